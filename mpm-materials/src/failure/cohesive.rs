//! Cohesive spall: tension decreases with the crack opening, for a given work of fracture.

use crate::failure::{Failure, Observed, OpeningCrack, Strain};
use crate::lane::{Lane, Real};
use crate::parameter::{Check, ParameterError};
use crate::state;

state! {
    /// State variables of an opening crack.
    pub struct Crack<L> {
        /// Volume of the open crack over reference volume.
        pub crack_volume: L,
        /// Largest opening so far over w_c, in \[0, 1\]; one if the point has failed.
        pub crack_damage: L,
    }
}

/// Cohesive spall \[Hillerborg1976\]: a crack opens where the mean tension reaches sigma_sp and carries
/// sigma = sigma_sp (1 - w/w_c) at the opening w; at w_c the point has failed. A closing crack unloads on the straight
/// line to the origin; a closed one carries no tension. The work per area is G_c = sigma_sp w_c/2 for any cell size:
/// the crack is as wide as one cell h, w = h x volume of the crack over reference volume (a crack band,
/// \[BazantOh1983\]), and the equation of state uses the volume beside it (book, "Damage and time to failure").
///
/// Cells must be smaller than 2 G_c K/sigma_sp^2 = w_c K/sigma_sp, K the bulk modulus: larger ones store more energy
/// than the surface dissipates, and fail as soon as the strength is reached, as with
/// [`TensilePressure`](crate::failure::TensilePressure). The deviator is lost at full opening. Two state variables. For
/// a [`Solid`](crate::Solid), with one such criterion at most:
///
/// ```
/// use mpm_materials::{CohesiveSpall, Constitutive, PlasticStrainLimit, library};
/// # fn main() -> Result<(), mpm_materials::ParameterError> {
/// let spall = CohesiveSpall::of_work(1.2e9, 2e4)?;
/// let copper = library::copper_ofhc().with_failure((spall, PlasticStrainLimit::new(2.0)?));
/// assert!(copper.wave_speed(&copper.virgin()) > 4e3);
/// # Ok(())
/// # }
/// ```
///
/// Two criteria that open cracks do not compile ([`combine`](crate::failure::combine)):
/// ```compile_fail,E0277
/// use mpm_materials::{CohesiveSpall, library};
/// # fn main() -> Result<(), mpm_materials::ParameterError> {
/// let spall = CohesiveSpall::of_work(1.2e9, 2e4)?;
/// let copper = library::copper_ofhc().with_failure((spall, spall));
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CohesiveSpall<T> {
    strength: T,
    opening: T,
}

impl<T: Real> CohesiveSpall<T> {
    /// Create from spall strength sigma_sp, Pa, and opening w_c of zero stress, m.
    ///
    /// # Errors
    /// A number that is not positive.
    pub fn new(strength: T, opening: T) -> Result<Self, ParameterError> {
        let check = Check("cohesive spall");
        Ok(CohesiveSpall {
            strength: check.positive("spall strength", strength)?,
            opening: check.positive("opening w_c", opening)?,
        })
    }
    /// Create from spall strength sigma_sp, Pa, and work of fracture per area G_c, J/m^2.
    ///
    /// # Errors
    /// A number that is not positive.
    pub fn of_work(strength: T, work: T) -> Result<Self, ParameterError> {
        let check = Check("cohesive spall");
        let strength = check.positive("spall strength", strength)?;
        let work = check.positive("work of the crack G_c", work)?;
        CohesiveSpall::new(strength, T::of(2.0) * work / strength)
    }
    /// The opening w_c, m.
    pub fn opening(&self) -> T {
        self.opening
    }
}

impl<T: Real> Failure<T> for CohesiveSpall<T> {
    type Cracks = OpeningCrack;
    type History<L: Lane<Real = T>> = Crack<L>;
    fn intact(&self) -> Crack<T::Single> {
        Crack { crack_volume: T::Single::zero(), crack_damage: T::Single::zero() }
    }
    #[inline(always)]
    fn failed<L: Lane<Real = T>>(&self, history: &Crack<L>, _: L) -> L::Mask {
        history.crack_damage.ge(L::one())
    }
    #[inline(always)]
    fn judge<L: Lane<Real = T>>(&self, _: &Observed<L>, old: &Crack<L>) -> Crack<L> {
        *old
    }
    #[inline(always)]
    fn crack_volume<L: Lane<Real = T>>(&self, history: &Crack<L>) -> L {
        history.crack_volume
    }
    #[inline(always)]
    fn opens<L: Lane<Real = T>>(&self, history: &Crack<L>, pressure: L) -> L::Mask {
        let (zero, one) = (L::zero(), L::one());
        let cracked = history.crack_damage.gt(zero);
        let bears = L::select(cracked, zero, L::splat(self.strength));
        let strained = (zero - pressure).gt(bears) | history.crack_volume.gt(zero);
        strained & history.crack_damage.lt(one)
    }
    /// Solve t + K (v - v') = sigma(v'), with t the tension and K the stiffness. It is linear in v' on both branches:
    /// softening from the strength, and unloading to the origin if the crack was wider before the step.
    #[inline(always)]
    fn opened<L: Lane<Real = T>>(&self, strain: &Strain<L>, now: &Crack<L>, old: &Crack<L>) -> Crack<L> {
        let (zero, one) = (L::zero(), L::one());
        let strength = L::splat(self.strength);
        let full = L::splat(self.opening) * strain.length.recip();
        let damage = old.crack_damage;
        // Tension if the crack were closed.
        let closed = strain.stiffness.mul_add(now.crack_volume, zero - strain.pressure);
        // No intermediate state if the material is softer than the softening branch.
        let stable = (strain.stiffness * full).gt(strength * L::of(1.0 + 1e-3));
        let slope = L::select(stable, strain.stiffness - strength * full.recip(), one);
        let down = (closed - strength) * slope.recip();
        let widest = damage * full;
        let opens = self.opens(now, strain.pressure);
        let wider = opens & stable & down.gt(widest);
        let breaks = opens & ((wider & down.ge(full)) | (!stable & closed.gt(strength)));
        // Unload on the line to the origin; close the crack where it would carry compression.
        let both = strain.stiffness * widest + strength * (one - damage);
        let back = (closed * widest * both.recip()).max(zero);
        let volume = L::select(wider, down, back);
        let reached = L::select(wider, down * full.recip(), damage);
        Crack {
            crack_volume: L::select(breaks, zero, L::select(opens, volume, now.crack_volume)),
            crack_damage: L::select(breaks, one, L::select(opens, reached, now.crack_damage)),
        }
    }
}
