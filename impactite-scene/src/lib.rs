//! Shared infrastructure of all methods: solver interface, run loop, observers, balances, checkpoints and boundary conditions.
//!
//! A method (`mpm-core`, `pcmm`, or your own) implements its physics and [`Solver`]. It uses these modules:
//!
//! | module | contents |
//! |---|---|
//! | [`solver`] | interface of a method, and default operations of every solver |
//! | [`body`], [`contact`] | public view of bodies, their points and their contacts |
//! | [`run`] | the run loop, with observers, checkpoints and restart |
//! | [`observe`] | histories, balances, probes, ParaView series, pictures, progress |
//! | [`clock`], [`control`] | simulated time and time step control |
//! | [`balance`], [`watch`] | balances of mass, momentum and energy; warnings and stop criteria |
//! | [`archive`], [`constants`] | checkpoints |
//! | [`boundary`], [`condition`], [`embedding`] | boundary conditions, custom conditions, embedding of `D` dimensions in space |
//! | [`boundaries`] | list of the conditions of a scene: order, motion over time, accounts |
//! | [`moving`] | boundary conditions on points with velocities of their own |
//! | [`error`] | invalid scene definitions and errors of steps |
//!
//! Units are SI. Stress is tension-positive, pressure compression-positive; symmetric tensors are listed xx, yy, zz, yz, xz, xy.

pub mod archive;
pub mod balance;
pub mod body;
pub mod boundaries;
pub mod boundary;
mod centre;
pub mod clock;
pub mod condition;
#[cfg(feature = "conformance")]
pub mod conformance;
pub mod constants;
pub mod contact;
pub mod control;
mod damping;
pub mod embedding;
pub mod error;
pub mod exchange;
mod finding;
pub mod moving;
pub mod observe;
pub mod run;
mod snapshot;
pub mod solver;
mod summary;
pub mod watch;

pub use archive::{Archive, CheckpointError};
pub use balance::Account;
pub use body::{Body, Bounds, Parts, PointView, Staggered, Totals};
pub use boundaries::{Boundaries, BoundaryEntry};
pub use boundary::{Boundary, Side};
pub use centre::CentreLead;
pub use clock::Clock;
pub use condition::{Condition, Place, Reaction};
pub use contact::{ContactPoint, PairContact};
pub use control::{StepLimit, TimeControl};
pub use damping::LocalDamping;
pub use embedding::{Axisymmetric, Embedding, FullSpace, Line, PlaneStrain};
pub use error::{Cause, PointKind, SceneError, StepError, Stopped};
pub use exchange::{ACCOUNTS, Booking, Exchange};
pub use moving::MovingPoint;
pub use run::{Run, RunError};
pub use snapshot::snapshot_fields;
pub use solver::Solver;
pub use summary::RunSummary;
pub use watch::{Finding, GainCause, Warning, Watch};
