//! Text of a scene: parsing, changes of keys, and error positions.

use std::io::Read;
use std::ops::Range;
use std::path::Path;

use toml_edit::{Document, DocumentMut, Item, Table, TableLike, Value};

use crate::error::{Fault, InputError};
use crate::hint::{helped, near};
use crate::json;
use crate::model::SceneFile;
use crate::model::over_time::TableSpec;
use crate::quantity::Parameters;
use crate::table::Table as Values;

/// Scene text in TOML.
#[derive(Clone, Debug)]
pub struct Source {
    /// Name in error messages.
    pub name: String,
    /// TOML text.
    pub text: String,
    /// Original JSON text, to which error positions refer; `None` for TOML.
    json: Option<String>,
    /// Keys changed after the file was read.
    changed: Vec<String>,
}

/// Maximum size of a scene file, bytes: reading of devices and endless pipes must end.
const LARGEST: u64 = 16 << 20;

/// Keys that a run resumed from a checkpoint may change, since no step depends on them.
pub const RESUMABLE: &[&str] = &["end", "until", "title", "description", "checks"];

/// Step from a table or a list to its entry.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Step {
    Key(String),
    Number(usize),
}

impl Source {
    /// Create a source from TOML text.
    pub fn new(name: impl Into<String>, text: impl Into<String>) -> Self {
        Source { name: name.into(), text: text.into(), json: None, changed: Vec::new() }
    }

    /// Read the file `path`: TOML, or JSON if it ends with `.json`.
    ///
    /// # Errors
    /// File that cannot be read, is too large, or is no UTF-8 text; invalid JSON.
    pub fn read(path: impl AsRef<Path>) -> Result<Self, InputError> {
        let path = path.as_ref();
        let read = || -> std::io::Result<String> {
            let mut text = String::new();
            std::fs::File::open(path)?.take(LARGEST + 1).read_to_string(&mut text)?;
            match text.len() as u64 > LARGEST {
                true => Err(std::io::Error::other(format!(
                    "it is larger than the {LARGEST} bytes that a scene may have"
                ))),
                false => Ok(text),
            }
        };
        let text = read().map_err(|source| InputError::Read { path: path.into(), source })?;
        let name = path.display().to_string();
        if path.extension().is_some_and(|e| e.eq_ignore_ascii_case("json")) {
            return Source::from_json(name, &text);
        }
        Ok(Source::new(name, text))
    }

    /// Convert JSON text to TOML.
    ///
    /// # Errors
    /// Invalid JSON; `null`, which TOML does not have; a top-level value that is no object.
    pub fn from_json(name: impl Into<String>, text: &str) -> Result<Self, InputError> {
        let name = name.into();
        let fault = |line: Option<usize>, column: usize, message: String| Fault {
            file: name.clone(),
            line,
            column: column.max(1),
            width: 1,
            text: line.and_then(|l| text.lines().nth(l - 1)).unwrap_or_default().into(),
            key: String::new(),
            message,
            help: None,
        };
        let value: serde_json::Value = serde_json::from_str(text)
            .map_err(|e| Box::new(fault(Some(e.line().max(1)), e.column(), format!("invalid JSON: {e}"))))?;
        let refused = |at: usize, key: String, message: String| {
            let line_start = text[..at].rfind('\n').map_or(0, |i| i + 1);
            let line = text[..at].matches('\n').count() + 1;
            let column = text[line_start..at].chars().count() + 1;
            InputError::from(Box::new(Fault { key, ..fault(Some(line), column, message) }))
        };
        if !value.is_object() {
            return Err(refused(0, String::new(), "a scene is an object: { \"title\": ..., ... }".into()));
        }
        for found in json::places(text) {
            match found.wrong {
                Some(json::Wrong::Twice) => {
                    return Err(refused(found.span.start, found.key, "stands twice".into()));
                }
                Some(json::Wrong::Null) => {
                    return Err(refused(
                        found.span.start,
                        found.key,
                        "`null` is no value; leave the key out".into(),
                    ));
                }
                None => {}
            }
        }
        match toml_edit::ser::to_string_pretty(&value) {
            Ok(toml) => Ok(Source { json: Some(text.into()), ..Source::new(name, toml) }),
            Err(why) => Err(Box::new(fault(None, 1, format!("not a scene: {why}"))).into()),
        }
    }

