//! Jobs: runs of the charts, with keys for files.

use serde::{Deserialize, Serialize};
use verification::formulation::Formulation;
use verification::problems::gates::Passage;
use verification::smoothed::Smoothed;
use verification::{Case, Outcome, Problem, Scheme};

use crate::contact::{Strike, Touch};
use crate::gates;
use crate::long::Long;
use crate::soil::Footing;
use crate::study::Study;

/// Run of a chart.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Job {
    /// Case of the package `verification`.
    Case(Case),
    /// Case of the package `verification` by smoothed particles.
    Smoothed(Case<Smoothed>),
    /// Contact of two bodies.
    Touch(Touch),
    /// Contact of two bars of smoothed particles.
    Strike(Strike),
    /// Strip footing.
    Footing(Footing),
    /// Long run of a vibrating bar.
    Long(Long),
    /// Method in a scene with known failures of methods.
    Study(Study),
    /// Gate: benchmark of all methods.
    Passage(Passage),
}

/// Unique key of a run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Key {
    /// Problem.
    pub problem: String,
    /// Scheme, followed by a comma and further options, if any.
    pub scheme: String,
    /// Particles per cell and axis.
    pub per_axis: usize,
    /// Number of cells along the problem's length.
    pub cells: usize,
    /// Courant number: time step times wave speed over cell size, or the factor of the time control.
    pub courant: f64,
}

fn of_case<S: Formulation>(case: &Case<S>) -> Key {
    Key {
        problem: case.problem.name().into(),
        scheme: case.scheme.name(),
        per_axis: case.per_axis,
        cells: case.cells,
        courant: case.courant,
    }
}

impl Job {
    /// Key of the job.
    pub fn key(&self) -> Key {
        match self {
            Job::Case(case) => of_case(case),
            Job::Smoothed(case) => of_case(case),
            Job::Touch(touch) => touch.key(),
            Job::Strike(strike) => strike.key(),
            Job::Footing(footing) => footing.key(),
            Job::Long(long) => long.key(),
            Job::Study(study) => study.key(),
            Job::Passage(passage) => gates::key(*passage),
        }
    }

    /// Find the job of a key, if it still exists.
    pub fn of(key: &Key) -> Option<Job> {
        if let Some(problem) = Problem::ALL.into_iter().find(|p| p.name() == key.problem) {
            let Key { per_axis, cells, courant, .. } = *key;
            if let Some(scheme) = Smoothed::named(&key.scheme) {
                return Some(Job::Smoothed(Case { problem, scheme, per_axis, cells, courant }));
            }
            let scheme = Scheme::named(&key.scheme)?;
            return Some(Job::Case(Case { problem, scheme, per_axis, cells, courant }));
        }
        Touch::of(key)
            .map(Job::Touch)
            .or_else(|| Strike::of(key).map(Job::Strike))
            .or_else(|| Footing::of(key).map(Job::Footing))
            .or_else(|| Long::of(key).map(Job::Long))
            .or_else(|| Study::of(key).map(Job::Study))
            .or_else(|| gates::of(key).map(Job::Passage))
    }

    /// Run the job; return one outcome, or several for a sampled run.
    pub fn run(&self) -> Vec<Outcome> {
        match self {
            Job::Case(case) => vec![case.run()],
            Job::Smoothed(case) => vec![case.run()],
            Job::Touch(touch) => vec![touch.run()],
            Job::Strike(strike) => vec![strike.run()],
            Job::Footing(footing) => vec![footing.run()],
            Job::Long(long) => long.run(),
            Job::Study(study) => vec![study.run()],
            Job::Passage(passage) => vec![passage.run()],
        }
    }

    /// Run the job for instruction counts; return particles times steps.
    pub fn particle_steps(&self) -> f64 {
        let work = match self {
            Job::Touch(touch) => touch.work(),
            other => other.run().pop().unwrap_or_default().work,
        };
        (work.particles * work.steps) as f64
    }

    /// Scale the problem down to some hundred particles with the same scheme, for instruction counts.
    pub fn scaled(&self) -> Job {
        match *self {
            Job::Case(case) => {
                let (cells, courant) = match case.problem {
                    Problem::Vortex => (12, 0.2),
                    Problem::Ring => (4, 0.3),
                    Problem::Sod | Problem::SodBare => (50, 0.4),
                    _ => (12, 0.4),
                };
                Job::Case(Case { cells, courant, ..case })
            }
            Job::Smoothed(case) => {
                let (cells, courant) = match case.problem {
                    Problem::Vortex => (24, 0.2),
                    Problem::Ring => (8, 0.6),
                    Problem::Sod | Problem::SodBare => (100, 0.8),
                    _ => (24, 0.8),
                };
                Job::Smoothed(Case { cells, courant, ..case })
            }
            Job::Touch(touch) => Job::Touch(touch.scaled()),
            Job::Strike(strike) => Job::Strike(Strike { cells: 50, ..strike }),
            Job::Footing(footing) => Job::Footing(Footing { cells: 1, ..footing }),
            Job::Long(long) => Job::Long(Long { steps: 100, ..long }),
            Job::Study(study) => Job::Study(study.scaled()),
            Job::Passage(passage) => Job::Passage(gates::scaled(passage)),
        }
    }
}
