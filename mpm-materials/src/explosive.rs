//! High explosive with programmed burn.

use crate::eos::chapman_jouguet::chapman_jouguet;
use crate::eos::{Eos, Jwl, Terms, balance};
use crate::lane::{Lane, Real};
use crate::parameter::{Check, ParameterError};
use crate::point::{Breakdown, Constitutive, Fault, Kinematics, Update, finite_state};
use crate::state;
use crate::tensor::Sym3;
use crate::viscosity::{BulkViscosity, NoViscosity, ShockViscosity};

/// State of one point of a charge.
pub type Charge<T, V = NoViscosity> =
    ExplosiveState<<T as Real>::Single, <V as ShockViscosity<T>>::Memory<<T as Real>::Single>>;

/// Lighting time of a charge that is never lit, s: beyond the end of any run.
const NEVER: f64 = 1.0e9;

state! {
    /// State variables of a charge: four numbers, one more with bulk viscosity.
    pub struct ExplosiveState<L, Q> {
        /// Volume over that of the unreacted explosive, V.
        pub volume_ratio: L,
        /// Internal energy e per volume of unreacted explosive, J/m^3, the chemical energy included.
        pub energy: L,
        /// Time until the programmed wave arrives, s; it decreases by dt per step and is negative behind the wave.
        pub time_to_light: L,
        /// Burn fraction F in \[0, 1\]; it never decreases.
        pub burn_fraction: L,
        /// Viscous pressure of the last step, Pa, with bulk viscosity only.
        pub viscous_pressure: Q,
    }
}

/// High explosive with programmed burn: sigma = -(F p(V, e) + q) I (book, "Detonation and JWL"), with p the equation of
/// state of the products ([`Jwl`] or any other with initial energy) and F the burn fraction,
///
/// F = max over the past of max( (t - t_L) D/(w h), (1 - V)/(1 - V_CJ) ), clipped to \[0, 1\].
///
/// t_L is the lighting time of the point, D the detonation speed, h the size of the cell, w the burn width in cells.
/// The second term burns material that is compressed to the Chapman-Jouguet volume by any cause;
/// [`Explosive::without_compression_burn`] leaves it out.
///
/// **Lighting times are data of the points**, not of the law: the state variable `time_to_light` is the time until the
/// wave arrives, at t = 0 the lighting time itself. [`Detonation`](crate::Detonation) computes it from a position,
/// [`Explosive::lit_after`] returns the state. A virgin point is never lit, unless [`Explosive::all_lit_after`] sets a
/// time.
///
/// The energy is the chemical energy less the work done; burning adds pressure, not energy. The energy balance closes,
/// but a strain cycle during the burn may release work, as of an explosive. Limits: the unburnt charge carries no
/// stress. The sound speed is at least D while a point burns.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Explosive<T, E = Jwl<T>, V = NoViscosity> {
    products: E,
    speed: T,
    width: T,
    /// Compression burn factor 1/(1 - V_CJ), or zero.
    compression_burn: T,
    delay: T,
    viscosity: V,
}

/// Burn width in cells, w.
const WIDTH: f64 = 1.5;

impl<T: Real, E: Eos<T>> Explosive<T, E> {
    /// Create from the products; detonation speed D and volume V_CJ are those of their Chapman-Jouguet state. The burn
    /// width is 1.5 cells.
    ///
    /// # Errors
    /// Products without a Chapman-Jouguet state: their initial energy is not positive.
    pub fn new(products: E) -> Result<Self, ParameterError> {
        let check = Check("explosive");
        let energy = products.initial_energy();
        let Some(state) = chapman_jouguet(&products) else {
            return Err(ParameterError {
                law: "explosive",
                parameter: "initial energy of the products",
                value: energy.to_double(),
                allowed: "such that there is a Chapman-Jouguet state",
            });
        };
        let speed = check.positive("detonation speed D", T::of(state.speed))?;
        Ok(Explosive {
            products,
            speed,
            width: T::of(WIDTH),
            compression_burn: T::of(1.0 / (1.0 - state.volume_ratio)),
            delay: T::of(NEVER),
            viscosity: NoViscosity,
        })
    }
}

