//! What the step asks of a contact algorithm.

use std::sync::Arc;

use super::{BlockContacts, SharedNodes};
use crate::parallel::Float;

/// What bodies do to each other at the nodes they share: [`GridContact`](crate::GridContact); [`OneField`] is none.
#[diagnostic::on_unimplemented(
    message = "`{Self}` is not a contact algorithm",
    note = "`Mpm::with_contact` takes a `GridContact`, or `OneField`"
)]
pub trait Contact<T: Float, const D: usize>: std::fmt::Debug + Send + Sync + 'static {
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
    /// Further impulses, those on free rigid bodies, which couple all blocks; called where the scene has any, with
    /// every block and what [`Contact::impulses`] left of it.
    fn couple(&self, _at: &[SharedNodes<'_, T, D>], _found: &mut [BlockContacts<T>]) {}
}

/// One velocity field for all bodies: they stick where they touch. Costs nothing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct OneField;

impl<T: Float, const D: usize> Contact<T, D> for OneField {
    fn separates(&self) -> bool {
        false
    }
    fn impulses(&self, _: &SharedNodes<'_, T, D>, _: &mut BlockContacts<T>, _: &mut Scratch<T>) {}
}

/// One that was chosen at run time.
impl<T: Float, const D: usize> Contact<T, D> for Arc<dyn Contact<T, D>> {
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
    fn couple(&self, at: &[SharedNodes<'_, T, D>], found: &mut [BlockContacts<T>]) {
        (**self).couple(at, found);
    }
}

/// Which velocities contact acts on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ContactPhase {
    /// Those of the mapped momentum, before the stress update of USF.
    Momentum,
    /// The trial velocities of the momentum update: every body moved by its own forces.
    Trial,
    /// Those mapped a second time (MUSL).
    Remapped,
}

/// Memory of a thread for contact algorithms: nothing in it lasts.
#[derive(Clone, Debug)]
pub struct Scratch<T> {
    /// Numbers of nodes.
    pub numbers: Vec<[T; 4]>,
    /// Sets of nodes, a bit each.
    pub bits: Vec<u64>,
    /// Vectors of pairs, two each.
    pub vectors: Vec<[[T; 3]; 3]>,
}

impl<T> Default for Scratch<T> {
    fn default() -> Self {
        Scratch { numbers: Vec::new(), bits: Vec::new(), vectors: Vec::new() }
    }
}

impl<T> Scratch<T> {
    /// Bytes of its memory.
    pub(in crate::step) fn bytes(&self) -> usize {
        self.numbers.capacity() * size_of::<[T; 4]>()
            + self.bits.capacity() * size_of::<u64>()
            + self.vectors.capacity() * size_of::<[[T; 3]; 3]>()
    }
}
