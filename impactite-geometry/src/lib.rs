//! Shapes, particle seeding, finite element meshes, and neighbour search among points.
//!
//! A [`Shape`] is a signed distance function with a bounding box and, where known, an exact measure. Shapes combine by method
//! chaining; [`fill`] seeds particles on a [`Lattice`] and corrects their volumes to the exact measure. [`search`] finds pairs of points
//! within a search radius. [`structured`] meshes simple shapes with elements; an [`ElementMesh`] checks, measures, joins and cuts
//! meshes, extracts their surface, and reads them from Gmsh and Abaqus files (feature `mesh`).
//!
//! ```
//! use impactite_geometry::{Compose, Cuboid, Cylinder, Filling, Lattice, fill};
//! // A plate of 26.3 mm with a bore of 10 mm, in metres.
//! let plate = Cuboid::new([-0.05, -0.05, 0.0], [0.05, 0.05, 0.0263])?;
//! let bore = Cylinder::new([0.0, 0.0, -0.01], [0.0, 0.0, 1.0], 0.05, 0.005)?;
//! let lattice = Lattice::new([0.0; 3], 0.005)?;
//! let seeds = fill(&plate.minus(bore), &lattice, 2, &Filling::new())?;
//! assert_eq!(seeds.positions.len(), seeds.volumes.len());
//! println!("volumes multiplied by {}", seeds.correction);
//! # Ok::<(), impactite_geometry::GeometryError>(())
//! ```

mod bounds;
mod cell_volumes;
mod combine;
mod compose;
#[cfg(feature = "mesh")]
mod cursor;
mod elements;
mod error;
mod facets;
#[cfg(feature = "mesh")]
mod file;
mod lattice;
mod mesh;
#[cfg(feature = "mesh")]
mod obj;
#[cfg(feature = "mesh")]
mod ply;
mod polygon;
mod primitives;
mod rings;
pub mod search;
mod seed;
mod shape;
#[cfg(feature = "mesh")]
mod stl;
pub mod structured;
#[cfg(feature = "mesh")]
mod surface;
mod transform;
mod tree;
#[cfg(feature = "mesh")]
mod triangles;
mod vector;

pub use bounds::Bounds;
pub use combine::{Difference, Intersection, Union};
pub use compose::Compose;
pub use elements::{EdgeLengths, ElementBlock, ElementKind, ElementMesh, Facet, MeshError, Quality};
pub use error::GeometryError;
pub use facets::Facets;
pub use lattice::Lattice;
pub use mesh::TriangleMesh;
pub use polygon::Polygon;
pub use primitives::{
    Ball, Cuboid, Cylinder, Disc, Frustum, HalfSpace, Implicit, OgiveRod, Ring, Shell, Sphere, Tube,
};
pub use rings::rings;
pub use seed::{Filling, Seeds, fill, sampled_measure};
pub use shape::{Metric, Shape};
pub use transform::{Rotated, Scaled, Translated};
