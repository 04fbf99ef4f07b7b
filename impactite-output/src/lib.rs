//! Output of a run: pictures, ParaView files and histories.
//!
//! All writers use a [`Snapshot`] (or plain columns of numbers) and are independent of solvers, so that
//! any particle method can use them:
//!
//! | module | writes | read by |
//! |---|---|---|
//! | [`vtk`] | a `.vtp` (elements: `.vtu`) per frame and a `.pvd` series; with the feature `hdf5` `.vtkhdf` | ParaView, VisIt, PyVista |
//! | [`csv`] | histories, one row per output time | any program |
//! | [`picture`] | shaded particles, flat fields, line charts and panels of them as PNG | people |
//! | [`progress`] | progress bar on the terminal | people |
//!
//! Files are replaced atomically: a path refers to the complete old file or the complete new one, however many processes write there
//! and whatever terminates them ([`WholeFile`]).
//!
//! All numbers are SI; pictures and tables convert for display only, through [`picture::Quantity`] or an
//! [`picture::Axis`] that names its unit. Invalid input causes an [`OutputError`] with the field,
//! its value and the allowed values.

use std::path::{Path, PathBuf};

mod cells;
pub mod csv;
pub mod picture;
mod printable;
pub mod progress;
mod snapshot;
pub mod vtk;
mod whole;

pub use cells::Cells;
pub use csv::{Column, History};
pub use printable::printable;
pub use progress::Progress;
pub(crate) use snapshot::{FARTHEST, is_place};
pub use snapshot::{FieldKind, FieldValues, ParticleSize, Snapshot};
pub use vtk::{Format, Precision, VtkOptions, VtkSeries};
pub use whole::{WholeFile, remove_parts, write_whole};

/// Error of a picture or a file.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum OutputError {
    /// File operation that failed: create, write, flush or rename.
    #[error("cannot {action} `{}`: {source}", path.display())]
    File {
        /// Attempted operation: "look at", "follow", "create", "write", "rename to", "remove", "open".
        action: &'static str,
        /// Path of the file or folder.
        path: PathBuf,
        /// Error of the operating system.
        source: std::io::Error,
    },
    /// Error of an earlier job on a writer thread.
    #[error(transparent)]
    Earlier(std::sync::Arc<OutputError>),
    /// Writer thread that ended by a panic.
    #[error(
        "the thread that draws pictures and writes frames has ended; what it was given since is not there"
    )]
    Ended,
    /// Path that is no regular file.
    #[error("cannot write `{}`: it is {found}, which is not allowed; it must be a regular file, a link to one, or free", path.display())]
    NoFile {
        /// Path of the file.
        path: PathBuf,
        /// Type of the existing object.
        found: &'static str,
    },
    /// Error of the PNG encoder.
    #[error("cannot encode `{}` as PNG: {source}", path.display())]
    Png {
        /// Path of the picture.
        path: PathBuf,
        /// Error of the encoder.
        source: png::EncodingError,
    },
    /// Error of the HDF5 encoder.
    #[cfg(feature = "hdf5")]
    #[error("cannot encode `{}` as HDF5: {source}", path.display())]
    Hdf {
        /// Path of the file.
        path: PathBuf,
        /// Error of the encoder.
        source: Box<dyn std::error::Error + Send + Sync>,
    },
    /// Column of a wrong length: one value per particle, point or column is required.
    #[error("{what} has {found} values, expected {expected}")]
    Length {
        /// Name of the column.
        what: String,
        /// Length of the column.
        found: usize,
        /// Required length.
        expected: usize,
    },
    /// Invalid name: empty, used twice or with a forbidden character.
    #[error("name {name:?} of {what} is not allowed: {why}")]
    Name {
        /// Named object.
        what: &'static str,
        /// Name.
        name: String,
        /// Requirement that the name violates.
        why: &'static str,
    },
    /// Field that the snapshot does not contain.
    #[error("no {kind} field {name:?} in the snapshot; it has {available}")]
    NoSuchField {
        /// Kind of the field: "scalar", "vector", "tensor", or "colour" for any quantity that can be shown in colour.
        kind: &'static str,
        /// Requested name.
        name: String,
        /// Available names of that kind.
        available: String,
    },
    /// Memory above the limit, or failed allocation.
    #[error(transparent)]
    Memory(#[from] impactite_simd::memory::MemoryError),
    /// Value outside its allowed range.
    #[error("{what} = {value} is not allowed: {allowed}")]
    Value {
        /// Name of the quantity.
        what: String,
        /// Value.
        value: String,
        /// Allowed values.
        allowed: &'static str,
    },
}

impl OutputError {
    /// Create an error of a value outside its allowed range.
    pub(crate) fn value(what: impl Into<String>, value: impl ToString, allowed: &'static str) -> Self {
        Self::Value { what: what.into(), value: value.to_string(), allowed }
    }

    /// Create an error of a file operation `action` on `path`, for `map_err`.
    pub fn file(action: &'static str, path: &Path) -> impl FnOnce(std::io::Error) -> Self {
        move |source| Self::File { action, path: path.to_path_buf(), source }
    }
}

/// Check a name for use in a file: not empty, no control characters, no surrounding blanks.
///
/// # Errors
/// [`OutputError::Name`] with the violated requirement.
pub fn check_name(what: &'static str, name: &str) -> Result<(), OutputError> {
    let refuse = |why| Err(OutputError::Name { what, name: name.to_string(), why });
    if name.trim().is_empty() {
        refuse("it must not be empty")
    } else if name.trim() != name {
        refuse("it must not begin or end with a blank")
    } else if name.chars().any(char::is_control) {
        refuse("it must not hold control characters")
    } else {
        Ok(())
    }
}

/// Check the length of a list.
pub(crate) fn check_length(what: &str, found: usize, expected: usize) -> Result<(), OutputError> {
    if found == expected {
        Ok(())
    } else {
        Err(OutputError::Length { what: what.to_string(), found, expected })
    }
}
