//! Lexer of Abaqus input files: keywords and data lines, with included files. After the Abaqus Analysis User's Guide, "Input syntax rules",
//! and the Keywords Reference Guide, *INCLUDE.

use std::borrow::Cow;
use std::ops::Range;
use std::path::{Path, PathBuf};

use crate::cursor::{Place, ReadError, shown};
use crate::file::{Kind, MOST_BYTES, read};

/// Maximum depth of nested includes.
const MOST_DEPTH: usize = 16;
/// Maximum number of files of a mesh.
const MOST_FILES: usize = 10_000;
/// Minimum number of letters of an abbreviated keyword and of an abbreviated parameter.
const FEWEST_LETTERS: [usize; 2] = [4, 3];

/// Source position: a line of one of the files.
#[derive(Clone, Copy, Debug)]
pub struct At {
    /// File index; 0 is the main file.
    file: u32,
    /// Line number, from 1.
    line: u32,
}

impl At {
    pub fn same_line(self, other: At) -> bool {
        (self.file, self.line) == (other.file, other.line)
    }
}

/// Comma-separated value with its source position.
pub type Field<'a> = (At, &'a str);

/// Keyword with its parameters; names are in capitals without blanks.
pub struct Keyword {
    pub at: At,
    pub name: String,
    parameters: Vec<(String, Option<String>)>,
}

/// Line that is neither empty nor a comment, as a range of bytes in its file.
struct Line {
    at: At,
    bytes: Range<usize>,
}

/// Decoded file.
struct File<'a> {
    name: String,
    text: Cow<'a, str>,
}

/// Keyword and the index of its first data line.
struct Block {
    keyword: Keyword,
    first: usize,
}

/// Text of all files of a mesh, concatenated.
#[derive(Default)]
pub struct Text<'a> {
    files: Vec<File<'a>>,
    /// Data lines of all files.
    lines: Vec<Line>,
    blocks: Vec<Block>,
    bytes: u64,
    /// Folder of the main file; `None` if it was read from memory.
    folder: Option<PathBuf>,
    /// Include stack: files that are being read, outermost first.
    open: Vec<PathBuf>,
}

fn place(at: At) -> Place {
    match at.file {
        0 => Place::Line(at.line as usize),
        file => Place::LineOf(file, at.line as usize),
    }
}

pub fn refuse(at: At, key: &str, found: impl ToString, allowed: impl ToString) -> ReadError {
    let (key, found, allowed) = (key.into(), found.to_string(), allowed.to_string());
    ReadError::Found { place: place(at), key, found, allowed }
}

pub fn end(at: At, expected: String) -> ReadError {
    ReadError::End { place: place(at), expected }
}

/// Parse a number from a field.
pub fn number<T: std::str::FromStr>((at, text): Field, key: &str, allowed: &str) -> Result<T, ReadError> {
    text.parse().map_err(|_| refuse(at, key, shown(text.as_bytes()), allowed))
}

/// Parse a finite number from a field; an empty field is zero. Fortran exponents such as 1.0D-3 are allowed.
pub fn real(field: Field, key: &str) -> Result<f64, ReadError> {
    const ALLOWED: &str = "a finite number";
    if field.1.is_empty() {
        return Ok(0.0);
    }
    let value: f64 = if field.1.contains(['d', 'D']) {
        number((field.0, &field.1.replace(['d', 'D'], "e")), key, ALLOWED)?
    } else {
        number(field, key, ALLOWED)?
    };
    if value.is_finite() { Ok(value) } else { Err(refuse(field.0, key, field.1, ALLOWED)) }
}

/// Split a line at commas and trim blanks; commas within double quotes belong to a value.
fn split(text: &str) -> impl Iterator<Item = &str> {
    let mut quoted = false;
    let fields = text.split(move |c: char| {
        quoted ^= c == '"';
        c == ',' && !quoted
    });
    fields.map(str::trim)
}

/// Strip the quotes of a name.
pub fn unquoted(name: &str) -> &str {
    name.trim().trim_matches('"').trim()
}

impl Keyword {
    fn parse(at: At, text: &str) -> Result<Self, ReadError> {
        let capitals = |s: &str| s.split_whitespace().collect::<String>().to_ascii_uppercase();
        let mut parts = split(text.trim_start_matches('*'));
        let name = capitals(parts.next().unwrap_or_default());
        if name.is_empty() {
            return Err(refuse(at, "keyword", text, "a name after the star"));
        }
        let parameters = parts.filter(|p| !p.is_empty()).map(|p| match p.split_once('=') {
            Some((key, value)) => (capitals(key), Some(unquoted(value).to_string())),
            None => (capitals(p), None),
        });
        Ok(Self { at, parameters: parameters.collect(), name })
    }

