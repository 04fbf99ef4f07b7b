//! Steinberg-Guinan strength at high rates.

use crate::lane::{Lane, Mask, Real};
use crate::parameter::{Check, ParameterError};
use crate::point::Fault;
use crate::strength::hardening::{Hardening, SaturatingPower};
use crate::strength::j2::radial_return;
use crate::strength::{FlowStress, Hardened, Loading, Return, Strength};
use crate::tensor::Sym3;

/// Constants of [`SteinbergGuinan`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SteinbergConstants<T> {
    /// Reference density rho0, kg/m^3.
    pub density: T,
    /// Shear modulus G0 at 300 K without pressure, Pa.
    pub shear: T,
    /// Pressure coefficient A, 1/Pa: (dG/dp)/G0.
    pub pressure: T,
    /// Temperature coefficient B, 1/K: -(dG/dT)/G0.
    pub temperature: T,
    /// Temperature of the virgin point, K.
    pub room: T,
    /// Melting temperature T_m0 at rho0, K.
    pub melt: T,
    /// Grueneisen gamma0 in the melting law.
    pub gruneisen: T,
    /// Volume correction a in the melting law.
    pub correction: T,
    /// Specific heat capacity, J/(kg K).
    pub heat_capacity: T,
    /// Taylor-Quinney coefficient chi.
    pub taylor_quinney: T,
}

/// Smallest shear modulus of the return mapping over G0, of a soft or molten point.
const SOFTEST: f64 = 0.1;

/// Steinberg-Cochran-Guinan strength (\[SteinbergCochranGuinan1980\], book, "Other flow stresses"):
///
/// - G = G0 r, r = 1 + A p J^(1/3) - B (T - 300 K);
/// - sigma_y = r min( Y0 \[1 + beta (eps_p + eps_i)\]^n, Y_max ), zero for r < 0 and above the melting
///   temperature T_m = T_m0 exp(2 a (1 - J)) J^-(2 (gamma0 - a - 1/3)).
///
/// Hardening is implicit; pressure and temperature are those at the start of the step. For rates above 1e5 /s, where
/// the flow stress no longer depends on rate. The wave speed includes the stiffening.
///
/// Limits: only plastic work heats, dT = chi sigma_y d_eps_p/(rho c); shock heating is left out, so that softening and
/// melting in a strong shock occur too late. The return mapping uses G of at least a tenth of G0; a molten point still has
/// no strength.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SteinbergGuinan<T> {
    constants: SteinbergConstants<T>,
    hardening: SaturatingPower<T>,
}

impl<T: Real> SteinbergGuinan<T> {
    /// Create from constants and hardening.
    ///
    /// # Errors
    /// Density, G0, T_melt or heat capacity not positive, A, B or room temperature negative, chi outside \[0, 1\],
    /// gamma0 or a not finite.
    pub fn new(
        constants: SteinbergConstants<T>,
        hardening: SaturatingPower<T>,
    ) -> Result<Self, ParameterError> {
        let check = Check("Steinberg-Guinan");
        let k = &constants;
        check.positive("density rho0", k.density)?;
        check.positive("shear modulus G0", k.shear)?;
        check.not_negative("A", k.pressure)?;
        check.not_negative("B", k.temperature)?;
        check.not_negative("room temperature", k.room)?;
        check.positive("melting temperature", k.melt)?;
        check.that(true, "gamma0", k.gruneisen, "finite")?;
        check.that(true, "volume correction a", k.correction, "finite")?;
        check.positive("heat capacity", k.heat_capacity)?;
        let chi = k.taylor_quinney;
        check.that(chi >= T::of(0.0) && chi <= T::of(1.0), "Taylor-Quinney coefficient", chi, "in [0, 1]")?;
        Ok(SteinbergGuinan { constants, hardening })
    }

    /// 4340 steel: G0 81.8 GPa, A 20.6e-12 /Pa, B 0.16e-3 /K, Y0 1.15 GPa, beta 2, n 0.5, T_m0 2310 K (Uintah
    /// `SCGPlastic4340Steel.xml`; book, "Material constants"), c 477 J/(kg K), rho0 7830 kg/m^3.
    ///
    /// **Known misprints of the source**: Y_max is printed 0.25 GPa, below Y0; 2.5 GPa is used here. Gamma_0 3.0 and
    /// a 1.67 appear to be exchanged in print; they change only the melting temperature under pressure and are exchanged
    /// here: gamma0 1.67, a 3.0.
    pub fn steel_4340() -> Self {
        Self::known([7830.0, 81.8e9, 20.6e-12, 0.16e-3, 2310.0, 1.67, 3.0, 477.0], [1.15e9, 2.5e9, 2.0, 0.5])
    }

    /// OFHC copper, half hard: rho0 8930 kg/m^3, G0 47.7 GPa, T_m0 1790 K, c 383 J/(kg K), gamma0 2.02, a 1.5
    /// (Steinberg, in Uintah; book, "Material constants"). A 28.3e-12 /Pa, B 0.377e-3 /K, Y0 120 MPa, Y_max 640 MPa, beta 36 and
    /// n 0.45 are **from memory of the literature**.
    pub fn copper() -> Self {
        Self::known(
            [8930.0, 47.7e9, 28.3e-12, 0.377e-3, 1790.0, 2.02, 1.5, 383.0],
            [120e6, 640e6, 36.0, 0.45],
        )
    }

