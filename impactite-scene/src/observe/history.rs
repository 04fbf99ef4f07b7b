//! CSV history of custom quantities.

use std::path::Path;

use crate::archive::{Archive, CheckpointError};

use super::{ObserveError, Observer, Pace, RunView};
use impactite_output::{Column, History};

/// Observer that writes custom quantities, one row per observation, into a CSV file that can be read during the run.
///
/// ```
/// use impactite_scene::observe::{HistoryCsv, Pace, RunView};
/// # let folder = std::env::temp_dir().join("impactite-doc-observe");
/// # std::fs::create_dir_all(&folder).unwrap();
/// let columns = [("time", "s"), ("kinetic energy", "J")];
/// let kinetic = HistoryCsv::create(
///     folder.join("kinetic.csv"),
///     columns,
///     Pace::interval(1.0e-6)?,
///     |now: &RunView<'_>| Ok(vec![now.time(), now.totals().kinetic]),
/// )?;
/// # Ok::<(), impactite_scene::observe::ObserveError>(())
/// ```
pub struct HistoryCsv<F> {
    pace: Pace,
    file: History,
    rows: Vec<Vec<f64>>,
    measure: F,
}

impl<F> HistoryCsv<F> {
    /// Create the file at `path`. `measure` returns one number for each of `columns` (name, unit).
    ///
    /// # Errors
    /// Bad column names, or a file that cannot be created.
    pub fn create<C: Into<Column>>(
        path: impl AsRef<Path>,
        columns: impl IntoIterator<Item = C>,
        pace: Pace,
        measure: F,
    ) -> Result<Self, ObserveError>
    where
        F: FnMut(&RunView<'_>) -> Result<Vec<f64>, ObserveError>,
    {
        Ok(HistoryCsv { pace, file: History::create(path, columns)?, rows: Vec::new(), measure })
    }

    /// Rows in order of time.
    #[must_use]
    pub fn rows(&self) -> &[Vec<f64>] {
        &self.rows
    }
}

impl<F> Observer for HistoryCsv<F>
where
    F: FnMut(&RunView<'_>) -> Result<Vec<f64>, ObserveError>,
{
    fn pace(&mut self) -> &mut Pace {
        &mut self.pace
    }
    fn observe(&mut self, now: &RunView<'_>) -> Result<(), ObserveError> {
        let row = (self.measure)(now)?;
        self.file.push(&row)?;
        self.rows.push(row);
        Ok(())
    }
    /// Write or read the rows. A state of `measure` is not saved.
    fn archive(&mut self, file: &mut Archive) -> Result<(), CheckpointError> {
        file.list(&mut self.rows, &Vec::new(), |file, row| file.list(row, &0.0, Archive::real))?;
        if file.reads() {
            self.rows.iter().try_for_each(|row| self.file.push(row))?;
        }
        Ok(())
    }
}
