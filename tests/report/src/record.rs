//! Runs as they are written down, one a line, so that a sweep can go on where it was stopped.

use std::fs::{File, OpenOptions};
use std::io::{self, BufRead, BufReader, Write};
use std::path::Path;

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use verification::Outcome;

use crate::job::{Job, Key};
use crate::long::Long;

/// One run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Record {
    /// What it was.
    #[serde(flatten)]
    pub key: Key,
    /// Particles.
    pub particles: u64,
    /// Steps made.
    pub steps: u64,
    /// Particle-steps times nodes a particle.
    pub units: f64,
    /// Core-seconds of the steps.
    pub core_seconds: f64,
    /// Memory of the solver at the end, grid and scratch included, bytes.
    pub bytes: u64,
    /// Errors by name; none of a run that failed.
    pub errors: Vec<(String, f64)>,
    /// What stopped it.
    pub failure: Option<String>,
    /// Commit of the program that made it.
    pub commit: String,
    /// Instructions of the steps: those a particle and step of the problem scaled down, times particles and steps.
    #[serde(skip)]
    pub instructions: Option<f64>,
}

impl Record {
    /// From what came of a run.
    pub fn new(key: Key, outcome: Outcome, commit: &str) -> Self {
        let broken = outcome.measures.iter().any(|m| !m.1.is_finite());
        let failure = outcome.failure.or_else(|| broken.then(|| "an error is not a number".to_string()));
        let kept = if failure.is_some() { Vec::new() } else { outcome.measures };
        Record {
            key,
            particles: outcome.work.particles,
            steps: outcome.work.steps,
            units: outcome.work.units(),
            core_seconds: outcome.work.seconds,
            bytes: outcome.work.bytes,
            errors: kept.into_iter().map(|(name, value)| (name.to_string(), value)).collect(),
            failure,
            commit: commit.into(),
            instructions: None,
        }
    }

    /// Is it a run of this job, to its end, by the program of this commit, if one is asked for?
    pub fn is_of(&self, job: &Job, commit: Option<&str>) -> bool {
        let ended = match job {
            Job::Long(Long { steps, .. }) => self.steps >= *steps || self.failure.is_some(),
            _ => true,
        };
        ended && commit.is_none_or(|commit| self.commit == commit) && self.key == job.key()
    }

    /// Does it stand in the place of an older one?
    fn replaces(&self, other: &Record) -> bool {
        self.key == other.key && (self.key.problem != Long::PROBLEM || self.steps == other.steps)
    }

    /// The size of an error, if the run did not fail.
    pub fn error(&self, name: &str) -> Option<f64> {
        let found = self.errors.iter().find(|e| e.0 == name).map(|e| e.1.abs());
        found.filter(|_| self.failure.is_none())
    }

    /// The size of an error that is an answer: errors above one, but for rounding, are none.
    pub fn answer(&self, name: &str) -> Option<f64> {
        self.error(name).filter(|e| *e <= 1.0 + 1e-6)
    }

    /// Its scheme.
    pub fn scheme(&self) -> &str {
        &self.key.scheme
    }

    /// What it was run with, in words.
    pub fn settings(&self) -> String {
        let Key { per_axis, cells, courant, .. } = &self.key;
        format!("{cells} cells, {per_axis}² a cell, Courant {courant}")
    }

    /// Bytes a particle; none of a run that did not say.
    pub fn bytes_a_particle(&self) -> Option<f64> {
        (self.bytes > 0 && self.particles > 0).then(|| self.bytes as f64 / self.particles as f64)
    }
}

/// Lines of before; a last line that was cut off is left out.
pub fn lines<T: DeserializeOwned>(path: &Path) -> io::Result<Vec<T>> {
    if !path.exists() {
        return Ok(Vec::new());
    }
    let mut list = Vec::new();
    for line in BufReader::new(File::open(path)?).lines() {
        if let Ok(found) = serde_json::from_str(&line?) {
            list.push(found);
        }
    }
    Ok(list)
}

/// Runs of before, of two of the same job the younger.
pub fn read(path: &Path) -> io::Result<Vec<Record>> {
    let mut list: Vec<Record> = Vec::new();
    for record in lines::<Record>(path)? {
        match list.iter().position(|r| record.replaces(r)) {
            Some(at) => list[at] = record,
            None => list.push(record),
        }
    }
    Ok(list)
}

/// Append lines, all of them or, if the program is stopped before, none.
pub fn append<T: Serialize>(path: &Path, list: &[T]) -> io::Result<()> {
    let mut text = String::new();
    for item in list {
        text.push_str(&serde_json::to_string(item)?);
        text.push('\n');
    }
    OpenOptions::new().create(true).append(true).open(path)?.write_all(text.as_bytes())
}

/// Runs as a table for others.
pub fn write_csv<'a>(path: &Path, records: impl Iterator<Item = &'a Record>) -> io::Result<()> {
    let mut text = String::from(
        "problem,scheme,particles a cell and axis,cells,Courant,particles,steps,particle-steps x nodes,\
         instructions,core-seconds,bytes a particle,error,value,failure\n",
    );
    let or_none = |x: Option<f64>| x.map_or(String::new(), |x| format!("{x:.4e}"));
    for r in records {
        let Key { problem, scheme, per_axis, cells, courant } = &r.key;
        let head = format!(
            "{problem},\"{scheme}\",{per_axis},{cells},{courant},{},{},{},{},{:.4},{}",
            r.particles,
            r.steps,
            r.units,
            or_none(r.instructions),
            r.core_seconds,
            or_none(r.bytes_a_particle())
        );
        if let Some(failure) = &r.failure {
            text.push_str(&format!("{head},,,\"{}\"\n", failure.replace('"', "'")));
        }
        for (name, value) in &r.errors {
            text.push_str(&format!("{head},{name},{value:.6e},\n"));
        }
    }
    std::fs::write(path, text)
}
