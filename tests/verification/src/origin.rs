//! Provenance of generated pages.

use std::process::Command;

/// Return the output of a program in one line; `unknown` if there is none.
pub fn said_by(program: &str, arguments: &[&str]) -> String {
    let said = Command::new(program).args(arguments).output().ok();
    let text = said.map(|o| String::from_utf8_lossy(&o.stdout).trim().to_string());
    text.filter(|t| !t.is_empty()).unwrap_or_else(|| "unknown".into())
}
