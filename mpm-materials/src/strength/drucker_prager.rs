//! Drucker-Prager plasticity with a tension cap.

use crate::elastic::Moduli;
use crate::ground::{Admissible, Geomaterial, Trial};
use crate::lane::{Lane, Real};
use crate::parameter::{Check, ParameterError};
use crate::point::{Breakdown, Fault};
use crate::state;

state! {
    /// State variables of soil, in addition to stress, volume and energy.
    pub struct Sheared<L> {
        /// Accumulated equivalent plastic strain.
        pub plastic_strain: L,
        /// Dilatancy: plastic part of ln J, positive in expansion.
        pub dilation: L,
    }
}

/// Fit of a cone to the hexagonal Mohr-Coulomb pyramid.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Cone {
    /// Cone through the inner edges: exact in triaxial extension, safe elsewhere.
    Inner,
    /// Cone through the outer edges: exact in triaxial compression.
    Outer,
    /// Cone of equal limit loads in plane strain, for dilatancy equal to friction.
    PlaneStrain,
}

impl Cone {
    /// Compute q and k per cohesion from the sine and cosine of the angle.
    fn fit(self, sine: f64, cosine: f64) -> (f64, f64) {
        let root = 3.0_f64.sqrt();
        match self {
            Cone::Inner => (6.0 * sine / (root * (3.0 + sine)), 6.0 * cosine / (root * (3.0 + sine))),
            Cone::Outer => (6.0 * sine / (root * (3.0 - sine)), 6.0 * cosine / (root * (3.0 - sine))),
            // 3 tan/sqrt(9 + 12 tan^2) and 3/sqrt(9 + 12 tan^2)
            Cone::PlaneStrain => {
                let norm = (9.0 * cosine * cosine + 12.0 * sine * sine).sqrt();
                (3.0 * sine / norm, 3.0 * cosine / norm)
            }
        }
    }
}

/// Drucker-Prager soil (book, "Soil"), a [`Geomaterial`]; `Ground::new` turns it into a law. With
/// tau = sqrt(s:s/2) and sigma_m = -p:
///
/// - shear: tau + q_phi sigma_m <= k_phi, flow with dilatancy q_psi <= q_phi;
/// - tension: sigma_m <= sigma_t, at most the apex k_phi/q_phi;
/// - elasticity: p = -K (ln J - dilation), Jaumann rate of the deviator with G.
///
/// The return to the cone is that of MPM3D, d_lambda = f/(G + K q_phi q_psi), exact for the straight cone. Where it
/// would end beyond the cap, or for a trial in pure tension, the stress returns to the cap instead, with
/// tau <= k_phi - q_phi sigma_t: every result is admissible. MPM3D divides the corner by an inclined line and may
/// return slightly outside the cone.
///
/// Tension opens a gap: the opening beyond the cap is not stored, so that a point carries pressure again at its
/// original density. (A rate form would make every such opening permanent.) Limits: perfectly plastic; unlimited
/// dilatancy; plastic strain without the gap.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DruckerPrager<T> {
    density: T,
    bulk: T,
    shear: T,
    friction: T,
    cohesion: T,
    dilatancy: T,
    tension: T,
}

const CHECK: Check = Check("Drucker-Prager");

