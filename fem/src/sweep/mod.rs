//! Vectorised sweeps over elements.
//!
//! Elements are stored in batches, eight side by side (an octet: two groups of lanes). A batch has a list of its nodes. Forces of its
//! elements are scattered there in the order of the elements, and nodes gather over batches. Sums therefore have a fixed order for any
//! number of threads, and nodal data pass through memory once a batch instead of once an element.

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
