//! What a run was made of, what it ran on, how far it came, and what it took.

use serde::{Deserialize, Serialize};

use crate::number::{maybe, real};

/// A setting of a run.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Setting {
    /// What it is.
    pub name: String,
    /// What was chosen, in words or numbers.
    pub value: String,
    /// Its unit; empty if it has none.
    #[serde(default)]
    pub unit: String,
}

/// A body at the time of the record.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct BodyRecord {
    /// Its name.
    pub name: String,
    /// Its constitutive law.
    pub material: String,
    /// Its points.
    pub points: usize,
    /// Mass, kg, of the part that is computed.
    #[serde(with = "real")]
    pub mass: f64,
    /// Width of its smallest point, m; NaN of a body without points.
    #[serde(with = "real")]
    pub smallest: f64,
    /// Speed of its fastest point, m/s; NaN of a body without points.
    #[serde(with = "real")]
    pub fastest: f64,
}

/// What a run ran on, and when.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct Machine {
    /// Programs and libraries, and their versions.
    #[serde(default)]
    pub versions: Vec<[String; 2]>,
    /// Processor architecture, and the vector instructions that it has.
    #[serde(default)]
    pub features: String,
    /// Threads; 0 if not told.
    #[serde(default)]
    pub threads: usize,
    /// When the run started, seconds since 1970 in universal time.
    #[serde(default)]
    pub started: Option<u64>,
    /// When it ended.
    #[serde(default)]
    pub ended: Option<u64>,
}

/// How far a run came. Times are s.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(tag = "state", rename_all = "snake_case")]
#[non_exhaustive]
pub enum Progress {
    /// Nobody said.
    #[default]
    Unknown,
    /// To its end.
    Finished {
        /// The end, if that is known.
        #[serde(default, with = "maybe")]
        time: Option<f64>,
    },
    /// An error stopped it.
    Stopped {
        /// Where, if that is known.
        #[serde(default, with = "maybe")]
        time: Option<f64>,
        /// What it said.
        error: String,
    },
    /// It was broken off, or goes on still.
    Interrupted {
        /// Where it stood when the record was made.
        #[serde(with = "real")]
        time: f64,
        /// Where it was to end.
        #[serde(with = "real")]
        end: f64,
    },
}

/// Where the time went, by the clock on the wall, s. What is `None` was not measured.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct Timing {
    /// Steps made.
    pub steps: u64,
    /// In steps.
    #[serde(default, with = "maybe")]
    pub stepping: Option<f64>,
    /// Between steps: observers, files, pictures, checkpoints.
    #[serde(default, with = "maybe")]
    pub observers: Option<f64>,
    /// Before the first step.
    #[serde(default, with = "maybe")]
    pub setup: Option<f64>,
    /// Point updates.
    pub updates: f64,
    /// Bytes of bodies and scratch.
    pub bytes: Option<usize>,
}

impl Timing {
    /// Point updates a second, if steps took time.
    #[must_use]
    pub fn rate(&self) -> Option<f64> {
        self.stepping.filter(|&seconds| seconds > 0.0).map(|seconds| self.updates / seconds)
    }
}

/// What limited the step, and how often.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Limit {
    /// What: a body with its waves and velocities, nodes of the grid, the growth allowed from one step to the next.
    pub cause: String,
    /// At how many looks of the [`Recorder`](crate::Recorder).
    pub looks: u64,
}
