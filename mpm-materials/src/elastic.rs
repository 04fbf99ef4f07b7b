//! Elastic laws: linear (rate form) and compressible neo-Hookean.

use crate::capability::Hyperelastic;
use crate::lane::{Lane, Mask, Real};
use crate::parameter::{Check, ParameterError};
use crate::point::{Breakdown, Constitutive, Fault, Kinematics, Update, finite_state, finite_stress};
use crate::rate::{HughesWinget, ObjectiveRate};
use crate::state;
use crate::tensor::{Mat3, Sym3};

/// The two constants of isotropic elasticity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moduli<T> {
    /// Bulk modulus K, Pa.
    pub bulk: T,
    /// Shear modulus G, Pa.
    pub shear: T,
}

impl<T: Real> Moduli<T> {
    /// Create from bulk and shear modulus, Pa.
    ///
    /// # Errors
    /// A modulus that is not positive and finite.
    pub fn bulk_shear(bulk: T, shear: T) -> Result<Self, ParameterError> {
        let check = Check("elastic moduli");
        Ok(Moduli {
            bulk: check.positive("bulk modulus", bulk)?,
            shear: check.positive("shear modulus", shear)?,
        })
    }
    /// Create from Young's modulus, Pa, and Poisson's ratio: K = E / 3(1 - 2 nu), G = E / 2(1 + nu).
    ///
    /// # Errors
    /// E not positive, or nu outside (-1, 1/2).
    pub fn young_poisson(young: T, poisson: T) -> Result<Self, ParameterError> {
        let check = Check("elastic moduli");
        let (one, two, three) = (T::of(1.0), T::of(2.0), T::of(3.0));
        let young = check.positive("Young's modulus", young)?;
        let inside = poisson > -one && poisson < T::of(0.5);
        let poisson = check.that(inside, "Poisson's ratio", poisson, "between -1 and 1/2, both excluded")?;
        Ok(Moduli { bulk: young / (three * (one - two * poisson)), shear: young / (two * (one + poisson)) })
    }
    /// Lame's first constant, K - 2G/3, Pa.
    pub fn lambda(&self) -> T {
        self.bulk - self.shear * T::of(2.0 / 3.0)
    }
    /// P-wave modulus, K + 4G/3, Pa.
    pub fn p_wave(&self) -> T {
        self.bulk + self.shear * T::of(4.0 / 3.0)
    }
}

state! {
    /// State variables of a hypoelastic point.
    pub struct HypoelasticState<L> {
        /// Cauchy stress, Pa.
        pub stress: Sym3<L>,
        /// Volume over reference volume.
        pub volume_ratio: L,
    }
}

/// Linear elasticity in rate form: tau' = lambda tr(d) I + 2 G d with an objective rate tau' of the Kirchhoff stress
/// tau = J sigma (\[Ma2010\] section 1.2, where tau is sigma). For small strains: a closed path of strains of size e
/// leaves a residual of order e^2 of its stored energy. (With the rate of sigma it is of order e, since volume changes
/// alter the energy released by shear.)
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LinearElastic<T, R = HughesWinget> {
    density: T,
    moduli: Moduli<T>,
    rate: R,
}

impl<T: Real> LinearElastic<T> {
    /// Create from reference density, kg/m^3, and moduli, with the [`HughesWinget`] rate.
    ///
    /// # Errors
    /// A density that is not positive.
    pub fn new(density: T, moduli: Moduli<T>) -> Result<Self, ParameterError> {
        Ok(LinearElastic {
            density: Check("linear elastic").positive("density", density)?,
            moduli,
            rate: HughesWinget,
        })
    }

    /// Create from checked constants.
    pub(crate) fn known(density: f64, moduli: Moduli<T>) -> Self {
        LinearElastic { density: T::of(density), moduli, rate: HughesWinget }
    }
}

impl<T: Real, R: ObjectiveRate> LinearElastic<T, R> {
    /// Set the objective rate.
    pub fn with_rate<Q: ObjectiveRate>(self, rate: Q) -> LinearElastic<T, Q> {
        LinearElastic { density: self.density, moduli: self.moduli, rate }
    }
    /// The elastic constants.
    pub fn moduli(&self) -> Moduli<T> {
        self.moduli
    }
}

