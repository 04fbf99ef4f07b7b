//! What some laws can tell about themselves beyond [`Constitutive`]. Tests and methods ask for it by bounds.

use crate::lane::{Lane, Real};
use crate::point::{Constitutive, Kinematics};
use crate::tensor::Mat3;

/// A law whose stress derives from a stored energy W(F): sigma = (1/J) dW/dF F^T with W =
/// [`Constitutive::energy`].
pub trait Hyperelastic<T: Real>: Constitutive<T> {
    /// The state at deformation gradient F.
    fn deformed<L: Lane<Real = T>>(&self, deformation: &Mat3<L>) -> Self::State<L>;
}

/// A law with a yield surface.
pub trait Yields<T: Real>: Constitutive<T> {
    /// The flow stress, Pa, which sqrt(3/2 s:s) did not exceed at the end of the step from `old` to `new`.
    fn flow_stress<L: Lane<Real = T>>(
        &self,
        kinematics: &Kinematics<L>,
        old: &Self::State<L>,
        new: &Self::State<L>,
    ) -> L;
    /// Accumulated equivalent plastic strain.
    fn plastic_strain<L: Lane<Real = T>>(&self, now: &Self::State<L>) -> L;
}

/// A law whose points keep their accumulated stretch, which tells when and along which direction to cut a particle in
/// two: [`Stretching`](crate::Stretching) makes one of any law.
#[diagnostic::on_unimplemented(
    message = "particles of the law `{Self}` cannot be split: they do not keep their accumulated stretch",
    note = "wrap the law: `Stretching::new(law)`"
)]
pub trait Stretches<T: Real>: Constitutive<T> {
    /// Place among the numbers of the state of the first of seven: the components xx, yy, zz, yz, xz, xy of b = F F^T,
    /// and how often the point was cut.
    const PLACE: usize;
}
