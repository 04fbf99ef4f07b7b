//! What leaves a run: pictures, ParaView files and histories.
//!
//! Everything here works on a [`Snapshot`] (or plain columns of numbers) and knows nothing of solvers, so that
//! any particle method can draw itself:
//!
//! | module | writes | read by |
//! |---|---|---|
//! | [`vtk`] | one `.vtp` file (of elements `.vtu`) an instant and a `.pvd` time series; with the feature `hdf5` also `.vtkhdf` | ParaView, VisIt, PyVista |
//! | [`csv`] | histories, one row an instant | everything |
//! | [`picture`] | shaded particles, flat fields, line charts and panels of them as PNG | people |
//! | [`progress`] | a progress bar on the terminal | people who wait |
//!
//! All of them write whole files: what is at a path is the old file or the new one, never half, however many processes write there
//! and whatever ends them ([`WholeFile`]).
//!
//! All numbers are SI; pictures and tables convert at the last moment through [`picture::Quantity`] or an
//! [`picture::Axis`] that names its unit. Bad input is refused with an [`OutputError`] that says which field
//! was wrong, what it was and what would have been allowed.

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

/// Why something could not be drawn or written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum OutputError {
    /// The operating system refused to create, write, flush or rename a file.
    #[error("cannot {action} `{}`: {source}", path.display())]
    File {
        /// Attempted operation: "look at", "follow", "create", "write", "rename to", "remove", "open".
        action: &'static str,
        /// The file or folder.
        path: PathBuf,
        /// What the operating system said.
        source: std::io::Error,
    },
    /// Work that was given to a thread failed before.
    #[error(transparent)]
    Earlier(std::sync::Arc<OutputError>),
    /// A thread that draws and writes has ended by a panic.
    #[error(
        "the thread that draws pictures and writes frames has ended; what it was given since is not there"
    )]
    Ended,
    /// A path where no file can be.
    #[error("cannot write `{}`: it is {found}, which is not allowed; it must be a regular file, a link to one, or free", path.display())]
    NoFile {
        /// The path.
        path: PathBuf,
        /// What is there.
        found: &'static str,
    },
    /// The PNG encoder failed.
    #[error("cannot encode `{}` as PNG: {source}", path.display())]
    Png {
        /// The picture's file.
        path: PathBuf,
        /// What the encoder said.
        source: png::EncodingError,
    },
    /// What was to be written is not possible in HDF5.
    #[cfg(feature = "hdf5")]
    #[error("cannot encode `{}` as HDF5: {source}", path.display())]
    Hdf {
        /// The file.
        path: PathBuf,
        /// What the encoder said.
        source: Box<dyn std::error::Error + Send + Sync>,
    },
    /// A column is not as long as there are particles, points or columns.
    #[error("{what} has {found} values, expected {expected}")]
    Length {
        /// Which column.
        what: String,
        /// Its length.
        found: usize,
        /// The length it must have.
        expected: usize,
    },
    /// A name that is empty, used twice or holds a forbidden character.
    #[error("name {name:?} of {what} is not allowed: {why}")]
    Name {
        /// What was named.
        what: &'static str,
        /// The name.
        name: String,
        /// What would have been allowed.
        why: &'static str,
    },
    /// A field that the snapshot does not hold.
    #[error("no {kind} field {name:?} in the snapshot; it has {available}")]
    NoSuchField {
        /// "scalar", "vector", "tensor", or "colour" for any number that gives one.
        kind: &'static str,
        /// The name asked for.
        name: String,
        /// The names of that kind that exist.
        available: String,
    },
    /// What is asked for takes more memory than is allowed, or than there is.
    #[error(transparent)]
    Memory(#[from] impactite_simd::memory::MemoryError),
    /// A number outside what makes sense.
    #[error("{what} = {value} is not allowed: {allowed}")]
    Value {
        /// Which number.
        what: String,
        /// The number as given.
        value: String,
        /// What would have been allowed.
        allowed: &'static str,
    },
}

impl OutputError {
    /// A number outside what makes sense.
    pub(crate) fn value(what: impl Into<String>, value: impl ToString, allowed: &'static str) -> Self {
        Self::Value { what: what.into(), value: value.to_string(), allowed }
    }

    /// For `map_err`: the operating system refused `action` on `path`.
    pub fn file(action: &'static str, path: &Path) -> impl FnOnce(std::io::Error) -> Self {
        move |source| Self::File { action, path: path.to_path_buf(), source }
    }
}

/// Check a name that ends up in a file: not empty, no control characters, no surrounding blanks.
///
/// # Errors
/// [`OutputError::Name`] says what is not allowed.
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

/// Refuse a list of another length.
pub(crate) fn check_length(what: &str, found: usize, expected: usize) -> Result<(), OutputError> {
    if found == expected {
        Ok(())
    } else {
        Err(OutputError::Length { what: what.to_string(), found, expected })
    }
}
