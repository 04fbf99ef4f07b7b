//! Increments for laws from the motion of a step.

use mpm_materials::{Increments, Kinematics, Lane, ObjectiveRate, SmallRotation, Sym3};

/// First-order strain, the symmetric part of dt grad v, without rotation of the stress, original formulation: \[Feng2014\] lists no
/// objective term. The stress of a spinning body then keeps its old directions. Set by `with_rate(NoRotation)`; every law of
/// `mpm-materials` is exact in rotations otherwise.
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

/// Configuration of the velocity gradient, between the start and the end of a step.
pub trait Configuration: Copy + Send + Sync + 'static {
    /// The name in tables and messages.
    const NAME: &'static str;
    /// Part of the step's motion that is subtracted: 1 for the start of the step, 0 for its end.
    const BACK: f64;
}

/// End of the step, original formulation: dt grad v at the new positions. Volumes drift from those of the elements by the square of the
/// increment, and so does the strain of a rotating body: w^2/2 for a rotation w in a step with the original rate ([`NoRotation`]), and
/// twice that with laws that go back half a step themselves.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct EndOfStep;
impl Configuration for EndOfStep {
    const NAME: &'static str = "end of step";
    const BACK: f64 = 0.0;
}

/// Start of the step: I + dt grad v is the deformation gradient of the step, and its determinant the volume ratio of the element. Laws
/// expect this: hyperelastic ones use it directly, those in rate form go to the middle of the step ([`Kinematics::increments`]), where a
/// rigid rotation of any size has a spin and no strain.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StartOfStep;
impl Configuration for StartOfStep {
    const NAME: &'static str = "start of step";
    const BACK: f64 = 1.0;
}

/// Source of the volume change of an element.
pub trait Dilatation: Copy + Send + Sync + 'static {
    /// The name in tables and messages.
    const NAME: &'static str;
    /// True if the volume change is averaged over the particles.
    const AVERAGED: bool;
}

/// Volume change by the element's own motion, original formulation. Triangles of linear velocity lock in plastic flow: they have too many
/// volume constraints.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct OfElement;
impl Dilatation for OfElement {
    const NAME: &'static str = "volume of elements";
    const AVERAGED: bool = false;
}

/// Volume change by the element's particles, each with the mean over its elements, weighted by mass (averaged nodal pressure,
/// \[BonetBurton1998\]). Pressures are averaged by the transposed rule, so that the work of the forces is that of the stresses. It prevents
/// volumetric locking; it costs two more passes over particles and one over elements.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct OfParticles;
impl Dilatation for OfParticles {
    const NAME: &'static str = "volume of particles";
    const AVERAGED: bool = true;
}
