//! Porous solids with compaction: the p-alpha model.

use crate::eos::{Eos, Terms, balance};
use crate::lane::{Lane, Mask, Real};
use crate::parameter::{Check, ParameterError};
use crate::point::{Breakdown, Constitutive, Fault, Kinematics, Update, finite_state};
use crate::rate::{HughesWinget, ObjectiveRate};
use crate::state;
use crate::strength::{Loading, Strength};
use crate::tensor::Sym3;
use crate::viscosity::{BulkViscosity, NoViscosity, ShockViscosity};

state! {
    /// State variables of a porous solid.
    pub struct PorousState<L, S> {
        /// Total Cauchy stress, viscous pressure included, Pa.
        pub stress: Sym3<L>,
        /// Volume over reference volume of the porous solid, J.
        pub volume_ratio: L,
        /// Internal energy e per reference volume of the porous solid, J/m^3.
        pub energy: L,
        /// Distension alpha: specific volume over that of the solid part, at least one; it never increases.
        pub distension: L,
        /// History of the strength.
        pub strength: S,
    }
}

/// Porous solid of p-alpha type (\[Herrmann1969\], \[CarrollHolt1972\], book, "Porous solids"): a strength, and the
/// equation of state of the **solid** part, p = p_s(rho alpha, e)/alpha. The distension alpha is constant while p is
/// below
///
/// P(alpha) = p_s - (p_s - p_e) sqrt((alpha - 1)/(alpha_0 - 1)),
///
/// and follows that curve on loading: from alpha_0 at the elastic limit p_e to one at the pressure of full compaction
/// p_s. Energy and alpha are implicit, as in [`Solid`](crate::Solid). Strength (shear modulus and flow stress) is that
/// of the porous solid.
///
/// Limits: elastic below p_e with the stiffness of the solid part, so that its sound speed is that of the solid (true
/// porous solids are slower); pores do not open again. **Slow during compaction**: 60 bisections compute alpha, for all
/// points of a pack in which one compacts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Porous<T, S, E, V = NoViscosity, R = HughesWinget> {
    strength: S,
    solid: E,
    distension: T,
    elastic_limit: T,
    full_compaction: T,
    viscosity: V,
    rate: R,
}

impl<T: Real, S: Strength<T>, E: Eos<T>> Porous<T, S, E> {
    /// Create from a strength, the equation of state of the solid part, the distension alpha_0 = rho_s0/rho_0 > 1, the
    /// elastic limit p_e and the pressure of full compaction p_s, Pa.
    ///
    /// # Errors
    /// alpha_0 not above 1, p_e not positive, p_s not above p_e, or a solid with initial energy.
    pub fn new(
        strength: S,
        solid: E,
        distension: T,
        elastic_limit: T,
        full_compaction: T,
    ) -> Result<Self, ParameterError> {
        let check = Check("p-alpha");
        check.that(distension > T::of(1.0), "distension alpha_0", distension, "above 1")?;
        check.positive("elastic limit p_e", elastic_limit)?;
        check.that(full_compaction > elastic_limit, "full compaction p_s", full_compaction, "above p_e")?;
        let energy = solid.initial_energy();
        check.that(energy == T::default(), "initial energy of the solid part", energy, "zero")?;
        let (viscosity, rate) = (NoViscosity, HughesWinget);
        Ok(Porous { strength, solid, distension, elastic_limit, full_compaction, viscosity, rate })
    }
}

