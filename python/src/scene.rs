//! Scenes: texts that were read and found to be one.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use impactite_input::{SceneFile, Source, measured};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyType};
use serde::Serialize;

use crate::error::Failed;
use crate::running::Running;
use crate::simulation::Simulation;

/// A scene: bodies of materials, how they are computed, what acts on them, how long.
///
/// Made of a dict, or by `Scene.from_file` and `Scene.from_toml`, of the keys of scene files. Quantities are numbers in SI units or
/// texts with units. `set` changes keys: `{"parameters.speed": "227 m/s"}`. Files that the scene names are looked for in `folder`.
///
/// Raises `SceneError` for what is wrong, with its place. A dict is read as the TOML text that `text` shows.
#[pyclass(frozen, module = "impactite")]
pub struct Scene {
    source: Source,
    file: Arc<SceneFile>,
}

impl Scene {
    /// The text, changed where `set` says so, and read.
    fn read(py: Python<'_>, mut source: Source, set: Option<&Bound<'_, PyDict>>) -> PyResult<Self> {
        for (key, value) in set.into_iter().flatten() {
            source = source.set(&assignment(&key, &value)?).map_err(Failed::from)?;
        }
        py.detach(|| {
            let file = source.parse()?;
            Ok(Scene { source, file: Arc::new(file) })
        })
        .map_err(|error: Failed| error.into())
    }

    /// Its text.
    pub fn source(&self) -> &Source {
        &self.source
    }
}

#[pymethods]
impl Scene {
    #[new]
    #[pyo3(signature = (tree, *, set=None, folder=None))]
    fn new(
        tree: &Bound<'_, PyDict>,
        set: Option<&Bound<'_, PyDict>>,
        folder: Option<PathBuf>,
    ) -> PyResult<Self> {
        let source = Source::from_json(named(folder, "<dict>"), &json(tree)?).map_err(Failed::from)?;
        Scene::read(tree.py(), source, set)
    }

    /// The scene of a file: TOML, or JSON if its name ends with `.json`.
    #[classmethod]
    #[pyo3(signature = (path, *, set=None))]
    fn from_file(
        class: &Bound<'_, PyType>,
        path: PathBuf,
        set: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Self> {
        Scene::read(class.py(), Source::read(path).map_err(Failed::from)?, set)
    }

    /// The scene of a TOML text.
    #[classmethod]
    #[pyo3(signature = (text, *, set=None, folder=None))]
    fn from_toml(
        class: &Bound<'_, PyType>,
        text: &str,
        set: Option<&Bound<'_, PyDict>>,
        folder: Option<PathBuf>,
    ) -> PyResult<Self> {
        Scene::read(class.py(), Source::new(named(folder, "<text>"), text), set)
    }

    /// The same scene with other values of some keys; this one stays as it is.
    fn changed(&self, py: Python<'_>, set: &Bound<'_, PyDict>) -> PyResult<Self> {
        Scene::read(py, self.source.clone(), Some(set))
    }

    /// The scene set up, ready to step on so many threads (all processors if none are given). Results are the same bits for any number.
    #[pyo3(signature = (*, threads=None))]
    fn simulation(&self, py: Python<'_>, threads: Option<usize>) -> PyResult<Simulation> {
        let running = py.detach(|| Running::new(&self.source, self.file.clone(), threads))?;
        Ok(Simulation::new(running))
    }

    /// Its title.
    #[getter]
    fn title(&self) -> &str {
        &self.file.title
    }
    /// What it says of itself.
    #[getter]
    fn description(&self) -> &str {
        &self.file.description
    }
    /// "3d", "plane strain", "plane stress" or "axisymmetric".
    #[getter]
    fn space(&self) -> &'static str {
        self.file.space.name()
    }
    /// When it ends, s.
    #[getter]
    fn end(&self) -> f64 {
        self.file.end.value
    }
    /// Its text, in TOML.
    #[getter]
    fn text(&self) -> &str {
        &self.source.text
    }
    /// Its parameters in SI units, by name.
    #[getter]
    fn parameters<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let all = PyDict::new(py);
        self.file.known.numbers().iter().try_for_each(|(name, value)| all.set_item(name, value))?;
        Ok(all)
    }
    /// SI units of its measures, by name; "-" of plain numbers.
    #[getter]
    fn measures<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let all = PyDict::new(py);
        measured::columns(&self.file).iter().try_for_each(|(name, unit)| all.set_item(name, unit))?;
        Ok(all)
    }

    fn __repr__(&self) -> String {
        format!(
            "<impactite.Scene {:?}, {}, {} s>",
            self.file.title,
            self.file.space.name(),
            self.file.end.value
        )
    }
}

/// What errors call a scene that is no file; its folder is where files that it names are.
fn named(folder: Option<PathBuf>, name: &str) -> String {
    folder.as_deref().unwrap_or(Path::new("")).join(name).display().to_string()
}

/// An object as JSON. Arrays and numbers of NumPy are lists and numbers, paths are texts.
fn json(object: &Bound<'_, PyAny>) -> PyResult<String> {
    let py = object.py();
    let options = PyDict::new(py);
    options.set_item("default", wrap_pyfunction!(plain, py)?)?;
    options.set_item("allow_nan", false)?;
    py.import("json")?.call_method("dumps", (object,), Some(&options))?.extract()
}

/// What JSON has a kind for, of what it has none for.
#[pyfunction]
fn plain<'py>(object: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
    if object.hasattr("tolist")? {
        return object.call_method0("tolist");
    }
    if object.hasattr("__fspath__")? {
        return object.call_method0("__fspath__");
    }
    let kind = object.get_type().name()?;
    Err(PyTypeError::new_err(format!(
        "a scene holds dicts, lists, texts, numbers and truth values, not {kind}"
    )))
}

/// `KEY=VALUE`, the value in TOML.
fn assignment(key: &Bound<'_, PyAny>, value: &Bound<'_, PyAny>) -> PyResult<String> {
    let key: String = key.extract()?;
    Ok(format!("{key}={}", toml(&key, value)?))
}

/// The value of a key, in TOML.
pub fn toml(key: &str, value: &Bound<'_, PyAny>) -> PyResult<String> {
    let wrong = |why: &dyn std::fmt::Display| PyValueError::new_err(format!("set: {key}: {why}"));
    let value: serde_json::Value = serde_json::from_str(&json(value)?).map_err(|e| wrong(&e))?;
    let value = value.serialize(toml_edit::ser::ValueSerializer::new()).map_err(|e| wrong(&e))?;
    Ok(value.to_string())
}
