//! Why a scene could not be run.

use std::path::PathBuf;

use impactite::observe::ObserveError;
use impactite::output::OutputError;
use impactite::scene::{CheckpointError, RunError};
use impactite_input::InputError;
use impactite_input::measured::MeasureError;
use impactite_report::ReportError;

/// Why a scene could not be run.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CliError {
    /// The file.
    #[error(transparent)]
    Input(#[from] InputError),
    /// The run.
    #[error(transparent)]
    Run(#[from] RunError),
    /// An observer.
    #[error(transparent)]
    Observe(#[from] ObserveError),
    /// A picture or a file of numbers.
    #[error(transparent)]
    Output(#[from] OutputError),
    /// A measure.
    #[error(transparent)]
    Measure(#[from] MeasureError),
    /// The page.
    #[error(transparent)]
    Report(#[from] ReportError),
    /// A checkpoint that cannot be resumed from.
    #[error("cannot resume from `{}`: {source}", path.display())]
    Resume {
        /// The checkpoint.
        path: PathBuf,
        /// Why.
        source: CheckpointError,
    },
    /// A file or folder.
    #[error("`{}`: {source}", path.display())]
    File {
        /// Which.
        path: PathBuf,
        /// What the operating system said.
        source: std::io::Error,
    },
    /// A folder that another run writes into.
    #[error("another run{} writes into `{}`; choose another folder with --out", if process.is_empty() { String::new() } else { format!(" (process {process})") }, path.display())]
    Locked {
        /// The folder.
        path: PathBuf,
        /// The number of its process, where that is known.
        process: String,
    },
    /// A folder without anything to resume.
    #[error("nothing to resume in `{}`: {why}", path.display())]
    NoResume {
        /// The folder.
        path: PathBuf,
        /// Why.
        why: String,
    },
    /// An option.
    #[error("{option}: {why}")]
    Option {
        /// The option.
        option: String,
        /// What is wrong with it.
        why: String,
    },
}

impl CliError {
    /// Was it written to a pipe that nobody reads any more?
    #[must_use]
    pub fn is_closed_pipe(&self) -> bool {
        matches!(self, CliError::File { source, .. } if source.kind() == std::io::ErrorKind::BrokenPipe)
    }
    /// Is the scene or its run the cause, so that the same run fails again? Files, folders and options are not.
    #[must_use]
    pub fn is_of_the_scene(&self) -> bool {
        matches!(self, CliError::Input(_) | CliError::Measure(_) | CliError::Run(RunError::Step(_)))
    }
    /// A file or folder, of an error of the operating system.
    pub fn file(path: impl Into<PathBuf>) -> impl FnOnce(std::io::Error) -> CliError {
        let path = path.into();
        |source| CliError::File { path, source }
    }
    pub(crate) fn option(option: impl Into<String>, why: impl Into<String>) -> CliError {
        CliError::Option { option: option.into(), why: why.into() }
    }
}
