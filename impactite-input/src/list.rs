//! Lists of accepted keys and values of scene files, generated from the schema and from the compiled laws and kernels.

use crate::build::kernels::{PARTS, PURPOSES, word};
use crate::build::material::described;
use crate::keys::{self, Key};
use crate::model::material::Library;

/// Topic of a list.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Topic {
    /// Methods.
    Methods,
    /// Compiled combinations of parts and of laws.
    Parts,
    /// Keys of bodies.
    Bodies,
    /// Shapes.
    Shapes,
    /// Named sets of constants.
    Materials,
    /// Constitutive laws of materials.
    Laws,
    /// Laws and detectors of contact.
    Contacts,
    /// Boundary conditions.
    Conditions,
    /// Time step.
    TimeStep,
    /// Measures.
    Measures,
    /// Keys of checks.
    Checks,
    /// Keys of the output.
    Output,
}

impl Topic {
    /// All topics, with their command-line words.
    pub const ALL: [(Topic, &str); 12] = [
        (Topic::Methods, "methods"),
        (Topic::Parts, "parts"),
        (Topic::Bodies, "bodies"),
        (Topic::Shapes, "shapes"),
        (Topic::Materials, "materials"),
        (Topic::Laws, "laws"),
        (Topic::Contacts, "contacts"),
        (Topic::Conditions, "conditions"),
        (Topic::TimeStep, "time-step"),
        (Topic::Measures, "measures"),
        (Topic::Checks, "checks"),
        (Topic::Output, "output"),
    ];

    /// Describe the topic.
    #[must_use]
    pub fn what(self) -> &'static str {
        match self {
            Topic::Methods => "methods with their options",
            Topic::Parts => "combinations of parts of `mpm` that are compiled",
            Topic::Bodies => "keys of a body",
            Topic::Shapes => "shapes of bodies and regions",
            Topic::Materials => "named sets of constants: density, moduli, laws, failure, source",
            Topic::Laws => "laws of materials and their constants",
            Topic::Contacts => "laws and detectors of contact",
            Topic::Conditions => "boundary conditions",
            Topic::TimeStep => "time steps",
            Topic::Measures => "measures of a scene",
            Topic::Checks => "keys of a check",
            Topic::Output => "keys of the output",
        }
    }

    /// Return the lines of the list: names, descriptions, and keys below them.
    #[must_use]
    pub fn lines(self) -> Vec<Line> {
        match self {
            Topic::Methods => children(&["method"]),
            Topic::Parts => parts(),
            Topic::Bodies => children(&["bodies.NAME"]),
            Topic::Shapes => children(&["bodies.NAME.shape"]),
            Topic::Materials => materials(),
            Topic::Laws => laws(),
            Topic::Contacts => children(&["contact.law", "contact.detector"]),
            Topic::Conditions => children(&["conditions[]"]),
            Topic::TimeStep => children(&["time_step"]),
            Topic::Measures => children(&["measures.NAME"]),
            Topic::Checks => children(&["checks[]"]),
            Topic::Output => children(&["output"]),
        }
    }
}

/// Line of a list.
#[derive(Clone, Debug, PartialEq)]
pub struct Line {
    /// Key above the entry.
    pub group: String,
    /// Name.
    pub name: String,
    /// Description.
    pub what: String,
    /// Keys below the entry, optional ones with `?`; properties for named sets.
    pub fields: Vec<String>,
}

/// Return the part of a path below another one, or `None`.
fn within<'a>(path: &'a str, above: &str) -> Option<&'a str> {
    path.strip_prefix(above)?.strip_prefix('.')
}

/// Return the keys and words directly below the given keys.
fn children(above: &[&str]) -> Vec<Line> {
    let keys = keys::all();
    above.iter().flat_map(|above| below(&keys, above)).collect()
}

fn below(keys: &[Key], above: &str) -> Vec<Line> {
    let mut lines = Vec::new();
    for key in keys {
        if key.path == above {
            let of_words = |(name, what): &(String, String)| Line {
                group: above.into(),
                name: name.clone(),
                what: what.clone(),
                fields: Vec::new(),
            };
            lines.extend(key.words.iter().map(of_words));
        }
        let Some(name) = within(&key.path, above).filter(|name| !name.contains('.')) else { continue };
        let what = match &key.default {
            Some(default) => format!("{} Default: {default}.", key.what),
            None => key.what.clone(),
        };
        let mut fields: Vec<String> = key.words.iter().map(|(word, _)| format!("\"{word}\"")).collect();
        fields.extend(options(keys, &key.path));
        lines.push(Line { group: above.into(), name: name.into(), what, fields });
    }
    lines
}

/// Return the keys directly below a key.
fn options(keys: &[Key], above: &str) -> Vec<String> {
    let right_below = keys.iter().filter_map(|key| {
        let name = within(&key.path, above)?;
        let alone = !name.contains('.');
        alone.then(|| if key.required { name.to_string() } else { format!("{name}?") })
    });
    right_below.collect()
}

/// List laws below their key of a material: `strength.johnson_cook`.
fn laws() -> Vec<Line> {
    let keys = keys::all();
    let material = "materials.NAME";
    let whole = ["elastic", "neo_hookean"];
    let mut lines: Vec<Line> = below(&keys, material);
    lines.retain(|line| whole.contains(&line.name.as_str()));
    for group in ["strength", "eos", "failure", "ground", "fluid", "explosive"] {
        let laws = below(&keys, &format!("{material}.{group}"));
        lines.extend(laws.into_iter().map(|line| Line { name: format!("{group}.{}", line.name), ..line }));
    }
    lines
}

fn parts() -> Vec<Line> {
    let line = |group: &str, name: String, what: &str| Line {
        group: group.into(),
        name,
        what: what.into(),
        fields: Vec::new(),
    };
    let of_purpose = PURPOSES.iter().map(|(purpose, shape, transfer, update, frame)| {
        let what = format!("{}, {}, {}, {frame}", word(shape), word(transfer), word(update));
        line("method.mpm.for", word(purpose), &what)
    });
    let of_parts = PARTS.iter().map(|(shape, transfer, update)| {
        let name = format!("{}, {}, {}", word(shape), word(transfer), word(update));
        line("method.mpm.parts", name, "shape function, transfer, stress update; updated Lagrangian")
    });
    of_purpose.chain(of_parts).collect()
}

/// List named sets with their properties.
fn materials() -> Vec<Line> {
    let keys = keys::all();
    let lines = below(&keys, "materials.NAME.library").into_iter();
    lines
        .map(|mut line| {
            let set = Library::ALL.iter().find(|(_, word)| *word == line.name).map(|(set, _)| *set);
            if let Some(set) = set.and_then(described) {
                line.fields = set.properties();
            }
            line
        })
        .collect()
}
