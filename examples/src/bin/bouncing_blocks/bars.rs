//! Bars in uniaxial strain: impact end to end, and waves through a joint.

use std::path::Path;
use std::sync::Arc;

use examples::{CaseError, Check, Detection, Law, Totals};
use mpm_contact::Gradients;
use mpm_core::geometry::{Cuboid, Filling, Lattice, Seeds, fill};
use mpm_core::{
    BlockGrid, Boundary, Composition, Flip, Fmpm, Linear, Method, Mpm, Musl, PlaneStrain, Side, Traction, Usf,
};

use crate::scene::{Asked, Run, Watch, mean, rubber, run, velocity};
use crate::{Outcome, figures};

/// Density, kg/m^3; wave speed, m/s; length of a bar, m.
const DENSITY: f64 = 1000.0;
const WAVE: f64 = 100.0;
const LENGTH: f64 = 1.0;
/// Closing speed, m/s: a strain of 1/4000, so that no particle leaves its cell.
const SPEED: f64 = 0.05;
/// Linear coefficient of bulk viscosity.
const VISCOSITY: f64 = 0.03;

/// A strip two cells high between planes of symmetry.
fn strip<M: Composition<f64, 2>>(method: M, h: f64, asked: Asked) -> Result<(Run<M>, Lattice<2>), CaseError> {
    let lattice = Lattice::new([0.0; 2], h)?;
    let best = (Detection::Distance, Law::Coulomb);
    let contact = asked.touch(0.0, Gradients::default(), best, [WAVE, h])?;
    let mut mpm = Mpm::with_contact(method, BlockGrid::new(lattice), contact);
    mpm.bound(Boundary::Symmetry { axis: 1, at: 0.0, side: Side::Above })?;
    mpm.bound(Boundary::Symmetry { axis: 1, at: 2.0 * h, side: Side::Below })?;
    Ok((mpm, lattice))
}

fn piece(lattice: &Lattice<2>, from: f64, to: f64) -> Result<Seeds<2>, CaseError> {
    let shape = Cuboid::new([from, 0.0], [to, 2.0 * lattice.spacing()])?;
    Ok(fill(&shape, lattice, 2, &Filling::new())?)
}

/// Equal bars, bars of different impedance, bars of different length.
pub fn impact(cells: u32, asked: Asked, folder: &Path) -> Result<Outcome, CaseError> {
    let (mut checks, mut totals, mut curves) = (Vec::new(), Totals::default(), Vec::new());
    for (name, ratio, second) in
        [("equal bars", 1.0, 1.0), ("second twice as heavy", 2.0, 1.0), ("second twice as long", 1.0, 2.0)]
    {
        let h = LENGTH / f64::from(cells);
        // FLIP takes the strain from velocities that were mapped to particles and back, and fronts come half a cell late for
        // every cell that they are wide; FMPM undoes the smoothing.
        let method = Method::new(Linear, Fmpm::<4>, Usf, PlaneStrain);
        let (mut mpm, lattice) = strip(method, h, asked)?;
        let young = DENSITY * WAVE * WAVE;
        let law = |m: f64| rubber(m * DENSITY, m * young, 0.0, VISCOSITY);
        mpm.add("first", law(1.0)?, &piece(&lattice, -LENGTH, 0.0)?, |_| [SPEED, 0.0])?;
        mpm.add("second", law(ratio)?, &piece(&lattice, 0.0, second * LENGTH)?, |_| [0.0; 2])?;
        let impedance = [DENSITY * WAVE, ratio * DENSITY * WAVE];
        let joint = SPEED * impedance[0] / (impedance[0] + impedance[1]);
        let stress = -impedance[1] * joint;
        // The plateau around the joint when the waves have run 0.8 of the bar.
        let when = 0.8 * LENGTH / WAVE;
        let (mut plateau, mut last, mut rows) = ([f64::NAN; 2], 0.0, Vec::new());
        let area = 2.0 * h;
        totals = totals.plus(&run(&mut mpm, 3.5 * LENGTH / WAVE, Watch::STEPS, |now| {
            let force = now.contacts().iter().map(|p| p.force[0]).sum::<f64>() / area;
            if force > 0.5 * stress.abs() {
                last = now.time();
            }
            if now.time() <= when {
                let near = [-0.4 * LENGTH, 0.4 * LENGTH];
                plateau = [mean(now, near, |p| p.velocity[0]), mean(now, near, |p| p.stress[0])];
            }
            rows.push([now.time(), velocity(now, 0)[0], velocity(now, 1)[0], force]);
        })?);
        let end = rows.last().copied().unwrap_or([f64::NAN; 4]);
        let named = |what: &str| format!("{name}: {what}");
        let exact = "exact, V8";
        checks.push(Check::gate(named("velocity of the joint"), plateau[0], "m/s", joint, 0.01, exact));
        checks.push(Check::gate(named("stress"), plateau[1], "Pa", stress, 0.03, exact));
        // The front is smeared: it is where the stress is halved.
        let duration = 2.0 * LENGTH / WAVE;
        let tolerance = 2.0 * h / WAVE / duration;
        checks.push(Check::gate(named("duration"), 1e3 * last, "ms", 1e3 * duration, tolerance, exact));
        let restitution = (end[2] - end[1]) / SPEED;
        if ratio == 1.0 && second == 1.0 {
            checks.push(Check::at_least(named("restitution"), restitution, "-", 0.97, "T7; exact 1"));
        } else if second > 1.0 {
            let source = "L1/L2, from memory [M]";
            checks.push(Check::shown(named("restitution"), restitution, "-", 1.0 / second, source));
        }
        curves.push((name.to_string(), rows));
    }
    figures::impact(&curves, folder)?;
    checks.push(Check::gate("bars: momentum", totals.momentum_error, "-", 0.0, 1e-12, "V8"));
    Ok(Outcome { checks, totals })
}

