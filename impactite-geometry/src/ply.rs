//! Reader of PLY files. After Greg Turk's description of the format (1994).

use super::cursor::{Cursor, Encoding, Place, ReadError, shown};
use super::triangles::{Triangles, fan};

/// Number type.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Scalar {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

const SCALARS: &str = "char, uchar, short, ushort, int, uint, float, double, or int8 to float64";

impl Scalar {
    fn of(name: &[u8]) -> Option<Self> {
        Some(match name {
            b"char" | b"int8" => Scalar::I8,
            b"uchar" | b"uint8" => Scalar::U8,
            b"short" | b"int16" => Scalar::I16,
            b"ushort" | b"uint16" => Scalar::U16,
            b"int" | b"int32" => Scalar::I32,
            b"uint" | b"uint32" => Scalar::U32,
            b"float" | b"float32" => Scalar::F32,
            b"double" | b"float64" => Scalar::F64,
            _ => return None,
        })
    }

    /// Read the next number: all types are exact in double precision.
    fn read(self, cursor: &mut Cursor, key: &str) -> Result<f64, ReadError> {
        let Encoding::Binary { big_endian: big, .. } = cursor.encoding else {
            let line_end = ReadError::End { place: cursor.place_of(cursor.at()), expected: key.into() };
            let (at, word) = cursor.word_of_line().ok_or(line_end)?;
            let value = std::str::from_utf8(word).ok().and_then(|text| text.parse().ok());
            return value.ok_or_else(|| cursor.refuse(at, key, shown(word), "a number"));
        };
        Ok(match self {
            Scalar::I8 => i8::from_le_bytes(cursor.raw(big, key)?).into(),
            Scalar::U8 => u8::from_le_bytes(cursor.raw(big, key)?).into(),
            Scalar::I16 => i16::from_le_bytes(cursor.raw(big, key)?).into(),
            Scalar::U16 => u16::from_le_bytes(cursor.raw(big, key)?).into(),
            Scalar::I32 => i32::from_le_bytes(cursor.raw(big, key)?).into(),
            Scalar::U32 => u32::from_le_bytes(cursor.raw(big, key)?).into(),
            Scalar::F32 => f32::from_le_bytes(cursor.raw(big, key)?).into(),
            Scalar::F64 => f64::from_le_bytes(cursor.raw(big, key)?),
        })
    }
}

/// Property of an element.
struct Property {
    name: Vec<u8>,
    /// Names of property and element, for messages.
    key: String,
    /// Type of the length of a list; `None` for a single number.
    length: Option<Scalar>,
    scalar: Scalar,
}

/// Element type: a number of elements with the same properties.
struct Element {
    name: Vec<u8>,
    count: u64,
    properties: Vec<Property>,
}

/// Read vertices and triangles of a file, in its unit.
///
/// # Errors
/// [`ReadError`] for an invalid header or invalid data, and for a file without vertex positions or face corners.
pub(super) fn triangles(bytes: &[u8]) -> Result<Triangles, ReadError> {
    let (elements, mut cursor) = header(bytes)?;
    let count = elements.iter().find(|e| e.name == b"vertex").map_or(0, |e| e.count);
    let (mut vertices, mut triangles) = (Vec::new(), Vec::new());
    for element in elements.iter().filter(|e| !e.properties.is_empty()) {
        for _ in 0..element.count {
            if cursor.encoding == Encoding::Text && cursor.is_done() {
                let expected = format!("element {}", shown(&element.name));
                return Err(ReadError::End { place: cursor.place_of(cursor.at()), expected });
            }
            match &element.name[..] {
                b"vertex" => vertices.push(vertex(&mut cursor, element)?),
                b"face" => face(&mut cursor, element, count, &mut triangles)?,
                _ => read(&mut cursor, element, |_, _, _, _| Ok(()))?,
            }
            if cursor.encoding == Encoding::Text
                && let Some((at, word)) = cursor.word_of_line()
            {
                let key = format!("line of element {}", shown(&element.name));
                return Err(cursor.refuse(at, &key, shown(word), "the numbers of its properties alone"));
            }
        }
    }
    // Some programs append a line feed or zeros to a file.
    let rest = cursor.rest();
    if let Some(more) = rest.iter().position(|b| !(b.is_ascii_whitespace() || *b == 0)) {
        let at = cursor.at() + more;
        let found = shown(&rest[more..]);
        return Err(cursor.refuse(at, "rest of the file", found, "nothing after the last element"));
    }
    Ok((vertices, triangles))
}

