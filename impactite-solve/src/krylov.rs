//! Stopping criteria and results common to all Krylov methods.

use impactite_simd::Team;

use crate::error::SolveError;
use crate::operator::Operator;
use crate::vectors::{norm, subtract_from};

/// Stopping criterion of an iteration: |b - A x| <= max(`relative` |b|, `absolute`) in the Euclidean norm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stop {
    /// Relative tolerance of the residual, 0 <= relative < 1.
    pub relative: f64,
    /// Absolute tolerance of the residual, >= 0, in the unit of b.
    pub absolute: f64,
    /// Largest number of iterations, >= 1.
    pub iterations: usize,
    /// Largest part of |b| in the null space of a singular operator, 0 to 1. A larger part is an error unless it is below the absolute
    /// tolerance.
    pub incompatible: f64,
}

impl Default for Stop {
    /// Relative tolerance 1e-8, absolute tolerance 0, 200 iterations, incompatible part 1e-8.
    fn default() -> Self {
        Stop { relative: 1e-8, absolute: 0.0, iterations: 200, incompatible: 1e-8 }
    }
}

/// Result of a solve that reached its tolerance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Solved {
    /// Number of iterations.
    pub iterations: usize,
    /// Norm of the true residual |b - A x|, in the unit of b.
    pub residual: f64,
    /// Norm of the part of b in the null space, which was removed; 0 for a regular operator.
    pub removed: f64,
}

impl Stop {
    fn check(&self) -> Result<(), SolveError> {
        let refuse = |field, value, allowed| Err(SolveError::Setting { field, value, allowed });
        if !(0.0..1.0).contains(&self.relative) {
            return refuse("relative", self.relative, "0 or more and less than 1");
        }
        if !(self.absolute >= 0.0 && self.absolute.is_finite()) {
            return refuse("absolute", self.absolute, "finite and not negative");
        }
        if self.iterations == 0 {
            return refuse("iterations", 0.0, "1 or more");
        }
        if !(0.0..=1.0).contains(&self.incompatible) {
            return refuse("incompatible", self.incompatible, "0 to 1");
        }
        Ok(())
    }
}

/// Checked data of a solve.
pub(crate) struct Problem<'a> {
    pub team: &'a Team,
    pub operator: &'a dyn Operator,
    /// Right-hand side without its part in the null space.
    pub b: std::borrow::Cow<'a, [f64]>,
    /// Norm of b.
    pub size: f64,
    pub tolerance: f64,
    pub removed: f64,
    pub stop: Stop,
}

impl<'a> Problem<'a> {
    /// Check the data, and remove the parts of b and x in the null space.
    pub fn new(
        team: &'a Team,
        operator: &'a dyn Operator,
        b: &'a [f64],
        x: &mut [f64],
        stop: &Stop,
    ) -> Result<Self, SolveError> {
        stop.check()?;
        for (field, value) in [("b", b.len()), ("x", x.len())] {
            if value != operator.len() {
                return Err(SolveError::Length { field, value, unknowns: operator.len() });
            }
        }
        let size = finite_norm(team, "b", b)?;
        finite_norm(team, "x", x)?;
        if let Some(index) = operator.unreachable(team, b) {
            return Err(SolveError::NoUnknown { value: b[index], index });
        }
        let mut problem = Problem {
            team,
            operator,
            b: b.into(),
            size,
            tolerance: (stop.relative * size).max(stop.absolute),
            removed: 0.0,
            stop: *stop,
        };
        if operator.nullity() > 0 {
            let mut projected = b.to_vec();
            operator.project(team, &mut projected);
            let mut part = projected.clone();
            subtract_from(team, b, &mut part);
            let removed = norm(team, &part);
            if removed > stop.incompatible * size && removed > stop.absolute {
                return Err(SolveError::Incompatible { removed, norm: size, allowed: stop.incompatible });
            }
            operator.project(team, x);
            (problem.b, problem.removed) = (projected.into(), removed);
        }
        Ok(problem)
    }

    /// Compute the true residual r = b - A x and return its norm.
    pub fn residual(&self, x: &[f64], r: &mut [f64]) -> f64 {
        self.operator.apply(self.team, x, r);
        subtract_from(self.team, &self.b, r);
        norm(self.team, r)
    }

    /// Result with the true residual.
    pub fn solved(&self, iterations: usize, residual: f64) -> Solved {
        Solved { iterations, residual, removed: self.removed }
    }

    /// Error of a breakdown of the recurrence: `cause`, unless the true residual has come to the accuracy of round-off, where signs are random.
    pub fn broken(&self, iterations: usize, cause: SolveError, x: &[f64], r: &mut [f64]) -> SolveError {
        let residual = self.residual(x, r);
        if residual <= ACCURACY * self.size { self.failed(iterations, residual) } else { cause }
    }

    /// Error of a residual above the tolerance.
    pub fn failed(&self, iterations: usize, residual: f64) -> SolveError {
        let advice = if !residual.is_finite() {
            "the operator or the preconditioner returned numbers that are not finite"
        } else if iterations >= self.stop.iterations {
            "allow more iterations or take a better preconditioner"
        } else {
            "round-off prevents a smaller residual: raise the tolerance"
        };
        SolveError::NotReached { residual, tolerance: self.tolerance, iterations, advice }
    }
}

/// Part of |b| below which a residual may be of round-off: eps times a condition number of 1e4.
const ACCURACY: f64 = 1e4 * f64::EPSILON;

/// Norm of a vector.
fn finite_norm(team: &Team, field: &'static str, x: &[f64]) -> Result<f64, SolveError> {
    let size = norm(team, x);
    if size.is_finite() {
        return Ok(size);
    }
    match x.iter().position(|v| !v.is_finite()) {
        Some(index) => Err(SolveError::NotFinite { field, value: x[index], index }),
        None => Err(SolveError::Setting { field, value: size, allowed: "a vector whose norm is finite" }),
    }
}
