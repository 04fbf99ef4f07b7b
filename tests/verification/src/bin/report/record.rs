//! Runs as they are written down, one a line, so that a sweep can go on where it was stopped.

use std::fs::{File, OpenOptions};
use std::io::{self, BufRead, BufReader, Write};
use std::path::Path;

use serde::{Deserialize, Serialize};
use verification::{Case, Problem, Scheme};

/// One run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Record {
    /// Problem.
    pub problem: String,
    /// Scheme.
    pub scheme: String,
    /// Particles a cell and axis.
    pub per_axis: usize,
    /// Cells along the problem's length.
    pub cells: usize,
    /// Time step times wave speed over the cell.
    pub courant: f64,
    /// Particles.
    pub particles: u64,
    /// Steps made.
    pub steps: u64,
    /// Particle-steps times nodes a particle.
    pub units: f64,
    /// Core-seconds of the steps.
    pub core_seconds: f64,
    /// Errors by name; none of a run that failed.
    pub errors: Vec<(String, f64)>,
    /// What stopped it.
    pub failure: Option<String>,
    /// Commit of the program that made it.
    pub commit: String,
}

impl Record {
    /// Run a case.
    pub fn make(case: &Case, commit: &str) -> Self {
        let outcome = case.run();
        let broken = outcome.measures.iter().any(|m| !m.1.is_finite());
        let failure = outcome.failure.or_else(|| broken.then(|| "an error is not a number".to_string()));
        let kept = if failure.is_some() { Vec::new() } else { outcome.measures };
        Record {
            problem: case.problem.name().into(),
            scheme: case.scheme.name(),
            per_axis: case.per_axis,
            cells: case.cells,
            courant: case.courant,
            particles: outcome.work.particles,
            steps: outcome.work.steps,
            units: outcome.work.units(),
            core_seconds: outcome.work.seconds,
            errors: kept.into_iter().map(|(name, value)| (name.to_string(), value)).collect(),
            failure,
            commit: commit.into(),
        }
    }

    /// Is it a run of this case by the program of this commit?
    pub fn is_of(&self, case: &Case, commit: &str) -> bool {
        self.problem == case.problem.name()
            && self.scheme == case.scheme.name()
            && (self.per_axis, self.cells) == (case.per_axis, case.cells)
            && self.courant == case.courant
            && self.commit == commit
    }

    /// The case, if there still is such a one.
    pub fn case(&self) -> Option<Case> {
        Some(Case {
            problem: Problem::ALL.into_iter().find(|p| p.name() == self.problem)?,
            scheme: Scheme::named(&self.scheme)?,
            per_axis: self.per_axis,
            cells: self.cells,
            courant: self.courant,
        })
    }

    /// The size of an error, if the run did not fail.
    pub fn error(&self, name: &str) -> Option<f64> {
        let found = self.errors.iter().find(|e| e.0 == name).map(|e| e.1.abs());
        found.filter(|_| self.failure.is_none())
    }

    /// What it was run with, in words.
    pub fn settings(&self) -> String {
        format!("{} cells, {}² a cell, Courant {}", self.cells, self.per_axis, self.courant)
    }
}

/// Runs of before; a last line that was cut off is left out.
pub fn read(path: &Path) -> io::Result<Vec<Record>> {
    if !path.exists() {
        return Ok(Vec::new());
    }
    let mut list = Vec::new();
    for line in BufReader::new(File::open(path)?).lines() {
        if let Ok(record) = serde_json::from_str(&line?) {
            list.push(record);
        }
    }
    Ok(list)
}

/// Append a run.
pub fn append(path: &Path, record: &Record) -> io::Result<()> {
    let mut file = OpenOptions::new().create(true).append(true).open(path)?;
    writeln!(file, "{}", serde_json::to_string(record)?)
}

/// All runs as a table for others.
pub fn write_csv(path: &Path, records: &[Record]) -> io::Result<()> {
    let mut file = File::create(path)?;
    writeln!(
        file,
        "problem,scheme,particles a cell and axis,cells,Courant,particles,steps,particle-steps x nodes,core-seconds,error,value,failure"
    )?;
    for r in records {
        let head = format!(
            "{},{},{},{},{},{},{},{},{:.4}",
            r.problem,
            r.scheme,
            r.per_axis,
            r.cells,
            r.courant,
            r.particles,
            r.steps,
            r.units,
            r.core_seconds
        );
        if let Some(failure) = &r.failure {
            writeln!(file, "{head},,,\"{}\"", failure.replace('"', "'"))?;
        }
        for (name, value) in &r.errors {
            writeln!(file, "{head},{name},{value:.6e},")?;
        }
    }
    Ok(())
}