    /// Copy with absolute paths of further files, so that the text is valid in any folder.
    #[must_use]
    pub fn anchored(&self) -> Self {
        let folder = Path::new(&self.name).parent().unwrap_or(Path::new(""));
        let folder = std::path::absolute(if folder.as_os_str().is_empty() { Path::new(".") } else { folder });
        let (Ok(folder), Ok(mut document)) = (folder, self.text.parse::<DocumentMut>()) else {
            return self.clone();
        };
        let mut moved = false;
        for (name, item) in document.iter_mut() {
            if name.get() != "parameters" {
                moved |= anchor(item, &folder);
            }
        }
        if moved { Source { text: document.to_string(), ..self.clone() } } else { self.clone() }
    }

    /// True if a run of this scene can resume as one of `other`: they differ only in the keys of [`RESUMABLE`] and in descriptive texts.
    #[must_use]
    pub fn resumes_as(&self, other: &Source) -> bool {
        let substance = |source: &Source| -> Option<serde_json::Value> {
            let mut value: serde_json::Value = toml_edit::de::from_str(&source.anchored().text).ok()?;
            let keys = value.as_object_mut()?;
            RESUMABLE.iter().for_each(|key| {
                keys.remove(*key);
            });
            if let Some(output) = keys.get_mut("output").and_then(|o| o.as_object_mut()) {
                ["histories", "pictures", "frames"].iter().for_each(|key| {
                    output.remove(*key);
                });
                if output.is_empty() {
                    keys.remove("output");
                }
            }
            Some(value)
        };
        substance(self).is_some_and(|here| substance(other) == Some(here))
    }

    /// Copy with one key changed: `bodies.rod.speed=600`. The value is TOML, else plain text. Missing tables are created.
    ///
    /// # Errors
    /// No `=`; a parameter that the file does not have, since it would have no effect; a key through something that is no table; a list
    /// that is too short; invalid TOML.
    pub fn set(&self, assignment: &str) -> Result<Self, InputError> {
        let wrong = |why: String| InputError::Set { assignment: assignment.into(), why };
        let (key, value) = assignment
            .split_once('=')
            .ok_or_else(|| wrong("write KEY=VALUE, as bodies.rod.speed=600".into()))?;
        let (key, value) = (key.trim(), value.trim());
        let mut document: DocumentMut = self
            .text
            .parse()
            .map_err(|e: toml_edit::TomlError| InputError::from(Box::new(self.syntax(&e))))?;
        let value: Value = value.parse().unwrap_or_else(|_| Value::from(value));
        let steps = steps_of(key);
        let Some((last, way)) = steps.split_last() else { return Err(wrong("the key is empty".into())) };
        if let [Step::Key(table), Step::Key(name)] = &steps[..]
            && table == "parameters"
        {
            let there = document.get(table).and_then(Item::as_table_like);
            let names: Vec<&str> = there.into_iter().flat_map(|t| t.iter().map(|(name, _)| name)).collect();
            if !names.contains(&name.as_str()) {
                let meant = near(name, names.iter().copied())
                    .map_or(String::new(), |n| format!("; did you mean `{n}`?"));
                return Err(wrong(format!(
                    "the file has no parameter `{name}`; it has {}{meant}",
                    names.join(", ")
                )));
            }
            self.check_measure(name, &value).map_err(wrong)?;
        }
        let mut here: &mut Item = document.as_item_mut();
        for step in way {
            here = down(here, step).map_err(wrong)?;
        }
        let place = down(here, last).map_err(wrong)?;
        *place = Item::Value(value);
        let mut changed = self.changed.clone();
        changed.push(key.into());
        // Error positions refer to the changed TOML text, not to the original JSON.
        Ok(Source { name: self.name.clone(), text: document.to_string(), json: None, changed })
    }

    /// Refuse a parameter value whose dimension differs from that in the file.
    fn check_measure(&self, name: &str, value: &Value) -> Result<(), String> {
        let Ok(document) = Document::parse(self.text.as_str()) else { return Ok(()) };
        let Ok(known) = self.parameters(&document) else { return Ok(()) };
        let Some(there) = document.get("parameters").and_then(|p| p.get(name)).and_then(text_of) else {
            return Ok(());
        };
        let new = text_of(&Item::Value(value.clone())).ok_or("must be a number, or a text with a unit")?;
        match (known.measure(&there), known.measure(&new)) {
            (Ok(there), Ok(new_measure)) if there != new_measure => {
                let words = |(name, unit): (&str, &str)| match unit {
                    "" => "a number without a unit".to_string(),
                    _ => format!("a {name} ({unit})"),
                };
                Err(format!(
                    "the parameter is {} in the file, and `{new}` is {}",
                    words(there),
                    words(new_measure)
                ))
            }
            _ => Ok(()),
        }
    }

