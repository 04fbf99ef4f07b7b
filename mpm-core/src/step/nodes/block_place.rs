//! Positions of the nodes of a block.

use super::layout::{LAYERS, whole_block};
use crate::dim::BLOCK;
use crate::grid::Lattices;
use impactite_scene::boundary::{Boundary, Plane};

/// Positions of the nodes of a block.
pub(in crate::step) struct BlockPlace<const D: usize> {
    pub(in crate::step) low: [f64; D],
    pub(in crate::step) high: [f64; D],
    first: [i32; D],
    origin: [f64; D],
    spacing: f64,
    level: usize,
    lattices: Lattices<D>,
}

impl<const D: usize> BlockPlace<D> {
    pub(in crate::step) fn new(lattices: &Lattices<D>, block: &[i32; D]) -> Self {
        let level = lattices.level(block);
        let (lattice, block) = lattices.of_block(block);
        let (origin, spacing) = (lattice.origin(), lattice.spacing());
        let first = block.map(|b| b * BLOCK as i32);
        let mut low = origin;
        let mut high = origin;
        for d in 0..D {
            low[d] += f64::from(first[d]) * spacing;
            high[d] += f64::from(first[d] + BLOCK as i32 - 1) * spacing;
        }
        BlockPlace { low, high, first, origin, spacing, level, lattices: *lattices }
    }
    /// Return the nodes of the layers across an axis for which `holds` is true of the layer's index, one bit each.
    fn layers(&self, axis: usize, holds: impl Fn(i32) -> bool) -> u64 {
        let at = |k: &usize| holds(self.first[axis] + *k as i32);
        let layer = |k: usize| LAYERS[axis] << (k * BLOCK.pow(axis as u32));
        whole_block(D) & (0..BLOCK).filter(at).fold(0, |nodes, k| nodes | layer(k))
    }
    /// Return the nodes on which a boundary may act in the step from `time`, s, one bit each: those on and behind a
    /// plane at rest, those within `reach`, m, of one that moves, and all for a boundary without a plane.
    pub(in crate::step) fn within_reach(&self, boundary: &Boundary<D>, time: f64, reach: f64) -> u64 {
        let Some(axis) = boundary.across() else { return whole_block(D) };
        let margin = if boundary.rests() { 2e-6 * self.spacing } else { reach };
        self.layers(axis, |index| {
            let mut x = self.low;
            x[axis] = self.origin[axis] + f64::from(index) * self.spacing;
            boundary.reaches(&x, &x, time, margin)
        })
    }
    /// Return the nodes behind planes, one bit each.
    pub(in crate::step) fn copies(&self, mirrors: &[Plane]) -> u64 {
        let behind = |m: &Plane| {
            let (node, _) = self.lattices.node_at_plane(self.level, m.node, m.sign);
            self.layers(m.axis, |index| (index - node) * m.sign < 0)
        };
        mirrors.iter().fold(0, |nodes, m| nodes | behind(m))
    }
    pub(in crate::step) fn is_copy(&self, n: usize, mirrors: &[Plane]) -> bool {
        mirrors.iter().any(|m| {
            let index = self.first[m.axis] + (n / BLOCK.pow(m.axis as u32) % BLOCK) as i32;
            (index - self.lattices.node_at_plane(self.level, m.node, m.sign).0) * m.sign < 0
        })
    }
    /// Return the axes along which a node is behind a plane.
    pub(in crate::step) fn image(&self, n: usize, mirrors: &[Plane]) -> [bool; 3] {
        let mut image = [false; 3];
        for m in mirrors {
            image[m.axis] |= self.is_copy(n, std::slice::from_ref(m));
        }
        image
    }
    pub(in crate::step) fn node(&self, n: usize) -> [f64; D] {
        let mut x = self.origin;
        let mut rest = n;
        for d in 0..D {
            x[d] += f64::from(self.first[d] + (rest % BLOCK) as i32) * self.spacing;
            rest /= BLOCK;
        }
        x
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dim::block_nodes;
    use impactite_geometry::Lattice;
    use impactite_scene::boundary::Side;

    /// Check that a boundary changes no velocity of a node that is not within reach of it.
    fn covers<const D: usize>(boundaries: impl Fn(usize, f64, Side) -> Vec<Boundary<D>>) {
        let spacing = 0.25;
        let lattice = Lattice::new([0.1; D], spacing).expect("a lattice");
        let (time, dt) = (2.0, 0.05);
        let mut spared = 0;
        for (axis, side) in (0..D).flat_map(|axis| [(axis, Side::Above), (axis, Side::Below)]) {
            for place in -6..18 {
                for boundary in boundaries(axis, 0.1 + 0.5 * spacing * f64::from(place), side) {
                    let block = BlockPlace::new(&Lattices::one(lattice), &[0; D]);
                    let nodes = block.within_reach(&boundary, time, 2.0 * spacing);
                    for n in 0..block_nodes(D) {
                        let changes = [1e3, -1e3].iter().any(|speed| {
                            let mut v = [*speed; 3];
                            boundary.constrain(&block.node(n), &mut v, time + dt, 1e-6 * spacing, 0.0);
                            v != [*speed; 3]
                        });
                        assert!(!changes || nodes >> n & 1 != 0, "node {n} of {boundary:?}");
                        spared += usize::from(nodes >> n & 1 == 0);
                    }
                }
            }
        }
        assert!(spared > 0, "all nodes are within reach of all boundaries");
    }

    fn planes<const D: usize>(axis: usize, at: f64, side: Side) -> Vec<Boundary<D>> {
        let mut velocity = [0.3; D];
        // Up to a cell a step, from a place at the time of the step.
        let fast = if side == Side::Above { 4.0 } else { -4.0 };
        let mut list = vec![
            Boundary::Symmetry { axis, at, side },
            Boundary::Fixed { axis, at, side },
            Boundary::Wall { axis, at, side, velocity: 0.0 },
            Boundary::Wall { axis, at: at - 2.0 * fast, side, velocity: fast },
        ];
        for normal in [0.0, fast] {
            velocity[axis] = normal;
            list.push(Boundary::FrictionWall { axis, at: at - 2.0 * normal, side, velocity, friction: 0.2 });
        }
        list
    }

    #[test]
    fn boundaries_change_only_nodes_within_reach() {
        covers::<2>(planes::<2>);
        covers::<3>(planes::<3>);
    }

    #[test]
    fn nodes_behind_a_plane_are_its_copies() {
        let lattice = Lattice::new([0.0; 3], 1.0).expect("a lattice");
        let block = BlockPlace::new(&Lattices::one(lattice), &[0, -1, 2]);
        for (axis, node, sign) in [(0, 2, 1), (1, -2, -1), (2, 8, 1), (2, 11, -1)] {
            let mirror = Plane { axis, node, sign };
            let copies = block.copies(&[mirror]);
            assert!((0..64).all(|n| (copies >> n & 1 != 0) == block.is_copy(n, &[mirror])));
        }
    }
}
