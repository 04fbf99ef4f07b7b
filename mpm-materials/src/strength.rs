//! Strength: yield surface, flow stress, return mapping and plastic history of the stress deviator of a solid.

pub mod borvik;
pub mod drucker_prager;
pub mod elastic;
pub mod hardening;
pub mod hjc;
pub mod j2;
pub mod johnson_cook;
pub mod mohr_coulomb;
pub mod rate_factors;
pub mod steinberg;

pub use borvik::{Borvik, BorvikConstants, Softened};
pub use drucker_prager::{Cone, DruckerPrager, Sheared};
pub use elastic::Elastic;
pub use hardening::{Hardening, LinearHardening, PowerHardening, SaturatingPower, VoceHardening};
pub use hjc::{Concrete, ConcreteConstants, HolmquistJohnsonCook};
pub use j2::J2;
pub use johnson_cook::{
    Adiabatic, AdiabaticJohnsonCook, Heat, Isothermal, JohnsonCook, Logarithmic, RateFactor, RateIndependent,
    SimplifiedJohnsonCook, SmoothLogarithmic, Thermal,
};
pub use mohr_coulomb::MohrCoulomb;
pub use rate_factors::{CowperSymonds, PowerRate};
pub use steinberg::{SteinbergConstants, SteinbergGuinan};

use crate::lane::{Lane, Real};
use crate::point::{Fault, Kinematics, State};
use crate::state;
use crate::tensor::Sym3;

/// Loading of a step for the return mapping of a deviator.
#[derive(Clone, Copy, Debug)]
pub struct Loading<L> {
    /// Deviator of the strain increment.
    pub strain_deviator: Sym3<L>,
    /// Time step, s.
    pub dt: L,
    /// Size of the element or cell, m.
    pub length: L,
    /// Mean pressure at the start of the step, Pa, compression positive, viscous pressure included.
    pub pressure: L,
    /// Volume per mass at the end of the step, 1/rho, m^3/kg.
    pub specific_volume: L,
}

impl<L: Lane> Loading<L> {
    /// Equivalent total strain rate of the step, sqrt(2/3 e:e), 1/s, with e the deviatoric rate.
    #[inline(always)]
    pub fn equivalent_rate(&self) -> L {
        let e = &self.strain_deviator;
        (e.dot(e) * L::of(2.0 / 3.0)).sqrt() * self.dt.recip()
    }
    /// Build the loading of a step from its strain increment.
    #[inline(always)]
    pub fn of(kinematics: &Kinematics<L>, strain: &Sym3<L>, pressure: L, specific_volume: L) -> Self {
        let strain_deviator = strain.deviator();
        Loading { strain_deviator, dt: kinematics.dt, length: kinematics.length, pressure, specific_volume }
    }
}

/// Result of the return mapping: a deviator on or inside the yield surface.
#[derive(Clone, Copy, Debug)]
pub struct Return<L, H> {
    /// Stress deviator at the end of the step, Pa.
    pub deviator: Sym3<L>,
    /// History at the end of the step.
    pub history: H,
    /// Plastic work of the step per current volume, sigma_y d_eps_p, J/m^3.
    pub plastic_work: L,
    /// Lanes in which the return mapping failed.
    pub fault: Fault<L>,
}

/// Strength model: a law for the stress deviator.
pub trait Strength<T: Real>: std::fmt::Debug + Clone + Send + Sync + 'static {
    /// State variables of plastic flow.
    type History<L: Lane<Real = T>>: State<L>;

    /// The law's name, for messages.
    fn name(&self) -> &'static str;

    /// Shear modulus G, Pa.
    fn shear_modulus(&self) -> T;

    /// Bit mask of the stored state variables: [`Constitutive::stored`](crate::Constitutive::stored).
    #[inline(always)]
    fn stored(&self) -> u64 {
        u64::MAX
    }

    /// The history of a virgin point.
    fn virgin(&self) -> Self::History<T::Single>;

    /// Map the elastic trial deviator (rotated old deviator + 2 G times the strain deviator) to the deviator at the end
    /// of the step.
    fn return_map<L: Lane<Real = T>>(
        &self,
        trial: &Sym3<L>,
        loading: &Loading<L>,
        old: &Self::History<L>,
    ) -> Return<L, Self::History<L>>;

    /// Accumulated equivalent plastic strain; zero for a law without plasticity.
    fn plastic_strain<L: Lane<Real = T>>(&self, history: &Self::History<L>) -> L;

    /// Homologous temperature T* in \[0, 1\], an input of failure criteria; zero, room temperature, for a law without
    /// temperature.
    #[inline(always)]
    fn homologous_temperature<L: Lane<Real = T>>(&self, history: &Self::History<L>) -> L {
        let _ = history;
        L::zero()
    }

    /// Damage in \[0, 1\]; zero for a law without damage.
    #[inline(always)]
    fn damage<L: Lane<Real = T>>(&self, history: &Self::History<L>) -> L {
        let _ = history;
        L::zero()
    }

    /// Shear modulus over [`Strength::shear_modulus`] at a pressure, Pa, and volume ratio J, for the wave speed; one
    /// for a law whose shear modulus is constant.
    #[inline(always)]
    fn stiffening<L: Lane<Real = T>>(&self, pressure: L, volume_ratio: L, history: &Self::History<L>) -> L {
        let _ = (pressure, volume_ratio, history);
        L::one()
    }
}

/// Strength with a flow stress that bounds its deviator, for tests.
pub trait FlowStress<T: Real>: Strength<T> {
    /// Flow stress, Pa: bound of sqrt(3/2 s:s) at the end of the step from `old` to `new`.
    fn flow_stress<L: Lane<Real = T>>(
        &self,
        loading: &Loading<L>,
        old: &Self::History<L>,
        new: &Self::History<L>,
    ) -> L;
}

state! {
    /// State variables of an isotropically hardening law; `H` is the temperature or nothing.
    pub struct Hardened<L, H> {
        /// Accumulated equivalent plastic strain, the sum of sqrt(2/3 d_ep:d_ep).
        pub plastic_strain: L,
        /// Temperature, K, of a law with heating.
        pub temperature: H,
    }
}
