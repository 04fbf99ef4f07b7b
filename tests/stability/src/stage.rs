//! Common parts of scenes: h = 1 m, density 1 kg/m^3, E = 1 Pa and c = 1 m/s unless stated otherwise.

use mpm_core::Mpm;
use mpm_core::geometry::{Lattice, Seeds};
use mpm_core::{Boundary, PointView, StepError, Stopped, TimeControl, Totals};
use verification::empty::empty_scene;
use verification::problems::{box_of_planes, lattice, rubber};
use verification::scene::block;
use verification::{Kernel, Scheme, Velocity};

use crate::verdict::Stop;

pub use Kernel::{CpGimp, Cpdi, Cpdi2, Cubic, Gimp, Linear, Quadratic};
pub use Velocity::{ApicUsl, FlipMusl, FlipUsl, Fmpm4Usl};

/// Updated Lagrangian scheme.
pub const fn ul(kernel: Kernel, velocity: Velocity) -> Scheme {
    Scheme::moving(kernel, velocity)
}

/// Total Lagrangian scheme.
pub const fn tl(kernel: Kernel, velocity: Velocity) -> Scheme {
    Scheme::total(kernel, velocity)
}

/// Convert an error to text.
pub fn text(error: impl std::fmt::Display) -> String {
    error.to_string()
}

/// Lattice of unit cells at the origin.
pub fn cells() -> Result<Lattice<2>, String> {
    lattice([0.0; 2], 1.0)
}

/// Create a solver of a scheme on unit cells, with fixed time steps.
pub fn solver(scheme: Scheme, dt: f64) -> Result<Mpm<2>, String> {
    let mut mpm = empty_scene(scheme, cells()?).ok_or("no such composition")?;
    mpm.set_time_control(TimeControl::Fixed(dt)).map_err(text)?;
    Ok(mpm)
}

/// Row of cells from node 0 on, `per_axis` particles per cell and axis, displaced by `shift` along x.
pub fn row_of_cells(count: usize, per_axis: usize, shift: f64) -> Result<Seeds<2>, String> {
    let mut seeds = block(&cells()?, [0; 2], [count, 1], per_axis);
    for x in &mut seeds.positions {
        x[0] += shift;
    }
    Ok(seeds)
}

/// Build a bar one cell wide between symmetry planes: one-dimensional motion, nu = 0.
pub fn bar(
    scheme: Scheme,
    dt: f64,
    seeds: &Seeds<2>,
    velocity: &dyn Fn(f64) -> f64,
) -> Result<Mpm<2>, String> {
    let mut mpm = solver(scheme, dt)?;
    bound(&mut mpm, box_of_planes(1..2, 0.0, 1.0))?;
    mpm.add("bar", rubber(1.0, 1.0, 0.0)?, seeds, |x| [velocity(x[0]), 0.0]).map_err(text)?;
    Ok(mpm)
}

/// Add boundary conditions.
pub fn bound(mpm: &mut Mpm<2>, list: Vec<Boundary<2>>) -> Result<(), String> {
    list.into_iter().try_for_each(|b| mpm.bound(b)).map_err(text)
}

/// Advance by steps and call `look` after each with its number; return the error that stopped them, if any.
pub fn steps(mpm: &mut Mpm<2>, count: u64, mut look: impl FnMut(&Mpm<2>, u64)) -> Option<Stop> {
    for step in 1..=count {
        if let Err(error) = mpm.step() {
            return Some(Stop { step: error.step, what: error.to_string() });
        }
        look(mpm, step);
    }
    None
}

/// Advance until a step stops with an error.
pub fn until_stopped(mpm: &mut Mpm<2>, count: u64) -> Option<StepError> {
    (0..count).find_map(|_| mpm.step().err())
}

/// Body, particle and position named in an error.
pub fn named(error: &StepError) -> Option<(&str, usize, [f64; 3])> {
    match &error.what {
        Stopped::Point { body, number, position, .. } => Some((body, *number, *position)),
        _ => None,
    }
}

/// Return all particles.
pub fn particles(mpm: &Mpm<2>) -> Vec<PointView> {
    mpm.bodies().iter().flat_map(|body| body.points()).collect()
}

/// Kinetic energy of the particles in the centre-of-mass frame, plus internal energy, J.
pub fn energy(t: &Totals) -> f64 {
    let square: f64 = t.momentum.iter().map(|p| p * p).sum();
    t.kinetic - 0.5 * square / t.mass + t.internal
}

/// Pseudo-random number generator (SplitMix64) for -1 .. 1; equal sequences on every machine.
pub struct Random(u64);

impl Random {
    /// Create a generator from a seed.
    pub fn new(seed: u64) -> Self {
        Random(seed)
    }
    /// Return the next number.
    pub fn number(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }
}

/// Means of a value over the first and the last of `parts` parts of a run.
#[derive(Clone, Debug)]
pub struct Means {
    length: u64,
    parts: u64,
    first: f64,
    last: f64,
}

impl Means {
    /// Create means of a run of `count` steps.
    pub fn new(count: u64, parts: u64) -> Self {
        Means { length: (count / parts).max(1), parts, first: 0.0, last: 0.0 }
    }
    /// Add the value of a step, from 1 on.
    pub fn add(&mut self, step: u64, value: f64) {
        if step <= self.length {
            self.first += value;
        }
        if step > (self.parts - 1) * self.length && step <= self.parts * self.length {
            self.last += value;
        }
    }
    /// Relative change from the first mean to the last.
    pub fn change(&self) -> f64 {
        self.last / self.first - 1.0
    }
}
