//! The sweeps over elements, on vectors of elements.
//!
//! Elements come in batches, eight side by side (an octet: two groups of lanes). A batch has a list of its nodes; forces of its elements
//! are summed there, in the order of the elements, and nodes gather over batches: so sums have a fixed order for any number of threads,
//! and a node's numbers go through memory once a batch and not once an element.

mod average;
mod bar;
mod batch;
mod choose;
mod give;
mod kernels;
mod rule;
mod solid;
mod strain;
mod work;

pub(crate) use batch::{
    BATCH, Batch, Left, Moving, OCTET, Reason, Record, Row, Rows, Trouble, lane, lane_mut,
};
pub(crate) use choose::sweep_of;
pub(crate) use work::{Measure, Of, Pass, Scratch, Sweep};
