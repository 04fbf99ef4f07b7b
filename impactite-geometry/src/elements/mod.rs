//! Finite element meshes: nodes, blocks of elements of one kind, named sets, and surface facets.

mod change;
mod check;
mod error;
mod groups;
#[cfg(feature = "mesh")]
mod read;
mod reference;
mod select;
mod split;
mod surface;

use std::collections::BTreeMap;

pub use error::MeshError;
pub use reference::Quality;
pub use select::EdgeLengths;

/// Element types. Node order: VTK file format.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum ElementKind {
    /// Bar of two nodes.
    Bar2,
    /// Triangle of three nodes, counter-clockwise.
    Triangle3,
    /// Quadrilateral of four nodes, counter-clockwise.
    Quad4,
    /// Tetrahedron of four nodes: the fourth node is on the side of the right-handed normal of the first three.
    Tetra4,
    /// Brick of eight nodes: four nodes of a face, then the four opposite to them.
    Hexa8,
}

impl ElementKind {
    /// Number of nodes of an element.
    #[must_use]
    pub fn nodes(self) -> usize {
        match self {
            ElementKind::Bar2 => 2,
            ElementKind::Triangle3 => 3,
            ElementKind::Quad4 | ElementKind::Tetra4 => 4,
            ElementKind::Hexa8 => 8,
        }
    }

    /// Number of dimensions of the element itself: 1 for a bar.
    #[must_use]
    pub fn dimensions(self) -> usize {
        match self {
            ElementKind::Bar2 => 1,
            ElementKind::Triangle3 | ElementKind::Quad4 => 2,
            ElementKind::Tetra4 | ElementKind::Hexa8 => 3,
        }
    }

    /// Facets of an element with as many dimensions as space, by local node index, oriented outwards: counter-clockwise from outside in
    /// space; in the plane with the element on the left. Empty for a bar.
    #[must_use]
    pub fn facets(self) -> &'static [&'static [usize]] {
        match self {
            ElementKind::Bar2 => &[],
            ElementKind::Triangle3 => &[&[0, 1], &[1, 2], &[2, 0]],
            ElementKind::Quad4 => &[&[0, 1], &[1, 2], &[2, 3], &[3, 0]],
            ElementKind::Tetra4 => &[&[0, 2, 1], &[0, 1, 3], &[1, 2, 3], &[2, 0, 3]],
            ElementKind::Hexa8 => {
                &[&[0, 3, 2, 1], &[4, 5, 6, 7], &[0, 1, 5, 4], &[1, 2, 6, 5], &[2, 3, 7, 6], &[3, 0, 4, 7]]
            }
        }
    }

    /// Edges of an element, by local node index.
    #[must_use]
    pub fn edges(self) -> &'static [[usize; 2]] {
        match self {
            ElementKind::Bar2 => &[[0, 1]],
            ElementKind::Triangle3 => &[[0, 1], [1, 2], [2, 0]],
            ElementKind::Quad4 => &[[0, 1], [1, 2], [2, 3], [3, 0]],
            ElementKind::Tetra4 => &[[0, 1], [1, 2], [2, 0], [0, 3], [1, 3], [2, 3]],
            ElementKind::Hexa8 => &[
                [0, 1],
                [1, 2],
                [2, 3],
                [3, 0],
                [4, 5],
                [5, 6],
                [6, 7],
                [7, 4],
                [0, 4],
                [1, 5],
                [2, 6],
                [3, 7],
            ],
        }
    }

    /// Name of the element type in messages.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            ElementKind::Bar2 => "bar",
            ElementKind::Triangle3 => "triangle",
            ElementKind::Quad4 => "quadrilateral",
            ElementKind::Tetra4 => "tetrahedron",
            ElementKind::Hexa8 => "brick",
        }
    }

    /// Local node indices of an element in reversed order, as in its mirror image.
    fn reversed(self) -> &'static [usize] {
        match self {
            ElementKind::Bar2 => &[1, 0],
            ElementKind::Triangle3 => &[0, 2, 1],
            ElementKind::Quad4 => &[0, 3, 2, 1],
            ElementKind::Tetra4 => &[0, 2, 1, 3],
            ElementKind::Hexa8 => &[0, 3, 2, 1, 4, 7, 6, 5],
        }
    }
}

/// Block of elements of one kind.
#[derive(Clone, Debug, PartialEq)]
pub struct ElementBlock {
    /// Name of the block; empty if it has none.
    pub name: String,
    /// Element type.
    pub kind: ElementKind,
    /// Node indices of all elements (connectivity), one element after the other.
    pub nodes: Vec<u32>,
}

