//! Long runs: energy drift of a vibrating bar (T17 of the stability scenes) over the number of steps.

use std::f64::consts::PI;

use mpm_core::geometry::Lattice;
use mpm_core::{PlaneStrain, Solver, TimeControl, Totals};
use sph::{Composition, Layout, Method, Sph};
use stability::scenes::long::{LENGTH, SPEED, STEP, swinging_bar};
use stability::stage::energy;
use verification::problems::{box_of_planes, rubber};
use verification::scene::block;
use verification::smoothed::Smoothed;
use verification::work::{Stopwatch, Work};
use verification::{Outcome, Scheme};

use crate::job::Key;

/// Discretisation of the bar.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Bar {
    /// Material points, two per axis in a cell of one metre.
    Points(Scheme),
    /// Smoothed particles, half a metre apart.
    Smoothed(Smoothed),
}

/// Spacing of smoothed particles, m.
const SPACING: f64 = 0.5;

impl Bar {
    /// List all discretisations.
    pub fn all() -> Vec<Bar> {
        let points = Scheme::all().into_iter().map(Bar::Points);
        points.chain(Smoothed::ALL.map(Bar::Smoothed)).collect()
    }

    fn name(self) -> String {
        match self {
            Bar::Points(scheme) => scheme.name(),
            Bar::Smoothed(smoothed) => smoothed.name().into(),
        }
    }

    /// Number of nodes or neighbours of a particle.
    fn nodes(self) -> u64 {
        match self {
            Bar::Points(scheme) => scheme.kernel.nodes(2),
            Bar::Smoothed(smoothed) => smoothed.neighbours(),
        }
    }

    fn solver(self) -> Result<Box<dyn Solver>, String> {
        Ok(match self {
            Bar::Points(scheme) => Box::new(swinging_bar(scheme)?),
            Bar::Smoothed(Smoothed::TotalLagrangian) => of_particles(Method::total_lagrangian(PlaneStrain))?,
            Bar::Smoothed(Smoothed::Updated) => of_particles(Method::updated(PlaneStrain))?,
        })
    }
}

/// Build the bar of smoothed particles: two rows between symmetry planes.
fn of_particles<M: Composition<2>>(method: M) -> Result<Box<dyn Solver>, String> {
    fn text(error: impl std::fmt::Display) -> String {
        error.to_string()
    }
    let lattice = Lattice::new([0.0; 2], SPACING).map_err(text)?;
    let seeds = block(&lattice, [0; 2], [(LENGTH / SPACING) as usize, 2], 1);
    let speed = |[x, _]: [f64; 2]| [SPEED * (PI * x / LENGTH).cos(), 0.0];
    let mut bar = Sph::new(method, rubber(1.0, 1.0, 0.0)?, &Layout::of_seeds(&seeds), speed).map_err(text)?;
    for plane in box_of_planes(1..2, 0.0, 2.0 * SPACING) {
        bar.bound(plane).map_err(text)?;
    }
    bar.set_time_control(TimeControl::Fixed(STEP)).map_err(text)?;
    Ok(Box::new(bar))
}

/// Vibrating bar.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Long {
    /// Discretisation of the bar.
    pub bar: Bar,
    /// Number of steps.
    pub steps: u64,
}

impl Long {
    /// Problem name in files.
    pub const PROBLEM: &str = "T17 swing";

    /// Key of the run, without its number of steps, which its records include.
    pub fn key(self) -> Key {
        let (per_axis, cell) = if self.is_smoothed() { (1, SPACING) } else { (2, 1.0) };
        Key {
            problem: Self::PROBLEM.into(),
            scheme: self.bar.name(),
            per_axis,
            cells: (LENGTH / cell) as usize,
            courant: STEP / cell,
        }
    }

    /// Find the run of a key, with the length of a quick sweep.
    pub fn of(key: &Key) -> Option<Long> {
        let found = Bar::all().into_iter().map(|bar| Long { bar, steps: 100_000 });
        found.into_iter().find(|long| long.key() == *key)
    }

    /// Return true for smoothed particles.
    pub fn is_smoothed(self) -> bool {
        matches!(self.bar, Bar::Smoothed(_))
    }

    /// Sample steps: 1, 2 and 5 per decade, and the last.
    fn marks(self) -> Vec<u64> {
        let all = (2..9).flat_map(|decade| [1, 2, 5].map(|n| n * 10u64.pow(decade)));
        all.filter(|&n| n > 2 * Self::period() && n < self.steps).chain([self.steps]).collect()
    }

    /// Number of steps of a period.
    fn period() -> u64 {
        (2.0 * LENGTH / STEP).round() as u64
    }

    /// Run the bar: "energy" is the relative change of its period mean, from the first period to the last before
    /// each sample.
    pub fn run(self) -> Vec<Outcome> {
        let mut solver = match self.bar.solver() {
            Ok(solver) => solver,
            Err(why) => return vec![Outcome { failure: Some(why), ..Outcome::default() }],
        };
        let mut work = Work { nodes: self.bar.nodes(), ..Work::default() };
        work.particles = solver.moving_points() as u64;
        let period = Self::period();
        let mut first = f64::NAN;
        let mut outcomes = Vec::new();
        for mark in std::iter::once(period).chain(self.marks()) {
            let mut sum = 0.0;
            while work.steps < mark {
                // Sample only the steps of the last period.
                let looked = work.steps >= mark - period;
                let stretch = if looked { 1 } else { mark - period - work.steps };
                let watch = Stopwatch::start();
                for _ in 0..stretch {
                    if let Err(error) = solver.step_at_most(f64::INFINITY) {
                        let failure = Some(error.to_string());
                        outcomes.push(Outcome { measures: Vec::new(), work, failure });
                        return outcomes;
                    }
                    work.steps += 1;
                }
                work.seconds += watch.seconds();
                if looked {
                    sum += energy(&totals(&*solver));
                }
            }
            work.bytes = solver.bytes() as u64;
            if first.is_nan() {
                first = sum;
            } else {
                outcomes.push(Outcome { measures: vec![("energy", sum / first - 1.0)], work, failure: None });
            }
        }
        outcomes
    }
}

fn totals(solver: &dyn Solver) -> Totals {
    solver.bodies().iter().map(|b| b.totals()).fold(Totals::default(), |a, b| a.plus(&b))
}
