//! Runs in alternation.

use examples::CaseError;
use examples::throughput::{Measured, Spread};

/// What is run.
pub struct Subject<'a> {
    /// Its name in the table.
    pub name: String,
    run: Box<dyn Fn() -> Result<Measured, CaseError> + 'a>,
}

impl<'a> Subject<'a> {
    /// A subject of this name.
    pub fn new(name: impl Into<String>, run: impl Fn() -> Result<Measured, CaseError> + 'a) -> Self {
        Subject { name: name.into(), run: Box::new(run) }
    }
}

/// All runs of a subject.
pub struct Sample {
    /// Its name.
    pub name: String,
    /// In the order of the rounds; none of a subject that failed.
    pub runs: Vec<Measured>,
    /// What stopped it.
    pub failure: Option<String>,
}

/// Run all subjects so many times, in turns. The first failure ends it.
pub fn alternate(subjects: &[Subject], rounds: usize) -> Result<Vec<Sample>, CaseError> {
    let samples = attempt(subjects, rounds);
    match samples.iter().find_map(|s| s.failure.clone()) {
        Some(failure) => Err(CaseError::Other(failure)),
        None => Ok(samples),
    }
}

/// The same; a subject that fails is not run again, and its sample says why.
pub fn attempt(subjects: &[Subject], rounds: usize) -> Vec<Sample> {
    let empty = |s: &Subject| Sample { name: s.name.clone(), runs: Vec::new(), failure: None };
    let mut samples: Vec<Sample> = subjects.iter().map(empty).collect();
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

impl Sample {
    /// A number of each run.
    pub fn spread(&self, of: impl Fn(&Measured) -> f64) -> Spread {
        Spread::of(self.runs.iter().map(of))
    }
    /// Rates, 10^6 updates a second.
    pub fn rates(&self) -> Spread {
        self.spread(|r| 1e-6 * r.particle_updates_per_second)
    }
    /// Rate over that of another one, round by round.
    pub fn over(&self, other: &Sample) -> Spread {
        let pairs = self.runs.iter().zip(&other.runs);
        Spread::of(pairs.map(|(a, b)| a.particle_updates_per_second / b.particle_updates_per_second))
    }
    /// The first run.
    pub fn first(&self) -> &Measured {
        &self.runs[0]
    }
}
