//! Members of a scene: bodies and walls, and their particles.

use impactite_scene::Body;

use super::body::{ContactParticle, ParticleBody};
use super::wall::RigidWall;

/// Particle of a body.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(super) struct Place {
    pub body: u32,
    /// Number of the particle; zero for a wall.
    pub particle: u32,
}

/// Body or wall.
pub(super) enum Member<const D: usize> {
    /// Body, with the velocities at the start of a step in `start`.
    Body {
        part: Box<dyn ParticleBody<D>>,
        start: Vec<[f64; D]>,
    },
    Wall {
        wall: RigidWall<D>,
    },
}

impl<const D: usize> Member<D> {
    pub fn body(&self) -> &dyn Body {
        match self {
            Member::Body { part, .. } => &**part,
            Member::Wall { wall } => wall,
        }
    }
    pub fn part(&self) -> Option<&dyn ParticleBody<D>> {
        match self {
            Member::Body { part, .. } => Some(part.as_ref()),
            Member::Wall { .. } => None,
        }
    }
}

/// Particles of a body, in their order.
pub(super) fn particles<const D: usize>(
    part: &dyn ParticleBody<D>,
) -> impl Iterator<Item = ContactParticle<D>> + '_ {
    (0..part.len()).map(|n| part.particle(n))
}
