//! Words and numbers of a file, with the place of what is wrong.

use std::fmt;

/// Where something stands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Place {
    /// A line of text, from 1.
    Line(usize),
    /// A line of an included file, by number of the file.
    LineOf(u32, usize),
    /// A byte of a binary file, from 0.
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

/// Why a file is no mesh.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub(crate) enum ReadError {
    /// Something that does not belong there.
    #[error("{place}: {key} = `{found}` is not allowed; allowed is {allowed}")]
    Found {
        /// Where.
        place: Place,
        /// What stands there.
        key: String,
        /// What was found.
        found: String,
        /// What would have been allowed.
        allowed: String,
    },
    /// A file that is cut off.
    #[error("{place}: the file ends where {expected} was expected")]
    End {
        /// The last place.
        place: Place,
        /// What should have been there.
        expected: String,
    },
    /// A file that cannot be included.
    #[error("{place}: `{file}` cannot be included: {reason}")]
    Include {
        /// Where it is named.
        place: Place,
        /// Its name there.
        file: String,
        /// Reason.
        reason: String,
    },
    /// An error within an included file.
    #[error("{file}, {error}")]
    Within {
        /// The file.
        file: String,
        /// The error, with its line.
        error: Box<ReadError>,
    },
    /// What belongs to no place.
    #[error("{what}; allowed is {allowed}")]
    Whole {
        /// What is wrong.
        what: String,
        /// What would have been allowed.
        allowed: &'static str,
    },
}

impl ReadError {
    /// Where it is, if at one place.
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

/// A word for a message, not too long.
pub(crate) fn shown(text: &[u8]) -> String {
    String::from_utf8_lossy(text).trim().chars().take(40).collect()
}

/// How numbers are written.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Encoding {
    /// As words.
    Text,
    /// As bytes.
    Binary {
        /// The most significant byte first?
        big_endian: bool,
        /// Are `size_t` of eight bytes, rather than four?
        long: bool,
    },
}

/// Reads bytes from front to back.
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

    /// What is left from a byte on.
    pub fn after(bytes: &'a [u8], at: usize, encoding: Encoding) -> Self {
        Self { bytes, at, encoding }
    }

    /// Bytes that are left.
    pub fn rest(&self) -> &'a [u8] {
        self.bytes.get(self.at..).unwrap_or_default()
    }

    pub fn at(&self) -> usize {
        self.at
    }

    /// The place of a byte; lines are counted only when something is wrong.
    pub fn place_of(&self, at: usize) -> Place {
        match self.encoding {
            Encoding::Text => {
                let before = self.bytes.get(..at).unwrap_or(self.bytes);
                // A carriage return alone ends a line, too.
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

    /// Is nothing left but blanks?
    pub fn is_done(&mut self) -> bool {
        self.skip_blanks();
        self.rest().is_empty()
    }

    /// The next word, and where it begins.
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

    /// What is left of the line; goes past its end.
    pub fn line(&mut self) -> &'a [u8] {
        let rest = self.rest();
        let length = rest.iter().position(|b| *b == b'\n').unwrap_or(rest.len());
        self.at += (length + 1).min(rest.len());
        rest[..length].trim_ascii()
    }

    /// The next word of the line; none at its end, a line feed or a carriage return.
    pub fn word_of_line(&mut self) -> Option<(usize, &'a [u8])> {
        let rest = self.rest();
        let blanks = rest.iter().take_while(|b| matches!(b, b' ' | b'\t' | 0x0b | 0x0c)).count();
        self.at += blanks;
        let word = rest[blanks..].split(u8::is_ascii_whitespace).next().filter(|word| !word.is_empty())?;
        self.at += word.len();
        Some((self.at - word.len(), word))
    }

    /// Goes past the next place where these bytes stand.
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

    /// The next bytes, the least significant first.
    pub fn raw<const N: usize>(&mut self, big_endian: bool, key: &str) -> Result<[u8; N], ReadError> {
        let mut raw = *self.rest().first_chunk::<N>().ok_or_else(|| self.end(key))?;
        if big_endian {
            raw.reverse();
        }
        self.at += N;
        Ok(raw)
    }

    /// A `size_t`: a count or a tag of a node or an element.
    pub fn size(&mut self, key: &str) -> Result<u64, ReadError> {
        match self.encoding {
            Encoding::Text => self.parsed(key, "a whole number that is not negative"),
            Encoding::Binary { big_endian, long: true } => self.raw(big_endian, key).map(u64::from_le_bytes),
            Encoding::Binary { big_endian, long: false } => {
                self.raw(big_endian, key).map(u32::from_le_bytes).map(u64::from)
            }
        }
    }

    /// An `int`: a tag of an entity, a dimension or a type.
    pub fn int(&mut self, key: &str) -> Result<i32, ReadError> {
        match self.encoding {
            Encoding::Text => self.parsed(key, "a whole number"),
            Encoding::Binary { big_endian, .. } => self.raw(big_endian, key).map(i32::from_le_bytes),
        }
    }

    /// A finite `double`.
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

    /// Blanks before a number that is a word; before one of bytes they would be part of it.
    pub fn skip_text_blanks(&mut self) {
        if self.encoding == Encoding::Text {
            self.skip_blanks();
        }
    }
}
