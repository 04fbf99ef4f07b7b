//! Particle contacts. One program, so that what all of them use is compiled once.

#![allow(missing_docs)]

mod common;
mod conditions;
mod contact;
mod errors;
mod mixed;
mod properties;
mod reference;
mod solver;
