//! Mesh files: size limit and detection of the format from the content.

use std::io::Read;
use std::path::Path;

/// Maximum number of bytes of a file, 4 GiB: a binary STL file of 8.6e7 triangles.
pub(crate) const MOST_BYTES: u64 = 4 << 30;

/// File format.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    /// STL: triangles, text or binary.
    Stl,
    /// Wavefront OBJ: polygons.
    Obj,
    /// Stanford PLY: polygons, text or binary.
    Ply,
    /// Gmsh: elements.
    Gmsh,
    /// Abaqus: elements.
    Abaqus,
    /// Format without a reader.
    Other(&'static str),
}

impl Kind {
    /// Description of the format and the suggested reader, for messages.
    fn told(self) -> (&'static str, &'static str) {
        match self {
            Kind::Stl => {
                ("an STL file: a closed surface, without elements", "read it by `TriangleMesh::read_stl`")
            }
            Kind::Obj => {
                ("an OBJ file: a closed surface, without elements", "read it by `TriangleMesh::read_obj`")
            }
            Kind::Ply => {
                ("a PLY file: a closed surface, without elements", "read it by `TriangleMesh::read_ply`")
            }
            Kind::Gmsh => ("a Gmsh file of elements", "read it by `ElementMesh::read_gmsh`"),
            Kind::Abaqus => ("an Abaqus file of elements", "read it by `ElementMesh::read_abaqus`"),
            Kind::Other(what) => {
                (what, "surfaces are STL, OBJ and PLY files, elements are of Gmsh and Abaqus")
            }
        }
    }

    /// Detect the format of a file from its bytes; `None` if they are ambiguous.
    fn of(bytes: &[u8]) -> Option<Kind> {
        let others: [(&[u8], &'static str); 7] = [
            (b"\x89PNG", "a picture"),
            (b"\xff\xd8\xff", "a picture"),
            (b"PK\x03\x04", "a ZIP archive"),
            (b"\x1f\x8b", "compressed by gzip"),
            (b"ISO-10303-21", "a STEP file of shapes, without triangles"),
            (b"# vtk", "a VTK file"),
            (b"<?xml", "an XML file"),
        ];
        if let Some((_, what)) = others.iter().find(|(start, _)| bytes.starts_with(start)) {
            return Some(Kind::Other(what));
        }
        if bytes.starts_with(b"ply\n") || bytes.starts_with(b"ply\r") {
            return Some(Kind::Ply);
        }
        let text = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
        let mut lines = text.split(|b| *b == b'\n' || *b == b'\r').map(<[u8]>::trim_ascii);
        let first = lines.find(|line| !line.is_empty() && !line.starts_with(b"#"))?;
        let word = first.split(u8::is_ascii_whitespace).next().unwrap_or_default();
        match word {
            [b'$', letter, ..] if letter.is_ascii_alphabetic() => Some(Kind::Gmsh),
            [b'*', b'*', ..] => Some(Kind::Abaqus),
            [b'*', letter, ..] if letter.is_ascii_alphabetic() => Some(Kind::Abaqus),
            b"v" | b"vn" | b"vt" | b"o" | b"g" | b"f" | b"mtllib" | b"usemtl" => Some(Kind::Obj),
            _ if word.eq_ignore_ascii_case(b"solid") => Some(Kind::Stl),
            _ => None,
        }
    }
}

/// Read the bytes of a regular file, unless its format is detected and differs from `wanted`.
///
/// # Errors
/// A folder, pipe or device; more than 4 GiB; another format, with the reader for it.
pub(crate) fn read(path: &Path, wanted: Kind) -> Result<Vec<u8>, String> {
    // Checked before opening: opening a pipe blocks until its other end is opened.
    let found = std::fs::metadata(path).map_err(|e| e.to_string())?;
    if !found.is_file() {
        let what = if found.is_dir() { "a folder" } else { "a pipe or device" };
        return Err(format!("it is {what}; it must be a regular file"));
    }
    let too_large =
        |size: u64| format!("it has {size} bytes; a file of a mesh may have {MOST_BYTES} at most");
    if found.len() > MOST_BYTES {
        return Err(too_large(found.len()));
    }
    let mut bytes = Vec::new();
    let file = std::fs::File::open(path).map_err(|e| e.to_string())?;
    file.take(MOST_BYTES + 1).read_to_end(&mut bytes).map_err(|e| e.to_string())?;
    if bytes.len() as u64 > MOST_BYTES {
        return Err(too_large(bytes.len() as u64));
    }
    match Kind::of(&bytes) {
        // The header of a binary STL file is arbitrary.
        Some(kind) if kind != wanted && !(wanted == Kind::Stl && crate::stl::is_binary(&bytes)) => {
            let (what, remedy) = kind.told();
            Err(format!("it is {what}; {remedy}"))
        }
        _ => Ok(bytes),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_are_told_apart_by_what_is_in_them() {
        for (text, kind) in [
            ("$MeshFormat\n4.1 0 8\n", Some(Kind::Gmsh)),
            ("\n$Comments\n", Some(Kind::Gmsh)),
            ("** made by hand\n*NODE\n1, 0., 0.\n", Some(Kind::Abaqus)),
            ("*Heading\n", Some(Kind::Abaqus)),
            ("# Blender\nmtllib cube.mtl\no Cube\n", Some(Kind::Obj)),
            ("v 0 0 0\r\n", Some(Kind::Obj)),
            ("  solid cube\n", Some(Kind::Stl)),
            ("ply\nformat ascii 1.0\n", Some(Kind::Ply)),
            ("", None),
            ("# only a comment\n", None),
            ("1 2 3\n", None),
        ] {
            assert_eq!(Kind::of(text.as_bytes()), kind, "{text:?}");
        }
    }
}