impl ElementBlock {
    /// Number of elements.
    #[must_use]
    pub fn len(&self) -> usize {
        self.nodes.len() / self.kind.nodes()
    }
    /// True if there is no element.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.nodes.is_empty()
    }
    /// Node indices of each element.
    pub fn elements(&self) -> impl ExactSizeIterator<Item = &[u32]> {
        self.nodes.chunks_exact(self.kind.nodes())
    }
}

/// Facet of the surface of a mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Facet {
    /// Node indices in the mesh, in the order of [`ElementKind::facets`]. Unused entries are [`Facet::NONE`]: the last one of a triangle,
    /// the last two of an edge.
    pub nodes: [u32; 4],
    /// Block of the element.
    pub block: u32,
    /// Index of the element in the block.
    pub element: u32,
}

impl Facet {
    /// Placeholder of an unused node entry.
    pub const NONE: u32 = u32::MAX;
    /// Node indices without unused entries.
    #[must_use]
    pub fn nodes(&self) -> &[u32] {
        let count = self.nodes.iter().position(|&n| n == Facet::NONE).unwrap_or(4);
        &self.nodes[..count]
    }
}

/// Finite element mesh in `D` dimensions.
///
/// The fields are public, so that a program can build a mesh; [`check`](ElementMesh::check) validates it. The functions
/// of [`structured`](crate::structured) and the readers return valid meshes.
///
/// | | |
/// |---|---|
/// | validity | [`check`](ElementMesh::check), [`quality`](ElementMesh::quality) |
/// | size | [`measure`](ElementMesh::measure), [`measure_of`](ElementMesh::measure_of), [`bounds`](ElementMesh::bounds), [`edge_lengths`](ElementMesh::edge_lengths) |
/// | surface | [`surface`](ElementMesh::surface), [`surface_of`](ElementMesh::surface_of) |
/// | nodes | [`nodes_where`](ElementMesh::nodes_where), [`nodes_in`](ElementMesh::nodes_in), [`with_node_set`](ElementMesh::with_node_set) |
/// | place | [`translated`](ElementMesh::translated), [`rotated`](ElementMesh::rotated), [`scaled`](ElementMesh::scaled), [`mirrored`](ElementMesh::mirrored), [`mapped`](ElementMesh::mapped) |
/// | build | [`joined`](ElementMesh::joined), [`welded`](ElementMesh::welded), [`part`](ElementMesh::part), [`extruded`](ElementMesh::extruded) |
/// | groups | [`groups`](ElementMesh::groups), [`only_groups`](ElementMesh::only_groups), [`with_element_set`](ElementMesh::with_element_set) |
/// | subdivide | [`split_to_triangles`](ElementMesh::split_to_triangles), [`split_to_tetrahedra`](ElementMesh::split_to_tetrahedra) |
#[cfg_attr(
    feature = "mesh",
    doc = "| files | [`read_gmsh`](ElementMesh::read_gmsh), [`read_abaqus`](ElementMesh::read_abaqus) |"
)]
///
/// ```
/// use impactite_geometry::{Cuboid, Metric, structured};
/// // Two plates of 10 mm x 10 mm x 2 mm, one upon the other, made one body.
/// let plate = structured::box_mesh(&Cuboid::new([0.0; 3], [0.01, 0.01, 0.002])?, [5, 5, 2])?;
/// let upper = plate.clone().translated([0.0, 0.0, 0.002])?;
/// let body = plate.joined(&upper)?.welded(1e-9)?;
/// body.check()?;
/// assert_eq!(body.nodes.len(), 6 * 6 * 5);
/// assert!((body.measure(Metric::Cartesian)? - 4e-7).abs() < 1e-20);
///
/// // 50 facets above and below, 20 round each of four layers.
/// assert_eq!(body.surface()?.len(), 2 * 25 + 4 * 20);
/// let below = body.nodes_where(|x| x[2] == 0.0);
/// assert_eq!(below.len(), 36);
/// // What a grid would compare with its cell: the shortest edge is 1 mm.
/// assert!((body.edge_lengths()?.min - 0.001).abs() < 1e-12);
/// # Ok::<(), impactite_geometry::GeometryError>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ElementMesh<const D: usize> {
    /// Node positions, m.
    pub nodes: Vec<[f64; D]>,
    /// Element blocks.
    pub blocks: Vec<ElementBlock>,
    /// Node sets by name, indices ascending.
    pub node_sets: BTreeMap<String, Vec<u32>>,
    /// Element sets by name, indices ascending. Elements are numbered through all blocks from 0; an element may be in several sets.
    pub element_sets: BTreeMap<String, Vec<u32>>,
}
