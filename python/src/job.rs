//! Whole runs in folders, as the program `impactite` makes them.

use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc;
use std::time::Duration;

use impactite_cli::sweep::{Point, Values, sweep as vary};
use impactite_cli::{CliError, Job, Outcome};
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;

use crate::error::Failed;
use crate::scene::{Scene, toml};

/// How often Python is asked whether Ctrl-C was pressed.
const ASKED: Duration = Duration::from_millis(50);

/// How a job is done.
#[derive(FromPyObject)]
pub struct How {
    #[pyo3(item)]
    threads: Option<usize>,
    #[pyo3(item)]
    checkpoint: f64,
    #[pyo3(item)]
    pictures: bool,
    #[pyo3(item)]
    report: bool,
}

impl How {
    fn of(&self, job: Job) -> Result<Job, Failed> {
        let seconds = self.checkpoint;
        if !(0.0..=1e9).contains(&seconds) {
            return Err(Failed::Value(format!(
                "checkpoint = {seconds} s is not allowed; it must be from 0 to 1e9"
            )));
        }
        let checkpoint = Duration::from_secs_f64(seconds);
        Ok(Job { threads: self.threads, checkpoint, pictures: self.pictures, report: self.report, ..job })
    }
}

/// Do `work` while Python is free, and have it stop when Ctrl-C is pressed.
fn interruptible<R: Send>(
    py: Python<'_>,
    work: impl FnOnce(&AtomicBool) -> Result<R, CliError> + Send,
) -> PyResult<R> {
    let stop = AtomicBool::new(false);
    let (done, waits) = mpsc::channel::<()>();
    py.detach(move || {
        std::thread::scope(|scope| {
            let stop = &stop;
            let worker = scope.spawn(move || {
                // Dropped at its end, however that comes.
                let _done = done;
                work(stop)
            });
            let mut interrupted = None;
            while let Err(mpsc::RecvTimeoutError::Timeout) = waits.recv_timeout(ASKED) {
                if interrupted.is_none()
                    && let Err(signal) = Python::attach(|py| py.check_signals())
                {
                    stop.store(true, Ordering::Relaxed);
                    interrupted = Some(signal);
                }
            }
            let result = worker
                .join()
                .map_err(|_| PyRuntimeError::new_err("the run broke off; its thread said why"))?;
            // What the handler of the signal raised, be it Ctrl-C's or one's own.
            interrupted.map_or(result.map_err(|error| Failed::from(error).into()), Err)
        })
    })
}

fn told(outcome: &Outcome) -> PyResult<String> {
    serde_json::to_string(outcome).map_err(|error| PyRuntimeError::new_err(error.to_string()))
}

/// Run a scene in a folder; what came, as JSON.
#[pyfunction]
pub fn run(py: Python<'_>, scene: &Bound<'_, Scene>, folder: PathBuf, how: How) -> PyResult<String> {
    let job = how.of(Job::new(scene.get().source().clone(), folder))?;
    told(&interruptible(py, |stop| job.run(stop))?)
}

/// Go on with the run in a folder; what came, as JSON.
#[pyfunction]
pub fn resume(py: Python<'_>, folder: PathBuf, how: How) -> PyResult<String> {
    let job = how.of(Job::resume(folder).map_err(Failed::from)?)?;
    told(&interruptible(py, |stop| job.run(stop))?)
}

/// Run a scene for all combinations of values of keys, the last key's varying fastest: what came, as JSON, or what went wrong.
#[pyfunction]
pub fn sweep<'py>(
    py: Python<'py>,
    scene: &Bound<'py, Scene>,
    over: Vec<(String, Vec<Bound<'py, PyAny>>)>,
    folder: PathBuf,
    how: How,
) -> PyResult<Vec<(Option<String>, Option<String>)>> {
    let job = how.of(Job::new(scene.get().source().clone(), folder))?;
    let texts = |(key, values): (String, Vec<Bound<'py, PyAny>>)| {
        let list = values.iter().map(|value| toml(&key, value)).collect::<PyResult<_>>()?;
        Ok(Values { key, list })
    };
    let keys = over.into_iter().map(texts).collect::<PyResult<Vec<Values>>>()?;
    let points = interruptible(py, |stop| vary(&job, &keys, stop))?;
    let row = |point: Point| match &point.outcome {
        Ok(outcome) => Ok((Some(told(outcome)?), None)),
        Err(why) => Ok((None, Some(why.clone()))),
    };
    points.into_iter().map(row).collect()
}
