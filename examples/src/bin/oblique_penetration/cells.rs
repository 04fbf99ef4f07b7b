//! How many cells hold particles.

use std::collections::HashSet;

use mpm_core::observe::Moment;

/// Cells with particles, and the box around all of them.
pub struct Cells {
    spacing: f64,
    most: usize,
    low: [i64; 3],
    high: [i64; 3],
}

impl Cells {
    /// Of this size, m.
    pub fn new(spacing: f64) -> Self {
        Cells { spacing, most: 0, low: [i64::MAX; 3], high: [i64::MIN; 3] }
    }
    /// Look at all particles.
    pub fn look(&mut self, now: &Moment<'_, f64, 3>) {
        let mut cells = HashSet::new();
        for body in now.bodies() {
            body.for_each(&mut |p| {
                let cell = p.position.map(|x| (x / self.spacing).floor() as i64);
                for d in 0..3 {
                    self.low[d] = self.low[d].min(cell[d]);
                    self.high[d] = self.high[d].max(cell[d]);
                }
                cells.insert(cell);
            });
        }
        self.most = self.most.max(cells.len());
    }
    /// Most cells with particles so far, and cells of the box around all that were seen.
    pub fn share(&self) -> [usize; 2] {
        let edges = (0..3).map(|d| usize::try_from(self.high[d] - self.low[d] + 1).unwrap_or(0));
        [self.most, edges.product()]
    }
}
