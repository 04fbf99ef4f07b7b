//! Meshes of elements: nodes, blocks of elements of one kind, named sets, and the facets of their surface.

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

/// Kinds of elements, with their nodes in the order of the VTK file format.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum ElementKind {
    /// A bar of two nodes.
    Bar2,
    /// A triangle, counter-clockwise.
    Triangle3,
    /// A quadrilateral, counter-clockwise.
    Quad4,
    /// A tetrahedron: the fourth node on the side of the first three's right-handed normal.
    Tetra4,
    /// A brick: four nodes of a face, then the four opposite to them.
    Hexa8,
}

impl ElementKind {
    /// Nodes of an element.
    #[must_use]
    pub fn nodes(self) -> usize {
        match self {
            ElementKind::Bar2 => 2,
            ElementKind::Triangle3 => 3,
            ElementKind::Quad4 | ElementKind::Tetra4 => 4,
            ElementKind::Hexa8 => 8,
        }
    }

    /// Dimensions of an element itself: 1 of a bar.
    #[must_use]
    pub fn dimensions(self) -> usize {
        match self {
            ElementKind::Bar2 => 1,
            ElementKind::Triangle3 | ElementKind::Quad4 => 2,
            ElementKind::Tetra4 | ElementKind::Hexa8 => 3,
        }
    }

    /// Facets of an element with as many dimensions as space, by place among its nodes, outwards: from outside counter-clockwise in
    /// space; in the plane with the element on the left. None of a bar.
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

    /// Edges of an element, by place among its nodes.
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

    /// What it is called in messages.
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

    /// The place that each node takes when an element is numbered the other way round, as its image in a mirror is.
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

/// Elements of one kind.
#[derive(Clone, Debug, PartialEq)]
pub struct ElementBlock {
    /// Its name; empty without one.
    pub name: String,
    /// What the elements are.
    pub kind: ElementKind,
    /// Nodes of all elements, one element after the other, by number in the mesh.
    pub nodes: Vec<u32>,
}

impl ElementBlock {
    /// How many elements there are.
    #[must_use]
    pub fn len(&self) -> usize {
        self.nodes.len() / self.kind.nodes()
    }
    /// Is there none?
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.nodes.is_empty()
    }
    /// Nodes of each element.
    pub fn elements(&self) -> impl ExactSizeIterator<Item = &[u32]> {
        self.nodes.chunks_exact(self.kind.nodes())
    }
}

/// A facet of the surface of a mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Facet {
    /// Its nodes by number in the mesh, as [`ElementKind::facets`] has them; of a triangle the last one is [`Facet::NONE`], of an edge
    /// the last two.
    pub nodes: [u32; 4],
    /// The block of its element.
    pub block: u32,
    /// Its element, by number in the block.
    pub element: u32,
}

impl Facet {
    /// No node.
    pub const NONE: u32 = u32::MAX;
    /// The nodes that are there.
    #[must_use]
    pub fn nodes(&self) -> &[u32] {
        let count = self.nodes.iter().position(|&n| n == Facet::NONE).unwrap_or(4);
        &self.nodes[..count]
    }
}

/// A mesh of elements in `D` dimensions.
///
/// The fields are public, so that a program may make a mesh of its own; [`check`](ElementMesh::check) says whether it is one. The functions
/// of [`structured`](crate::structured) and the readers give meshes that are checked.
///
/// | | |
/// |---|---|
/// | sound? | [`check`](ElementMesh::check), [`quality`](ElementMesh::quality) |
/// | size | [`measure`](ElementMesh::measure), [`measure_of`](ElementMesh::measure_of), [`bounds`](ElementMesh::bounds), [`edge_lengths`](ElementMesh::edge_lengths) |
/// | surface | [`surface`](ElementMesh::surface), [`surface_of`](ElementMesh::surface_of) |
/// | nodes | [`nodes_where`](ElementMesh::nodes_where), [`nodes_in`](ElementMesh::nodes_in), [`with_node_set`](ElementMesh::with_node_set) |
/// | place | [`translated`](ElementMesh::translated), [`rotated`](ElementMesh::rotated), [`scaled`](ElementMesh::scaled), [`mirrored`](ElementMesh::mirrored), [`mapped`](ElementMesh::mapped) |
/// | build | [`joined`](ElementMesh::joined), [`welded`](ElementMesh::welded), [`part`](ElementMesh::part), [`extruded`](ElementMesh::extruded) |
/// | groups | [`groups`](ElementMesh::groups), [`only_groups`](ElementMesh::only_groups), [`with_element_set`](ElementMesh::with_element_set) |
/// | other elements | [`split_to_triangles`](ElementMesh::split_to_triangles), [`split_to_tetrahedra`](ElementMesh::split_to_tetrahedra) |
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
    /// Positions of the nodes, m.
    pub nodes: Vec<[f64; D]>,
    /// Blocks of elements.
    pub blocks: Vec<ElementBlock>,
    /// Named sets of nodes, ascending.
    pub node_sets: BTreeMap<String, Vec<u32>>,
    /// Named sets of elements, ascending. Elements are numbered through all blocks, from 0 in the first; an element may be in several sets.
    pub element_sets: BTreeMap<String, Vec<u32>>,
}
