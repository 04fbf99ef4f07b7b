//! Impactite: the material point method and its neighbours, for impact, penetration and large deformation of solids.
//!
//! This crate is the entry point: one dependency that re-exports the crates of the framework by topic, and a [`prelude`]. It has no code of
//! its own.
//!
//! ```
//! use impactite::prelude::*;
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! // A copper ball of 2 mm radius hits a rigid wall at 200 m/s, axisymmetric.
//! let lattice = Lattice::new([0.0; 2], 0.5e-3)?;
//! let seeds = fill(&Ball::new([0.0, 2.0e-3], 2.0e-3)?, &lattice, 2, &Filling::new().axisymmetric())?;
//! let mut mpm = Mpm::new(Method::impact(Axisymmetric), BlockGrid::new(lattice));
//! mpm.add("ball", library::copper_taylor(), &seeds, |_| [0.0, -200.0])?;
//! mpm.bound(Boundary::Symmetry { axis: 0, at: 0.0, side: Side::Above })?;
//! mpm.bound(Boundary::Wall { axis: 1, at: 0.0, side: Side::Above, velocity: 0.0 })?;
//! mpm.run_until(1.0e-6)?;
//! # assert!(mpm.totals().internal > 0.0);
//! # Ok(())
//! # }
//! ```
//!
//! | module | contents | crate |
//! |---|---|---|
//! | [`mpm`] | the material point method: parts of a method, grids, bodies, conditions, the step | `mpm-core` |
//! | [`pcmm`] | the particle-contact meshfree method | `pcmm` |
//! | [`fem`] | explicit finite elements | `fem` |
//! | [`sph`] | smoothed particle hydrodynamics of solids | `sph` |
//! | [`fpm`] | the fragile points method: cells whose faces open as cracks | `fpm` |
//! | [`coupling`] | elements and particles in one scene | `coupling` |
//! | [`materials`] | constitutive laws, equations of state, failure; the driver of a single point | `mpm-materials` |
//! | [`contact`] | contact detectors, normals and laws; scenes of bodies of particles; points and meshes | `mpm-contact` |
//! | [`geometry`] | shapes, lattices, seeding, meshes, neighbour search | `impactite-geometry` |
//! | [`scene`] | infrastructure of all methods: bodies, `Solver`, run loop, balances, checkpoints | `impactite-scene` |
//! | [`observe`], [`watch`] | observers; checks of unexplained energy and momentum | `impactite-scene` |
//! | [`output`] | ParaView files, pictures, charts, histories | `impactite-output` |
//! | [`solve`] | linear solves with equal bits for any number of threads | `impactite-solve` |
//! | [`parallel`] | vector instructions and threads | `impactite-simd` |
//!
//! Start with the [book](https://github.com/impactite/impactite/blob/main/docs/book/src/SUMMARY.md). Units are SI; stress is
//! tension-positive, pressure compression-positive.
//!
//! # Features
//! - `mesh` (default): bodies from STL, OBJ and PLY files.
//! - `single`: kernels of the most used methods and laws also in single precision.
//! - `one-width`: no AVX-512, for faster compilation of kernels.
//! - `hdf5`: frames for ParaView in VTKHDF, [`output::Format`]`::Hdf`.
//! - `conformance`: test suites for custom laws, shape functions, transfers, grids, detectors, contact laws and bodies of particles.

pub use coupling;
pub use fem;
pub use flow;
pub use fpm;
pub use impactite_geometry as geometry;
pub use impactite_output as output;
pub use impactite_scene as scene;
pub use impactite_scene::{observe, watch};
pub use impactite_simd as parallel;
pub use impactite_solve as solve;
pub use mpm_contact as contact;
pub use mpm_core as mpm;
pub use mpm_materials as materials;
pub use pcmm;
pub use sph;

/// Names that most programs use: `use impactite::prelude::*;`.
///
/// The particle-contact method is not included, since its method and its scene have names of their own in `impactite::pcmm`.
pub mod prelude {
    pub use crate::contact::{
        Adhesion, Approach, Coulomb, Frictionless, Gradients, Pairs, Penalty, Regression, SeparatingPlane,
        SlipWeakening, Stick, SurfaceDistance,
    };
    pub use crate::geometry::{
        Ball, Compose, Cuboid, Cylinder, Disc, Filling, Frustum, HalfSpace, Implicit, Lattice, OgiveRod,
        Polygon, Ring, Seeds, Shape, Shell, Sphere, TriangleMesh, Tube, fill, rings,
    };
    pub use crate::materials::{
        AdiabaticJohnsonCook, BulkViscosity, CohesiveSpall, CrackBand, Detonation, DruckerPrager, Elastic,
        Explosive, Fluid, Ground, HolmquistJohnsonCook, IdealGas, Inviscid, J2, JohnsonCook,
        JohnsonCookDamage, Jwl, LinearElastic, MieGruneisen, Moduli, MohrCoulomb, NeoHookean, Newtonian,
        PlasticStrainLimit, Porous, Removed, Solid, SteinbergGuinan, Stretching, Tait, TensilePressure,
        library,
    };
    pub use crate::mpm::{
        Aflip, Apic, Axisymmetric, Blend, BlockGrid, Boundary, BoundaryModified, CpGimp, Cpdi, Cpdi2,
        CubicBSpline, Deformable, DenseGrid, FieldForce, Flip, Fmpm, FullSpace, Gimp, GridContact,
        IntoKernels, Kernels, Linear, Merging, Method, Mls, Mpm, Musl, Pic, PlaneStrain, QuadraticBSpline,
        Rest, Rigid, Side, Splitting, Team, TimeControl, Traction, Twist, Usf, Usl, Watch,
    };
    pub use crate::observe::{
        HistoryCsv, Ledger, ObserveError, Observer, Pace, Pictures, Probe, Probes, Progress, Quantity,
        RunView, VtkSeries,
    };
    pub use crate::scene::{
        Archive, Body, CheckpointError, Run, RunError, RunSummary, SceneError, Solver, StepError, Stopped,
        Totals,
    };
}

/// Programs of the README and of the book, compiled and run by `cargo test`: one struct per page.
#[cfg(doctest)]
mod pages {
    #[doc = include_str!("../../README.md")]
    struct Readme;
    #[doc = include_str!("../../docs/book/src/conditions.md")]
    struct Conditions;
    #[doc = include_str!("../../docs/book/src/contact.md")]
    struct Contact;
    #[doc = include_str!("../../docs/book/src/elements.md")]
    struct Elements;
    #[doc = include_str!("../../docs/book/src/extending.md")]
    struct Extending;
    #[doc = include_str!("../../docs/book/src/flow.md")]
    struct Flow;
    #[doc = include_str!("../../docs/book/src/fpm.md")]
    struct Fpm;
    #[doc = include_str!("../../docs/book/src/getting-started.md")]
    struct GettingStarted;
    #[doc = include_str!("../../docs/book/src/materials.md")]
    struct Materials;
    #[doc = include_str!("../../docs/book/src/observers.md")]
    struct Observers;
    #[doc = include_str!("../../docs/book/src/pcmm.md")]
    struct Pcmm;
    #[doc = include_str!("../../docs/book/src/resolution.md")]
    struct Resolution;
    #[doc = include_str!("../../docs/book/src/restart.md")]
    struct Restart;
    #[doc = include_str!("../../docs/book/src/sph.md")]
    struct Sph;
    #[doc = include_str!("../../docs/book/src/time-control.md")]
    struct TimeControl;
    #[doc = include_str!("../../docs/book/src/watch.md")]
    struct Watch;
}
