//! Normals that are chosen at run time, so that a step is compiled once for all of them.

use mpm_contact::{Gradients, Memory, Nodal, NormalRule, Places, Regression};

/// A rule for the normal between two bodies.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Normals {
    /// From gradients of mass or volume.
    Gradients(Gradients),
    /// Of the plane that best tells the particles of both bodies apart.
    Regression,
}

impl<const D: usize> NormalRule<f64, D> for Normals {
    fn prepare(&self, at: &dyn Places<f64, D>, memory: &mut Memory<'_, f64>) {
        match self {
            Normals::Gradients(rule) => rule.prepare(at, memory),
            Normals::Regression => Regression.prepare(at, memory),
        }
    }
    fn normals(
        &self,
        at: &dyn Places<f64, D>,
        pair: [usize; 2],
        nodes: u64,
        memory: &Memory<'_, f64>,
        normals: &mut Nodal<[f64; 3]>,
    ) -> u64 {
        match self {
            Normals::Gradients(rule) => rule.normals(at, pair, nodes, memory, normals),
            Normals::Regression => NormalRule::normals(&Regression, at, pair, nodes, memory, normals),
        }
    }
}