impl<T: Real, R: ObjectiveRate> Constitutive<T> for LinearElastic<T, R> {
    type State<L: Lane<Real = T>> = HypoelasticState<L>;

    fn name(&self) -> &'static str {
        "linear elastic"
    }
    fn density(&self) -> T {
        self.density
    }
    fn virgin(&self) -> HypoelasticState<T::Single> {
        HypoelasticState { stress: Sym3::zero(), volume_ratio: T::Single::one() }
    }
    #[inline(always)]
    fn update<L: Lane<Real = T>>(
        &self,
        kinematics: &Kinematics<L>,
        old: &HypoelasticState<L>,
    ) -> Update<L, HypoelasticState<L>> {
        let step = self.rate.increments(kinematics);
        let strain = step.strain;
        let lambda = L::splat(self.moduli.lambda());
        let two_g = L::splat(self.moduli.shear * T::of(2.0));
        let factor = step.volume_factor;
        let volume_ratio = old.volume_ratio * factor;
        let rotated = self.rate.rotate(&step, &old.stress) * old.volume_ratio;
        let kirchhoff = rotated.plus_times(&strain, two_g).plus_isotropic(lambda * strain.trace());
        let stress = kirchhoff * volume_ratio.recip();
        let state = HypoelasticState { stress, volume_ratio };
        let (turned, finite) = (factor.gt(L::zero()), finite_state(&state));
        let mut fault = Fault::none();
        // One test covers the usual case without breakdown.
        if !(turned & finite).all() {
            fault = fault.require(turned, Breakdown::InvertedVolume).require(finite, Breakdown::NotFinite);
        }
        Update { state, stress, fault }
    }
    #[inline(always)]
    fn stress<L: Lane<Real = T>>(&self, now: &HypoelasticState<L>) -> Sym3<L> {
        now.stress
    }
    #[inline(always)]
    fn volume_ratio<L: Lane<Real = T>>(&self, now: &HypoelasticState<L>) -> L {
        now.volume_ratio
    }
    /// P-wave speed sqrt((K + 4G/3 + J s) / rho0), s a bound of the largest compressive stress: -mean + 2/3 of the
    /// equivalent stress.
    #[inline(always)]
    fn wave_speed<L: Lane<Real = T>>(&self, now: &HypoelasticState<L>) -> L {
        let squeezed =
            now.stress.deviator().equivalent().mul_add(L::of(2.0 / 3.0), -now.stress.mean()).max(L::zero());
        let stiffness = now.volume_ratio.mul_add(squeezed, L::splat(self.moduli.p_wave()));
        (stiffness * L::splat(T::of(1.0) / self.density)).sqrt()
    }
    /// Complementary energy of the Kirchhoff stress, J^2 (s:s / 4G + p^2 / 2K).
    #[inline(always)]
    fn energy<L: Lane<Real = T>>(&self, now: &HypoelasticState<L>) -> L {
        let (mean, dev) = (now.stress.mean(), now.stress.deviator());
        let shear = dev.dot(&dev) * L::splat(T::of(0.25) / self.moduli.shear);
        let bulk = mean * mean * L::splat(T::of(0.5) / self.moduli.bulk);
        now.volume_ratio * now.volume_ratio * (shear + bulk)
    }
}

state! {
    /// State variables of a hyperelastic point.
    pub struct HyperelasticState<L> {
        /// Deformation gradient.
        pub deformation: Mat3<L>,
    }
}

/// Compressible neo-Hookean solid: sigma = \[G (b - I) + lambda ln J I\] / J with b = F F^T
/// (book, "Elasticity and objective rates"), from the energy W = G/2 (tr b - 3) - G ln J + lambda/2 (ln J)^2 per reference volume.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NeoHookean<T> {
    density: T,
    moduli: Moduli<T>,
}

