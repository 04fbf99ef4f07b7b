//! Contact between bodies of particles, of any method.
//!
//! Bodies with a known surface ([`ParticleBody::has_surface`]) are in contact by its points: each with the surface interpolated between the
//! points of the other body, from both sides (book, "Contact at surfaces"). Every surface particle of other bodies is in contact with the
//! nearest particle of the other body that faces it. Detectors, normals and laws are those of this crate: pairs of particles replace the
//! nodes of the material point method. Impulses of all pairs are solved for together ([`crate::relax`]); each acts on two bodies with
//! opposite signs.
//!
//! | item | |
//! |---|---|
//! | [`Bodies`] | scene of bodies with common time steps, in contact |
//! | [`ParticleBody`] | interface of a body: `pcmm::Pcmm` has it, and custom bodies may |
//! | [`RigidWall`] | half space with prescribed motion |
//! | [`PairOfParticles`] | pair in contact in the last step |
//! | [`SurfacePoint`] | surface point, with its normal |
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
//!   ([`ParticleBody::facing`]), each the nearest of its body to the other. With surface normals a flat surface is flat: blocks slide on
//!   each other and on walls without interlocking of circles. Surfaces are [`ParticleBody::beyond`] the centres.
//! - Particles without neighbours in their body are balls: the normal is towards the other particle.
//! - Particles that passed through the surface are in contact with the inside ball by ball, as far as [`ParticleBody::may_touch`] permits.
//! - Particles under a wall, or that will be in the step, are in contact with it.
//!
//! # Properties
//! Momentum is conserved to rounding, between surfaces angular momentum too. Kinetic energy taken by impulses, friction apart, is in
//! [`impactite_scene::Exchange`]: J . (u + u') / 2 with the relative velocities at the start and the end of the step. Results are bitwise
//! equal for any number of threads; checkpoints are complete.
//!
//! # Cost
//! Candidate pairs are searched among the particles in the boxes of other bodies, and kept until something has moved half a mean radius. A
//! step processes these pairs alone, and the speeds of all particles; particles surrounded by their own body ([`ParticleBody::may_touch`])
//! cost nothing more.
//!
//! # Limits
//! `f64`, equal steps for all bodies, no self-contact, no laws with memory. At the edges of cubes in space, normals of elements are
//! inclined by up to 35 degrees, since one or two triangles of each face meet there.

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
