//! Lists of accepted keys and values of scene files, for the terminal.

use std::fmt::Write;

use clap::builder::{PossibleValue, PossibleValuesParser};
use impactite_input::keys;
use impactite_input::list::Topic;

use crate::templates::TEMPLATES;

/// Additional topics besides those of the library: name and description.
const KEYS: (&str, &str) = ("keys", "all keys, or those below a prefix: keys bodies.plate.shape");
const SCENES: (&str, &str) = ("templates", "scene files to begin with, for `impactite new`");

/// Names and descriptions of all topics.
fn topics() -> impl Iterator<Item = (&'static str, &'static str)> {
    Topic::ALL.iter().map(|(topic, name)| (*name, topic.what())).chain([KEYS, SCENES])
}

/// Parser of topics on the command line.
#[must_use]
pub fn topic_parser() -> PossibleValuesParser {
    PossibleValuesParser::new(topics().map(|(name, what)| PossibleValue::new(name).help(what)))
}

/// Return the list of a topic (of `keys` those below a prefix), or the list of topics if `topic` is `None`.
///
/// # Errors
/// Unknown topic; unknown prefix, or a prefix for a topic without prefixes.
pub fn list(topic: Option<&str>, prefix: Option<&str>, markdown: bool) -> Result<String, String> {
    let mut text = String::new();
    match topic {
        None => {
            text += "topics, as in `impactite list bodies`:\n";
            for (name, what) in topics() {
                let _ = writeln!(text, "  {name:<11} {what}");
            }
            return Ok(text);
        }
        Some(topic) if topic == KEYS.0 && markdown => return Ok(keys::markdown()),
        Some(topic) if topic == KEYS.0 => return of_keys(prefix.unwrap_or_default()),
        Some(other) => {
            if markdown {
                return Err("--markdown is for the topic `keys`".into());
            }
            if let Some(prefix) = prefix {
                return Err(format!("`{prefix}`: only the topic `keys` takes a prefix"));
            }
            if other == SCENES.0 {
                for (name, what, _) in TEMPLATES {
                    let _ = writeln!(text, "{name}: {what}");
                }
                return Ok(text);
            }
            let Some((topic, _)) = Topic::ALL.iter().find(|(_, name)| *name == other) else {
                return Err(format!("no list has the name `{other}`"));
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
                // Properties of a material have a line each.
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
