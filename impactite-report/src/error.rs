//! Errors of records and pages.

use std::path::{Path, PathBuf};

use impactite_output::OutputError;

/// Error of reading or writing a record or a page.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ReportError {
    /// File or folder that cannot be written.
    #[error(transparent)]
    Output(#[from] OutputError),
    /// File or folder that cannot be read.
    #[error("cannot read `{}`: {source}", path.display())]
    Read {
        /// Path of the file or folder.
        path: PathBuf,
        /// Error of the operating system.
        source: std::io::Error,
    },
    /// Invalid content of a file.
    #[error("`{}` cannot be used: {why}", path.display())]
    Damaged {
        /// Path of the file.
        path: PathBuf,
        /// Description of the error.
        why: String,
    },
    /// Folder without a run.
    #[error("`{}` holds no run: it has neither `run.json` nor `result.json`", .0.display())]
    NoRun(PathBuf),
    /// Invalid field of a record.
    #[error("record: {field} = {value} is not allowed; it must be {allowed}")]
    Field {
        /// Name of the field.
        field: &'static str,
        /// Value.
        value: String,
        /// Allowed values.
        allowed: &'static str,
    },
}

impl ReportError {
    /// Create an error of reading `path`, for `map_err`.
    pub(crate) fn read(path: &Path) -> impl FnOnce(std::io::Error) -> Self {
        move |source| ReportError::Read { path: path.to_path_buf(), source }
    }

    /// Create an error of invalid content of a file.
    pub(crate) fn damaged(path: &Path, why: impl ToString) -> Self {
        ReportError::Damaged { path: path.to_path_buf(), why: why.to_string() }
    }
}
