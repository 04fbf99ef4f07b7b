//! Spall: a flyer of thickness d_f hits a target of 2 d_f. The release waves of both free surfaces intersect at a depth d_f below the
//! target's free surface and put the metal in tension; the pull-back of the free surface measures the spall strength.
//!
//! The metal is a 4340 steel without yield strength (1 kPa), so that there is one speed of sound, c0, and no elastic precursor. Its shock
//! line is the steepest of the library's metals: the release of the flyer is a ramp only because compressed metal is faster. With
//! instantaneous fracture the front of the crack's signal overtakes the foot of that ramp, more so for a thicker front from viscosity; the
//! acoustic formula of the pull-back neglects this. A cohesive crack carries traction while it opens, and its signal preserves the foot.
//! Both are run; `lagrange.rs` computes a reference by another method.

use examples::{CaseError, Totals};
use mpm_materials::{CohesiveSpall, Constitutive, IntoMaterial, J2, Solid};

use crate::metals::Metal;
use crate::plates::{self, Files, Look, Plates, Point};
use crate::shock::arrival;

/// Metal, by its name in the list.
pub const METAL: &str = "steel 4340";
/// Thickness of the flyer d_f, m; the target is twice as thick.
pub const FLYER: f64 = 0.005;
/// Speed of the flyer, m/s.
pub const SPEED: f64 = 310.0;
/// Spall strength, Pa: an input of the check, of the magnitude observed in plate impact, not a property of the steel.
pub const STRENGTH: f64 = 3.5e9;
/// Opening at which the traction of a crack is zero, m: fracture energy 17.5 kJ/m2, (1 - nu^2) K^2/E of a toughness of 62 MPa m^1/2.
pub const OPENING: f64 = 10e-6;
/// Opening of a crack with negligible fracture energy, m: it fails at once, as with a tension limit.
pub const AT_ONCE: f64 = 1e-9;
/// Shear modulus, Pa (book, "Material constants"), and a yield strength, Pa, that makes it irrelevant.
const SHEAR_MODULUS: f64 = 80e9;
const YIELD_STRENGTH: f64 = 1e3;
/// Ends of runs in transits of the flyer by sound: after one reverberation of the scab, and after the onset of failure.
pub const RINGING: f64 = 6.5;
pub const ONSET: f64 = 3.8;
/// Averaging window of the plateau of the free surface, and window of the pull-back, in transits.
const PLATEAU: [f64; 2] = [2.6, 3.3];
const PULL_BACK: [f64; 2] = [3.3, 5.0];

/// Results of an impact.
pub struct Spall {
    /// Cells along the flyer.
    pub cells: u32,
    /// Velocity of the free surface.
    pub surface: Vec<Look>,
    /// Velocity of the plateau, m/s.
    pub plateau: f64,
    /// Pull-back: loss of velocity of the free surface before the arrival of the crack's signal, m/s.
    pub pull_back: f64,
    /// Arrival time of the shock at the free surface, s.
    pub arrival: f64,
    /// Reference thickness of the intact layer between the free surface and the nearest failed particle, m.
    pub scab: f64,
    /// Reference thickness of failed metal, m.
    pub failed: f64,
    /// Target at the end.
    pub profile: Vec<Point>,
    /// Totals of the run.
    pub totals: Totals,
}

/// Acoustic pull-back 2 sigma_sp/(rho0 c0), m/s; also the slowest flyer whose tension reaches the strength.
pub fn acoustic_pull_back(metal: &Metal) -> f64 {
    2.0 * STRENGTH / (metal.density * metal.sound_speed)
}

/// Parameters of an impact.
#[derive(Clone, Copy, Debug)]
pub struct Setup {
    /// Speed of the flyer, m/s.
    pub speed: f64,
    /// Opening at which the traction of a crack is zero, m.
    pub opening: f64,
    /// End of the run in transits of the flyer by sound.
    pub transits: f64,
    /// Cells along the flyer.
    pub cells: u32,
    /// Linear and quadratic coefficient of the bulk viscosity.
    pub viscosity: [f64; 2],
}

/// Run the impact of a flyer on the target.
pub fn spall(metal: &Metal, setup: &Setup, files: Files) -> Result<Spall, CaseError> {
    let Setup { speed, opening, transits, cells, viscosity: [linear, quadratic] } = *setup;
    let transit = FLYER / metal.sound_speed;
    let plates = Plates {
        flyer: cells,
        target: 2 * cells,
        spacing: FLYER / f64::from(cells),
        speed,
        sound_speed: metal.sound_speed,
        gauges: vec![2 * cells - 1],
        end: transits * transit,
    };
    let law = Solid::new(J2::linear(SHEAR_MODULUS, YIELD_STRENGTH, 0.0)?, metal.law)
        .with_failure(CohesiveSpall::new(STRENGTH, opening)?)
        .with_bulk_viscosity(linear, quadratic)?;
    let run = plates::collide(law.compiled().into_material(), &plates, files)?;
    let surface = run.gauges.into_iter().next().unwrap_or_default();
    let within = |[from, to]: [f64; 2]| {
        surface.iter().filter(move |l| l.time > from * transit && l.time < to * transit).map(|l| l.speed)
    };
    let plateau = within(PLATEAU).sum::<f64>() / within(PLATEAU).count() as f64;
    let lowest = within(PULL_BACK).fold(plateau, f64::min);
    Ok(Spall {
        cells,
        plateau,
        pull_back: plateau - lowest,
        arrival: arrival(&surface, 0.5 * speed),
        scab: run.target.iter().rev().take_while(|p| !p.failed).map(|p| p.thickness).sum(),
        failed: run.target.iter().filter(|p| p.failed).map(|p| p.thickness).sum(),
        surface,
        profile: run.target,
        totals: run.totals,
    })
}
