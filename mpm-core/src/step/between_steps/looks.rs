//! State of the balance checks of a run.

use impactite_scene::Totals;
use impactite_scene::watch::Watcher;

use super::cells::Cells;

/// State of the balance checks of a run.
#[derive(Clone, Debug, Default)]
pub(in crate::step) struct Looks<const D: usize> {
    pub(in crate::step) watcher: Watcher,
    /// Number of parts of each body at the first check.
    pub(in crate::step) parts: Vec<u64>,
    pub(in crate::step) cells: Option<Cells<D>>,
    pub(in crate::step) totals: Vec<Totals>,
}

impl<const D: usize> Looks<D> {
    /// Open the balance again with the next step, after bodies were added.
    pub(in crate::step) fn reopen(&mut self) {
        self.watcher.reopen();
        *self = Looks { watcher: std::mem::take(&mut self.watcher), ..Looks::default() };
    }
    pub(in crate::step) fn bytes(&self) -> usize {
        self.cells.as_ref().map_or(0, Cells::bytes) + self.totals.capacity() * size_of::<Totals>()
    }
}
