//! V5: expanding ring with free surfaces, manufactured.
//!
//! r = R + u(R) T(t), u = c1 R + c2 R^2 + c3 R^3 with u' = 0 at both radii, which are free of traction since nu =
//! 0; T = A sin(pi c t / 2 r_b). With l_r = 1 + u' T, l_t = 1 + u T / R and P(s) = G (s - 1/s), `b_R = u T'' -
//! (1/rho) [G u'' T (1 + 1/l_r^2) + (P(l_r) - P(l_t)) / R]`. Radii 0.4, 0.5 and 0.6 m, E 1e7 Pa, rho 1000 kg/m^3, A
//! 0.1 m. Quarter model between symmetry planes, particles on a lattice; those at the rim have their inner volume
//! fraction. The run ends at t = 2 r_b / c, half a period; errors are relative to A.

use std::f64::consts::PI;
use std::sync::Arc;

use mpm_core::geometry::{Filling, Shell, fill};
use mpm_core::{Boundary, Side};

use crate::case::{Case, Outcome};
use crate::formulation::Formulation;
use crate::problems::{lattice, rubber};
use crate::scene::{Norm, Scene, worse};

const INNER: f64 = 0.4;
const OUTER: f64 = 0.6;
const MIDDLE: f64 = 0.5;
const YOUNG: f64 = 1e7;
const DENSITY: f64 = 1000.0;
const SPEED: f64 = 100.0;
const AMPLITUDE: f64 = 0.1;

/// Radial profile and derivatives: u, u', u''.
fn profile(r: f64) -> (f64, f64, f64) {
    let per = 1.0 / (OUTER - 3.0 * INNER);
    let c1 = -6.0 * INNER / OUTER * per;
    let c2 = 3.0 * (OUTER + INNER) / (OUTER * OUTER) * per;
    let c3 = -2.0 / (OUTER * OUTER) * per;
    (((c3 * r + c2) * r + c1) * r, (3.0 * c3 * r + 2.0 * c2) * r + c1, 6.0 * c3 * r + 2.0 * c2)
}

/// Time history and derivatives: T, T', T''.
fn swing(t: f64) -> (f64, f64, f64) {
    let omega = PI * SPEED / (2.0 * MIDDLE);
    let (sin, cos) = (omega * t).sin_cos();
    (AMPLITUDE * sin, AMPLITUDE * omega * cos, -AMPLITUDE * omega * omega * sin)
}

fn force(x: &[f64; 2], t: f64) -> [f64; 2] {
    let r = x[0].hypot(x[1]);
    let (u, slope, bend) = profile(r);
    let (size, _, second) = swing(t);
    let g = 0.5 * YOUNG;
    let nominal = |s: f64| g * (s - 1.0 / s);
    let (lr, lt) = (1.0 + slope * size, 1.0 + u * size / r);
    let inner = g * bend * size * (1.0 + 1.0 / (lr * lr)) + (nominal(lr) - nominal(lt)) / r;
    let b = u * second - inner / DENSITY;
    [b * x[0] / r, b * x[1] / r]
}

/// Run V5; `cells` is the number of cells across the ring, 0.2 m.
pub(crate) fn run<S: Formulation>(case: &Case<S>) -> Result<Outcome, String> {
    let h = (OUTER - INNER) / case.cells as f64;
    let lattice = lattice([0.0; 2], h)?;
    let duration = 2.0 * MIDDLE / SPEED;
    let steps = (duration * SPEED / (case.courant * h)).ceil() as u64;
    let dt = duration / steps as f64;
    let shell = Shell::new([0.0; 2], INNER, OUTER).map_err(|e| e.to_string())?;
    let mut seeds =
        fill(&shell, &lattice, case.per_axis, &Filling::new().partial(8, 0.1)).map_err(|e| e.to_string())?;
    let quarter: Vec<bool> = seeds.positions.iter().map(|x| x[0] > 0.0 && x[1] > 0.0).collect();
    let mut keep = quarter.iter();
    seeds.positions.retain(|_| *keep.next().unwrap_or(&false));
    let mut keep = quarter.iter();
    seeds.volumes.retain(|_| *keep.next().unwrap_or(&false));
    let scene = Scene {
        lattice,
        seeds,
        law: rubber(DENSITY, YOUNG, 0.0)?,
        velocity: Box::new(move |x| {
            let r = x[0].hypot(x[1]);
            let rate = profile(r).0 * swing(-0.5 * dt).1;
            [rate * x[0] / r, rate * x[1] / r]
        }),
        field: Some(Arc::new(force)),
        boundaries: vec![
            Boundary::Symmetry { axis: 0, at: 0.0, side: Side::Above },
            Boundary::Symmetry { axis: 1, at: 0.0, side: Side::Above },
        ],
        dt,
        steps,
        every: (steps / 20).max(1),
    };
    let (mut mean, mut largest) = (0.0, 0.0);
    let outcome = case.scheme.plane(&scene, &mut |moment| {
        let mut of_u = Norm::default();
        moment.for_each(&mut |p| {
            let x = &moment.starts[p.number];
            let r = x[0].hypot(x[1]);
            let growth = 1.0 + profile(r).0 * swing(moment.time).0 / r;
            let error = |d: usize| (p.position[d] - x[d] * growth) / AMPLITUDE;
            of_u.add(p.mass, &[error(0), error(1)]);
        });
        mean = worse(mean, of_u.l2());
        largest = worse(largest, of_u.largest());
    });
    Ok(outcome.with("u", mean).with("u largest", largest))
}
