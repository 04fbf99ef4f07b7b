//! Checks of shock lines, spall and conservation.

use examples::{Check, Totals};

use crate::lagrange::{self, Mesh};
use crate::metals::{self, Metal};
use crate::shock::{self, Impact};
use crate::spall::{self, Spall};

const LINE_TOLERANCE: f64 = 0.01;
const STATE_TOLERANCE: f64 = 0.01;
const OVERSHOOT_TOLERANCE: f64 = 0.03;
const LEAST_ORDER: f64 = 0.7;
const SURFACE_TOLERANCE: f64 = 0.01;
const PULL_BACK_TOLERANCE: f64 = 0.10;
/// Number of cells from which the mean energy is evaluated.
const ENERGY_CELLS: u32 = 300;
/// Number of cells along the flyer from which the pull-back is evaluated.
const RESOLVED: u32 = 100;
/// Flyer speeds below and above the spall threshold, over the acoustic threshold: 10 % to both sides.
pub const SLOWER: f64 = 0.9;
pub const FASTER: f64 = 1.1;
/// Number of cells along the flyer and viscosity coefficients of the reference for the scab of plates without viscosity.
const FINE: usize = 800;
const NEXT_TO_NONE: [f64; 2] = [0.05, 2.0];
const ENERGY_TOLERANCE: f64 = 0.01;
const MOMENTUM_TOLERANCE: f64 = 1e-12;

/// Return all checks.
pub fn of(
    impacts: &[Impact],
    refined: &[Impact],
    spalls: &[Spall],
    viscosity: [f64; 2],
    totals: &Totals,
) -> Vec<Check> {
    let mut checks = Vec::new();
    for metal in metals::all() {
        let own: Vec<&Impact> = impacts.iter().filter(|i| i.metal.name == metal.name).collect();
        checks.extend(of_line(&metal, &own));
    }
    checks.extend(of_refinement(refined));
    if let Some(steel) = metals::all().iter().find(|m| m.name == spall::METAL) {
        let mesh = Mesh {
            cells: FINE,
            length: spall::FLYER / FINE as f64,
            viscosity: NEXT_TO_NONE,
            opening: spall::OPENING,
        };
        let inviscid = lagrange::spall(steel, spall::SPEED, &mesh);
        let acoustic = spall::acoustic_pull_back(steel);
        let name = "finite differences, next to no viscosity: pull-back";
        checks.push(Check::gate(
            name,
            inviscid.pull_back,
            "m/s",
            acoustic,
            PULL_BACK_TOLERANCE,
            "acoustic [C]",
        ));
        let name = "the same, broken at once";
        let at_once = lagrange::spall(steel, spall::SPEED, &Mesh { opening: spall::AT_ONCE, ..mesh });
        checks.push(
            Check::gate(name, at_once.pull_back, "m/s", acoustic, PULL_BACK_TOLERANCE, "acoustic [C]")
                .known_miss(
                    "10.7 % below: a crack of no width smears its own signal, even with next to no viscosity",
                ),
        );
        checks.extend(spalls.chunks(4).flat_map(|runs| of_spall(steel, runs, viscosity, inviscid.scab)));
    }
    let energy = totals.energy_error;
    checks.push(Check::gate("energy error, worst run", energy, "-", 0.0, ENERGY_TOLERANCE, "conservation"));
    let momentum = totals.momentum_error;
    checks.push(Check::gate("momentum error", momentum, "-", 0.0, MOMENTUM_TOLERANCE, "conservation"));
    checks
}

/// Check the fitted line, and the worst of its shocks.
fn of_line(metal: &Metal, impacts: &[&Impact]) -> Vec<Check> {
    let points: Vec<[f64; 2]> = impacts.iter().map(|i| [i.particle_speed, i.measured.front]).collect();
    let [sound_speed, slope] = shock::line(&points);
    let name = |what: &str| format!("{}: {what}", metal.name);
    let speed = 1e-3 * metal.sound_speed;
    let mut checks = vec![
        Check::gate(name("c0"), 1e-3 * sound_speed, "km/s", speed, LINE_TOLERANCE, metal.source),
        Check::gate(name("s"), slope, "-", metal.slope, LINE_TOLERANCE, metal.source),
    ];
    let worst = |which: usize| examples::worst(impacts.iter().map(|i| i.errors()[which]));
    let tolerances = [LINE_TOLERANCE, STATE_TOLERANCE, STATE_TOLERANCE, STATE_TOLERANCE];
    for (which, what) in ["U_s", "p", "rho/rho0 - 1", "e"].into_iter().enumerate() {
        let name = name(&format!("{what}, worst relative error"));
        let check = Check::gate(name, worst(which), "-", 0.0, tolerances[which], "Rankine-Hugoniot");
        let heat = "on few cells the heat that the start leaves at the plane of impact is still in the mean of the energy";
        let fine = impacts.iter().all(|i| i.cells >= ENERGY_CELLS);
        checks.push(if what == "e" { check.judged_if(fine, heat) } else { check });
    }
    checks
}

