//! Two elastic discs (Sulsky, Chen, Schreyer 1994).

use std::path::Path;

use examples::{CaseError, Check, Detection, Law, Totals};
use mpm_contact::Gradients;
use mpm_core::geometry::Lattice;
use mpm_core::output::Snapshot;
use mpm_core::{BlockGrid, Flip, Method, Mpm, Musl, PlaneStrain, QuadraticBSpline};

use crate::circles::{Part, disc};
use crate::scene::{Asked, Watch, rubber, run, velocity, wave};
use crate::{Outcome, figures};

/// Radius, m; speed along each axis, m/s; end, s; cell of Sulsky, m.
const RADIUS: f64 = 0.2;
const SPEED: f64 = 0.1;
const END: f64 = 3.0;
const CELL: f64 = 0.05;

/// A collision.
pub struct Collision {
    /// Cells are those of Sulsky over this.
    pub finer: u32,
    /// Time, s, kinetic and internal energy, J, velocity of the first disc along x, m/s.
    pub rows: Vec<[f64; 4]>,
    /// The discs at the end.
    pub end: Snapshot,
    /// When the first step with contact began, s.
    onset: f64,
    totals: Totals,
}

/// With cells of 0.05 m over each of `finer`.
pub fn all(finer: &[u32], asked: Asked, folder: &Path) -> Result<Outcome, CaseError> {
    let collisions = finer.iter().map(|&f| collide(f, asked, folder)).collect::<Result<Vec<_>, _>>()?;
    figures::discs(&collisions, folder)?;
    let closing = 2.0 * 2.0f64.sqrt() * SPEED;
    let touch = (0.4 * 2.0f64.sqrt() - 2.0 * RADIUS) / closing;
    let mut checks = Vec::new();
    for c in &collisions {
        let h = CELL / f64::from(c.finer);
        let name = |what: &str| format!("discs, cell {h} m: {what}");
        let (first, last) = (c.rows.first().copied(), c.rows.last().copied());
        let (first, last) = (first.unwrap_or([f64::NAN; 4]), last.unwrap_or([f64::NAN; 4]));
        let (onset, tolerance) = (c.onset, 0.25 * h / closing / touch);
        let kept = (last[1] + last[2]) / first[1];
        let kept = Check::gate(name("kinetic and internal energy kept"), kept, "-", 1.0, 0.03, "V10");
        let gap = closing * (touch - onset) / h;
        let rebound = Check::shown(name("rebound over approach"), -last[3] / SPEED, "-", 0.0, "");
        checks.extend([
            Check::gate(name("kinetic energy at the start"), first[1], "J", 2.513, 1e-3, "exact [C], V10"),
            Check::gate(name("time of touch"), onset, "s", touch, tolerance, "exact [C], V10, T6"),
            Check::gate(name("gap at onset"), gap, "cells", 0.0, 0.1, "surfaces meet, T6"),
            kept,
            Check::shown(
                name("kinetic energy recovered"),
                last[1] / first[1],
                "-",
                0.9,
                "quadratic MUSL, [M]",
            ),
            Check { reference: None, ..rebound },
        ]);
    }
    let totals = collisions.iter().fold(Totals::default(), |sum, c| sum.plus(&c.totals));
    checks.push(Check::gate("discs: momentum", totals.momentum_error, "-", 0.0, 1e-12, "V8"));
    Ok(Outcome { checks, totals })
}

fn collide(finer: u32, asked: Asked, folder: &Path) -> Result<Collision, CaseError> {
    let h = CELL / f64::from(finer);
    let lattice = Lattice::new([0.0; 2], h)?;
    let method = Method::new(QuadraticBSpline, Flip, Musl, PlaneStrain);
    let contact = asked.touch(
        0.0,
        Gradients::default(),
        (Detection::Regression, Law::Penalty),
        [wave(1000.0, 1000.0, 0.3), h],
    )?;
    let mut mpm = Mpm::with_contact(method, BlockGrid::new(lattice), contact);
    for (name, at, v) in [("low", 0.3, SPEED), ("high", 0.7, -SPEED)] {
        let seeds = disc([at; 2], RADIUS, 0.5 * h, Part::Whole);
        mpm.add(name, rubber(1000.0, 1000.0, 0.3, 0.0)?, &seeds, |_| [v; 2])?;
    }
    let (mut onset, mut before, mut rows) = (f64::NAN, 0.0, Vec::new());
    let name = format!("discs_{finer}");
    let watch = Watch { series: Some((folder, &name)), ..Watch::STEPS };
    let totals = run(&mut mpm, END, watch, |now| {
        if onset.is_nan() && now.contacts().iter().any(|p| p.nodes > 0) {
            onset = before;
        }
        before = now.time();
        let t = now.totals();
        rows.push([now.time(), t.kinetic, t.internal, velocity(now, 0)[0]]);
    })?;
    Ok(Collision { finer, rows, end: mpm.snapshot()?, onset, totals })
}
