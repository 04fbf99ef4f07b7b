//! What the step asks of a contact algorithm.

use std::sync::Arc;

use super::found::{BlockContacts, Scratch};
use super::shared_nodes::SharedNodes;
use crate::contact::solve_planes;
use crate::step::PlaneTouch;
use impactite_simd::Float;

/// What bodies do to each other at the nodes they share: [`GridContact`](crate::GridContact); [`OneField`] is none.
#[diagnostic::on_unimplemented(
    message = "`{Self}` is not a contact algorithm",
    note = "`Mpm::with_contact` takes a `GridContact`, or `OneField`"
)]
pub trait ContactAlgorithm<T: Float, const D: usize>: std::fmt::Debug + Send + Sync + 'static {
    /// Does every body have velocities of its own at the nodes it shares with others?
    fn separates(&self) -> bool {
        true
    }
    /// Is contact also made in the velocities that only the strain is taken from: those of the mapped momentum
    /// with USF, those mapped a second time with MUSL? (Costs energy its balance: book, "Contact on the grid".)
    fn corrects_strain(&self) -> bool {
        false
    }
    /// How far bodies may move, m, before what [`BlockContacts`] know of them is forgotten, for cells of `spacing`, m. Zero:
    /// in every step.
    fn keeps(&self, _spacing: f64) -> f64 {
        0.0
    }
    /// How many numbers contacts remember from step to step; see [`SharedNodes::recall`]. Zero: none, at no cost.
    fn remembers(&self) -> usize {
        0
    }
    /// Bring what is found up to date at the nodes of a block that several bodies share: who touches where, and the
    /// impulses. Must depend on what `at` shows and on what was found before alone.
    fn impulses(&self, at: &SharedNodes<'_, T, D>, found: &mut BlockContacts<T>, scratch: &mut Scratch<T>);
    /// Further impulses, those on free rigid bodies, which couple all blocks, and those of the planes that such bodies touch; called
    /// where the scene has any, with every block and what [`ContactAlgorithm::impulses`] left of it. Without more only the
    /// planes act.
    fn couple(
        &self,
        _at: &[SharedNodes<'_, T, D>],
        _found: &mut [BlockContacts<T>],
        planes: &mut [PlaneTouch<'_, D>],
    ) {
        solve_planes::<T, D>(planes);
    }
}

/// One velocity field for all bodies: they stick where they touch. Costs nothing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct OneField;

impl<T: Float, const D: usize> ContactAlgorithm<T, D> for OneField {
    fn separates(&self) -> bool {
        false
    }
    fn impulses(&self, _: &SharedNodes<'_, T, D>, _: &mut BlockContacts<T>, _: &mut Scratch<T>) {}
}

/// One that was chosen at run time.
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
