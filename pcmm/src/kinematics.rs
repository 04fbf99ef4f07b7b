//! How the motion of a step becomes the increment a law sees.

use mpm_materials::{Increments, Kinematics, Lane, ObjectiveRate, SmallRotation, Sym3};

/// Strain to first order, the symmetric part of dt grad v, and no rotation of the stress, as printed: \[Feng2014\]
/// lists no objective term. A spinning body then feels its own old stress in directions it has left. Given to a law by
/// `with_rate(NoRotation)`; every law of `mpm-materials` is exact in rotations otherwise.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct NoRotation;

impl ObjectiveRate for NoRotation {
    #[inline(always)]
    fn increments<L: Lane>(&self, kinematics: &Kinematics<L>) -> Increments<L> {
        SmallRotation.increments(kinematics)
    }
    #[inline(always)]
    fn rotate<L: Lane>(&self, _: &Increments<L>, tensor: &Sym3<L>) -> Sym3<L> {
        *tensor
    }
}

/// At which configuration between the start and the end of a step the velocity gradient is taken.
pub trait Configuration: Copy + Send + Sync + 'static {
    /// The name in tables and messages.
    const NAME: &'static str;
    /// The part of the step's motion that is taken back: 1 for the start of the step, 0 for its end.
    const BACK: f64;
}

/// At the end of the step, as printed: dt grad v at the positions reached. Volumes drift from those of the elements
/// by the square of the increment, and so does a turning body's strain: w^2/2 for a turn w in a step with the rate as
/// printed ([`NoRotation`]), and twice that with laws that go back half a step themselves.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct EndOfStep;
impl Configuration for EndOfStep {
    const NAME: &'static str = "end of step";
    const BACK: f64 = 0.0;
}

/// At the start of the step: I + dt grad v is the deformation gradient of the step, and its determinant the change of
/// the element's volume. What laws expect: hyperelastic ones use it as it is, those in rate form go to the middle of the
/// step ([`Kinematics::increments`]), where a rigid rotation, however large, has a spin and no strain.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StartOfStep;
impl Configuration for StartOfStep {
    const NAME: &'static str = "start of step";
    const BACK: f64 = 1.0;
}

/// Where the change of volume of an element comes from.
pub trait Dilatation: Copy + Send + Sync + 'static {
    /// The name in tables and messages.
    const NAME: &'static str;
    /// Is it averaged over the particles?
    const AVERAGED: bool;
}

/// From its own motion, as printed. Triangles of linear velocity lock in plastic flow: too many of them must keep
/// their volume.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct OfElement;
impl Dilatation for OfElement {
    const NAME: &'static str = "volume of elements";
    const AVERAGED: bool = false;
}

/// From its particles, each of which has the mean over its elements, weighted by mass (averaged nodal pressure,
/// \[BonetBurton1998\]). Pressures are averaged by the transposed rule, so that the work of the forces is that of the
/// stresses. Frees plastic flow from locking; costs two more passes over particles and one over elements.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct OfParticles;
impl Dilatation for OfParticles {
    const NAME: &'static str = "volume of particles";
    const AVERAGED: bool = true;
}
