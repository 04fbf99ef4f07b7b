//! Viscoplasticity coupled to ductile damage, after Borvik and co-workers.

use crate::failure::{Local, Localisation};
use crate::lane::{Lane, Mask, Real};
use crate::parameter::{Check, ParameterError};
use crate::point::Fault;
use crate::state;
use crate::strength::j2::radial_return;
use crate::strength::{
    Adiabatic, FlowStress, Hardening, Heat, Loading, PowerHardening, PowerRate, Return, Strength, Thermal,
};
use crate::tensor::Sym3;

state! {
    /// State variables of a softening strength.
    pub struct Softened<L> {
        /// Accumulated equivalent plastic strain p.
        pub plastic_strain: L,
        /// Plastic strain of the undamaged part, r: dr = (1 - D) dp.
        pub hardening_strain: L,
        /// Damage D in \[0, D_c\].
        pub damage: L,
        /// Temperature, K.
        pub temperature: L,
    }
}

/// The constants of [`Borvik`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BorvikConstants<T> {
    /// Shear modulus G, Pa.
    pub shear: T,
    /// Hardening constants A, B, Pa, and n.
    pub hardening: [T; 3],
    /// Rate coefficient C.
    pub c: T,
    /// Reference rate, 1/s.
    pub reference_rate: T,
    /// Heating and thermal softening.
    pub heat: Heat<T>,
    /// Fracture strain constants D1 to D5.
    pub fracture: [T; 5],
    /// Critical damage D_c.
    pub critical_damage: T,
    /// Damage threshold p_d: plastic strain at which damage begins.
    pub threshold: T,
}

/// Largest exponent of the fracture strain.
const STEEPEST: f64 = 80.0;
/// Smallest p_f - p_d.
const SMALLEST: f64 = 1e-6;

/// Flow stress sigma_y = (1 - D) (A + B r^n) (1 + rdot*)^C (1 - T*^m), dr = (1 - D) dp (\[Borvik2001\], book, "Other
/// flow stresses"), with dD = D_c dp/(p_f - p_d) beyond p_d and
///
/// p_f = \[D1 + D2 exp(D3 s*)\] (1 + pdot*)^D4 (1 + D5 T*), s* = -p/sigma_y, tension positive.
///
/// D stops at D_c; with [`DamageLimit`](crate::DamageLimit) of D_c the point then fails. Hardening is implicit; damage,
/// temperature, pressure (all at the start of the step) and rate (total deviatoric) are explicit. With
/// [`CrackBand`](crate::CrackBand) the softening depends on the size of the cell. Damage does not change the elastic
/// moduli.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Borvik<T, B = Local> {
    shear: T,
    hardening: PowerHardening<T>,
    rate: PowerRate<T>,
    reference: T,
    heat: Adiabatic<T>,
    fracture: [T; 5],
    critical: T,
    threshold: T,
    localisation: B,
}

impl<T: Real> Borvik<T> {
    /// Create from constants.
    ///
    /// # Errors
    /// G, A, n or the reference rate not positive, B, C, D2 or p_d negative, D_c outside (0, 1), D1 to D5 not finite,
    /// or an error of [`Adiabatic::new`].
    pub fn new(constants: BorvikConstants<T>) -> Result<Self, ParameterError> {
        let check = Check("Borvik viscoplasticity");
        let k = &constants;
        let [initial, coefficient, exponent] = k.hardening;
        for (name, value) in ["D1", "D2", "D3", "D4", "D5"].into_iter().zip(k.fracture) {
            check.that(true, name, value, "finite")?;
        }
        check.not_negative("D2", k.fracture[1])?;
        let critical = k.critical_damage;
        let inside = critical > T::of(0.0) && critical < T::of(1.0);
        Ok(Borvik {
            shear: check.positive("shear modulus G", k.shear)?,
            hardening: PowerHardening::new(initial, coefficient, exponent)?,
            rate: PowerRate::new(k.c, k.reference_rate)?,
            reference: k.reference_rate,
            heat: Adiabatic::new(k.heat)?,
            fracture: k.fracture,
            critical: check.that(inside, "critical damage D_c", critical, "above 0 and below 1")?,
            threshold: check.not_negative("damage threshold p_d", k.threshold)?,
            localisation: Local,
        })
    }

    /// Weldox 460 E steel, the set of 2001: E 200 GPa, nu 0.33, A 490, B 807 MPa, n 0.73, C 0.0114 at 5e-4 /s, m 0.94,
    /// c_p 452 J/(kg K), T_room 293 K, T_melt 1800 K, Taylor-Quinney 0.9, D_c 0.30, p_d 0, **all from memory of the
    /// literature**; D1 to D5 0.0705, 1.732, -0.54, -0.0123, 0 (a public material library; book, "Material constants").
    pub fn weldox_460_e() -> Self {
        let hardening = PowerHardening::known(T::of(490e6), T::of(807e6), T::of(0.73));
        let heat = Heat {
            room: T::of(293.0),
            melt: T::of(1800.0),
            exponent: T::of(0.94),
            heat_capacity: T::of(452.0),
            taylor_quinney: T::of(0.9),
        };
        Borvik {
            shear: T::of(200e9 / 2.66),
            hardening,
            rate: PowerRate::known(0.0114, 5e-4),
            reference: T::of(5e-4),
            heat: Adiabatic::known(heat),
            fracture: [0.0705, 1.732, -0.54, -0.0123, 0.0].map(T::of),
            critical: T::of(0.30),
            threshold: T::of(0.0),
            localisation: Local,
        }
    }
}

