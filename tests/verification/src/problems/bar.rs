//! Bars with E = rho = length = 1 and nu = 0, so that c = 1: V1, V2, V7. Rows of cells between symmetry planes.

use std::f64::consts::{FRAC_PI_2, PI};

use mpm_core::{Boundary, Side};
use mpm_materials::NeoHookean;

use crate::case::{Case, Outcome};
use crate::formulation::Formulation;
use crate::problems::{box_of_planes, lattice, rubber};
use crate::scene::{Norm, Scene, block};

fn scene<S: Formulation>(
    case: &Case<S>,
    velocity: impl Fn(f64) -> f64 + 'static,
    duration: f64,
) -> Result<Scene<NeoHookean<f64>, 2>, String> {
    let h = 1.0 / case.cells as f64;
    let lattice = lattice([0.0; 2], h)?;
    let dt = case.courant * h;
    let across = case.scheme.across();
    Ok(Scene {
        lattice,
        seeds: block(&lattice, [0; 2], [case.cells, across], case.per_axis),
        law: rubber(1.0, 1.0, 0.0)?,
        velocity: Box::new(move |x| [velocity(x[0]), 0.0]),
        field: None,
        boundaries: box_of_planes(1..2, 0.0, across as f64 * h),
        dt,
        steps: (duration / dt).round() as u64,
        every: 1,
    })
}

/// Run V1: a bar held at one end vibrates in its first mode, v = V cos(w t) sin(b x), b = pi/2, w = b c, V = 1e-5 c.
/// `cells` is the number of cells of the bar, half of those per half wave. "period" is the relative error of the
/// period, measured over five periods by sign changes of the momentum.
pub(crate) fn period<S: Formulation>(case: &Case<S>) -> Result<Outcome, String> {
    let mut scene = scene(case, |x| 1e-5 * (FRAC_PI_2 * x).sin(), 5.2 * 4.0)?;
    scene.boundaries.push(Boundary::Symmetry { axis: 0, at: 0.0, side: Side::Above });
    let (mut crossings, mut last) = (Vec::new(), 0.0);
    let dt = scene.dt;
    let outcome = case.scheme.plane(&scene, &mut |moment| {
        let now = moment.totals().momentum[0];
        if last * now < 0.0 {
            crossings.push(moment.time - dt + dt * last / (last - now));
        }
        last = now;
    });
    let period = match crossings[..] {
        [first, .., last] => 2.0 * (last - first) / (crossings.len() as f64 - 1.0),
        _ => f64::NAN,
    };
    Ok(outcome.with("period", period / 4.0 - 1.0))
}

/// Run V2: a free bar drifts at 0.05 c and vibrates in its first mode with 0.05 c for ten periods, so that
/// particles cross cells at large strain. Measured is the change of the energy in the centre-of-mass frame between
/// the means over the first and the last period.
pub(crate) fn drift<S: Formulation>(case: &Case<S>) -> Result<Outcome, String> {
    let speed = 0.05;
    let scene = scene(case, move |x| speed * (1.0 + (PI * x).cos()), 20.0)?;
    let length = scene.steps / 10;
    let (mut first, mut last, mut step) = (0.0, 0.0, 0);
    let outcome = case.scheme.plane(&scene, &mut |moment| {
        let t = moment.totals();
        let drift = t.momentum[0] / t.mass;
        let energy = t.kinetic + t.internal - 0.5 * t.mass * drift * drift;
        if step < length {
            first += energy;
        }
        if step >= 9 * length && step < 10 * length {
            last += energy;
        }
        step += 1;
    });
    Ok(outcome.with("energy", last / first - 1.0))
}

/// Run V7: a velocity bump, V exp(-((x - 1/2) / s)^2) with s = 0.08, splits into two opposite waves (d'Alembert): v
/// = [V(x - t) + V(x + t)] / 2. V = 1e-5 c. Measured is the root mean square error at t = 0.25, over V.
pub(crate) fn pulse<S: Formulation>(case: &Case<S>) -> Result<Outcome, String> {
    let size = 1e-5;
    let bump = |x: f64| (-((x - 0.5) / 0.08).powi(2)).exp();
    // Initial velocity at half a step before the start: the acceleration is zero there, v(-dt/2) = V + O(dt^2).
    let mut scene = scene(case, move |x| size * bump(x), 0.25)?;
    scene.boundaries.extend(box_of_planes::<2>(0..1, 0.0, 1.0));
    scene.every = scene.steps;
    let mut error = f64::NAN;
    let outcome = case.scheme.plane(&scene, &mut |moment| {
        let mut of_v = Norm::default();
        let t = moment.velocity_time;
        moment.for_each(&mut |p| {
            let x = moment.starts[p.number][0];
            of_v.add(p.mass, &[p.velocity[0] / size - 0.5 * (bump(x - t) + bump(x + t))]);
        });
        error = of_v.l2();
    });
    Ok(outcome.with("v", error))
}
