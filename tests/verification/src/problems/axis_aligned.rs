//! V3: large axis-aligned stretch of a unit square or cube (\[WallstedtGuilkey2008\]).
//!
//! u_i = A sin(k X_i) sin(w t + phi_i), so that F is diagonal with F_ii = 1 + A k cos(k X_i) sin(w t + phi_i). For
//! the neo-Hookean law of the library the body force is `b_i = -w^2 u_i + (k^2 u_i / rho0) [G + (lambda (1 - ln J) +
//! G) / F_ii^2]`. Here k = 2 pi, w = pi c, c the root of E / rho0, A = 0.05 (31 % strain), nu = 0.3, phases 0 and pi
//! (and 0): initial displacements are zero, and normal displacements vanish on the faces, which are symmetry planes.
//! The run ends at t = 1 / c; measured are the largest errors of 20 samples, relative to A and to A k E.

use std::f64::consts::PI;
use std::sync::Arc;

use crate::case::{Case, Outcome};
use crate::formulation::Formulation;
use crate::problems::{box_of_planes, lattice, rubber};
use crate::scene::{Moment, Norm, Scene, block, worse};

pub(crate) const AMPLITUDE: f64 = 0.05;
const K: f64 = 2.0 * PI;
const YOUNG: f64 = 1.0;
const DENSITY: f64 = 1.0;
const POISSON: f64 = 0.3;
const OMEGA: f64 = PI;
const PHASES: [f64; 3] = [0.0, PI, 0.0];

/// Displacement, velocity and stretch along an axis.
pub(crate) fn motion(axis: usize, x: f64, t: f64) -> (f64, f64, f64) {
    let phase = OMEGA * t + PHASES[axis];
    let u = AMPLITUDE * (K * x).sin() * phase.sin();
    let v = AMPLITUDE * OMEGA * (K * x).sin() * phase.cos();
    (u, v, 1.0 + AMPLITUDE * K * (K * x).cos() * phase.sin())
}

/// Lame's constants.
fn moduli() -> (f64, f64) {
    (YOUNG * POISSON / ((1.0 + POISSON) * (1.0 - 2.0 * POISSON)), YOUNG / (2.0 * (1.0 + POISSON)))
}

/// Principal Cauchy stresses along the axes.
fn stress(stretches: &[f64; 3]) -> [f64; 3] {
    let (lambda, g) = moduli();
    let j: f64 = stretches.iter().product();
    stretches.map(|f| (lambda * j.ln() + g * (f * f - 1.0)) / j)
}

pub(crate) fn force<const D: usize>(x: &[f64; D], t: f64) -> [f64; D] {
    let (lambda, g) = moduli();
    let mut log_j = 0.0;
    for d in 0..D {
        log_j += motion(d, x[d], t).2.ln();
    }
    let mut b = [0.0; D];
    for d in 0..D {
        let (u, _, f) = motion(d, x[d], t);
        let stiffness = g + (lambda * (1.0 - log_j) + g) / (f * f);
        b[d] = -OMEGA * OMEGA * u + K * K * u / DENSITY * stiffness;
    }
    b
}

fn scene<S, const D: usize>(case: &Case<S>) -> Result<Scene<mpm_materials::NeoHookean<f64>, D>, String> {
    let h = 1.0 / case.cells as f64;
    let lattice = lattice([0.0; D], h)?;
    let steps = (case.cells as f64 / case.courant).ceil() as u64;
    let dt = 1.0 / steps as f64;
    Ok(Scene {
        lattice,
        seeds: block(&lattice, [0; D], [case.cells; D], case.per_axis),
        law: rubber(DENSITY, YOUNG, POISSON)?,
        velocity: Box::new(move |x| {
            let mut v = [0.0; D];
            for d in 0..D {
                v[d] = motion(d, x[d], -0.5 * dt).1;
            }
            v
        }),
        field: Some(Arc::new(|x: &[f64; D], t| force(x, t))),
        boundaries: box_of_planes(0..D, 0.0, 1.0),
        dt,
        steps,
        every: (steps / 20).max(1),
    })
}

/// Largest errors of the samples so far.
#[derive(Default)]
struct Errors {
    displacement: f64,
    largest: f64,
    velocity: f64,
    stress: f64,
}

impl Errors {
    fn look<const D: usize>(&mut self, moment: &Moment<'_, D>) {
        let (mut of_u, mut of_v, mut of_s) = (Norm::default(), Norm::default(), Norm::default());
        moment.for_each(&mut |p| {
            let start = &moment.starts[p.number];
            let (mut du, mut dv, mut stretches) = ([0.0; D], [0.0; D], [1.0; 3]);
            for d in 0..D {
                let (u, _, f) = motion(d, start[d], moment.time);
                du[d] = (p.position[d] - start[d] - u) / AMPLITUDE;
                dv[d] = (p.velocity[d] - motion(d, start[d], moment.velocity_time).1) / (AMPLITUDE * OMEGA);
                stretches[d] = f;
            }
            let exact = stress(&stretches);
            let mut ds = [0.0; D];
            for d in 0..D {
                ds[d] = (p.stress[d] - exact[d]) / (AMPLITUDE * K * YOUNG);
            }
            of_u.add(p.mass, &du);
            of_v.add(p.mass, &dv);
            of_s.add(p.mass, &ds);
        });
        self.displacement = worse(self.displacement, of_u.l2());
        self.largest = worse(self.largest, of_u.largest());
        self.velocity = worse(self.velocity, of_v.l2());
        self.stress = worse(self.stress, of_s.l2());
    }
    fn into(self, outcome: Outcome) -> Outcome {
        outcome
            .with("u", self.displacement)
            .with("u largest", self.largest)
            .with("v", self.velocity)
            .with("stress", self.stress)
    }
}

/// Run the square.
pub(crate) fn plane<S: Formulation>(case: &Case<S>) -> Result<Outcome, String> {
    let scene = scene::<_, 2>(case)?;
    let mut errors = Errors::default();
    let outcome = case.scheme.plane(&scene, &mut |moment| errors.look(moment));
    Ok(errors.into(outcome))
}

/// Run the cube.
pub(crate) fn solid<S: Formulation>(case: &Case<S>) -> Result<Outcome, String> {
    let scene = scene::<_, 3>(case)?;
    let mut errors = Errors::default();
    let outcome = case.scheme.solid(&scene, &mut |moment| errors.look(moment));
    Ok(errors.into(outcome))
}
