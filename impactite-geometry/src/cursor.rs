//! Tokenizer of mesh files, with positions for error messages.

use std::fmt;

/// Position in a file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Place {
    /// Line of text, from 1.
    Line(usize),
    /// Line of an included file, by index of the file.
    LineOf(u32, usize),
    /// Byte of a binary file, from 0.
    Byte(usize),
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Place::Line(line) | Place::LineOf(_, line) => write!(f, "line {line}"),
            Place::Byte(byte) => write!(f, "byte {byte}"),
        }
    }
}

/// Error of a mesh reader.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub(crate) enum ReadError {
    /// Invalid value.
    #[error("{place}: {key} = `{found}` is not allowed; allowed is {allowed}")]
    Found {
        /// Position of the value.
        place: Place,
        /// Name of the quantity.
        key: String,
        /// Found value.
        found: String,
        /// Allowed values.
        allowed: String,
    },
    /// Truncated file.
    #[error("{place}: the file ends where {expected} was expected")]
    End {
        /// Last position.
        place: Place,
        /// Expected content.
        expected: String,
    },
    /// File that cannot be included.
    #[error("{place}: `{file}` cannot be included: {reason}")]
    Include {
        /// Position of the include directive.
        place: Place,
        /// File name in the directive.
        file: String,
        /// Reason.
        reason: String,
    },
    /// Error within an included file.
    #[error("{file}, {error}")]
    Within {
        /// Name of the included file.
        file: String,
        /// Error with its line.
        error: Box<ReadError>,
    },
    /// Error of the whole file, without a position.
    #[error("{what}; allowed is {allowed}")]
    Whole {
        /// Description of the error.
        what: String,
        /// Allowed content.
        allowed: &'static str,
    },
}

impl ReadError {
    /// Position of the error, if it has one.
    pub fn place(&self) -> Option<Place> {
        match self {
            ReadError::Found { place, .. }
            | ReadError::End { place, .. }
            | ReadError::Include { place, .. } => Some(*place),
            ReadError::Within { error, .. } => error.place(),
            ReadError::Whole { .. } => None,
        }
    }
}

/// Trim and shorten a word for a message.
pub(crate) fn shown(text: &[u8]) -> String {
    String::from_utf8_lossy(text).trim().chars().take(40).collect()
}

/// Encoding of numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Encoding {
    /// Text.
    Text,
    /// Bytes.
    Binary {
        /// True if the most significant byte is first.
        big_endian: bool,
        /// True if `size_t` has eight bytes, false for four.
        long: bool,
    },
}

/// Sequential reader of bytes.
pub(crate) struct Cursor<'a> {
    bytes: &'a [u8],
    at: usize,
    pub encoding: Encoding,
}

impl<'a> Cursor<'a> {
    pub fn new(bytes: &'a [u8]) -> Self {
        let at = if bytes.starts_with(b"\xef\xbb\xbf") { 3 } else { 0 };
        Self { bytes, at, encoding: Encoding::Text }
    }

    /// Create a reader that starts at byte `at`.
    pub fn after(bytes: &'a [u8], at: usize, encoding: Encoding) -> Self {
        Self { bytes, at, encoding }
    }

