//! A body by any of the methods.

use std::sync::Arc;

use fem::{Fem, MeshBody};
use mpm_core::geometry::structured::box_mesh;
use mpm_core::geometry::{Cuboid, Filling, Lattice, fill};
use mpm_core::{
    Axisymmetric, BlockGrid, Boundary, Embedding, Flip, IntoKernels, Kernels, Linear, Method, Mpm, Musl,
    PlaneStrain, PointView, Side, Solver,
};
use mpm_materials::IntoMaterial;
use pcmm::{Composition, LocalDelaunay, Masses, Packing, Pcmm};
use sph::{Layout, Sph};

use super::Way;
use crate::work::{Stopwatch, Work};

/// A velocity, m/s, of a place, m.
pub type Velocity = Arc<dyn Fn([f64; 2]) -> [f64; 2] + Send + Sync>;

/// A box from the origin, and what holds it.
pub struct Setup {
    /// Edges, m.
    pub size: [f64; 2],
    /// Cells or elements along them.
    pub cells: [usize; 2],
    pub velocity: Velocity,
    pub boundaries: Vec<Boundary<2>>,
}

impl Setup {
    /// A bar of so many cells along its `length` (m) and `across`, between planes of symmetry, that meets a wall at the origin at a speed
    /// (m/s).
    pub fn on_a_wall(length: f64, [cells, across]: [usize; 2], speed: f64) -> Self {
        let width = across as f64 * length / cells as f64;
        Setup {
            size: [length, width],
            cells: [cells, across],
            velocity: Arc::new(move |_| [-speed, 0.0]),
            boundaries: vec![
                Boundary::Wall { axis: 0, at: 0.0, side: Side::Above, velocity: 0.0 },
                Boundary::Symmetry { axis: 1, at: 0.0, side: Side::Above },
                Boundary::Symmetry { axis: 1, at: width, side: Side::Below },
            ],
        }
    }
}

/// A particle or a node.
#[derive(Clone, Copy, Debug)]
pub struct Point {
    pub mass: f64,
    /// Where it was at the start, m.
    pub rest: [f64; 2],
    pub position: [f64; 2],
    pub velocity: [f64; 2],
}

/// What differs from method to method.
trait Solved {
    fn solver(&mut self) -> &mut dyn Solver;
    /// Mass, position and velocity of every particle or node, with its place among those of the start.
    fn each(&self, visit: &mut dyn FnMut(usize, f64, [f64; 2], [f64; 2]));
}

impl Solved for Mpm<2> {
    fn solver(&mut self) -> &mut dyn Solver {
        self
    }
    fn each(&self, visit: &mut dyn FnMut(usize, f64, [f64; 2], [f64; 2])) {
        let plane = |x: [f64; 3]| [x[0], x[1]];
        self.bodies()[0].for_each(&mut |p| visit(p.number, p.mass, plane(p.position), plane(p.velocity)));
    }
}

impl Solved for Fem<2> {
    fn solver(&mut self) -> &mut dyn Solver {
        self
    }
    fn each(&self, visit: &mut dyn FnMut(usize, f64, [f64; 2], [f64; 2])) {
        let nodes = self.body(0).nodes().iter().enumerate();
        nodes.for_each(|(n, node)| visit(n, node.mass, node.position, node.velocity));
    }
}

impl<M: Composition<2>> Solved for Pcmm<2, M> {
    fn solver(&mut self) -> &mut dyn Solver {
        self
    }
    fn each(&self, visit: &mut dyn FnMut(usize, f64, [f64; 2], [f64; 2])) {
        self.particles().iter().enumerate().for_each(|(n, p)| visit(n, p.mass, p.position, p.velocity));
    }
}

impl<M: sph::Composition<2>> Solved for Sph<2, M> {
    fn solver(&mut self) -> &mut dyn Solver {
        self
    }
    fn each(&self, visit: &mut dyn FnMut(usize, f64, [f64; 2], [f64; 2])) {
        for (i, &n) in self.numbers().iter().enumerate() {
            visit(n as usize, self.mass(i), self.positions()[i], self.velocity(i));
        }
    }
}

/// A body of smoothed particles, and where they rest.
type Smoothed = (Vec<[f64; 2]>, Box<dyn Solved>);

/// Rows of smoothed particles on both ends of a box, where walls and clamps are, and half a spacing within its sides.
fn smoothed<M: sph::Composition<2>>(
    method: M,
    setup: Setup,
    law: impl IntoMaterial<f64>,
    (shape, lattice, filling): (&Cuboid<2>, &Lattice<2>, &Filling),
) -> Result<Smoothed, String> {
    let upright = setup.size[1] > setup.size[0];
    let layout = Layout::on_faces(shape, lattice, [!upright, upright], filling).map_err(text)?;
    let velocity = setup.velocity;
    let mut body = Sph::new(method, law, &layout, |x| velocity(x)).map_err(text)?;
    for boundary in setup.boundaries {
        body.bound(boundary).map_err(text)?;
    }
    Ok((layout.positions, Box::new(body)))
}

