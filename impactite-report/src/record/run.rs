//! Settings, bodies, machine, progress and timing of a run.

use serde::{Deserialize, Serialize};

use crate::number::{maybe, real};

/// Setting of a run.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Setting {
    /// Name of the setting.
    pub name: String,
    /// Value, in words or numbers.
    pub value: String,
    /// Unit; empty if it has none.
    #[serde(default)]
    pub unit: String,
}

/// State of a body at the time of the record.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct BodyRecord {
    /// Name of the body.
    pub name: String,
    /// Name of the constitutive law.
    pub material: String,
    /// Number of points.
    pub points: usize,
    /// Mass of the modelled part, kg.
    #[serde(with = "real")]
    pub mass: f64,
    /// Width of the smallest point, m; NaN for a body without points.
    #[serde(with = "real")]
    pub smallest: f64,
    /// Speed of the fastest point, m/s; NaN for a body without points.
    #[serde(with = "real")]
    pub fastest: f64,
}

/// Machine, versions and date of a run.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct Machine {
    /// Names and versions of programs and libraries.
    #[serde(default)]
    pub versions: Vec<[String; 2]>,
    /// Processor architecture and its vector instructions.
    #[serde(default)]
    pub features: String,
    /// Number of threads; 0 if unknown.
    #[serde(default)]
    pub threads: usize,
    /// Start of the run, seconds since 1970 in universal time.
    #[serde(default)]
    pub started: Option<u64>,
    /// End of the run, seconds since 1970 in universal time.
    #[serde(default)]
    pub ended: Option<u64>,
}

/// Progress of a run. Times in s.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(tag = "state", rename_all = "snake_case")]
#[non_exhaustive]
pub enum Progress {
    /// Unknown progress.
    #[default]
    Unknown,
    /// The run reached its end.
    Finished {
        /// End time, if known.
        #[serde(default, with = "maybe")]
        time: Option<f64>,
    },
    /// The run was stopped by an error.
    Stopped {
        /// Time of the error, if known.
        #[serde(default, with = "maybe")]
        time: Option<f64>,
        /// Message of the error.
        error: String,
    },
    /// The run was interrupted, or is still running.
    Interrupted {
        /// Time when the record was saved.
        #[serde(with = "real")]
        time: f64,
        /// Intended end time.
        #[serde(with = "real")]
        end: f64,
    },
}

/// Wall-clock times, s. `None` was not measured.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct Timing {
    /// Number of steps.
    pub steps: u64,
    /// Time in steps.
    #[serde(default, with = "maybe")]
    pub stepping: Option<f64>,
    /// Time between steps: observers, files, pictures, checkpoints.
    #[serde(default, with = "maybe")]
    pub observers: Option<f64>,
    /// Time before the first step.
    #[serde(default, with = "maybe")]
    pub setup: Option<f64>,
    /// Times of stages of the steps, by name, if the method measures them.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub stages: Vec<(String, f64)>,
    /// Number of point updates.
    pub updates: f64,
    /// Memory of bodies and scratch, bytes.
    pub bytes: Option<usize>,
}

impl Timing {
    /// Point updates per second, if the time in steps is positive.
    #[must_use]
    pub fn rate(&self) -> Option<f64> {
        self.stepping.filter(|&seconds| seconds > 0.0).map(|seconds| self.updates / seconds)
    }
}

/// Cause of the time step limit, and its frequency.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Limit {
    /// Cause: waves and velocities of a body, nodes of the grid, growth limit from one step to the next.
    pub cause: String,
    /// Number of looks of the [`Recorder`](crate::Recorder) with this cause.
    pub looks: u64,
}
