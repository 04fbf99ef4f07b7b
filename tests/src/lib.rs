//! Shared test support: plain reference method, scenes, laws and comparisons.

pub mod compare;
pub mod laws;
pub mod reference;
pub mod scene;
