//! Errors of element meshes.

use super::ElementKind;

/// Error of an element mesh. Nodes, blocks and elements are counted from 0.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MeshError {
    /// Node position that is not finite.
    #[error("mesh: coordinate {axis} of node {node} = {value} is not allowed; it must be finite")]
    Position {
        /// Node index.
        node: usize,
        /// Coordinate axis.
        axis: usize,
        /// Coordinate (m).
        value: f64,
    },
    /// More nodes, blocks or elements than 32-bit indices can count.
    #[error("mesh: {count} {what} are not allowed; at most {allowed} can be numbered")]
    Count {
        /// Counted objects: nodes, elements or blocks.
        what: &'static str,
        /// Number of objects.
        count: usize,
        /// Maximum number.
        allowed: u32,
    },
    /// Block with a number of node indices that is no multiple of the nodes per element.
    #[error(
        "mesh: block {block} `{name}` lists {numbers} nodes; a {} has {}, so that a multiple is allowed",
        kind.name(), kind.nodes()
    )]
    BlockLength {
        /// Block index.
        block: usize,
        /// Block name.
        name: String,
        /// Element type.
        kind: ElementKind,
        /// Number of node indices in the block.
        numbers: usize,
    },
    /// Elements of more dimensions than space.
    #[error(
        "mesh: block {block} `{name}` is of kind {}, of {} dimensions; in {space} dimensions at most {space} are allowed",
        kind.name(), kind.dimensions()
    )]
    Dimensions {
        /// Block index.
        block: usize,
        /// Block name.
        name: String,
        /// Element type.
        kind: ElementKind,
        /// Number of space dimensions.
        space: usize,
    },
    /// Element that refers to a node that does not exist.
    #[error(
        "mesh: element {element} of block {block} `{name}` names node {node}; allowed are numbers below {nodes}"
    )]
    NodeOutOfRange {
        /// Block index.
        block: usize,
        /// Block name.
        name: String,
        /// Element index in the block.
        element: usize,
        /// Node index that does not exist.
        node: u32,
        /// Number of nodes.
        nodes: usize,
    },
    /// Collapsed element: two corners share one node.
    #[error(
        "mesh: element {element} of block {block} `{name}` names node {node} twice; its nodes must differ (elements that are collapsed to others are not allowed)"
    )]
    RepeatedNode {
        /// Block index.
        block: usize,
        /// Block name.
        name: String,
        /// Element index in the block.
        element: usize,
        /// Node index that occurs twice.
        node: u32,
    },
    /// Degenerate element: flat, inverted or with reversed node order.
    #[error(
        "mesh: the {} {element} of block {block} `{name}` has a scaled Jacobian of {value:e} {place}; above {allowed:e} is allowed: it is flat, inverted, or its nodes run the wrong way round",
        kind.name()
    )]
    Shape {
        /// Block index.
        block: usize,
        /// Block name.
        name: String,
        /// Element index in the block.
        element: usize,
        /// Element type.
        kind: ElementKind,
        /// Corner or quadrature point, in words.
        place: String,
        /// Scaled Jacobian: Jacobian over the product of the lengths of its columns; 1 for a rectangle, negative if inverted.
        value: f64,
        /// Lower limit of the scaled Jacobian.
        allowed: f64,
    },
    /// Node set that refers to a node that does not exist.
    #[error("mesh: node set `{set}` names node {node}; allowed are numbers below {nodes}")]
    SetNode {
        /// Name of the node set.
        set: String,
        /// Node index that does not exist.
        node: u32,
        /// Number of nodes.
        nodes: usize,
    },
    /// Node set that is not ascending.
    #[error("mesh: node set `{set}` has node {node} after node {before}; numbers must ascend, each one once")]
    SetOrder {
        /// Name of the node set.
        set: String,
        /// Node index out of order.
        node: u32,
        /// Node index before it.
        before: u32,
    },
    /// Element set that refers to an element that does not exist.
    #[error("mesh: element set `{set}` names element {element}; allowed are numbers below {elements}")]
    SetElement {
        /// Name of the element set.
        set: String,
        /// Element index that does not exist, counted through all blocks.
        element: u32,
        /// Number of elements of all blocks.
        elements: usize,
    },
    /// Element set that is not ascending.
    #[error(
        "mesh: element set `{set}` has element {element} after element {before}; numbers must ascend, each one once"
    )]
    ElementSetOrder {
        /// Name of the element set.
        set: String,
        /// Element index out of order.
        element: u32,
        /// Element index before it.
        before: u32,
    },
    /// No group of this name.
    #[error("mesh: no group of elements has the name `{name}`; {}", among(groups))]
    NoGroup {
        /// Requested name.
        name: String,
        /// Names of all groups.
        groups: Vec<String>,
    },
    /// Non-manifold facet: shared by more than two elements, or by two on the same side of it.
    #[error(
        "mesh: the facet of nodes {nodes:?} belongs to {count} elements, among them {first:?} and {second:?} (block, element); allowed are one, or two on opposite sides"
    )]
    Facet {
        /// Nodes of the facet.
        nodes: Vec<u32>,
        /// Number of elements that share the facet.
        count: usize,
        /// Block and element index of the first element.
        first: (u32, u32),
        /// Block and element index of another element.
        second: (u32, u32),
    },
    /// Block or element index that does not exist.
    #[error("mesh: there is no element {element} in block {block}; allowed are {allowed}")]
    NoElement {
        /// Block index.
        block: usize,
        /// Element index in the block.
        element: usize,
        /// Allowed indices, in words.
        allowed: String,
    },
    /// Element type that an operation does not support.
    #[error("mesh: block {block} `{name}` is of kind {}; {what} takes {allowed}", kind.name())]
    Kind {
        /// Requested operation.
        what: &'static str,
        /// Block index.
        block: usize,
        /// Block name.
        name: String,
        /// Element type.
        kind: ElementKind,
        /// Supported element types, in words.
        allowed: &'static str,
    },
    /// Mesh without elements.
    #[error("mesh: there is no element; {what} needs one at least")]
    Empty {
        /// Requested operation.
        what: &'static str,
    },
}

/// List the available names, in words.
fn among(names: &[String]) -> String {
    if names.is_empty() { "there is none".into() } else { format!("there are {}", names.join(", ")) }
}
