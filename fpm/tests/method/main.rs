//! The fragile points method against plain sums, closed-form solutions and the conformance suites.
#![allow(missing_docs)]

mod bar;
mod beam;
mod cells;
mod common;
mod cracks;
mod errors;
mod limit;
mod patch;
mod reference;
mod solver;
mod wave;
