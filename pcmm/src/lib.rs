//! Particle-contact meshfree method \[Feng2014\]: particles in contact define triangles (tetrahedra in space) for continuum mechanics. As
//! contacts change, distorted elements are deleted and new ones created.
//!
//! Constitutive laws are from [`mpm_materials`]; embeddings, boundary conditions, the run loop, observers and checkpoints from
//! [`impactite_scene`]. A [`Pcmm`] and a scene of [`Bodies`] are each a [`Solver`](impactite_scene::Solver).
//!
//! ```
//! use impactite_geometry::{Cuboid, Lattice};
//! use impactite_scene::{Boundary, PlaneStrain, Side, Solver};
//! use mpm_materials::{Elastic, LogarithmicBulk, Moduli, Solid};
//! use pcmm::{LocalDelaunay, Masses, Method, Packing, Pcmm};
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! // A steel bar, 1 mm x 5 mm, hits a rigid wall at 50 m/s. Particles lie on its surface.
//! let h = 0.1e-3;
//! let shape = Cuboid::new([0.0; 2], [1.0e-3, 5.0e-3])?;
//! let packing = Packing::on_nodes(&shape, &Lattice::new([0.0; 2], h)?)?;
//!
//! let moduli = Moduli::young_poisson(206e9, 0.3)?;
//! let steel = Solid::new(Elastic::new(moduli.shear)?, LogarithmicBulk::new(7850.0, moduli.bulk)?);
//! let method = Method::consistent(PlaneStrain, LocalDelaunay::new(0.5 * h, 2.0)?);
//! let mut bar = Pcmm::new(method, steel, &packing, |_| [0.0, -50.0], Masses::FromElements)?;
//! bar.bound(Boundary::Wall { axis: 1, at: 0.0, side: Side::Above, velocity: 0.0 })?;
//! bar.run_until(0.2e-6)?;
//! assert!(bar.exchange().impulse[1] > 0.0);
//! # Ok(())
//! # }
//! ```
//!
//! | part | original \[Feng2014\] | this crate |
//! |---|---|---|
//! | [`Tessellation`] | [`AzimuthFan`] (two dimensions) | [`LocalDelaunay`] |
//! | [`Inheritance`] | [`ParticleMean`] | [`OverlapWeighted`] |
//! | [`Configuration`] of the velocity gradient | [`EndOfStep`] | [`StartOfStep`] |
//! | [`Dilatation`] | [`OfElement`] | [`OfParticles`] |
//! | rotation of stress | [`NoRotation`] | objective rates of the laws |
//! | [`Masses`] | from elements | from volumes |
//! | contact of bodies | not described | [`Bodies`]: pairs of particles |
//!
//! # The cycle
//! Steps of the paper's cycle, and their places in this crate:
//!
//! | step | operation | place |
//! |---|---|---|
//! | 1 | velocity gradient | sweep over elements |
//! | 2 - 9 | strain rate, split, deviator, pressure, yield, viscosity, total stress | the law, on vectors of elements |
//! | 10 | nodal forces, minus (6) of the paper: a stretched triangle pulls its particles together | the same sweep |
//! | 11 | sum of forces, velocity, position | sweep over particles, boundaries between velocity and position |
//! | | deletion, search, creation, inheritance | revision, at an interval of steps |
//!
//! A step begins with 11, so that positions, velocities and stresses at the end of a step belong together; forces at its start are those of
//! the stresses there. Time integration is explicit (leapfrog: velocities belong to the middle of a step). Momentum and angular momentum
//! are conserved to rounding, the energy to the order of the step, except for additions and removals by revisions, which [`Audit`] books.
//!
//! # Several bodies
//! Bodies of any laws and methods are in contact in a scene of [`Bodies`], by pairs of particles ([`mpm_contact::particles`]): a [`Pcmm`]
//! is a [`ParticleBody`](mpm_contact::particles::ParticleBody). Its surface normals are sums of V grad N over the elements at a particle,
//! exact for flat surfaces; its surface is [`Packing::surface`] radii beyond the centres. [`Bodies::part`] returns a body with its own
//! type.
//!
//! ```
//! use impactite_geometry::{Cuboid, Lattice};
//! use impactite_scene::PlaneStrain;
//! use mpm_contact::{Coulomb, Pairs, SurfaceDistance};
//! use mpm_materials::{Elastic, LogarithmicBulk, Moduli, Solid};
//! use pcmm::{Bodies, Consistent, LocalDelaunay, Masses, Method, Packing, Pcmm};
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! // A block of aluminium flies into one of steel, friction 0.2.
//! let h = 1.0e-3;
//! let mut scene = Bodies::<2, _>::new(SurfaceDistance::default(), Pairs::new(Coulomb::new(0.2)?));
//! for (name, left, density, young, speed) in
//!     [("steel", 0.0, 7850.0, 206e9, 0.0), ("aluminium", 5.0 * h, 2700.0, 70e9, -100.0)]
//! {
//!     let shape = Cuboid::new([left, 0.0], [left + 4.0 * h, 4.0 * h])?;
//!     let packing = Packing::on_nodes(&shape, &Lattice::new([left, 0.0], h)?)?;
//!     let moduli = Moduli::young_poisson(young, 0.3)?;
//!     let law = Solid::new(Elastic::new(moduli.shear)?, LogarithmicBulk::new(density, moduli.bulk)?);
//!     let method = Method::consistent(PlaneStrain, LocalDelaunay::new(0.45 * h, 2.0)?);
//!     scene.add(name, Pcmm::new(method, law, &packing, |_| [speed, 0.0], Masses::FromElements)?);
//! }
//! scene.run_until(1.2e-5)?;
//! // The gap of 1 mm was closed after 10 microseconds, and the steel moves.
//! assert!(scene.totals_of(0).is_some_and(|steel| steel.momentum[0] < 0.0));
//! let steel = scene.part::<Pcmm<2, Consistent<PlaneStrain>>>(0);
//! assert!(steel.is_some_and(|steel| steel.elements() == 32));
//! # Ok(())
//! # }
//! ```
//!
//! # Limits
//! `f64` only. One law per body. Contact within a body is welding: particles of it in contact form elements, whatever piece they came from.
//! Masses and radii of particles never change.

mod audit;
mod contact;
mod elements;
mod fitted;
mod inheritance;
mod kinematics;
mod method;
mod particles;
mod pieces;
mod revise;
mod search;
pub mod simplex;
mod solver;
mod step;
mod sweep;
mod tessellation;
mod view;

pub use audit::{Audit, Coverage, Lot};
pub use elements::Incidence;
pub use inheritance::{Inheritance, Newborn, OverlapWeighted, Parent, ParticleMean, Taken};
pub use kinematics::{Configuration, Dilatation, EndOfStep, NoRotation, OfElement, OfParticles, StartOfStep};
pub use method::{Composition, Consistent, Method, Printed};
pub use mpm_contact::particles::{Bodies, PairOfParticles, RigidWall};
pub use particles::{Packing, Particle};
pub use pieces::pieces;
pub use search::Neighbours;
pub use solver::{Masses, Pcmm, SMALL};
pub use tessellation::{AzimuthFan, Flaw, Limits, LocalDelaunay, Revision, Tessellation, View};