impl<T: Real> DruckerPrager<T> {
    /// Create from density, kg/m^3, elastic moduli, q_phi, k_phi, Pa, q_psi and sigma_t, Pa.
    ///
    /// # Errors
    /// Density not positive, q_phi or k_phi negative, q_psi outside \[0, q_phi\], sigma_t negative or beyond the
    /// apex k_phi/q_phi.
    pub fn new(
        density: T,
        moduli: Moduli<T>,
        friction: T,
        cohesion: T,
        dilatancy: T,
        tension: T,
    ) -> Result<Self, ParameterError> {
        CHECK.positive("density rho0", density)?;
        CHECK.positive("bulk modulus K", moduli.bulk)?;
        CHECK.positive("shear modulus G", moduli.shear)?;
        CHECK.not_negative("friction q_phi", friction)?;
        CHECK.not_negative("cohesion k_phi", cohesion)?;
        let inside = dilatancy >= T::of(0.0) && dilatancy <= friction;
        CHECK.that(inside, "dilatancy q_psi", dilatancy, "between 0 and q_phi")?;
        // With a rounding tolerance: decks print the apex itself.
        let reach = tension * friction <= cohesion * T::of(1.0 + 1e-3);
        let allowed = "zero or positive and at most k_phi/q_phi";
        CHECK.that(tension >= T::of(0.0) && reach, "tensile strength", tension, allowed)?;
        let apex = if tension * friction > cohesion { cohesion / friction } else { tension };
        Ok(DruckerPrager {
            density,
            bulk: moduli.bulk,
            shear: moduli.shear,
            friction,
            cohesion,
            dilatancy,
            tension: apex,
        })
    }

    /// Create from density, kg/m^3, elastic moduli, friction angle phi, cohesion c, Pa, and dilatancy angle psi
    /// (radians) of Mohr and Coulomb, matched by `cone`. The tensile strength is that of the apex, c/tan phi; without
    /// friction there is no apex and it is c.
    ///
    /// # Errors
    /// phi outside \[0, pi/2), psi outside \[0, phi\], c negative, a density or modulus that is not positive.
    pub fn matching(
        density: T,
        moduli: Moduli<T>,
        cone: Cone,
        friction_angle: T,
        cohesion: T,
        dilatancy_angle: T,
    ) -> Result<Self, ParameterError> {
        let right = T::of(std::f64::consts::FRAC_PI_2);
        let acute = friction_angle >= T::of(0.0) && friction_angle < right;
        CHECK.that(acute, "friction angle", friction_angle, "in [0, pi/2)")?;
        let inside = dilatancy_angle >= T::of(0.0) && dilatancy_angle <= friction_angle;
        CHECK.that(inside, "dilatancy angle", dilatancy_angle, "between 0 and the friction angle")?;
        CHECK.not_negative("cohesion c", cohesion)?;
        let (phi, psi) = (friction_angle.to_double(), dilatancy_angle.to_double());
        let (q_phi, per_cohesion) = cone.fit(phi.sin(), phi.cos());
        let (q_psi, _) = cone.fit(psi.sin(), psi.cos());
        let k_phi = cohesion * T::of(per_cohesion);
        let q_phi = T::of(q_phi);
        let tension = if q_phi > T::of(0.0) { k_phi / q_phi } else { cohesion };
        Self::new(density, moduli, q_phi, k_phi, T::of(q_psi), tension)
    }

    /// Set the tensile strength sigma_t, Pa.
    ///
    /// # Errors
    /// sigma_t negative or beyond the apex.
    pub fn with_tension_cap(self, tension: T) -> Result<Self, ParameterError> {
        let moduli = Moduli { bulk: self.bulk, shear: self.shear };
        Self::new(self.density, moduli, self.friction, self.cohesion, self.dilatancy, tension)
    }

    /// Slope soil of MPM3D-F90 `Slopefail.mpm`: rho 2100 kg/m^3, E 70 MPa, nu 0.3, phi 20 degrees, c 10 kPa, inner
    /// cone, no dilatancy, tension to the apex: q_phi 0.3545, k_phi 9.74 kPa, sigma_t 27.48 kPa (book, "Material
    /// constants").
    pub fn slope_soil() -> Self {
        Self::known(2100.0, [70e6, 0.3], Cone::Inner, 20.0, 10e3)
    }

    /// Aluminium bars as granular material: rho 2650 kg/m^3, E 0.84 MPa, nu 0.3, phi 19.8 degrees, no cohesion, no
    /// dilatancy (two public sources, book, "Material constants"), matched in plane strain, our choice.
    pub fn aluminium_bars() -> Self {
        Self::known(2650.0, [0.84e6, 0.3], Cone::PlaneStrain, 19.8, 0.0)
    }

