//! Contact stage of a step, and its state. See [`crate::contact`].

mod algorithm;
mod found;
mod memory;
mod shared_nodes;
mod stage;
mod state;

pub use algorithm::{ContactAlgorithm, OneField};
pub(in crate::step) use found::OFFSET;
pub use found::{BlockContacts, ContactPhase, Pair, Scratch, Touch, TouchMemory};
pub use memory::ContactMemory;
pub(in crate::step) use memory::Key;
pub use shared_nodes::SharedNodes;
pub(in crate::step) use state::ContactState;