    /// Parse the scene.
    ///
    /// # Errors
    /// With the position: invalid TOML; unknown keys (near misses are suggested), values of wrong types, quantities of wrong dimensions.
    pub fn parse(&self) -> Result<SceneFile, InputError> {
        let document = Document::parse(self.text.as_str()).map_err(|e| Box::new(self.syntax(&e)))?;
        let parameters = self.with_tables(self.parameters(&document)?, &document)?;
        let read = impactite_scene_file::read(document.clone(), &parameters);
        let mut scene = read.map_err(|error| {
            let path = error.path().to_string();
            let path = if path == "." { String::new() } else { path };
            let inner = error.into_inner();
            let (message, help) = helped(inner.message());
            Box::new(self.fault(inner.span(), path, message, help))
        })?;
        scene.expand().map_err(|(key, why)| Box::new(self.fault_at(&key, why, None)))?;
        Ok(scene)
    }

    fn parameters(&self, document: &Document<&str>) -> Result<Parameters, InputError> {
        let mut parameters = Parameters::default();
        let Some(item) = document.get("parameters") else { return Ok(parameters) };
        let Some(table) = item.as_table_like() else {
            let fault = self.fault(
                item.span(),
                "parameters".into(),
                "must be a table of names and values".into(),
                None,
            );
            return Err(Box::new(fault).into());
        };
        for (name, item) in table.iter() {
            let text = text_of(item).unwrap_or_default();
            let defined = if text.trim().is_empty() {
                Err("must be a number, or a text with a unit".into())
            } else {
                parameters.define(name, &text)
            };
            if let Err(why) = defined {
                return Err(Box::new(self.fault(item.span(), format!("parameters.{name}"), why, None)).into());
            }
        }
        Ok(parameters)
    }

    /// Add the tables of the file to the parameters.
    fn with_tables(
        &self,
        mut parameters: Parameters,
        document: &Document<&str>,
    ) -> Result<Parameters, InputError> {
        let tables = document.get("tables").and_then(Item::as_table_like);
        for (name, item) in tables.into_iter().flat_map(|tables| tables.iter()) {
            let fault = |message: String| {
                InputError::from(Box::new(self.fault(item.span(), format!("tables.{name}"), message, None)))
            };
            // Parsing of the whole scene reports invalid tables.
            let Ok(text) = item.clone().into_table().map(|table| table.to_string()) else { continue };
            let Ok(spec) = parameters.during(|| toml_edit::de::from_str::<TableSpec>(&text)) else {
                continue;
            };
            // Building the scene reports unreadable tables.
            if let Ok(table) = spec.table(&self.folder()).or_else(|_| Values::new([(0.0, 0.0), (1.0, 0.0)])) {
                parameters.define_table(name, table).map_err(fault)?;
            }
        }
        Ok(parameters)
    }

    /// Create an error at a key, as `bodies.rod.shape`, or at its deepest existing parent.
    #[must_use]
    pub fn fault_at(&self, key: &str, message: impl Into<String>, help: Option<String>) -> Fault {
        let span = Document::parse(self.text.as_str()).ok().and_then(|document| {
            let mut here = document.as_item().clone();
            let mut span = None;
            for step in steps_of(key) {
                let next = match &step {
                    Step::Key(key) => here.get(key.as_str()).cloned(),
                    Step::Number(n) => here.get(*n).cloned(),
                };
                let Some(next) = next else { break };
                let at_key = match (&here, &step) {
                    (Item::Table(table), Step::Key(key)) => table.key(key).and_then(|k| k.span()),
                    (Item::Value(Value::InlineTable(table)), Step::Key(key)) => {
                        table.key(key).and_then(|k| k.span())
                    }
                    _ => None,
                };
                span = match &next {
                    // Heading of a table only, not its whole content.
                    Item::Table(_) | Item::ArrayOfTables(_) => at_key.or(next.span()),
                    _ => next.span().or(at_key),
                }
                .or(span);
                here = next;
            }
            span
        });
        self.fault(span, key.into(), message.into(), help)
    }

    /// Copy with another text, whose lines are not those of the file.
    pub(crate) fn with_text(&self, text: String) -> Self {
        Source { text, json: None, ..self.clone() }
    }

