//! Two equal balls or cylinders run into each other slowly: area, force and approach of Hertz (V11).

use std::f64::consts::PI;

use mpm_core::geometry::Lattice;
use mpm_core::observe::RunView;
use mpm_core::{Archive, BlockGrid, Boundary, CheckpointError, IntoKernels, Mpm, Side};

use crate::blocks::circles::{Part, disc};
use crate::blocks::scene::{Seen, Task, Watch, rubber, run, wave};
use crate::{CaseError, Detection, Law, Totals};

/// Radius, m.
pub const RADIUS: f64 = 1.0;
/// Density, kg/m^3.
pub const DENSITY: f64 = 1000.0;
/// Young's modulus, Pa.
pub const YOUNG: f64 = 1.0e6;
/// Poisson's ratio.
pub const POISSON: f64 = 0.3;
/// Of two equal bodies: 1/E* = 2 (1 - nu^2) / E, Pa.
pub const STIFFNESS: f64 = 0.5 * YOUNG / (1.0 - POISSON * POISSON);
/// Of two equal bodies: 1/R* = 2 / R, m.
pub const CURVATURE: f64 = 0.5 * RADIUS;
/// Force, area and approach are compared while the approach is at least this part of the largest.
const NEAR_THE_TOP: f64 = 0.95;

/// A moment of an impact.
#[derive(Clone, Copy, Debug, Default)]
pub struct Row {
    /// s.
    pub time: f64,
    /// By how much the centres of mass are closer than at the first touch, m.
    pub approach: f64,
    /// N, or N/m for cylinders.
    pub force: f64,
    /// Radius or half width of the contact from the second moment of its pressure, m.
    pub width: f64,
    /// Momentum along the axis over the sum of m |v|; across it hoop stress and the plane of symmetry act.
    pub momentum: f64,
}

impl Row {
    /// Hertz's force of balls for this approach of their centres of mass, N.
    pub fn hertz_force(&self, part: f64) -> f64 {
        let approach = (self.approach / part).max(0.0);
        4.0 / 3.0 * STIFFNESS * CURVATURE.sqrt() * approach.powf(1.5)
    }
    /// Hertz's radius for this force, m.
    pub fn ball_radius(&self) -> f64 {
        (0.75 * self.force * CURVATURE / STIFFNESS).cbrt()
    }
    /// Hertz's half width for this force, m.
    pub fn cylinder_width(&self) -> f64 {
        (4.0 * self.force * CURVATURE / (PI * STIFFNESS)).sqrt()
    }
}

/// The part of a history where the approach is near its largest.
pub fn top(rows: &[Row]) -> &[Row] {
    let most = rows.iter().map(|r| r.approach).fold(0.0, f64::max);
    let is = |r: &Row| r.approach > NEAR_THE_TOP * most;
    let first = rows.iter().position(is).unwrap_or(0);
    let last = rows.iter().rposition(is).unwrap_or(0);
    &rows[first..=last.max(first)]
}

/// The mean over a history.
pub fn mean(rows: &[Row], of: impl Fn(&Row) -> f64) -> f64 {
    rows.iter().map(of).sum::<f64>() / rows.len() as f64
}

/// From the first to the last moment with contact, s.
pub fn lasts(rows: &[Row]) -> f64 {
    let mut pressed = rows.iter().filter(|r| r.force > 0.0);
    let first = pressed.next().map_or(f64::NAN, |r| r.time);
    pressed.next_back().map_or(f64::NAN, |r| r.time - first)
}

