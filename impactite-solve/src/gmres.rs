//! Restarted GMRES.

use impactite_simd::Team;

use crate::error::SolveError;
use crate::krylov::{Problem, Solved, Stop};
use crate::operator::{Operator, Preconditioner};
use crate::vectors::{add, dot, norm, scale, update};

/// Solve A x = b by restarted GMRES with a preconditioner on the right \[SaadSchultz1986\], for any regular operator. `x` holds the start and
/// the result.
///
/// The iteration minimises the norm of the residual over the Krylov space of A M^-1, of at most `restart` dimensions, which needs memory for
/// 2 `restart` + 2 vectors: preconditioned vectors are stored, so that the preconditioner may change between iterations \[Saad1993\]. The Arnoldi
/// basis is orthogonalised twice by the modified Gram-Schmidt process.
///
/// # Errors
/// Vectors of another length than the operator; settings out of range; entries of b or x that are not finite; a right-hand side that is
/// incompatible with a singular operator; a tolerance that is not reached. `x` then holds the last iterate.
pub fn gmres(
    team: &Team,
    operator: &impl Operator,
    preconditioner: &mut impl Preconditioner,
    b: &[f64],
    x: &mut [f64],
    restart: usize,
    stop: &Stop,
) -> Result<Solved, SolveError> {
    if restart == 0 {
        return Err(SolveError::Setting { field: "restart", value: 0.0, allowed: "1 or more" });
    }
    let problem = Problem::new(team, operator, b, x, stop)?;
    let (mut iterations, mut r) = (0, vec![0.0; x.len()]);
    let (mut arnoldi, mut idle) = (Arnoldi::default(), 0);
    let mut residual = problem.residual(x, &mut r);
    loop {
        if residual <= problem.tolerance {
            operator.project(team, x);
            return Ok(problem.solved(iterations, residual));
        }
        if iterations >= stop.iterations || idle > 2 || !residual.is_finite() {
            return Err(problem.failed(iterations, residual));
        }
        let dimensions = restart.min(stop.iterations - iterations);
        iterations += arnoldi.cycle(&problem, preconditioner, &mut r, residual, dimensions);
        arnoldi.correct(team, x);
        let before = residual;
        residual = problem.residual(x, &mut r);
        // Cycles that do not reduce the residual have come to stagnation.
        idle = if residual < 0.999 * before { 0 } else { idle + 1 };
    }
}

/// Arnoldi process: orthonormal basis v, preconditioned basis z, and the triangular factor of the Hessenberg matrix.
#[derive(Default)]
struct Arnoldi {
    basis: Vec<Vec<f64>>,
    preconditioned: Vec<Vec<f64>>,
    /// Columns of the triangular factor.
    columns: Vec<Vec<f64>>,
    /// Rotations (c, s) that make it triangular.
    rotations: Vec<[f64; 2]>,
    /// Rotated right-hand side.
    g: Vec<f64>,
}

impl Arnoldi {
    /// Run up to `dimensions` iterations from the residual r; return their number.
    fn cycle(
        &mut self,
        problem: &Problem,
        preconditioner: &mut impl Preconditioner,
        r: &mut [f64],
        residual: f64,
        dimensions: usize,
    ) -> usize {
        let team = problem.team;
        self.columns.clear();
        self.rotations.clear();
        self.g = vec![residual];
        scale(team, r, 1.0 / residual);
        store(&mut self.basis, 0, r);
        for k in 0..dimensions {
            if self.preconditioned.len() == k {
                self.preconditioned.push(vec![0.0; r.len()]);
            }
            preconditioner.apply(team, &self.basis[k], &mut self.preconditioned[k]);
            problem.operator.project(team, &mut self.preconditioned[k]);
            problem.operator.apply(team, &self.preconditioned[k], r);
            let size = norm(team, r);
            let mut column = vec![0.0; k + 1];
            for _ in 0..2 {
                for (h, v) in column.iter_mut().zip(&self.basis) {
                    let part = dot(team, v, r);
                    *h += part;
                    add(team, r, -part, v);
                }
            }
            let next = norm(team, r);
            let broken = next <= 10.0 * f64::EPSILON * size;
            self.rotate(column, if broken { 0.0 } else { next });
            if broken || !next.is_finite() || self.g[k + 1].abs() <= problem.tolerance {
                return k + 1;
            }
            scale(team, r, 1.0 / next);
            store(&mut self.basis, k + 1, r);
        }
        dimensions
    }

    /// Append a column of the Hessenberg matrix, with `next` below its diagonal, and rotate it to triangular form.
    fn rotate(&mut self, mut column: Vec<f64>, next: f64) {
        let k = self.rotations.len();
        for (i, [c, s]) in self.rotations.iter().enumerate() {
            (column[i], column[i + 1]) =
                (c * column[i] + s * column[i + 1], c * column[i + 1] - s * column[i]);
        }
        let length = column[k].hypot(next);
        let [c, s] = if length == 0.0 { [1.0, 0.0] } else { [column[k] / length, next / length] };
        column[k] = length;
        self.g.push(-s * self.g[k]);
        self.g[k] *= c;
        self.columns.push(column);
        self.rotations.push([c, s]);
    }

    /// x <- x + Z y with the solution y of the triangular system; columns without a pivot are left out.
    fn correct(&self, team: &Team, x: &mut [f64]) {
        let n = self.columns.len();
        let mut y = self.g[..n].to_vec();
        for k in (0..n).rev() {
            for j in k + 1..n {
                y[k] -= self.columns[j][k] * y[j];
            }
            let pivot = self.columns[k][k];
            y[k] = if pivot == 0.0 { 0.0 } else { y[k] / pivot };
        }
        let z = &self.preconditioned;
        update(team, x, |first, piece| {
            for (y, z) in y.iter().zip(z) {
                for (x, z) in piece.iter_mut().zip(&z[first..]) {
                    *x += y * z;
                }
            }
            []
        });
    }
}

/// Store a copy of a vector at index `k`, which is at most the length of the list.
fn store(list: &mut Vec<Vec<f64>>, k: usize, vector: &[f64]) {
    match list.get_mut(k) {
        Some(place) => place.copy_from_slice(vector),
        None => list.push(vector.to_vec()),
    }
}
