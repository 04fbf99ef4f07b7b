//! Tests of the step and its parts in one program, so that their common code is compiled once. Tests of allocations and of the plain
//! reference have programs of their own.

#![allow(missing_docs)]

mod books;
mod conformance;
mod convergence;
mod defaults;
mod dilatation;
mod failures;
mod flight;
mod loads;
mod merging;
mod observe;
mod plates;
mod restart;
mod resting;
mod solver;
mod splitting;
mod states;
mod symmetries;
mod takeover;
mod total;
mod vectors;
mod viscous;
mod watch;
