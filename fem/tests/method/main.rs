//! Tests of finite elements: closed-form solutions, plain reference implementations, solver conformance.

mod common;
mod contact;
mod elements;
mod erosion;
mod gates;
mod locking;
mod reference;
mod solver;
mod step;
mod time;
