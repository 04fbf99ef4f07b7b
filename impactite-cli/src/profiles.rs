//! Histories of profiles: a CSV file each.

use std::path::Path;

use impactite::observe::{HistoryCsv, ObserveError, Pace, RunView};
use impactite::output::Column;
use impactite::scene::Solver;
use impactite_input::SceneFile;
use impactite_input::measured::{profile_columns, profile_values};

use crate::CliError;
use crate::folder::PROFILES;

/// Default number of rows of a profile.
const ROWS: f64 = 40.0;

/// Evaluation of a profile: the time, and a value a bin.
pub(crate) type Evaluation = Box<dyn FnMut(&RunView<'_>) -> Result<Vec<f64>, ObserveError>>;

/// Create the files of the profiles of a scene: a row an instant, a column a bin.
///
/// # Errors
/// Field that the law of a body does not have; file that cannot be created.
pub(crate) fn histories(
    scene: &SceneFile,
    solver: &dyn Solver,
    folder: &Path,
) -> Result<Vec<HistoryCsv<Evaluation>>, CliError> {
    let folder = folder.join(PROFILES);
    if !scene.profiles.is_empty() {
        std::fs::create_dir_all(&folder).map_err(CliError::file(&folder))?;
    }
    let one = |(name, profile): (&String, &impactite_input::model::measure::Profile)| {
        profile_values(scene, name, profile, &RunView::of(solver)).map_err(said)?;
        let bins = profile_columns(profile);
        let bins = bins.iter().map(|(name, unit)| (name.as_str(), unit.as_str()));
        let columns: Vec<Column> = [("time", "s")].into_iter().chain(bins).map(Column::from).collect();
        let pace = Pace::interval(profile.every.map_or(scene.end.value / ROWS, |q| q.value))?;
        let (scene, name, profile) = (scene.clone(), name.clone(), profile.clone());
        let path = folder.join(format!("{name}.csv"));
        let evaluation: Evaluation = Box::new(move |now| {
            let values = profile_values(&scene, &name, &profile, now).map_err(said)?;
            Ok(std::iter::once(now.time()).chain(values).collect())
        });
        Ok(HistoryCsv::create(path, columns, pace, evaluation)?)
    };
    scene.profiles.iter().map(one).collect()
}

fn said(error: impactite_input::measured::ProfileError) -> ObserveError {
    ObserveError::Other(error.to_string())
}
