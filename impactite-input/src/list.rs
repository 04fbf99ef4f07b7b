//! What scene files can say, in lists for people: made from the schema, so that it is what the reader knows.

use serde_json::Value;

/// What there is a list of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Topic {
    /// Methods.
    Methods,
    /// Laws of materials, by their parts.
    Laws,
    /// Named sets of constants.
    Materials,
    /// Laws and detectors of contact.
    Contacts,
    /// Conditions.
    Conditions,
    /// Shapes.
    Shapes,
    /// Measures.
    Measures,
}

impl Topic {
    /// All, with the words of the command line.
    pub const ALL: [(Topic, &str); 7] = [
        (Topic::Methods, "methods"),
        (Topic::Laws, "laws"),
        (Topic::Materials, "materials"),
        (Topic::Contacts, "contacts"),
        (Topic::Conditions, "conditions"),
        (Topic::Shapes, "shapes"),
        (Topic::Measures, "measures"),
    ];

    /// Names, what they are, and their options.
    #[must_use]
    pub fn lines(self) -> Vec<Line> {
        let schema = crate::schema().to_value();
        let types: &[&str] = match self {
            Topic::Methods => &["Method"],
            Topic::Laws => &["Strength", "Eos", "Failure", "GroundLaw", "FluidLaw", "ExplosiveLaw"],
            Topic::Materials => &["Library"],
            Topic::Contacts => &["Law", "Detector"],
            Topic::Conditions => &["Condition"],
            Topic::Shapes => &["Shape"],
            Topic::Measures => &["Measurement"],
        };
        let mut lines: Vec<Line> = types.iter().flat_map(|name| variants(&schema, name)).collect();
        if self == Topic::Laws {
            let constants = fields(&schema, &schema["$defs"]["ElasticConstants"]);
            for (name, what) in
                [("elastic", "Linear elasticity in rate form."), ("neo_hookean", "Compressible neo-Hookean.")]
            {
                lines.insert(
                    0,
                    Line {
                        group: "Material".into(),
                        name: name.into(),
                        what: what.into(),
                        fields: constants.clone(),
                    },
                );
            }
        }
        lines
    }
}

/// A line of a list.
#[derive(Clone, Debug, PartialEq)]
pub struct Line {
    /// The key that it stands under.
    pub group: String,
    /// The name.
    pub name: String,
    /// What it is.
    pub what: String,
    /// Its options; `?` after those that may be left out.
    pub fields: Vec<String>,
}

fn variants(schema: &Value, name: &str) -> Vec<Line> {
    let of = &schema["$defs"][name];
    let list = of["oneOf"].as_array().or_else(|| of["anyOf"].as_array());
    let mut lines = Vec::new();
    for variant in list.into_iter().flatten() {
        let what = variant["description"].as_str().unwrap_or_default().replace('\n', " ");
        let mut add = |word: &str, fields: Vec<String>| {
            lines.push(Line { group: name.into(), name: word.into(), what: what.clone(), fields });
        };
        if let Some(word) = variant["const"].as_str() {
            add(word, Vec::new());
        }
        for word in variant["enum"].as_array().into_iter().flatten().filter_map(Value::as_str) {
            add(word, Vec::new());
        }
        for (word, inner) in variant["properties"].as_object().into_iter().flatten() {
            add(word, fields(schema, inner));
        }
    }
    lines
}

/// Names of the fields of an object, by way of references.
fn fields(schema: &Value, of: &Value) -> Vec<String> {
    let target =
        of["$ref"].as_str().and_then(|r| r.strip_prefix("#/$defs/")).map(|name| &schema["$defs"][name]);
    let of = target.unwrap_or(of);
    let required: Vec<&str> =
        of["required"].as_array().into_iter().flatten().filter_map(Value::as_str).collect();
    let names = of["properties"].as_object().into_iter().flatten().map(|(name, _)| name);
    names.map(|n| if required.contains(&n.as_str()) { n.clone() } else { format!("{n}?") }).collect()
}
