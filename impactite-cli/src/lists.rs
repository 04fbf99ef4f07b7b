//! Lists of what scene files accept, for the terminal.

use std::fmt::Write;

use clap::ValueEnum;
use impactite_input::keys;
use impactite_input::list::Topic;

use crate::templates::TEMPLATES;

/// Topic of a list, as the command line has it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Word {
    /// Methods with their options
    Methods,
    /// Combinations of parts of mpm and of laws that are compiled
    Parts,
    /// Keys of a body
    Bodies,
    /// Shapes of bodies and regions
    Shapes,
    /// Named sets of constants: density, moduli, laws, failure, source
    Materials,
    /// Laws of materials and their constants
    Laws,
    /// Laws and detectors of contact
    Contacts,
    /// Boundary conditions
    Conditions,
    /// Time steps
    TimeStep,
    /// Measures of a scene
    Measures,
    /// Keys of a check
    Checks,
    /// Keys of the output
    Output,
    /// All keys, or those below a prefix: keys bodies.plate.shape
    Keys,
    /// Scene files to begin with, for `impactite new`
    Templates,
}

impl Word {
    fn name(self) -> String {
        self.to_possible_value().map(|v| v.get_name().to_string()).unwrap_or_default()
    }
}

/// The list of a topic, of keys those below a prefix; the topics if there is none.
///
/// # Errors
/// A prefix of no key, or of a topic that takes none.
pub fn list(topic: Option<Word>, prefix: Option<&str>, markdown: bool) -> Result<String, String> {
    let mut text = String::new();
    match topic {
        None => {
            text += "topics, as in `impactite list bodies`:\n";
            for word in Word::value_variants() {
                let what = word.to_possible_value().and_then(|v| Some(v.get_help()?.to_string()));
                let _ = writeln!(text, "  {:<11} {}", word.name(), what.unwrap_or_default());
            }
            return Ok(text);
        }
        Some(Word::Keys) if markdown => return Ok(keys::markdown()),
        Some(Word::Keys) => return of_keys(prefix.unwrap_or_default()),
        Some(other) => {
            if markdown {
                return Err("--markdown is for the topic `keys`".into());
            }
            if let Some(prefix) = prefix {
                return Err(format!("`{prefix}`: only the topic `keys` takes a prefix"));
            }
            if other == Word::Templates {
                for (name, what, _) in TEMPLATES {
                    let _ = writeln!(text, "{name}: {what}");
                }
                return Ok(text);
            }
            let Some((topic, _)) = Topic::ALL.iter().find(|(_, word)| *word == other.name()) else {
                return Err(format!("no list of {}", other.name()));
            };
            let lines = topic.lines();
            let several = lines.iter().any(|line| line.group != lines[0].group);
            let mut group = "";
            for line in &lines {
                if several && line.group != group {
                    group = &line.group;
                    let _ = writeln!(text, "{}{group}:", if text.is_empty() { "" } else { "\n" });
                }
                let _ = writeln!(text, "{}: {}", line.name, line.what);
                // Properties of named sets have a line each.
                let between = if *topic == Topic::Materials { "\n    " } else { ", " };
                if !line.fields.is_empty() {
                    let _ = writeln!(text, "    {}", line.fields.join(between));
                }
            }
        }
    }
    Ok(text)
}

fn of_keys(prefix: &str) -> Result<String, String> {
    let list = keys::below(prefix);
    if list.is_empty() {
        return Err(format!(
            "no key begins with `{prefix}`; `impactite list keys` has all, as `bodies.NAME.shape` and `conditions.wall`"
        ));
    }
    let mut text = String::new();
    for key in list {
        let value = match key.value() {
            value if value.is_empty() => String::new(),
            value => format!(": {}", value.replace('`', "")),
        };
        let presence = match (&key.default, key.required) {
            (_, true) => "; required".into(),
            (Some(default), _) => format!("; default {default}"),
            (None, _) => String::new(),
        };
        let _ = writeln!(text, "{}{value}{presence}\n    {}\n    {}", key.path, key.what, key.example);
        for (word, what) in key.words.iter().filter(|(_, what)| !what.is_empty()) {
            let _ = writeln!(text, "        \"{word}\": {what}");
        }
    }
    Ok(text)
}