/// Parse the header; return the elements and the data after the header.
fn header(bytes: &[u8]) -> Result<(Vec<Element>, Cursor<'_>), ReadError> {
    let end: &[u8] = match bytes {
        [b'p', b'l', b'y', b'\r', b'\n', ..] => b"\r\n",
        [b'p', b'l', b'y', b'\r', ..] => b"\r",
        _ => b"\n",
    };
    let (mut at, mut number) = (0, 0);
    let mut encoding = None;
    let mut elements: Vec<Element> = Vec::new();
    loop {
        number += 1;
        let rest = bytes.get(at..).unwrap_or_default();
        if rest.is_empty() {
            return Err(ReadError::End { place: Place::Line(number), expected: "end_header".into() });
        }
        let length = rest.windows(end.len()).position(|w| w == end);
        let line = &rest[..length.unwrap_or(rest.len())];
        at += length.map_or(rest.len(), |length| length + end.len());
        let refuse = |key: &str, allowed: &str| ReadError::Found {
            place: Place::Line(number),
            key: key.into(),
            found: shown(line),
            allowed: allowed.into(),
        };
        let words: Vec<&[u8]> = line.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty()).collect();
        match words[..] {
            [b"ply"] if number == 1 => {}
            _ if number == 1 => return Err(refuse("first line", "ply")),
            [] | [b"comment" | b"obj_info", ..] => {}
            [b"format", format, b"1.0"] if encoding.is_none() => {
                encoding = Some(match format {
                    b"ascii" => Encoding::Text,
                    b"binary_little_endian" => Encoding::Binary { big_endian: false, long: false },
                    b"binary_big_endian" => Encoding::Binary { big_endian: true, long: false },
                    _ => {
                        let allowed = "format ascii, binary_little_endian or binary_big_endian 1.0";
                        return Err(refuse("format", allowed));
                    }
                });
            }
            [b"format", ..] => {
                return Err(refuse("format", "one, as format ascii 1.0 or format binary_little_endian 1.0"));
            }
            [b"element", name, count] => {
                let count = std::str::from_utf8(count).ok().and_then(|count| count.parse().ok());
                let count =
                    count.ok_or_else(|| refuse("element", "element, its name, and a whole number"))?;
                if elements.iter().any(|e| e.name == name) {
                    return Err(refuse("element", "each element once"));
                }
                elements.push(Element { name: name.into(), count, properties: Vec::new() });
            }
            [b"property", ref types @ .., name] => {
                let (length, scalar) = match types {
                    [b"list", length, scalar] => (Some(Scalar::of(length)), Scalar::of(scalar)),
                    [scalar] => (None, Scalar::of(scalar)),
                    _ => (None, None),
                };
                let wrong = || {
                    refuse(
                        "property",
                        &format!("property TYPE NAME or property list TYPE TYPE NAME of {SCALARS}"),
                    )
                };
                let scalar = scalar.ok_or_else(wrong)?;
                let length = match length {
                    Some(length) => Some(length.ok_or_else(wrong)?),
                    None => None,
                };
                let element =
                    elements.last_mut().ok_or_else(|| refuse("property", "an element before it"))?;
                let key = format!("property {} of element {}", shown(name), shown(&element.name));
                element.properties.push(Property { name: name.into(), key, length, scalar });
            }
            [b"end_header"] => break,
            _ => {
                return Err(refuse(
                    "line of the header",
                    "format, comment, obj_info, element, property or end_header",
                ));
            }
        }
    }
    let missing = |what: &str, allowed| ReadError::Whole { what: what.into(), allowed };
    let encoding = encoding.ok_or_else(|| missing("the header has no line format", "format ascii 1.0"))?;
    let properties = |name: &[u8]| elements.iter().find(|e| e.name == name).map(|e| &e.properties);
    let is_place = |name: &[u8]| {
        let found = properties(b"vertex").and_then(|list| list.iter().find(|p| p.name == name));
        found.is_some_and(|property| property.length.is_none())
    };
    if !(is_place(b"x") && is_place(b"y") && is_place(b"z")) {
        return Err(missing("the vertices have no places", "element vertex with properties x, y and z"));
    }
    let is_corners = |property: &Property| property.length.is_some() && is_corners(property);
    if !properties(b"face").is_some_and(|list| list.iter().any(is_corners)) {
        let allowed = "element face with a list vertex_indices or vertex_index";
        return Err(missing("the faces have no corners", allowed));
    }
    Ok((elements, Cursor::after(bytes, at, encoding)))
}

fn is_corners(property: &Property) -> bool {
    matches!(&property.name[..], b"vertex_indices" | b"vertex_index")
}

/// Read an element; call `take` for every number with its property and position.
fn read(
    cursor: &mut Cursor,
    element: &Element,
    mut take: impl FnMut(&Cursor, &Property, usize, f64) -> Result<(), ReadError>,
) -> Result<(), ReadError> {
    for property in &element.properties {
        let key = &property.key;
        let numbers = match property.length {
            Some(length) => {
                let at = cursor.at();
                let count = length.read(cursor, key)?;
                if !(count >= 0.0 && count.fract() == 0.0 && count <= f64::from(u32::MAX)) {
                    let key = format!("length of {key}");
                    return Err(cursor.refuse(at, &key, count, "a whole number that is not negative"));
                }
                count as u64
            }
            None => 1,
        };
        for _ in 0..numbers {
            let at = cursor.at();
            let value = property.scalar.read(cursor, key)?;
            take(cursor, property, at, value)?;
        }
    }
    Ok(())
}

fn vertex(cursor: &mut Cursor, element: &Element) -> Result<[f64; 3], ReadError> {
    let mut x = [0.0; 3];
    read(cursor, element, |cursor, property, at, value| {
        if let [name @ b'x'..=b'z'] = property.name[..] {
            if !value.is_finite() {
                return Err(cursor.refuse(at, "coordinate of a vertex", value, "a finite number"));
            }
            x[usize::from(name - b'x')] = value;
        }
        Ok(())
    })?;
    Ok(x)
}

fn face(
    cursor: &mut Cursor,
    element: &Element,
    vertices: u64,
    triangles: &mut Vec<[usize; 3]>,
) -> Result<(), ReadError> {
    let start = cursor.at();
    let mut corners = Vec::new();
    read(cursor, element, |cursor, property, at, value| {
        if property.length.is_some() && is_corners(property) {
            if !(value >= 0.0 && value.fract() == 0.0 && value < vertices as f64) {
                let allowed = format!("a whole number from 0, less than {vertices}, the number of vertices");
                return Err(cursor.refuse(at, "vertex of a face", value, allowed));
            }
            corners.push(value as usize);
        }
        Ok(())
    })?;
    if corners.len() < 3 {
        let found = format!("{} vertices", corners.len());
        return Err(cursor.refuse(start, "face", found, "three vertices or more"));
    }
    fan(&corners, triangles);
    Ok(())
}
