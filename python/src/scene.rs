//! Python class of a scene: a text that was parsed and validated.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use impactite_input::{SceneFile, Source, measured};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyType};

use crate::background;
use crate::error::Failed;
use crate::running::Running;
use crate::simulation::Simulation;
use crate::value;

/// A scene: bodies of materials, how they are computed, what acts on them, how long.
///
/// Made of a dict, or by `Scene.from_file` and `Scene.from_toml`, of the keys of scene files. Quantities are numbers in SI units or
/// texts with units. `set` changes keys: `{"parameters.speed": "227 m/s"}`. Files that the scene names are looked for in `folder`.
///
/// Raises `SceneError` for what is wrong, with its place. A dict is read as the TOML text that `text` shows. Scenes can be pickled.
#[pyclass(frozen, module = "impactite")]
pub struct Scene {
    source: Source,
    file: Arc<SceneFile>,
}

impl Scene {
    /// Parse a text with the changes of `set`.
    fn read(py: Python<'_>, source: Source, set: Option<&Bound<'_, PyDict>>) -> PyResult<Self> {
        let source = value::changed(source, set)?;
        py.detach(|| {
            let file = source.parse()?;
            Ok(Scene { source, file: Arc::new(file) })
        })
        .map_err(|error: Failed| error.into())
    }

    /// Text of the scene.
    pub fn source(&self) -> &Source {
        &self.source
    }
}

#[pymethods]
impl Scene {
    #[new]
    #[pyo3(signature = (tree, *, set=None, folder=None))]
    fn new(
        tree: &Bound<'_, PyAny>,
        set: Option<&Bound<'_, PyDict>>,
        folder: Option<PathBuf>,
    ) -> PyResult<Self> {
        let source =
            Source::from_json(named(folder, "<dict>"), &value::scene(tree)?).map_err(Failed::from)?;
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
        let (source, file) = (self.source.clone(), self.file.clone());
        let set_up = move || Running::new(&source, file, threads);
        // An interrupted set-up is abandoned.
        Ok(Simulation::new(background::run(py, set_up, |_| Ok(()), || false)??))
    }

    /// Run the scene to its end in the folder `out`: `impactite.run(scene, out, ...)`, with its options.
    #[pyo3(signature = (out=None, **options))]
    fn run<'py>(
        slf: &Bound<'py, Self>,
        out: Option<Bound<'py, PyAny>>,
        options: Option<&Bound<'py, PyDict>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        slf.py().import("impactite")?.call_method("run", (slf, out), options)
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

    /// Scene of a pickle: its name in messages, its text.
    #[classmethod]
    fn _of(class: &Bound<'_, PyType>, name: String, text: String) -> PyResult<Self> {
        Scene::read(class.py(), Source::new(name, text), None)
    }
    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<(Bound<'py, PyAny>, (String, String))> {
        let Source { name, text, .. } = slf.get().source.clone();
        Ok((slf.get_type().getattr("_of")?, (name, text)))
    }
    // Scenes are immutable.
    fn __copy__(slf: Py<Self>) -> Py<Self> {
        slf
    }
    fn __deepcopy__(slf: Py<Self>, _memo: &Bound<'_, PyAny>) -> Py<Self> {
        slf
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

/// Return the name of a scene without a file, for errors; its folder is the base of the files that the scene names.
fn named(folder: Option<PathBuf>, name: &str) -> String {
    folder.as_deref().unwrap_or(Path::new("")).join(name).display().to_string()
}
