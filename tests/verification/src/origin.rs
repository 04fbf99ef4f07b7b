//! What pages say of how they were made.

use std::process::Command;

/// What a program says, in one line; `unknown` if it does not.
pub fn said_by(program: &str, arguments: &[&str]) -> String {
    let said = Command::new(program).args(arguments).output().ok();
    let text = said.map(|o| String::from_utf8_lossy(&o.stdout).trim().to_string());
    text.filter(|t| !t.is_empty()).unwrap_or_else(|| "unknown".into())
}
