//! Occupancy of the grid: cells that contain particles.

use std::collections::HashSet;

use mpm_core::observe::RunView;

/// Number of occupied cells, and their bounding box.
#[derive(Default)]
pub struct Cells {
    most: f64,
    /// First and last cell along each axis.
    ends: Option<[[f64; 3]; 2]>,
}

impl Cells {
    /// Count the cells of this size (m) that contain particles, and find the first and last cell along each axis.
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
    /// Record a count.
    pub fn add(&mut self, [cells, a, b, c, x, y, z]: [f64; 7]) {
        let [low, high] = self.ends.get_or_insert([[a, b, c], [x, y, z]]);
        for (d, (first, last)) in [(a, x), (b, y), (c, z)].into_iter().enumerate() {
            low[d] = low[d].min(first);
            high[d] = high[d].max(last);
        }
        self.most = self.most.max(cells);
    }
    /// Return the largest number of occupied cells so far, and the number of cells in the bounding box of all counts.
    pub fn share(&self) -> [usize; 2] {
        let [low, high] = self.ends.unwrap_or([[0.0; 3], [-1.0; 3]]);
        let edges = (0..3).map(|d| (high[d] - low[d] + 1.0) as usize);
        [self.most as usize, edges.product()]
    }
}
