//! Smoothed particles against plain sums, closed solutions and the contracts of the house.
#![allow(missing_docs)]

mod common;
mod contact;
mod diffusion;
mod errors;
mod physics;
mod reference;
mod solver;
