//! Preconditioned MINRES.

use impactite_simd::Team;

use crate::error::SolveError;
use crate::krylov::{Problem, Solved, Stop};
use crate::operator::{Operator, Preconditioner};
use crate::vectors::{add, dot, scale, update};

/// Solve A x = b by MINRES \[PaigeSaunders1975\], for a symmetric, possibly indefinite operator and a symmetric positive definite
/// preconditioner. `x` holds the start and the result.
///
/// The iteration minimises the norm of the residual induced by the preconditioner, (r . M^-1 r)^(1/2). It checks the true residual when that
/// estimate reaches the tolerance, and starts anew from it if it is larger.
///
/// # Errors
/// Vectors of another length than the operator; settings out of range; entries of b or x that are not finite; a right-hand side that is
/// incompatible with a singular operator; a preconditioner that is not positive definite; a tolerance that is not reached. `x` then holds
/// the last iterate.
pub fn minres(
    team: &Team,
    operator: &impl Operator,
    preconditioner: &mut impl Preconditioner,
    b: &[f64],
    x: &mut [f64],
    stop: &Stop,
) -> Result<Solved, SolveError> {
    let problem = Problem::new(team, operator, b, x, stop)?;
    let mut lanczos = Lanczos::new(x.len());
    let (mut iterations, mut last) = (0, f64::INFINITY);
    loop {
        let residual = problem.residual(x, &mut lanczos.r);
        if residual <= problem.tolerance {
            operator.project(team, x);
            return Ok(problem.solved(iterations, residual));
        }
        // A run that gained less than a factor of two has come to the accuracy of round-off.
        if residual.is_nan() || residual >= 0.5 * last || iterations >= stop.iterations {
            return Err(problem.failed(iterations, residual));
        }
        last = residual;
        lanczos.run(&problem, preconditioner, x, residual, &mut iterations)?;
    }
}

/// Vectors of the Lanczos process with preconditioner.
struct Lanczos {
    /// Residual that a run starts from, then Lanczos vector v (unscaled).
    r: Vec<f64>,
    /// Preceding Lanczos vector.
    before: Vec<f64>,
    /// Preconditioned vector z = M^-1 v.
    z: Vec<f64>,
    /// A z.
    az: Vec<f64>,
    /// Search directions: the last and the one before it.
    directions: [Vec<f64>; 2],
}

impl Lanczos {
    fn new(length: usize) -> Self {
        let zero = || vec![0.0; length];
        Lanczos { r: zero(), before: zero(), z: zero(), az: zero(), directions: [zero(), zero()] }
    }

    /// Precondition the Lanczos vector; return its norm beta = (v . M^-1 v)^(1/2).
    fn precondition(
        &mut self,
        problem: &Problem,
        preconditioner: &mut impl Preconditioner,
        iteration: usize,
    ) -> Result<f64, SolveError> {
        preconditioner.apply(problem.team, &self.r, &mut self.z);
        problem.operator.project(problem.team, &mut self.z);
        let value = dot(problem.team, &self.r, &self.z);
        if value >= 0.0 && value.is_finite() {
            return Ok(value.sqrt());
        }
        Err(SolveError::Preconditioner { value, iteration })
    }

    /// Iterate from the residual `self.r` of norm `residual` until the estimate reaches the tolerance.
    fn run(
        &mut self,
        problem: &Problem,
        preconditioner: &mut impl Preconditioner,
        x: &mut [f64],
        residual: f64,
        iterations: &mut usize,
    ) -> Result<(), SolveError> {
        let team = problem.team;
        self.before.fill(0.0);
        self.directions.iter_mut().for_each(|w| w.fill(0.0));
        let mut beta = self.precondition(problem, preconditioner, *iterations)?;
        let (start, mut old_beta, mut phi) = (beta, 0.0, beta);
        let (mut c, mut s, mut old_c, mut old_s) = (1.0, 0.0, 1.0, 0.0);
        // The preconditioned norm stands for the norm of the residual: both start at a known ratio.
        while phi.abs() > REACH * problem.tolerance / residual * start
            && *iterations < problem.stop.iterations
        {
            *iterations += 1;
            scale(team, &mut self.z, 1.0 / beta);
            let alpha = problem.operator.apply_dot(team, &self.z, &mut self.az);
            // Next Lanczos vector: A z - (alpha / beta) v - (beta / old beta) v before.
            let (along, back) = (alpha / beta, if old_beta == 0.0 { 0.0 } else { beta / old_beta });
            let (r, before) = (&self.r, &self.before);
            update(team, &mut self.az, |first, piece| {
                for ((y, r), b) in piece.iter_mut().zip(&r[first..]).zip(&before[first..]) {
                    *y -= along * r + back * b;
                }
                []
            });
            // Rotations of the tridiagonal matrix.
            let (epsilon, delta) = (old_s * beta, c * alpha - s * old_c * beta);
            let off = s * alpha + c * old_c * beta;
            std::mem::swap(&mut self.before, &mut self.r);
            std::mem::swap(&mut self.r, &mut self.az);
            std::mem::swap(&mut self.az, &mut self.z);
            let next = self.precondition(problem, preconditioner, *iterations)?;
            // `az` now holds the scaled preconditioned vector of this iteration.
            let gamma = delta.hypot(next);
            if gamma == 0.0 {
                return Ok(());
            }
            (old_c, old_s, c, s) = (c, s, delta / gamma, next / gamma);
            self.turn(team, [off, epsilon, gamma]);
            add(team, x, c * phi, &self.directions[0]);
            (phi, old_beta, beta) = (-s * phi, beta, next);
            if beta == 0.0 {
                return Ok(());
            }
        }
        Ok(())
    }

    /// Next direction w = (z - off w1 - epsilon w2) / gamma from the last two, w1 and w2.
    fn turn(&mut self, team: &Team, [off, epsilon, gamma]: [f64; 3]) {
        let [last, older] = &mut self.directions;
        let (z, w) = (&self.az, &*last);
        update(team, older, |first, piece| {
            for ((old, z), w) in piece.iter_mut().zip(&z[first..]).zip(&w[first..]) {
                *old = (z - off * w - epsilon * *old) / gamma;
            }
            []
        });
        self.directions.swap(0, 1);
    }
}

/// Part of the tolerance that the estimate of the residual has to reach: norms with and without the preconditioner differ.
const REACH: f64 = 0.3;