    /// Remaining bytes.
    pub fn rest(&self) -> &'a [u8] {
        self.bytes.get(self.at..).unwrap_or_default()
    }

    pub fn at(&self) -> usize {
        self.at
    }

    /// Position of a byte; lines are counted only for error messages.
    pub fn place_of(&self, at: usize) -> Place {
        match self.encoding {
            Encoding::Text => {
                let before = self.bytes.get(..at).unwrap_or(self.bytes);
                // A single carriage return also ends a line.
                let feeds = before.iter().filter(|b| **b == b'\n').count();
                let next = self.bytes.iter().skip(1).map(Some).chain([None]);
                let returns =
                    before.iter().zip(next).filter(|(b, next)| **b == b'\r' && *next != Some(&b'\n'));
                Place::Line(1 + feeds + returns.count())
            }
            Encoding::Binary { .. } => Place::Byte(at),
        }
    }

    pub fn refuse(&self, at: usize, key: &str, found: impl ToString, allowed: impl ToString) -> ReadError {
        let place = self.place_of(at);
        ReadError::Found { place, key: key.into(), found: found.to_string(), allowed: allowed.to_string() }
    }

    fn end(&self, expected: &str) -> ReadError {
        let last = self.bytes.trim_ascii_end().len();
        ReadError::End { place: self.place_of(last), expected: expected.into() }
    }

    fn skip_blanks(&mut self) {
        let rest = self.rest();
        self.at += rest.len() - rest.trim_ascii_start().len();
    }

    /// True if only blanks remain.
    pub fn is_done(&mut self) -> bool {
        self.skip_blanks();
        self.rest().is_empty()
    }

    /// Read the next word; return its start and bytes.
    pub fn word(&mut self, key: &str) -> Result<(usize, &'a [u8]), ReadError> {
        self.skip_blanks();
        let rest = self.rest();
        let length = rest.iter().position(u8::is_ascii_whitespace).unwrap_or(rest.len());
        if length == 0 {
            return Err(self.end(key));
        }
        let start = self.at;
        self.at += length;
        Ok((start, &rest[..length]))
    }

    /// Read the rest of the line and skip its end.
    pub fn line(&mut self) -> &'a [u8] {
        let rest = self.rest();
        let length = rest.iter().position(|b| *b == b'\n').unwrap_or(rest.len());
        self.at += (length + 1).min(rest.len());
        rest[..length].trim_ascii()
    }

    /// Read the next word of the line; `None` at its end, a line feed or a carriage return.
    pub fn word_of_line(&mut self) -> Option<(usize, &'a [u8])> {
        let rest = self.rest();
        let blanks = rest.iter().take_while(|b| matches!(b, b' ' | b'\t' | 0x0b | 0x0c)).count();
        self.at += blanks;
        let word = rest[blanks..].split(u8::is_ascii_whitespace).next().filter(|word| !word.is_empty())?;
        self.at += word.len();
        Some((self.at - word.len(), word))
    }

    /// Skip past the next occurrence of these bytes.
    pub fn skip_past(&mut self, text: &[u8]) -> Result<(), ReadError> {
        match self.rest().windows(text.len()).position(|w| w == text) {
            Some(found) => {
                self.at += found + text.len();
                Ok(())
            }
            None => Err(self.end(&shown(text))),
        }
    }

    fn parsed<T: std::str::FromStr>(&mut self, key: &str, allowed: &str) -> Result<T, ReadError> {
        let (start, word) = self.word(key)?;
        let value = std::str::from_utf8(word).ok().and_then(|text| text.parse().ok());
        value.ok_or_else(|| self.refuse(start, key, shown(word), allowed))
    }

    /// Read the next `N` bytes in little-endian order.
    pub fn raw<const N: usize>(&mut self, big_endian: bool, key: &str) -> Result<[u8; N], ReadError> {
        let mut raw = *self.rest().first_chunk::<N>().ok_or_else(|| self.end(key))?;
        if big_endian {
            raw.reverse();
        }
        self.at += N;
        Ok(raw)
    }

    /// Read a `size_t`: a count or a tag of a node or an element.
    pub fn size(&mut self, key: &str) -> Result<u64, ReadError> {
        match self.encoding {
            Encoding::Text => self.parsed(key, "a whole number that is not negative"),
            Encoding::Binary { big_endian, long: true } => self.raw(big_endian, key).map(u64::from_le_bytes),
            Encoding::Binary { big_endian, long: false } => {
                self.raw(big_endian, key).map(u32::from_le_bytes).map(u64::from)
            }
        }
    }

    /// Read an `int`: a tag of an entity, a dimension or a type.
    pub fn int(&mut self, key: &str) -> Result<i32, ReadError> {
        match self.encoding {
            Encoding::Text => self.parsed(key, "a whole number"),
            Encoding::Binary { big_endian, .. } => self.raw(big_endian, key).map(i32::from_le_bytes),
        }
    }

    /// Read a finite `double`.
    pub fn double(&mut self, key: &str) -> Result<f64, ReadError> {
        const ALLOWED: &str = "a finite number";
        self.skip_text_blanks();
        let start = self.at;
        let value: f64 = match self.encoding {
            Encoding::Text => self.parsed(key, ALLOWED)?,
            Encoding::Binary { big_endian, .. } => self.raw(big_endian, key).map(f64::from_le_bytes)?,
        };
        if value.is_finite() { Ok(value) } else { Err(self.refuse(start, key, value, ALLOWED)) }
    }

    /// Skip blanks before a number in text; in binary files such bytes belong to the number.
    pub fn skip_text_blanks(&mut self) {
        if self.encoding == Encoding::Text {
            self.skip_blanks();
        }
    }
}
