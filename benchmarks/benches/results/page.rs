//! Results page with sections between markers, so that single sections can be measured again.

use std::path::{Path, PathBuf};

use examples::{CaseError, machine};

/// Page of sections.
pub struct Page {
    path: PathBuf,
    /// Name and text of each section, in order.
    sections: Vec<(String, String)>,
}

const HEAD: &str = "\
# Speed and memory, measured

Written by `cargo bench -p benchmarks --bench results`; do not edit. Rates are million particle updates a second
(particles x steps / seconds of stepping; scenes are built before), medians with [least - most] of rounds in
alternation. Compare within one table; between tables the machine may have changed its clock. How a step is laid out
and why, and what did not help: [the performance log](../docs/book/src/performance.md).
";

fn marker(name: &str) -> String {
    format!("<!-- section: {name} -->")
}

impl Page {
    /// Read the page at `path`, or create an empty one.
    pub fn open(path: &Path) -> Result<Self, CaseError> {
        let text = std::fs::read_to_string(path).unwrap_or_default();
        let mut sections: Vec<(String, String)> = Vec::new();
        for line in text.lines() {
            let name = line.strip_prefix("<!-- section: ").and_then(|rest| rest.strip_suffix(" -->"));
            if let Some(name) = name {
                sections.push((name.into(), String::new()));
            } else if let Some((_, text)) = sections.last_mut() {
                text.push_str(line);
                text.push('\n');
            }
        }
        Ok(Page { path: path.into(), sections })
    }

    /// Set the text of a section.
    pub fn put(&mut self, name: &str, text: &str) {
        let text =
            format!("{}\n\n*{}; commit {}.*\n\n", text.trim_end(), machine::class(), machine::commit());
        match self.sections.iter_mut().find(|s| s.0 == name) {
            Some(found) => found.1 = text,
            None => self.sections.push((name.into(), text)),
        }
    }

    /// Write the page.
    pub fn save(&self) -> Result<(), CaseError> {
        let mut text = String::from(HEAD);
        for (name, section) in &self.sections {
            text.push_str(&format!("\n{}\n{}\n", marker(name), section.trim_end()));
        }
        std::fs::write(&self.path, text).map_err(|source| CaseError::File { path: self.path.clone(), source })
    }
}

/// Format a Markdown table.
pub fn table<'a>(head: impl AsRef<[&'a str]>, rows: &[impl AsRef<[String]>]) -> String {
    let (line, head) = (|cells: &[&str]| format!("| {} |\n", cells.join(" | ")), head.as_ref());
    let mut text = line(head);
    text.push_str(&line(&vec!["---"; head.len()]));
    for row in rows {
        text.push_str(&line(&row.as_ref().iter().map(String::as_str).collect::<Vec<_>>()));
    }
    text
}

/// Format a requirement of a number and its result.
pub fn asked(what: impl std::fmt::Display, met: bool) -> String {
    format!("{what}: {}", if met { "met" } else { "missed" })
}
