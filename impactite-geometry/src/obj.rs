//! Reader of Wavefront OBJ files: the lines `v` and `f`.

use super::cursor::{Place, ReadError, shown};
use super::triangles::{Triangles, fan};

/// Read vertices and triangles of a file, in its unit.
///
/// # Errors
/// [`ReadError`] for a vertex without three finite coordinates, and a face without three vertices of the file.
pub(super) fn triangles(bytes: &[u8]) -> Result<Triangles, ReadError> {
    let (mut vertices, mut triangles) = (Vec::new(), Vec::new());
    let mut corners = Vec::new();
    // Largest vertex index and the line of its face: vertices may follow the faces that use them.
    let mut largest = (0, 0);
    for (number, line) in Lines::new(bytes) {
        let refuse = |key: &str, found: &[u8], allowed: &str| ReadError::Found {
            place: Place::Line(number),
            key: key.into(),
            found: shown(found),
            allowed: allowed.into(),
        };
        let said = line.split(|b| *b == b'#').next().unwrap_or_default();
        let mut words = said.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty());
        match words.next() {
            Some(b"v") => {
                let mut x = [0.0; 3];
                for coordinate in &mut x {
                    let word = words.next().unwrap_or_default();
                    let value = parsed::<f64>(word).filter(|value| value.is_finite());
                    *coordinate =
                        value.ok_or_else(|| refuse("coordinate of a vertex", word, "a finite number"))?;
                }
                // A fourth number is a weight; colours follow.
                vertices.push(x);
            }
            Some(b"f") => {
                const ALLOWED: &str =
                    "the number of a vertex, from 1 or, counted back from the last one, from -1";
                corners.clear();
                for word in words {
                    // Vertex / texture / normal.
                    let vertex = word.split(|b| *b == b'/').next().unwrap_or_default();
                    let wrong = || refuse("vertex of a face", word, ALLOWED);
                    let corner = match parsed::<i64>(vertex).ok_or_else(wrong)? {
                        0 => return Err(wrong()),
                        back @ ..0 => vertices.len().checked_sub(back.unsigned_abs() as usize),
                        front => Some(front as usize - 1),
                    };
                    corners.push(corner.ok_or_else(wrong)?);
                }
                if corners.len() < 3 {
                    let found = format!("{} vertices", corners.len());
                    return Err(refuse("face", found.as_bytes(), "three vertices or more"));
                }
                let last = corners.iter().copied().max().unwrap_or(0);
                largest = largest.max((last, number));
                fan(&corners, &mut triangles);
            }
            _ => {}
        }
    }
    if largest.0 >= vertices.len() && !triangles.is_empty() {
        let (found, place) = ((largest.0 + 1).to_string(), Place::Line(largest.1));
        let allowed = format!("at most {}, the number of vertices of the file", vertices.len());
        return Err(ReadError::Found { place, key: "vertex of a face".into(), found, allowed });
    }
    Ok((vertices, triangles))
}

fn parsed<T: std::str::FromStr>(word: &[u8]) -> Option<T> {
    std::str::from_utf8(word).ok()?.parse().ok()
}

/// Logical lines with the number of their first line; a backslash joins lines. Line ends are a line feed, a carriage return, or both.
struct Lines<'a> {
    rest: &'a [u8],
    number: usize,
}

impl<'a> Lines<'a> {
    fn new(bytes: &'a [u8]) -> Self {
        Self { rest: bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes), number: 0 }
    }
}

impl Iterator for Lines<'_> {
    type Item = (usize, Vec<u8>);

    fn next(&mut self) -> Option<Self::Item> {
        let (first, mut line) = (self.number + 1, Vec::new());
        while !self.rest.is_empty() {
            let length = self.rest.iter().position(|b| matches!(b, b'\n' | b'\r')).unwrap_or(self.rest.len());
            let (part, after) = self.rest.split_at(length);
            self.rest = after.strip_prefix(b"\r\n").or_else(|| after.get(1..)).unwrap_or_default();
            self.number += 1;
            let part = part.trim_ascii_end();
            line.extend_from_slice(part.strip_suffix(b"\\").unwrap_or(part));
            if !part.ends_with(b"\\") {
                break;
            }
            line.push(b' ');
        }
        (self.number >= first).then_some((first, line))
    }
}
