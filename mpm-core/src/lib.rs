//! The material point method as parts that compose: particles, sparse grids, shape functions, transfers.

pub mod boundary;
#[cfg(feature = "conformance")]
pub mod conformance;
pub mod dim;
pub mod embedding;
pub mod geometry;
pub mod grid;
pub mod method;
pub mod observe;
pub mod output;
pub mod parallel;
pub mod particles;
pub mod scheme;
pub mod shape;
pub mod step;
pub mod transfer;

pub use boundary::{Boundary, Side};
pub use dim::Dim;
pub use embedding::{Axisymmetric, Embedding, FullSpace, PlaneStrain};
pub use grid::{BlockGrid, DenseGrid, GridStorage};
pub use method::{Composition, Method};
pub use parallel::{Float, Team};
pub use scheme::{Musl, StressUpdate, Usf, Usl};
pub use shape::{
    AffineShape, BoundaryModified, CpGimp, CubicBSpline, Gimp, Linear, QuadraticBSpline, ShapeFunction,
};
pub use step::{Body, Mpm, Particle, StepError, Stopped, TimeControl, Totals};
pub use transfer::{Apic, Blend, Flip, Fmpm, Mls, Pic, Transfer};
