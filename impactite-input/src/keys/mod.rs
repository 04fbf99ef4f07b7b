//! Reference of all keys of scene files, generated from the schema: path, value, default, description and an example of each.

use std::collections::BTreeMap;

use serde_json::{Map, Value, json};

use crate::quantity::MEASURES;

mod page;

pub use page::markdown;

/// Key of scene files.
#[derive(Clone, Debug, PartialEq)]
pub struct Key {
    /// Path, as `bodies.NAME.shape.ball.radius`: `NAME` is any name, `[]` an element of a list.
    pub path: String,
    /// Kind of the value, with its SI unit.
    pub kind: String,
    /// Allowed range, where the schema has one.
    pub range: Option<String>,
    /// Allowed words, with descriptions at their first occurrence.
    pub words: Vec<(String, String)>,
    /// True if the table that contains the key must have it.
    pub required: bool,
    /// Default, as TOML; `None` if the key has no effect unless specified, or if its description states the default behaviour.
    pub default: Option<String>,
    /// Description.
    pub what: String,
    /// Line of TOML with the key, relative to the table that contains it.
    pub example: String,
    /// Minimal scene with the example, as JSON. It can be parsed; whether it can be run depends on files and names.
    pub scene: Value,
    /// Type and field of the schema; `None` for elements and alternatives.
    pub field: Option<(String, String)>,
}

impl Key {
    /// Describe the value and its bounds in words.
    #[must_use]
    pub fn value(&self) -> String {
        let words: Vec<String> = self.words.iter().map(|(word, _)| format!("`\"{word}\"`")).collect();
        let mut parts = Vec::new();
        if !self.kind.is_empty() {
            parts.push(self.kind.clone());
        }
        if !words.is_empty() {
            parts.push(words.join(", "));
        }
        parts.extend(self.range.clone());
        parts.join("; ")
    }

    /// True if the path is at or below a prefix, in which any name matches `NAME`: `bodies.plate`, `bodies.NAME`, `conditions.wall`.
    #[must_use]
    pub fn is_below(&self, prefix: &str) -> bool {
        let plain = |s: &str| s.split('[').next().unwrap_or_default().to_string();
        let mut path = self.path.split('.').map(plain);
        prefix.split('.').filter(|s| !s.is_empty()).map(plain).all(|wanted| match path.next() {
            Some(there) => there == wanted || there == "NAME",
            None => false,
        })
    }
}

/// Return all keys, in the order of the types that they are parsed into.
#[must_use]
pub fn all() -> Vec<Key> {
    let schema = crate::schema().to_value();
    let mut walk = Walk { schema: &schema, keys: Vec::new(), seen: BTreeMap::new(), open: Vec::new() };
    walk.object(&schema, "SceneFile", "", &[]);
    walk.keys
}

/// Return the keys at or below a prefix.
#[must_use]
pub fn below(prefix: &str) -> Vec<Key> {
    all().into_iter().filter(|key| key.is_below(prefix)).collect()
}

/// Types that are described at a key other than the first one that has them, and that key.
const HOMES: [(&str, &str); 1] = [("Shape", "bodies.NAME.shape")];

/// Step from the whole scene down to a key, with its surroundings.
#[derive(Clone)]
enum Frame {
    /// Field of an object, with its required siblings.
    Field { siblings: Map<String, Value>, name: String },
    /// Alternative of a key that accepts one of several.
    Variant(String),
    /// Entry of a table of names.
    Name(&'static str),
    /// Element of a list.
    Element,
}

struct Walk<'a> {
    schema: &'a Value,
    keys: Vec<Key>,
    /// Types with words or alternatives that were described before, and their paths.
    seen: BTreeMap<String, String>,
    /// Types that contain the present one.
    open: Vec<String>,
}

/// Resolve references and `null` in a type of the schema.
fn resolved<'a>(schema: &'a Value, of: &'a Value) -> (&'a Value, &'a str) {
    if let Some(name) = of["$ref"].as_str().and_then(|r| r.strip_prefix("#/$defs/")) {
        let target = &schema["$defs"][name];
        let beside =
            target["anyOf"].as_array().is_some_and(|list| list.iter().any(|v| v["const"].is_string()));
        return if beside { resolved(schema, target) } else { (target, name) };
    }
    // Skip `null`, and a word or list accepted instead of a table, which the description of the key documents.
    let is_beside =
        |one: &Value, v: &Value| v["type"] == "null" || v["const"].is_string() || v["items"] == *one;
    if let Some([one, beside]) = of["anyOf"].as_array().map(Vec::as_slice)
        && is_beside(one, beside)
    {
        return resolved(schema, one);
    }
    (of, "")
}

