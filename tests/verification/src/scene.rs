//! Scene of one elastic or fluid body, run by any method and sampled at intervals.

use std::sync::Arc;

use mpm_core::geometry::{Lattice, Seeds};
use mpm_core::{
    BlockGrid, Body, Boundary, Deformable, FieldForce, IntoKernels, Mpm, PointView, StepError, TimeControl,
    Totals,
};
use mpm_materials::IntoMaterial;

use crate::work::{Stopwatch, Work};

/// Velocity field, m/s: function of position.
pub type Flow<const D: usize> = Box<dyn Fn([f64; D]) -> [f64; D]>;

/// Acceleration field, m/s^2: function of initial particle position and time.
pub type Drive<const D: usize> = Arc<dyn Fn(&[f64; D], f64) -> [f64; D] + Send + Sync>;

/// Body with its loads and boundary conditions.
pub struct Scene<C, const D: usize> {
    /// Background grid.
    pub lattice: Lattice<D>,
    /// Particle seeds.
    pub seeds: Seeds<D>,
    /// Constitutive law.
    pub law: C,
    /// Velocity half a step before the start: leapfrog velocities are midway between the times of the momentum
    /// updates.
    pub velocity: Flow<D>,
    /// Body force, optional.
    pub field: Option<Drive<D>>,
    /// Boundary conditions.
    pub boundaries: Vec<Boundary<D>>,
    /// Time step, s.
    pub dt: f64,
    /// Number of steps.
    pub steps: u64,
    /// Number of steps between samples.
    pub every: u64,
}

/// Sample of a run.
pub struct Moment<'a, const D: usize> {
    /// Time, s.
    pub time: f64,
    /// Time of the velocities, s.
    pub velocity_time: f64,
    /// Initial particle positions by number, m.
    pub starts: &'a [[f64; D]],
    body: &'a dyn Body,
    grid: Option<&'a Mpm<D>>,
}

impl<const D: usize> Moment<'_, D> {
    /// Visit every particle.
    pub fn for_each(&self, visit: &mut dyn FnMut(&PointView)) {
        self.body.for_each(visit);
    }
    /// Material point solver, if any.
    pub fn grid(&self) -> Option<&Mpm<D>> {
        self.grid
    }
    /// Totals over the particles.
    pub fn totals(&self) -> Totals {
        self.body.totals()
    }
}

/// Body of a scene with a time step interface.
pub(crate) trait Stepped<const D: usize> {
    /// Advance by one step.
    fn step(&mut self) -> Result<(), StepError>;
    /// Time, s.
    fn time(&self) -> f64;
    /// Time of the velocities after steps of `dt`, s.
    fn velocity_time(&self, dt: f64) -> f64 {
        self.time() - 0.5 * dt
    }
    /// Body of the scene.
    fn body(&self) -> &dyn Body;
    /// Material point solver, if any.
    fn grid(&self) -> Option<&Mpm<D>> {
        None
    }
    /// Memory use, bytes.
    fn bytes(&self) -> usize;
}

impl<const D: usize> Stepped<D> for Mpm<D> {
    fn step(&mut self) -> Result<(), StepError> {
        Mpm::step(self).map(|_| ())
    }
    fn time(&self) -> f64 {
        Mpm::time(self)
    }
    fn body(&self) -> &dyn Body {
        &*self.bodies()[0]
    }
    fn grid(&self) -> Option<&Mpm<D>> {
        Some(self)
    }
    fn bytes(&self) -> usize {
        Mpm::bytes(self)
    }
}

/// Runner of a scene with sampling.
pub struct Run<'a, C, const D: usize> {
    /// Scene to run.
    pub scene: &'a Scene<C, D>,
    /// Sampling function.
    pub look: &'a mut dyn FnMut(&Moment<'_, D>),
}

/// Work and failure message of a run.
pub type Ended = (Work, Option<String>);

impl<C: IntoMaterial<f64> + Clone, const D: usize> Run<'_, C, D> {
    /// Run the scene by this method.
    pub fn with(self, method: impl IntoKernels<f64, D>) -> Ended {
        let scene = self.scene;
        let body = Deformable::new("body", scene.law.clone(), &scene.seeds).moving(&scene.velocity);
        self.on(Mpm::new(method, BlockGrid::new(scene.lattice)), body)
    }
}