/// A body, and what its steps cost so far.
pub struct Matter {
    solved: Box<dyn Solved>,
    rest: Vec<[f64; 2]>,
    pub work: Work,
}

fn text(error: impl std::fmt::Display) -> String {
    error.to_string()
}

impl Matter {
    pub fn in_plane_strain(way: Way, setup: Setup, law: impl IntoMaterial<f64>) -> Result<Self, String> {
        let kernels = match way {
            Way::Linear => Method::new(Linear, Flip, Musl, PlaneStrain).into_kernels(),
            _ => Method::impact(PlaneStrain).into_kernels(),
        };
        Self::new(way, setup, law, PlaneStrain, kernels, Filling::new())
    }

    pub fn around_the_axis(way: Way, setup: Setup, law: impl IntoMaterial<f64>) -> Result<Self, String> {
        let kernels = match way {
            Way::Linear => Method::new(Linear, Flip, Musl, Axisymmetric).into_kernels(),
            _ => Method::impact(Axisymmetric).into_kernels(),
        };
        Self::new(way, setup, law, Axisymmetric, kernels, Filling::new().axisymmetric())
    }

    fn new<E: Embedding<2> + std::fmt::Debug>(
        way: Way,
        setup: Setup,
        law: impl IntoMaterial<f64>,
        space: E,
        kernels: Kernels<f64, 2>,
        filling: Filling,
    ) -> Result<Self, String> {
        let shape = Cuboid::new([0.0; 2], setup.size).map_err(text)?;
        let h = setup.size[0] / setup.cells[0] as f64;
        let lattice = Lattice::new([0.0; 2], h).map_err(text)?;
        let velocity = setup.velocity.clone();
        let (rest, mut solved): (_, Box<dyn Solved>) = match way {
            Way::Linear | Way::Impact => {
                let seeds = fill(&shape, &lattice, 2, &filling).map_err(text)?;
                let mut mpm = Mpm::new(kernels, BlockGrid::new(lattice));
                mpm.add("body", law, &seeds, |x| velocity(x)).map_err(text)?;
                for boundary in setup.boundaries {
                    mpm.bound(boundary).map_err(text)?;
                }
                (seeds.positions, Box::new(mpm))
            }
            Way::TotalLagrangian => {
                smoothed(sph::Method::total_lagrangian(space), setup, law, (&shape, &lattice, &filling))?
            }
            Way::Updated => smoothed(sph::Method::updated(space), setup, law, (&shape, &lattice, &filling))?,
            Way::Contacts => {
                let packing = Packing::on_nodes(&shape, &lattice).map_err(text)?;
                let delaunay = LocalDelaunay::new(0.45 * h, 20.0).map_err(text)?;
                let method = pcmm::Method::consistent(space, delaunay);
                let made = Pcmm::new(method, law, &packing, |x| velocity(x), Masses::FromElements);
                let mut pcmm = made.map_err(text)?;
                for boundary in setup.boundaries {
                    pcmm.bound(boundary).map_err(text)?;
                }
                pcmm.set_revision_interval(10).map_err(text)?;
                (packing.positions, Box::new(pcmm))
            }
            Way::Elements(elements) => {
                let mesh = elements.cut(box_mesh(&shape, setup.cells).map_err(text)?)?;
                let rest = mesh.nodes.clone();
                let (kind, technology) = elements.technology();
                let body = MeshBody::new("body", mesh, law).with(kind, technology);
                let mut fem = Fem::new(space);
                fem.add(body.moving(move |x| velocity(x))).map_err(text)?;
                for boundary in setup.boundaries {
                    fem.bound(boundary).map_err(text)?;
                }
                (rest, Box::new(fem))
            }
        };
        let work =
            Work { particles: solved.solver().moving_points() as u64, nodes: way.nodes(), ..Work::default() };
        Ok(Matter { solved, rest, work })
    }

    /// Step until `end`, s.
    pub fn run_until(&mut self, end: f64) -> Result<(), String> {
        let watch = Stopwatch::start();
        let solver = self.solved.solver();
        let made = solver.run_until(end);
        self.work.seconds += watch.seconds();
        self.work.steps = solver.steps();
        self.work.bytes = solver.bytes() as u64;
        made.map_err(text)
    }

    /// What there is now.
    pub fn points(&self) -> Vec<Point> {
        let mut points = Vec::with_capacity(self.rest.len());
        self.solved.each(&mut |n, mass, position, velocity| {
            points.push(Point { mass, rest: self.rest[n], position, velocity });
        });
        points
    }

    /// Call `visit` for every particle, or every element.
    pub fn visit(&mut self, visit: &mut dyn FnMut(&PointView)) {
        self.solved.solver().bodies().iter().for_each(|body| body.for_each(visit));
    }

    /// The place of a number of the law among those of a point, by its name.
    pub fn place_of(&mut self, name: &str) -> Option<usize> {
        let bodies = self.solved.solver().bodies();
        bodies.first()?.state_names().iter().position(|n| n == name)
    }

    /// Energy that nothing explains, over that at the start.
    pub fn energy_error(&mut self) -> f64 {
        self.solved.solver().account().energy_error()
    }
}
