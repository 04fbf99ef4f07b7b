//! What keeps a record or a page from being read or written.

use std::path::{Path, PathBuf};

use impactite_output::OutputError;

/// Why a record or a page could not be read or written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ReportError {
    /// A file or folder that cannot be written.
    #[error(transparent)]
    Output(#[from] OutputError),
    /// A file or folder that cannot be read.
    #[error("cannot read `{}`: {source}", path.display())]
    Read {
        /// Which.
        path: PathBuf,
        /// What the operating system said.
        source: std::io::Error,
    },
    /// A file that is not what its name says.
    #[error("`{}` cannot be used: {why}", path.display())]
    Damaged {
        /// Which.
        path: PathBuf,
        /// What is wrong with it.
        why: String,
    },
    /// A folder without a run.
    #[error("`{}` holds no run: it has neither `run.json` nor `result.json`", .0.display())]
    NoRun(PathBuf),
    /// A part of a record that cannot be.
    #[error("record: {field} = {value} is not allowed; it must be {allowed}")]
    Field {
        /// Which part.
        field: &'static str,
        /// What was given.
        value: String,
        /// What would have been allowed.
        allowed: &'static str,
    },
}

impl ReportError {
    /// For `map_err`: the operating system refused to read `path`.
    pub(crate) fn read(path: &Path) -> impl FnOnce(std::io::Error) -> Self {
        move |source| ReportError::Read { path: path.to_path_buf(), source }
    }

    /// A file that is not what its name says.
    pub(crate) fn damaged(path: &Path, why: impl ToString) -> Self {
        ReportError::Damaged { path: path.to_path_buf(), why: why.to_string() }
    }
}
