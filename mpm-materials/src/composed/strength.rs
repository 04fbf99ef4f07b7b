//! Strength whose law, hardening, rate factor and heating are values.

use crate::failure::{CrackBand, Local, Localisation};
use crate::lane::{Lane, Real};
use crate::point::Fault;
use crate::state;
use crate::strength::hardening::{Increment, SaturatingPower};
use crate::strength::{
    Adiabatic, Borvik, CowperSymonds, Elastic, Hardened, Hardening, Isothermal, J2, JohnsonCook,
    LinearHardening, Loading, Logarithmic, PowerHardening, PowerRate, RateFactor, RateIndependent, Return,
    SmoothLogarithmic, Softened, SteinbergGuinan, Strength, Thermal, VoceHardening,
};
use crate::tensor::Sym3;

/// Isotropic hardening chosen at run time.
#[derive(Clone, Copy, PartialEq)]
pub enum AnyHardening<T> {
    /// Linear.
    Linear(LinearHardening<T>),
    /// Ludwik's power law.
    Power(PowerHardening<T>),
    /// Voce's saturation.
    Voce(VoceHardening<T>),
    /// Power law with an upper bound.
    Saturating(SaturatingPower<T>),
}

/// Rate factor chosen at run time.
#[derive(Clone, Copy, PartialEq)]
pub enum AnyRate<T> {
    /// One.
    Independent,
    /// Johnson-Cook's logarithm.
    Logarithmic(Logarithmic<T>),
    /// Logarithm without a kink.
    SmoothLogarithmic(SmoothLogarithmic<T>),
    /// Power law.
    Power(PowerRate<T>),
    /// Cowper and Symonds.
    CowperSymonds(CowperSymonds<T>),
}

/// Heating by plastic work and thermal softening, or none, chosen at run time.
#[derive(Clone, Copy, PartialEq)]
pub enum AnyHeat<T> {
    /// Constant temperature.
    Isothermal,
    /// Adiabatic heating.
    Adiabatic(Adiabatic<T>),
}

/// Regularisation of softening chosen at run time.
#[derive(Clone, Copy, PartialEq)]
pub enum AnyLocalisation<T> {
    /// None.
    Local,
    /// Crack band.
    CrackBand(CrackBand<T>),
}

macro_rules! from {
    ($any:ident: $($part:ty => $to:expr),+ $(,)?) => {$(
        impl<T> From<$part> for $any<T> {
            fn from(part: $part) -> Self {
                $to(part)
            }
        }
    )+};
}
from! {
    AnyHardening:
    LinearHardening<T> => AnyHardening::Linear,
    PowerHardening<T> => AnyHardening::Power,
    VoceHardening<T> => AnyHardening::Voce,
    SaturatingPower<T> => AnyHardening::Saturating,
}
from! {
    AnyRate:
    RateIndependent => |_| AnyRate::Independent,
    Logarithmic<T> => AnyRate::Logarithmic,
    SmoothLogarithmic<T> => AnyRate::SmoothLogarithmic,
    PowerRate<T> => AnyRate::Power,
    CowperSymonds<T> => AnyRate::CowperSymonds,
}
from! {
    AnyHeat:
    Isothermal => |_| AnyHeat::Isothermal,
    Adiabatic<T> => AnyHeat::Adiabatic,
}
from! {
    AnyLocalisation:
    Local => |_| AnyLocalisation::Local,
    CrackBand<T> => AnyLocalisation::CrackBand,
}

impl<T: Real> Hardening<T> for AnyHardening<T> {
    #[inline(always)]
    fn stress<L: Lane<Real = T>>(&self, strain: L) -> L {
        match self {
            AnyHardening::Linear(law) => law.stress(strain),
            AnyHardening::Power(law) => law.stress(strain),
            AnyHardening::Voce(law) => law.stress(strain),
            AnyHardening::Saturating(law) => law.stress(strain),
        }
    }
    #[inline(always)]
    fn lower_bound<L: Lane<Real = T>>(&self, strain: L) -> L {
        match self {
            AnyHardening::Linear(law) => law.lower_bound(strain),
            AnyHardening::Power(law) => law.lower_bound(strain),
            AnyHardening::Voce(law) => law.lower_bound(strain),
            AnyHardening::Saturating(law) => law.lower_bound(strain),
        }
    }
    #[inline(always)]
    fn increment<L: Lane<Real = T>>(&self, trial: L, three_g: L, factor: L, strain: L) -> Increment<L> {
        match self {
            AnyHardening::Linear(law) => law.increment(trial, three_g, factor, strain),
            AnyHardening::Power(law) => law.increment(trial, three_g, factor, strain),
            AnyHardening::Voce(law) => law.increment(trial, three_g, factor, strain),
            AnyHardening::Saturating(law) => law.increment(trial, three_g, factor, strain),
        }
    }
}