/// Return the table among the alternatives of a type that also accepts others.
fn table_beside<'a>(schema: &'a Value, of: &'a Value) -> Option<(&'a Value, &'a str)> {
    let list = of["anyOf"].as_array()?;
    list.iter().map(|one| resolved(schema, one)).find(|(one, _)| one["properties"].is_object())
}

/// Return the alternatives of a type: word, description, and the schema below the word, `None` for plain words.
fn alternatives(of: &Value) -> Vec<(String, String, Option<&Value>, &Value)> {
    let mut list = Vec::new();
    for one in of["oneOf"].as_array().into_iter().flatten() {
        let what = text(&one["description"]);
        if let Some(word) = one["const"].as_str() {
            list.push((word.to_string(), what.clone(), None, one));
        }
        for word in one["enum"].as_array().into_iter().flatten().filter_map(Value::as_str) {
            list.push((word.to_string(), what.clone(), None, one));
        }
        for (word, inner) in one["properties"].as_object().into_iter().flatten() {
            list.push((word.clone(), what.clone(), Some(inner), one));
        }
    }
    for word in of["enum"].as_array().into_iter().flatten().filter_map(Value::as_str) {
        list.push((word.to_string(), String::new(), None, of));
    }
    list
}

fn text(value: &Value) -> String {
    // Doc comments escape brackets.
    value.as_str().unwrap_or_default().replace('\n', " ").replace("\\[", "[").replace("\\]", "]")
}

fn is_type(of: &Value, name: &str) -> bool {
    match &of["type"] {
        Value::String(one) => one == name,
        Value::Array(list) => list.iter().any(|t| t == name),
        _ => false,
    }
}

/// Return the dimension of a quantity or formula: name, SI unit, and words on accepted formulas.
fn measure(name: &str) -> Option<(&'static str, &'static str, &'static str)> {
    if name == "SpeedOrFree" {
        return Some(("speed", "m/s", ", formula, or `\"free\"`"));
    }
    let (plain, more) = match name.strip_suffix("Formula") {
        Some(plain) => (plain, ", or formula"),
        None => (name, ""),
    };
    let words = |name: &str| -> String { name.split(' ').map(|w| w[..1].to_uppercase() + &w[1..]).collect() };
    MEASURES.iter().find(|(name, _)| words(name) == plain).map(|(name, unit)| (*name, *unit, more))
}

/// Return an example of each dimension.
fn of_measure(name: &str) -> Value {
    match name {
        "length" => json!("5 mm"),
        "area" => json!("1 cm^2"),
        "time" => json!("1 us"),
        "speed" => json!("190 m/s"),
        "acceleration" => json!("9.81 m/s^2"),
        "angular velocity" => json!("30 rad/s"),
        "angle" => json!("30 deg"),
        "mass" => json!("1 kg"),
        "density" => json!("7850 kg/m^3"),
        "pressure" => json!("200 MPa"),
        "viscosity" => json!("1 mPa s"),
        "temperature" => json!("294 K"),
        "heat capacity" => json!("477 J/(kg K)"),
        "energy of an area" => json!("50 J/m^2"),
        "energy of a volume" => json!("7 GJ/m^3"),
        _ => json!(1),
    }
}

/// Return the name that replaces `NAME` in examples.
fn sample(path: &str) -> &'static str {
    match path {
        "materials" => "steel",
        "bodies" => "body",
        "parameters" => "radius",
        "tables" => "pulse",
        _ => "length",
    }
}

impl<'a> Walk<'a> {
    fn fields(&self, of: &'a Value) -> Vec<(&'a String, &'a Value, bool)> {
        let required: Vec<&str> =
            of["required"].as_array().into_iter().flatten().filter_map(Value::as_str).collect();
        let all = of["properties"].as_object().into_iter().flatten();
        all.map(|(name, field)| (name, field, required.contains(&name.as_str()))).collect()
    }

    /// Return the required fields of an object, with examples.
    fn required(&self, of: &'a Value, path: &str) -> Map<String, Value> {
        let fields = self.fields(of).into_iter().filter(|f| f.2);
        fields.map(|(name, field, _)| (name.clone(), self.example(field, &join(path, name)))).collect()
    }

