//! Rock, soil and concrete: solids whose strength depends on the pressure.

use crate::failure::combine::OfGround;
use crate::failure::{Failure, NoCrack, NoFailure, Observed};
use crate::lane::{Lane, Real};
use crate::parameter::ParameterError;
use crate::point::{Breakdown, Constitutive, Fault, Kinematics, State, Update, finite_state};
use crate::rate::{HughesWinget, ObjectiveRate};
use crate::state;
use crate::tensor::Sym3;
use crate::viscosity::{BulkViscosity, NoViscosity, ShockViscosity};

/// Trial state of a step, the input of a [`Geomaterial`].
#[derive(Clone, Copy, Debug)]
pub struct Trial<L> {
    /// Elastic trial deviator: the rotated old deviator + 2 G times the strain deviator, Pa.
    pub deviator: Sym3<L>,
    /// Deviator of the strain increment.
    pub strain_deviator: Sym3<L>,
    /// Volume ratio J at the end of the step.
    pub volume_ratio: L,
    /// Time step, s.
    pub dt: L,
    /// Size of the element or cell, m.
    pub length: L,
}

impl<L: Lane> Trial<L> {
    /// Equivalent total strain rate of the step, sqrt(2/3 e:e), 1/s, with e the deviatoric rate.
    #[inline(always)]
    pub fn equivalent_rate(&self) -> L {
        let e = &self.strain_deviator;
        (e.dot(e) * L::of(2.0 / 3.0)).sqrt() * self.dt.recip()
    }
}

/// Result of the return mapping: an admissible stress.
#[derive(Clone, Copy, Debug)]
pub struct Admissible<L, H> {
    /// Stress deviator, Pa.
    pub deviator: Sym3<L>,
    /// Pressure, Pa, compression positive.
    pub pressure: L,
    /// History at the end of the step.
    pub history: H,
    /// Lanes in which the return mapping failed.
    pub fault: Fault<L>,
}

/// A law for the whole stress, pressure and deviator together. Its pressure is a function of volume ratio and
/// history, without internal energy.
pub trait Geomaterial<T: Real>: std::fmt::Debug + Clone + Send + Sync + 'static {
    /// State variables in addition to stress, volume and energy.
    type History<L: Lane<Real = T>>: State<L>;
    /// The law's name, for messages.
    fn name(&self) -> &'static str;
    /// Reference density rho0, kg/m^3.
    fn density(&self) -> T;
    /// Shear modulus G, Pa.
    fn shear_modulus(&self) -> T;
    /// The history of a virgin point, whose stress is zero.
    fn virgin(&self) -> Self::History<T::Single>;
    /// Map the trial to the stress at the end of the step.
    fn return_map<L: Lane<Real = T>>(
        &self,
        trial: &Trial<L>,
        old: &Self::History<L>,
    ) -> Admissible<L, Self::History<L>>;
    /// Bulk modulus -J dp/dJ, Pa, the larger of loading and unloading.
    fn bulk_modulus<L: Lane<Real = T>>(&self, volume_ratio: L, history: &Self::History<L>) -> L;
    /// Shear modulus for the wave speed, Pa: zero if a point has no shear strength and cannot gain any within a step,
    /// such as torn debris. Default: [`Geomaterial::shear_modulus`].
    #[inline(always)]
    fn shear_stiffness<L: Lane<Real = T>>(&self, volume_ratio: L, history: &Self::History<L>) -> L {
        let _ = (volume_ratio, history);
        L::splat(self.shear_modulus())
    }
    /// Accumulated equivalent plastic strain.
    fn plastic_strain<L: Lane<Real = T>>(&self, history: &Self::History<L>) -> L;
    /// Damage in \[0, 1\]; zero for a law without damage.
    #[inline(always)]
    fn damage<L: Lane<Real = T>>(&self, history: &Self::History<L>) -> L {
        let _ = history;
        L::zero()
    }
}

state! {
    /// State variables of ground: eight numbers and the history of its law.
    pub struct GroundState<L, H, F> {
        /// Total Cauchy stress, viscous pressure included, Pa.
        pub stress: Sym3<L>,
        /// Volume over reference volume, J.
        pub volume_ratio: L,
        /// Internal energy e per reference volume, J/m^3: all stress work since the virgin state.
        pub energy: L,
        /// History of the law.
        pub history: H,
        /// History of the failure.
        pub failure: F,
    }
}

