//! Reader of STL files.

/// Header of a binary file, bytes: a text of 80, then the number of triangles.
const HEAD: usize = 84;
/// Triangle of a binary file, bytes: normal, three corners, two bytes of attributes.
const RECORD: usize = 50;

/// Error of an STL file.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub(super) enum StlError {
    /// Neither a text nor a binary STL file.
    #[error(
        "this is no STL file: text must begin with the word `solid`, and a binary file has at least {HEAD} bytes (found {found})"
    )]
    NotStl {
        /// Number of bytes.
        found: u64,
    },
    /// Binary file that is truncated or too long for its number of triangles.
    #[error("a binary STL file of {triangles} triangles has {expected} bytes, but {found} were found")]
    Length {
        /// Number of triangles in the header.
        triangles: u32,
        /// Expected length, bytes.
        expected: u64,
        /// Length of the file, bytes.
        found: u64,
    },
    /// Coordinate in a binary file that is not finite.
    #[error("triangle {triangle} (counted from 0): coordinate {value} is not allowed; it must be finite")]
    Place {
        /// Triangle index.
        triangle: usize,
        /// Coordinate.
        value: f32,
    },
    /// Unexpected word.
    #[error("line {line}: expected {expected}, found `{found}`")]
    Word {
        /// Line number, from 1.
        line: usize,
        /// Expected word.
        expected: &'static str,
        /// Found word.
        found: String,
    },
    /// Truncated text file.
    #[error("the file ends in line {line}, where {expected} was expected")]
    End {
        /// Last line that is not empty, from 1.
        line: usize,
        /// Expected word.
        expected: &'static str,
    },
}

/// Read the triangles of all solids of a file, ASCII or binary, corners in the unit of the file. Up to 49 bytes, fewer than a triangle,
/// may follow the triangles of a binary file.
///
/// # Errors
/// [`StlError`] for anything but complete solids and blanks around them.
pub(super) fn triangles(bytes: &[u8]) -> Result<Vec<[[f64; 3]; 3]>, StlError> {
    let found = bytes.len() as u64;
    // Many binary files begin with the word that marks ASCII files, so check the length first.
    if is_binary(bytes) {
        return binary(bytes);
    }
    match count(bytes) {
        _ if is_text(bytes) => Reader::new(bytes).solids(),
        Some(triangles) => Err(StlError::Length { triangles, expected: length(triangles), found }),
        None => Err(StlError::NotStl { found }),
    }
}

/// Number of triangles if the file is binary.
fn count(bytes: &[u8]) -> Option<u32> {
    let head: &[u8; HEAD] = bytes.first_chunk()?;
    Some(u32::from_le_bytes([head[80], head[81], head[82], head[83]]))
}

/// Length of a binary file, bytes.
fn length(triangles: u32) -> u64 {
    HEAD as u64 + RECORD as u64 * u64::from(triangles)
}

/// True if a file has the length of a binary file with its number of triangles, or up to 49 bytes more.
pub(super) fn is_binary(bytes: &[u8]) -> bool {
    let more = count(bytes).and_then(|count| (bytes.len() as u64).checked_sub(length(count)));
    more.is_some_and(|more| more < RECORD as u64)
}

/// True if a file begins like text, given that [`is_binary`] is false.
fn is_text(bytes: &[u8]) -> bool {
    let start = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes).trim_ascii_start();
    let word = start.split(u8::is_ascii_whitespace).next().unwrap_or_default();
    // The number of triangles of a binary file contains a zero byte, which text does not.
    word.eq_ignore_ascii_case(b"solid") && !bytes.iter().take(HEAD).any(|b| *b == 0)
}

fn binary(bytes: &[u8]) -> Result<Vec<[[f64; 3]; 3]>, StlError> {
    let records = bytes.get(HEAD..).unwrap_or_default().chunks_exact(RECORD);
    let mut triangles = Vec::with_capacity(records.len());
    for (triangle, record) in records.enumerate() {
        let mut corners = [[0.0; 3]; 3];
        let numbers = record.chunks_exact(4).skip(3);
        for (coordinate, number) in corners.as_flattened_mut().iter_mut().zip(numbers) {
            let value = f32::from_le_bytes([number[0], number[1], number[2], number[3]]);
            if !value.is_finite() {
                return Err(StlError::Place { triangle, value });
            }
            *coordinate = f64::from(value);
        }
        triangles.push(corners);
    }
    Ok(triangles)
}

