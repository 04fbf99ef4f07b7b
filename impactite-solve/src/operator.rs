//! Linear operators and preconditioners.

use impactite_simd::Team;

use crate::vectors::{dot, update};

/// Linear operator y = A x on vectors of f64.
///
/// Every result has the same bits for any number of threads of the team.
pub trait Operator {
    /// Length of the vectors.
    fn len(&self) -> usize;

    /// True if the vectors have no entries.
    fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Compute y = A x. Both vectors have the length [`Operator::len`].
    fn apply(&self, team: &Team, x: &[f64], y: &mut [f64]);

    /// Compute y = A x and return x . y, in one pass where the operator has one.
    fn apply_dot(&self, team: &Team, x: &[f64], y: &mut [f64]) -> f64 {
        self.apply(team, x, y);
        dot(team, x, y)
    }

    /// Dimension of the known null space of A; 0 for a regular operator.
    fn nullity(&self) -> usize {
        0
    }

    /// Index of an entry of b that no x can produce, since its row of A is zero; None if there is no such entry.
    fn unreachable(&self, _team: &Team, _b: &[f64]) -> Option<usize> {
        None
    }

    /// Remove the part of x in the known null space of A.
    fn project(&self, _team: &Team, _x: &mut [f64]) {}
}

/// Approximate inverse z = M^-1 r of an operator.
///
/// Conjugate gradients and MINRES require a symmetric positive definite M.
pub trait Preconditioner {
    /// Compute z = M^-1 r. Both vectors have the length of the operator.
    fn apply(&mut self, team: &Team, r: &[f64], z: &mut [f64]);
}

/// Identity as a preconditioner, z = r.
#[derive(Clone, Copy, Debug, Default)]
pub struct Identity;

impl Preconditioner for Identity {
    fn apply(&mut self, team: &Team, r: &[f64], z: &mut [f64]) {
        update(team, z, |start, piece| {
            piece.copy_from_slice(&r[start..start + piece.len()]);
            []
        });
    }
}

/// Jacobi preconditioner, z = D^-1 r with the diagonal D; z = r where the diagonal is zero.
#[derive(Clone, Debug)]
pub struct Jacobi {
    inverse: Vec<f64>,
}

impl Jacobi {
    /// Create the preconditioner of an operator with this diagonal.
    #[must_use]
    pub fn new(diagonal: &[f64]) -> Self {
        Jacobi { inverse: diagonal.iter().map(|d| if *d == 0.0 { 1.0 } else { 1.0 / d }).collect() }
    }
}

impl Preconditioner for Jacobi {
    fn apply(&mut self, team: &Team, r: &[f64], z: &mut [f64]) {
        let inverse = &self.inverse;
        update(team, z, |start, piece| {
            let end = start + piece.len();
            for (z, (r, d)) in piece.iter_mut().zip(r[start..end].iter().zip(&inverse[start..end])) {
                *z = r * d;
            }
            []
        });
    }
}
