//! The step and what it is made of, but for what needs a program of its own: allocations, and the plain method. One program, so that what all of them use is compiled once.

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
