//! A law and a shape function that the framework does not have.

pub mod tent;
pub mod viscoelastic;

pub use tent::TentAveragedHat;
pub use viscoelastic::StandardLinearSolid;
