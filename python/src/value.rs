//! Conversion of Python values to values of a scene.

use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyByteArray, PyBytes, PyDict, PyFloat, PyInt, PyMapping, PySequence, PyString};
use serde::Serialize;
use serde_json::{Map, Number, Value};

use crate::error::refused;

/// Largest nesting depth of dicts and lists, below the recursion limits of the JSON and TOML parsers.
const LEVELS: usize = 64;
/// Largest number of characters of a key in a message.
const SHOWN: usize = 60;

/// Location of a value, for messages.
struct Place<'a> {
    /// Key of the whole value; empty for a scene.
    root: &'a str,
    /// Prefix of messages.
    from: &'static str,
    way: Vec<Step>,
}

enum Step {
    Key(String),
    Number(usize),
}

impl Place<'_> {
    fn key(&self) -> String {
        let mut key = self.root.to_string();
        for step in &self.way {
            match step {
                Step::Key(name) if key.is_empty() => key.push_str(name),
                Step::Key(name) => key.extend([".", name]),
                Step::Number(n) => key.push_str(&format!("[{n}]")),
            }
        }
        if key.chars().count() > SHOWN {
            key = key.chars().take(SHOWN).chain("...".chars()).collect();
        }
        key
    }

    /// Return the key between backquotes, or "the scene" without a key.
    fn named(&self) -> String {
        match self.key() {
            key if key.is_empty() => "the scene".into(),
            key => format!("`{key}`"),
        }
    }

    fn wrong(&self, why: &str, help: Option<&str>) -> PyErr {
        let message = format!(
            "{}{} {why}{}",
            self.from,
            self.named(),
            help.map_or(String::new(), |h| format!("; {h}"))
        );
        refused(message, &self.key(), why, help)
    }

    fn wrong_type(&self, what: &str, help: &str) -> PyErr {
        PyTypeError::new_err(format!("{}{} {what}; {help}", self.from, self.named()))
    }
}

/// Convert a scene, a dict or another mapping, to JSON.
pub fn scene(tree: &Bound<'_, PyAny>) -> PyResult<String> {
    if tree.cast::<PyMapping>().is_err() {
        let help = match tree.is_instance_of::<PyString>() {
            true => "`Scene.from_file` reads a file, `Scene.from_toml` a text",
            false => "a scene is a dict with the keys of scene files, as `title`, `method` and `bodies`",
        };
        return Err(PyTypeError::new_err(format!("`Scene` does not take {}; {help}", kind(tree)?)));
    }
    let mut place = Place { root: "", from: "", way: Vec::new() };
    Ok(value(tree, &mut place)?.to_string())
}

/// Convert the value of a key of `set` to TOML.
pub fn toml(key: &str, new: &Bound<'_, PyAny>) -> PyResult<String> {
    let mut place = Place { root: key, from: "set: ", way: Vec::new() };
    let new = value(new, &mut place)?;
    let new = new
        .serialize(toml_edit::ser::ValueSerializer::new())
        .map_err(|e| place.wrong(&format!("cannot be written in TOML: {e}"), None))?;
    Ok(new.to_string())
}

/// Return the type of an object, with an article.
fn kind(object: &Bound<'_, PyAny>) -> PyResult<String> {
    if object.is_none() {
        return Ok("None".into());
    }
    let name = object.get_type().name()?.to_string();
    let article = if name.starts_with(['a', 'e', 'i', 'o', 'u', 'A', 'E', 'I', 'O']) { "an" } else { "a" };
    Ok(format!("{article} {name}"))
}

