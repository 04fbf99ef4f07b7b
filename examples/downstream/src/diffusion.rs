//! Hook that solves a system in the step: implicit diffusion of velocity, (M + dt mu L) v = M v*, for the trial velocities v*.
//!
//! M has the masses of nodes. L is the Laplacian on the links between neighbouring nodes of a body, each weighted by the part of
//! its cells that is filled, so that free surfaces have no traction. The time step has no limit by viscosity.

use std::collections::HashMap;

use impactite::mpm::{Hook, HookError, TrialNode, TrialNodes};
use impactite::parallel::Team;
use impactite::solve::{Jacobi, Operator, Stop, conjugate_gradients};

/// Viscosity of all bodies, Pa s, with their density, kg/m^3.
#[derive(Clone, Debug)]
pub struct Diffusion {
    viscosity: f64,
    density: f64,
    /// Largest number of iterations of a solve so far.
    pub iterations: usize,
}

impl Diffusion {
    /// Create from viscosity, Pa s, and density, kg/m^3.
    pub fn new(viscosity: f64, density: f64) -> Self {
        Diffusion { viscosity, density, iterations: 0 }
    }
}

/// Links between nodes with their weights, kg/s times the time step, and which nodes have a prescribed velocity.
struct System<'a> {
    mass: Vec<f64>,
    links: &'a [(usize, usize, f64)],
    held: Vec<bool>,
}

impl Operator for System<'_> {
    fn len(&self) -> usize {
        self.mass.len()
    }
    fn apply(&self, _: &Team, x: &[f64], y: &mut [f64]) {
        for (n, y) in y.iter_mut().enumerate() {
            *y = self.mass[n] * x[n];
        }
        for &(a, b, weight) in self.links {
            // Prescribed velocities are on the right-hand side.
            let of = |n: usize| if self.held[n] { 0.0 } else { x[n] };
            let push = weight * (of(a) - of(b));
            if !self.held[a] {
                y[a] += push;
            }
            if !self.held[b] {
                y[b] -= push;
            }
        }
    }
}

impl<const D: usize> Hook<f64, D> for Diffusion {
    fn name(&self) -> &str {
        "diffusion of velocity"
    }
    fn trial(&mut self, nodes: &mut TrialNodes<D>, dt: f64) -> Result<(), HookError> {
        let (list, h, team) = (nodes.nodes(), nodes.spacing(), Team::one());
        let at: HashMap<_, usize> = list.iter().enumerate().map(|(n, x)| ((x.body, x.index), n)).collect();
        let filled = |node: &TrialNode<D>| (node.mass / (self.density * h.powi(D as i32))).min(1.0);
        let mut links = Vec::new();
        for (a, node) in list.iter().enumerate() {
            for d in 0..D {
                let mut index = node.index;
                index[d] += 1;
                if let Some(&b) = at.get(&(node.body, index)) {
                    let part = filled(node).min(filled(&list[b]));
                    links.push((a, b, dt * self.viscosity * h.powi(D as i32 - 2) * part));
                }
            }
        }
        let mut velocities: Vec<[f64; D]> = list.iter().map(|node| node.velocity).collect();
        for d in 0..D {
            let held: Vec<bool> = list.iter().map(|node| node.held[d]).collect();
            let system = System { mass: list.iter().map(|node| node.mass).collect(), links: &links, held };
            let mut x: Vec<f64> = list.iter().map(|node| node.velocity[d]).collect();
            let (mut b, mut diagonal) = (vec![0.0; x.len()], system.mass.clone());
            (0..x.len()).for_each(|n| b[n] = system.mass[n] * x[n]);
            for &(one, two, weight) in &links {
                for (n, other) in [(one, two), (two, one)].into_iter().filter(|(n, _)| !system.held[*n]) {
                    diagonal[n] += weight;
                    b[n] += if system.held[other] { weight * x[other] } else { 0.0 };
                }
            }
            let stop = Stop { relative: 1e-10, ..Stop::default() };
            let solved = conjugate_gradients(&team, &system, &mut Jacobi::new(&diagonal), &b, &mut x, &stop)?;
            self.iterations = self.iterations.max(solved.iterations);
            velocities.iter_mut().zip(&x).for_each(|(velocity, x)| velocity[d] = *x);
        }
        velocities.into_iter().enumerate().for_each(|(n, velocity)| nodes.set_velocity(n, velocity));
        Ok(())
    }
}
