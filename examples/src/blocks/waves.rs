//! Bars of one piece and of two, in uniaxial strain: a strip two cells high between planes of symmetry, and a wave through
//! a joint under pressure (V9).

use std::sync::Arc;

use mpm_contact::Gradients;
use mpm_core::geometry::{Cuboid, Filling, Lattice, Seeds, fill};
use mpm_core::{BlockGrid, Boundary, Composition, Mpm, Side, Traction};

use crate::blocks::scene::{Asked, Run, Watch, mean, rubber, run};
use crate::{CaseError, Detection, Totals};

/// Density, kg/m^3.
pub const DENSITY: f64 = 1000.0;
/// Wave speed, m/s.
pub const WAVE: f64 = 100.0;
/// Length of a bar, m.
pub const LENGTH: f64 = 1.0;

/// A strip two cells high between planes of symmetry, still empty, and its lattice of cells of `h` metres.
///
/// # Errors
/// What a scene refuses.
pub fn strip<M: Composition<f64, 2>>(
    method: M,
    h: f64,
    asked: Asked,
) -> Result<(Run<M>, Lattice<2>), CaseError> {
    let lattice = Lattice::new([0.0; 2], h)?;
    let contact = asked.touch(0.0, Gradients::default(), Detection::Distance)?;
    let mut mpm = Mpm::with_contact(method, BlockGrid::new(lattice), contact);
    mpm.bound(Boundary::Symmetry { axis: 1, at: 0.0, side: Side::Above })?;
    mpm.bound(Boundary::Symmetry { axis: 1, at: 2.0 * h, side: Side::Below })?;
    Ok((mpm, lattice))
}

/// Particles of a strip between two places, m; two a cell and axis.
///
/// # Errors
/// Places in the wrong order.
pub fn piece(lattice: &Lattice<2>, from: f64, to: f64) -> Result<Seeds<2>, CaseError> {
    let shape = Cuboid::new([from, 0.0], [to, 2.0 * lattice.spacing()])?;
    Ok(fill(&shape, lattice, 2, &Filling::new())?)
}

/// Pressure that holds the joint together, Pa, and how long it takes to apply, s.
pub const PRELOAD: f64 = 4.0e3;
const RAMP: f64 = 20.0 * 2.0 * LENGTH / WAVE;
/// Length of the pulse, s.
const PULSE: f64 = 0.4 * LENGTH / WAVE;

/// Time after the pulse began, s, velocity, m/s, and stress, Pa, at a quarter and three quarters of the bar.
pub type Row = [f64; 5];

/// A bar of one piece (`joined`) or two of `cells` in all, pressed and then hit (or pulled) at its left end with `pulse` Pa.
///
/// # Errors
/// What a scene refuses, and a step that breaks.
pub fn pressed<M: Composition<f64, 2>>(
    method: M,
    cells: u32,
    joined: bool,
    pulse: f64,
    asked: Asked,
) -> Result<(Vec<Row>, Totals), CaseError> {
    let h = 0.5 * LENGTH / f64::from(cells / 2);
    let (mut mpm, lattice) = strip(method, h, asked)?;
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

/// The largest change of a column from where it starts, in the direction of `sign`.
pub fn most(rows: &[Row], column: usize, sign: f64) -> f64 {
    let start = rows.first().map_or(f64::NAN, |r| r[column]);
    rows.iter().map(|r| sign * (r[column] - start)).fold(f64::NEG_INFINITY, f64::max)
}

/// The largest difference of the velocity at a quarter between a bar of two pieces and one of one, over that of a
/// pulse of `pulse` Pa: the share that the joint reflects.
pub fn reflected(bonded: &[Row], split: &[Row], pulse: f64) -> f64 {
    let incident = pulse / (DENSITY * WAVE);
    let back = |r: &Row| {
        // The steps of both runs differ a little: look at the same time.
        let other = bonded.iter().min_by(|a, b| (a[0] - r[0]).abs().total_cmp(&(b[0] - r[0]).abs()));
        other.map_or(f64::NAN, |o| (r[1] - o[1]).abs())
    };
    split.iter().map(back).fold(0.0, f64::max) / incident
}
