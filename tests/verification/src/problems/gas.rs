//! Sod's shock tube (V13) and Taylor-Green vortices (V22).

use std::f64::consts::PI;

use mpm_materials::fluid::FluidState;
use mpm_materials::{Constitutive, Fluid, IdealGas, Newtonian, Nothing, Tait};

use crate::case::{Case, Outcome};
use crate::empty::{GasState, gas_schemes};
use crate::formulation::Formulation;
use crate::problems::{box_of_planes, lattice};
use crate::scene::{Moment, Norm, Scene, block};
use crate::scheme::{Kernel, Scheme, Velocity};

const GAMMA: f64 = 1.4;
/// Pressure and speed of the plateau between contact discontinuity and shock.
const PLATEAU_PRESSURE: f64 = 0.303130;
const PLATEAU_SPEED: f64 = 0.927453;
const LEFT_DENSITY: f64 = 0.426319;
const RIGHT_DENSITY: f64 = 0.265574;
const SHOCK: f64 = 1.752156;
/// Speed of the rarefaction tail.
const TAIL: f64 = -0.070273;
const END: f64 = 0.2;

/// Exact density at x / t.
fn density(s: f64) -> f64 {
    let c = GAMMA.sqrt();
    if s < -c {
        1.0
    } else if s < TAIL {
        let speed = 2.0 / (GAMMA + 1.0) * (c + s);
        (1.0 - 0.5 * (GAMMA - 1.0) * speed / c).powf(2.0 / (GAMMA - 1.0))
    } else if s < PLATEAU_SPEED {
        LEFT_DENSITY
    } else if s < SHOCK {
        RIGHT_DENSITY
    } else {
        0.125
    }
}

/// Initial state of the gas: the right half has an eighth of the density and a tenth of the pressure, p = 0.4 e /
/// J.
fn halves(x: [f64; 2]) -> GasState {
    let (volume_ratio, energy) = if x[0] < 0.5 { (1.0, 2.5) } else { (8.0, 2.0) };
    FluidState { volume_ratio, energy, viscous_stress: Nothing, viscous_pressure: 0.0, viscous_heat: Nothing }
}

/// Errors of the shock tube: L1 density error per metre of the tube and of its `width`, mean relative pressure error on the plateau, and
/// overshoot of the largest particle speed.
fn profile(moment: &Moment<'_, 2>, width: f64) -> [f64; 3] {
    let (mut error, mut pressure, mut inside, mut fastest) = (0.0, 0.0, 0.0, 0.0f64);
    // Margin: excludes a fifth of the plateau at either end.
    let margin = 0.2 * (SHOCK - TAIL);
    moment.for_each(&mut |p| {
        let s = (p.position[0] - 0.5) / END;
        error += p.volume / width * (p.mass / p.volume - density(s)).abs();
        if s > TAIL + margin && s < SHOCK - margin {
            pressure += p.volume * p.pressure();
            inside += p.volume;
        }
        fastest = fastest.max(p.velocity[0]);
    });
    [error, pressure / inside / PLATEAU_PRESSURE - 1.0, fastest / PLATEAU_SPEED - 1.0]
}

/// List the schemes for Sod's tube.
pub fn tube_schemes() -> Vec<Scheme> {
    gas_schemes()
}

