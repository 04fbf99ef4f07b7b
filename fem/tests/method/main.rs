//! Finite elements against closed solutions, plain references, and what every solver must do.

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
