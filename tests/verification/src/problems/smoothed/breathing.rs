//! Breathing modes: steel bodies vibrate in their lowest mode.

use mpm_core::geometry::{Ball, Cuboid, Filling, Lattice, Shape, fill};
use mpm_core::{Axisymmetric, Boundary, FullSpace, Side};
use sph::Layout;

use super::{By, Setup, outcome, steel, step, text};
use crate::case::Outcome;
use crate::smoothed::March;
use crate::work::Stopwatch;

const RADIUS: f64 = 10e-3;
/// Exact frequencies, Hz.
const SPHERE: f64 = 248.88e3;
const CYLINDER: f64 = 198.13e3;
/// Number of velocity zero crossings, which span two periods.
const STOPS: usize = 5;

/// Particles of a shape in whole cells of `h` metres with no negative coordinate.
fn particles<const D: usize>(shape: &impl Shape<D>, h: f64, filling: &Filling) -> Result<Layout<D>, String> {
    let lattice = Lattice::new([0.0; D], h).map_err(text)?;
    let whole = Layout::of_seeds(&fill(shape, &lattice, 1, filling).map_err(text)?);
    let mut part = Layout { positions: vec![], volumes: vec![], spacings: vec![], surface: whole.surface };
    for (n, x) in whole.positions.iter().enumerate().filter(|(_, x)| x.iter().all(|c| *c > 0.0)) {
        part.positions.push(*x);
        part.volumes.push(whole.volumes[n]);
        part.spacings.push(whole.spacings[n]);
    }
    Ok(part)
}

/// Run a breathing mode; "frequency" is its error, "energy" the change of the energy during the measurement.
fn breathe<const D: usize>(
    mut march: March<D>,
    mode: &dyn Fn([f64; D]) -> [f64; D],
    expected: f64,
) -> Result<Outcome, String> {
    let watch = Stopwatch::start();
    let amplitude = |march: &March<D>| -> f64 {
        let part = |n: usize| {
            let p = march.body.particle(n);
            let shape = mode(p.position);
            p.mass * (0..D).map(|d| p.velocity[d] * shape[d]).sum::<f64>()
        };
        (0..march.body.len()).map(part).sum()
    };
    let start = march.body.totals().kinetic;
    let (mut before, mut stops) = (amplitude(&march), Vec::new());
    while stops.len() < STOPS {
        if march.time > 2.0 * STOPS as f64 / expected {
            return Err("it does not breathe".into());
        }
        let dt = step(&march);
        march.smoothed_step(dt, None).map_err(text)?;
        let now = amplitude(&march);
        if now * before < 0.0 {
            // Time of the zero crossing: leapfrog velocities are at mid-step.
            stops.push(march.time - 0.5 * dt - dt * now / (now - before));
        }
        before = now;
    }
    let after = march.body.totals();
    let frequency = 0.5 * (STOPS as f64 - 1.0) / (stops[STOPS - 1] - stops[0]);
    Ok(outcome(&march, &watch)
        .with("frequency", frequency / expected - 1.0)
        .with("energy", (after.kinetic + after.internal) / start - 1.0))
}

/// Lowest mode of a sphere: u = sin(kr)/r^2 - k cos(kr)/r with kR = 2.6702, m/s.
fn of_sphere<const D: usize>(x: [f64; D]) -> [f64; D] {
    let k = 2.6702 / RADIUS;
    let r = x.iter().map(|c| c * c).sum::<f64>().sqrt();
    let u = ((k * r).sin() / (r * r) - k * (k * r).cos() / r) / (k * k * k);
    x.map(|c| c * u / r * 1e3)
}

fn above<const D: usize>(axis: usize) -> Boundary<D> {
    Boundary::Symmetry { axis, at: 0.0, side: Side::Above }
}

/// Run half a sphere, axisymmetric.
pub fn sphere(by: By, cells: usize) -> Result<Outcome, String> {
    let ball = Ball::<2>::new([0.0; 2], RADIUS).map_err(text)?;
    let layout = particles(&ball, RADIUS / cells as f64, &Filling::new().axisymmetric())?;
    let setup = Setup { layout: &layout, velocity: &of_sphere, boundaries: vec![above(1)] };
    breathe(setup.body(by, Axisymmetric, steel()?)?, &of_sphere, SPHERE)
}

/// Run an eighth of a sphere in three dimensions.
pub fn eighth(by: By, cells: usize) -> Result<Outcome, String> {
    let ball = Ball::<3>::new([0.0; 3], RADIUS).map_err(text)?;
    let layout = particles(&ball, RADIUS / cells as f64, &Filling::new())?;
    let setup = Setup { layout: &layout, velocity: &of_sphere, boundaries: (0..3).map(above).collect() };
    breathe(setup.body(by, FullSpace, steel()?)?, &of_sphere, SPHERE)
}

/// Bessel function J1 by its series.
fn bessel(x: f64) -> f64 {
    let (mut term, mut sum) = (0.5 * x, 0.0);
    for n in 1..30 {
        sum += term;
        term *= -0.25 * x * x / f64::from(n * (n + 1));
    }
    sum
}

/// Run a slice of a long cylinder.
pub fn cylinder(by: By, cells: usize) -> Result<Outcome, String> {
    let h = RADIUS / cells as f64;
    let slice = Cuboid::new([0.0; 2], [RADIUS, 4.0 * h]).map_err(text)?;
    let layout = particles(&slice, h, &Filling::new().axisymmetric())?;
    let boundaries = vec![above(1), Boundary::Symmetry { axis: 1, at: 4.0 * h, side: Side::Below }];
    let mode = |[r, _]: [f64; 2]| [bessel(2.1257 * r / RADIUS), 0.0];
    let setup = Setup { layout: &layout, velocity: &mode, boundaries };
    breathe(setup.body(by, Axisymmetric, steel()?)?, &mode, CYLINDER)
}
