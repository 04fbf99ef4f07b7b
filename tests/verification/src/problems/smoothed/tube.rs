//! Lame's tube: radii a and b, inner pressure p, plane strain.
//!
//! s_tt = p a^2 / (b^2 - a^2) (1 + b^2 / r^2), u(a) = p a (1 + nu) / E ((1 - 2 nu) a^2 + b^2) / (b^2 - a^2): for steel with radii 10 and 20
//! mm under 100 MPa, 166.67 MPa and 9.533 um. Here p is a thousandth of that, so that strains are small.

use std::f64::consts::FRAC_PI_2;
use std::fmt::Debug;

use mpm_core::geometry::{Cuboid, Filling, Lattice};
use mpm_core::{Axisymmetric, Boundary, Embedding, PlaneStrain, Side};
use sph::Layout;

use super::{By, DENSITY, Setup, outcome, steel, step, text};
use crate::case::Outcome;
use crate::smoothed::March;
use crate::work::Stopwatch;

const BORE: f64 = 10e-3;
const OUTER: f64 = 20e-3;
const PRESSURE: f64 = 100e3;
const YOUNG: f64 = 200e9;
const POISSON: f64 = 0.3;

/// Exact hoop stress, Pa.
fn hoop(r: f64) -> f64 {
    PRESSURE * BORE * BORE / (OUTER * OUTER - BORE * BORE) * (1.0 + (OUTER / r).powi(2))
}

/// Exact displacement of the bore, m.
fn opening() -> f64 {
    let (a, b) = (BORE * BORE, OUTER * OUTER);
    PRESSURE * BORE * (1.0 + POISSON) / YOUNG * ((1.0 - 2.0 * POISSON) * a + b) / (b - a)
}

/// Approximate angular frequency of the slowest mode (breathing), rad/s.
fn slowest() -> f64 {
    (YOUNG / DENSITY).sqrt() / (0.5 * (BORE + OUTER))
}

/// Radius at a position, m.
type Radius = fn([f64; 2]) -> f64;

/// Pressure forces at the bore, N by number: those that balance a uniform pressure within the body and at its bore. That state is one of
/// equal strains `along` both axes, or in axisymmetry along the radius. The forces are distributed over the rows within kernel range, like
/// the forces of stresses at a surface; concentrated on the outermost row, they would cause a layer with a radial stress error of 40 % of
/// the pressure at any resolution.
fn load<E: Embedding<2> + Debug>(
    by: By,
    space: E,
    (layout, boundaries): (&Layout<2>, &[Boundary<2>]),
    (radius, along): (Radius, [f64; 2]),
) -> Result<Vec<[f64; 2]>, String> {
    let squeeze = |x: [f64; 2]| [0, 1].map(|d| -100.0 * along[d] * x[d]);
    let setup = Setup { layout, velocity: &squeeze, boundaries: boundaries.to_vec() };
    let mut march = setup.body(by, space, steel()?)?;
    let dt = 0.1 * step(&march);
    march.smoothed_step(dt, None).map_err(text)?;
    let points = march.body.points();
    let stress = points.iter().map(|p| p.stress[0]).sum::<f64>() / points.len() as f64;
    let accelerations = march.accelerations(dt).map_err(text)?;
    let force = |(n, a): (usize, &[f64; 2])| {
        let bore = radius(layout.positions[n]) < 0.5 * (BORE + OUTER);
        let scale = if bore { points[n].mass * PRESSURE / stress } else { 0.0 };
        a.map(|a| scale * a)
    };
    Ok(accelerations.iter().enumerate().map(force).collect())
}

