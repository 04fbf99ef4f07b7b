//! The step: a list of stages, in the order of the flow chart of \[Ma2010\] 1.4.

pub mod body;
pub mod control;
mod gather;
pub mod load;
mod migrate;
pub mod nodes;
mod scatter;
mod solver;
pub mod sweep;
pub mod tile;

pub use body::{Body, Particle, ParticleBody, Totals};
pub use control::TimeControl;
pub use load::{Load, Traction, Unloaded};
pub use solver::{Mpm, SceneError, StepError, Stopped};
