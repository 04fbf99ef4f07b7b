//! The fragile points method against closed-form solutions and independent computations of cracks.
#![allow(missing_docs)]

mod kalthoff;
mod stationary;