impl<T: Real, S: Strength<T>, E: Eos<T>, V, R> Porous<T, S, E, V, R> {
    /// Set the bulk viscosity: linear coefficient b1 and quadratic b0.
    ///
    /// # Errors
    /// A negative coefficient.
    pub fn with_bulk_viscosity(
        self,
        linear: T,
        quadratic: T,
    ) -> Result<Porous<T, S, E, BulkViscosity<T>, R>, ParameterError> {
        let Porous { strength, solid, distension, elastic_limit, full_compaction, rate, .. } = self;
        let viscosity = BulkViscosity::new(linear, quadratic, solid.rest_speed())?;
        Ok(Porous { strength, solid, distension, elastic_limit, full_compaction, viscosity, rate })
    }
    pub(crate) fn with_viscosity<W>(self, viscosity: W) -> Porous<T, S, E, W, R> {
        let Porous { strength, solid, distension, elastic_limit, full_compaction, rate, .. } = self;
        Porous { strength, solid, distension, elastic_limit, full_compaction, viscosity, rate }
    }
    /// Set the objective rate.
    pub fn with_rate<Q: ObjectiveRate>(self, rate: Q) -> Porous<T, S, E, V, Q> {
        let Porous { strength, solid, distension, elastic_limit, full_compaction, viscosity, .. } = self;
        Porous { strength, solid, distension, elastic_limit, full_compaction, viscosity, rate }
    }

    fn density(&self) -> T {
        self.solid.density() / self.distension
    }

    /// Volume ratio of the solid part.
    #[inline(always)]
    fn solid_ratio<L: Lane<Real = T>>(&self, volume_ratio: L, distension: L) -> L {
        volume_ratio * L::splat(self.distension) / distension
    }

    /// Terms of the pressure at a distension.
    #[inline(always)]
    fn terms<L: Lane<Real = T>>(&self, volume_ratio: L, distension: L) -> Terms<L> {
        let Terms { cold, thermal } = self.solid.terms(self.solid_ratio(volume_ratio, distension));
        let inverse = distension.recip();
        Terms { cold: cold * inverse, thermal: thermal * inverse * L::splat(self.distension) }
    }

    /// Crush pressure P(alpha), Pa.
    #[inline(always)]
    fn crush_pressure<L: Lane<Real = T>>(&self, distension: L) -> L {
        let open =
            (distension - L::one()).max(L::zero()) * L::splat(T::of(1.0) / (self.distension - T::of(1.0)));
        L::splat(self.full_compaction) - L::splat(self.full_compaction - self.elastic_limit) * open.sqrt()
    }

    /// True if the pressure at this distension exceeds P(alpha).
    #[inline(always)]
    fn crushes<L: Lane<Real = T>>(&self, volume_ratio: L, distension: L, worked: L, change: L) -> L::Mask {
        let found = balance(self.terms(volume_ratio, distension), worked, change);
        found.pressure.gt(self.crush_pressure(distension))
    }

    /// Distension at the end of the step.
    #[inline(always)]
    fn compacted<L: Lane<Real = T>>(&self, volume_ratio: L, old: L, worked: L, change: L) -> L {
        let one = L::one();
        let (mut low, mut high) = (one, old);
        let (mut compacts, mut full) = (L::Mask::splat(false), L::Mask::splat(false));
        // The old distension, full compaction, then bisections: one loop, so that the equation of state is compiled once.
        for trial in 0..62 {
            let at = match trial {
                0 => old,
                1 => one,
                _ => (low + high) * L::of(0.5),
            };
            let crushes = self.crushes(volume_ratio, at, worked, change);
            match trial {
                0 => {
                    compacts = crushes & old.gt(one);
                    if !compacts.any() {
                        return old;
                    }
                }
                1 => full = crushes,
                _ => {
                    high = L::select(crushes, at, high);
                    low = L::select(crushes, low, at);
                }
            }
        }
        L::select(compacts, L::select(full, one, low), old)
    }
}