    fn known(
        [density, shear, pressure, temperature, melt, gruneisen, correction, heat]: [f64; 8],
        curve: [f64; 4],
    ) -> Self {
        let constants = SteinbergConstants {
            density: T::of(density),
            shear: T::of(shear),
            pressure: T::of(pressure),
            temperature: T::of(temperature),
            room: T::of(300.0),
            melt: T::of(melt),
            gruneisen: T::of(gruneisen),
            correction: T::of(correction),
            heat_capacity: T::of(heat),
            taylor_quinney: T::of(0.9),
        };
        SteinbergGuinan { constants, hardening: SaturatingPower::known(curve) }
    }

    /// Relative shear modulus r = G/G0 before any floor.
    #[inline(always)]
    fn relative<L: Lane<Real = T>>(&self, pressure: L, volume_ratio: L, temperature: L) -> L {
        let k = &self.constants;
        let cube_root = volume_ratio.powf(L::of(1.0 / 3.0));
        let warm = temperature - L::of(300.0);
        L::one() + L::splat(k.pressure) * pressure * cube_root - L::splat(k.temperature) * warm
    }

    /// Melting temperature T_m, K.
    #[inline(always)]
    pub fn melting_temperature<L: Lane<Real = T>>(&self, volume_ratio: L) -> L {
        let k = &self.constants;
        let power = T::of(-2.0) * (k.gruneisen - k.correction - T::of(1.0 / 3.0));
        let growth = (L::splat(k.correction * T::of(2.0)) * (L::one() - volume_ratio)).exp();
        L::splat(k.melt) * growth * volume_ratio.powf(L::splat(power))
    }

    /// Relative shear modulus of the return mapping, and factor of the flow stress.
    #[inline(always)]
    fn factors<L: Lane<Real = T>>(&self, loading: &Loading<L>, temperature: L) -> (L, L) {
        let volume_ratio = loading.specific_volume * L::splat(self.constants.density);
        // An inverted point is reported elsewhere.
        let volume_ratio = L::select(volume_ratio.gt(L::zero()), volume_ratio, L::one());
        let relative = self.relative(loading.pressure, volume_ratio, temperature);
        let solid = temperature.lt(self.melting_temperature(volume_ratio));
        let factor = L::select(solid, relative.max(L::zero()), L::zero());
        (relative.max(L::of(SOFTEST)), factor)
    }
}

impl<T: Real> Strength<T> for SteinbergGuinan<T> {
    type History<L: Lane<Real = T>> = Hardened<L, L>;

    fn name(&self) -> &'static str {
        "Steinberg-Guinan"
    }
    /// Shear modulus G0, Pa.
    fn shear_modulus(&self) -> T {
        self.constants.shear
    }
    fn virgin(&self) -> Hardened<T::Single, T::Single> {
        Hardened { plastic_strain: T::Single::zero(), temperature: T::Single::splat(self.constants.room) }
    }
    #[inline(always)]
    fn return_map<L: Lane<Real = T>>(
        &self,
        trial: &Sym3<L>,
        loading: &Loading<L>,
        old: &Hardened<L, L>,
    ) -> Return<L, Hardened<L, L>> {
        let k = &self.constants;
        let (stiffness, factor) = self.factors(loading, old.temperature);
        // The trial deviator was computed with G0.
        let more = (stiffness - L::one()) * L::splat(k.shear * T::of(2.0));
        let trial = *trial + loading.strain_deviator * more;
        let equivalent = trial.equivalent();
        let bound = self.hardening.lower_bound(old.plastic_strain) * factor;
        if !bound.lt(equivalent).any() {
            return Return { deviator: trial, history: *old, plastic_work: L::zero(), fault: Fault::none() };
        }
        let three_g = L::splat(k.shear * T::of(3.0)) * stiffness;
        let increment = self.hardening.increment(equivalent, three_g, factor, old.plastic_strain);
        let (deviator, plastic_work) = radial_return(&trial, equivalent, three_g, increment.value);
        let warming = L::splat(k.taylor_quinney / k.heat_capacity) * plastic_work * loading.specific_volume;
        let history = Hardened {
            plastic_strain: old.plastic_strain + increment.value,
            temperature: old.temperature + warming,
        };
        Return { deviator, history, plastic_work, fault: increment.fault }
    }
    #[inline(always)]
    fn plastic_strain<L: Lane<Real = T>>(&self, history: &Hardened<L, L>) -> L {
        history.plastic_strain
    }
    /// Homologous temperature (T - T_room)/(T_m0 - T_room), with the melting temperature at rho0.
    #[inline(always)]
    fn homologous_temperature<L: Lane<Real = T>>(&self, history: &Hardened<L, L>) -> L {
        let k = &self.constants;
        let per_range = L::splat(T::of(1.0) / (k.melt - k.room));
        ((history.temperature - L::splat(k.room)) * per_range).clamp(L::zero(), L::one())
    }
    #[inline(always)]
    fn stiffening<L: Lane<Real = T>>(&self, pressure: L, volume_ratio: L, history: &Hardened<L, L>) -> L {
        self.relative(pressure, volume_ratio, history.temperature).max(L::of(SOFTEST))
    }
}

impl<T: Real> FlowStress<T> for SteinbergGuinan<T> {
    #[inline(always)]
    fn flow_stress<L: Lane<Real = T>>(
        &self,
        loading: &Loading<L>,
        old: &Hardened<L, L>,
        new: &Hardened<L, L>,
    ) -> L {
        self.factors(loading, old.temperature).1 * self.hardening.stress(new.plastic_strain)
    }
}
