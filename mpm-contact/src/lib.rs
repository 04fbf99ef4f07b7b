//! Contact between bodies: interchangeable detectors, normals and laws.
//!
//! | part | choices |
//! |---|---|
//! | [`ContactDetector`] | [`Approach`], [`Compression`], [`SurfaceDistance`], [`Regression`]; [`EachPair`] of a [`PairDetector`] |
//! | [`NormalRule`] | [`SeparatingPlane`]; [`Gradients`] by mass or volume: collinear, difference, of one body; [`Regression`] |
//! | [`ContactLaw`] | [`Frictionless`], [`Coulomb`], [`SlipWeakening`], [`Stick`], [`Adhesion`], [`Penalty`]; a table of [`Pairs`] |
//!
//! [`particles`] is contact between bodies of particles, in scenes of their own; [`mesh`] is contact of points of any method with the
//! facets of meshes, from search to impulses.
//!
//! The crate is independent of methods: detectors, normals and laws work on [`Places`], which are the nodes of a grid
//! (`mpm_core::GridContact`) or pairs of particles ([`particles`]). Any number of bodies may be in contact at a place; every impulse acts
//! on two bodies with opposite signs ([`relax`]).
//!
//! Units are SI; normals point from the first body of a pair to the second; a gap is negative for overlap. `REFERENCES.md` of the
//! repository explains the keys in square brackets.
//!
//! # Features
//! - `conformance`: tests for custom detectors, laws and bodies of particles.

mod any_detector;
mod bonds;
#[cfg(feature = "conformance")]
pub mod conformance;
mod detect;
mod field_points;
mod friction;
mod law;
pub mod mesh;
mod normal;
mod pair_detector;
pub mod particles;
mod penalty;
mod places;
mod regression;
mod relax;
mod separate;
pub mod vector;

pub use any_detector::{AnyDetector, AnyNormals};
pub use bonds::{Adhesion, Stick};
pub use detect::{Approach, Compression, ContactDetector, Criterion, SurfaceDistance};
pub use field_points::FieldPoints;
pub use friction::{Coulomb, Frictionless, SlipWeakening};
pub use law::{Contact, ContactLaw, Outcome, Pairs, Remembers};
pub use normal::{Choice, Gradients, Memory, Nodal, NormalNodes, NormalRule, Weight};
pub use pair_detector::{EachPair, PairDetector, SurfacePair};
pub use penalty::Penalty;
pub use places::{NearPoint, Places, SurfaceQuantity, each_place};
pub use regression::Regression;
pub use relax::{Iterate, relax};
pub use separate::SeparatingPlane;
