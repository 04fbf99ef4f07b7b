//! Python exceptions for errors: built-in classes where they fit, else `SceneError` and `RunError`.

use std::path::Path;

use impactite::scene::{CheckpointError, RunError as Broken, StepError, Stopped};
use impactite_cli::CliError;
use impactite_input::measured::MeasureError;
use impactite_input::{Fault, InputError, shown};
use pyo3::exceptions::{PyOSError, PyRuntimeError, PyValueError};
use pyo3::prelude::*;

pyo3::create_exception!(
    impactite,
    SceneError,
    PyValueError,
    "What is wrong with a scene. The message shows its place; `file`, `line`, `column`, `key`, `reason` and `help` have the parts, \
     None where there is none."
);
pyo3::create_exception!(
    impactite,
    RunError,
    PyRuntimeError,
    "A run that cannot go on. `step` and `time` (s) say when; `body`, `number` and `position` (m) which point stopped it, None where \
     none did; `warnings` are those of a run in a folder."
);

/// Add the exceptions; attributes are None by default.
pub fn add_to(module: &Bound<'_, PyModule>) -> PyResult<()> {
    let none = module.py().None();
    let (scene, run) = (module.py().get_type::<SceneError>(), module.py().get_type::<RunError>());
    for name in ["file", "line", "column", "key", "reason", "help"] {
        scene.setattr(name, &none)?;
    }
    for name in ["step", "time", "body", "number", "position", "warnings"] {
        run.setattr(name, &none)?;
    }
    module.add("SceneError", scene)?;
    module.add("RunError", run)
}

/// Error of a call, created without the interpreter lock (GIL) and converted to an exception later.
#[derive(Debug)]
pub enum Failed {
    /// Invalid scene.
    Input(InputError),
    /// Failed step.
    Step(StepError),
    /// Failed checkpoint.
    Checkpoint(std::path::PathBuf, CheckpointError),
    /// Failed job.
    Job(CliError),
    /// Failed measure.
    Measure(MeasureError),
    /// Invalid value.
    Value(String),
    /// Unusable simulation.
    Unusable(String),
}

impl From<InputError> for Failed {
    fn from(error: InputError) -> Self {
        Failed::Input(error)
    }
}
impl From<StepError> for Failed {
    fn from(error: StepError) -> Self {
        Failed::Step(error)
    }
}
impl From<MeasureError> for Failed {
    fn from(error: MeasureError) -> Self {
        Failed::Measure(error)
    }
}
impl From<CliError> for Failed {
    fn from(error: CliError) -> Self {
        Failed::Job(error)
    }
}

impl From<Failed> for PyErr {
    fn from(failed: Failed) -> Self {
        match failed {
            Failed::Input(error) | Failed::Job(CliError::Input(error)) => input(&error),
            Failed::Step(error) | Failed::Job(CliError::Run(Broken::Step(error))) => step(&error),
            Failed::Job(CliError::File { path, source }) => file(&path, &source),
            Failed::Job(error @ CliError::Option { .. }) => PyValueError::new_err(error.to_string()),
            Failed::Measure(error) => SceneError::new_err(error.to_string()),
            Failed::Job(error) => RunError::new_err(shown(&error.to_string())),
            Failed::Checkpoint(path, error) => RunError::new_err(format!("`{}`: {error}", path.display())),
            Failed::Value(why) => PyValueError::new_err(why),
            Failed::Unusable(why) => RunError::new_err(why),
        }
    }
}

/// Return `FileNotFoundError` or another `OSError`, with the name of the file.
fn file(path: &Path, error: &std::io::Error) -> PyErr {
    let path = path.display().to_string();
    match error.raw_os_error() {
        // Python selects the class by the number and makes the message of all three.
        Some(number) => {
            let said = error.to_string();
            let said = said.split(" (os error").next().unwrap_or_default().to_string();
            PyOSError::new_err((number, said, path))
        }
        None => PyOSError::new_err(format!("`{path}`: {error}")),
    }
}

fn input(error: &InputError) -> PyErr {
    match error {
        InputError::Read { path, source } => file(path, source),
        InputError::At(fault) => at(fault),
        InputError::Set { assignment, why } => SceneError::new_err(format!("set: {assignment}: {why}")),
        // The enumeration is non-exhaustive.
        other => SceneError::new_err(other.to_string()),
    }
}

/// Return the exception of a failed run; a `RunError` has the warnings as attribute.
pub fn with_warnings(failed: Failed, warnings: Vec<String>) -> PyErr {
    let error = PyErr::from(failed);
    let broke = Python::attach(|py| error.is_instance_of::<RunError>(py));
    if broke { with(error, |value| value.setattr("warnings", warnings)) } else { error }
}

/// Return a `SceneError` for a Python value at a key.
pub fn refused(message: String, key: &str, reason: &str, help: Option<&str>) -> PyErr {
    with(SceneError::new_err(message), |value| {
        value.setattr("key", Some(key).filter(|key| !key.is_empty()))?;
        value.setattr("reason", reason)?;
        value.setattr("help", help)
    })
}

/// Return the exception of a fault, with its place in the message and as attributes.
fn at(fault: &Fault) -> PyErr {
    let error = SceneError::new_err(fault.to_string());
    with(error, |value| {
        value.setattr("file", &fault.file)?;
        value.setattr("line", fault.line)?;
        value.setattr("column", fault.line.map(|_| fault.column))?;
        value.setattr("key", Some(&fault.key).filter(|key| !key.is_empty()))?;
        value.setattr("reason", &fault.message)?;
        value.setattr("help", &fault.help)
    })
}

fn step(error: &StepError) -> PyErr {
    let (body, number, position) = match &error.what {
        Stopped::Point { body, number, position, .. } => (Some(body), Some(*number), Some(*position)),
        Stopped::Outside { body, particle, position, .. } => (Some(body), Some(*particle), Some(*position)),
        _ => (None, None, None),
    };
    with(RunError::new_err(shown(&error.to_string())), |value| {
        value.setattr("step", error.step)?;
        value.setattr("time", error.time)?;
        value.setattr("body", body)?;
        value.setattr("number", number)?;
        value.setattr("position", position.map(|[x, y, z]| (x, y, z)))
    })
}

/// Set attributes of an exception and return it; if that fails, return the exception raised by Python.
fn with(error: PyErr, set: impl FnOnce(&Bound<'_, PyAny>) -> PyResult<()>) -> PyErr {
    Python::attach(|py| match set(error.value(py)) {
        Ok(()) => error,
        Err(other) => other,
    })
}
