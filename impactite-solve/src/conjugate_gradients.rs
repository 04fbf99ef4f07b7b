//! Preconditioned conjugate gradients.

use impactite_simd::Team;

use crate::error::SolveError;
use crate::krylov::{Problem, Solved, Stop};
use crate::operator::{Operator, Preconditioner};
use crate::vectors::{add, dot_piece, sum_pieces, update};

/// Solve A x = b by preconditioned conjugate gradients \[HestenesStiefel1952\], for a symmetric positive (semi)definite operator. `x` holds the
/// start and the result.
///
/// The update of the search direction is the flexible one, beta = z' . (r' - r) / (z . r) \[Notay2000\], which admits a preconditioner that is
/// symmetric but for round-off, as a multigrid cycle in single precision. It starts anew along z where round-off has left p . r, which is
/// z . r in exact arithmetic, off by half: the step rz / (p . A p) then stays below twice that of the least error, and the error in the energy
/// norm never grows. The returned residual is the true one; the iteration starts anew from it when the recurrence drifts away.
///
/// # Errors
/// Vectors of another length than the operator; settings out of range; entries of b or x that are not finite; a right-hand side that is
/// incompatible with a singular operator; a direction without positive curvature; a preconditioner that is not positive definite; a
/// tolerance that is not reached. `x` then holds the last iterate.
pub fn conjugate_gradients(
    team: &Team,
    operator: &impl Operator,
    preconditioner: &mut impl Preconditioner,
    b: &[f64],
    x: &mut [f64],
    stop: &Stop,
) -> Result<Solved, SolveError> {
    let problem = Problem::new(team, operator, b, x, stop)?;
    let mut r = vec![0.0; x.len()];
    let mut residual = problem.residual(x, &mut r);
    let (mut z, mut p, mut q) = (vec![0.0; x.len()], vec![0.0; x.len()], vec![0.0; x.len()]);
    let (mut iterations, mut restarts, mut rho, mut alpha) = (0, 0, 0.0, 0.0);
    loop {
        if residual <= problem.tolerance {
            operator.project(team, x);
            residual = problem.residual(x, &mut r);
            if residual <= problem.tolerance {
                return Ok(problem.solved(iterations, residual));
            }
            // The recurrence drifted away from the true residual.
            (restarts, rho) = (restarts + 1, 0.0);
        }
        if iterations >= stop.iterations || restarts > RESTARTS || !residual.is_finite() {
            residual = problem.residual(x, &mut r);
            return Err(problem.failed(iterations, residual));
        }
        iterations += 1;
        preconditioner.apply(team, &r, &mut z);
        operator.project(team, &mut z);
        let [rz, qz] = products(team, &r, &q, &z);
        if !(rz > 0.0 && rz.is_finite()) {
            let cause = SolveError::Preconditioner { value: rz, iteration: iterations };
            return Err(problem.broken(iterations, cause, x, &mut r));
        }
        let beta = if rho == 0.0 { 0.0 } else { -alpha * qz / rho };
        let slope = direct(team, &mut p, beta, &z, &r);
        if (slope - rz).abs() > SLOPE * rz {
            direct(team, &mut p, 0.0, &z, &r);
        }
        let curvature = operator.apply_dot(team, &p, &mut q);
        if !(curvature > 0.0 && curvature.is_finite()) {
            let cause = SolveError::Curvature { value: curvature, iteration: iterations };
            return Err(problem.broken(iterations, cause, x, &mut r));
        }
        (rho, alpha) = (rz, rz / curvature);
        add(team, x, alpha, &p);
        residual = advance(team, &mut r, -alpha, &q);
    }
}

/// Restarts from the true residual before a solve gives up.
const RESTARTS: usize = 3;

/// Difference of p . r from z . r, as a share of it, from which a direction is of round-off.
const SLOPE: f64 = 0.5;

/// p <- z + a p; return p . r.
fn direct(team: &Team, p: &mut [f64], a: f64, z: &[f64], r: &[f64]) -> f64 {
    let [slope] = update(team, p, |start, piece| {
        for (p, z) in piece.iter_mut().zip(&z[start..]) {
            *p = z + a * *p;
        }
        [dot_piece(piece, &r[start..start + piece.len()])]
    });
    slope
}

/// Products r . z and q . z in one pass.
fn products(team: &Team, r: &[f64], q: &[f64], z: &[f64]) -> [f64; 2] {
    sum_pieces(team, z.len(), |start, end| {
        [dot_piece(&r[start..end], &z[start..end]), dot_piece(&q[start..end], &z[start..end])]
    })
}

/// r <- r + a q; return the norm of r.
fn advance(team: &Team, r: &mut [f64], a: f64, q: &[f64]) -> f64 {
    let [square] = update(team, r, |start, piece| {
        for (r, q) in piece.iter_mut().zip(&q[start..]) {
            *r += a * q;
        }
        [dot_piece(piece, piece)]
    });
    square.sqrt()
}