/// Pressure that holds the joint together, Pa, and how long it takes to apply, s.
const PRELOAD: f64 = 4.0e3;
const RAMP: f64 = 20.0 * 2.0 * LENGTH / WAVE;
/// Length of the pulse, s.
const PULSE: f64 = 0.4 * LENGTH / WAVE;

/// A bar of one or two pieces, pressed and then hit (or pulled) at its left end with `pulse` Pa. Returns time after
/// the pulse began and velocity and stress at a quarter and three quarters.
fn pressed(cells: u32, joined: bool, pulse: f64, asked: Asked) -> Result<(Vec<[f64; 5]>, Totals), CaseError> {
    let h = 0.5 * LENGTH / f64::from(cells / 2);
    let (mut mpm, lattice) = strip(Method::new(Linear, Flip, Musl, PlaneStrain), h, asked)?;
    mpm.bound(Boundary::Fixed { axis: 0, at: LENGTH, side: Side::Below })?;
    let law = || rubber(DENSITY, DENSITY * WAVE * WAVE, 0.0, 0.0);
    let load = Traction {
        region: Arc::new(Cuboid::new([-1.0, -1.0], [0.5 * h, 1.0])?),
        axis: 0,
        history: Arc::new(move |t: f64| {
            let ramp = (t / RAMP).min(1.0);
            let smooth = ramp * ramp * (3.0 - 2.0 * ramp);
            let part = (t - RAMP) / PULSE;
            let hit =
                if (0.0..1.0).contains(&part) { (std::f64::consts::PI * part).sin().powi(2) } else { 0.0 };
            [PRELOAD * smooth + pulse * hit, 0.0]
        }),
        revolved: false,
    };
    let middle = 0.5 * LENGTH;
    if joined {
        mpm.add_loaded("bar", law()?, &piece(&lattice, 0.0, LENGTH)?, |_| [0.0; 2], load)?;
    } else {
        mpm.add_loaded("left", law()?, &piece(&lattice, 0.0, middle)?, |_| [0.0; 2], load)?;
        mpm.add("right", law()?, &piece(&lattice, middle, LENGTH)?, |_| [0.0; 2])?;
    }
    let mut rows = Vec::new();
    let end = RAMP + 1.15 * LENGTH / WAVE;
    let totals = run(&mut mpm, end, Watch::STEPS, |now| {
        if now.time() >= RAMP {
            let at = |x: f64| [x - 2.0 * h, x + 2.0 * h];
            let of = |x: f64| [mean(now, at(x), |p| p.velocity[0]), mean(now, at(x), |p| p.stress[0])];
            let (a, b) = (of(0.25 * LENGTH), of(0.75 * LENGTH));
            rows.push([now.time() - RAMP, a[0], b[0], a[1], b[1]]);
        }
    })?;
    Ok((rows, totals))
}

/// The same pulse through one piece and two.
pub fn wave(cells: u32, asked: Asked, folder: &Path) -> Result<Outcome, CaseError> {
    let push = 0.5 * PRELOAD;
    let (bonded, a) = pressed(cells, true, push, asked)?;
    let (split, b) = pressed(cells, false, push, asked)?;
    let pull = -2.0 * PRELOAD;
    let (whole, c) = pressed(cells, true, pull, asked)?;
    let (open, d) = pressed(cells, false, pull, asked)?;
    let totals = [b, c, d].iter().fold(a, |sum, t| sum.plus(t));
    let most = |rows: &[[f64; 5]], column: usize, sign: f64| {
        let start = rows.first().map_or(f64::NAN, |r| r[column]);
        rows.iter().map(|r| sign * (r[column] - start)).fold(f64::NEG_INFINITY, f64::max)
    };
    let incident = push / (DENSITY * WAVE);
    let back = |r: &[f64; 5]| {
        // The steps of both runs differ a little: look at the same time.
        let other = bonded.iter().min_by(|a, b| (a[0] - r[0]).abs().total_cmp(&(b[0] - r[0]).abs()));
        other.map_or(f64::NAN, |o| (r[1] - o[1]).abs())
    };
    let reflected = split.iter().map(back).fold(0.0, f64::max) / incident;
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
    checks.push(Check::shown(what, transmitted, "-", 0.5, "the pull beyond the pressure is cut [C]"));
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
