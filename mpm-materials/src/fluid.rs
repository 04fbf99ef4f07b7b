//! A compressible fluid from any equation of state.

use impactite_simd::Float;

use crate::eos::{EnergyColumn, Eos, Tait, balance};
use crate::lane::{Lane, Real};
use crate::material::Material;
use crate::parameter::{Check, ParameterError};
use crate::point::{
    Breakdown, Constitutive, Fault, Kinematics, Nothing, State, Update, alike, finite_state, mean,
};
use crate::solid::LIKE_VOLUME;
use crate::state;
use crate::tensor::Sym3;
use crate::viscosity::{BulkViscosity, NoViscosity, ShockViscosity};

state! {
    /// State variables of a fluid: one number if the pressure depends on the volume alone, two with internal energy;
    /// six more with shear viscosity, one more with bulk viscosity, and one more with either if the internal energy is
    /// not stored.
    pub struct FluidState<L, E, N, Q, H> {
        /// Volume over reference volume, J.
        pub volume_ratio: L,
        /// Internal energy e per reference volume, J/m^3, if the equation of state stores it.
        pub energy: E,
        /// Viscous deviator of the last step, Pa, with shear viscosity only.
        pub viscous_stress: N,
        /// Viscous pressure of the last step, Pa, with bulk viscosity only.
        pub viscous_pressure: Q,
        /// Viscous heat per reference volume, J/m^3, of a viscous fluid whose equation of state stores no energy.
        pub viscous_heat: H,
    }
}

/// Shear viscosity model of a fluid.
pub trait ShearViscosity<T: Real>: std::fmt::Debug + Copy + Send + Sync + 'static {
    /// Viscous deviator in the state, or nothing.
    type Memory<L: Lane<Real = T>>: State<L>;
    /// Column for the heat of this viscosity and of another one, which has the column `H`.
    type Heat<L: Lane<Real = T>, H: EnergyColumn<L>>: EnergyColumn<L>;
    /// Compute the viscous deviator of a step.
    fn deviator<L: Lane<Real = T>>(&self, kinematics: &Kinematics<L>) -> Self::Memory<L>;
    /// Return the deviator as a tensor, Pa.
    fn stress<L: Lane<Real = T>>(&self, memory: &Self::Memory<L>) -> Sym3<L>;
    /// Largest dynamic viscosity, Pa s, for the time step limit.
    fn largest(&self) -> T;
    /// Bit mask of the stored state variables; `None`: all are stored.
    #[inline(always)]
    fn stored(&self) -> Option<u64> {
        None
    }
}

/// No shear viscosity.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Inviscid;

impl<T: Real> ShearViscosity<T> for Inviscid {
    type Memory<L: Lane<Real = T>> = Nothing;
    type Heat<L: Lane<Real = T>, H: EnergyColumn<L>> = H;
    #[inline(always)]
    fn deviator<L: Lane<Real = T>>(&self, _: &Kinematics<L>) -> Nothing {
        Nothing
    }
    #[inline(always)]
    fn stress<L: Lane<Real = T>>(&self, _: &Nothing) -> Sym3<L> {
        Sym3::zero()
    }
    fn largest(&self) -> T {
        T::of(0.0)
    }
}

/// Newtonian fluid: s = 2 eta dev(d), d the rate of deformation (book, "Viscous fluid").
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Newtonian<T> {
    viscosity: T,
}

impl<T: Real> Newtonian<T> {
    /// Create from the dynamic viscosity eta, Pa s.
    ///
    /// # Errors
    /// A viscosity that is not positive; for zero use [`Inviscid`].
    pub fn new(viscosity: T) -> Result<Self, ParameterError> {
        Ok(Newtonian { viscosity: Check("Newtonian fluid").positive("dynamic viscosity eta", viscosity)? })
    }
}

impl<T: Real> ShearViscosity<T> for Newtonian<T> {
    type Memory<L: Lane<Real = T>> = Sym3<L>;
    type Heat<L: Lane<Real = T>, H: EnergyColumn<L>> = L;
    #[inline(always)]
    fn deviator<L: Lane<Real = T>>(&self, kinematics: &Kinematics<L>) -> Sym3<L> {
        kinematics.strain().deviator() * (L::splat(self.viscosity * T::of(2.0)) / kinematics.dt)
    }
    #[inline(always)]
    fn stress<L: Lane<Real = T>>(&self, memory: &Sym3<L>) -> Sym3<L> {
        *memory
    }
    fn largest(&self) -> T {
        self.viscosity
    }
}