    pub(crate) fn known(
        density: f64,
        [young, poisson]: [f64; 2],
        cone: Cone,
        degrees: f64,
        cohesion: f64,
    ) -> Self {
        let phi = degrees.to_radians();
        let (q_phi, per_cohesion) = cone.fit(phi.sin(), phi.cos());
        DruckerPrager {
            density: T::of(density),
            bulk: T::of(young / (3.0 * (1.0 - 2.0 * poisson))),
            shear: T::of(young / (2.0 * (1.0 + poisson))),
            friction: T::of(q_phi),
            cohesion: T::of(per_cohesion * cohesion),
            dilatancy: T::of(0.0),
            tension: T::of(per_cohesion * cohesion / q_phi),
        }
    }

    /// Friction coefficient q_phi.
    pub fn friction(&self) -> T {
        self.friction
    }
    /// Cohesion k_phi, Pa.
    pub fn cohesion(&self) -> T {
        self.cohesion
    }
    /// Tensile strength sigma_t, Pa.
    pub fn tension_cap(&self) -> T {
        self.tension
    }
}

impl<T: Real> Geomaterial<T> for DruckerPrager<T> {
    type History<L: Lane<Real = T>> = Sheared<L>;

    fn name(&self) -> &'static str {
        "Drucker-Prager"
    }
    fn density(&self) -> T {
        self.density
    }
    fn shear_modulus(&self) -> T {
        self.shear
    }
    fn virgin(&self) -> Sheared<T::Single> {
        Sheared { plastic_strain: T::Single::zero(), dilation: T::Single::zero() }
    }
    #[inline(always)]
    fn return_map<L: Lane<Real = T>>(&self, trial: &Trial<L>, old: &Sheared<L>) -> Admissible<L, Sheared<L>> {
        let (zero, one) = (L::zero(), L::one());
        let (q, k, cap) = (L::splat(self.friction), L::splat(self.cohesion), L::splat(self.tension));
        let mean = L::splat(self.bulk) * (trial.volume_ratio.ln() - old.dilation);
        let tau = (trial.deviator.dot(&trial.deviator) * L::of(0.5)).sqrt();

        // Return to the cone.
        let over = (q.mul_add(mean, tau) - k).max(zero);
        let stiffness = self.shear + self.bulk * self.friction * self.dilatancy;
        let multiplier = over * L::splat(T::of(1.0) / stiffness);
        let shifted = mean - multiplier * L::splat(self.bulk * self.dilatancy);
        // Return to the cap where the return to the cone ends beyond it.
        let torn = shifted.gt(cap);
        let new_mean = L::select(torn, cap, shifted);
        let flowed = L::select(torn, zero, multiplier * L::splat(self.dilatancy));
        let sheared = tau - multiplier * L::splat(self.shear);
        let corner = tau.min((k - q * cap).max(zero));
        let new_tau = L::select(torn, corner, sheared);

        let loss = tau - new_tau;
        let shrink = L::select(loss.gt(zero), one - loss / tau, one);
        let slip = loss * L::splat(T::of(1.0) / self.shear);
        // sqrt(2/3 d_ep:d_ep) of the shear slip and the plastic dilatation.
        let square = slip * slip * L::of(1.0 / 3.0) + flowed * flowed * L::of(2.0 / 9.0);
        let history =
            Sheared { plastic_strain: old.plastic_strain + square.sqrt(), dilation: old.dilation + flowed };
        let fault = Fault::none().require((mean + tau).is_finite(), Breakdown::NotFinite);
        Admissible { deviator: trial.deviator * shrink, pressure: -new_mean, history, fault }
    }
    #[inline(always)]
    fn bulk_modulus<L: Lane<Real = T>>(&self, _: L, _: &Sheared<L>) -> L {
        L::splat(self.bulk)
    }
    #[inline(always)]
    fn plastic_strain<L: Lane<Real = T>>(&self, history: &Sheared<L>) -> L {
        history.plastic_strain
    }
}