impl<T: Real> NeoHookean<T> {
    /// Create from reference density, kg/m^3, and moduli.
    ///
    /// # Errors
    /// A density that is not positive, or a negative Lame constant K - 2G/3.
    pub fn new(density: T, moduli: Moduli<T>) -> Result<Self, ParameterError> {
        let check = Check("neo-Hookean");
        check.not_negative("Lame's first constant K - 2G/3", moduli.lambda())?;
        Ok(NeoHookean { density: check.positive("density", density)?, moduli })
    }
    /// The elastic constants at small strain.
    pub fn moduli(&self) -> Moduli<T> {
        self.moduli
    }
}

impl<T: Real> Constitutive<T> for NeoHookean<T> {
    type State<L: Lane<Real = T>> = HyperelasticState<L>;

    fn name(&self) -> &'static str {
        "neo-Hookean"
    }
    fn density(&self) -> T {
        self.density
    }
    fn virgin(&self) -> HyperelasticState<T::Single> {
        HyperelasticState { deformation: Mat3::identity() }
    }
    #[inline(always)]
    fn update<L: Lane<Real = T>>(
        &self,
        kinematics: &Kinematics<L>,
        old: &HyperelasticState<L>,
    ) -> Update<L, HyperelasticState<L>> {
        let deformation = kinematics.increment.times_plus(&old.deformation, old.deformation);
        let state = HyperelasticState { deformation };
        let stress = self.stress(&state);
        let (turned, finite) = (deformation.determinant().gt(L::zero()), finite_stress(&stress));
        let mut fault = Fault::none();
        if !(turned & finite).all() {
            fault = fault.require(turned, Breakdown::InvertedVolume).require(finite, Breakdown::NotFinite);
        }
        Update { state, stress, fault }
    }
    #[inline(always)]
    fn stress<L: Lane<Real = T>>(&self, now: &HyperelasticState<L>) -> Sym3<L> {
        let j = now.deformation.determinant();
        let per_volume = j.recip();
        let g = L::splat(self.moduli.shear);
        let b = now.deformation.times_transpose();
        (b * g).plus_isotropic(L::splat(self.moduli.lambda()).mul_add(j.ln(), -g)) * per_volume
    }
    #[inline(always)]
    fn volume_ratio<L: Lane<Real = T>>(&self, now: &HyperelasticState<L>) -> L {
        now.deformation.determinant()
    }
    /// Upper bound: the P-wave modulus along the largest stretch, rho c^2 = \[lambda (1 - ln J) + G (1 + b1)\] / J with
    /// the largest eigenvalue of b bounded by b1 <= tr b/3 + sqrt(2/3 b':b'); never below the modulus at rest.
    #[inline(always)]
    fn wave_speed<L: Lane<Real = T>>(&self, now: &HyperelasticState<L>) -> L {
        let f = &now.deformation;
        let j = f.determinant();
        let (lambda, g) = (L::splat(self.moduli.lambda()), L::splat(self.moduli.shear));
        let b = f.times_transpose();
        let largest = (b.mean() + b.deviator().equivalent() * L::of(2.0 / 3.0)).max(L::one());
        let modulus = lambda * (L::one() - j.ln()).max(L::zero()) + g * (L::one() + largest);
        // c^2 = modulus / (J rho) and rho = rho0 / J.
        (modulus * L::splat(T::of(1.0) / self.density)).sqrt()
    }
    #[inline(always)]
    fn energy<L: Lane<Real = T>>(&self, now: &HyperelasticState<L>) -> L {
        let log_j = now.deformation.determinant().ln();
        let trace = now.deformation.times_transpose().trace();
        let (lambda, g) = (L::splat(self.moduli.lambda()), L::splat(self.moduli.shear));
        let half = L::of(0.5);
        half * g * (trace - L::of(3.0)) - g * log_j + half * lambda * log_j * log_j
    }
}

impl<T: Real> Hyperelastic<T> for NeoHookean<T> {
    #[inline(always)]
    fn deformed<L: Lane<Real = T>>(&self, deformation: &Mat3<L>) -> HyperelasticState<L> {
        HyperelasticState { deformation: *deformation }
    }
}
