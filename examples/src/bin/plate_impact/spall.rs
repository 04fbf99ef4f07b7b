//! Spall: a flyer of thickness d_f on a target of 2 d_f. The releases of both free surfaces meet one d_f under the
//! target's, where the metal is pulled apart; what the free surface then does tells the strength.
//!
//! The metal is a 4340 steel without yield strength (1 kPa), so that there is one speed of sound, c0, and no elastic
//! precursor. Of the library's metals its shock line is the steepest: the release of the flyer is a ramp only because
//! compressed metal is faster. Where the metal breaks at once, the front of the crack's signal eats the foot of that
//! ramp, which the acoustic formula of the pull-back leaves out, and eats the more, the thicker the viscosity makes it.
//! A crack that takes work bears on while it opens, and its signal leaves the foot. Both are run; `lagrange.rs` does the
//! same by another method.

use examples::{CaseError, Totals};
use mpm_materials::{CohesiveSpall, Constitutive, IntoMaterial, J2, Solid};

use crate::metals::Metal;
use crate::plates::{self, Files, Look, Plates, Point};
use crate::shock::arrival;

/// The metal, by its name in the list.
pub const METAL: &str = "steel 4340";
/// Thickness of the flyer d_f, m; the target is twice as thick.
pub const FLYER: f64 = 0.005;
/// Speed of the flyer, m/s.
pub const SPEED: f64 = 310.0;
/// Spall strength, Pa: an input of the check, of the size seen in plate impact, no claim about the steel.
pub const STRENGTH: f64 = 3.5e9;
/// Opening at which a crack bears nothing, m: a surface takes 17.5 kJ/m2, (1 - nu^2) K^2/E of a toughness of 62 MPa m^1/2.
pub const OPENING: f64 = 10e-6;
/// The opening of a crack that takes next to no work: it opens at once, as with a limit of tension alone.
pub const AT_ONCE: f64 = 1e-9;
/// Shear modulus, Pa (book, "Material constants"), and the yield strength, Pa, that makes it meaningless.
const SHEAR_MODULUS: f64 = 80e9;
const YIELD_STRENGTH: f64 = 1e3;
/// Ends of runs in transits of the flyer by sound: the scab has rung once; what can fail has failed.
pub const RINGING: f64 = 6.5;
pub const ONSET: f64 = 3.8;
/// The plateau of the free surface is a mean over this time, and the pull-back is looked for in the next, in transits.
const PLATEAU: [f64; 2] = [2.6, 3.3];
const PULL_BACK: [f64; 2] = [3.3, 5.0];

/// One impact.
pub struct Spall {
    /// Cells along the flyer.
    pub cells: u32,
    /// Velocity of the free surface.
    pub surface: Vec<Look>,
    /// Velocity of the plateau, m/s.
    pub plateau: f64,
    /// How much of it the free surface loses before the spall tells it of the crack, m/s.
    pub pull_back: f64,
    /// When the shock came to the free surface, s.
    pub arrival: f64,
    /// Virgin thickness of what is intact between the free surface and the nearest failed particle, m.
    pub scab: f64,
    /// Virgin thickness of what failed, m.
    pub failed: f64,
    /// The target at the end.
    pub profile: Vec<Point>,
    /// Sums of the run.
    pub totals: Totals,
}

/// 2 sigma_sp/(rho0 c0), m/s: the pull-back in acoustics, and the slowest flyer whose tension reaches the strength.
pub fn acoustic_pull_back(metal: &Metal) -> f64 {
    2.0 * STRENGTH / (metal.density * metal.sound_speed)
}

/// One impact to run.
#[derive(Clone, Copy, Debug)]
pub struct Setup {
    /// Speed of the flyer, m/s.
    pub speed: f64,
    /// Opening at which a crack bears nothing, m.
    pub opening: f64,
    /// End of the run in transits of the flyer by sound.
    pub transits: f64,
    /// Cells along the flyer.
    pub cells: u32,
    /// Linear and quadratic coefficient of the bulk viscosity.
    pub viscosity: [f64; 2],
}

/// Let a flyer hit the target.
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