impl<C, const D: usize> Run<'_, C, D> {
    /// Run this body of the scene in an empty solver scene.
    pub(crate) fn on<L: IntoMaterial<f64>>(self, mut mpm: Mpm<D>, body: Deformable<'_, D, L>) -> Ended {
        let scene = self.scene;
        let body = match scene.field.clone() {
            Some(acceleration) => body.with_field_force(FieldForce { acceleration }),
            None => body,
        };
        let bounded = mpm
            .add_body(body)
            .and_then(|()| scene.boundaries.iter().try_for_each(|b| mpm.bound(b.clone())))
            .and_then(|()| mpm.set_time_control(TimeControl::Fixed(scene.dt)));
        match bounded {
            Ok(()) => self.by_steps(&mut mpm),
            Err(error) => self.refused(error),
        }
    }

    /// Return the result of a scene whose setup failed.
    pub(crate) fn refused(&self, why: impl std::fmt::Display) -> Ended {
        let particles = self.scene.seeds.positions.len() as u64;
        (Work { particles, ..Work::default() }, Some(why.to_string()))
    }

    /// Advance the scene by its steps and sample it.
    pub(crate) fn by_steps(self, solver: &mut dyn Stepped<D>) -> Ended {
        let Run { scene, look } = self;
        let mut work = Work { particles: scene.seeds.positions.len() as u64, ..Work::default() };
        while work.steps < scene.steps {
            let stretch = scene.every.min(scene.steps - work.steps);
            let watch = Stopwatch::start();
            for _ in 0..stretch {
                if let Err(error) = solver.step() {
                    return (work, Some(error.to_string()));
                }
                work.steps += 1;
            }
            work.seconds += watch.seconds();
            work.bytes = solver.bytes() as u64;
            look(&Moment {
                time: solver.time(),
                velocity_time: solver.velocity_time(scene.dt),
                starts: &scene.seeds.positions,
                body: solver.body(),
                grid: solver.grid(),
            });
        }
        (work, None)
    }
}

/// Mass-weighted sum of squares and maximum of an error.
#[derive(Clone, Copy, Debug, Default)]
pub struct Norm {
    mass: f64,
    squares: f64,
    largest: f64,
}

impl Norm {
    /// Add the error of one particle.
    pub fn add(&mut self, mass: f64, error: &[f64]) {
        let square: f64 = error.iter().map(|e| e * e).sum();
        self.mass += mass;
        self.squares += mass * square;
        // `f64::max` would lose a NaN.
        if square.is_nan() || square.sqrt() > self.largest {
            self.largest = square.sqrt();
        }
    }
    /// Root mean square error.
    pub fn l2(&self) -> f64 {
        (self.squares / self.mass).sqrt()
    }
    /// Maximum error.
    pub fn largest(&self) -> f64 {
        self.largest
    }
}

/// Return the larger of two numbers, or NaN.
pub fn worse(a: f64, b: f64) -> f64 {
    if b.is_nan() || b > a { b } else { a }
}

/// Return a block of cells from `low` on, `per_axis` particles per cell and axis, with the volumes of the lattice.
pub fn block<const D: usize>(
    lattice: &Lattice<D>,
    low: [i64; D],
    cells: [usize; D],
    per_axis: usize,
) -> Seeds<D> {
    let h = lattice.spacing();
    let counts = cells.map(|c| c * per_axis);
    let volume = (h / per_axis as f64).powi(D as i32);
    let mut positions = Vec::new();
    for mut rest in 0..counts.iter().product() {
        let mut x = lattice.node(low);
        for d in 0..D {
            x[d] += ((rest % counts[d]) as f64 + 0.5) / per_axis as f64 * h;
            rest /= counts[d];
        }
        positions.push(x);
    }
    let volumes = vec![volume; positions.len()];
    Seeds::placed(positions, volumes, [0.5 * h / per_axis as f64; D])
}
