//! Nodes behind symmetry planes, edges and periodic planes, and the nodes that represent them.

use std::sync::Arc;

use super::NodeWeight;
use crate::dim::block_of;
use crate::grid::levels::{pack_node, unpack_node};
use crate::grid::{Lattices, Levels};
use crate::step::nodes::fields::Fields;
use crate::step::nodes::wrap::Wrap;
use impactite_scene::boundary::{Boundary, Plane};

/// Map of nodes behind planes to the nodes that represent them.
pub(in crate::step) struct Folds<const D: usize> {
    levels: Option<Arc<Levels<D>>>,
    wrap: Wrap<D>,
    mirrors: Vec<Plane>,
    edges: Vec<Plane>,
}

impl<const D: usize> Folds<D> {
    /// Create the map for these boundaries; `modified` is true if the basis ends at walls and fixed planes.
    pub(in crate::step) fn of(boundaries: &[Boundary<D>], fields: &Fields<D>, modified: bool) -> Self {
        let lattices = fields.lattices();
        let lattice = lattices.base();
        Folds {
            levels: fields.levels().cloned(),
            // The scene has validated its boundaries.
            wrap: Wrap::of(boundaries, lattice).unwrap_or_default(),
            mirrors: boundaries.iter().filter_map(|b| b.mirror(lattice)).collect(),
            edges: boundaries.iter().filter(|_| modified).filter_map(|b| b.edge(lattice)).collect(),
        }
    }

    /// Replace nodes behind planes by those that represent them.
    pub(in crate::step) fn fold(&self, nodes: &[NodeWeight<D>], list: &mut Vec<NodeWeight<D>>) {
        list.clear();
        list.extend_from_slice(nodes);
        if !self.wrap.is_none() {
            list.iter_mut().for_each(|w| w.node = self.wrap.node(w.node));
        }
        if let Some(levels) = &self.levels {
            fold_levels(levels, list);
            return self.fold_mirrors(levels.lattices(), list);
        }
        for m in &self.mirrors {
            for w in list.iter_mut().filter(|w| (w.node[m.axis] - m.node) * m.sign < 0) {
                w.node[m.axis] = 2 * m.node - w.node[m.axis];
                w.sign[m.axis] = -w.sign[m.axis];
            }
        }
        // The value behind an edge is 2 (value on it) - (value in front).
        for e in &self.edges {
            for n in 0..list.len() {
                if list[n].node[e.axis] != e.node - e.sign {
                    continue;
                }
                let scaled = |by: f64, node: i32| {
                    let mut w = list[n];
                    w.node[e.axis] = node;
                    w.value *= by;
                    w.gradient = w.gradient.map(|g| by * g);
                    w
                };
                let (on, front) = (scaled(2.0, e.node), scaled(-1.0, e.node + e.sign));
                list[n] = on;
                list.push(front);
            }
        }
    }

    /// Replace nodes of any level behind symmetry planes by those in front.
    fn fold_mirrors(&self, lattices: Lattices<D>, list: &mut [NodeWeight<D>]) {
        for m in &self.mirrors {
            for w in list.iter_mut() {
                let (level, mut node) = unpack_node(&w.node);
                let (front, between) = lattices.node_at_plane(level, m.node, m.sign);
                if (node[m.axis] - front) * m.sign < 0 {
                    node[m.axis] = 2 * front - node[m.axis] - if between { m.sign } else { 0 };
                    w.node = pack_node(level, node);
                    w.sign[m.axis] = -w.sign[m.axis];
                }
            }
        }
    }
}

/// Replace nodes that depend on those of larger cells by these.
fn fold_levels<const D: usize>(levels: &Levels<D>, list: &mut Vec<NodeWeight<D>>) {
    let (mut n, mut last) = (0, None);
    while n < list.len() {
        let (level, node) = unpack_node(&list[n].node);
        let (block, within) = block_of(&node);
        // Consecutive nodes are mostly in one block.
        let dependent = match last {
            Some((known, nodes)) if known == (level, block) => nodes,
            _ => levels.dependent(level, &block),
        };
        last = Some(((level, block), dependent));
        if dependent >> within & 1 == 0 {
            n += 1;
            continue;
        }
        let own = list.swap_remove(n);
        levels.parents(&node, &mut |parent| {
            list.push(NodeWeight {
                node: pack_node(level - 1, parent.node),
                value: parent.weight * own.value,
                gradient: own.gradient.map(|g| parent.weight * g),
                sign: own.sign,
            });
        });
    }
}
