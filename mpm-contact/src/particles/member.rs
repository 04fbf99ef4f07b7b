//! Who is in a scene: bodies and walls, and places in them.

use impactite_scene::Body;

use super::body::{ContactParticle, ParticleBody};
use super::wall::RigidWall;

/// A particle of a body.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(super) struct Place {
    pub body: u32,
    /// Zero for a wall.
    pub particle: u32,
}

/// A body or a wall.
pub(super) enum Member<const D: usize> {
    /// `start` holds the velocities at the start of a step.
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

/// The particles of a body, in their order.
pub(super) fn particles<const D: usize>(
    part: &dyn ParticleBody<D>,
) -> impl Iterator<Item = ContactParticle<D>> + '_ {
    (0..part.len()).map(|n| part.particle(n))
}
