//! Null-space noise: particle velocities invisible to the grid.

use nalgebra::{DMatrix, DVector};
use verification::problems::box_of_planes;
use verification::{Kernel, Scheme};

use super::limits::weight;
use crate::stage::{
    ApicUsl, Cubic, FlipMusl, FlipUsl, Fmpm4Usl, Linear, Quadratic, Random, bar, energy, particles,
    row_of_cells, solver, steps, text, ul,
};
use crate::verdict::{Limit, Measured, Scene, Size};

/// Random velocities of points at `x` with zero nodal momentum: their projection on the weights is removed.
fn unseen(kernel: Kernel, x: &[f64]) -> Result<Vec<f64>, String> {
    let nodes = x.iter().fold(0.0f64, |a, &b| a.max(b)).ceil() as usize + 5;
    let n = DMatrix::from_fn(nodes, x.len(), |i, p| weight(kernel, x[p] - (i as f64 - 2.0), 0.25).0);
    let mut random = Random::new(11);
    let noise = DVector::from_fn(x.len(), |_, _| random.number());
    let momentum = &n * &noise;
    let solved = (&n * n.transpose()).svd(true, true).solve(&momentum, 1e-12)?;
    let left = &noise - n.transpose() * solved;
    Ok(left.iter().copied().collect())
}

/// Measure the noise energy after `count` steps over the initial one.
fn noise_left(scheme: Scheme, drift: f64, count: u64) -> Result<Measured, String> {
    let seeds = row_of_cells(20, 3, 0.05)?;
    let mut x: Vec<f64> = seeds.positions.iter().map(|x| x[0]).collect();
    x.sort_by(f64::total_cmp);
    x.dedup();
    let noise = unseen(scheme.kernel, &x)?;
    let velocity = |at: f64| drift + 1e-4 * x.iter().position(|&x| x == at).map_or(f64::NAN, |k| noise[k]);
    let mut mpm = bar(scheme, 0.3, &seeds, &velocity)?;
    let start = energy(&mpm.totals());
    let (mut sum, mut counted) = (0.0, 0.0);
    let stop = steps(&mut mpm, count, |now, step| {
        // Mean of the last tenth, independent of the phase of an oscillation.
        if step > count - count / 10 {
            sum += energy(&now.totals());
            counted += 1.0;
        }
    });
    Ok(Measured::new(sum / counted / start, count).stopped(stop))
}

fn trial(scheme: Scheme, drift: f64) -> impl Fn(Size) -> Result<Measured, String> {
    move |size| noise_left(scheme, drift, if size == Size::Fast { 2_000 } else { 10_000 })
}

/// T9: remaining null-space noise.
pub fn null_space() -> Scene {
    Scene {
        id: "T9",
        name: "ringing: noise that stays",
        fails: "A bar drifts at 0.1 c; its particles also have random velocities that sum to no momentum at any node. The grid does not see \
                them, FLIP does not touch them. What filters, forgets them.",
        metric: "energy about the centre of mass after the run over that of the noise",
        limit: Limit::AtMost(1e-3),
        rows: Vec::new(),
    }
    .fails("linear FLIP-MUSL", "list T9", trial(ul(Linear, FlipMusl), 0.1))
    .fails("quadratic FLIP-MUSL", "list T9", trial(ul(Quadratic, FlipMusl), 0.1))
    .fails("quadratic FLIP-USL", "list T9", trial(ul(Quadratic, FlipUsl), 0.1))
    .holds("quadratic APIC", "list T9", trial(ul(Quadratic, ApicUsl), 0.1))
    .holds("cubic APIC", "list T9", trial(ul(Cubic, ApicUsl), 0.1))
    .holds("quadratic FMPM(4)", "list T9", trial(ul(Quadratic, Fmpm4Usl), 0.1))
    .holds("cubic FMPM(4)", "list T9", trial(ul(Cubic, Fmpm4Usl), 0.1))
}