/// One impact of two bodies that just touch, at `speed` over sqrt(E / rho); half a plane, or a radian of the whole, is
/// computed, in cells of `h` metres.
///
/// # Errors
/// What a scene refuses, and a step that breaks.
pub fn collide<M: IntoKernels<f64, 2>>(
    method: M,
    part: Part,
    h: f64,
    speed: f64,
    task: impl Into<Task>,
    threads: usize,
) -> Result<(Vec<Row>, Totals), CaseError> {
    let Task { asked, simulation } = task.into();
    let lattice = Lattice::new([0.0; 2], h)?;
    // Balls curve away from the nodes beside the contact: only what is on a node's own line counts.
    let best = (Detection::Plane, Law::Coulomb);
    let contact = asked.touch(0.0, best, [wave(DENSITY, YOUNG, POISSON), h])?;
    let mut mpm = Mpm::with_contact(method, BlockGrid::new(lattice), contact);
    mpm.bound(Boundary::Symmetry { axis: 0, at: 0.0, side: Side::Above })?;
    let slow = (YOUNG / DENSITY).sqrt();
    for (name, side) in [("low", -1.0), ("high", 1.0)] {
        let seeds = disc([0.0, side * RADIUS], RADIUS, 0.5 * h, part);
        let law = rubber(DENSITY, YOUNG, POISSON, 0.0)?;
        mpm.add(name, law, &seeds, |_| [0.0, -0.5 * side * speed * slow])?;
    }
    // Half a plane, or a radian of the whole; the square of the width over the second moment of Hertz's pressure.
    let (whole, square) = if part == Part::Ball { (2.0 * PI, 2.5) } else { (2.0, 4.0) };
    let end = 1.1 * duration(part, speed);
    let mut history = History { start: f64::NAN, rows: Vec::new() };
    let watch = Watch { every: end / 400.0, threads, series: None };
    let totals = run(&mut mpm, end, watch, simulation, &mut history, |seen, now| {
        let apart = centre(now, 1) - centre(now, 0);
        if seen.start.is_nan() {
            seen.start = apart;
        }
        let (mut sum, mut second) = (0.0, 0.0);
        for node in now.contact_points() {
            let (x, impulse) = (node.position[0], node.impulse[1]);
            sum += impulse;
            second += impulse * x * x;
        }
        // Quadratic splines add a quarter of a cell squared to the second moment of what they spread.
        let spread = (second / sum - 0.25 * h * h).max(0.0);
        seen.rows.push(Row {
            time: now.time(),
            approach: seen.start - apart,
            force: whole * now.contacts().iter().map(|p| p.force[1]).sum::<f64>(),
            width: (square * spread).sqrt(),
            momentum: (now.totals().momentum[1] / now.totals().momentum_scale).abs(),
        });
    })?;
    Ok((history.rows, totals))
}

/// Distance of the centres of mass at the start, m, and what came after.
struct History {
    start: f64,
    rows: Vec<Row>,
}

impl Seen for History {
    fn archive(&mut self, file: &mut Archive) -> Result<(), CheckpointError> {
        file.real(&mut self.start)?;
        file.list(&mut self.rows, &Row::default(), |file, row| {
            let Row { time, approach, force, width, momentum } = row;
            file.reals([time, approach, force, width, momentum])
        })
    }
}

/// How long bodies stay in contact, s: balls after Hertz, cylinders by a bound found in runs.
fn duration(part: Part, speed: f64) -> f64 {
    let wave = (YOUNG / DENSITY).sqrt();
    match part {
        Part::Ball => {
            let mass = 0.5 * DENSITY * 4.0 / 3.0 * PI * RADIUS.powi(3);
            2.868 * (mass * mass / (CURVATURE * STIFFNESS * STIFFNESS * speed * wave)).powf(0.2)
        }
        Part::Whole | Part::Half => 8.0 * RADIUS / wave,
    }
}

/// Height of a body's centre of mass, m.
fn centre(now: &RunView<'_>, body: usize) -> f64 {
    let (mut sum, mut mass) = (0.0, 0.0);
    if let Some(body) = now.bodies().get(body) {
        body.for_each(&mut |p| {
            sum += p.mass * p.position[1];
            mass += p.mass;
        });
    }
    sum / mass
}
