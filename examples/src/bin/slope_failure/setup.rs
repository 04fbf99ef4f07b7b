//! Parameters of a run.

use examples::CaseError;
use mpm_materials::strength::DruckerPrager;
use mpm_materials::{Ground, Moduli};
use serde::Serialize;

use crate::bishop::Strength;

/// Slope of MPM3D-F90 `Slopefail.mpm`: left end, shoulder, toe and right end, m.
pub const CREST: f64 = 0.0;
pub const SHOULDER: f64 = 30.0;
pub const TOE: f64 = 50.0;
pub const FAR: f64 = 110.0;
/// Height of the crest above the toe, and level of the base relative to the toe, m.
pub const HEIGHT: f64 = 20.0;
pub const BASE: f64 = -15.0;
/// Gravity, m/s^2.
pub const GRAVITY: f64 = 9.80;
/// Density, kg/m^3.
pub const DENSITY: f64 = 2100.0;
/// Drucker-Prager constants q_phi and k_phi, Pa, of the soil.
pub const CONE: [f64; 2] = [0.3545, 9740.0];

/// Parameters of a run.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Setup {
    /// Cell size, m; two particles per cell along each axis.
    pub spacing: f64,
    /// Divisor of cohesion and of the tangent of the friction angle.
    pub reduction: f64,
    /// Duration of the linear growth of gravity, s; 0 for a sudden load.
    pub ramp: f64,
    /// End of the run, s.
    pub end: f64,
    pub threads: usize,
}

impl Setup {
    /// Return cohesion and friction of Mohr-Coulomb that are effective in plane strain. Without dilatancy the stress along the third axis
    /// is the mean of the others, so that tau + q_phi sigma_m <= k_phi is sin(phi) = q_phi, c = k_phi / cos(phi).
    pub fn strength(&self) -> Strength {
        let cosine = (1.0 - CONE[0] * CONE[0]).sqrt();
        Strength { cohesion: CONE[1] / cosine / self.reduction, tangent: CONE[0] / cosine / self.reduction }
    }
    /// Build the law of the soil.
    ///
    /// # Errors
    /// Invalid reduction of the strength.
    pub fn soil(&self) -> Result<Ground<DruckerPrager<f64>>, CaseError> {
        let Strength { cohesion, tangent } = self.strength();
        let cosine = 1.0 / (1.0 + tangent * tangent).sqrt();
        let (friction, cohesion) = (tangent * cosine, cohesion * cosine);
        let elastic = Moduli::young_poisson(70e6, 0.3)?;
        let apex = cohesion / friction;
        Ok(Ground::new(DruckerPrager::new(DENSITY, elastic, friction, cohesion, 0.0, apex)?))
    }
    /// Return the name in file names.
    pub fn name(&self) -> String {
        format!("{:.0}mm", 1e3 * self.spacing)
    }
}
