//! Incompressible flow against closed-form solutions, and the conformance suite of solvers.
#![allow(missing_docs)]

mod bodies;
mod common;
mod drops;
mod gates;
mod inclined;
mod schemes;
mod solver;
mod tension;
mod viscous;
mod waves;
