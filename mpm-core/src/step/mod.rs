//! The step: a list of stages, in the order of the flow chart of \[Ma2010\] 1.4.

pub mod body;
pub mod contact;
pub mod control;
mod encounters;
pub mod fields;
mod gather;
pub mod layout;
pub mod load;
mod mean;
mod meet;
mod migrate;
pub mod nodes;
pub mod planes;
mod reach;
pub mod rigid;
mod rigid_body;
mod scatter;
mod scene;
mod shared;
mod solver;
pub mod splitting;
pub mod survey;
pub mod sweep;
pub mod tile;
mod total;

pub use body::{Body, Particle, ParticleBody, Totals};
pub use contact::{Contact, ContactNode, OneField, PairContact};
pub use control::TimeControl;
pub(crate) use encounters::Encounters;
pub use load::{FieldForce, Load, Traction, Unloaded};
pub use rigid::{Rigid, RigidState, Twist};
pub use scene::SceneError;
pub use solver::{Mpm, StepError, Stopped};
pub use splitting::{SplitBook, Splitting};
