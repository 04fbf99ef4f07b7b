//! What the tests of the framework share: a plain reference method, scenes, and comparisons.

pub mod compare;
pub mod laws;
pub mod reference;
pub mod scene;