impl<T: Real, B: Localisation<T>> Borvik<T, B> {
    pub(crate) fn localisation(&self) -> B {
        self.localisation
    }
    /// Set the dependence on the size of the cell.
    pub fn with_localisation<C: Localisation<T>>(self, localisation: C) -> Borvik<T, C> {
        let Borvik { shear, hardening, rate, reference, heat, fracture, critical, threshold, .. } = self;
        Borvik { shear, hardening, rate, reference, heat, fracture, critical, threshold, localisation }
    }
    /// Critical damage D_c.
    pub fn critical_damage(&self) -> T {
        self.critical
    }

    /// Fracture strain p_f at triaxiality s*, plastic strain rate, 1/s, and homologous temperature.
    #[inline(always)]
    pub fn fracture_strain<L: Lane<Real = T>>(&self, triaxiality: L, rate: L, temperature: L) -> L {
        let [d1, d2, d3, d4, d5] = self.fracture;
        let (one, steepest) = (L::one(), L::of(STEEPEST));
        let exponent = (L::splat(d3) * triaxiality).clamp(-steepest, steepest);
        let ductile = L::splat(d2).mul_add(exponent.exp(), L::splat(d1));
        let fast = rate.mul_add(L::splat(T::of(1.0) / self.reference), one).powf(L::splat(d4));
        ductile * fast * L::splat(d5).mul_add(temperature, one)
    }

    /// Flow stress factor: (1 - D) times rate and temperature factor, explicit.
    #[inline(always)]
    fn factor<L: Lane<Real = T>>(&self, loading: &Loading<L>, old: &Softened<L>) -> L {
        let sound = L::one() - old.damage;
        sound * self.rate.at(sound * loading.equivalent_rate()) * self.heat.softening(&old.temperature)
    }
}

impl<T: Real, B: Localisation<T>> Strength<T> for Borvik<T, B> {
    type History<L: Lane<Real = T>> = Softened<L>;

    fn name(&self) -> &'static str {
        "Borvik viscoplasticity"
    }
    fn shear_modulus(&self) -> T {
        self.shear
    }
    fn virgin(&self) -> Softened<T::Single> {
        let zero = T::Single::zero();
        Softened {
            plastic_strain: zero,
            hardening_strain: zero,
            damage: zero,
            temperature: self.heat.virgin(),
        }
    }
    #[inline(always)]
    fn return_map<L: Lane<Real = T>>(
        &self,
        trial: &Sym3<L>,
        loading: &Loading<L>,
        old: &Softened<L>,
    ) -> Return<L, Softened<L>> {
        let (zero, one) = (L::zero(), L::one());
        let sound = one - old.damage;
        let squared = trial.dot(trial) * L::of(1.5);
        let cold = self.hardening.lower_bound(old.hardening_strain) * sound;
        let bound = cold * self.heat.softening_bound(&old.temperature);
        if !(bound * bound).lt(squared).any() {
            return Return { deviator: *trial, history: *old, plastic_work: zero, fault: Fault::none() };
        }
        let equivalent = squared.sqrt();
        let three_g = L::splat(self.shear * T::of(3.0));
        // In terms of dr = (1 - D) dp: trial - 3 G/(1 - D) dr = factor sigma_h(r + dr).
        let factor = self.factor(loading, old);
        let found = self.hardening.increment(equivalent, three_g / sound, factor, old.hardening_strain);
        let increment = found.value / sound;
        let (deviator, plastic_work) = radial_return(trial, equivalent, three_g, increment);

        let plastic_strain = old.plastic_strain + increment;
        let reached = (equivalent - three_g * increment).max(L::of(1e-20));
        let triaxiality = -(loading.pressure / reached);
        let temperature = self.heat.homologous(&old.temperature);
        let strain = self.fracture_strain(triaxiality, increment / loading.dt, temperature);
        let to_fracture = (strain - L::splat(self.threshold)).max(L::of(SMALLEST));
        let beyond = increment.min((plastic_strain - L::splat(self.threshold)).max(zero));
        let weight = self.localisation.weight(loading.length) * L::splat(self.critical);
        let history = Softened {
            plastic_strain,
            hardening_strain: old.hardening_strain + found.value,
            damage: (old.damage + weight * beyond / to_fracture).min(L::splat(self.critical)),
            temperature: self.heat.heated(&old.temperature, plastic_work * loading.specific_volume),
        };
        Return { deviator, history, plastic_work, fault: found.fault }
    }
    #[inline(always)]
    fn plastic_strain<L: Lane<Real = T>>(&self, history: &Softened<L>) -> L {
        history.plastic_strain
    }
    #[inline(always)]
    fn homologous_temperature<L: Lane<Real = T>>(&self, history: &Softened<L>) -> L {
        self.heat.homologous(&history.temperature)
    }
    #[inline(always)]
    fn damage<L: Lane<Real = T>>(&self, history: &Softened<L>) -> L {
        history.damage
    }
}

impl<T: Real, B: Localisation<T>> FlowStress<T> for Borvik<T, B> {
    #[inline(always)]
    fn flow_stress<L: Lane<Real = T>>(
        &self,
        loading: &Loading<L>,
        old: &Softened<L>,
        new: &Softened<L>,
    ) -> L {
        self.factor(loading, old) * self.hardening.stress(new.hardening_strain)
    }
}