/// A [`Geomaterial`] as a constitutive law: sigma = s - (p + q) I. Concrete
/// ([`HolmquistJohnsonCook`](crate::strength::HolmquistJohnsonCook)), soil
/// ([`DruckerPrager`](crate::strength::DruckerPrager), [`MohrCoulomb`](crate::strength::MohrCoulomb)).
///
/// An update rotates the old stress, computes the elastic trial deviator, returns pressure and deviator together,
/// evaluates the failure criterion ([`Failure`]) and adds the viscous pressure. The energy includes the stress work of
/// the step by the trapezoidal rule.
///
/// ```
/// use mpm_materials::Ground;
/// use mpm_materials::strength::HolmquistJohnsonCook;
/// # fn main() -> Result<(), mpm_materials::ParameterError> {
/// let concrete = Ground::new(HolmquistJohnsonCook::<f64>::concrete_48()).with_bulk_viscosity(0.06, 1.5)?;
/// # let _ = concrete;
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ground<M, F = NoFailure, V = NoViscosity, R = HughesWinget> {
    law: M,
    failure: F,
    viscosity: V,
    rate: R,
}

impl<M> Ground<M> {
    /// Create ground without failure and bulk viscosity, with the [`HughesWinget`] rate.
    pub fn new(law: M) -> Self {
        Ground { law, failure: NoFailure, viscosity: NoViscosity, rate: HughesWinget }
    }
}

impl<M, F, V, R> Ground<M, F, V, R> {
    /// Set the failure criterion: `N` is `Ground<M, G, V, R>`, of a `G` that is a [`Failure`] and opens no crack, which
    /// would need an equation of state.
    pub fn with_failure<T, G, W, N>(self, failure: G) -> N
    where
        T: Real,
        M: Geomaterial<T>,
        G: OfGround<T, W, Ground<M, G, V, R>, N>,
    {
        let Ground { law, viscosity, rate, .. } = self;
        G::made(Ground { law, failure, viscosity, rate })
    }
    /// Set the bulk viscosity: linear coefficient b1 and quadratic b0, and the bulk sound speed at rest.
    ///
    /// # Errors
    /// A negative coefficient.
    pub fn with_bulk_viscosity<T: Real>(
        self,
        linear: T,
        quadratic: T,
    ) -> Result<Ground<M, F, BulkViscosity<T>, R>, ParameterError>
    where
        M: Geomaterial<T>,
    {
        let Ground { law, failure, rate, .. } = self;
        let bulk = law.bulk_modulus::<T::Single>(T::Single::one(), &law.virgin());
        let speed = (bulk / T::Single::splat(law.density())).sqrt();
        Ok(Ground { viscosity: BulkViscosity::new(linear, quadratic, speed.into())?, law, failure, rate })
    }
    /// Set the objective rate.
    pub fn with_rate<Q: ObjectiveRate>(self, rate: Q) -> Ground<M, F, V, Q> {
        let Ground { law, failure, viscosity, .. } = self;
        Ground { law, failure, viscosity, rate }
    }
    /// The law.
    pub fn law(&self) -> &M {
        &self.law
    }
}

