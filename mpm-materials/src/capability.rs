//! Capabilities of laws beyond [`Constitutive`], required by trait bounds in tests and methods.

use crate::lane::{Lane, Real};
use crate::point::{Constitutive, Kinematics};
use crate::tensor::Mat3;

/// A law whose stress derives from a stored energy W(F): sigma = (1/J) dW/dF F^T with W =
/// [`Constitutive::energy`].
pub trait Hyperelastic<T: Real>: Constitutive<T> {
    /// Return the state at deformation gradient F.
    fn deformed<L: Lane<Real = T>>(&self, deformation: &Mat3<L>) -> Self::State<L>;
}

/// A law with a yield surface.
pub trait Yields<T: Real>: Constitutive<T> {
    /// Flow stress, Pa: bound of sqrt(3/2 s:s) at the end of the step from `old` to `new`.
    fn flow_stress<L: Lane<Real = T>>(
        &self,
        kinematics: &Kinematics<L>,
        old: &Self::State<L>,
        new: &Self::State<L>,
    ) -> L;
    /// Accumulated equivalent plastic strain.
    fn plastic_strain<L: Lane<Real = T>>(&self, now: &Self::State<L>) -> L;
}

/// A law that stores the accumulated stretch of a point, which determines when and in which direction to split its
/// particle: [`Stretching`](crate::Stretching) adds it to any law.
#[diagnostic::on_unimplemented(
    message = "particles of the law `{Self}` cannot be split: they do not keep their accumulated stretch",
    note = "wrap the law: `Stretching::new(law)`"
)]
pub trait Stretches<T: Real>: Constitutive<T> {
    /// Index in the state of the first of seven numbers: the components xx, yy, zz, yz, xz, xy of b = F F^T, and the
    /// number of splits.
    const PLACE: usize;
}
