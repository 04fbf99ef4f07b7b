//! Transfers: update of particle velocities from nodal velocities.

use mpm_materials::{Lane, Real, Wide};

use crate::shape::AffineShape;

/// Grid-to-particle velocity update.
pub trait Transfer<T: Real>: Copy + Send + Sync + 'static {
    /// Name in tables and messages.
    const NAME: &'static str;
    /// True if it reads the nodal velocity. A pass gathers this velocity only if the transfer or another operation reads it.
    const READS_VELOCITY: bool = true;
    /// True if it reads the nodal acceleration.
    const READS_INCREMENT: bool;
    /// True if it carries the affine velocity field of APIC from the gather to the next scatter.
    const AFFINE: bool = false;
    /// True if the affine fit is also the velocity gradient and the force is its adjoint (MLS-MPM).
    const LEAST_SQUARES: bool = false;
    /// Order k of the approximate inverse of the full mass matrix (FMPM); 1 for the lumped mass.
    const ORDER: usize = 1;

    /// Return the new velocity from the `old` one, the nodal velocity `nodal` and its change over the step
    /// `increment`, both interpolated at the particle.
    fn velocity<L: Lane<Real = T>>(&self, old: L, nodal: L, increment: L, dt: L) -> L;
}

/// PIC fraction of the transfer in a step of `dt`: 0 for FLIP, 1 for PIC.
pub(crate) fn taken<T: Real, X: Transfer<T>>(transfer: &X, dt: T) -> T {
    let [nothing, nodal, dt] = [T::default(), T::of(1.0), dt].map(|x| Wide([x]));
    let Wide([taken]) = transfer.velocity(nothing, nodal, nothing, dt);
    taken
}

/// FLIP: v <- v + dt sum N a (eq. 17 of \[Ma2010\]). It does not dissipate by itself.
#[derive(Clone, Copy, Debug, Default)]
pub struct Flip;
impl<T: Real> Transfer<T> for Flip {
    const NAME: &'static str = "FLIP";
    const READS_VELOCITY: bool = false;
    const READS_INCREMENT: bool = true;
    #[inline(always)]
    fn velocity<L: Lane<Real = T>>(&self, old: L, _nodal: L, increment: L, _dt: L) -> L {
        old + increment
    }
}

/// PIC: v <- sum N v. Removes velocity components that the grid does not resolve; viscosity (p + 1) h^2 / 12 dt.
#[derive(Clone, Copy, Debug, Default)]
pub struct Pic;
impl<T: Real> Transfer<T> for Pic {
    const NAME: &'static str = "PIC";
    const READS_INCREMENT: bool = false;
    #[inline(always)]
    fn velocity<L: Lane<Real = T>>(&self, _old: L, nodal: L, _increment: L, _dt: L) -> L {
        nodal
    }
}

/// FLIP that relaxes towards PIC with a time constant tau: the PIC fraction of a step is dt / tau (at most 1), so
/// that the damping does not depend on the step size, unlike that of a constant fraction.
#[derive(Clone, Copy, Debug)]
pub struct Blend<T> {
    tau: T,
}
impl<T: Real> Blend<T> {
    /// Create the transfer with time constant tau, s.
    ///
    /// # Errors
    /// A time constant that is not positive.
    pub fn new(tau: T) -> Result<Self, mpm_materials::ParameterError> {
        Ok(Blend { tau: mpm_materials::Check("FLIP/PIC blend").positive("time constant", tau)? })
    }
}
impl<T: Real> Transfer<T> for Blend<T> {
    const NAME: &'static str = "FLIP/PIC blend";
    const READS_INCREMENT: bool = true;
    #[inline(always)]
    fn velocity<L: Lane<Real = T>>(&self, old: L, nodal: L, increment: L, dt: L) -> L {
        let share = (dt / L::splat(self.tau)).min(L::one());
        let flip = old + increment;
        share.mul_add(nodal - flip, flip)
    }
}

/// APIC (Jiang, Schroeder, Teran 2017): PIC that carries the local affine velocity field, so that angular momentum is
/// conserved. The affine matrix exists only from the gather to the next scatter in the same pass, and needs no
/// memory.
#[derive(Clone, Copy, Debug, Default)]
pub struct Apic;
impl<T: Real> Transfer<T> for Apic {
    const NAME: &'static str = "APIC";
    const READS_INCREMENT: bool = false;
    const AFFINE: bool = true;
    #[inline(always)]
    fn velocity<L: Lane<Real = T>>(&self, _old: L, nodal: L, _increment: L, _dt: L) -> L {
        nodal
    }
}

/// FLIP with the affine velocity field of APIC (AFLIP, \[Fei2021\]): particles receive the change of the nodal
/// velocity and, per step, a fraction of that velocity itself. Particle velocities are mapped with the affine field
/// around them.
///
/// A PIC fraction of a thousandth to a hundredth per step suffices to remove velocity components that the nodes do
/// not resolve; APIC removes all of them at once. In impacts AFLIP damps a quarter to a third of what APIC damps, and
/// like APIC it comes to rest. Angular momentum, which APIC conserves on B-splines, is nearly conserved: -0.01 % per
/// turn for a disc with a radius of ten cells (book, "Methods compared"). The fraction refers to steps of the default
/// length: shorter steps damp more per time.
#[derive(Clone, Copy, Debug)]
pub struct Aflip<T = f64> {
    share: T,
}
impl<T: Real> Aflip<T> {
    /// Create the transfer with a PIC fraction per step, 0 to 1.
    ///
    /// # Errors
    /// A fraction out of range.
    pub fn new(share: T) -> Result<Self, mpm_materials::ParameterError> {
        let allowed = share >= T::default() && share <= T::of(1.0);
        Ok(Aflip { share: mpm_materials::Check("AFLIP").that(allowed, "share", share, "0 to 1")? })
    }
}
impl<T: Real> Default for Aflip<T> {
    /// PIC fraction of one hundredth.
    fn default() -> Self {
        Aflip { share: T::of(0.01) }
    }
}
impl<T: Real> Transfer<T> for Aflip<T> {
    const NAME: &'static str = "AFLIP";
    const READS_INCREMENT: bool = true;
    const AFFINE: bool = true;
    #[inline(always)]
    fn velocity<L: Lane<Real = T>>(&self, old: L, nodal: L, increment: L, _dt: L) -> L {
        let flip = old + increment;
        L::splat(self.share).mul_add(nodal - flip, flip)
    }
}

