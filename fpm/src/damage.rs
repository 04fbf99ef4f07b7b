//! Damage field and crack lines for files and pictures.

use crate::fracture::Crack;
use crate::method::Composition;
use crate::solver::Fpm;
use crate::vector::{along, norm};

impl<const D: usize, M: Composition<D>> Fpm<D, M> {
    /// Damage of each cell, in sorted order, for files and pictures: cracked part of the area of its faces to neighbours, each face
    /// weighted by its damage. Zero for an intact cell, one for a lone cell.
    pub fn damage(&self) -> Vec<f64> {
        let mut cracked = vec![0.0; self.reference.len()];
        for crack in &self.cracks {
            let area = crack.damage() * norm(&crack.surface.area);
            crack.cells.iter().for_each(|&c| cracked[c as usize] += area);
        }
        let of = |(cell, cracked): (usize, &f64)| {
            let faces = self.sides.of(cell).map(|side| norm(&self.sides.surface[side].area));
            let all: f64 = faces.sum();
            if all > 0.0 { (cracked / all).min(1.0) } else { 0.0 }
        };
        cracked.iter().enumerate().map(of).collect()
    }
}

impl<M: Composition<2>> Fpm<2, M> {
    /// Both sides of the open faces selected by `shown`, in the present configuration: lines of two places, m, for pictures.
    pub fn crack_lines(&self, shown: impl Fn(&Crack<2>) -> bool) -> Vec<[[f64; 2]; 2]> {
        let mut lines = Vec::new();
        for (crack, seen) in self.cracks.iter().zip(self.cracks()) {
            if !shown(&seen) {
                continue;
            }
            let [x, y] = crack.surface.area;
            let half = [-0.5 * y, 0.5 * x];
            for (&cell, arm) in crack.cells.iter().zip([&crack.surface.own, &crack.surface.other]) {
                let (cell, trace) = (cell as usize, &self.traces[cell as usize]);
                lines.push([-1.0, 1.0].map(|end| {
                    let arm = along(arm, end, &half);
                    along(&along(&self.reference[cell], 1.0, &arm), 1.0, &trace.at(&arm))
                }));
            }
        }
        lines
    }
}
