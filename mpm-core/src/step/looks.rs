//! What a run remembers of looks at it.

use impactite_scene::Totals;
use impactite_scene::watch::Watcher;

use super::cells::Cells;

/// What a run remembers of its looks.
#[derive(Clone, Debug, Default)]
pub(super) struct Looks<const D: usize> {
    pub(super) watcher: Watcher,
    /// Parts of each body at the first look.
    pub(super) parts: Vec<u64>,
    pub(super) cells: Option<Cells<D>>,
    pub(super) totals: Vec<Totals>,
}

impl<const D: usize> Looks<D> {
    /// Open the balance anew with the next step, as bodies came.
    pub(super) fn reopen(&mut self) {
        self.watcher.reopen();
        *self = Looks { watcher: std::mem::take(&mut self.watcher), ..Looks::default() };
    }
    pub(super) fn bytes(&self) -> usize {
        self.cells.as_ref().map_or(0, Cells::bytes) + self.totals.capacity() * size_of::<Totals>()
    }
}
