//! Bars in uniaxial strain: impact end to end, and waves through a joint.

use std::path::Path;

use examples::blocks::scene::Asked;
use examples::blocks::waves::{LENGTH, PRELOAD, SPEED, Struck, WAVE, most, pressed, reflected, strike};
use examples::{CaseError, Check, Restart, Totals, methods};
use mpm_core::{Flip, Linear, Method, Musl, PlaneStrain};

use crate::{Outcome, figures};

/// Linear coefficient of bulk viscosity.
const VISCOSITY: f64 = 0.03;

/// Tolerance of the cut pulse: its edge is one or two cells wide, of twenty.
const CUT_TOLERANCE: f64 = 0.1;

/// Return the method for a smooth pulse.
fn plain() -> Method<Linear, Flip, Musl, PlaneStrain> {
    Method::new(Linear, Flip, Musl, PlaneStrain)
}

/// Run equal bars, bars of different impedance, bars of different length.
pub fn impact(cells: u32, asked: Asked, folder: &Path, restart: &Restart) -> Result<Outcome, CaseError> {
    let (mut checks, mut totals, mut curves) = (Vec::new(), Totals::default(), Vec::new());
    for (name, ratio, second) in
        [("equal bars", 1.0, 1.0), ("second twice as heavy", 2.0, 1.0), ("second twice as long", 1.0, 2.0)]
    {
        let h = LENGTH / f64::from(cells);
        // FLIP computes the strain from velocities that were mapped to particles and back, which smears fronts; FMPM undoes
        // that (book, "Bars, discs, Hertz: exact values").
        let task = asked.in_simulation(restart.scene(format!("impact_{}", name.replace(' ', "_")))?);
        let struck = strike(methods::linear_fmpm_usf(), cells, [ratio, second], VISCOSITY, task)?;
        totals = totals.plus(&struck.totals);
        let Struck { joint, stress, plateau, last, rows, .. } = struck;
        let end = rows.last().copied().unwrap_or([f64::NAN; 4]);
        let named = |what: &str| format!("{name}: {what}");
        let exact = "exact, V8";
        checks.push(Check::gate(named("velocity of the joint"), plateau[0], "m/s", joint, 0.01, exact));
        checks.push(Check::gate(named("stress"), plateau[1], "Pa", stress, 0.03, exact));
        // The smeared front is located at half the stress.
        let duration = 2.0 * LENGTH / WAVE;
        let tolerance = 2.0 * h / WAVE / duration;
        checks.push(Check::gate(named("duration"), 1e3 * last, "ms", 1e3 * duration, tolerance, exact));
        let restitution = (end[2] - end[1]) / SPEED;
        if ratio == 1.0 && second == 1.0 {
            checks.push(Check::at_least(named("restitution"), restitution, "-", 0.97, "T7; exact 1"));
        } else if second > 1.0 {
            let source = "L1/L2, from memory [M]";
            checks.push(Check::remembered(named("restitution"), restitution, "-", 1.0 / second, source));
        }
        curves.push((name.to_string(), rows));
    }
    figures::impact(&curves, folder)?;
    checks.push(Check::gate("bars: momentum", totals.momentum_error, "-", 0.0, 1e-12, "V8"));
    Ok(Outcome { checks, totals })
}

/// Run the same pulse through a bar of one piece and through one of two.
pub fn wave(cells: u32, asked: Asked, folder: &Path, restart: &Restart) -> Result<Outcome, CaseError> {
    let push = 0.5 * PRELOAD;
    let task = |label: &str| Ok::<_, CaseError>(asked.in_simulation(restart.scene(label)?));
    let (bonded, a) = pressed(plain(), cells, true, push, task("push_one_piece")?)?;
    let (split, b) = pressed(plain(), cells, false, push, task("push_two_pieces")?)?;
    let pull = -2.0 * PRELOAD;
    let (whole, c) = pressed(plain(), cells, true, pull, task("pull_one_piece")?)?;
    let (open, d) = pressed(plain(), cells, false, pull, task("pull_two_pieces")?)?;
    let totals = [b, c, d].iter().fold(a, |sum, t| sum.plus(t));
    let reflected = reflected(&bonded, &split, push);
    let source = "the bar of one piece, V9";
    let mut checks = vec![
        Check::gate(
            "push: transmitted peak",
            most(&split, 2, 1.0),
            "m/s",
            most(&bonded, 2, 1.0),
            0.01,
            source,
        ),
        Check::gate("push: reflected over incident", reflected, "-", 0.0, 0.01, source),
    ];
    let peak = |rows: &[[f64; 5]]| most(rows, 2, -1.0);
    let (uncut, cut) = (peak(&whole), peak(&open));
    let transmitted = cut / uncut;
    let what = "pull: transmitted peak over that of one piece";
    checks.push(Check::at_most(what, transmitted, "-", 0.75, "V9; between open and bonded"));
    let source = "the pull beyond the pressure is cut [C]";
    checks.push(Check::gate(what, transmitted, "-", 0.5, CUT_TOLERANCE, source));
    figures::wave(
        &[
            ("one piece", &bonded),
            ("two pieces", &split),
            ("one piece, pulled", &whole),
            ("two pieces, pulled", &open),
        ],
        folder,
    )?;
    Ok(Outcome { checks, totals })
}