impl<T: Real> Explosive<T> {
    /// TNT: [`Jwl::tnt`], with the detonation speed 6930 m/s of the same deck (that of the Chapman-Jouguet state is
    /// 6928) and V_CJ 0.7318 (book, "Material constants").
    pub fn tnt() -> Self {
        Explosive {
            products: Jwl::tnt(),
            speed: T::of(6930.0),
            width: T::of(WIDTH),
            compression_burn: T::of(1.0 / (1.0 - 0.7318)),
            delay: T::of(NEVER),
            viscosity: NoViscosity,
        }
    }
}

impl<T: Real, E: Eos<T>, V: ShockViscosity<T>> Explosive<T, E, V> {
    /// Set the detonation speed D, m/s. It should be within a percent of that of the products, or burn front and
    /// pressure wave separate.
    ///
    /// # Errors
    /// D not positive.
    pub fn with_detonation_speed(self, speed: T) -> Result<Self, ParameterError> {
        Ok(Explosive { speed: Check("explosive").positive("detonation speed D", speed)?, ..self })
    }
    /// Set the burn width, in cells.
    ///
    /// # Errors
    /// A width that is not positive.
    pub fn with_burn_width(self, cells: T) -> Result<Self, ParameterError> {
        Ok(Explosive { width: Check("explosive").positive("burn width", cells)?, ..self })
    }
    /// Disable the compression burn: the programmed wave alone lights the charge.
    pub fn without_compression_burn(self) -> Self {
        Explosive { compression_burn: T::default(), ..self }
    }
    /// Set the time until the wave arrives, s, of every virgin point.
    ///
    /// # Errors
    /// A negative time.
    pub fn all_lit_after(self, time: T) -> Result<Self, ParameterError> {
        Ok(Explosive { delay: Check("explosive").not_negative("lighting time", time)?, ..self })
    }
    /// Set the artificial bulk viscosity: linear coefficient b1, quadratic b0, and the detonation speed as sound speed.
    ///
    /// # Errors
    /// A negative coefficient.
    pub fn with_bulk_viscosity(
        self,
        linear: T,
        quadratic: T,
    ) -> Result<Explosive<T, E, BulkViscosity<T>>, ParameterError> {
        let Explosive { products, speed, width, compression_burn, delay, .. } = self;
        let viscosity = BulkViscosity::new(linear, quadratic, speed)?;
        Ok(Explosive { products, speed, width, compression_burn, delay, viscosity })
    }
    /// Return a virgin point that the wave reaches after `time`, s; negative if it is lit already.
    ///
    /// # Errors
    /// A time that is not finite.
    pub fn lit_after(&self, time: T) -> Result<Charge<T, V>, ParameterError> {
        let time = Check("explosive").that(true, "lighting time", time, "finite")?;
        Ok(ExplosiveState { time_to_light: T::Single::splat(time), ..self.virgin() })
    }
    /// The equation of state of the products.
    pub fn products(&self) -> &E {
        &self.products
    }
    /// Detonation speed D, m/s.
    pub fn detonation_speed(&self) -> T {
        self.speed
    }

    /// The terms of the pressure F p.
    #[inline(always)]
    fn terms<L: Lane<Real = T>>(&self, volume_ratio: L, burn_fraction: L) -> Terms<L> {
        let Terms { cold, thermal } = self.products.terms(volume_ratio);
        Terms { cold: burn_fraction * cold, thermal: burn_fraction * thermal }
    }

    #[inline(always)]
    fn pressure<L: Lane<Real = T>>(&self, state: &ExplosiveState<L, V::Memory<L>>) -> L {
        let Terms { cold, thermal } = self.terms(state.volume_ratio, state.burn_fraction);
        thermal.mul_add(state.energy, cold) + self.viscosity.remembered(&state.viscous_pressure)
    }
}