    /// Return an example of a value.
    fn example(&self, of: &'a Value, path: &str) -> Value {
        if let Some(first) = of["examples"].get(0) {
            return first.clone();
        }
        let (target, name) = resolved(self.schema, of);
        if let Some(first) = target["examples"].get(0) {
            return first.clone();
        }
        if let Some((name, ..)) = measure(name) {
            return of_measure(name);
        }
        if let Some((word, _, inner, whole)) = alternatives(target).into_iter().next() {
            return match inner {
                _ if whole["examples"].get(0).is_some() => whole["examples"][0].clone(),
                Some(inner) => json!({ word: self.example(inner, path) }),
                None => json!(word),
            };
        }
        if target["properties"].is_object() {
            let mut made = self.required(target, path);
            if made.is_empty()
                && let Some((name, field, _)) = self.fields(target).first()
            {
                made.insert((*name).clone(), self.example(field, &join(path, name)));
            }
            return Value::Object(made);
        }
        if target["additionalProperties"].is_object() {
            return json!({ sample(path): self.example(&target["additionalProperties"], path) });
        }
        // Examples of keys whose types have none.
        match path.rsplit('.').next().unwrap_or_default() {
            "field" => return json!("plastic_strain"),
            "fields" => return json!(["velocity", "pressure"]),
            "range" => return json!([0, 1.5]),
            "seen_from" => return json!([1, -1, 0.7]),
            _ => {}
        }
        if is_type(target, "array") {
            let one = self.example(&target["items"], path);
            let count = target["minItems"].as_u64().unwrap_or(1);
            let is_vector = measure(resolved(self.schema, &target["items"]).1).is_some();
            return match count {
                // Position or vector.
                1 if is_vector => json!([0, one]),
                _ => Value::Array((0..count).map(|_| one.clone()).collect()),
            };
        }
        if is_type(target, "boolean") {
            return json!(true);
        }
        if is_type(target, "string") {
            return json!(path.rsplit('.').next().unwrap_or_default());
        }
        if is_type(target, "object") { json!({}) } else { json!(1) }
    }

    fn push(&mut self, path: &str, of: &'a Value, place: Place, frames: &[Frame], example: &Value) {
        let (target, name) = resolved(self.schema, of);
        // A list of words has the words of its elements.
        let (of_words, name) = match resolved(self.schema, &target["items"]) {
            (items, name) if is_words(items) => (items, name),
            _ => (target, name),
        };
        let list = alternatives(of_words);
        let plain = list.iter().filter(|a| a.2.is_none());
        let kind = self.kind(of, path);
        let known = name.is_empty() || self.described(name, path).is_some();
        if !known {
            self.seen.insert(name.into(), path.into());
        }
        let words = plain.map(|a| (a.0.clone(), if known { String::new() } else { a.1.clone() })).collect();
        let default = match &of["default"] {
            Value::Null => None,
            Value::String(empty) if empty.is_empty() => None,
            Value::Array(empty) if empty.is_empty() => None,
            value => Some(toml(value)),
        };
        let mut scene = example.clone();
        for frame in frames.iter().rev() {
            scene = match frame {
                Frame::Field { siblings, name } => {
                    let mut all = siblings.clone();
                    all.insert(name.clone(), scene);
                    Value::Object(all)
                }
                Frame::Variant(word) => json!({ word: scene }),
                Frame::Name(name) => json!({ *name: scene }),
                Frame::Element => json!([scene]),
            };
        }
        self.keys.push(Key {
            path: path.into(),
            kind,
            range: range(of),
            words,
            required: place.required,
            default,
            what: place.what,
            example: line(path, place.variant, example),
            scene,
            field: place.field,
        });
    }

    /// Return the path at which a type is described, unless that is this one.
    fn described(&self, name: &str, path: &str) -> Option<&str> {
        let home = HOMES.iter().find(|(of, home)| *of == name && *home != path);
        self.seen.get(name).map(String::as_str).or(home.map(|(_, home)| *home))
    }

