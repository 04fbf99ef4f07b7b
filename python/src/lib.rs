//! Extension module `impactite._impactite` of the Python package `impactite`.
//!
//! Classes and functions are documented for Python users: here by docstrings, and by types in `_impactite.pyi`.

mod background;
mod body;
mod error;
mod fields;
mod job;
mod running;
mod scene;
mod simulation;
mod value;

use impactite_cli::templates::TEMPLATES;
use impactite_input::list::Topic;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

/// The part of `impactite` that is compiled.
#[pymodule]
fn _impactite(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    error::add_to(module)?;
    module.add_class::<scene::Scene>()?;
    module.add_class::<simulation::Simulation>()?;
    module.add_class::<body::Body>()?;
    module.add_function(wrap_pyfunction!(job::run, module)?)?;
    module.add_function(wrap_pyfunction!(job::resume, module)?)?;
    module.add_function(wrap_pyfunction!(job::chart, module)?)?;
    module.add_function(wrap_pyfunction!(schema, module)?)?;
    module.add_function(wrap_pyfunction!(items, module)?)
}

/// The JSON Schema of scene files, as JSON.
#[pyfunction]
fn schema() -> String {
    impactite_input::schema().to_value().to_string()
}

/// Names of a topic with what they are and their options.
#[pyfunction]
fn items(topic: &str) -> PyResult<Vec<(String, String, Vec<String>)>> {
    if topic == "templates" {
        let line = |&(name, what, _): &(&str, &str, &str)| (name.into(), what.into(), Vec::new());
        return Ok(TEMPLATES.iter().map(line).collect());
    }
    let Some((known, _)) = Topic::ALL.iter().find(|(_, word)| *word == topic) else {
        let words: Vec<&str> = Topic::ALL.iter().map(|(_, word)| *word).collect();
        let why =
            format!("topic = {topic:?} is not allowed; it must be one of {}, templates", words.join(", "));
        return Err(PyValueError::new_err(why));
    };
    Ok(known.lines().into_iter().map(|line| (line.name, line.what, line.fields)).collect())
}