impl<T, M, F, V, R> Constitutive<T> for Ground<M, F, V, R>
where
    T: Real,
    M: Geomaterial<T>,
    F: Failure<T, Cracks = NoCrack>,
    V: ShockViscosity<T>,
    R: ObjectiveRate,
{
    type State<L: Lane<Real = T>> = GroundState<L, M::History<L>, F::History<L>>;

    fn name(&self) -> &'static str {
        self.law.name()
    }
    fn density(&self) -> T {
        self.law.density()
    }
    fn shock_viscosity(&self) -> [T; 2] {
        self.viscosity.coefficients()
    }
    fn virgin(&self) -> Self::State<T::Single> {
        GroundState {
            stress: Sym3::zero(),
            volume_ratio: T::Single::one(),
            energy: T::Single::zero(),
            history: self.law.virgin(),
            failure: self.failure.intact(),
        }
    }
    #[inline(always)]
    fn update<L: Lane<Real = T>>(
        &self,
        kinematics: &Kinematics<L>,
        old: &Self::State<L>,
    ) -> Update<L, Self::State<L>> {
        let (zero, one, half) = (L::zero(), L::one(), L::of(0.5));
        let stilled;
        let kinematics = if self.failure.is_possible() && !self.failure.remains().compression() {
            // A removed point does not follow the motion: no work, no breakdown.
            let gone = self.failure.failed(&old.failure, self.law.plastic_strain(&old.history));
            let increment = kinematics.increment * L::select(gone, zero, one);
            stilled = Kinematics { increment, ..*kinematics };
            &stilled
        } else {
            kinematics
        };
        let step = self.rate.increments(kinematics);
        let volume_factor = step.volume_factor;
        let volume_ratio = old.volume_ratio * volume_factor;
        let density = volume_ratio.recip() * L::splat(self.law.density());

        let rotated = self.rate.rotate(&step, &old.stress);
        let old_mean = rotated.mean();
        let old_deviator = rotated.plus_isotropic(-old_mean);
        let strain_deviator = step.strain.deviator();
        let two_g = L::splat(self.law.shear_modulus() * T::of(2.0));
        let mut tried = old_deviator + strain_deviator * two_g;
        if self.failure.is_possible() && !self.failure.remains().shear() {
            let failed = self.failure.failed(&old.failure, self.law.plastic_strain(&old.history));
            tried = tried * L::select(failed, zero, one);
        }
        let trial = Trial {
            deviator: tried,
            strain_deviator,
            // An inverted point is reported below; the law must not receive it.
            volume_ratio: L::select(volume_ratio.gt(zero), volume_ratio, one),
            dt: kinematics.dt,
            length: kinematics.length,
        };
        let returned = self.law.return_map(&trial, &old.history);

        let mut deviator = returned.deviator;
        let mut pressure = returned.pressure;
        let mut viscous = self.viscosity.pressure(kinematics, volume_factor, density);
        let mut failure = old.failure;
        if self.failure.is_possible() {
            let plastic_strain = self.law.plastic_strain(&returned.history);
            let observed = Observed {
                deviator,
                pressure,
                plastic_strain,
                plastic_strain_increment: plastic_strain - self.law.plastic_strain(&old.history),
                homologous_temperature: zero,
                damage: self.law.damage(&returned.history),
                dt: kinematics.dt,
                length: kinematics.length,
            };
            failure = self.failure.judge(&observed, &old.failure);
            let failed = self.failure.failed(&failure, plastic_strain);
            let intact = L::select(failed, zero, one);
            if !self.failure.remains().shear() {
                deviator = deviator * intact;
            }
            if !self.failure.remains().compression() {
                pressure = pressure * intact;
                viscous = viscous * intact;
            } else if !self.failure.remains().tension() {
                pressure = L::select(failed, pressure.max(zero), pressure);
            }
        }

        // Work of the step, with the stress left at its end.
        let total_pressure = pressure + viscous;
        let volume_change = volume_ratio - old.volume_ratio;
        let middle_volume = old.volume_ratio + volume_change * half;
        let shear_work = middle_volume * (old_deviator + deviator).dot(&strain_deviator) * half;
        let pressure_work = (old_mean - total_pressure) * volume_change * half;
        let state = GroundState {
            stress: deviator.plus_isotropic(-total_pressure),
            volume_ratio,
            energy: old.energy + shear_work + pressure_work,
            history: returned.history,
            failure,
        };
        let fault = Fault::none()
            .require(volume_factor.gt(L::zero()), Breakdown::InvertedVolume)
            .require(volume_ratio.gt(L::zero()), Breakdown::InvertedVolume)
            .or(returned.fault)
            .require(finite_state(&state), Breakdown::NotFinite);
        Update { state, stress: state.stress, fault }
    }
    #[inline(always)]
    fn stress<L: Lane<Real = T>>(&self, now: &Self::State<L>) -> Sym3<L> {
        now.stress
    }
    #[inline(always)]
    fn volume_ratio<L: Lane<Real = T>>(&self, now: &Self::State<L>) -> L {
        now.volume_ratio
    }
    /// Squared wave speed c^2 = (K + 4 G/3)/rho with the larger bulk modulus of loading and unloading. Plastic flow does not lower it;
    /// bulk viscosity is left out. Debris without strength has no shear term ([`Geomaterial::shear_stiffness`]): it
    /// expands, and 4 G/(3 rho) at its low density would govern the time step of the whole scene.
    #[inline(always)]
    fn wave_speed<L: Lane<Real = T>>(&self, now: &Self::State<L>) -> L {
        let bulk = self.law.bulk_modulus(now.volume_ratio, &now.history);
        let shear = self.law.shear_stiffness(now.volume_ratio, &now.history) * L::of(4.0 / 3.0);
        ((bulk + shear) * now.volume_ratio * L::splat(T::of(1.0) / self.law.density())).sqrt()
    }
    #[inline(always)]
    fn energy<L: Lane<Real = T>>(&self, now: &Self::State<L>) -> L {
        now.energy
    }
    #[inline(always)]
    fn failed<L: Lane<Real = T>>(&self, now: &Self::State<L>) -> L::Mask {
        self.failure.failed(&now.failure, self.law.plastic_strain(&now.history))
    }
}
