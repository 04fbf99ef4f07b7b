//! Verification case: problem, scheme and resolution, with its outcome.

use crate::formulation::Formulation;
use crate::problems::{axis_aligned, bar, column, gas, rigid, ring, vortex};
use crate::scene::Ended;
use crate::scheme::Scheme;
use crate::work::Work;

/// Verification problem.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Problem {
    /// V1: period of an elastic bar.
    Bar,
    /// V2: energy of a drifting bar.
    Drift,
    /// V3 in two dimensions.
    Axes,
    /// V3 in three dimensions.
    Axes3,
    /// V4: generalised vortex.
    Vortex,
    /// V5: expanding ring.
    Ring,
    /// V6: rigid translation.
    Flight,
    /// V6: rigid rotation.
    Turn,
    /// V7: velocity pulse in a bar.
    Pulse,
    /// V13: Sod's shock tube, with bulk viscosity.
    Sod,
    /// V13: Sod's shock tube, without bulk viscosity.
    SodBare,
    /// V14: column under its own weight.
    Column,
    /// V22: Taylor-Green vortices.
    TaylorGreen,
}

impl Problem {
    /// All problems.
    pub const ALL: [Problem; 13] = [
        Problem::Bar,
        Problem::Drift,
        Problem::Axes,
        Problem::Axes3,
        Problem::Vortex,
        Problem::Ring,
        Problem::Flight,
        Problem::Turn,
        Problem::Pulse,
        Problem::Sod,
        Problem::SodBare,
        Problem::Column,
        Problem::TaylorGreen,
    ];
    /// Name in files.
    pub fn name(self) -> &'static str {
        match self {
            Problem::Bar => "V1 bar",
            Problem::Drift => "V2 drift",
            Problem::Axes => "V3 axes",
            Problem::Axes3 => "V3 axes 3D",
            Problem::Vortex => "V4 vortex",
            Problem::Ring => "V5 ring",
            Problem::Flight => "V6 flight",
            Problem::Turn => "V6 turn",
            Problem::Pulse => "V7 pulse",
            Problem::Sod => "V13 Sod",
            Problem::SodBare => "V13 Sod bare",
            Problem::Column => "V14 column",
            Problem::TaylorGreen => "V22 Taylor-Green",
        }
    }
}

/// Problem, scheme (of the material point method, or another [`Formulation`]) and resolution.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Case<S = Scheme> {
    /// Verification problem.
    pub problem: Problem,
    /// Numerical scheme.
    pub scheme: S,
    /// Particles per cell and axis.
    pub per_axis: usize,
    /// Number of cells along the problem's length.
    pub cells: usize,
    /// Courant number: time step times the wave speed at rest over the cell size.
    pub courant: f64,
}

/// Errors and work of a run.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Outcome {
    /// Errors and other measures by name.
    pub measures: Vec<(&'static str, f64)>,
    /// Work of the run.
    pub work: Work,
    /// Failure message of a stopped run.
    pub failure: Option<String>,
}

impl Outcome {
    /// Create an outcome without measures of a run with `nodes` nodes or neighbours per particle; a failure if the scheme
    /// is not compiled.
    pub(crate) fn of(nodes: u64, ended: Option<Ended>) -> Self {
        let (mut work, failure) = ended.unwrap_or((Work::default(), Some("no such composition".into())));
        work.nodes = nodes;
        Outcome { measures: Vec::new(), work, failure }
    }
    /// Create the outcome of a case whose setup failed.
    pub(crate) fn refused(why: String) -> Self {
        Outcome { failure: Some(why), ..Outcome::default() }
    }
    /// Add a measure.
    pub(crate) fn with(mut self, name: &'static str, value: f64) -> Self {
        self.measures.push((name, value));
        self
    }
    /// Return a measure by name; NaN if it is missing or the run failed.
    pub fn get(&self, name: &str) -> f64 {
        if self.failure.is_some() {
            return f64::NAN;
        }
        self.measures.iter().find(|m| m.0 == name).map_or(f64::NAN, |m| m.1)
    }
}

impl<S: Formulation> Case<S> {
    /// Run the case.
    pub fn run(&self) -> Outcome {
        S::run(self)
    }
    /// Run the scene of the problem.
    pub(crate) fn by_problem(&self) -> Outcome {
        let made = match self.problem {
            Problem::Bar => bar::period(self),
            Problem::Drift => bar::drift(self),
            Problem::Axes => axis_aligned::plane(self),
            Problem::Axes3 => axis_aligned::solid(self),
            Problem::Vortex => vortex::run(self),
            Problem::Ring => ring::run(self),
            Problem::Flight => rigid::flight(self),
            Problem::Turn => rigid::turn(self),
            Problem::Pulse => bar::pulse(self),
            Problem::Sod => gas::sod(self, true),
            Problem::SodBare => gas::sod(self, false),
            Problem::Column => column::run(self),
            Problem::TaylorGreen => gas::taylor_green(self),
        };
        made.unwrap_or_else(Outcome::refused)
    }
    /// Name of the case.
    pub fn name(&self) -> String {
        format!(
            "{}, {}, {} a cell and axis, {} cells, Courant {}",
            self.problem.name(),
            self.scheme.name(),
            self.per_axis,
            self.cells,
            self.courant
        )
    }
}