    pub(crate) fn syntax(&self, error: &toml_edit::TomlError) -> Fault {
        self.fault(error.span(), String::new(), format!("no TOML: {}", error.message()), None)
    }

    fn fault(&self, span: Option<Range<usize>>, key: String, message: String, help: Option<String>) -> Fault {
        let (file, message) = (self.name.clone(), message.replace('\n', "; "));
        let (text, span) = match &self.json {
            // Value of the key, or of its deepest existing parent.
            Some(json) => {
                let within = |of: &str| {
                    key.strip_prefix(of).is_some_and(|rest| rest.is_empty() || rest.starts_with(['.', '[']))
                };
                let place =
                    json::places(json).into_iter().filter(|p| within(&p.key)).max_by_key(|p| p.key.len());
                (json, place.filter(|p| !p.key.is_empty()).map(|p| p.span))
            }
            None => (&self.text, span),
        };
        let Some(span) = span.filter(|s| s.start <= text.len()) else {
            return Fault { file, line: None, column: 1, width: 0, text: String::new(), key, message, help };
        };
        // Byte span, extended to whole characters.
        let start = (0..=span.start).rev().find(|&i| text.is_char_boundary(i)).unwrap_or(0);
        let before = &text[..start];
        let line_start = before.rfind('\n').map_or(0, |i| i + 1);
        let shown = text[line_start..].lines().next().unwrap_or_default();
        let column = before[line_start..].chars().count() + 1;
        let end = span.end.min(line_start + shown.len());
        let width = text.get(start..end).map_or(1, |s| s.chars().count()).max(1);
        let line = Some(before.matches('\n').count() + 1);
        Fault { file, line, column, width, text: shown.into(), key, message, help }
    }
}

/// Return the text of a parameter: a finite number, or a text.
pub(crate) fn text_of(item: &Item) -> Option<String> {
    match item.as_value()? {
        Value::String(text) => Some(text.value().clone()),
        Value::Integer(number) => Some(number.value().to_string()),
        Value::Float(number) if number.value().is_finite() => Some(format!("{:?}", number.value())),
        _ => None,
    }
}

/// Make the file paths of an item absolute. Return true if it has any.
fn anchor(item: &mut Item, folder: &Path) -> bool {
    match item {
        Item::Value(Value::Array(list)) => list.iter_mut().fold(false, |moved, value| {
            value.as_inline_table_mut().is_some_and(|table| anchor_table(table, folder)) | moved
        }),
        Item::ArrayOfTables(tables) => {
            tables.iter_mut().fold(false, |moved, table| anchor_table(table, folder) | moved)
        }
        _ => item.as_table_like_mut().is_some_and(|table| anchor_table(table, folder)),
    }
}

fn anchor_table(table: &mut dyn TableLike, folder: &Path) -> bool {
    table.iter_mut().fold(false, |moved, (key, item)| {
        let relative = item.as_str().filter(|path| key.get() == "file" && Path::new(path).is_relative());
        let Some(path) = relative else { return anchor(item, folder) | moved };
        *item = toml_edit::value(folder.join(path).display().to_string());
        true
    })
}

/// Split a key into its steps: `bodies.rod.velocity[2]`.
pub(crate) fn steps_of(key: &str) -> Vec<Step> {
    let mut steps = Vec::new();
    for part in key.split('.').filter(|p| !p.is_empty()) {
        let (name, numbers) = part.split_once('[').unwrap_or((part, ""));
        if !name.is_empty() {
            steps.push(Step::Key(name.trim_matches('"').into()));
        }
        steps.extend(numbers.split(['[', ']']).filter_map(|n| n.parse().ok()).map(Step::Number));
    }
    steps
}

fn down<'a>(item: &'a mut Item, step: &Step) -> Result<&'a mut Item, String> {
    match step {
        Step::Key(key) => {
            if item.is_none() {
                *item = Item::Table(Table::new());
            }
            if item.as_table_like().is_none() {
                return Err(format!("`{key}` is asked for in what is no table"));
            }
            item.as_table_like_mut()
                .map(|t: &mut dyn TableLike| t.entry(key).or_insert(Item::None))
                .ok_or_else(String::new)
        }
        Step::Number(n) => {
            let count = match &*item {
                Item::Value(Value::Array(list)) => list.len(),
                Item::ArrayOfTables(list) => list.len(),
                _ => return Err(format!("[{n}] is asked for in what is no list")),
            };
            item.get_mut(*n).ok_or_else(|| format!("[{n}] is asked for in a list of {count}"))
        }
    }
}
