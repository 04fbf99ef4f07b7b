//! Repeated runs in alternation.

use benchmarks::Stepped;
use examples::CaseError;
use examples::throughput::{Measured, Spread};

/// Result of a run.
pub trait Run {
    /// Rate, point updates per second.
    fn rate(&self) -> f64;
}

impl Run for Measured {
    fn rate(&self) -> f64 {
        self.particle_updates_per_second
    }
}

impl Run for Stepped {
    fn rate(&self) -> f64 {
        self.updates_per_second()
    }
}

/// Named run of a comparison.
pub struct Subject<'a, R = Measured> {
    /// Name in the table.
    pub name: String,
    run: Box<dyn Fn() -> Result<R, CaseError> + 'a>,
}

impl<'a, R> Subject<'a, R> {
    /// Create a subject of this name.
    pub fn new(name: impl Into<String>, run: impl Fn() -> Result<R, CaseError> + 'a) -> Self {
        Subject { name: name.into(), run: Box::new(run) }
    }
}

/// Runs of a subject.
pub struct Sample<R = Measured> {
    /// Name of the subject.
    pub name: String,
    /// Runs in the order of the rounds; none for a failed subject.
    pub runs: Vec<R>,
    /// Failure message.
    pub failure: Option<String>,
}

/// Run all subjects in turn for this number of rounds. Returns the first failure as an error.
pub fn alternate<R>(subjects: &[Subject<R>], rounds: usize) -> Result<Vec<Sample<R>>, CaseError> {
    let samples = attempt(subjects, rounds);
    match samples.iter().find_map(|s| s.failure.clone()) {
        Some(failure) => Err(CaseError::Other(failure)),
        None => Ok(samples),
    }
}

/// Run all subjects in turn for this number of rounds. A failed subject is not run again, and its sample has the
/// message.
pub fn attempt<R>(subjects: &[Subject<R>], rounds: usize) -> Vec<Sample<R>> {
    let empty = |s: &Subject<R>| Sample { name: s.name.clone(), runs: Vec::new(), failure: None };
    let mut samples: Vec<Sample<R>> = subjects.iter().map(empty).collect();
    for _ in 0..rounds {
        for (subject, sample) in subjects.iter().zip(&mut samples).filter(|(_, s)| s.failure.is_none()) {
            match (subject.run)() {
                Ok(run) => sample.runs.push(run),
                Err(error) => {
                    sample.runs.clear();
                    sample.failure = Some(error.to_string());
                }
            }
        }
    }
    samples
}

impl<R> Sample<R> {
    /// Spread of a quantity over the runs.
    pub fn spread(&self, of: impl Fn(&R) -> f64) -> Spread {
        Spread::of(self.runs.iter().map(of))
    }
    /// First run.
    pub fn first(&self) -> &R {
        &self.runs[0]
    }
}

impl<R: Run> Sample<R> {
    /// Rates, 10^6 updates per second.
    pub fn rates(&self) -> Spread {
        self.spread(|r| 1e-6 * r.rate())
    }
    /// Ratio of rates to another sample, round by round.
    pub fn over(&self, other: &Sample<R>) -> Spread {
        Spread::of(self.runs.iter().zip(&other.runs).map(|(a, b)| a.rate() / b.rate()))
    }
}