/// Tokenizer of a text file.
struct Reader<'a> {
    /// Rest of the line.
    rest: &'a [u8],
    /// Text after the line.
    after: &'a [u8],
    line: usize,
    /// Byte that ends a line.
    end: u8,
    /// Last line that contained a word.
    last: usize,
}

impl<'a> Reader<'a> {
    fn new(bytes: &'a [u8]) -> Self {
        let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
        // Old files end their lines with a single carriage return.
        let end = if bytes.contains(&b'\n') { b'\n' } else { b'\r' };
        let mut reader = Self { rest: &[], after: bytes, line: 0, end, last: 0 };
        reader.next_line();
        reader
    }

    /// Advance to the next line; `false` at the end of the file.
    fn next_line(&mut self) -> bool {
        if self.after.is_empty() {
            self.rest = &[];
            return false;
        }
        let length = self.after.iter().position(|b| *b == self.end).unwrap_or(self.after.len());
        let (line, after) = self.after.split_at(length);
        self.rest = line;
        self.after = after.get(1..).unwrap_or_default();
        self.line += 1;
        true
    }

    /// Read the next word of the file, if there is one.
    fn word(&mut self) -> Option<&'a [u8]> {
        loop {
            let text = self.rest.trim_ascii_start();
            if !text.is_empty() {
                let length = text.iter().position(u8::is_ascii_whitespace).unwrap_or(text.len());
                let (word, rest) = text.split_at(length);
                self.rest = rest;
                self.last = self.line;
                return Some(word);
            }
            if !self.next_line() {
                return None;
            }
        }
    }

    fn some_word(&mut self, expected: &'static str) -> Result<&'a [u8], StlError> {
        let last = self.last;
        self.word().ok_or(StlError::End { line: last, expected })
    }

    fn refuse(&self, expected: &'static str, word: &[u8]) -> StlError {
        let found = String::from_utf8_lossy(word).chars().take(40).collect();
        StlError::Word { line: self.last, expected, found }
    }

    /// Read these words and check that they match.
    fn expect(&mut self, words: &[&'static str]) -> Result<(), StlError> {
        for expected in words {
            let word = self.some_word(expected)?;
            if !word.eq_ignore_ascii_case(expected.as_bytes()) {
                return Err(self.refuse(expected, word));
            }
        }
        Ok(())
    }

    fn number(&mut self, expected: &'static str) -> Result<f64, StlError> {
        let word = self.some_word(expected)?;
        let value = std::str::from_utf8(word).ok().and_then(|text| text.parse().ok());
        value.ok_or_else(|| self.refuse(expected, word))
    }

    /// Read all solids of the file.
    fn solids(mut self) -> Result<Vec<[[f64; 3]; 3]>, StlError> {
        const SOLID: &str = "`solid` or the end of the file";
        let mut triangles = Vec::new();
        while let Some(word) = self.word() {
            if !word.eq_ignore_ascii_case(b"solid") {
                return Err(self.refuse(SOLID, word));
            }
            // The rest of the line is a name, which may contain any words.
            self.next_line();
            loop {
                const FACET: &str = "`facet` or `endsolid`";
                let word = self.some_word(FACET)?;
                if word.eq_ignore_ascii_case(b"endsolid") {
                    self.next_line();
                    break;
                }
                if !word.eq_ignore_ascii_case(b"facet") {
                    return Err(self.refuse(FACET, word));
                }
                triangles.push(self.facet()?);
            }
        }
        Ok(triangles)
    }

    /// Read the text between `facet` and `endfacet`.
    fn facet(&mut self) -> Result<[[f64; 3]; 3], StlError> {
        self.expect(&["normal"])?;
        for _ in 0..3 {
            // The order of the corners defines the outside, so that an invalid normal does no harm.
            self.number("a number of the normal")?;
        }
        self.expect(&["outer", "loop"])?;
        let mut corners = [[0.0; 3]; 3];
        for corner in &mut corners {
            self.expect(&["vertex"])?;
            for coordinate in corner {
                const FINITE: &str = "a finite coordinate";
                *coordinate = self.number(FINITE)?;
                if !coordinate.is_finite() {
                    return Err(self.refuse(FINITE, coordinate.to_string().as_bytes()));
                }
            }
        }
        self.expect(&["endloop", "endfacet"])?;
        Ok(corners)
    }
}