impl<T: Real> RateFactor<T> for AnyRate<T> {
    #[inline(always)]
    fn factor<L: Lane<Real = T>>(&self, loading: &Loading<L>) -> L {
        match self {
            AnyRate::Independent => L::one(),
            AnyRate::Logarithmic(law) => law.factor(loading),
            AnyRate::SmoothLogarithmic(law) => law.factor(loading),
            AnyRate::Power(law) => law.factor(loading),
            AnyRate::CowperSymonds(law) => law.factor(loading),
        }
    }
}

impl<T: Real> AnyHeat<T> {
    fn is_isothermal(&self) -> bool {
        matches!(self, AnyHeat::Isothermal)
    }
}

impl<T: Real> Thermal<T> for AnyHeat<T> {
    type Temperature<L: Lane<Real = T>> = L;
    fn virgin(&self) -> T::Single {
        match self {
            AnyHeat::Isothermal => T::Single::zero(),
            AnyHeat::Adiabatic(heat) => heat.virgin(),
        }
    }
    #[inline(always)]
    fn homologous<L: Lane<Real = T>>(&self, temperature: &L) -> L {
        match self {
            AnyHeat::Isothermal => L::zero(),
            AnyHeat::Adiabatic(heat) => heat.homologous(temperature),
        }
    }
    #[inline(always)]
    fn softening<L: Lane<Real = T>>(&self, temperature: &L) -> L {
        match self {
            AnyHeat::Isothermal => L::one(),
            AnyHeat::Adiabatic(heat) => heat.softening(temperature),
        }
    }
    #[inline(always)]
    fn softening_bound<L: Lane<Real = T>>(&self, temperature: &L) -> L {
        match self {
            AnyHeat::Isothermal => L::one(),
            AnyHeat::Adiabatic(heat) => heat.softening_bound(temperature),
        }
    }
    #[inline(always)]
    fn heated<L: Lane<Real = T>>(&self, temperature: &L, work: L) -> L {
        match self {
            AnyHeat::Isothermal => *temperature,
            AnyHeat::Adiabatic(heat) => heat.heated(temperature, work),
        }
    }
}

impl<T: Real> Localisation<T> for AnyLocalisation<T> {
    #[inline(always)]
    fn weight<L: Lane<Real = T>>(&self, length: L) -> L {
        match self {
            AnyLocalisation::Local => L::one(),
            AnyLocalisation::CrackBand(band) => band.weight(length),
        }
    }
}

