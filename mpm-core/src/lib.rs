//! x

pub mod geometry;
