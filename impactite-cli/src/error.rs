//! Errors of running a scene file.

use std::path::PathBuf;

use impactite::observe::ObserveError;
use impactite::output::OutputError;
use impactite::scene::{CheckpointError, RunError};
use impactite_input::InputError;
use impactite_input::measured::MeasureError;
use impactite_report::ReportError;

/// Error of running a scene file.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CliError {
    /// Invalid scene file.
    #[error(transparent)]
    Input(#[from] InputError),
    /// Failed run.
    #[error(transparent)]
    Run(#[from] RunError),
    /// Failed observer.
    #[error(transparent)]
    Observe(#[from] ObserveError),
    /// Picture or file of numbers that cannot be written.
    #[error(transparent)]
    Output(#[from] OutputError),
    /// Invalid measure.
    #[error(transparent)]
    Measure(#[from] MeasureError),
    /// Report page that cannot be written.
    #[error(transparent)]
    Report(#[from] ReportError),
    /// Checkpoint that cannot be resumed from.
    #[error("cannot resume from `{}`: {source}", path.display())]
    Resume {
        /// Path of the checkpoint.
        path: PathBuf,
        /// Cause.
        source: CheckpointError,
    },
    /// File or folder error of the operating system.
    #[error("`{}`: {source}", path.display())]
    File {
        /// Path of the file or folder.
        path: PathBuf,
        /// Error of the operating system.
        source: std::io::Error,
    },
    /// Folder locked by another run.
    #[error("another run{} writes into `{}`; choose another folder with --out", if process.is_empty() { String::new() } else { format!(" (process {process})") }, path.display())]
    Locked {
        /// The folder.
        path: PathBuf,
        /// Process number; empty if unknown.
        process: String,
    },
    /// Folder without a run to resume.
    #[error("nothing to resume in `{}`: {why}", path.display())]
    NoResume {
        /// The folder.
        path: PathBuf,
        /// Reason.
        why: String,
    },
    /// Invalid command-line option.
    #[error("{option}: {why}")]
    Option {
        /// The option.
        option: String,
        /// Reason.
        why: String,
    },
}

impl CliError {
    /// True if the output was written to a closed pipe.
    #[must_use]
    pub fn is_closed_pipe(&self) -> bool {
        matches!(self, CliError::File { source, .. } if source.kind() == std::io::ErrorKind::BrokenPipe)
    }
    /// True if the scene or its run is the cause, so that the same run fails again; false for files, folders and options.
    #[must_use]
    pub fn is_of_the_scene(&self) -> bool {
        matches!(self, CliError::Input(_) | CliError::Measure(_) | CliError::Run(RunError::Step(_)))
    }
    /// Convert an error of the operating system to [`CliError::File`] with its path.
    pub fn file(path: impl Into<PathBuf>) -> impl FnOnce(std::io::Error) -> CliError {
        let path = path.into();
        |source| CliError::File { path, source }
    }
    pub(crate) fn option(option: impl Into<String>, why: impl Into<String>) -> CliError {
        CliError::Option { option: option.into(), why: why.into() }
    }
}
