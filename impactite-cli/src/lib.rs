//! Library of the program `impactite`: run a scene file in a folder, resume it, sweep over its keys, refine it.

mod cells;
pub mod converge;
pub mod error;
pub mod folder;
mod inertia;
pub mod job;
pub mod lists;
pub mod pictures;
mod profiles;
pub mod resume;
pub mod shared_progress;
pub mod sweep;
pub mod templates;

pub use error::CliError;
pub use job::{Job, Outcome};
pub use shared_progress::{ProgressState, SharedProgress};
