//! The material point method as parts that compose: particles, sparse grids, shape functions, transfers.
//!
//! A [`Method`] names a shape function, a transfer, a stress update and an embedding; [`Mpm`] runs it on a grid,
//! with bodies of any laws ([`mpm_materials`]):
//!
//! ```
//! use mpm_core::geometry::{Ball, Filling, Lattice, fill};
//! use mpm_core::{Apic, BlockGrid, Boundary, Method, Mpm, PlaneStrain, QuadraticBSpline, Side, Usl};
//! use mpm_materials::{Moduli, NeoHookean};
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! // A rubber disc of radius 0.1 m falls on a floor at 2 m/s.
//! let lattice = Lattice::new([0.0; 2], 0.05)?;
//! let rubber = NeoHookean::new(1000.0, Moduli::young_poisson(1.0e6, 0.4)?)?;
//! let seeds = fill(&Ball::new([0.5, 0.1], 0.1)?, &lattice, 2, &Filling::new())?;
//! let method = Method::new(QuadraticBSpline, Apic, Usl, PlaneStrain);
//! let mut mpm = Mpm::new(method, BlockGrid::new(lattice));
//! mpm.add("disc", rubber, &seeds, |_| [0.0, -2.0])?;
//! mpm.bound(Boundary::Wall { axis: 1, at: 0.0, side: Side::Above, velocity: 0.0 })?;
//! mpm.run_until(1.0e-3)?;
//! # assert!((mpm.time() - 1.0e-3).abs() < 1e-12);
//! # Ok(())
//! # }
//! ```
//!
//! | module | holds |
//! |---|---|
//! | [`method`], [`shape`], [`transfer`], [`scheme`], [`embedding`], [`frame`], [`dilatation`] | the parts of a method, and which go together |
//! | [`step`] | the solver, the stages of a step, the time step |
//! | [`particles`], [`grid`] | where particles and nodes are kept |
//! | [`contact`] | contact between bodies at the nodes they share |
//! | [`boundary`] | conditions and loads |
//! | [`geometry`] | shapes, and particles seeded from them |
//! | [`memory`] | how much of it one call may ask for |
//! | [`watch`] | books of energy and momentum, and what stops or warns |
//! | [`observe`], [`output`] | what looks at a run, and what it writes |
//! | [`parallel`] | vectors and threads: the crate `impactite-simd` |
//!
//! Units are SI. Stress is tension-positive, pressure compression-positive; symmetric tensors are listed xx, yy,
//! zz, yz, xz, xy. Results are the same bits for any number of threads and any grid. `CONVENTIONS.md` and
//! `REFERENCES.md` of the repository explain symbols, rules and the keys in square brackets.
//!
//! # Features
//! - `mesh` (default): bodies from STL, OBJ and PLY files.
//! - `conformance`: tests for shape functions, transfers, grids and methods written elsewhere.

mod combine;
#[cfg(feature = "conformance")]
pub mod conformance;
pub mod contact;
pub mod dilatation;
pub mod dim;
pub mod frame;
pub mod grid;
pub mod kernels;
mod library;
pub mod method;
pub mod particles;
pub mod scheme;
pub mod shape;
pub mod step;
pub mod transfer;

pub use impactite_geometry as geometry;
pub use impactite_output as output;
pub use impactite_scene as scene;
pub use impactite_scene::{
    Account, Archive, Axisymmetric, Body, Boundary, Cause, CheckpointError, Condition, ContactPoint,
    Embedding, Exchange, Finding, FullSpace, GainCause, PairContact, PlaneStrain, PointKind, PointView, Run,
    RunError, RunSummary, SceneError, Side, Solver, StepError, Stopped, TimeControl, Totals, Warning, Watch,
};
pub use impactite_scene::{boundary, condition, embedding, observe, watch};
pub use impactite_simd as parallel;
pub use impactite_simd::memory;

pub use contact::{ContactAlgorithm, GridContact, OneField};
pub use dilatation::{Dilatation, MeanDilatation, OwnDilatation};
pub use dim::Dim;
pub use frame::{Frame, TotalLagrangian, UpdatedLagrangian};
pub use grid::{BlockGrid, DenseGrid, DenseGridError, GridStorage};
pub use kernels::IntoKernels;
pub use memory::MemoryError;
pub use method::{CompiledHere, Composition, Method};
pub use parallel::{Float, Team};
pub use scheme::{Musl, StressUpdate, Usf, Usl};
pub use shape::{
    AffineShape, BoundaryModified, CpGimp, Cpdi, Cpdi2, CubicBSpline, Domain, FixedDomain, Gimp, Linear,
    QuadraticBSpline, ShapeFunction,
};
pub use step::Scalar;
pub use step::{
    Balance, ClientPoint, Deformable, Facts, FieldForce, Footprint, Frequency, GridBody, GridClient, Kernels,
    Matter, MergeBook, Merging, Mpm, NearParticle, NearParticles, NewParticle, NewParticles, NodeWeight,
    Occupied, Rest, Rested, Rigid, RigidState, SplitBook, Splitting, SurfaceClient, Surroundings, Taken,
    Traction, Twist,
};
pub use transfer::{Aflip, Apic, Blend, Flip, Fmpm, Mls, Pic, Transfer};