    fn kind(&self, of: &'a Value, path: &str) -> String {
        let (target, name) = resolved(self.schema, of);
        if let Some((name, unit, more)) = measure(name) {
            return if unit.is_empty() { format!("number{more}") } else { format!("{name}, {unit}{more}") };
        }
        let list = alternatives(target);
        if !list.is_empty() {
            let tables: Vec<String> =
                list.iter().filter(|a| a.2.is_some()).map(|a| format!("`{}`", a.0)).collect();
            return match self.described(name, path) {
                _ if tables.is_empty() => String::new(),
                Some(path) => format!("as `{path}`"),
                None => format!("one of {}", tables.join(", ")),
            };
        }
        if let Some(list) = target["anyOf"].as_array() {
            let of_measure = |of| {
                let (name, unit, more) = measure(resolved(self.schema, of).1)?;
                Some(if unit.is_empty() { format!("number{more}") } else { format!("{name}, {unit}{more}") })
            };
            let of_type = |of| match resolved(self.schema, of).0["type"].as_str() {
                Some("object") => "table".to_string(),
                Some("boolean") => "`true` or `false`".to_string(),
                Some("array") => "list".into(),
                Some("string") => "text with a unit".into(),
                _ => "number".into(),
            };
            let one = |of| of_measure(of).unwrap_or_else(|| of_type(of));
            return list.iter().map(one).collect::<Vec<_>>().join(", or ");
        }
        if target["properties"].is_object() {
            return "table".into();
        }
        if target["additionalProperties"].is_object() {
            return "tables, by name".into();
        }
        if is_type(target, "array") {
            let (inner, name) = resolved(self.schema, &target["items"]);
            let count = match (target["minItems"].as_u64(), target["maxItems"].as_u64()) {
                (Some(low), Some(high)) if low == high => format!("{low} "),
                _ => String::new(),
            };
            return match measure(name) {
                Some((_, "", _)) => format!("list of {count}numbers"),
                Some((name, unit, more)) => {
                    let many = if name.starts_with("energy") { name.to_string() } else { plural(name) };
                    format!("list of {count}{many}, {unit}{more}")
                }
                None if is_type(inner, "array") => {
                    let inner = self.kind(inner, "");
                    let more = inner.strip_prefix("list of ").map(String::from);
                    format!("list of lists of {}", more.unwrap_or(inner))
                }
                None if is_type(inner, "string") => format!("list of {count}texts"),
                None if is_type(inner, "integer") => format!("list of {count}integers"),
                None if is_words(inner) => "list of words".into(),
                None => "list of tables".into(),
            };
        }
        for (kind, word) in [
            ("boolean", "`true` or `false`"),
            ("integer", "integer"),
            ("number", "number"),
            ("string", "text"),
            ("object", "table"),
        ] {
            if is_type(target, kind) {
                return word.into();
            }
        }
        "any".into()
    }

    fn object(&mut self, of: &'a Value, name: &str, path: &str, frames: &[Frame]) {
        // The siblings in an example are the required keys of the table, or those of the table's own example.
        let required = match of["examples"].get(0).and_then(Value::as_object) {
            Some(example) => example.clone(),
            None => self.required(of, path),
        };
        for (field, inner, needed) in self.fields(of) {
            let mut siblings = required.clone();
            siblings.shift_remove(field);
            let mut below = frames.to_vec();
            below.push(Frame::Field { siblings, name: field.clone() });
            let place = Place {
                required: needed,
                what: text(&inner["description"]),
                field: Some((name.to_string(), field.clone())),
                ..Place::default()
            };
            self.value(inner, &join(path, field), place, &below);
        }
    }

    /// Add a key and the keys below it.
    fn value(&mut self, of: &'a Value, path: &str, place: Place, frames: &[Frame]) {
        let (target, name) = resolved(self.schema, of);
        let example = self.example(of, path);
        let first = self.described(name, path).is_none();
        self.push(path, of, place, frames, &example);
        self.inside(target, name, path, frames, first);
    }

