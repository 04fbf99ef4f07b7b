//! Errors in scene files, with their positions.

use std::fmt;
use std::path::PathBuf;

use impactite::output::printable;
use impactite_scene_file::remedy::in_scene_files;

/// Convert a library message for authors of scene files: remedies by keys of such files, without terminal control characters.
///
/// ```
/// let shown = impactite_input::shown("body `a\u{1b}[31m` trembles; take `Method::impact`");
/// assert_eq!(shown, "body `a\\u{1b}[31m` trembles; take `method.mpm.for = \"impact\"`");
/// ```
#[must_use]
pub fn shown(message: &str) -> String {
    printable(&in_scene_files(message)).into_owned()
}

/// Error of reading a scene file.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum InputError {
    /// Unreadable file.
    #[error("cannot read `{}`: {source}", path.display())]
    Read {
        /// Path of the file.
        path: PathBuf,
        /// Error of the operating system.
        source: std::io::Error,
    },
    /// Error at a position in the file.
    #[error(transparent)]
    At(#[from] Box<Fault>),
    /// Invalid change of a key.
    #[error("--set {assignment}: {why}")]
    Set {
        /// Assignment as entered.
        assignment: String,
        /// Reason.
        why: String,
    },
}

/// Error in a file, with its position. [`Display`](fmt::Display) shows the line with a mark below it, without terminal control characters.
#[derive(Clone, Debug, PartialEq)]
pub struct Fault {
    /// Name of the file.
    pub file: String,
    /// Line, from 1; `None` for the whole file.
    pub line: Option<usize>,
    /// Column in characters, from 1.
    pub column: usize,
    /// Number of marked characters.
    pub width: usize,
    /// Text of the line.
    pub text: String,
    /// Key, as `bodies.rod.velocity`; empty for the whole file.
    pub key: String,
    /// Description of the error.
    pub message: String,
    /// Suggested remedy.
    pub help: Option<String>,
}

impl std::error::Error for Fault {}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", printable(&self.file))?;
        if let Some(line) = self.line {
            write!(f, ":{line}:{}", self.column)?;
        }
        write!(f, ": ")?;
        if !self.key.is_empty() {
            write!(f, "{}: ", printable(&self.key))?;
        }
        write!(f, "{}", printable(&self.message))?;
        if let Some(line) = self.line {
            let number = line.to_string();
            let blank = " ".repeat(number.len());
            // Repeat tabs in the blank line, so that the mark is aligned whatever their width.
            let before: String =
                self.text.chars().take(self.column - 1).map(|c| if c == '\t' { '\t' } else { ' ' }).collect();
            // Replace each control character by one character, so that the marks stay aligned.
            let steers = |c: char| c != '\t' && printable(c.encode_utf8(&mut [0; 4])).len() > c.len_utf8();
            let text: String = self.text.chars().map(|c| if steers(c) { '\u{fffd}' } else { c }).collect();
            write!(
                f,
                "\n {blank} |\n {number} | {text}\n {blank} | {before}{}",
                "^".repeat(self.width.max(1))
            )?;
        }
        if let Some(help) = &self.help {
            write!(f, "\n help: {}", printable(help))?;
        }
        Ok(())
    }
}
