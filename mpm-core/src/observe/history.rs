//! Any numbers, as CSV.

use std::path::Path;

use super::{Moment, ObserveError, Observer, Pace};
use crate::output::{Column, History};
use crate::parallel::Float;

/// Writes numbers of one's own choice, one row a moment, into a CSV file that can be watched while the run goes
/// on.
///
/// ```
/// use mpm_core::observe::{HistoryCsv, Moment, Pace};
/// # let folder = std::env::temp_dir().join("impactite-doc-observe");
/// # std::fs::create_dir_all(&folder).unwrap();
/// let columns = [("time", "s"), ("kinetic energy", "J")];
/// let kinetic = HistoryCsv::create(
///     folder.join("kinetic.csv"),
///     columns,
///     Pace::interval(1.0e-6)?,
///     |now: &Moment<'_, f64, 3>| Ok(vec![now.time(), now.totals().kinetic]),
/// )?;
/// # Ok::<(), mpm_core::observe::ObserveError>(())
/// ```
pub struct HistoryCsv<F> {
    pace: Pace,
    file: History,
    measure: F,
}

impl<F> HistoryCsv<F> {
    /// Write what `measure` returns, a number for each of `columns` (name, unit), into the file at `path`.
    ///
    /// # Errors
    /// Bad column names, or a file that cannot be created.
    pub fn create<T: Float, const D: usize, C: Into<Column>>(
        path: impl AsRef<Path>,
        columns: impl IntoIterator<Item = C>,
        pace: Pace,
        measure: F,
    ) -> Result<Self, ObserveError>
    where
        F: FnMut(&Moment<'_, T, D>) -> Result<Vec<f64>, ObserveError>,
    {
        Ok(HistoryCsv { pace, file: History::create(path, columns)?, measure })
    }
}

impl<T, const D: usize, F> Observer<T, D> for HistoryCsv<F>
where
    T: Float,
    F: FnMut(&Moment<'_, T, D>) -> Result<Vec<f64>, ObserveError>,
{
    fn pace(&mut self) -> &mut Pace {
        &mut self.pace
    }
    fn observe(&mut self, now: &Moment<'_, T, D>) -> Result<(), ObserveError> {
        let row = (self.measure)(now)?;
        Ok(self.file.push(&row)?)
    }
}
