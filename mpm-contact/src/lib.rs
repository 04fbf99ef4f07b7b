//! Contact between bodies: detectors, normals and laws that compose.
//!
//! | part | choices |
//! |---|---|
//! | [`ContactDetector`] | [`Approach`], [`Compression`], [`SurfaceDistance`], [`Regression`] |
//! | [`NormalRule`] | [`SeparatingPlane`]; [`Gradients`] by mass or volume: collinear, difference, one body's own; [`Regression`] |
//! | [`ContactLaw`] | [`Frictionless`], [`Coulomb`], [`Stick`], [`Adhesion`], [`Penalty`]; a table of [`Pairs`] |
//!
//! [`GridContact`] makes a contact algorithm of them for [`mpm_core::Mpm::with_contact`]. Every body then has
//! velocities of its own at the nodes of the blocks that others reach, too, and only there. Detectors, normals and laws
//! see [`Places`], and so serve the pairs of particles of the crate `pcmm` as well. Any number of bodies
//! may meet at a node; every impulse acts on two bodies with opposite signs.
//!
//! Units are SI; normals point from the first body of a pair to the second; a gap is negative where bodies overlap.
//! `REFERENCES.md` of the repository explains the keys in square brackets.
//!
//! # Features
//! - `conformance`: tests for detectors and laws written elsewhere.

#[cfg(feature = "conformance")]
pub mod conformance;
mod couple;
mod detect;
mod law;
mod meet;
mod normal;
mod places;
mod regression;
mod relax;
mod separate;
mod solve;
mod vector;

pub use detect::{Approach, Compression, ContactDetector, Criterion, SurfaceDistance};
pub use law::{Adhesion, Contact, ContactLaw, Coulomb, Frictionless, Pairs, Penalty, Stick};
pub use meet::GridContact;
pub use normal::{Choice, Gradients, Memory, Nodal, NormalRule, Weight};
pub use places::Places;
pub use regression::Regression;
pub use relax::{Iterate, relax};
pub use separate::SeparatingPlane;
