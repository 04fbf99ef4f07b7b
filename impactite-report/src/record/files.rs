//! Output files of a run.

use serde::{Deserialize, Serialize};

use crate::number::reals;

/// History in a CSV file written by [`impactite_output::History`]: header `name [unit]` for each column, the abscissa first.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct HistoryRecord {
    /// Title of the history.
    pub title: String,
    /// Path of the file, relative to the folder of the run.
    pub file: String,
    /// Names of the columns to draw; empty for all.
    #[serde(default)]
    pub columns: Vec<String>,
}

impl HistoryRecord {
    /// Create the history `title` in `file`, with all of its columns.
    #[must_use]
    pub fn new(title: impl Into<String>, file: impl Into<String>) -> Self {
        HistoryRecord { title: title.into(), file: file.into(), columns: Vec::new() }
    }

    /// Draw only these columns, by name.
    #[must_use]
    pub fn columns<T: Into<String>>(self, names: impl IntoIterator<Item = T>) -> Self {
        HistoryRecord { columns: names.into_iter().map(Into::into).collect(), ..self }
    }
}

/// Picture in a PNG, JPEG, WebP or SVG file.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct PictureRecord {
    /// Path of the file, relative to the folder of the run.
    pub file: String,
    /// Caption of the picture.
    pub caption: String,
}

/// Frames of an animation: PNG files of equal size.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Frames {
    /// Paths of the files, relative to the folder of the run, in order.
    pub files: Vec<String>,
    /// Simulated times of the frames, s; empty if unknown.
    #[serde(default, with = "reals")]
    pub times: Vec<f64>,
    /// Caption of the animation.
    #[serde(default)]
    pub caption: String,
}

impl Frames {
    /// Create the frames `name_000000.png`, ... that [`impactite_scene::observe::Pictures`] wrote to `folder`, relative to the folder
    /// of the run (empty for that folder itself).
    #[must_use]
    pub fn series(folder: &str, name: &str, count: usize) -> Self {
        let folder = if folder.is_empty() { String::new() } else { format!("{folder}/") };
        let files = (0..count).map(|n| format!("{folder}{name}_{n:06}.png")).collect();
        Frames { files, ..Frames::default() }
    }

    /// Set the caption.
    #[must_use]
    pub fn caption(self, caption: impl Into<String>) -> Self {
        Frames { caption: caption.into(), ..self }
    }

    /// Set the simulated times, s.
    #[must_use]
    pub fn times(self, times: impl IntoIterator<Item = f64>) -> Self {
        Frames { times: times.into_iter().collect(), ..self }
    }
}
