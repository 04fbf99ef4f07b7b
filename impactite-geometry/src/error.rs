//! Errors of shapes, seeding, meshes and searches.

use super::elements::MeshError;
use super::search::SearchError;

/// Error of a shape, a lattice, a seeding, a mesh or a search.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum GeometryError {
    /// Parameter outside its allowed range.
    #[error("{owner}: {field} = {value} is not allowed; it must be {allowed}")]
    Parameter {
        /// Shape, lattice or option that owns the parameter.
        owner: &'static str,
        /// Name of the parameter.
        field: &'static str,
        /// Value of the parameter.
        value: f64,
        /// Allowed values, in words.
        allowed: &'static str,
    },
    /// Unbounded shape, which cannot be filled.
    #[error("the shape is unbounded along axis {axis}; intersect it with a bounded shape")]
    Unbounded {
        /// Coordinate axis along which the shape is unbounded.
        axis: usize,
    },
    /// No particle centre inside the shape.
    #[error(
        "no particle lies inside the shape: it is empty, or too small for particles {particle_edge} m apart"
    )]
    NoParticles {
        /// Edge of a particle (m).
        particle_edge: f64,
    },
    /// Too many particle sites.
    #[error("the shape covers {points:e} particle sites; at most {allowed:e} are allowed (units mixed up?)")]
    TooFine {
        /// Number of particle sites within the bounds of the shape.
        points: f64,
        /// Maximum number of sites.
        allowed: f64,
    },
    /// Memory above the limit, or failed allocation.
    #[error(transparent)]
    Memory(#[from] impactite_simd::memory::MemoryError),
    /// Triangle that refers to a vertex that does not exist.
    #[error("mesh: triangle {triangle} names vertex {vertex}, but there are only {vertices} vertices")]
    VertexOutOfRange {
        /// Triangle index.
        triangle: usize,
        /// Vertex index that does not exist.
        vertex: usize,
        /// Number of vertices.
        vertices: usize,
    },
    /// Mesh without a triangle of three different corners.
    #[error("mesh: there is no triangle with three different corners")]
    EmptyMesh,
    /// Open surface mesh.
    #[error("mesh: the surface is not closed: {open_edges} of its edges have a triangle on one side only")]
    OpenMesh {
        /// Number of open edges: edges of an odd number of triangles.
        open_edges: usize,
    },
    /// Closed mesh with inconsistent triangle orientation.
    #[error("mesh: {edges} edges join triangles of opposite orientation; make the orientation consistent")]
    InconsistentMesh {
        /// Number of edges that two triangles use in the same direction.
        edges: usize,
    },
    /// Mesh that encloses no volume.
    #[error("mesh: the enclosed volume is {volume} m3; a body must enclose some volume")]
    NoVolume {
        /// Enclosed volume (m3).
        volume: f64,
    },
    /// Error of an element mesh.
    #[error(transparent)]
    Elements(#[from] MeshError),
    /// Error of a neighbour search.
    #[error(transparent)]
    Search(#[from] SearchError),
    /// Mesh file that cannot be read.
    #[error("cannot read {path}: {reason}")]
    File {
        /// Path of the file.
        path: String,
        /// Error of the reader.
        reason: String,
    },
}

/// Parameter checks on behalf of one owner.
#[derive(Clone, Copy)]
pub(super) struct Check(pub &'static str);

impl Check {
    /// Return `value` if `holds` and it is finite, else an error with the `allowed` values.
    pub fn that(
        self,
        holds: bool,
        field: &'static str,
        value: f64,
        allowed: &'static str,
    ) -> Result<f64, GeometryError> {
        if holds && value.is_finite() {
            Ok(value)
        } else {
            Err(GeometryError::Parameter { owner: self.0, field, value, allowed })
        }
    }
    /// Return `value` if it is positive and finite.
    pub fn positive(self, field: &'static str, value: f64) -> Result<f64, GeometryError> {
        self.that(value > 0.0, field, value, "positive and finite")
    }
    /// Return `x` if all its components are finite.
    pub fn point<const D: usize>(self, field: &'static str, x: [f64; D]) -> Result<[f64; D], GeometryError> {
        for value in x {
            self.that(true, field, value, "finite")?;
        }
        Ok(x)
    }
    /// Return the unit vector along `x`.
    pub fn direction<const D: usize>(
        self,
        field: &'static str,
        x: [f64; D],
    ) -> Result<[f64; D], GeometryError> {
        self.point(field, x)?;
        let largest = x.iter().fold(0.0f64, |m, c| m.max(c.abs()));
        self.that(largest > 0.0, field, largest, "a vector that is not zero")?;
        let scaled = x.map(|c| c / largest);
        let length = super::vector::norm(scaled);
        Ok(scaled.map(|c| c / length))
    }
}
