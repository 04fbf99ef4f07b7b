//! The step: a list of stages, in the order of the flow chart of \[Ma2010\] 1.4.

pub mod body;
pub mod control;
mod gather;
pub mod nodes;
mod scatter;
mod solver;
pub mod sweep;

pub use body::{Body, Load, Particle, ParticleBody, Totals, Traction, Unloaded};
pub use control::TimeControl;
pub use solver::{Mpm, SceneError, StepError, Stopped};
