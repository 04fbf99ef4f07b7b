//! A case: problem, scheme, resolution; and what comes of it.

use crate::formulation::Formulation;
use crate::problems::{axis_aligned, bar, column, gas, rigid, ring, vortex};
use crate::scene::Ended;
use crate::scheme::Scheme;
use crate::work::Work;

/// What is solved.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Problem {
    /// V1: period of an elastic bar.
    Bar,
    /// V2: energy of a drifting bar.
    Drift,
    /// V3 in the plane.
    Axes,
    /// V3 in space.
    Axes3,
    /// V4.
    Vortex,
    /// V5.
    Ring,
    /// V6: flight.
    Flight,
    /// V6: turn.
    Turn,
    /// V7: a pulse in a bar.
    Pulse,
    /// V13: Sod's tube, with bulk viscosity.
    Sod,
    /// V13: the same without.
    SodBare,
    /// V14.
    Column,
    /// V22: Taylor-Green vortices.
    TaylorGreen,
}

impl Problem {
    /// All.
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
    /// Its name in files.
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

/// A problem, a scheme (of material points, or another [`Formulation`]) and a resolution.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Case<S = Scheme> {
    /// The problem.
    pub problem: Problem,
    /// The scheme.
    pub scheme: S,
    /// Particles a cell and axis.
    pub per_axis: usize,
    /// Cells along the problem's length.
    pub cells: usize,
    /// Time step times the wave speed at rest over the cell.
    pub courant: f64,
}

/// Errors of a run, and its work.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Outcome {
    /// Errors and other measures by name.
    pub measures: Vec<(&'static str, f64)>,
    /// Work.
    pub work: Work,
    /// What stopped the run, if something did.
    pub failure: Option<String>,
}

impl Outcome {
    /// Without measures yet, of a run by what has so many nodes or neighbours a particle; none of one that is not compiled.
    pub(crate) fn of(nodes: u64, ended: Option<Ended>) -> Self {
        let (mut work, failure) = ended.unwrap_or((Work::default(), Some("no such composition".into())));
        work.nodes = nodes;
        Outcome { measures: Vec::new(), work, failure }
    }
    /// A case that could not be set up.
    pub(crate) fn refused(why: String) -> Self {
        Outcome { failure: Some(why), ..Outcome::default() }
    }
    /// With a measure.
    pub(crate) fn with(mut self, name: &'static str, value: f64) -> Self {
        self.measures.push((name, value));
        self
    }
    /// A measure by name; not a number where there is none or the run failed.
    pub fn get(&self, name: &str) -> f64 {
        if self.failure.is_some() {
            return f64::NAN;
        }
        self.measures.iter().find(|m| m.0 == name).map_or(f64::NAN, |m| m.1)
    }
}

impl<S: Formulation> Case<S> {
    /// Run it.
    pub fn run(&self) -> Outcome {
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
    /// Its name.
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
