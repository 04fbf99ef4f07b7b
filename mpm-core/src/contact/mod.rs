//! Contact on the grid: impulses between the velocity fields of bodies at the nodes that several share.
//!
//! | what | is |
//! |---|---|
//! | [`GridContact`] | the contact algorithm of a detector and the laws of the pairs (crate `mpm-contact`) |
//! | [`OneField`] | one velocity field for all bodies: they stick |
//! | [`ContactAlgorithm`] | what the step asks of either, and of one's own |
//! | [`SharedNodes`] | what it shows: the nodes of a block, and what particles around them tell |
//! | [`BlockContacts`] | what was found there, and lasts |
//! | [`PlaneTouch`] | where free rigid bodies touch walls, fixed planes and planes of symmetry |
//!
//! The step has the scene's [`ContactAlgorithm`] look at every shared block on its own, and keeps what it found there from step to step.

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