/// Check the order of convergence of the profile to the step, and the overshoot of the pressure.
fn of_refinement(refined: &[Impact]) -> Vec<Check> {
    let [first, .., last] = refined else { return Vec::new() };
    let ratio = f64::from(last.cells) / f64::from(first.cells);
    let order = (first.profile_error() / last.profile_error()).ln() / ratio.ln();
    let mut checks = Vec::new();
    for impact in refined {
        let at = format!("{}, {} cells", impact.metal.name, impact.cells);
        let name = format!("{at}: mean error of rho/rho0 - 1 along the target");
        checks.push(Check::unreferenced(name, impact.profile_error(), "-", "its order is judged"));
        let [front, ..] = impact.errors();
        let name = format!("{at}: relative error of U_s");
        checks.push(Check::gate(name, front, "-", 0.0, LINE_TOLERANCE, impact.metal.source));
        let name = format!("{at}: overshoot of the pressure");
        checks.push(Check::at_most(name, impact.overshoot, "-", OVERSHOOT_TOLERANCE, "3 % of the shock"));
    }
    let name = "order of the profile's error in h";
    checks.push(Check::at_least(name, order, "-", LEAST_ORDER, "first order at a jump"));
    checks
}

/// Check free surface and scab, also for instantaneous fracture, and flyers just below and above the threshold.
fn of_spall(steel: &Metal, runs: &[Spall], viscosity: [f64; 2], inviscid_scab: f64) -> Vec<Check> {
    let [spall, at_once, slower, faster] = runs else { return Vec::new() };
    let decides = |check: Check| {
        check.judged_if(
            spall.cells >= RESOLVED,
            "less than 100 cells along the flyer do not resolve crack and release",
        )
    };
    let h = spall::FLYER / f64::from(spall.cells);
    let at = |what: &str| format!("spall, {} cells: {what}", spall.cells);
    // The gauge is the middle of the last cell.
    let due = (2.0 * spall::FLYER - 0.5 * h) / steel.shocked(0.5 * spall::SPEED).front;
    let (arrival, plateau) = (1e6 * spall.arrival, spall.plateau);
    let (scab, thickness) = (1e3 * spall.scab, 1e3 * spall::FLYER);
    let one_cell = 1.0 / f64::from(spall.cells);
    let mut checks = vec![
        decides(Check::gate(
            at("shock at the free surface"),
            arrival,
            "µs",
            1e6 * due,
            SURFACE_TOLERANCE,
            "U_s",
        )),
        Check::gate(
            at("velocity of the free surface"),
            plateau,
            "m/s",
            spall::SPEED,
            SURFACE_TOLERANCE,
            "2 u_p",
        ),
    ];
    let name = at("thickness of the scab, within h");
    let acoustic = decides(Check::gate(name, scab, "mm", thickness, one_cell, "d_f, acoustic [C]"));
    // Acoustic theory neglects the width of the front, which is some cells.
    checks.push(match spall.cells {
        0..200 => acoustic.known_miss("2 % off with 100 cells, whose width is 1 %"),
        _ => acoustic,
    });
    let source = "finite differences, next to no viscosity";
    let same = decides(Check::gate(at("the same"), scab, "mm", 1e3 * inviscid_scab, one_cell, source));
    checks.push(match spall.cells {
        0..200 => same,
        _ => {
            same.known_miss("0.9 % below: finite differences have a scab 1.1 % thicker than acoustic theory")
        }
    });

    // The front of the crack's signal must be thinner than the ramp of the release.
    let (acoustic, theory) = (spall::acoustic_pull_back(steel), "2 sigma_sp/(rho0 c0), acoustic [C]");
    let pull_back = |what: &str, run: &Spall| {
        Check::gate(at(what), run.pull_back, "m/s", acoustic, PULL_BACK_TOLERANCE, theory)
    };
    checks.push(decides(pull_back("pull-back of the free surface", spall)));
    checks.push(
        decides(pull_back("pull-back where the metal breaks at once", at_once)).known_miss(
            "31, 25, 23 % below with 100, 200, 400 cells: a crack of no width sends a signal that bulk viscosity smears",
        ),
    );
    // Bulk viscosity determines the thickness of that front; the reference has the same viscosity on a finer mesh.
    let cells = spall.cells as usize * if spall.cells > 100 { 2 } else { 4 };
    for (what, run, opening) in [
        ("pull-back, the same viscosity", spall, spall::OPENING),
        ("the same, broken at once", at_once, spall::AT_ONCE),
    ] {
        let viscous = lagrange::spall(steel, spall::SPEED, &Mesh { cells, length: h, viscosity, opening });
        let (value, reference) = (run.pull_back, viscous.pull_back);
        let source = "finite differences";
        checks.push(decides(Check::gate(at(what), value, "m/s", reference, PULL_BACK_TOLERANCE, source)));
    }
    let name = at(&format!("failed, flyer at {SLOWER} of 2 sigma_sp/(rho0 c0)"));
    checks.push(Check::at_most(name, 1e3 * slower.failed, "mm", 0.0, "the tension does not reach sigma_sp"));
    let name = at(&format!("failed, flyer at {FASTER} of 2 sigma_sp/(rho0 c0)"));
    checks.push(Check::at_least(name, 1e3 * faster.failed, "mm", 0.25e3 * h, "it does"));
    checks
}