/// Apply the load `force` (N by number) with critical damping of the slowest mode until oscillations have decayed to e^-25. `radius` is
/// that of a position, `hoop_of` the hoop stress of a stress there.
///
/// "bore" is the error of the displacement of the bore, "hoop" that of the mean hoop stress there, "profile" the root mean square error of
/// the hoop stress in the whole wall, over its largest value.
fn rest(
    mut march: March<2>,
    layout: &Layout<2>,
    force: &[[f64; 2]],
    radius: fn([f64; 2]) -> f64,
    hoop_of: fn([f64; 2], &[f64; 6]) -> f64,
) -> Result<Outcome, String> {
    let watch = Stopwatch::start();
    let damping = 2.0 * slowest();
    let masses: Vec<f64> = (0..march.body.len()).map(|n| march.body.particle(n).mass).collect();
    let mut slowing = vec![[0.0; 2]; layout.len()];
    while march.time < 25.0 / slowest() {
        for (n, slow) in slowing.iter_mut().enumerate() {
            *slow = march.body.particle(n).velocity.map(|v| -damping * v);
        }
        let dt = step(&march);
        let act = |n: usize| [0, 1].map(|d| force[n][d] / masses[n] + slowing[n][d]);
        march.smoothed_step(dt, Some(&act)).map_err(text)?;
    }
    let (mut at_bore, mut opened, mut squares, mut volume) = ((0.0, 0.0), 0.0, 0.0, 0.0);
    march.body.for_each(&mut |p| {
        let x = layout.positions[p.number];
        let (r, stress) = (radius(x), hoop_of(x, &p.stress));
        if r < BORE * (1.0 + 1e-9) {
            opened += radius([p.position[0], p.position[1]]) - r;
            at_bore = (at_bore.0 + stress, at_bore.1 + 1.0);
        }
        squares += p.volume * (stress - hoop(r)).powi(2);
        volume += p.volume;
    });
    let (stress, count) = at_bore;
    Ok(outcome(&march, &watch)
        .with("bore", opened / count / opening() - 1.0)
        .with("hoop", stress / count / hoop(BORE) - 1.0)
        .with("profile", (squares / volume).sqrt() / hoop(BORE)))
}

/// Run an axisymmetric slice with rows on both faces.
pub fn around_the_axis(by: By, cells: usize) -> Result<Outcome, String> {
    let h = (OUTER - BORE) / cells as f64;
    let wall = Cuboid::new([BORE, 0.0], [OUTER, 4.0 * h]).map_err(text)?;
    let lattice = Lattice::new([BORE, 0.0], h).map_err(text)?;
    let filling = Filling::new().axisymmetric();
    let layout = Layout::on_faces(&wall, &lattice, [true, false], &filling).map_err(text)?;
    let boundaries = vec![
        Boundary::Symmetry { axis: 1, at: 0.0, side: Side::Above },
        Boundary::Symmetry { axis: 1, at: 4.0 * h, side: Side::Below },
    ];
    let force = load(by, Axisymmetric, (&layout, &boundaries), (|x| x[0], [1.0, 0.0]))?;
    let march =
        Setup { layout: &layout, velocity: &|_| [0.0; 2], boundaries }.body(by, Axisymmetric, steel()?)?;
    rest(march, &layout, &force, |x| x[0], |_, stress| stress[2])
}

/// Run a quarter in the plane: rings of particles about one spacing apart, the first and the last on the faces and half as thick. Particles
/// of a ring are equidistant, the outermost half that distance from the symmetry planes.
pub fn in_the_plane(by: By, cells: usize) -> Result<Outcome, String> {
    let h = (OUTER - BORE) / cells as f64;
    let mut layout = Layout { positions: vec![], volumes: vec![], spacings: vec![], surface: 0.0 };
    for ring in 0..=cells {
        let r = BORE + ring as f64 * h;
        let (low, high) = ((r - 0.5 * h).max(BORE), (r + 0.5 * h).min(OUTER));
        let count = (FRAC_PI_2 * r / h).round();
        let angle = FRAC_PI_2 / count;
        for n in 0..count as usize {
            let (sin, cos) = ((n as f64 + 0.5) * angle).sin_cos();
            layout.positions.push([r * cos, r * sin]);
            layout.volumes.push(0.5 * angle * (high * high - low * low));
            layout.spacings.push((h * angle * r).sqrt());
        }
    }
    let plane = |axis| Boundary::Symmetry { axis, at: 0.0, side: Side::Above };
    let boundaries = vec![plane(0), plane(1)];
    let force = load(by, PlaneStrain, (&layout, &boundaries), (|[x, y]| x.hypot(y), [1.0; 2]))?;
    let march =
        Setup { layout: &layout, velocity: &|_| [0.0; 2], boundaries }.body(by, PlaneStrain, steel()?)?;
    let around = |[x, y]: [f64; 2], stress: &[f64; 6]| {
        let r = x.hypot(y);
        let (cos, sin) = (x / r, y / r);
        stress[0] * sin * sin + stress[1] * cos * cos - 2.0 * stress[5] * sin * cos
    };
    rest(march, &layout, &force, |[x, y]| x.hypot(y), around)
}
