//! What the program `impactite` does, for programs of one's own: run a scene file in a folder, resume it, vary it.

pub mod advance;
pub mod error;
pub mod folder;
pub mod job;
pub mod lists;
pub mod pictures;
pub mod sweep;
pub mod templates;

pub use advance::{Advance, Stand};
pub use error::CliError;
pub use job::{Job, Outcome};
