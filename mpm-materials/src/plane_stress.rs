//! Plane stress: laws of thin plates.

use crate::lane::{Lane, Mask, Real};
use crate::point::{Breakdown, Constitutive, Fault, Kinematics, Update};
use crate::state;
use crate::tensor::Sym3;

state! {
    /// State variables of a plate: two numbers before those of its law.
    pub struct PlaneStressState<L, S> {
        /// Thickness over reference thickness.
        pub thickness: L,
        /// Out-of-plane strain increment over the sum of the in-plane normal ones in the last step: the next initial
        /// guess.
        pub ratio: L,
        /// State of the law.
        pub law: S,
    }
}

/// The law `C` in plane stress: the out-of-plane strain increment, along z, follows from sigma_zz = 0, not from the
/// motion. For two-dimensional scenes in plane strain, of any method: volume ratios include the thickness, so that
/// masses, volumes and forces are those of a plate with an initial thickness of one metre.
///
/// A secant iteration with the law itself computes the increment, to a millionth of the stress of the increments of the
/// step; after 16 trials a point breaks down ([`Breakdown::NotConverged`]). The first trial usually suffices in elastic
/// steps, since the ratio of the last step is stored. Waves travel at plate speed, but the law returns the bulk wave
/// speed: time steps are up to some tenth shorter than necessary where a method uses that speed alone.
///
/// The law is two-dimensional: it ignores increments along z and does not support rotation out of the plane.
///
/// ```
/// use mpm_materials::{Constitutive, LinearElastic, Moduli, PlaneStress};
/// # fn main() -> Result<(), mpm_materials::ParameterError> {
/// let plate = PlaneStress::new(LinearElastic::new(7850.0, Moduli::young_poisson(206e9, 0.3)?)?);
/// assert_eq!(plate.density(), 7850.0);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlaneStress<C> {
    law: C,
}

/// Largest number of trials of the out-of-plane strain in a step.
const TRIALS: usize = 16;
/// Tolerance of sigma_zz over the stress of the strain increments at the P-wave modulus.
const LEFT: f64 = 1e-6;
/// Smallest sum of the in-plane normal increments, over all in-plane ones, at which the strain ratio is stored.
const CLEAR: f64 = 0.1;

impl<C> PlaneStress<C> {
    /// Wrap a law for plane stress.
    pub fn new(law: C) -> Self {
        PlaneStress { law }
    }
    /// Wrapped law.
    pub fn law(&self) -> &C {
        &self.law
    }
}

impl<T: Real, C: Constitutive<T>> Constitutive<T> for PlaneStress<C> {
    type State<L: Lane<Real = T>> = PlaneStressState<L, C::State<L>>;

    fn name(&self) -> &'static str {
        self.law.name()
    }
    fn density(&self) -> T {
        self.law.density()
    }
    fn has_viscous_heat(&self) -> bool {
        self.law.has_viscous_heat()
    }
    #[inline(always)]
    fn viscous_heat<L: Lane<Real = T>>(&self, now: &Self::State<L>) -> L {
        self.law.viscous_heat(&now.law)
    }
    fn shock_viscosity(&self) -> [T; 2] {
        self.law.shock_viscosity()
    }
    fn is_plane_stress(&self) -> bool {
        true
    }
    #[inline(always)]
    fn stored(&self) -> u64 {
        match self.law.stored() {
            u64::MAX => u64::MAX,
            law => 0b11 | law << 2,
        }
    }
    fn virgin(&self) -> Self::State<T::Single> {
        PlaneStressState { thickness: T::Single::one(), ratio: T::Single::zero(), law: self.law.virgin() }
    }
    #[inline(always)]
    fn update<L: Lane<Real = T>>(
        &self,
        kinematics: &Kinematics<L>,
        old: &Self::State<L>,
    ) -> Update<L, Self::State<L>> {
        let (zero, one) = (L::zero(), L::one());
        let mut motion = *kinematics;
        let x = &kinematics.increment.0;
        let along = x[0][0] + x[1][1];
        let size = x[0][0].abs() + x[1][1].abs() + x[0][1].abs() + x[1][0].abs();
        let speed = self.law.wave_speed(&old.law);
        let modulus = L::splat(self.law.density()) * speed * speed / self.law.volume_ratio(&old.law);
        let rounding = T::default_epsilon().to_double();
        let most = modulus * (size * L::of(LEFT.max(1e3 * rounding)) + L::of(8.0 * rounding));
        let stiff = modulus.gt(zero);
        let slope = L::select(stiff, modulus, one);
        let mut across = old.ratio * along;
        let (mut last, mut at_last) = (zero, zero);
        let mut found = L::Mask::splat(false);
        let mut trial = 0;
        // One loop, so that the law is compiled once.
        let new = loop {
            motion.increment.0[2][2] = across;
            let new = self.law.update(&motion, &old.law);
            let left = new.stress.0[2];
            found = found | left.abs().le(most);
            if found.all() || trial + 1 == TRIALS {
                break new;
            }
            // The first step uses the P-wave modulus, then secants follow. Converged lanes stay constant.
            let (run, rise) = (across - last, left - at_last);
            let flat = rise.le(zero) & rise.ge(zero);
            let secant = run / L::select(flat, one, rise);
            let per = if trial == 0 { one / slope } else { L::select(flat, one / slope, secant) };
            let next = L::select(found, across, across - left * per);
            (last, at_last) = (L::select(found, last, across), L::select(found, at_last, left));
            across = next;
            trial += 1;
        };
        let clear = along.abs().gt(size * L::of(CLEAR)) & size.gt(zero);
        let ratio = across / L::select(clear, along, one);
        let state = PlaneStressState {
            thickness: old.thickness * (one + across),
            ratio: L::select(clear, ratio, old.ratio),
            law: new.state,
        };
        let fault = new.fault.or(Fault::none().require(found, Breakdown::NotConverged));
        let fault = fault.require((state.thickness + state.ratio).is_finite(), Breakdown::NotFinite);
        Update { state, stress: new.stress, fault }
    }
    #[inline(always)]
    fn stress<L: Lane<Real = T>>(&self, now: &Self::State<L>) -> Sym3<L> {
        self.law.stress(&now.law)
    }
    #[inline(always)]
    fn in_range<L: Lane<Real = T>>(&self, now: &Self::State<L>) -> L::Mask {
        self.law.in_range(&now.law)
    }
    #[inline(always)]
    fn failed<L: Lane<Real = T>>(&self, now: &Self::State<L>) -> L::Mask {
        self.law.failed(&now.law)
    }
    #[inline(always)]
    fn volume_ratio<L: Lane<Real = T>>(&self, now: &Self::State<L>) -> L {
        self.law.volume_ratio(&now.law)
    }
    #[inline(always)]
    fn wave_speed<L: Lane<Real = T>>(&self, now: &Self::State<L>) -> L {
        self.law.wave_speed(&now.law)
    }
    #[inline(always)]
    fn step_speed<L: Lane<Real = T>>(&self, now: &Self::State<L>, length: L) -> L {
        self.law.step_speed(&now.law, length)
    }
    #[inline(always)]
    fn energy<L: Lane<Real = T>>(&self, now: &Self::State<L>) -> L {
        self.law.energy(&now.law)
    }
}
