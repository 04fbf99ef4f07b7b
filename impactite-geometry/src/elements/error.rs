//! What is refused about meshes of elements, and why.

use super::ElementKind;

/// Why a mesh of elements is refused. Nodes, blocks and elements are counted from 0.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MeshError {
    /// A position that is at no place.
    #[error("mesh: coordinate {axis} of node {node} = {value} is not allowed; it must be finite")]
    Position {
        /// The node.
        node: usize,
        /// The coordinate axis.
        axis: usize,
        /// What was given (m).
        value: f64,
    },
    /// More nodes or elements than numbers of 32 bits can count.
    #[error("mesh: {count} {what} are not allowed; at most {allowed} can be numbered")]
    Count {
        /// Nodes, elements or blocks.
        what: &'static str,
        /// How many there are.
        count: usize,
        /// The most that are allowed.
        allowed: u32,
    },
    /// A block whose list of nodes is no whole number of elements.
    #[error(
        "mesh: block {block} `{name}` lists {numbers} nodes; a {} has {}, so that a multiple is allowed",
        kind.name(), kind.nodes()
    )]
    BlockLength {
        /// The block.
        block: usize,
        /// Its name.
        name: String,
        /// What its elements are.
        kind: ElementKind,
        /// How many nodes it lists.
        numbers: usize,
    },
    /// Elements of more dimensions than space has.
    #[error(
        "mesh: block {block} `{name}` is of kind {}, of {} dimensions; in {space} dimensions at most {space} are allowed",
        kind.name(), kind.dimensions()
    )]
    Dimensions {
        /// The block.
        block: usize,
        /// Its name.
        name: String,
        /// What its elements are.
        kind: ElementKind,
        /// Dimensions of space.
        space: usize,
    },
    /// An element names a node that does not exist.
    #[error(
        "mesh: element {element} of block {block} `{name}` names node {node}; allowed are numbers below {nodes}"
    )]
    NodeOutOfRange {
        /// The block.
        block: usize,
        /// Its name.
        name: String,
        /// The element.
        element: usize,
        /// The node it names.
        node: u32,
        /// How many nodes there are.
        nodes: usize,
    },
    /// An element with one node at two of its corners.
    #[error(
        "mesh: element {element} of block {block} `{name}` names node {node} twice; its nodes must differ (elements that are collapsed to others are not allowed)"
    )]
    RepeatedNode {
        /// The block.
        block: usize,
        /// Its name.
        name: String,
        /// The element.
        element: usize,
        /// The node it names twice.
        node: u32,
    },
    /// An element that is flat, inverted or numbered the wrong way round.
    #[error(
        "mesh: the {} {element} of block {block} `{name}` has a scaled Jacobian of {value:e} {place}; above {allowed:e} is allowed: it is flat, inverted, or its nodes run the wrong way round",
        kind.name()
    )]
    Shape {
        /// The block.
        block: usize,
        /// Its name.
        name: String,
        /// The element.
        element: usize,
        /// What it is.
        kind: ElementKind,
        /// Which corner, or a point within.
        place: String,
        /// Jacobian over the product of the lengths of its columns: 1 of a rectangle, negative if inverted.
        value: f64,
        /// What it must exceed.
        allowed: f64,
    },
    /// A node set that names a node that does not exist.
    #[error("mesh: node set `{set}` names node {node}; allowed are numbers below {nodes}")]
    SetNode {
        /// The set.
        set: String,
        /// The node it names.
        node: u32,
        /// How many nodes there are.
        nodes: usize,
    },
    /// A node set out of order.
    #[error("mesh: node set `{set}` has node {node} after node {before}; numbers must ascend, each one once")]
    SetOrder {
        /// The set.
        set: String,
        /// A node.
        node: u32,
        /// The node before it.
        before: u32,
    },
    /// An element set that names an element that does not exist.
    #[error("mesh: element set `{set}` names element {element}; allowed are numbers below {elements}")]
    SetElement {
        /// The set.
        set: String,
        /// The element it names, counted through all blocks.
        element: u32,
        /// Number of elements of all blocks.
        elements: usize,
    },
    /// An element set out of order.
    #[error(
        "mesh: element set `{set}` has element {element} after element {before}; numbers must ascend, each one once"
    )]
    ElementSetOrder {
        /// The set.
        set: String,
        /// An element.
        element: u32,
        /// The element before it.
        before: u32,
    },
    /// No group of this name.
    #[error("mesh: no group of elements has the name `{name}`; {}", among(groups))]
    NoGroup {
        /// The name.
        name: String,
        /// Names of all groups.
        groups: Vec<String>,
    },
    /// A facet of more than two elements, or of two on the same side of it.
    #[error(
        "mesh: the facet of nodes {nodes:?} belongs to {count} elements, among them {first:?} and {second:?} (block, element); allowed are one, or two on opposite sides"
    )]
    Facet {
        /// Its nodes.
        nodes: Vec<u32>,
        /// How many elements have it.
        count: usize,
        /// Block and element of the first.
        first: (u32, u32),
        /// Block and element of another.
        second: (u32, u32),
    },
    /// No block or element of this number.
    #[error("mesh: there is no element {element} in block {block}; allowed are {allowed}")]
    NoElement {
        /// The block.
        block: usize,
        /// The element.
        element: usize,
        /// What there is, in words.
        allowed: String,
    },
    /// Elements of a kind of which something cannot be made.
    #[error("mesh: block {block} `{name}` is of kind {}; {what} takes {allowed}", kind.name())]
    Kind {
        /// What was asked for.
        what: &'static str,
        /// The block.
        block: usize,
        /// Its name.
        name: String,
        /// What its elements are.
        kind: ElementKind,
        /// What is allowed, in words.
        allowed: &'static str,
    },
    /// A mesh without an element.
    #[error("mesh: there is no element; {what} needs one at least")]
    Empty {
        /// What was asked for.
        what: &'static str,
    },
}

/// Names that are allowed, in words.
fn among(names: &[String]) -> String {
    if names.is_empty() { "there is none".into() } else { format!("there are {}", names.join(", ")) }
}
