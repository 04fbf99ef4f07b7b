//! Incompressible flow against closed-form solutions, and the conformance suite of solvers.
#![allow(missing_docs)]

mod common;
mod drops;
mod solver;
mod tension;
mod viscous;
mod waves;
