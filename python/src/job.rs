//! Runs in folders, as made by the program `impactite`.

use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use impactite_cli::sweep::{Values, chart as draw};
use impactite_cli::{Job, ProgressState, SharedProgress};
use pyo3::exceptions::{PyRuntimeError, PyValueError};
use pyo3::prelude::*;

use crate::background;
use crate::error::{Failed, with_warnings};
use crate::scene::Scene;
use crate::value::toml;

/// Options of a job.
#[derive(FromPyObject)]
pub struct How {
    #[pyo3(item)]
    threads: Option<usize>,
    #[pyo3(item)]
    checkpoint: f64,
    /// None: value of the checkpoint.
    #[pyo3(item)]
    pictures: Option<bool>,
    #[pyo3(item)]
    report: Option<bool>,
}

/// Outcome of a job as JSON, and warnings of the job.
type Told = (String, Vec<String>);

/// Run a job. `shown` is called with time, end, steps, rate and energy error at every check for signals and at the end.
fn perform(py: Python<'_>, job: Job, how: &How, shown: Option<&Bound<'_, PyAny>>) -> PyResult<Told> {
    let seconds = how.checkpoint;
    if !(0.0..=1e9).contains(&seconds) {
        let why = format!("checkpoint = {seconds} s is not allowed; it must be from 0 to 1e9");
        return Err(PyValueError::new_err(why));
    }
    let (stop, advance) = (Arc::new(AtomicBool::new(false)), Arc::new(SharedProgress::default()));
    let job = Job {
        threads: how.threads,
        checkpoint: Duration::from_secs_f64(seconds),
        pictures: how.pictures.unwrap_or(job.pictures),
        report: how.report.unwrap_or(job.report),
        advance: Some(advance.clone()),
        ..job
    };
    let stopping = stop.clone();
    let show = || {
        let ProgressState { time, end, steps, rate, energy_error } = advance.stand();
        match shown {
            Some(shown) if end > 0.0 => shown.call1((time, end, steps, rate, energy_error)).map(drop),
            _ => Ok(()),
        }
    };
    let outcome = background::run(
        py,
        move || job.run(&stopping),
        |_| show(),
        || {
            stop.store(true, Ordering::SeqCst);
            // Set-up writes no file and is abandoned.
            advance.begun()
        },
    )?;
    let outcome = outcome.map_err(|error| with_warnings(error.into(), advance.warnings()))?;
    // Progress at the end of the run.
    show()?;
    let told = serde_json::to_string(&outcome).map_err(|error| PyRuntimeError::new_err(error.to_string()))?;
    Ok((told, advance.warnings()))
}

/// Run a scene in a folder.
#[pyfunction]
#[pyo3(signature = (scene, folder, how, shown=None))]
pub fn run(
    py: Python<'_>,
    scene: &Bound<'_, Scene>,
    folder: PathBuf,
    how: How,
    shown: Option<&Bound<'_, PyAny>>,
) -> PyResult<Told> {
    perform(py, Job::new(scene.get().source().clone(), folder), &how, shown)
}

/// Go on with the run in a folder, with other values of keys that no step depends on.
#[pyfunction]
#[pyo3(signature = (folder, how, shown=None, set=Vec::new()))]
pub fn resume(
    py: Python<'_>,
    folder: PathBuf,
    how: How,
    shown: Option<&Bound<'_, PyAny>>,
    set: Vec<(String, Bound<'_, PyAny>)>,
) -> PyResult<Told> {
    let assignments = set.iter().map(|(key, value)| Ok(format!("{key}={}", toml(key, value)?)));
    let assignments = assignments.collect::<PyResult<Vec<String>>>()?;
    let job = Job::resume(folder).and_then(|job| job.set(&assignments)).map_err(Failed::from)?;
    perform(py, job, &how, shown)
}

/// Draw measures (name, unit, values) over the values of a key into the file `path`; false, and no file, where the values are no numbers.
#[pyfunction]
pub fn chart(
    path: PathBuf,
    title: &str,
    key: String,
    values: Vec<Bound<'_, PyAny>>,
    measures: Vec<(String, String, Vec<f64>)>,
) -> PyResult<bool> {
    let list = values.iter().map(|value| toml(&key, value)).collect::<PyResult<_>>()?;
    let drawn = draw(title, &Values { key, list }, &measures).map_err(Failed::from)?;
    let Some(picture) = drawn else { return Ok(false) };
    picture.save(path).map_err(|error| Failed::Job(error.into()))?;
    Ok(true)
}
