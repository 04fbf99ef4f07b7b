//! What is wrong with a file, and where.

use std::fmt;
use std::path::PathBuf;

use impactite::output::printable;
use impactite_scene_file::remedy::in_scene_files;

/// A message of the libraries for whoever wrote a scene file: remedies by the keys of such files, and no character that steers a terminal.
///
/// ```
/// let shown = impactite_input::shown("body `a\u{1b}[31m` trembles; take `Method::impact`");
/// assert_eq!(shown, "body `a\\u{1b}[31m` trembles; take `method.mpm.for = \"impact\"`");
/// ```
#[must_use]
pub fn shown(message: &str) -> String {
    printable(&in_scene_files(message)).into_owned()
}

/// Why a file is no scene.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum InputError {
    /// A file that cannot be read.
    #[error("cannot read `{}`: {source}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// What the operating system said.
        source: std::io::Error,
    },
    /// Something in it.
    #[error(transparent)]
    At(#[from] Box<Fault>),
    /// A change of a key that was asked for beside the file.
    #[error("--set {assignment}: {why}")]
    Set {
        /// As it was given.
        assignment: String,
        /// What is wrong with it.
        why: String,
    },
}

/// Error in a file, with its place. [`Display`](fmt::Display) shows the line with a mark below it, and no character that steers a
/// terminal.
#[derive(Clone, Debug, PartialEq)]
pub struct Fault {
    /// Name of the file.
    pub file: String,
    /// Line, from 1; none where the whole file is meant.
    pub line: Option<usize>,
    /// Column in characters, from 1.
    pub column: usize,
    /// Characters that are meant.
    pub width: usize,
    /// The text of the line.
    pub text: String,
    /// The key, as `bodies.rod.velocity`; empty for the whole file.
    pub key: String,
    /// What is wrong.
    pub message: String,
    /// What to do.
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
            // A mark at the place of a tab is below it, whatever its width.
            let before: String =
                self.text.chars().take(self.column - 1).map(|c| if c == '\t' { '\t' } else { ' ' }).collect();
            // One mark a character, so that those below stay where they are.
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