    /// True if this keyword is `name` or an abbreviation of it.
    pub fn is(&self, name: &str) -> bool {
        is(&self.name, name, FEWEST_LETTERS[0])
    }

    /// Reject parameters other than these.
    pub fn allow(&self, allowed: &[&str]) -> Result<(), ReadError> {
        let known = |key: &str| allowed.iter().any(|name| is(key, name, FEWEST_LETTERS[1]));
        match self.parameters.iter().find(|(key, _)| !known(key)) {
            Some((key, _)) => {
                let what = format!("parameter of *{}", self.name);
                Err(refuse(self.at, &what, key, format!("one of {}", allowed.join(", "))))
            }
            None => Ok(()),
        }
    }

    pub fn get(&self, key: &str) -> Option<&str> {
        let found = self.parameters.iter().find(|(k, _)| is(k, key, FEWEST_LETTERS[1]));
        found?.1.as_deref().filter(|v| !v.is_empty())
    }

    pub fn has(&self, key: &str) -> bool {
        self.parameters.iter().any(|(k, _)| is(k, key, FEWEST_LETTERS[1]))
    }

    pub fn need(&self, key: &str) -> Result<&str, ReadError> {
        let missing = || refuse(self.at, &format!("*{}", self.name), "", format!("a parameter {key}=..."));
        self.get(key).ok_or_else(missing)
    }
}

fn is(written: &str, name: &str, fewest: usize) -> bool {
    written == name || (written.len() >= fewest && name.starts_with(written))
}

/// Split a text into lines that are neither empty nor comments. Line ends are a line feed, a carriage return, or both.
fn lines(text: &str, file: u32) -> Result<Vec<Line>, ReadError> {
    let (mut found, mut start, mut line) = (Vec::new(), 0, 0u32);
    while start < text.len() {
        line = u32::saturating_add(line, 1);
        let rest = &text[start..];
        let length = rest.find(['\n', '\r']).unwrap_or(rest.len());
        let words = rest[..length].trim();
        let at = At { file, line };
        if words.contains('\0') {
            return Err(refuse(at, "line", shown(words.as_bytes()), "text"));
        }
        if !words.is_empty() && !words.starts_with("**") {
            let first = start + length - rest[..length].trim_start().len();
            found.push(Line { at, bytes: first..first + words.len() });
        }
        start += length + if rest[length..].starts_with("\r\n") { 2 } else { 1 };
    }
    Ok(found)
}

/// True for the continuation of a keyword line: parameters begin with letters. Numbers are data that follow a superfluous comma.
fn is_parameter(text: &str) -> bool {
    text.starts_with(|c: char| c.is_alphabetic())
}

impl<'a> Text<'a> {
    /// Read a file and its included files.
    pub fn load(&mut self, bytes: &'a [u8], path: Option<&Path>) -> Result<(), ReadError> {
        if let Some(path) = path {
            self.folder = Some(path.parent().map(PathBuf::from).unwrap_or_default());
            self.open.extend(std::fs::canonicalize(path));
        }
        let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
        let text = match std::str::from_utf8(bytes) {
            Ok(text) => Cow::Borrowed(text),
            Err(_) => Cow::Owned(latin(bytes)),
        };
        self.bytes += bytes.len() as u64;
        self.file(String::new(), text, self.folder.clone().as_deref())
    }

    fn text(&self, line: &Line) -> &str {
        &self.files[line.at.file as usize].text[line.bytes.clone()]
    }

    /// Add the lines of a file in a folder.
    fn file(&mut self, name: String, text: Cow<'a, str>, folder: Option<&Path>) -> Result<(), ReadError> {
        let file = self.files.len() as u32;
        let found = lines(&text, file);
        self.files.push(File { name, text });
        let mut rest = found?.into_iter().peekable();
        while let Some(line) = rest.next() {
            let text = self.text(&line);
            if !text.starts_with('*') {
                if self.blocks.is_empty() {
                    let found = shown(text.as_bytes());
                    return Err(refuse(line.at, "first line", found, "a keyword, as *HEADING or *NODE"));
                }
                self.lines.push(line);
                continue;
            }
            let mut words = text.to_string();
            while words.ends_with(',')
                && let Some(next) = rest.next_if(|next| is_parameter(self.text(next)))
            {
                words.push_str(self.text(&next));
            }
            let keyword = Keyword::parse(line.at, &words)?;
            let include = keyword.is("INCLUDE");
            let source = if include {
                keyword.allow(&["INPUT"])?;
                Some(keyword.need("INPUT")?)
            } else {
                // Data lines of nodes and elements may be in a separate file.
                keyword.get("INPUT").filter(|_| keyword.is("NODE") || keyword.is("ELEMENT"))
            };
            let source = source.map(String::from);
            if !include {
                self.blocks.push(Block { keyword, first: self.lines.len() });
            }
            if let Some(source) = source {
                self.include(line.at, &source, folder)?;
            }
        }
        Ok(())
    }