/// APIC in moving-least-squares form (Hu et al. 2018): the affine fit serves as the velocity gradient, and its
/// adjoint maps the force, f_i = -V sigma D^-1 N_i (x_i - x_p). It needs no gradients of weights: the cheapest affine
/// step, as accurate as [`Apic`] in the bulk, first order where the fit is.
#[derive(Clone, Copy, Debug, Default)]
pub struct Mls;
impl<T: Real> Transfer<T> for Mls {
    const NAME: &'static str = "MLS-APIC";
    const READS_INCREMENT: bool = false;
    const AFFINE: bool = true;
    const LEAST_SQUARES: bool = true;
    #[inline(always)]
    fn velocity<L: Lane<Real = T>>(&self, _old: L, nodal: L, _increment: L, _dt: L) -> L {
        nodal
    }
}

/// FMPM(K), also XPIC(K) (Nairn 2021; Hammerquist and Nairn 2017): PIC with the grid velocity multiplied by K
/// terms of the series sum_j (I - S~)^j for the inverse of the full mass matrix. K = 1 is PIC; each further
/// order maps once more to the particles and back. Orders are 1 to 16 ([`FmpmOrder`]).
#[derive(Clone, Copy, Debug, Default)]
pub struct Fmpm<const K: usize>;
impl<T: Real, const K: usize> Transfer<T> for Fmpm<K>
where
    Fmpm<K>: FmpmOrder,
{
    const NAME: &'static str = <Self as FmpmOrder>::NAME;
    const READS_INCREMENT: bool = false;
    const ORDER: usize = K;
    #[inline(always)]
    fn velocity<L: Lane<Real = T>>(&self, _old: L, nodal: L, _increment: L, _dt: L) -> L {
        nodal
    }
}

/// Orders of FMPM, listed one by one because stable Rust cannot bound a number: a series without terms is not a
/// transfer, and beyond 16 a step would map more than thirty times to the nodes and back.
#[diagnostic::on_unimplemented(
    message = "`{Self}` is not a transfer: its order is not allowed",
    note = "the order K of `Fmpm::<K>` must be 1 to 16; `Fmpm::<1>` is PIC, `Fmpm::<2>` and `Fmpm::<4>` are usual"
)]
pub trait FmpmOrder {
    /// Name in tables and messages.
    const NAME: &'static str;
}
macro_rules! orders {
    ($($k:literal)*) => {$(
        impl FmpmOrder for Fmpm<$k> {
            const NAME: &'static str = concat!("FMPM(", $k, ")");
        }
    )*};
}
orders!(1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16);

/// Particle-to-grid part of a transfer: particle velocities do not change.
#[derive(Clone, Copy, Debug, Default)]
pub struct Held<X>(pub(crate) X);
impl<T: Real, X: Transfer<T>> Transfer<T> for Held<X> {
    const NAME: &'static str = X::NAME;
    const READS_INCREMENT: bool = X::READS_INCREMENT;
    const AFFINE: bool = X::AFFINE;
    const LEAST_SQUARES: bool = X::LEAST_SQUARES;
    #[inline(always)]
    fn velocity<L: Lane<Real = T>>(&self, old: L, _nodal: L, _increment: L, _dt: L) -> L {
        old
    }
}

/// Placeholder transfer for passes that change no velocity.
#[derive(Clone, Copy, Debug, Default)]
pub struct AnyTransfer;
impl<T: Real> Transfer<T> for AnyTransfer {
    const NAME: &'static str = "any";
    const READS_VELOCITY: bool = false;
    const READS_INCREMENT: bool = false;
    #[inline(always)]
    fn velocity<L: Lane<Real = T>>(&self, old: L, _nodal: L, _increment: L, _dt: L) -> L {
        old
    }
}

/// Shape functions that a transfer supports: one with an affine velocity field requires an [`AffineShape`], the
/// others accept any. Declare the shape functions of a custom transfer by `impl Suits<Mine> for Gimp {}`.
#[diagnostic::on_unimplemented(
    message = "the transfer `{X}` cannot be used with the shape function `{Self}`",
    note = "a transfer of one's own says which shape functions it goes with: `impl Suits<Mine> for Gimp {{}}`"
)]
pub trait Suits<X> {}
impl<S> Suits<Flip> for S {}
impl<S> Suits<Pic> for S {}
impl<S, T> Suits<Blend<T>> for S {}
impl<S, const K: usize> Suits<Fmpm<K>> for S where Fmpm<K>: FmpmOrder {}
impl<S: AffineShape> Suits<Apic> for S {}
impl<S: AffineShape> Suits<Mls> for S {}
impl<S: AffineShape, T> Suits<Aflip<T>> for S {}
