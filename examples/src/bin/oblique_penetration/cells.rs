//! How many cells hold particles.

use std::collections::HashSet;

use mpm_core::observe::RunView;

/// Cells with particles, and the box around all of them.
#[derive(Default)]
pub struct Cells {
    most: f64,
    /// The first and the last cell along each axis.
    ends: Option<[[f64; 3]; 2]>,
}

impl Cells {
    /// A look at all particles: how many cells of this size (m) hold some, and the first and the last cell along each axis.
    pub fn seen(now: &RunView<'_>, spacing: f64) -> [f64; 7] {
        let mut cells = HashSet::new();
        let (mut low, mut high) = ([i64::MAX; 3], [i64::MIN; 3]);
        for body in now.bodies() {
            body.for_each(&mut |p| {
                let cell = p.position.map(|x| (x / spacing).floor() as i64);
                for d in 0..3 {
                    low[d] = low[d].min(cell[d]);
                    high[d] = high[d].max(cell[d]);
                }
                cells.insert(cell);
            });
        }
        let ([a, b, c], [x, y, z]) = (low.map(|c| c as f64), high.map(|c| c as f64));
        [cells.len() as f64, a, b, c, x, y, z]
    }
    /// Add what was seen.
    pub fn add(&mut self, [cells, a, b, c, x, y, z]: [f64; 7]) {
        let [low, high] = self.ends.get_or_insert([[a, b, c], [x, y, z]]);
        for (d, (first, last)) in [(a, x), (b, y), (c, z)].into_iter().enumerate() {
            low[d] = low[d].min(first);
            high[d] = high[d].max(last);
        }
        self.most = self.most.max(cells);
    }
    /// Most cells with particles so far, and cells of the box around all that were seen.
    pub fn share(&self) -> [usize; 2] {
        let [low, high] = self.ends.unwrap_or([[0.0; 3], [-1.0; 3]]);
        let edges = (0..3).map(|d| (high[d] - low[d] + 1.0) as usize);
        [self.most as usize, edges.product()]
    }
}
