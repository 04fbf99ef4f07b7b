//! Artificial viscosity: bulk viscosity, which smears a shock over a few cells.

use crate::eos::EnergyColumn;
use crate::lane::{Lane, Real};
use crate::parameter::{Check, ParameterError};
use crate::point::{Kinematics, Nothing, State};

/// Viscous pressure in compression.
pub trait ShockViscosity<T: Real>: std::fmt::Debug + Copy + Send + Sync + 'static {
    /// Viscous pressure in the state of a law that does not store its stress, or nothing.
    type Memory<L: Lane<Real = T>>: State<L>;
    /// Column for viscous heat in a law without an energy column, or none.
    type Heat<L: Lane<Real = T>>: EnergyColumn<L>;
    /// Return the state variable of a viscous pressure, Pa.
    fn memory<L: Lane<Real = T>>(&self, pressure: L) -> Self::Memory<L>;
    /// Return the stored viscous pressure, Pa.
    fn remembered<L: Lane<Real = T>>(&self, memory: &Self::Memory<L>) -> L;
    /// Viscous pressure q >= 0, Pa, in a step that changes the volume by a factor
    /// ([`Kinematics::volume_factor`]), at density rho, kg/m^3.
    fn pressure<L: Lane<Real = T>>(&self, kinematics: &Kinematics<L>, volume_factor: L, density: L) -> L;
    /// Coefficients for the time step limit: \[b1 c in m/s, b0\] of q = rho l d (b0 l d + b1 c) at the compression rate
    /// d. Default: zeros.
    fn coefficients(&self) -> [T; 2] {
        [T::default(); 2]
    }
}

/// No bulk viscosity: no memory, no code.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct NoViscosity;

impl<T: Real> ShockViscosity<T> for NoViscosity {
    type Memory<L: Lane<Real = T>> = Nothing;
    type Heat<L: Lane<Real = T>> = Nothing;
    #[inline(always)]
    fn memory<L: Lane<Real = T>>(&self, _: L) -> Nothing {
        Nothing
    }
    #[inline(always)]
    fn remembered<L: Lane<Real = T>>(&self, _: &Nothing) -> L {
        L::zero()
    }
    #[inline(always)]
    fn pressure<L: Lane<Real = T>>(&self, _: &Kinematics<L>, _: L, _: L) -> L {
        L::zero()
    }
}

/// Bulk viscosity q = rho l (b0 l d^2 - b1 c d) for a volumetric rate d < 0, else 0 (book, "Bulk viscosity"); l is the
/// size of the cell and c the bulk sound speed **at rest**, which saves a square root per point. d is the change of
/// volume over the time step: tr grad v differs from it by -alpha^2/dt in a step that rotates by alpha.
///
/// The stable time step is shorter with it, about l / \[Q + sqrt(Q^2 + c^2)\], Q = b1 c + b0 l |d|. `wave_speed` leaves
/// this out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BulkViscosity<T> {
    linear: T,
    quadratic: T,
    sound_speed: T,
}

impl<T: Real> BulkViscosity<T> {
    /// Create from the linear coefficient b1 (0.06 in the public decks), the quadratic b0 (1.5), and the bulk sound
    /// speed at rest, m/s.
    ///
    /// # Errors
    /// A negative coefficient or a sound speed that is not positive.
    pub fn new(linear: T, quadratic: T, sound_speed: T) -> Result<Self, ParameterError> {
        let check = Check("bulk viscosity");
        Ok(BulkViscosity {
            linear: check.not_negative("linear coefficient b1", linear)?,
            quadratic: check.not_negative("quadratic coefficient b0", quadratic)?,
            sound_speed: check.positive("sound speed", sound_speed)?,
        })
    }
}

impl<T: Real> ShockViscosity<T> for BulkViscosity<T> {
    type Memory<L: Lane<Real = T>> = L;
    type Heat<L: Lane<Real = T>> = L;
    fn coefficients(&self) -> [T; 2] {
        [self.linear * self.sound_speed, self.quadratic]
    }
    #[inline(always)]
    fn memory<L: Lane<Real = T>>(&self, pressure: L) -> L {
        pressure
    }
    #[inline(always)]
    fn remembered<L: Lane<Real = T>>(&self, memory: &L) -> L {
        *memory
    }
    #[inline(always)]
    fn pressure<L: Lane<Real = T>>(&self, kinematics: &Kinematics<L>, volume_factor: L, density: L) -> L {
        // The time step is equal for all points: its reciprocal is computed once.
        let per_time = kinematics.dt.recip();
        let rate = ((volume_factor - L::one()) * per_time).min(L::zero());
        let closing = -(rate * kinematics.length);
        let linear = L::splat(self.linear * self.sound_speed);
        density * closing * L::splat(self.quadratic).mul_add(closing, linear)
    }
}
