//! Accumulated stretch of a point, added to a law for particle splitting.

use crate::capability::{Stretches, Yields};
use crate::lane::{Lane, Real};
use crate::point::{Breakdown, Constitutive, Kinematics, Update, mean};
use crate::state;
use crate::tensor::{Mat3, Sym3};

state! {
    /// State variables of a [`Stretching`] law: 7 numbers before those of the law itself.
    pub struct StretchingState<L, S> {
        /// Left Cauchy-Green tensor b = F F^T of the motion since the start, reduced when the point is split: its
        /// principal values are the squares of the stretches, its axes the present directions of the stretches.
        pub cauchy_green: Sym3<L>,
        /// Number of splits of the point.
        pub splits: L,
        /// State of the law.
        pub law: S,
    }
}

/// The law `C` with the accumulated stretch as state variables, required for particle splitting ([`Stretches`]).
/// Stress, energy and wave speed are those of `C`, bit for bit; a point has 7 numbers more.
///
/// A step updates b to (I + dt grad v) b (I + dt grad v)^T, exact for the motion. b includes elastic and plastic
/// deformation and volume change.
///
/// ```
/// use mpm_materials::{Constitutive, Stretching, library};
/// let lead = Stretching::new(library::lead::<f64>());
/// assert_eq!(lead.density(), 11350.0);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stretching<C> {
    law: C,
}

impl<C> Stretching<C> {
    /// Wrap a law and add its accumulated stretch.
    pub fn new(law: C) -> Self {
        Stretching { law }
    }
    /// Wrapped law.
    pub fn law(&self) -> &C {
        &self.law
    }
}

impl<T: Real, C: Constitutive<T>> Constitutive<T> for Stretching<C> {
    type State<L: Lane<Real = T>> = StretchingState<L, C::State<L>>;

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
        self.law.is_plane_stress()
    }
    #[inline(always)]
    fn stored(&self) -> u64 {
        match self.law.stored() {
            u64::MAX => u64::MAX,
            law => 0b111_1111 | law << 7,
        }
    }
    fn virgin(&self) -> Self::State<T::Single> {
        let (one, splits) = (T::Single::one(), T::Single::zero());
        StretchingState { cauchy_green: Sym3::isotropic(one), splits, law: self.law.virgin() }
    }
    #[inline(always)]
    fn update<L: Lane<Real = T>>(
        &self,
        kinematics: &Kinematics<L>,
        old: &Self::State<L>,
    ) -> Update<L, Self::State<L>> {
        let Update { state, stress, fault } = self.law.update(kinematics, &old.law);
        let motion = kinematics.increment + Mat3::identity();
        let cauchy_green = motion.congruence(&old.cauchy_green);
        let b = &cauchy_green.0;
        let sum = b[0] + b[1] + b[2] + b[3] + b[4] + b[5] + old.splits;
        let fault = fault.require(sum.is_finite(), Breakdown::NotFinite);
        Update { state: StretchingState { cauchy_green, splits: old.splits, law: state }, stress, fault }
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
    /// Merge the law; stretch and splits are means, too, which the caller adapts to the size of the new particle.
    fn merged(&self, points: &[(f64, Self::State<T::Single>)]) -> Option<Self::State<T::Single>> {
        let laws: Vec<_> = points.iter().map(|(mass, state)| (*mass, state.law)).collect();
        let law = self.law.merged(&laws)?;
        let cauchy_green = mean::<T, _>(points.iter().map(|(mass, state)| (*mass, state.cauchy_green)));
        let splits = mean::<T, T::Single>(points.iter().map(|(mass, state)| (*mass, state.splits)));
        Some(StretchingState { cauchy_green, splits, law })
    }
    fn stretch_place(&self) -> Option<usize> {
        Some(<Self as Stretches<T>>::PLACE)
    }
}

impl<T: Real, C: Constitutive<T>> Stretches<T> for Stretching<C> {
    const PLACE: usize = 0;
}

impl<T: Real, C: Yields<T>> Yields<T> for Stretching<C> {
    #[inline(always)]
    fn flow_stress<L: Lane<Real = T>>(
        &self,
        kinematics: &Kinematics<L>,
        old: &Self::State<L>,
        new: &Self::State<L>,
    ) -> L {
        self.law.flow_stress(kinematics, &old.law, &new.law)
    }
    #[inline(always)]
    fn plastic_strain<L: Lane<Real = T>>(&self, now: &Self::State<L>) -> L {
        self.law.plastic_strain(&now.law)
    }
}
