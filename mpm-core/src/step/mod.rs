//! Stages of a time step, in the order of the flow chart of \[Ma2010\] 1.4.

pub(crate) mod between_steps;
pub(crate) mod bodies;
mod clients;
pub(crate) mod contact;
mod hook_calls;
mod hooks;
mod mpm;
mod nodes;
pub(crate) mod passes;
mod refine;
mod rigid;
mod scene;
mod setup;
mod solver;
mod stepper;
mod view;

pub use between_steps::merging::{MergeBook, Merging};
pub use between_steps::rest::{Balance, Frequency, Rest, Rested};
pub use between_steps::splitting::{SplitBook, Splitting};
pub use bodies::body::{GridBody, Presence};
pub use bodies::capability::{ClientSteps, Deactivation, Division, FreeVelocities, MeetsSurfaces};
pub use bodies::deformable::Deformable;
pub use bodies::load::{FieldForce, Traction};
pub use bodies::particle_body::ParticleBody;
pub use clients::client::{ClientPoint, GridClient, SurfaceClient, Taken};
pub use clients::near_particles::{NearParticle, NearParticles};
pub use clients::new_particles::{Matter, NewParticle, NewParticles, Occupied, Surroundings};
pub use hooks::{Hook, HookError, StepView, TrialNode, TrialNodes};
pub use mpm::{Kernels, Mpm, Scalar};
pub use nodes::footprint::{Footprint, NodeWeight};
pub use passes::kernels::Facts;
pub(crate) use passes::rows::RowsMut;
pub use refine::Refinement;
pub use rigid::motion::{Rigid, RigidState, Twist};
pub use rigid::planes::PlaneTouch;