const HEATS: &str = "numerical heating: as particles drift over nodes the grid begins to see the noise, and feeds it: linear 3e7 and quadratic 3e3 times \
     after 1e4 steps; none at rest, none of the cubic spline, none with USL";

/// T9: growing null-space noise.
pub fn growth() -> Scene {
    Scene {
        id: "T9g",
        name: "ringing: noise that grows",
        fails: "The same. FLIP may keep the noise, but must not feed it.",
        metric: "energy about the centre of mass after the run over that of the noise",
        limit: Limit::AtMost(1.01),
        rows: Vec::new(),
    }
    .holds("linear FLIP-USL", "list T9", trial(ul(Linear, FlipUsl), 0.1))
    .holds("linear FLIP-MUSL", "list T9", trial(ul(Linear, FlipMusl), 0.1))
    .but(|row| row.noted(HEATS))
    .holds("quadratic FLIP-MUSL", "list T9", trial(ul(Quadratic, FlipMusl), 0.1))
    .but(|row| row.noted(HEATS))
    .holds("quadratic FLIP-USL", "list T9", trial(ul(Quadratic, FlipUsl), 0.1))
    .holds("cubic FLIP-MUSL", "list T9", trial(ul(Cubic, FlipMusl), 0.1))
    .holds("quadratic FLIP-MUSL, at rest", "list T9", trial(ul(Quadratic, FlipMusl), 0.0))
}

/// Measure the remaining fraction of a checkerboard velocity after the first period of the square.
fn checkerboard(scheme: Scheme, per_axis: usize) -> Result<Measured, String> {
    let side = 8;
    let lattice = crate::stage::cells()?;
    let seeds = verification::scene::block(&lattice, [0; 2], [side; 2], per_axis);
    let sign = |x: [f64; 2]| if (x[0].floor() + x[1].floor()) as i64 % 2 == 0 { 1.0 } else { -1.0 };
    let dt = 0.3;
    let mut mpm = solver(scheme, dt)?;
    crate::stage::bound(&mut mpm, box_of_planes(0..2, 0.0, side as f64))?;
    let rubber = verification::problems::rubber(1.0, 1.0, 0.3)?;
    mpm.add("block", rubber, &seeds, |x| [1e-4 * sign(x), 0.0]).map_err(text)?;
    let count = (2.0 * side as f64 / dt).round() as u64;
    let stop = steps(&mut mpm, count, |_, _| {});
    let (mut left, mut all) = (0.0, 0.0);
    for p in particles(&mpm) {
        let start = seeds.positions[p.number];
        left += p.velocity[0] * sign(start);
        all += 1e-4;
    }
    Ok(Measured::new((left / all).powi(2), count).stopped(stop))
}

/// T10: hourglass modes.
pub fn hourglass() -> Scene {
    fn trial(scheme: Scheme, per_axis: usize) -> impl Fn(Size) -> Result<Measured, String> {
        move |_| checkerboard(scheme, per_axis)
    }
    Scene {
        id: "T10",
        name: "hourglass",
        fails: "Square cells of rubber kicked left and right by turns like a checkerboard. One particle in the middle of a cell of hats sees \
                neither strain nor force from it: the zigzag stays for ever.",
        metric: "kinetic energy of the checkerboard over that of the kick, after a period of the square",
        limit: Limit::AtMost(0.01),
        rows: Vec::new(),
    }
    .fails("linear FLIP-MUSL, 1", "list T10", trial(ul(Linear, FlipMusl), 1))
    .fails("quadratic FLIP-MUSL, 1", "the same null space [I]", trial(ul(Quadratic, FlipMusl), 1))
    .holds("quadratic APIC, 1", "list T9", trial(ul(Quadratic, ApicUsl), 1))
    .holds("quadratic APIC, 2", "list T10", trial(ul(Quadratic, ApicUsl), 2))
    .holds("linear FMPM(4), 2", "list T10", trial(ul(Linear, Fmpm4Usl), 2))
    .holds("quadratic FMPM(4), 2", "list T10", trial(ul(Quadratic, Fmpm4Usl), 2))
}