/// Bingham fluid, regularised as by Papanastasiou (book, "Other flow stresses"): s = 2 dev(d) \[eta + tau_y (1 -
/// exp(-g/g0))/g\] with g = sqrt(2 dev d : dev d) the shear rate. Above a few g0 the shear stress is tau_y + eta g;
/// below g0 the fluid creeps with viscosity eta + tau_y/g0.
///
/// Limits: the creep viscosity limits the stable time step, dt below 3 rho h^2/(8 eta); time controls respect it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bingham<T> {
    yield_stress: T,
    viscosity: T,
    rate: T,
}

impl<T: Real> Bingham<T> {
    /// Create from yield stress in shear tau_y, Pa, plastic viscosity eta, Pa s, and creep shear rate g0, 1/s.
    ///
    /// # Errors
    /// A number that is not positive; without yield stress use [`Newtonian`].
    pub fn new(yield_stress: T, viscosity: T, rate: T) -> Result<Self, ParameterError> {
        let check = Check("Bingham fluid");
        Ok(Bingham {
            yield_stress: check.positive("yield stress tau_y", yield_stress)?,
            viscosity: check.positive("plastic viscosity eta", viscosity)?,
            rate: check.positive("creep rate g0", rate)?,
        })
    }
}

impl<T: Real> ShearViscosity<T> for Bingham<T> {
    type Memory<L: Lane<Real = T>> = Sym3<L>;
    type Heat<L: Lane<Real = T>, H: EnergyColumn<L>> = L;
    #[inline(always)]
    fn deviator<L: Lane<Real = T>>(&self, kinematics: &Kinematics<L>) -> Sym3<L> {
        let one = L::one();
        let rate = kinematics.strain().deviator() * kinematics.dt.recip();
        let x = (rate.dot(&rate) * L::of(2.0)).sqrt() * L::splat(T::of(1.0) / self.rate);
        // (1 - exp(-x))/x, by its series where the difference would cancel.
        let small = L::of(1e-3);
        let wide = x.max(small);
        let series = one - x * L::of(0.5) * (one - x * L::of(1.0 / 3.0));
        let share = L::select(x.lt(small), series, (one - (-wide).exp()) / wide);
        let creep = L::splat(self.yield_stress / self.rate);
        rate * (L::of(2.0) * creep.mul_add(share, L::splat(self.viscosity)))
    }
    #[inline(always)]
    fn stress<L: Lane<Real = T>>(&self, memory: &Sym3<L>) -> Sym3<L> {
        *memory
    }
    /// Creep viscosity.
    fn largest(&self) -> T {
        self.viscosity + self.yield_stress / self.rate
    }
}

/// Compressible fluid, sigma = -(p + q) I + 2 eta dev(d).
///
/// The energy includes the work of pressure, bulk viscosity and shear viscosity. If the equation of state stores no
/// energy, it is the elastic energy of the volume plus the viscous heat, J (s : dev(d) - q tr(d)) integrated over time
/// per reference volume, which is then a state variable.
///
/// ```
/// use mpm_materials::{Fluid, IdealGas, Newtonian, Tait};
/// # fn main() -> Result<(), mpm_materials::ParameterError> {
/// let air = Fluid::new(IdealGas::<f64>::air()).with_bulk_viscosity(0.06, 1.5)?;
/// let water = Fluid::new(Tait::new(1000.0, 50.0)?).with_shear_viscosity(Newtonian::new(1.0e-3)?);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fluid<E, N = Inviscid, V = NoViscosity> {
    eos: E,
    shear: N,
    viscosity: V,
}

impl<E> Fluid<E> {
    /// Create a fluid without viscosity.
    pub fn new(eos: E) -> Self {
        Fluid { eos, shear: Inviscid, viscosity: NoViscosity }
    }
}