/// Strength chosen at run time. Laws of the library convert into it by `into()`.
#[derive(Clone, Copy, PartialEq)]
pub enum AnyStrength<T> {
    /// Elastic.
    Elastic(Elastic<T>),
    /// Yield stress as a product of hardening, rate factor and thermal softening, with the name of the law.
    Product(&'static str, JohnsonCook<T, AnyRate<T>, AnyHeat<T>, AnyHardening<T>>),
    /// Steinberg and Guinan.
    Steinberg(SteinbergGuinan<T>),
    /// Borvik's law with damage.
    Borvik(Borvik<T, AnyLocalisation<T>>),
}

impl<T> From<Elastic<T>> for AnyStrength<T> {
    fn from(law: Elastic<T>) -> Self {
        AnyStrength::Elastic(law)
    }
}
impl<T> From<SteinbergGuinan<T>> for AnyStrength<T> {
    fn from(law: SteinbergGuinan<T>) -> Self {
        AnyStrength::Steinberg(law)
    }
}
impl<T: Real, B: Localisation<T> + Into<AnyLocalisation<T>>> From<Borvik<T, B>> for AnyStrength<T> {
    fn from(law: Borvik<T, B>) -> Self {
        let localisation = law.localisation().into();
        AnyStrength::Borvik(law.with_localisation(localisation))
    }
}
impl<T: Real, H: Hardening<T> + Into<AnyHardening<T>>> From<J2<T, H>> for AnyStrength<T> {
    fn from(law: J2<T, H>) -> Self {
        let (shear, hardening) = law.parts();
        let product =
            JohnsonCook::of_parts(shear, hardening.into(), AnyRate::Independent, AnyHeat::Isothermal);
        AnyStrength::Product(Strength::<T>::name(&law), product)
    }
}
impl<T, R, H, K> From<JohnsonCook<T, R, H, K>> for AnyStrength<T>
where
    T: Real,
    R: RateFactor<T> + Into<AnyRate<T>>,
    H: Thermal<T> + Into<AnyHeat<T>>,
    K: Hardening<T> + Into<AnyHardening<T>>,
{
    fn from(law: JohnsonCook<T, R, H, K>) -> Self {
        let (shear, hardening, rate, thermal) = law.parts();
        let product = JohnsonCook::of_parts(shear, hardening.into(), rate.into(), thermal.into());
        AnyStrength::Product(Strength::<T>::name(&law), product)
    }
}

state! {
    /// State variables of a strength chosen at run time; those that it does not have are zero and not stored.
    pub struct StrengthState<L> {
        /// Accumulated equivalent plastic strain.
        pub plastic_strain: L,
        /// Strain of the hardening, reduced by damage.
        pub hardening_strain: L,
        /// Damage.
        pub damage: L,
        /// Temperature, K.
        pub temperature: L,
    }
}

impl<L: Lane> StrengthState<L> {
    #[inline(always)]
    fn hardened(self) -> Hardened<L, L> {
        Hardened { plastic_strain: self.plastic_strain, temperature: self.temperature }
    }
    #[inline(always)]
    fn softened(self) -> Softened<L> {
        let StrengthState { plastic_strain, hardening_strain, damage, temperature } = self;
        Softened { plastic_strain, hardening_strain, damage, temperature }
    }
}
impl<L: Lane> From<Hardened<L, L>> for StrengthState<L> {
    #[inline(always)]
    fn from(h: Hardened<L, L>) -> Self {
        let zero = L::zero();
        StrengthState {
            plastic_strain: h.plastic_strain,
            hardening_strain: zero,
            damage: zero,
            temperature: h.temperature,
        }
    }
}
impl<L: Lane> From<Softened<L>> for StrengthState<L> {
    #[inline(always)]
    fn from(s: Softened<L>) -> Self {
        let Softened { plastic_strain, hardening_strain, damage, temperature } = s;
        StrengthState { plastic_strain, hardening_strain, damage, temperature }
    }
}

#[inline(always)]
fn widened<L, H: Into<StrengthState<L>>>(r: Return<L, H>) -> Return<L, StrengthState<L>> {
    let Return { deviator, history, plastic_work, fault } = r;
    Return { deviator, history: history.into(), plastic_work, fault }
}

impl<T: Real> Strength<T> for AnyStrength<T> {
    type History<L: Lane<Real = T>> = StrengthState<L>;

