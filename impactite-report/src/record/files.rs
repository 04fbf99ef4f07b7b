//! Files that a run left.

use serde::{Deserialize, Serialize};

use crate::number::reals;

/// A history in a CSV file, as [`impactite_output::History`] writes them: `name [unit]` above each column, what it runs over first.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct HistoryRecord {
    /// What it shows.
    pub title: String,
    /// The file, relative to the folder of the run.
    pub file: String,
    /// Names of the columns that are drawn; empty for all.
    #[serde(default)]
    pub columns: Vec<String>,
}

impl HistoryRecord {
    /// The history `title` in `file`, with all of its columns.
    #[must_use]
    pub fn new(title: impl Into<String>, file: impl Into<String>) -> Self {
        HistoryRecord { title: title.into(), file: file.into(), columns: Vec::new() }
    }

    /// Draw these columns alone, by name.
    #[must_use]
    pub fn columns<T: Into<String>>(self, names: impl IntoIterator<Item = T>) -> Self {
        HistoryRecord { columns: names.into_iter().map(Into::into).collect(), ..self }
    }
}

/// A picture in a PNG, JPEG, WebP or SVG file.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct PictureRecord {
    /// The file, relative to the folder of the run.
    pub file: String,
    /// What it shows.
    pub caption: String,
}

/// PNG files of one size that make an animation.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Frames {
    /// The files, relative to the folder of the run, in order.
    pub files: Vec<String>,
    /// Simulated times of the frames, s; empty if not told.
    #[serde(default, with = "reals")]
    pub times: Vec<f64>,
    /// What they show.
    #[serde(default)]
    pub caption: String,
}

impl Frames {
    /// The pictures `name_000000.png`, ... that [`impactite_scene::observe::Pictures`] left in a folder named so, relative to the folder
    /// of the run (empty for that folder itself).
    #[must_use]
    pub fn series(folder: &str, name: &str, count: usize) -> Self {
        let folder = if folder.is_empty() { String::new() } else { format!("{folder}/") };
        let files = (0..count).map(|n| format!("{folder}{name}_{n:06}.png")).collect();
        Frames { files, ..Frames::default() }
    }

    /// What they show.
    #[must_use]
    pub fn caption(self, caption: impl Into<String>) -> Self {
        Frames { caption: caption.into(), ..self }
    }

    /// Their simulated times, s.
    #[must_use]
    pub fn times(self, times: impl IntoIterator<Item = f64>) -> Self {
        Frames { times: times.into_iter().collect(), ..self }
    }
}
