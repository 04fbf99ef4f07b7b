//! Stored runs, one per line, so that a stopped sweep can be resumed.

use std::fs::{File, OpenOptions};
use std::io::{self, BufRead, BufReader, Write};
use std::path::Path;

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use verification::Outcome;

use crate::job::{Job, Key};
use crate::long::Long;

/// Stored run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Record {
    /// Key of the run.
    #[serde(flatten)]
    pub key: Key,
    /// Particles.
    pub particles: u64,
    /// Number of steps.
    pub steps: u64,
    /// Particle-steps times nodes per particle.
    pub units: f64,
    /// Core-seconds of the steps.
    pub core_seconds: f64,
    /// Memory of the solver at the end including grid and scratch, bytes.
    pub bytes: u64,
    /// Errors by name; none for a failed run.
    pub errors: Vec<(String, f64)>,
    /// Failure message.
    pub failure: Option<String>,
    /// Commit of the program.
    pub commit: String,
    /// Instructions of the steps: those per particle and step of the scaled-down problem, times particles and
    /// steps.
    #[serde(skip)]
    pub instructions: Option<f64>,
}

impl Record {
    /// Create a record from the outcome of a run.
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

    /// Return true for a complete run of this job, by the program of this commit, if given.
    pub fn is_of(&self, job: &Job, commit: Option<&str>) -> bool {
        let ended = match job {
            Job::Long(Long { steps, .. }) => self.steps >= *steps || self.failure.is_some(),
            _ => true,
        };
        ended && commit.is_none_or(|commit| self.commit == commit) && self.key == job.key()
    }

    /// Return true if the record replaces an older one.
    fn replaces(&self, other: &Record) -> bool {
        self.key == other.key && (self.key.problem != Long::PROBLEM || self.steps == other.steps)
    }

    /// Absolute value of an error, if the run did not fail.
    pub fn error(&self, name: &str) -> Option<f64> {
        let found = self.errors.iter().find(|e| e.0 == name).map(|e| e.1.abs());
        found.filter(|_| self.failure.is_none())
    }

    /// Absolute value of a valid error: at most one, within round-off.
    pub fn answer(&self, name: &str) -> Option<f64> {
        self.error(name).filter(|e| *e <= 1.0 + 1e-6)
    }

    /// Scheme of the run.
    pub fn scheme(&self) -> &str {
        &self.key.scheme
    }

    /// Describe the settings of the run.
    pub fn settings(&self) -> String {
        let Key { per_axis, cells, courant, .. } = &self.key;
        format!("{cells} cells, {per_axis}² a cell, Courant {courant}")
    }

    /// Bytes per particle; none for a run without memory data.
    pub fn bytes_a_particle(&self) -> Option<f64> {
        (self.bytes > 0 && self.particles > 0).then(|| self.bytes as f64 / self.particles as f64)
    }
}

/// Read stored lines, without a truncated last line.
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

/// Read stored runs; the later one of the same job replaces the earlier one.
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

/// Write runs as a CSV table.
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
