//! Contact on the grid: impulses between the velocity fields of bodies at shared nodes.
//!
//! | item | meaning |
//! |---|---|
//! | [`GridContact`] | contact algorithm with a detector and the laws of the pairs (crate `mpm-contact`) |
//! | [`OneField`] | one velocity field for all bodies: they stick |
//! | [`ContactAlgorithm`] | interface of contact algorithms, also user-defined ones |
//! | [`SharedNodes`] | input of an algorithm: the nodes of a block, and quantities of the particles around them |
//! | [`BlockContacts`] | result of an algorithm: contacts of a block, kept from step to step |
//! | [`PlaneTouch`] | contact point of a free rigid body with a wall, fixed plane or symmetry plane |
//!
//! The step calls the scene's [`ContactAlgorithm`] for every shared block separately, and keeps its contacts from step to
//! step.

mod free_rigid;
mod grid_contact;
mod node_impulses;

pub use crate::step::PlaneTouch;
pub use crate::step::contact::{
    BlockContacts, ContactAlgorithm, ContactPhase, OneField, Pair, Scratch, SharedNodes, Touch, TouchMemory,
};
pub(crate) use free_rigid::solve_planes;
pub use grid_contact::GridContact;
pub use impactite_scene::{ContactPoint, PairContact};
