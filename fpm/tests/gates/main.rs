//! The fragile points method against closed solutions and independent computations of cracks.
#![allow(missing_docs)]

mod kalthoff;
mod stationary;
