//! Hook that solves a system in the step: implicit Newtonian viscosity, (M + dt K) v = M v*, for the trial velocities v*.
//!
//! M has the masses of nodes, K = sum_p B_p^T mu V_p (B_p + B_p^T) goes through the particles: free surfaces have no traction, whatever their
//! shape, and momentum and angular momentum are kept. The time step has no limit by viscosity.

use std::sync::Arc;

use impactite::mpm::{Hook, HookError, PointOperator, TrialNodes};
use impactite::parallel::Team;
use impactite::solve::{Jacobi, Operator, Stop, conjugate_gradients};

/// Viscosity of all bodies, Pa s.
#[derive(Clone, Debug)]
pub struct Diffusion {
    viscosity: f64,
    /// Largest number of iterations of a solve so far.
    pub iterations: usize,
}

impl Diffusion {
    /// Create from a viscosity, Pa s.
    pub fn new(viscosity: f64) -> Self {
        Diffusion { viscosity, iterations: 0 }
    }
}

/// M + dt K on the free components of velocity; `held` ones have the identity.
struct System<const D: usize> {
    points: Arc<PointOperator<D>>,
    mass: Vec<f64>,
    held: Vec<[bool; D]>,
    /// Viscosity times step, Pa s^2.
    impulse: f64,
}

impl<const D: usize> System<D> {
    /// Volume times viscous stress times step, J s.
    fn law(&self, p: usize, l: &[[f64; 3]; 3]) -> [[f64; 3]; 3] {
        let scale = self.impulse * self.points.points()[p].volume;
        std::array::from_fn(|c| std::array::from_fn(|d| scale * (l[c][d] + l[d][c])))
    }
    /// M u + dt K u without the identity of held components.
    fn product(&self, u: &[[f64; D]]) -> Vec<[f64; D]> {
        let mut y: Vec<[f64; D]> = u.iter().zip(&self.mass).map(|(u, m)| u.map(|u| m * u)).collect();
        self.points.stiffness(|p, l| self.law(p, l), u, &mut y);
        y
    }
    /// Components that are `held` or not; the others are 0.
    fn part(&self, x: &[[f64; D]], held: bool) -> Vec<[f64; D]> {
        let of = |n: usize| std::array::from_fn(|d| if self.held[n][d] == held { x[n][d] } else { 0.0 });
        (0..x.len()).map(of).collect()
    }
}

impl<const D: usize> Operator for System<D> {
    fn len(&self) -> usize {
        D * self.mass.len()
    }
    fn apply(&self, _: &Team, x: &[f64], y: &mut [f64]) {
        let x = x.as_chunks::<D>().0;
        let (free, held) = (self.product(&self.part(x, false)), self.part(x, true));
        let sum = self.part(&free, false).into_iter().zip(held);
        y.as_chunks_mut::<D>()
            .0
            .iter_mut()
            .zip(sum)
            .for_each(|(y, (a, b))| *y = std::array::from_fn(|d| a[d] + b[d]));
    }
}

impl<const D: usize> Hook<f64, D> for Diffusion {
    fn name(&self) -> &str {
        "diffusion of velocity"
    }
    fn needs_points(&self) -> bool {
        true
    }
    fn trial(&mut self, nodes: &mut TrialNodes<D>, dt: f64) -> Result<(), HookError> {
        let (list, points) = (nodes.nodes(), nodes.points().ok_or("no points")?);
        let mass: Vec<f64> = list.iter().map(|node| node.mass).collect();
        let system = System {
            points,
            mass,
            held: list.iter().map(|n| n.held).collect(),
            impulse: dt * self.viscosity,
        };
        let mut x: Vec<[f64; D]> = list.iter().map(|node| node.velocity).collect();
        // M v* on free components, less what the prescribed velocities give them.
        let given = system.product(&system.part(&x, true));
        let free = |n: usize, d: usize| system.mass[n] * x[n][d] - given[n][d];
        let right = |n: usize| std::array::from_fn(|d| if system.held[n][d] { x[n][d] } else { free(n, d) });
        let b: Vec<[f64; D]> = (0..x.len()).map(right).collect();
        let stiff = system.points.diagonal(|p, l| system.law(p, l));
        let entry = |n: usize| {
            std::array::from_fn(|d| if system.held[n][d] { 1.0 } else { system.mass[n] + stiff[n][d] })
        };
        let diagonal: Vec<[f64; D]> = (0..x.len()).map(entry).collect();
        let (team, stop) = (Team::one(), Stop { relative: 1e-10, ..Stop::default() });
        let mut jacobi = Jacobi::new(diagonal.as_flattened());
        let (b, found) = (b.as_flattened(), x.as_flattened_mut());
        let solved = conjugate_gradients(&team, &system, &mut jacobi, b, found, &stop)?;
        self.iterations = self.iterations.max(solved.iterations);
        x.into_iter().enumerate().for_each(|(n, velocity)| nodes.set_velocity(n, velocity));
        Ok(())
    }
}
