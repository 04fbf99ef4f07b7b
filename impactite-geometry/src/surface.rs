//! Readers of closed surfaces: STL, OBJ and PLY files.

use std::path::Path;

use super::error::{Check, GeometryError};
use super::file::{Kind, read};
use super::mesh::TriangleMesh;
use super::triangles::Triangles;
use super::{obj, ply, stl};

impl TriangleMesh {
    /// Read an STL file, ASCII or binary: all its solids become pieces of one solid. Coordinates are multiplied by
    /// `unit` (m): 1e-3 for a file in mm. Those of an ASCII file are read in double precision.
    ///
    /// # Errors
    /// [`GeometryError::File`] if it cannot be read, is no regular file, exceeds 4 GiB, has another format, is truncated, contains anything
    /// but solids, or has a coordinate that is not finite; errors of [`TriangleMesh::new`].
    pub fn read_stl(path: impl AsRef<Path>, unit: f64) -> Result<Self, GeometryError> {
        let (name, bytes) = load(path.as_ref(), Kind::Stl, unit)?;
        Self::from_stl(&name, &bytes, unit)
    }

    /// Build the solid from the bytes of an STL file; `name` is the file name in errors.
    ///
    /// # Errors
    /// Errors of [`read_stl`](Self::read_stl).
    pub fn from_stl(name: &str, bytes: &[u8], unit: f64) -> Result<Self, GeometryError> {
        Check("triangle mesh").positive("unit", unit)?;
        let mut soup = stl::triangles(bytes).map_err(|e| refuse(name, e))?;
        for x in soup.as_flattened_mut().as_flattened_mut() {
            *x *= unit;
        }
        Self::from_soup(&soup)
    }

    /// Read a Wavefront OBJ file: all its groups together, polygons split into triangles about their first corner. Coordinates are
    /// multiplied by `unit` (m): 1e-3 for a file in mm. Materials, normals, textures and vertex colours are ignored; lines may be
    /// continued by a backslash, and any line ending is accepted.
    ///
    /// # Errors
    /// [`GeometryError::File`] if it cannot be read, with the line, the found and the allowed value; errors of [`TriangleMesh::new`].
    pub fn read_obj(path: impl AsRef<Path>, unit: f64) -> Result<Self, GeometryError> {
        let (name, bytes) = load(path.as_ref(), Kind::Obj, unit)?;
        Self::from_obj(&name, &bytes, unit)
    }

    /// Build the solid from the bytes of an OBJ file; `name` is the file name in errors.
    ///
    /// # Errors
    /// Errors of [`read_obj`](Self::read_obj).
    pub fn from_obj(name: &str, bytes: &[u8], unit: f64) -> Result<Self, GeometryError> {
        Check("triangle mesh").positive("unit", unit)?;
        Self::scaled_by(unit, obj::triangles(bytes).map_err(|e| refuse(name, e))?)
    }

    /// Read a PLY file, ASCII or binary of either byte order: its faces, polygons split into triangles about their first corner.
    /// Coordinates are multiplied by `unit` (m): 1e-3 for a file in mm. Elements and properties other than vertex positions and face
    /// corners (`vertex_indices` or `vertex_index`) are skipped.
    ///
    /// # Errors
    /// [`GeometryError::File`] if it cannot be read, with the line or byte, the found and the allowed value; errors of
    /// [`TriangleMesh::new`].
    pub fn read_ply(path: impl AsRef<Path>, unit: f64) -> Result<Self, GeometryError> {
        let (name, bytes) = load(path.as_ref(), Kind::Ply, unit)?;
        Self::from_ply(&name, &bytes, unit)
    }

    /// Build the solid from the bytes of a PLY file; `name` is the file name in errors.
    ///
    /// ```
    /// use impactite_geometry::{Shape, TriangleMesh};
    /// let file = b"ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n\
    /// element face 4\nproperty list uchar int vertex_indices\nend_header\n\
    /// 0 0 0\n6 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 0 3 2\n";
    /// let tetrahedron = TriangleMesh::from_ply("tetrahedron.ply", file, 1.0)?;
    /// assert_eq!(tetrahedron.measure(), Some(1.0));
    /// # Ok::<(), impactite_geometry::GeometryError>(())
    /// ```
    ///
    /// # Errors
    /// Errors of [`read_ply`](Self::read_ply).
    pub fn from_ply(name: &str, bytes: &[u8], unit: f64) -> Result<Self, GeometryError> {
        Check("triangle mesh").positive("unit", unit)?;
        Self::scaled_by(unit, ply::triangles(bytes).map_err(|e| refuse(name, e))?)
    }

    fn scaled_by(unit: f64, (mut vertices, triangles): Triangles) -> Result<Self, GeometryError> {
        for x in vertices.as_flattened_mut() {
            *x *= unit;
        }
        Self::new(&vertices, &triangles)
    }
}

fn refuse(name: &str, error: impl ToString) -> GeometryError {
    GeometryError::File { path: name.into(), reason: error.to_string() }
}

fn load(path: &Path, kind: Kind, unit: f64) -> Result<(String, Vec<u8>), GeometryError> {
    Check("triangle mesh").positive("unit", unit)?;
    let name = path.display().to_string();
    match read(path, kind) {
        Ok(bytes) => Ok((name, bytes)),
        Err(reason) => Err(refuse(&name, reason)),
    }
}
