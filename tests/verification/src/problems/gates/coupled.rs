//! Finite element body with conversion to particles.

use coupling::{Conversion, ConversionLog, Elements};
use fem::{Fem, MeshBody};
use mpm_core::geometry::structured::box_mesh;
use mpm_core::geometry::{Cuboid, Lattice};
use mpm_core::{BlockGrid, Embedding, Kernels, Mpm, Solver, StepError};
use mpm_materials::IntoMaterial;

use super::Way;
use super::matter::Setup;
use super::solved::{Solved, text};
use crate::work::Work;

/// Height of the region of initial particles (MPFEM), in bar radii: it includes all large deformation.
const REGION: f64 = 2.0;

/// Coupled scene and the work of its steps.
pub struct Coupled {
    mpm: Mpm<2>,
    log: ConversionLog,
    way: Way,
    /// Cell size, m.
    cell: f64,
    /// Number of initial elements.
    elements: u64,
    /// Number of points and of their nodes, summed over steps.
    points: u64,
    nodes: u64,
}

impl Coupled {
    /// Mesh a box with elements of cell size on its lower boundary plane.
    pub fn new<E: Embedding<2>>(
        way: Way,
        setup: Setup,
        law: impl IntoMaterial<f64>,
        space: E,
        kernels: Kernels<f64, 2>,
    ) -> Result<Self, String> {
        let [radius, _] = setup.size;
        let cell = radius / setup.cells[0] as f64;
        let lattice = Lattice::new([0.0; 2], cell).map_err(text)?;
        let mesh = box_mesh(&Cuboid::new([0.0; 2], setup.size).map_err(text)?, setup.cells).map_err(text)?;
        let velocity = setup.velocity;
        let mut fem = Fem::new(space);
        fem.add(MeshBody::new("body", mesh, law).moving(move |x| velocity(x))).map_err(text)?;
        let conversion = match way {
            Way::Mpfem => {
                let far = 10.0 * radius;
                Conversion::within(Cuboid::new([-far, -far], [far, REGION * radius]).map_err(text)?)
            }
            _ => Conversion::adaptive(),
        };
        let (elements, log) = Elements::converting(fem, "particles", conversion).map_err(text)?;
        let mut mpm = Mpm::new(kernels, BlockGrid::new(lattice));
        mpm.add_client(elements).map_err(text)?;
        for boundary in setup.boundaries {
            mpm.bound(boundary).map_err(text)?;
        }
        let elements = (setup.cells[0] * setup.cells[1]) as u64;
        Ok(Coupled { mpm, log, way, cell, elements, points: 0, nodes: 0 })
    }
}

impl Solved for Coupled {
    fn solver(&mut self) -> &mut dyn Solver {
        &mut self.mpm
    }
    fn run_until(&mut self, end: f64) -> Result<(), StepError> {
        let (mut converted, mut points, mut nodes) = (u64::MAX, 0, 0);
        while !self.mpm.reached(end) {
            self.mpm.step_towards(end)?;
            let now = self.mpm.moving_points() as u64;
            if now != converted {
                let book = self.log.book();
                let left = self.elements - book.elements;
                converted = now;
                points = left + book.particles;
                nodes = left * self.way.nodes() + book.particles * Way::Impact.nodes();
            }
            self.points += points;
            self.nodes += nodes;
        }
        self.mpm.look_at_the_end()
    }
    fn each(&self, _: &mut dyn FnMut(usize, f64, [f64; 2], [f64; 2])) {}
    fn outer_sizes(&self) -> Option<[f64; 2]> {
        Some(sizes(&self.mpm, self.cell))
    }
    fn weigh(&self, work: &mut Work) {
        work.particles = self.points / work.steps.max(1);
        work.nodes = (self.nodes as f64 / self.points.max(1) as f64).round() as u64;
    }
}

/// Height and largest radius, m, of an axisymmetric bar, from element corners and from outermost particles with half their size. The width
/// of a particle is the distance to its lateral neighbour within an angle of 27 degrees; its height follows from its volume.
fn sizes(mpm: &Mpm<2>, cell: f64) -> [f64; 2] {
    let (mut corners, mut places, mut particles) = (Vec::new(), Vec::new(), Vec::new());
    for body in mpm.bodies() {
        body.for_each(&mut |p| {
            let [r, z, _] = p.position;
            places.push([r, z]);
            match p.corners.is_empty() {
                true => particles.push(([r, z], p.volume / r)),
                false => corners.extend(p.corners.iter().map(|x| [x[0], x[1]])),
            }
        });
    }
    let half_sizes = |x: &[f64; 2], area: f64| {
        let away = places.iter().map(|y| [0, 1].map(|d| (y[d] - x[d]).abs()));
        let beside = away.filter(|[r, z]| *r > 2.0 * z).map(|[r, _]| r);
        let width = beside.fold(f64::INFINITY, f64::min);
        [0.5 * width, 0.5 * area / width]
    };
    let end = |axis: usize, sign: f64| {
        let along = |x: &[f64; 2]| sign * x[axis];
        let outermost = places.iter().map(along).fold(f64::NEG_INFINITY, f64::max);
        let last = particles.iter().filter(|(x, _)| along(x) > outermost - cell);
        let reach = last.map(|(x, area)| along(x) + half_sizes(x, *area)[axis]);
        reach.chain(corners.iter().map(along)).fold(f64::NEG_INFINITY, f64::max)
    };
    [end(1, 1.0) + end(1, -1.0), end(0, 1.0)]
}
