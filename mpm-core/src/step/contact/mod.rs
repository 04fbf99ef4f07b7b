//! The stage of a step in which bodies act on each other, and what it keeps. See [`crate::contact`].

mod algorithm;
mod memory;
mod shared_nodes;
mod stage;
mod state;

pub use algorithm::{Contact, ContactPhase, OneField, Scratch};
pub use memory::{ContactMemory, TouchMemory};
pub(in crate::step) use memory::{Key, OFFSET};
pub use shared_nodes::SharedNodes;
pub(in crate::step) use state::ContactState;
pub use state::{BlockContacts, Pair, Touch};