impl<T, E, V> Constitutive<T> for Explosive<T, E, V>
where
    T: Real,
    E: Eos<T>,
    V: ShockViscosity<T>,
{
    type State<L: Lane<Real = T>> = ExplosiveState<L, V::Memory<L>>;

    fn name(&self) -> &'static str {
        "explosive"
    }
    fn density(&self) -> T {
        self.products.density()
    }
    fn shock_viscosity(&self) -> [T; 2] {
        self.viscosity.coefficients()
    }
    fn virgin(&self) -> Self::State<T::Single> {
        ExplosiveState {
            volume_ratio: T::Single::one(),
            energy: T::Single::splat(self.products.initial_energy()),
            time_to_light: T::Single::splat(self.delay),
            burn_fraction: T::Single::zero(),
            viscous_pressure: self.viscosity.memory(T::Single::zero()),
        }
    }
    #[inline(always)]
    fn update<L: Lane<Real = T>>(
        &self,
        kinematics: &Kinematics<L>,
        old: &Self::State<L>,
    ) -> Update<L, Self::State<L>> {
        let (zero, one, half) = (L::zero(), L::one(), L::of(0.5));
        let volume_factor = kinematics.volume_factor();
        let volume_ratio = old.volume_ratio * volume_factor;
        let density = volume_ratio.recip() * L::splat(self.products.density());
        let viscous_pressure = self.viscosity.pressure(kinematics, volume_factor, density);

        let time_to_light = old.time_to_light - kinematics.dt;
        let per_width = L::splat(self.speed / self.width) / kinematics.length;
        let programmed = -(time_to_light * per_width);
        let compressed = (one - volume_ratio) * L::splat(self.compression_burn);
        let burn_fraction = programmed.max(compressed).clamp(zero, one).max(old.burn_fraction);

        let volume_change = volume_ratio - old.volume_ratio;
        let push = self.pressure(old) + viscous_pressure;
        let worked = old.energy - push * volume_change * half;
        let balanced = balance(self.terms(volume_ratio, burn_fraction), worked, volume_change);
        let state = ExplosiveState {
            volume_ratio,
            energy: balanced.energy,
            time_to_light,
            burn_fraction,
            viscous_pressure: self.viscosity.memory(viscous_pressure),
        };
        let total_pressure = balanced.pressure + viscous_pressure;
        let fault = Fault::none()
            .require(volume_factor.gt(zero), Breakdown::InvertedVolume)
            .require(volume_ratio.gt(zero), Breakdown::InvertedVolume)
            .require(finite_state(&state), Breakdown::NotFinite)
            .require(total_pressure.is_finite(), Breakdown::NotFinite)
            // A maximum may mask NaN.
            .require((old.burn_fraction + programmed).is_finite(), Breakdown::NotFinite);
        Update { state, stress: Sym3::isotropic(-total_pressure), fault }
    }
    #[inline(always)]
    fn stress<L: Lane<Real = T>>(&self, now: &Self::State<L>) -> Sym3<L> {
        Sym3::isotropic(-self.pressure(now))
    }
    #[inline(always)]
    fn in_range<L: Lane<Real = T>>(&self, now: &Self::State<L>) -> L::Mask {
        self.products.in_range(now.volume_ratio)
    }
    #[inline(always)]
    fn volume_ratio<L: Lane<Real = T>>(&self, now: &Self::State<L>) -> L {
        now.volume_ratio
    }
    /// Sound speed of the products, at least D until the point is burnt.
    #[inline(always)]
    fn wave_speed<L: Lane<Real = T>>(&self, now: &Self::State<L>) -> L {
        let products = self.products.speed_squared(now.volume_ratio, now.energy).max(L::zero());
        let burning = products.max(L::splat(self.speed * self.speed));
        L::select(now.burn_fraction.lt(L::one()), burning, products).sqrt()
    }
    /// Energy less the chemical energy of the virgin state: minus the work done by the charge.
    #[inline(always)]
    fn energy<L: Lane<Real = T>>(&self, now: &Self::State<L>) -> L {
        now.energy - L::splat(self.products.initial_energy())
    }
}