    /// Add the lines of an included file, searched for in the folder of the including file, then in that of the main file.
    fn include(&mut self, at: At, name: &str, folder: Option<&Path>) -> Result<(), ReadError> {
        let refuse = |reason: String| ReadError::Include { place: place(at), file: name.into(), reason };
        let (Some(folder), Some(main)) = (folder, &self.folder) else {
            return Err(refuse("these bytes are of no folder; read the file by its path".into()));
        };
        let portable = name.replace('\\', "/");
        let places = [folder.join(name), folder.join(&portable), main.join(name), main.join(&portable)];
        let path = places.iter().find(|path| path.exists()).unwrap_or(&places[0]).clone();
        let known = std::fs::canonicalize(&path).map_err(|e| refuse(format!("{}: {e}", path.display())))?;
        if let Some(first) = self.open.iter().position(|open| *open == known) {
            let cycle = self.open[first..].iter().chain([&known]);
            let names: Vec<String> = cycle.map(|path| path.display().to_string()).collect();
            return Err(refuse(format!("it includes itself: {}", names.join(" -> "))));
        }
        if self.open.len() > MOST_DEPTH {
            return Err(refuse(format!("at most {MOST_DEPTH} files may include each other in a row")));
        }
        if self.files.len() >= MOST_FILES {
            return Err(refuse(format!("at most {MOST_FILES} files may be included")));
        }
        let bytes =
            read(&path, Kind::Abaqus).map_err(|reason| refuse(format!("{}: {reason}", path.display())))?;
        self.bytes += bytes.len() as u64;
        if self.bytes > MOST_BYTES {
            return Err(refuse(format!("files of a mesh may have {MOST_BYTES} bytes together at most")));
        }
        let bytes = match bytes.strip_prefix(b"\xef\xbb\xbf") {
            Some(rest) => rest.to_vec(),
            None => bytes,
        };
        let text = String::from_utf8(bytes).unwrap_or_else(|e| latin(e.as_bytes()));
        let folder = path.parent().map(PathBuf::from).unwrap_or_default();
        self.open.push(known);
        self.file(path.display().to_string(), Cow::Owned(text), Some(&folder))?;
        self.open.pop();
        Ok(())
    }

    /// Iterate over the keywords, each with its data lines.
    pub fn blocks(&self) -> impl Iterator<Item = (&Keyword, Data<'_>)> {
        self.blocks.iter().enumerate().map(|(n, block)| {
            let end = self.blocks.get(n + 1).map_or(self.lines.len(), |next| next.first);
            (&block.keyword, Data { text: self, lines: block.first..end })
        })
    }

    /// Add the name of the file to an error.
    pub fn named(&self, error: ReadError) -> ReadError {
        match error.place() {
            Some(Place::LineOf(file, _)) => match self.files.get(file as usize) {
                Some(file) => ReadError::Within { file: file.name.clone(), error: Box::new(error) },
                None => error,
            },
            _ => error,
        }
    }
}

/// Decode text that is not valid UTF-8 as Latin-1: every byte is a character.
fn latin(bytes: &[u8]) -> String {
    bytes.iter().map(|&b| char::from(b)).collect()
}

/// Data lines of a keyword.
#[derive(Clone)]
pub struct Data<'t> {
    text: &'t Text<'t>,
    lines: Range<usize>,
}

impl<'t> Data<'t> {
    /// Lines with their source positions.
    pub fn lines(&self) -> impl Iterator<Item = Field<'t>> + use<'t> {
        let text = self.text;
        text.lines[self.lines.clone()].iter().map(|line| (line.at, text.text(line)))
    }

    /// Source position of the last line.
    pub fn last(&self) -> Option<At> {
        self.text.lines[self.lines.clone()].last().map(|line| line.at)
    }
}

/// Values of a line; trailing commas add no empty values.
pub fn fields((at, text): Field) -> impl Iterator<Item = Field> {
    split(text.trim_end_matches([',', ' ', '\t'])).map(move |field| (at, field))
}
