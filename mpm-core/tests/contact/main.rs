//! Contact on the grid, in one test program, so that shared code is compiled once.

#![allow(missing_docs)]

mod bodies;
mod client;
mod common;
#[cfg(feature = "conformance")]
mod conformance;
mod crowd;
mod floors;
mod halves;
mod hostile;
mod keeping;
mod memory;
mod onset;
mod planes;
mod random;
mod reference;
mod rest;
mod restart;
mod resting;
mod rigid;
mod sliding;
mod stacked;
mod symmetry;
mod units;
