//! A scene of one elastic or fluid body, run by any method, looked at now and then.

use std::sync::Arc;

use mpm_core::geometry::{Lattice, Seeds};
use mpm_core::{
    BlockGrid, Boundary, Deformable, FieldForce, Footprint, Frequency, GridBody, IntoKernels, Mpm, PointView,
    TimeControl, Totals,
};
use mpm_materials::IntoMaterial;

use crate::work::{Stopwatch, Work};

/// Velocity by position, m/s.
pub type Flow<const D: usize> = Box<dyn Fn([f64; D]) -> [f64; D]>;

/// Acceleration by where a particle started and time, m/s^2.
pub type Drive<const D: usize> = Arc<dyn Fn(&[f64; D], f64) -> [f64; D] + Send + Sync>;

/// A body and what acts on it.
pub struct Scene<C, const D: usize> {
    /// Nodes.
    pub lattice: Lattice<D>,
    /// Particles.
    pub seeds: Seeds<D>,
    /// Law.
    pub law: C,
    /// Velocity half a step before the start: updates of momentum are centred on times, velocities between them.
    pub velocity: Flow<D>,
    /// Body force, if any.
    pub field: Option<Drive<D>>,
    /// Boundaries.
    pub boundaries: Vec<Boundary<D>>,
    /// Time step, s.
    pub dt: f64,
    /// Steps.
    pub steps: u64,
    /// Steps between looks.
    pub every: u64,
}

/// A moment of a run.
pub struct Moment<'a, const D: usize> {
    /// Time, s.
    pub time: f64,
    /// Time that velocities belong to, s.
    pub velocity_time: f64,
    /// Where particles started, by number, m.
    pub starts: &'a [[f64; D]],
    bodies: &'a [Box<dyn GridBody<f64, D>>],
    frequency: &'a dyn Fn() -> Frequency,
}

impl<const D: usize> Moment<'_, D> {
    /// Call `visit` for every particle.
    pub fn for_each(&self, visit: &mut dyn FnMut(&PointView)) {
        for body in self.bodies {
            body.for_each(visit);
        }
    }
    /// Call `visit` for every particle as its nodes see it.
    pub fn footprints(&self, visit: &mut dyn FnMut(&Footprint<'_, D>)) {
        for body in self.bodies {
            body.footprints(self.time, visit);
        }
    }
    /// The bound of the highest frequency.
    pub fn frequency(&self) -> Frequency {
        (self.frequency)()
    }
    /// Totals over the particles.
    pub fn totals(&self) -> Totals {
        self.bodies.iter().map(|b| b.totals()).fold(Totals::default(), |a, b| a.plus(&b))
    }
}

/// Runs a scene and looks at it.
pub struct Run<'a, C, const D: usize> {
    /// The scene.
    pub scene: &'a Scene<C, D>,
    /// What looks.
    pub look: &'a mut dyn FnMut(&Moment<'_, D>),
}

/// Work done, and what stopped the run, if something did.
pub type Ended = (Work, Option<String>);

impl<C: IntoMaterial<f64> + Clone, const D: usize> Run<'_, C, D> {
    /// Run it by this method.
    pub fn with(self, method: impl IntoKernels<f64, D>) -> Ended {
        let Run { scene, look } = self;
        let mut work = Work { particles: scene.seeds.positions.len() as u64, ..Work::default() };
        let mut mpm = Mpm::new(method, BlockGrid::new(scene.lattice));
        let mut body = Deformable::new("body", scene.law.clone(), &scene.seeds).moving(&scene.velocity);
        if let Some(acceleration) = scene.field.clone() {
            body = body.with_field_force(FieldForce { acceleration });
        }
        let bounded = mpm
            .add_body(body)
            .and_then(|()| scene.boundaries.iter().try_for_each(|b| mpm.bound(b.clone())))
            .and_then(|()| mpm.set_time_control(TimeControl::Fixed(scene.dt)));
        if let Err(error) = bounded {
            return (work, Some(error.to_string()));
        }
        while work.steps < scene.steps {
            let stretch = scene.every.min(scene.steps - work.steps);
            let watch = Stopwatch::start();
            for _ in 0..stretch {
                if let Err(error) = mpm.step() {
                    return (work, Some(error.to_string()));
                }
                work.steps += 1;
            }
            work.seconds += watch.seconds();
            work.bytes = mpm.bytes() as u64;
            look(&Moment {
                time: mpm.time(),
                velocity_time: mpm.time() - 0.5 * scene.dt,
                starts: &scene.seeds.positions,
                bodies: mpm.bodies(),
                frequency: &|| mpm.frequency_bound(),
            });
        }
        (work, None)
    }
}

/// Sums of squares and largest of an error, by mass.
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
        // `f64::max` would lose a value that is not a number.
        if square.is_nan() || square.sqrt() > self.largest {
            self.largest = square.sqrt();
        }
    }
    /// Root of the mean square.
    pub fn l2(&self) -> f64 {
        (self.squares / self.mass).sqrt()
    }
    /// The largest.
    pub fn largest(&self) -> f64 {
        self.largest
    }
}

/// The larger of two, or what is not a number.
pub fn worse(a: f64, b: f64) -> f64 {
    if b.is_nan() || b > a { b } else { a }
}

/// A block of cells from `low` on, `per_axis` particles a cell and axis, volumes of the lattice.
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
