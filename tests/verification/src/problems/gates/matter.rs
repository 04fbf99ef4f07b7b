//! Body of a gate, solved by any of the methods.

use std::sync::Arc;

use fem::{Fem, MeshBody};
use mpm_core::geometry::structured::box_mesh;
use mpm_core::geometry::{Cuboid, Filling, Lattice, fill};
use mpm_core::{
    Axisymmetric, BlockGrid, Boundary, Deformable, Embedding, Flip, IntoKernels, Kernels, Linear, Method,
    Mpm, Musl, PlaneStrain, PointView, Side, Traction,
};
use mpm_materials::IntoMaterial;
use pcmm::{LocalDelaunay, Masses, Packing, Pcmm};

use super::Way;
use super::coupled::Coupled;
use super::solved::{self, Solved, smoothed, text, unloaded};
use crate::work::{Stopwatch, Work};

/// Initial velocity, m/s, as a function of position, m.
pub type Velocity = Arc<dyn Fn([f64; 2]) -> [f64; 2] + Send + Sync>;

/// Traction history, Pa, over time, s.
pub type Load = Arc<dyn Fn(f64) -> [f64; 2] + Send + Sync>;

/// Box from the origin, with boundary conditions and loads.
pub struct Setup {
    /// Edge lengths, m.
    pub size: [f64; 2],
    /// Number of cells or elements along the edges.
    pub cells: [usize; 2],
    pub velocity: Velocity,
    pub boundaries: Vec<Boundary<2>>,
    /// Traction on the far end along x.
    pub load: Option<Load>,
}

impl Setup {
    /// Build a bar of so many cells along its `length` (m) and `across`, between symmetry planes, that hits a wall at the origin at a
    /// speed (m/s).
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
            load: None,
        }
    }
}

/// Particle or node.
#[derive(Clone, Copy, Debug)]
pub struct Point {
    pub mass: f64,
    /// Initial position, m.
    pub rest: [f64; 2],
    pub position: [f64; 2],
    pub velocity: [f64; 2],
}

/// Body of a gate and its work so far.
pub struct Matter {
    solved: Box<dyn Solved>,
    rest: Vec<[f64; 2]>,
    pub work: Work,
}

impl Matter {
    pub fn in_plane_strain(way: Way, setup: Setup, law: impl IntoMaterial<f64>) -> Result<Self, String> {
        if let Way::Fragile(fragile) = way {
            let (rest, solved) = solved::fragile(fragile, setup, law)?;
            return Ok(Self::of(way, rest, solved));
        }
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
        let (rest, solved): (_, Box<dyn Solved>) = match way {
            Way::Linear | Way::Impact => {
                let seeds = fill(&shape, &lattice, 2, &filling).map_err(text)?;
                let mut mpm = Mpm::new(kernels, BlockGrid::new(lattice));
                let mut body = Deformable::new("body", law, &seeds).moving(|x| velocity(x));
                if let Some(history) = setup.load {
                    // Loaded particles: nearer to the end than half a cell.
                    let [length, width] = setup.size;
                    let region =
                        Cuboid::new([length - 0.5 * h, -h], [length + h, width + h]).map_err(text)?;
                    let region = Arc::new(region);
                    body = body.with_traction(Traction { region, axis: 0, history, revolved: false });
                }
                mpm.add_body(body).map_err(text)?;
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
                unloaded(&setup)?;
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
                let solved: Box<dyn Solved> = match setup.load {
                    Some(load) => Box::new(solved::Loaded::new(fem, setup.size[0], load)),
                    None => Box::new(fem),
                };
                (rest, solved)
            }
            Way::Mpfem | Way::Afemp => {
                unloaded(&setup)?;
                (Vec::new(), Box::new(Coupled::new(way, setup, law, space, kernels)?))
            }
            Way::Fragile(_) | Way::Cracks(_) => return Err(format!("{} does not run this", way.name())),
        };
        Ok(Self::of(way, rest, solved))
    }

    fn of(way: Way, rest: Vec<[f64; 2]>, mut solved: Box<dyn Solved>) -> Self {
        let particles = solved.solver().moving_points() as u64;
        Matter { solved, rest, work: Work { particles, nodes: way.nodes(), ..Work::default() } }
    }

    /// Advance to time `end`, s.
    pub fn run_until(&mut self, end: f64) -> Result<(), String> {
        let watch = Stopwatch::start();
        let made = self.solved.run_until(end);
        let solver = self.solved.solver();
        self.work.seconds += watch.seconds();
        self.work.steps = solver.steps();
        self.work.bytes = solver.bytes() as u64;
        self.solved.weigh(&mut self.work);
        made.map_err(text)
    }

    /// Height and largest radius, m, of a body whose points have no initial position.
    pub fn outer_sizes(&self) -> Option<[f64; 2]> {
        self.solved.outer_sizes()
    }

    /// Return all points that have an initial position.
    pub fn points(&self) -> Vec<Point> {
        let mut points = Vec::with_capacity(self.rest.len());
        self.solved.each(&mut |n, mass, position, velocity| {
            points.push(Point { mass, rest: self.rest[n], position, velocity });
        });
        points
    }

    /// Visit every particle or every element.
    pub fn visit(&mut self, visit: &mut dyn FnMut(&PointView)) {
        self.solved.solver().bodies().iter().for_each(|body| body.for_each(visit));
    }

    /// Index of a state variable of the law among those of a point, by its name.
    pub fn place_of(&mut self, name: &str) -> Option<usize> {
        let bodies = self.solved.solver().bodies();
        bodies.first()?.state_names().iter().position(|n| n == name)
    }

    /// Relative energy error of the balance, over the initial energy.
    pub fn energy_error(&mut self) -> f64 {
        self.solved.solver().account().energy_error()
    }
}
