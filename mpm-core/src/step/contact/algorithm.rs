//! Interface of contact algorithms.

use std::sync::Arc;

use super::found::{BlockContacts, Scratch};
use super::shared_nodes::SharedNodes;
use crate::contact::solve_planes;
use crate::step::PlaneTouch;
use impactite_simd::Float;

/// Contact of bodies at shared nodes: [`GridContact`](crate::GridContact); [`OneField`] has none.
#[diagnostic::on_unimplemented(
    message = "`{Self}` is not a contact algorithm",
    note = "`Mpm::with_contact` takes a `GridContact`, or `OneField`"
)]
pub trait ContactAlgorithm<T: Float, const D: usize>: std::fmt::Debug + Send + Sync + 'static {
    /// True if every body has its own velocities at shared nodes.
    fn separates(&self) -> bool {
        true
    }
    /// True if contact also corrects the velocities that only the strain uses: those of the mapped momentum with USF, those
    /// mapped a second time with MUSL. (Violates the energy balance: book, "Contact on the grid".)
    fn corrects_strain(&self) -> bool {
        false
    }
    /// Largest motion of bodies, m, before their [`BlockContacts`] are discarded, for cells of `spacing`, m. Zero: in every
    /// step.
    fn keeps(&self, _spacing: f64) -> f64 {
        0.0
    }
    /// Number of state variables of a contact; see [`SharedNodes::recall`]. Zero: none, at no cost.
    fn remembers(&self) -> usize {
        0
    }
    /// Update contacts and impulses at the shared nodes of a block. The result must depend only on `at` and on the previous
    /// contacts.
    fn impulses(&self, at: &SharedNodes<'_, T, D>, found: &mut BlockContacts<T>, scratch: &mut Scratch<T>);
    /// Solve for further impulses: those on free rigid bodies, which couple all blocks, and those of the planes in contact
    /// with them. Called if the scene has rigid bodies, with every block after [`ContactAlgorithm::impulses`]. By default
    /// only the planes act.
    fn couple(
        &self,
        _at: &[SharedNodes<'_, T, D>],
        _found: &mut [BlockContacts<T>],
        planes: &mut [PlaneTouch<'_, D>],
    ) {
        solve_planes::<T, D>(planes);
    }
}

/// One velocity field for all bodies: they stick on contact. No cost.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct OneField;

impl<T: Float, const D: usize> ContactAlgorithm<T, D> for OneField {
    fn separates(&self) -> bool {
        false
    }
    fn impulses(&self, _: &SharedNodes<'_, T, D>, _: &mut BlockContacts<T>, _: &mut Scratch<T>) {}
}

/// Contact algorithm selected at run time.
impl<T: Float, const D: usize> ContactAlgorithm<T, D> for Arc<dyn ContactAlgorithm<T, D>> {
    fn separates(&self) -> bool {
        (**self).separates()
    }
    fn corrects_strain(&self) -> bool {
        (**self).corrects_strain()
    }
    fn keeps(&self, spacing: f64) -> f64 {
        (**self).keeps(spacing)
    }
    fn remembers(&self) -> usize {
        (**self).remembers()
    }
    fn impulses(&self, at: &SharedNodes<'_, T, D>, found: &mut BlockContacts<T>, scratch: &mut Scratch<T>) {
        (**self).impulses(at, found, scratch);
    }
    fn couple(
        &self,
        at: &[SharedNodes<'_, T, D>],
        found: &mut [BlockContacts<T>],
        planes: &mut [PlaneTouch<'_, D>],
    ) {
        (**self).couple(at, found, planes);
    }
}