impl<E, N, V> Fluid<E, N, V> {
    /// Set the shear viscosity.
    pub fn with_shear_viscosity<M>(self, shear: M) -> Fluid<E, M, V> {
        Fluid { eos: self.eos, shear, viscosity: self.viscosity }
    }
    /// Set the artificial bulk viscosity: linear coefficient b1, quadratic b0, and the sound speed of the equation of
    /// state at rest.
    ///
    /// # Errors
    /// A negative coefficient, or an equation of state without sound speed at rest.
    pub fn with_bulk_viscosity<T: Real>(
        self,
        linear: T,
        quadratic: T,
    ) -> Result<Fluid<E, N, BulkViscosity<T>>, ParameterError>
    where
        E: Eos<T>,
    {
        let viscosity = BulkViscosity::new(linear, quadratic, self.eos.rest_speed())?;
        Ok(Fluid { eos: self.eos, shear: self.shear, viscosity })
    }
    /// The equation of state.
    pub fn eos(&self) -> &E {
        &self.eos
    }
}

/// Speed of sound at rest, m/s, of a liquid by [`Tait`]'s equation: a number that is chosen for the speeds of a scene, ten
/// times the largest or more. None for other laws.
pub fn chosen_sound_speed<T: Float>(material: &dyn Material<T>) -> Option<f64> {
    if material.name() != Tait::<T>::NAME {
        return None;
    }
    Some(material.describe_point(&material.virgin())?.wave_speed.to_double())
}

/// State column for viscous heat of a fluid.
type HeatColumn<T, L, E, N, V> = <<E as Eos<T>>::Energy<L> as EnergyColumn<L>>::Beside<
    <N as ShearViscosity<T>>::Heat<L, <V as ShockViscosity<T>>::Heat<L>>,
>;

