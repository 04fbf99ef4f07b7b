//! Material point method from interchangeable parts: particles, sparse grids, shape functions, transfers.
//!
//! A [`Method`] consists of a shape function, a transfer, a stress update and an embedding; [`Mpm`] runs it on a grid
//! with bodies of any material law ([`mpm_materials`]):
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
//! | module | content |
//! |---|---|
//! | [`method`], [`shape`], [`transfer`], [`scheme`], [`embedding`], [`frame`], [`dilatation`] | parts of a method, compatibility |
//! | [`step`] | solver, stages of a step, time step |
//! | [`particles`], [`grid`] | storage of particles and nodes |
//! | [`contact`] | contact between bodies at shared nodes |
//! | [`boundary`] | boundary conditions and loads |
//! | [`geometry`] | shapes, and particles seeded in them |
//! | [`memory`] | limit of the memory that one call may request |
//! | [`watch`] | energy and momentum balances, stop criteria and warnings |
//! | [`observe`], [`output`] | observers of a run, and output files |
//! | [`parallel`] | vectors and threads: the crate `impactite-simd` |
//!
//! Units are SI. Stress is tension-positive, pressure compression-positive; symmetric tensors are listed xx, yy, zz,
//! yz, xz, xy. Results are bitwise identical for any number of threads and any grid. `CONVENTIONS.md` and
//! `REFERENCES.md` of the repository explain symbols, rules and the keys in square brackets.
//!
//! # Features
//! - `mesh` (default): bodies from STL, OBJ and PLY files.
//! - `conformance`: tests for custom shape functions, transfers, grids and methods.

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
    Balance, ClientPoint, Deformable, Facts, FieldForce, Footprint, Frequency, GridBody, GridClient, Hook,
    HookError, Kernels, Matter, MergeBook, Merging, Mpm, NearParticle, NearParticles, NewParticle,
    NewParticles, NodeWeight, Occupied, OperatorPoint, OperatorWeight, PointOperator, Rest, Rested, Rigid,
    RigidState, SplitBook, Splitting, StepView, StrainNodes, SurfaceClient, Surroundings, Taken, Traction,
    TrialNode, TrialNodes, Twist,
};
pub use step::{Criterion, NearContact, OccupiedBlock, Refinement, RegridView, StateAbove, WithBody};
pub use transfer::{Aflip, Apic, Blend, Flip, Fmpm, Mls, Pic, Transfer};
