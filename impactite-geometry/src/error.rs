//! What geometry refuses, and why.

use super::elements::MeshError;
use super::search::SearchError;

/// Why a shape, a lattice or a seeding is refused.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum GeometryError {
    /// A parameter outside what its owner allows.
    #[error("{owner}: {field} = {value} is not allowed; it must be {allowed}")]
    Parameter {
        /// The shape, lattice or option.
        owner: &'static str,
        /// The field.
        field: &'static str,
        /// What was given.
        value: f64,
        /// What is allowed, in words.
        allowed: &'static str,
    },
    /// A shape that reaches to infinity cannot be filled.
    #[error("the shape is unbounded along axis {axis}; intersect it with a bounded shape")]
    Unbounded {
        /// The coordinate axis along which it is unbounded.
        axis: usize,
    },
    /// No particle centre lies inside the shape.
    #[error(
        "no particle lies inside the shape: it is empty, or too small for particles {particle_edge} m apart"
    )]
    NoParticles {
        /// Edge of a particle (m).
        particle_edge: f64,
    },
    /// The shape covers more lattice points than can be counted.
    #[error("the shape covers {points:e} particle sites; at most {allowed:e} are allowed (units mixed up?)")]
    TooFine {
        /// Number of particle sites within the bounds of the shape.
        points: f64,
        /// The most that are allowed.
        allowed: f64,
    },
    /// What is asked for takes more memory than is allowed, or than there is.
    #[error(transparent)]
    Memory(#[from] impactite_simd::memory::MemoryError),
    /// A triangle names a vertex that does not exist.
    #[error("mesh: triangle {triangle} names vertex {vertex}, but there are only {vertices} vertices")]
    VertexOutOfRange {
        /// The triangle.
        triangle: usize,
        /// The vertex it names.
        vertex: usize,
        /// Number of vertices.
        vertices: usize,
    },
    /// A mesh without a single proper triangle.
    #[error("mesh: there is no triangle with three different corners")]
    EmptyMesh,
    /// A mesh with holes.
    #[error("mesh: the surface is not closed: {open_edges} of its edges have a triangle on one side only")]
    OpenMesh {
        /// Number of edges used by an odd number of triangles.
        open_edges: usize,
    },
    /// A closed mesh whose neighbouring triangles disagree about which side is outside.
    #[error("mesh: {edges} edges join triangles of opposite orientation; make the orientation consistent")]
    InconsistentMesh {
        /// Number of edges whose triangles run through them in the same direction.
        edges: usize,
    },
    /// A mesh that encloses nothing.
    #[error("mesh: the enclosed volume is {volume} m3; a body must enclose some volume")]
    NoVolume {
        /// The volume found (m3).
        volume: f64,
    },
    /// A mesh of elements that is none, or that does not allow what is asked of it.
    #[error(transparent)]
    Elements(#[from] MeshError),
    /// Points that a neighbour search refuses.
    #[error(transparent)]
    Search(#[from] SearchError),
    /// A file that cannot be read as a mesh.
    #[error("cannot read {path}: {reason}")]
    File {
        /// The file.
        path: String,
        /// What the reader said.
        reason: String,
    },
}

/// Refuses the parameters of one owner.
#[derive(Clone, Copy)]
pub(super) struct Check(pub &'static str);

impl Check {
    /// `value` if `holds` and it is finite, else an error saying what is `allowed`.
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
    /// `value` if it is positive and finite.
    pub fn positive(self, field: &'static str, value: f64) -> Result<f64, GeometryError> {
        self.that(value > 0.0, field, value, "positive and finite")
    }
    /// `x` if all its components are finite.
    pub fn point<const D: usize>(self, field: &'static str, x: [f64; D]) -> Result<[f64; D], GeometryError> {
        for value in x {
            self.that(true, field, value, "finite")?;
        }
        Ok(x)
    }
    /// The unit vector along `x`.
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
