//! Impulses on nodes within a step.

/// Impulses on a node in the present step, N s.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Push<const D: usize> {
    pub node: u32,
    /// Impulse of couplings.
    pub given: [f64; D],
    /// Impulse of contact in the scene.
    pub touch: [f64; D],
    /// Impulse of surface loads.
    pub load: [f64; D],
}

impl<const D: usize> Push<D> {
    /// Create an entry of a node without impulses.
    pub fn of(node: u32) -> Self {
        Push { node, given: [0.0; D], touch: [0.0; D], load: [0.0; D] }
    }
    /// Sum of the impulses.
    pub fn sum(&self) -> [f64; D] {
        std::array::from_fn(|d| self.given[d] + self.touch[d] + self.load[d])
    }
}

/// Sort impulses by node, and merge those of the same node.
pub(crate) fn merge<const D: usize>(pushes: &mut Vec<Push<D>>) {
    pushes.sort_by_key(|push| push.node);
    pushes.dedup_by(|next, sum| {
        let same = next.node == sum.node;
        if same {
            for d in 0..D {
                sum.given[d] += next.given[d];
                sum.touch[d] += next.touch[d];
                sum.load[d] += next.load[d];
            }
        }
        same
    });
}
