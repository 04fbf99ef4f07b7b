//! Tests of the particle-contact method in one program, so that common code is compiled once.

#![allow(missing_docs)]

mod common;
mod conditions;
mod contact;
mod errors;
mod fitted;
mod mixed;
mod properties;
mod reference;
mod solver;