    fn inside(&mut self, target: &'a Value, name: &str, path: &str, frames: &[Frame], first: bool) {
        if !name.is_empty() && self.open.iter().any(|open| open == name) {
            return;
        }
        self.open.push(name.to_string());
        let with = |frame| {
            let mut below = frames.to_vec();
            below.push(frame);
            below
        };
        let list = alternatives(target);
        if list.iter().any(|a| a.2.is_some()) {
            // Document shapes and contact laws below their first key, to which the others refer.
            for (word, what, inner, whole) in list.into_iter().filter(|_| first) {
                let Some(inner) = inner else { continue };
                let below = with(Frame::Variant(word.clone()));
                let example = match whole["examples"].get(0) {
                    Some(example) => example[&word].clone(),
                    None => self.example(inner, path),
                };
                let path = join(path, &word);
                let place = Place { variant: true, what, ..Place::default() };
                self.push(&path, inner, place, &below, &example);
                let (target, name) = resolved(self.schema, inner);
                self.inside(target, name, &path, &below, true);
            }
        } else if target["properties"].is_object() {
            self.object(target, name, path, frames);
        } else if let Some((table, name)) = table_beside(self.schema, target) {
            self.object(table, name, path, frames);
        } else if target["additionalProperties"].is_object() {
            let below = with(Frame::Name(sample(path)));
            let path = join(path, "NAME");
            self.element(&target["additionalProperties"], &path, &below);
        } else if is_type(target, "array") {
            let items = &target["items"];
            let (inner, inner_name) = resolved(self.schema, items);
            if inner["properties"].is_object() || alternatives(inner).iter().any(|a| a.2.is_some()) {
                let path = format!("{path}[]");
                let first = !self.seen.contains_key(inner_name);
                let below = with(Frame::Element);
                if first {
                    self.seen.insert(inner_name.into(), path.clone());
                }
                self.inside(inner, inner_name, &path, &below, first);
            }
        }
        self.open.pop();
    }

    /// Add an entry of a table of names.
    fn element(&mut self, of: &'a Value, path: &str, frames: &[Frame]) {
        let (target, name) = resolved(self.schema, of);
        let place = Place { what: text(&target["description"]), ..Place::default() };
        let example = self.example(of, path);
        let first = !self.seen.contains_key(name);
        self.push(path, of, place, frames, &example);
        self.inside(target, name, path, frames, first);
    }
}

/// Role of a key in the table that contains it.
#[derive(Default)]
struct Place {
    required: bool,
    /// Alternative of the key above.
    variant: bool,
    what: String,
    field: Option<(String, String)>,
}

fn is_words(of: &Value) -> bool {
    let list = alternatives(of);
    !list.is_empty() && list.iter().all(|a| a.2.is_none())
}

fn plural(name: &str) -> String {
    match name.strip_suffix('y') {
        Some(stem) => format!("{stem}ies"),
        None => format!("{name}s"),
    }
}

fn join(path: &str, name: &str) -> String {
    if path.is_empty() { name.into() } else { format!("{path}.{name}") }
}

fn range(of: &Value) -> Option<String> {
    let number = |key: &str| of[key].as_f64();
    let low = number("exclusiveMinimum").map(|x| format!("above {x}"));
    let low = low.or_else(|| {
        number("minimum")
            .filter(|_| of["format"].is_null() || of["minimum"] != 0)
            .map(|x| format!("{x} or more"))
    });
    let high = number("exclusiveMaximum").map(|x| format!("below {x}"));
    let high = high.or_else(|| number("maximum").map(|x| format!("at most {x}")));
    match (low, high) {
        (Some(low), Some(high)) => Some(format!("{low}, {high}")),
        (low, high) => low.or(high),
    }
}

/// Format a value as inline TOML.
fn toml(value: &Value) -> String {
    match value {
        Value::Array(list) => format!("[{}]", list.iter().map(toml).collect::<Vec<_>>().join(", ")),
        Value::Object(map) if map.is_empty() => "{}".into(),
        Value::Object(map) => {
            let fields: Vec<String> =
                map.iter().map(|(name, value)| format!("{name} = {}", toml(value))).collect();
            format!("{{ {} }}", fields.join(", "))
        }
        Value::Number(number) => match number.as_f64() {
            Some(x) if x == x.trunc() && x.abs() < 1e15 => format!("{x:.0}"),
            _ => number.to_string(),
        },
        other => other.to_string(),
    }
}

/// Format the assignment of a value to a key, in the table that contains it; for an alternative, in the table that contains the key above.
fn line(path: &str, variant: bool, value: &Value) -> String {
    let steps: Vec<&str> = path.split('.').collect();
    let above = steps.iter().rev().nth(1).copied().unwrap_or_default();
    let key = match steps.last().copied().unwrap_or_default() {
        "NAME" => format!("{above}.{}", sample(above)),
        last if variant && above != "NAME" && !above.ends_with("[]") => format!("{above}.{last}"),
        last => last.to_string(),
    };
    format!("{key} = {}", toml(value))
}