/// Convert a Python object to a JSON value: mappings, sequences, arrays, texts, paths, truth values, and real numbers of any type.
fn value(object: &Bound<'_, PyAny>, place: &mut Place<'_>) -> PyResult<Value> {
    if object.is_none() {
        let help = match place.way.last() {
            Some(Step::Number(_)) => "leave it out of the list",
            _ => "leave the key out",
        };
        return Err(place.wrong("is None", Some(help)));
    }
    if let Ok(yes) = object.cast::<PyBool>() {
        return Ok(Value::Bool(yes.is_true()));
    }
    if let Ok(text) = object.cast::<PyString>() {
        return Ok(Value::String(text.extract()?));
    }
    if object.is_instance_of::<PyInt>() {
        return integer(object, place);
    }
    if let Ok(number) = object.cast::<PyFloat>() {
        return real(number.value(), place);
    }
    if place.way.len() >= LEVELS {
        let why = format!("lies below {LEVELS} levels of dicts and lists");
        return Err(place.wrong(&why, Some("no scene has as many; does one of them contain itself?")));
    }
    if let Ok(table) = object.cast::<PyMapping>() {
        return mapping(table, place);
    }
    for unit in ["unit", "units"] {
        // `tolist` of such an array drops the unit.
        if object.hasattr(unit)? {
            let unit = object.getattr(unit)?.str()?;
            let help = "write a text, as \"2 mm\", or a number in SI units";
            return Err(place.wrong(&format!("is {} with the unit {unit}", kind(object)?), Some(help)));
        }
    }
    let bytes = object.is_instance_of::<PyBytes>() || object.is_instance_of::<PyByteArray>();
    if let (Ok(list), false) = (object.cast::<PySequence>(), bytes) {
        return sequence(list, place);
    }
    if object.hasattr("tolist")? {
        let list = object.call_method0("tolist")?;
        // `tolist` of a long double is a long double.
        if !list.get_type().is(object.get_type()) {
            return value(&list, place);
        }
    }
    if object.hasattr("__fspath__")? {
        let path = object.call_method0("__fspath__")?;
        if path.is_instance_of::<PyString>() {
            return value(&path, place);
        }
    }
    if object.hasattr("__index__")? {
        return integer(&object.call_method0("__index__")?, place);
    }
    if object.hasattr("__float__")? {
        match object.call_method0("__float__") {
            Ok(number) => return real(number.extract()?, place),
            // Python 3.9: `__float__` of complex numbers always fails.
            Err(error) if error.is_instance_of::<PyTypeError>(object.py()) => {}
            Err(error) => return Err(error),
        }
    }
    let help = "a scene holds dicts, lists, arrays, texts, paths, numbers and truth values";
    Err(place.wrong_type(&format!("is {}", kind(object)?), help))
}

fn integer(object: &Bound<'_, PyAny>, place: &Place<'_>) -> PyResult<Value> {
    let number: i64 =
        object.extract().map_err(|_| place.wrong("is an integer of more than 64 bits", None))?;
    Ok(number.into())
}

fn real(number: f64, place: &Place<'_>) -> PyResult<Value> {
    let finite = Number::from_f64(number)
        .ok_or_else(|| place.wrong(&format!("is {number}"), Some("it must be finite")));
    Ok(Value::Number(finite?))
}

fn mapping(table: &Bound<'_, PyMapping>, place: &mut Place<'_>) -> PyResult<Value> {
    let mut all = Map::new();
    // Copy of the items, since the conversion of a value may change the mapping.
    for item in table.items()?.iter() {
        let (key, inner): (Bound<'_, PyAny>, Bound<'_, PyAny>) = item.extract()?;
        let Ok(key) = key.cast::<PyString>() else {
            let what = format!("has the key {}, which is {}", key.repr()?, kind(&key)?);
            return Err(place.wrong_type(&what, "keys of a scene are texts"));
        };
        let key: String = key.extract()?;
        place.way.push(Step::Key(key.clone()));
        all.insert(key, value(&inner, place)?);
        place.way.pop();
    }
    Ok(Value::Object(all))
}

fn sequence(list: &Bound<'_, PySequence>, place: &mut Place<'_>) -> PyResult<Value> {
    let mut all = Vec::new();
    for (n, inner) in list.try_iter()?.enumerate() {
        place.way.push(Step::Number(n));
        all.push(value(&inner?, place)?);
        place.way.pop();
    }
    Ok(Value::Array(all))
}

/// Return the text of a scene with the changes of `set`.
pub fn changed(
    mut source: impactite_input::Source,
    set: Option<&Bound<'_, PyDict>>,
) -> PyResult<impactite_input::Source> {
    for (key, new) in set.into_iter().flatten() {
        let Ok(key) = key.extract::<String>() else {
            return Err(PyTypeError::new_err(format!(
                "set: the key {} is {}; keys are texts",
                key.repr()?,
                kind(&key)?
            )));
        };
        if key.matches(['.', '[']).count() >= LEVELS {
            let place = Place { root: &key, from: "set: ", way: Vec::new() };
            return Err(place.wrong(&format!("has more than {LEVELS} levels"), None));
        }
        let assignment = format!("{key}={}", toml(&key, &new)?);
        source = source.set(&assignment).map_err(crate::error::Failed::from)?;
    }
    Ok(source)
}
