//! Smoothed particles against plain sums, closed-form solutions and the conformance suites.
#![allow(missing_docs)]

mod common;
mod contact;
mod diffusion;
mod errors;
mod liquid;
mod physics;
mod reference;
mod solver;
