//! Operator of the pressure with free rigid bodies: that of the liquid alone, and a term of low rank.

use impactite_simd::Team;
use impactite_solve::Operator;

/// Sparse column c of the term c c^T of an operator: places and values.
pub(crate) type Column = Vec<(u32, f64)>;

/// Operator A + sum c c^T.
pub(crate) struct Coupled<'a, A> {
    pub alone: &'a A,
    pub columns: &'a [Column],
}

impl<A: Operator> Operator for Coupled<'_, A> {
    fn len(&self) -> usize {
        self.alone.len()
    }
    fn apply(&self, team: &Team, x: &[f64], y: &mut [f64]) {
        self.alone.apply(team, x, y);
        for column in self.columns {
            let sum: f64 = column.iter().map(|(at, c)| c * x[*at as usize]).sum();
            column.iter().for_each(|(at, c)| y[*at as usize] += c * sum);
        }
    }
    fn nullity(&self) -> usize {
        self.alone.nullity()
    }
    fn unreachable(&self, team: &Team, b: &[f64]) -> Option<usize> {
        self.alone.unreachable(team, b)
    }
    fn project(&self, team: &Team, x: &mut [f64]) {
        self.alone.project(team, x);
    }
}
