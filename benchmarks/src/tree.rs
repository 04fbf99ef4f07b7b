//! Search by a tree of boxes.

use pcmm::Particle;

use crate::{Lists, half_box, largest_radius, touch};

/// Particles of a leaf.
const LEAF: usize = 8;

/// A balanced tree: the box of its particles, which are a part of one list.
struct Tree {
    /// Box, and the range in the list; children of node n are 2 n + 1 and 2 n + 2.
    nodes: Vec<([f64; 4], u32, u32)>,
    order: Vec<u32>,
}

impl Tree {
    fn new(particles: &[Particle<2>]) -> Self {
        let mut tree = Tree { nodes: Vec::new(), order: (0..particles.len() as u32).collect() };
        if !particles.is_empty() {
            tree.build(particles, 0, 0, particles.len());
        }
        tree
    }

    fn build(&mut self, particles: &[Particle<2>], node: usize, from: usize, to: usize) {
        let mut range = [f64::INFINITY, f64::INFINITY, f64::NEG_INFINITY, f64::NEG_INFINITY];
        for &i in &self.order[from..to] {
            let x = &particles[i as usize].position;
            for d in 0..2 {
                range[d] = range[d].min(x[d]);
                range[d + 2] = range[d + 2].max(x[d]);
            }
        }
        if self.nodes.len() <= node {
            self.nodes.resize(node + 1, ([0.0; 4], 0, 0));
        }
        self.nodes[node] = (range, from as u32, to as u32);
        if to - from > LEAF {
            let axis = usize::from(range[3] - range[1] > range[2] - range[0]);
            let middle = (to - from) / 2;
            let along = |i: &u32| particles[*i as usize].position[axis];
            self.order[from..to].select_nth_unstable_by(middle, |a, b| along(a).total_cmp(&along(b)));
            self.build(particles, 2 * node + 1, from, from + middle);
            self.build(particles, 2 * node + 2, from + middle, to);
        }
    }

    /// The particles in a box around `x`.
    fn visit(&self, particles: &[Particle<2>], x: &[f64; 2], half: f64, found: &mut impl FnMut(u32)) {
        let mut stack = [0usize; 64];
        let mut depth = 1;
        while depth > 0 {
            depth -= 1;
            let node = stack[depth];
            let (range, from, to) = &self.nodes[node];
            if (0..2).any(|d| x[d] + half < range[d] || x[d] - half > range[d + 2]) {
                continue;
            }
            if (to - from) as usize <= LEAF {
                for &i in &self.order[*from as usize..*to as usize] {
                    let y = &particles[i as usize].position;
                    if (0..2).all(|d| (y[d] - x[d]).abs() <= half) {
                        found(i);
                    }
                }
            } else {
                stack[depth] = 2 * node + 1;
                stack[depth + 1] = 2 * node + 2;
                depth += 2;
            }
        }
    }
}

/// Neighbours by a tree: O(N log N).
pub fn tree(particles: &[Particle<2>], reach: f64) -> Lists {
    let (tree, largest) = (Tree::new(particles), largest_radius(particles));
    let mut lists = Lists::new(particles.len());
    for (i, p) in particles.iter().enumerate() {
        tree.visit(particles, &p.position, half_box(p, largest, reach), &mut |j| {
            if j as usize != i && touch(p, &particles[j as usize], reach) {
                lists.list.push(j);
            }
        });
        lists.close();
    }
    lists
}
