//! Contact between bodies of particles, whatever their methods.
//!
//! Bodies that know their surface ([`ParticleBody::has_surface`]) are in contact by the points of that: each with the surface interpolated
//! between the points of the other body, from both sides (book, "Contact at surfaces"). Of other bodies every particle of a surface touches the
//! nearest of the other body that faces it. Detectors, normals and laws are those of this crate:
//! where the material point method has nodes, there are pairs of particles. Impulses of all pairs are found together
//! ([`crate::relax`]); every one acts on two bodies with opposite signs.
//!
//! | item | |
//! |---|---|
//! | [`Bodies`] | a scene: bodies that take their steps together, and meet |
//! | [`ParticleBody`] | what a body answers: `pcmm::Pcmm` is one, and one's own may be |
//! | [`RigidWall`] | a half space that moves as prescribed |
//! | [`PairOfParticles`] | two that touched in the last step |
//! | [`SurfacePoint`] | a point of a surface, with its normal |
//! | [`press_on_walls`] | keeps a surface in front of walls across axes |
//!
//! ```
//! use mpm_contact::particles::{Bodies, RigidWall};
//! use mpm_contact::{Coulomb, Pairs, SurfaceDistance};
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! // Friction 0.2 between all that meets; a floor that goes to the right at 1 m/s. Bodies come by `Bodies::add`.
//! let mut scene = Bodies::<2, _>::new(SurfaceDistance::default(), Pairs::new(Coulomb::new(0.2)?));
//! let floor = scene.add_wall(RigidWall::new([0.0, 0.0], [0.0, 1.0])?.moving([1.0, 0.0])?);
//! assert!(scene.body(floor).is_none() && scene.particles(floor).count() == 0);
//! # Ok(())
//! # }
//! ```
//!
//! # Pairs of bodies without a surface of their own
//! - Particles of two bodies less than one and a half times the sum of their radii apart whose surfaces face each other
//!   ([`ParticleBody::facing`]), each the nearest of its body to the other. With normals of the surface a flat one is flat: blocks slide
//!   on each other and on walls without interlocking of circles. Surfaces lie [`ParticleBody::beyond`] the centres.
//! - A particle without neighbours in its body is a ball: its normal is towards the other.
//! - What came through the surface meets the inside ball by ball, as far as [`ParticleBody::may_touch`] says.
//! - A particle and a wall that it is under, or will be in the step.
//!
//! # What holds
//! Momentum to rounding, between surfaces angular momentum too. Kinetic energy that impulses take, friction apart, in [`impactite_scene::Exchange`]: J . (u + u') / 2 with the
//! relative velocities at the start and the end of the step. The same bits for any number of threads; checkpoints hold all.
//!
//! # Cost
//! Pairs that may touch are searched among the particles in the boxes of other bodies, and kept until something has moved half a mean
//! radius. A step looks at those pairs alone, besides the speeds of all particles; of what is surrounded by its own body
//! ([`ParticleBody::may_touch`]) at nothing more.
//!
//! # Limits
//! `f64`, steps of one length for all bodies, no contact of a body with itself, no laws that remember. At the edges of cubes in space
//! normals of elements slant by up to 35 degrees, since one or two triangles of each face meet there.

mod bodies;
mod body;
mod candidates;
mod meet;
mod member;
mod met;
mod places;
mod solve;
mod surface;
mod system;
mod wall;

pub use bodies::Bodies;
pub use body::{Advice, ContactParticle, Facing, ParticleBody, SurfacePoint};
pub use met::PairOfParticles;
pub use surface::press_on_walls;
pub use wall::RigidWall;
