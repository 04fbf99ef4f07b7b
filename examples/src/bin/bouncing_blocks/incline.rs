//! Block on an incline of 30 degrees, in the frame of the incline.

use std::path::Path;

use examples::{CaseError, Check, Detection, Law, Restart, Totals};
use mpm_core::geometry::{Cuboid, Filling, Lattice, fill};
use mpm_core::{
    Archive, Blend, BlockGrid, Boundary, CheckpointError, Linear, Method, Mpm, Musl, PlaneStrain, Side,
};

use crate::{Outcome, figures};
use examples::blocks::scene::{Asked, Seen, Watch, rubber, run, wave};

/// Gravity, m/s^2.
const GRAVITY: f64 = 10.0;
/// Density, kg/m^3, and Young's modulus, Pa, of block and floor.
const DENSITY: f64 = 1000.0;
const YOUNG: f64 = 1.0e7;
/// Decay time of particle noise, in h / sqrt(E / rho). The noise shakes a sticking block off its place: with FLIP alone by
/// 2.1 cells in ten thousand steps, with 100 by 1.8, with 10 by 0.05, with 3 by 2e-4.
const DAMPING: f64 = 3.0;
/// Ramp time of gravity, s, so that the block does not bounce.
const RAMP: f64 = 0.2;
/// End times, s: sliding, sticking.
const SLIDE: f64 = 1.5;
const STICK: f64 = 5.0;

/// History row: time, s, distance, m, gap, m.
pub type Row = [f64; 3];

/// Run the sliding and the sticking block.
pub fn all(finer: u32, asked: Asked, folder: &Path, restart: &Restart) -> Result<Outcome, CaseError> {
    let h = 0.1 / f64::from(finer);
    let (sin, cos) = (std::f64::consts::PI / 6.0).sin_cos();
    let friction = [0.3, 0.7];
    let (slid, a) = one(h, friction[0], SLIDE, asked, restart)?;
    let (stuck, b) = one(h, friction[1], STICK, asked, restart)?;
    let rest = SLIDE - RAMP;
    let exact =
        GRAVITY * (sin - friction[0] * cos) * (0.5 * rest * rest + 0.5 * RAMP * rest + RAMP * RAMP / 6.0);
    let way = |rows: &[Row]| rows.last().map_or(f64::NAN, |r| r[1]);
    let lift = |rows: &[Row]| rows.iter().map(|r| r[2]).fold(f64::NEG_INFINITY, f64::max) / h;
    // Drift after the ramp of gravity and the first shear, in ten thousand steps.
    let settled = stuck.iter().find(|r| r[0] > 1.0).map_or(f64::NAN, |r| r[1]);
    let steps = b.steps as f64 * (STICK - 1.0) / STICK;
    let drift = (way(&stuck) - settled).abs() / h * 1e4 / steps;
    let source = "exact, V12";
    let checks = vec![
        Check::gate("incline, mu 0.3: way at 1.5 s", way(&slid), "m", exact, 0.01, source),
        Check::gate("incline, mu 0.7: drift in 1e4 steps", drift, "cells", 0.0, 1e-3, source),
        Check::at_most("incline, mu 0.3: largest gap", lift(&slid), "cells", 0.1, source),
        Check::at_most("incline, mu 0.7: largest gap", lift(&stuck), "cells", 0.1, source),
    ];
    figures::incline(&slid, &stuck, exact, folder)?;
    Ok(Outcome { checks, totals: a.plus(&b) })
}

fn one(
    h: f64,
    friction: f64,
    end: f64,
    asked: Asked,
    restart: &Restart,
) -> Result<(Vec<Row>, Totals), CaseError> {
    let lattice = Lattice::new([0.0; 2], h)?;
    let damping = DAMPING * h / (YOUNG / DENSITY).sqrt();
    let method = Method::new(Linear, Blend::new(damping)?, Musl, PlaneStrain);
    let contact = asked.touch(friction, (Detection::Plane, Law::Coulomb), [wave(DENSITY, YOUNG, 0.2), h])?;
    let mut mpm = Mpm::with_contact(method, BlockGrid::new(lattice), contact);
    let law = || rubber(DENSITY, YOUNG, 0.2, 0.1);
    let floor = fill(&Cuboid::new([-0.5, -0.4], [4.5, 0.0])?, &lattice, 2, &Filling::new())?;
    let block = fill(&Cuboid::new([0.0, 0.0], [0.8, 0.4])?, &lattice, 2, &Filling::new())?;
    mpm.add("floor", law()?, &floor, |_| [0.0; 2])?;
    mpm.add("block", law()?, &block, |_| [0.0; 2])?;
    mpm.bound(Boundary::Fixed { axis: 1, at: -0.1, side: Side::Above })?;
    let (sin, cos) = (std::f64::consts::PI / 6.0).sin_cos();
    mpm.set_body_force(move |t| {
        let g = GRAVITY * (t / RAMP).min(1.0);
        [g * sin, -g * cos]
    });
    let particle = 0.5 * h;
    let mut history = History { start: f64::NAN, rows: Vec::new() };
    let watch = Watch { every: 2.0e-3, ..Watch::STEPS };
    let simulation = restart.scene(format!("incline_{friction}"))?;
    let totals = run(&mut mpm, end, watch, simulation, &mut history, |seen, now| {
        let (mut x, mut low, mut top, mut count) = (0.0, f64::INFINITY, f64::NEG_INFINITY, 0.0);
        if let [floor, block] = now.bodies()[..] {
            block.for_each(&mut |p| {
                x += p.position[0];
                count += 1.0;
                low = low.min(p.position[1]);
            });
            floor.for_each(&mut |p| top = top.max(p.position[1]));
        }
        x /= count;
        if seen.start.is_nan() {
            seen.start = x;
        }
        seen.rows.push([now.time(), x - seen.start, low - top - particle]);
    })?;
    Ok((history.rows, totals))
}

/// Initial position of the block, m, and its history.
struct History {
    start: f64,
    rows: Vec<Row>,
}

impl Seen for History {
    fn archive(&mut self, file: &mut Archive) -> Result<(), CheckpointError> {
        file.real(&mut self.start)?;
        file.list(&mut self.rows, &[0.0; 3], |file, row| file.reals(row))
    }
}
