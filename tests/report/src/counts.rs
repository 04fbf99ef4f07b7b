//! Instructions per particle and step, counted by callgrind on a scaled-down problem: independent of machine load.

use std::path::Path;
use std::process::{Command, Stdio};

use serde::{Deserialize, Serialize};

use crate::job::{Job, Key};
use crate::record::Record;

/// Instruction count of a scheme.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Count {
    /// Problem.
    pub problem: String,
    /// Scheme.
    pub scheme: String,
    /// Particles per cell and axis.
    pub per_axis: usize,
    /// Instructions per particle and step; none if the scaled-down problem fails in its first step.
    pub instructions: Option<f64>,
    /// Number of counted particle-steps.
    pub particle_steps: f64,
    /// Commit of the program.
    pub commit: String,
}

/// Return true if callgrind is available.
pub fn possible() -> bool {
    Command::new("valgrind").arg("--version").stdout(Stdio::null()).stderr(Stdio::null()).status().is_ok()
}

/// Name pattern of the step function: unique in the call stack, since a nested match would end the count.
fn steps_of(job: &Job) -> &'static str {
    match job {
        Job::Passage(passage) if passage.way.per_axis() == 1 => "*step_at_most*",
        Job::Long(long) if long.is_smoothed() => "*step_at_most*",
        Job::Strike(_) => "*step_at_most*",
        Job::Smoothed(_) => "*smoothed_step*",
        _ => "*step_at_most_here*",
    }
}

impl Count {
    /// Return true if the count belongs to this job.
    pub fn is_of(&self, key: &Key) -> bool {
        (&self.problem, &self.scheme, self.per_axis) == (&key.problem, &key.scheme, key.per_axis)
    }

    /// Count instructions: run this program under callgrind, which collects in steps only.
    pub fn make(job: &Job, folder: &Path, commit: &str) -> Result<Count, Box<dyn std::error::Error>> {
        let key = job.scaled().key();
        let name = format!("{} {} {}", key.problem, key.scheme, key.per_axis);
        let file = folder.join(name.replace(|c: char| !c.is_ascii_alphanumeric(), "_"));
        let output = Command::new("valgrind")
            .args([
                "--tool=callgrind",
                "--collect-atstart=no",
                &format!("--toggle-collect={}", steps_of(job)),
            ])
            .arg(format!("--callgrind-out-file={}", file.display()))
            .arg(std::env::current_exe()?)
            .args(["--count", &serde_json::to_string(&key)?])
            .output()?;
        if !output.status.success() {
            return Err(format!("{name}: {}", String::from_utf8_lossy(&output.stderr)).into());
        }
        let particle_steps: f64 = String::from_utf8_lossy(&output.stdout).trim().parse()?;
        let text = std::fs::read_to_string(&file)?;
        std::fs::remove_file(&file)?;
        let total = text.lines().find_map(|l| l.strip_prefix("summary: ").or(l.strip_prefix("totals: ")));
        let total: f64 = total.ok_or("callgrind wrote no total")?.trim().parse()?;
        let instructions = (particle_steps > 0.0 && total > 0.0).then(|| total / particle_steps);
        let Key { problem, scheme, per_axis, .. } = key;
        Ok(Count { problem, scheme, per_axis, instructions, particle_steps, commit: commit.into() })
    }
}

/// Set the instructions of every run from the latest count of its scheme.
pub fn attach(records: &mut [Record], counts: &[Count]) {
    for record in records {
        let count = counts.iter().rev().find(|c| c.is_of(&record.key));
        let each = count.and_then(|c| c.instructions);
        record.instructions = each.map(|each| each * (record.particles * record.steps) as f64);
    }
}
