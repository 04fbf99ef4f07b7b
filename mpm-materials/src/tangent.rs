//! Trials of a law, which commit nothing, and exact differentials of its stress.

use impactite_simd::Dual;

use crate::lane::{Lane, Real};
use crate::point::{Breakdown, Constitutive, Kinematics, first_broken, flatten, unflatten};
use crate::tensor::{Mat3, Sym3};

/// Differential of a law that does not exist.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum NoDifferential {
    /// The point broke down in the trial.
    #[error("the point broke down: {0}")]
    Broken(Breakdown),
    /// The law computes single points, lane by lane, whose derivatives are not known.
    #[error("the law works on single points and has no exact differential; take differences of trials")]
    Pointwise,
}

/// Stress of a trial step and its derivative.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Differential<T> {
    /// Cauchy stress at the end of the step, Pa.
    pub stress: Sym3<T>,
    /// Derivative of the stress with respect to the displacement-gradient increment, in the given direction, Pa.
    pub change: Sym3<T>,
}

/// Trials and differentials of every law: the state is read and nothing is written, so that a step can be tried again. The
/// derivative is exact along the branch of the step (algorithmically consistent), by dual numbers ([`Dual`]).
///
/// ```
/// use mpm_materials::{Constitutive, Kinematics, LinearElastic, Mat3, Moduli, Tangent};
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let steel = LinearElastic::new(7850.0, Moduli::young_poisson(206e9, 0.3)?)?;
/// let rest = Kinematics { increment: Mat3::zero(), dt: 1e-6, length: 1e-3 };
/// let tangent: [[f64; 9]; 6] = steel.tangent(&rest, &steel.virgin())?;
/// // Row xx, column du/dx: the P-wave modulus.
/// assert!((tangent[0][0] / (206e9 * 0.7 / (1.3 * 0.4)) - 1.0).abs() < 1e-12);
/// # Ok(())
/// # }
/// ```
pub trait Tangent<T: Real>: Constitutive<T> {
    /// Return the stress at the end of a step, Pa, and leave the state as it is.
    ///
    /// # Errors
    /// Breakdown of the point.
    fn trial(
        &self,
        kinematics: &Kinematics<T::Single>,
        old: &Self::State<T::Single>,
    ) -> Result<Sym3<T::Single>, Breakdown> {
        let new = self.update(kinematics, old);
        first_broken(&new).map_or(Ok(new.stress), |broken| Err(broken.cause))
    }

    /// Return the stress at the end of a step and its derivative in the direction of an increment of the displacement
    /// gradient.
    ///
    /// # Errors
    /// Breakdown of the point; a law that computes single points.
    fn differential(
        &self,
        kinematics: &Kinematics<T::Single>,
        old: &Self::State<T::Single>,
        direction: &Mat3<T::Single>,
    ) -> Result<Differential<T::Single>, NoDifferential> {
        let increment = Mat3(std::array::from_fn(|i| {
            std::array::from_fn(|j| Dual { value: kinematics.increment.0[i][j], slope: direction.0[i][j] })
        }));
        let dual = Kinematics {
            increment,
            dt: Dual::constant(kinematics.dt),
            length: Dual::constant(kinematics.length),
        };
        let numbers: Vec<Dual<T::Single>> = flatten(old).into_iter().map(Dual::constant).collect();
        let state = unflatten(&numbers).map_err(|_| NoDifferential::Pointwise)?;
        let new = self.update(&dual, &state);
        if let Some(broken) = first_broken(&new) {
            return Err(NoDifferential::Broken(broken.cause));
        }
        let stress = Sym3(new.stress.0.map(|s| s.value));
        let change = Sym3(new.stress.0.map(|s| s.slope));
        let known = change.0.iter().all(|s| s.is_finite());
        if known { Ok(Differential { stress, change }) } else { Err(NoDifferential::Pointwise) }
    }

    /// Return the tangent at the end of a step, Pa: derivatives of the stress components xx, yy, zz, yz, xz, xy (rows) with
    /// respect to the nine components of the displacement-gradient increment, row by row (columns).
    ///
    /// # Errors
    /// Those of [`Tangent::differential`].
    fn tangent(
        &self,
        kinematics: &Kinematics<T::Single>,
        old: &Self::State<T::Single>,
    ) -> Result<[[T::Single; 9]; 6], NoDifferential> {
        let mut tangent = [[T::Single::zero(); 9]; 6];
        for column in 0..9 {
            let mut direction = Mat3::zero();
            direction.0[column / 3][column % 3] = T::Single::one();
            let Differential { change, .. } = self.differential(kinematics, old, &direction)?;
            (0..6).for_each(|row| tangent[row][column] = change.0[row]);
        }
        Ok(tangent)
    }
}

impl<T: Real, C: Constitutive<T>> Tangent<T> for C {}
