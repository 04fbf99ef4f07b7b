//! Runs in alternation.

use benchmarks::Stepped;
use examples::CaseError;
use examples::throughput::{Measured, Spread};

/// What came of a run.
pub trait Run {
    /// Updates of points in a second.
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

/// What is run.
pub struct Subject<'a, R = Measured> {
    /// Its name in the table.
    pub name: String,
    run: Box<dyn Fn() -> Result<R, CaseError> + 'a>,
}

impl<'a, R> Subject<'a, R> {
    /// A subject of this name.
    pub fn new(name: impl Into<String>, run: impl Fn() -> Result<R, CaseError> + 'a) -> Self {
        Subject { name: name.into(), run: Box::new(run) }
    }
}

/// All runs of a subject.
pub struct Sample<R = Measured> {
    /// Its name.
    pub name: String,
    /// In the order of the rounds; none of a subject that failed.
    pub runs: Vec<R>,
    /// What stopped it.
    pub failure: Option<String>,
}

/// Run all subjects so many times, in turns. The first failure ends it.
pub fn alternate<R>(subjects: &[Subject<R>], rounds: usize) -> Result<Vec<Sample<R>>, CaseError> {
    let samples = attempt(subjects, rounds);
    match samples.iter().find_map(|s| s.failure.clone()) {
        Some(failure) => Err(CaseError::Other(failure)),
        None => Ok(samples),
    }
}

/// The same; a subject that fails is not run again, and its sample says why.
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
    /// A number of each run.
    pub fn spread(&self, of: impl Fn(&R) -> f64) -> Spread {
        Spread::of(self.runs.iter().map(of))
    }
    /// The first run.
    pub fn first(&self) -> &R {
        &self.runs[0]
    }
}

impl<R: Run> Sample<R> {
    /// Rates, 10^6 updates a second.
    pub fn rates(&self) -> Spread {
        self.spread(|r| 1e-6 * r.rate())
    }
    /// Rate over that of another one, round by round.
    pub fn over(&self, other: &Sample<R>) -> Spread {
        Spread::of(self.runs.iter().zip(&other.runs).map(|(a, b)| a.rate() / b.rate()))
    }
}
