//! Spall: a flyer of thickness d_f on a target of 2 d_f. The releases of both free surfaces meet one d_f under the
//! target's, where the metal is pulled apart; what the free surface then does tells the strength.
//!
//! The metal is lead, whose yield strength of 12 MPa is a hundredth of the stresses: the acoustic formula with the bulk
//! sound speed, du = 2 sigma_sp/(rho0 c0), holds. Stresses are small beside K, so that the shock is nearly acoustic,
//! but not too small: the release of the flyer becomes a ramp only because compressed metal is faster, and a tensile
//! limit without time reads no more than the ramp resolves.

use examples::{CaseError, Totals};
use mpm_materials::{TensilePressure, library};

use crate::metals::Metal;
use crate::plates::{self, Files, Look, Plates, Point};
use crate::shock::arrival;

/// Thickness of the flyer d_f, m; the target is twice as thick.
pub const FLYER: f64 = 0.005;
/// Speed of the flyer, m/s.
pub const SPEED: f64 = 98.0;
/// Spall strength, Pa: an input of the check, of the size seen in plate impact, no claim about lead.
pub const STRENGTH: f64 = 0.9e9;
/// End of the run in transits of the flyer by sound: the scab has rung once.
const TRANSITS: f64 = 6.5;
/// The plateau of the free surface is a mean over this time, and the pull-back is looked for in the next, in transits.
const PLATEAU: [f64; 2] = [2.6, 3.4];
const PULL_BACK: [f64; 2] = [3.4, 5.0];

/// One impact with spall.
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
    /// Thickness of the piece between the free surface and the nearest failed particle, m.
    pub scab: f64,
    /// Thickness of virgin metal that failed, m.
    pub failed: f64,
    /// The target at the end.
    pub profile: Vec<Point>,
    /// Sums of the run.
    pub totals: Totals,
}

/// 2 sigma_sp/(rho0 c0), m/s.
pub fn pull_back(lead: &Metal) -> f64 {
    2.0 * STRENGTH / (lead.density * lead.sound_speed)
}

/// Let the flyer hit the target.
pub fn spall(
    lead: &Metal,
    cells: u32,
    [linear, quadratic]: [f64; 2],
    threads: usize,
    files: Files,
) -> Result<Spall, CaseError> {
    let h = FLYER / f64::from(cells);
    let transit = FLYER / lead.sound_speed;
    let plates = Plates {
        flyer: cells,
        target: 2 * cells,
        spacing: h,
        speed: SPEED,
        sound_speed: lead.sound_speed,
        gauges: vec![2 * cells - 1],
        end: TRANSITS * transit,
        threads,
    };
    let law = library::lead::<f64>()
        .with_failure(TensilePressure::new(STRENGTH)?)
        .with_bulk_viscosity(linear, quadratic)?;
    let run = plates::collide(law, &plates, files)?;
    let surface = run.gauges.into_iter().next().unwrap_or_default();
    let within = |[from, to]: [f64; 2]| {
        surface.iter().filter(move |l| l.time > from * transit && l.time < to * transit).map(|l| l.speed)
    };
    let plateau = within(PLATEAU).sum::<f64>() / within(PLATEAU).count() as f64;
    let lowest = within(PULL_BACK).fold(plateau, f64::min);
    let from_surface = run.target.iter().rev();
    Ok(Spall {
        cells,
        plateau,
        pull_back: plateau - lowest,
        arrival: arrival(&surface, 0.5 * SPEED),
        scab: from_surface.take_while(|p| !p.failed).map(|p| p.thickness).sum(),
        failed: run.target.iter().filter(|p| p.failed).map(|p| p.thickness).sum(),
        surface,
        profile: run.target,
        totals: run.totals,
    })
}
