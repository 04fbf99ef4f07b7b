//! Sums over the sides of cells: gradients, jumps, tractions, forces. Each cell gathers from its neighbours and writes its own data only,
//! so that results do not depend on threads.

mod batch;
mod deform;
mod force;
mod lift;
mod traction;

pub(crate) use batch::{BATCH, Batch, GROUP, Outer, Row};
pub(crate) use deform::{Deform, Trace, trace};
pub(crate) use force::Force;
pub(crate) use lift::{Lift, jump, lifting};
pub(crate) use traction::{Load, Traction};