impl<T, S, E, V, R> Constitutive<T> for Porous<T, S, E, V, R>
where
    T: Real,
    S: Strength<T>,
    E: Eos<T>,
    V: ShockViscosity<T>,
    R: ObjectiveRate,
{
    type State<L: Lane<Real = T>> = PorousState<L, S::History<L>>;

    fn name(&self) -> &'static str {
        "p-alpha"
    }
    /// Reference density of the porous solid, rho_s0/alpha_0.
    fn density(&self) -> T {
        self.density()
    }
    fn shock_viscosity(&self) -> [T; 2] {
        self.viscosity.coefficients()
    }
    #[inline(always)]
    fn stored(&self) -> u64 {
        // Stress, volume ratio, energy and distension come first.
        match self.strength.stored() {
            u64::MAX => u64::MAX,
            strength => 0x1ff | strength << 9,
        }
    }
    fn virgin(&self) -> Self::State<T::Single> {
        PorousState {
            stress: Sym3::zero(),
            volume_ratio: T::Single::one(),
            energy: T::Single::zero(),
            distension: T::Single::splat(self.distension),
            strength: self.strength.virgin(),
        }
    }
    #[inline(always)]
    fn update<L: Lane<Real = T>>(
        &self,
        kinematics: &Kinematics<L>,
        old: &Self::State<L>,
    ) -> Update<L, Self::State<L>> {
        let half = L::of(0.5);
        let step = self.rate.increments(kinematics);
        let volume_factor = step.volume_factor;
        let volume_ratio = old.volume_ratio * volume_factor;
        let density = volume_ratio.recip() * L::splat(self.density());

        let rotated = self.rate.rotate(&step, &old.stress);
        let old_mean = rotated.mean();
        let old_deviator = rotated.plus_isotropic(-old_mean);
        let loading = Loading::of(kinematics, &step.strain, -old_mean, density.recip());
        let two_g = L::splat(self.strength.shear_modulus() * T::of(2.0));
        let trial = old_deviator + loading.strain_deviator * two_g;
        let returned = self.strength.return_map(&trial, &loading, &old.strength);

        let viscous = self.viscosity.pressure(kinematics, volume_factor, density);
        let volume_change = volume_ratio - old.volume_ratio;
        let middle_volume = old.volume_ratio + volume_change * half;
        let power = (old_deviator + returned.deviator).dot(&loading.strain_deviator) * half;
        let push = (viscous - old_mean) * half;
        let worked = old.energy + middle_volume * power - push * volume_change;
        let distension = self.compacted(volume_ratio, old.distension, worked, volume_change);
        let balanced = balance(self.terms(volume_ratio, distension), worked, volume_change);

        let state = PorousState {
            stress: returned.deviator.plus_isotropic(-(balanced.pressure + viscous)),
            volume_ratio,
            energy: balanced.energy,
            distension,
            strength: returned.history,
        };
        let fault = Fault::none()
            .require(volume_factor.gt(L::zero()), Breakdown::InvertedVolume)
            .require(volume_ratio.gt(L::zero()), Breakdown::InvertedVolume)
            .require(finite_state(&state), Breakdown::NotFinite)
            .or(returned.fault);
        Update { state, stress: state.stress, fault }
    }
    #[inline(always)]
    fn stress<L: Lane<Real = T>>(&self, now: &Self::State<L>) -> Sym3<L> {
        now.stress
    }
    #[inline(always)]
    fn in_range<L: Lane<Real = T>>(&self, now: &Self::State<L>) -> L::Mask {
        self.solid.in_range(self.solid_ratio(now.volume_ratio, now.distension))
    }
    #[inline(always)]
    fn volume_ratio<L: Lane<Real = T>>(&self, now: &Self::State<L>) -> L {
        now.volume_ratio
    }
    /// Squared wave speed c^2 = c_s^2 + 4 G/(3 rho), with c_s the bulk sound speed of the solid part, that of unloading.
    #[inline(always)]
    fn wave_speed<L: Lane<Real = T>>(&self, now: &Self::State<L>) -> L {
        let ratio = self.solid_ratio(now.volume_ratio, now.distension);
        let bulk = self.solid.speed_squared(ratio, now.energy * L::splat(self.distension)).max(L::zero());
        let stiffening = self.strength.stiffening(-now.stress.mean(), now.volume_ratio, &now.strength);
        let shear = L::splat(self.strength.shear_modulus() * T::of(4.0 / 3.0) / self.density());
        (shear * stiffening).mul_add(now.volume_ratio, bulk).sqrt()
    }
    #[inline(always)]
    fn energy<L: Lane<Real = T>>(&self, now: &Self::State<L>) -> L {
        now.energy
    }
}