impl<T, E, N, V> Constitutive<T> for Fluid<E, N, V>
where
    T: Real,
    E: Eos<T>,
    N: ShearViscosity<T>,
    V: ShockViscosity<T>,
{
    type State<L: Lane<Real = T>> =
        FluidState<L, E::Energy<L>, N::Memory<L>, V::Memory<L>, HeatColumn<T, L, E, N, V>>;

    fn name(&self) -> &'static str {
        self.eos.name()
    }
    fn density(&self) -> T {
        self.eos.density()
    }
    fn shock_viscosity(&self) -> [T; 2] {
        self.viscosity.coefficients()
    }
    #[inline(always)]
    fn stored(&self) -> u64 {
        let Some(shear) = self.shear.stored() else { return u64::MAX };
        let first = 1 + <E::Energy<T::Single> as State<T::Single>>::LEN;
        let count = <N::Memory<T::Single> as State<T::Single>>::LEN;
        let low = |count: usize| (1 << count) - 1;
        low(first) | (shear & low(count)) << first | u64::MAX << (first + count)
    }
    /// Virgin state at reference density; a gas has its initial pressure there.
    fn virgin(&self) -> Self::State<T::Single> {
        let still =
            Kinematics { increment: crate::Mat3::zero(), dt: T::Single::one(), length: T::Single::one() };
        FluidState {
            volume_ratio: T::Single::one(),
            energy: E::Energy::keep(T::Single::splat(self.eos.initial_energy())),
            viscous_stress: self.shear.deviator(&still),
            viscous_pressure: self.viscosity.memory(T::Single::zero()),
            viscous_heat: EnergyColumn::keep(T::Single::zero()),
        }
    }
    #[inline(always)]
    fn update<L: Lane<Real = T>>(
        &self,
        kinematics: &Kinematics<L>,
        old: &Self::State<L>,
    ) -> Update<L, Self::State<L>> {
        let half = L::of(0.5);
        let volume_factor = kinematics.volume_factor();
        let volume_ratio = old.volume_ratio * volume_factor;
        let density = volume_ratio.recip() * L::splat(self.eos.density());
        let viscous_stress = self.shear.deviator(kinematics);
        let viscous_pressure = self.viscosity.pressure(kinematics, volume_factor, density);

        // Work of the step without that of the new pressure.
        let old_energy = old.energy.recall();
        let volume_change = volume_ratio - old.volume_ratio;
        let middle_volume = old.volume_ratio + volume_change * half;
        let shear = self.shear.stress(&old.viscous_stress) + self.shear.stress(&viscous_stress);
        let shear_work = middle_volume * shear.dot(&kinematics.strain()) * half;
        let old_viscous = self.viscosity.remembered(&old.viscous_pressure);
        let old_pressure = self.eos.pressure(old.volume_ratio, old_energy) + old_viscous;
        let heat = shear_work - (old_viscous + viscous_pressure) * volume_change * half;
        let worked = old_energy + shear_work - (old_pressure + viscous_pressure) * volume_change * half;

        let balanced = balance(self.eos.terms(volume_ratio), worked, volume_change);
        let state = FluidState {
            volume_ratio,
            energy: E::Energy::keep(balanced.energy),
            viscous_stress,
            viscous_pressure: self.viscosity.memory(viscous_pressure),
            viscous_heat: EnergyColumn::keep(old.viscous_heat.recall() + heat),
        };
        let total_pressure = balanced.pressure + viscous_pressure;
        let stress = self.shear.stress(&viscous_stress).plus_isotropic(-total_pressure);
        let fault = Fault::none()
            .require(volume_factor.gt(L::zero()), Breakdown::InvertedVolume)
            .require(volume_ratio.gt(L::zero()), Breakdown::InvertedVolume)
            .require(finite_state(&state), Breakdown::NotFinite)
            .require(total_pressure.is_finite(), Breakdown::NotFinite);
        Update { state, stress, fault }
    }
    #[inline(always)]
    fn stress<L: Lane<Real = T>>(&self, now: &Self::State<L>) -> Sym3<L> {
        let pressure = self.eos.pressure(now.volume_ratio, now.energy.recall())
            + self.viscosity.remembered(&now.viscous_pressure);
        self.shear.stress(&now.viscous_stress).plus_isotropic(-pressure)
    }
    #[inline(always)]
    fn in_range<L: Lane<Real = T>>(&self, now: &Self::State<L>) -> L::Mask {
        self.eos.in_range(now.volume_ratio)
    }
    #[inline(always)]
    fn volume_ratio<L: Lane<Real = T>>(&self, now: &Self::State<L>) -> L {
        now.volume_ratio
    }
    /// Sound speed sqrt((dp/drho)_s); viscosity left out.
    #[inline(always)]
    fn wave_speed<L: Lane<Real = T>>(&self, now: &Self::State<L>) -> L {
        self.eos.speed_squared(now.volume_ratio, now.energy.recall()).max(L::zero()).sqrt()
    }
    #[inline(always)]
    fn step_speed<L: Lane<Real = T>>(&self, now: &Self::State<L>, length: L) -> L {
        // 8/3 eta / rho, with rho = rho0 / J.
        let nu = L::splat(self.shear.largest() * T::of(8.0 / 3.0) / self.eos.density()) * now.volume_ratio;
        self.wave_speed(now) + nu / length
    }
    #[inline(always)]
    fn energy<L: Lane<Real = T>>(&self, now: &Self::State<L>) -> L {
        if <E::Energy<L> as EnergyColumn<L>>::KEPT {
            now.energy.recall() - L::splat(self.eos.initial_energy())
        } else {
            self.eos.stored_energy(now.volume_ratio) + now.viscous_heat.recall()
        }
    }
    fn has_viscous_heat(&self) -> bool {
        <HeatColumn<T, T::Single, E, N, V> as EnergyColumn<T::Single>>::KEPT
    }
    #[inline(always)]
    fn viscous_heat<L: Lane<Real = T>>(&self, now: &Self::State<L>) -> L {
        now.viscous_heat.recall()
    }
    /// Merge points whose volume ratios are within [`LIKE_VOLUME`] of their mean, if the fluid stores its energy
    /// ([`KeepEnergy`](crate::eos::KeepEnergy)): all numbers are mass-weighted means. Otherwise the elastic energy of
    /// the mean volume would be less than that of the points.
    fn merged(&self, points: &[(f64, Self::State<T::Single>)]) -> Option<Self::State<T::Single>> {
        if !<E::Energy<T::Single> as EnergyColumn<T::Single>>::KEPT {
            return None;
        }
        let state = mean::<T, Self::State<T::Single>>(points.iter().copied());
        let ratio = |state: &Self::State<T::Single>| -> f64 {
            let ratio: T = state.volume_ratio.into();
            ratio.to_double()
        };
        let middle = ratio(&state);
        alike(points.iter().map(|(_, s)| ratio(s)), middle, middle * LIKE_VOLUME).then_some(state)
    }
}