/// Run V13, Sod: gamma 1.4, (rho, u, p) = (1, 0, 1) and (0.125, 0, 0.1), a tube of length 1 with the diaphragm in
/// its middle, to t = 0.2, with bulk viscosity of q1 = 0.5, q2 = 2 or without. `cells` is the number of cells of
/// the tube; particles are of equal size, so that those on the right have an eighth of the mass. "density" is the
/// L1 norm of the density error, "pressure" the relative error of the mean plateau pressure, "overshoot" the
/// largest speed over the plateau speed, minus 1.
pub(crate) fn sod<S: Formulation>(case: &Case<S>, viscous: bool) -> Result<Outcome, String> {
    let h = 1.0 / case.cells as f64;
    let lattice = lattice([0.0; 2], h)?;
    let across = case.scheme.across();
    let width = across as f64 * h;
    let gas = IdealGas::new(1.0, GAMMA, 1.0).map_err(|e| e.to_string())?;
    let (linear, quadratic) = if viscous { (0.5, 2.0) } else { (0.0, 0.0) };
    let law = Fluid::new(gas).with_bulk_viscosity(linear, quadratic).map_err(|e| e.to_string())?;
    let mut boundaries = box_of_planes(0..1, 0.0, 1.0);
    boundaries.extend(box_of_planes(1..2, 0.0, width));
    // Fastest signal: the shock.
    let steps = (END * 2.0 / (case.courant * h)).ceil() as u64;
    let scene = Scene {
        lattice,
        seeds: block(&lattice, [0; 2], [case.cells, across], case.per_axis),
        law,
        velocity: Box::new(|_| [0.0; 2]),
        field: None,
        boundaries,
        dt: END / steps as f64,
        steps,
        every: steps,
    };
    let mut measured = [f64::NAN; 3];
    let outcome = case.scheme.gas(&scene, halves, &mut |moment| measured = profile(moment, width));
    let [density, pressure, overshoot] = measured;
    Ok(outcome.with("density", density).with("pressure", pressure).with("overshoot", overshoot))
}

/// List the schemes for Taylor-Green vortices.
pub fn vortices_schemes() -> Vec<Scheme> {
    vec![
        Scheme::moving(Kernel::Quadratic, Velocity::FlipUsl),
        Scheme::moving(Kernel::Quadratic, Velocity::ApicUsl),
        Scheme::moving(Kernel::Cubic, Velocity::ApicUsl),
    ]
}

/// Run V22: v = V (sin k x cos k y, -cos k x sin k y) in a unit square between symmetry planes, k = pi, decays as
/// exp(-2 nu k^2 t) in an incompressible fluid. Here V = 0.05 c in Tait water, nu such that the decay is by e in 1
/// / V, Reynolds number 20. Measured is the remaining amplitude of the field at that time (its projection), over
/// exp(-1), minus 1.
pub(crate) fn taylor_green<S: Formulation>(case: &Case<S>) -> Result<Outcome, String> {
    let h = 1.0 / case.cells as f64;
    let lattice = lattice([0.0; 2], h)?;
    let speed = 0.05;
    let end = 1.0 / speed;
    let nu = speed / (2.0 * PI * PI);
    let tait = Tait::new(1.0, 1.0).map_err(|e| e.to_string())?;
    let law =
        Fluid::new(tait).with_shear_viscosity(Newtonian::new(nu).map_err(|e| e.to_string())?).compiled();
    let field = |x: [f64; 2]| {
        let ((sx, cx), (sy, cy)) = ((PI * x[0]).sin_cos(), (PI * x[1]).sin_cos());
        [sx * cy, -cx * sy]
    };
    let steps = (end / (case.courant * h)).ceil() as u64;
    let scene = Scene {
        lattice,
        seeds: block(&lattice, [0; 2], [case.cells; 2], case.per_axis),
        law,
        velocity: Box::new(move |x| field(x).map(|v| speed * v)),
        field: None,
        boundaries: box_of_planes(0..2, 0.0, 1.0),
        dt: end / steps as f64,
        steps,
        every: steps,
    };
    let (mut left, mut rest) = (f64::NAN, f64::NAN);
    let mut look = |moment: &Moment<'_, 2>| {
        let (mut along, mut square) = (0.0, 0.0);
        let mut of_v = Norm::default();
        let exact = (-1.0f64).exp();
        moment.for_each(&mut |p| {
            let v = field([p.position[0], p.position[1]]);
            along += p.volume * (p.velocity[0] * v[0] + p.velocity[1] * v[1]) / speed;
            square += p.volume * (v[0] * v[0] + v[1] * v[1]);
            of_v.add(p.volume, &[0, 1].map(|d| p.velocity[d] / speed - exact * v[d]));
        });
        left = along / square / exact - 1.0;
        rest = of_v.l2();
    };
    let outcome = case.scheme.plane(&scene, &mut look);
    Ok(outcome.with("left", left).with("v", rest))
}