    fn name(&self) -> &'static str {
        match self {
            AnyStrength::Elastic(law) => law.name(),
            AnyStrength::Product(name, _) => name,
            AnyStrength::Steinberg(law) => law.name(),
            AnyStrength::Borvik(law) => law.name(),
        }
    }
    #[inline(always)]
    fn shear_modulus(&self) -> T {
        match self {
            AnyStrength::Elastic(law) => law.shear_modulus(),
            AnyStrength::Product(_, law) => law.shear_modulus(),
            AnyStrength::Steinberg(law) => law.shear_modulus(),
            AnyStrength::Borvik(law) => law.shear_modulus(),
        }
    }
    #[inline(always)]
    fn stored(&self) -> u64 {
        match self {
            AnyStrength::Elastic(_) => 0,
            AnyStrength::Product(_, law) if law.thermal().is_isothermal() => 0b0001,
            AnyStrength::Product(..) | AnyStrength::Steinberg(_) => 0b1001,
            AnyStrength::Borvik(_) => 0b1111,
        }
    }
    fn virgin(&self) -> StrengthState<T::Single> {
        let zero = T::Single::zero();
        match self {
            AnyStrength::Elastic(_) => Hardened { plastic_strain: zero, temperature: zero }.into(),
            AnyStrength::Product(_, law) => law.virgin().into(),
            AnyStrength::Steinberg(law) => law.virgin().into(),
            AnyStrength::Borvik(law) => law.virgin().into(),
        }
    }
    #[inline(always)]
    fn return_map<L: Lane<Real = T>>(
        &self,
        trial: &Sym3<L>,
        loading: &Loading<L>,
        old: &StrengthState<L>,
    ) -> Return<L, StrengthState<L>> {
        match self {
            AnyStrength::Elastic(_) => {
                Return { deviator: *trial, history: *old, plastic_work: L::zero(), fault: Fault::none() }
            }
            AnyStrength::Product(_, law) => widened(law.return_map(trial, loading, &old.hardened())),
            AnyStrength::Steinberg(law) => widened(law.return_map(trial, loading, &old.hardened())),
            AnyStrength::Borvik(law) => widened(law.return_map(trial, loading, &old.softened())),
        }
    }
    #[inline(always)]
    fn plastic_strain<L: Lane<Real = T>>(&self, history: &StrengthState<L>) -> L {
        history.plastic_strain
    }
    #[inline(always)]
    fn homologous_temperature<L: Lane<Real = T>>(&self, history: &StrengthState<L>) -> L {
        match self {
            AnyStrength::Elastic(_) => L::zero(),
            AnyStrength::Product(_, law) => law.homologous_temperature(&history.hardened()),
            AnyStrength::Steinberg(law) => law.homologous_temperature(&history.hardened()),
            AnyStrength::Borvik(law) => law.homologous_temperature(&history.softened()),
        }
    }
    #[inline(always)]
    fn damage<L: Lane<Real = T>>(&self, history: &StrengthState<L>) -> L {
        history.damage
    }
    #[inline(always)]
    fn stiffening<L: Lane<Real = T>>(&self, pressure: L, volume_ratio: L, history: &StrengthState<L>) -> L {
        match self {
            AnyStrength::Steinberg(law) => law.stiffening(pressure, volume_ratio, &history.hardened()),
            _ => L::one(),
        }
    }
}

impl<T: std::fmt::Debug> std::fmt::Debug for AnyHardening<T> {
    /// Debug of the part.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            AnyHardening::Linear(law) => law.fmt(f),
            AnyHardening::Power(law) => law.fmt(f),
            AnyHardening::Voce(law) => law.fmt(f),
            AnyHardening::Saturating(law) => law.fmt(f),
        }
    }
}

impl<T: std::fmt::Debug> std::fmt::Debug for AnyRate<T> {
    /// Debug of the part.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            AnyRate::Independent => RateIndependent.fmt(f),
            AnyRate::Logarithmic(law) => law.fmt(f),
            AnyRate::SmoothLogarithmic(law) => law.fmt(f),
            AnyRate::Power(law) => law.fmt(f),
            AnyRate::CowperSymonds(law) => law.fmt(f),
        }
    }
}

impl<T: std::fmt::Debug> std::fmt::Debug for AnyHeat<T> {
    /// Debug of the part.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            AnyHeat::Isothermal => Isothermal.fmt(f),
            AnyHeat::Adiabatic(law) => law.fmt(f),
        }
    }
}

impl<T: std::fmt::Debug> std::fmt::Debug for AnyLocalisation<T> {
    /// Debug of the part.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            AnyLocalisation::Local => Local.fmt(f),
            AnyLocalisation::CrackBand(law) => law.fmt(f),
        }
    }
}

impl<T: std::fmt::Debug> std::fmt::Debug for AnyStrength<T> {
    /// Debug of the part.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            AnyStrength::Elastic(law) => law.fmt(f),
            AnyStrength::Product(_, law) => law.fmt(f),
            AnyStrength::Steinberg(law) => law.fmt(f),
            AnyStrength::Borvik(law) => law.fmt(f),
        }
    }
}
