//! Density of balls: hidden balls, surface normals and ambient occlusion.

use super::colour::Rgb;
use super::refill;

/// Particle to draw.
pub(super) struct Ball {
    pub(super) x: [f64; 3],
    pub(super) radius: f64,
    pub(super) colour: Rgb,
}

/// Density of balls on a coarse lattice.
#[derive(Debug, Default)]
pub(super) struct Matter {
    low: [f64; 3],
    per_metre: f64,
    n: [usize; 3],
    fine: Vec<f32>,
    wide: Vec<f32>,
    usual: f32,
    /// Cell of each ball, [`NOWHERE`] for those far from the bulk.
    home: Vec<u32>,
    deep: Vec<bool>,
    /// True if cells are too large to determine hidden balls.
    pub(super) coarse: bool,
}

/// Positions of balls by cell of [`Matter`]: those of cell c are `places[start[c]..start[c + 1]]`.
#[derive(Debug, Default)]
pub(super) struct Neighbours {
    start: Vec<u32>,
    places: Vec<[f32; 3]>,
    next: Vec<u32>,
}

/// Approximate maximum number of cells of the lattice; cells are enlarged if the bulk needs more.
const CELLS: f64 = 3.0e6;

/// Cell index of balls outside the lattice.
const NOWHERE: u32 = u32::MAX;

impl Matter {
    /// Measure the density of these balls.
    pub(super) fn measure(&mut self, balls: &[Ball]) {
        let mut low = [f64::INFINITY; 3];
        let mut high = [f64::NEG_INFINITY; 3];
        let mut radius = 0.0;
        for ball in balls {
            for d in 0..3 {
                low[d] = low[d].min(ball.x[d]);
                high[d] = high[d].max(ball.x[d]);
            }
            radius += ball.radius / balls.len() as f64;
        }
        if balls.is_empty() {
            (low, high, radius) = ([0.0; 3], [0.0; 3], 1.0);
        }
        // The radius of a ball is 0.75 particle sizes; a cell is 1.6 sizes.
        let usual_cell = radius * (1.6 / 0.75);
        let count = |cell: f64, low: [f64; 3], high: [f64; 3]| {
            (0..3).map(|d| (high[d] - low[d]) / cell + 8.0).product::<f64>()
        };
        if count(usual_cell, low, high) > CELLS {
            // Restrict the lattice to the bulk: exclude the outermost percent on each side, except near the bulk.
            for d in 0..3 {
                let mut sample: Vec<f64> =
                    balls.iter().step_by(balls.len() / 4000 + 1).map(|ball| ball.x[d]).collect();
                sample.sort_by(f64::total_cmp);
                let (first, last) =
                    (sample[sample.len() / 100], sample[sample.len() - 1 - sample.len() / 100]);
                let near = 0.2 * (last - first);
                (low[d], high[d]) = (low[d].max(first - near), high[d].min(last + near));
            }
        }
        // Minimum cell size: smaller cells are too many in any case, and a size of zero could not be enlarged.
        let longest = (0..3).map(|d| high[d] - low[d]).fold(0.0, f64::max);
        let mut cell = usual_cell.max(longest / CELLS);
        while count(cell, low, high) > CELLS {
            cell *= 1.2;
        }
        let coarse = cell > 1.3 * usual_cell;
        let n = [0, 1, 2].map(|d| ((high[d] - low[d]) / cell) as usize + 8);
        let inside = |x: &[f64; 3]| (0..3).all(|d| x[d] >= low[d] && x[d] <= high[d]);
        let outside: Vec<bool> = balls.iter().map(|ball| !inside(&ball.x)).collect();
        let low = low.map(|x| x - 3.5 * cell);
        let per_metre = 1.0 / cell;
        let total = n[0] * n[1] * n[2];
        let Matter { fine, wide, home, deep, .. } = self;
        refill(fine, total, 0.0);
        refill(deep, total, false);
        home.clear();
        for (ball, outside) in balls.iter().zip(outside) {
            let places = [0, 1, 2].map(|d| (ball.x[d] - low[d]) * per_metre);
            // Far from the origin, rounding may consume the margin.
            if outside || !(0..3).all(|d| places[d] >= 2.0 && places[d] <= n[d] as f64 - 2.0) {
                home.push(NOWHERE);
                continue;
            }
            let mut base = [0; 3];
            let mut part = [0.0_f32; 3];
            let mut own = [0; 3];
            for d in 0..3 {
                own[d] = places[d] as usize;
                base[d] = (places[d] - 0.5) as usize;
                part[d] = (places[d] - 0.5) as f32 - base[d] as f32;
            }
            let cell = (own[2] * n[1] + own[1]) * n[0] + own[0];
            deep[cell] = true;
            home.push(cell as u32);
            for k in 0..8 {
                let bit = [k & 1, (k >> 1) & 1, k >> 2];
                let weight: f32 = (0..3).map(|d| if bit[d] == 1 { part[d] } else { 1.0 - part[d] }).product();
                fine[((base[2] + bit[2]) * n[1] + base[1] + bit[1]) * n[0] + base[0] + bit[0]] += weight;
            }
        }
        let mut usual: Vec<f32> = home
            .iter()
            .step_by(home.len() / 2000 + 1)
            .filter_map(|c| fine.get(*c as usize).copied())
            .collect();
        usual.sort_by(f32::total_cmp);
        let usual = usual.get(usual.len() * 3 / 4).copied().unwrap_or(1.0).max(1e-6);
        // Cap the density, so that dense regions of particles do not cast shadows.
        for value in fine.iter_mut() {
            *value = value.min(1.3 * usual);
        }
        let strides = [1, n[0], n[0] * n[1]];
        for stride in strides {
            blur(fine, stride);
        }
        wide.clone_from(fine);
        for _ in 0..3 {
            for stride in strides {
                blur(wide, stride);
            }
        }
        for stride in strides {
            erode(deep, stride);
        }
        (self.low, self.per_metre, self.n, self.usual, self.coarse) = (low, per_metre, n, usual, coarse);
    }

    /// True if ball `i` is surrounded by matter.
    pub(super) fn hides(&self, i: usize) -> bool {
        !self.coarse && self.deep.get(self.home[i] as usize).is_some_and(|deep| *deep)
    }

    /// Sort the balls by cell.
    pub(super) fn sort(&self, balls: &[Ball], neighbours: &mut Neighbours) {
        let Neighbours { start, places, next } = neighbours;
        refill(start, self.fine.len() + 1, 0);
        for cell in self.home.iter().filter(|cell| **cell != NOWHERE) {
            start[*cell as usize + 1] += 1;
        }
        for c in 0..self.fine.len() {
            start[c + 1] += start[c];
        }
        next.clone_from(start);
        refill(places, balls.len(), [0.0; 3]);
        for (ball, cell) in balls.iter().zip(&self.home).filter(|(_, cell)| **cell != NOWHERE) {
            let at = &mut next[*cell as usize];
            places[*at as usize] = [0, 1, 2].map(|d| (ball.x[d] - self.low[d]) as f32);
            *at += 1;
        }
    }

    /// Growth factor of a ball that closes gaps to its neighbours in stretched matter. The nearest
    /// neighbour is searched in each of the eight octants, and the ball extends over 0.4 of the distance to the third
    /// farthest of those within reach, which leaves a cubic lattice unchanged and ignores single outliers.
    pub(super) fn growth(&self, i: usize, ball: &Ball, neighbours: &Neighbours) -> f32 {
        const MOST: f32 = 1.7;
        if self.coarse || self.home[i] == NOWHERE {
            return 1.0;
        }
        let radius = ball.radius as f32;
        let reach = 4.0 * radius;
        let x = [0, 1, 2].map(|d| (ball.x[d] - self.low[d]) as f32);
        let mut nearest = [f32::INFINITY; 8];
        let (row, layer) = (self.n[0], self.n[0] * self.n[1]);
        let corner = self.home[i] as usize - layer - row - 1;
        for k in 0..3 {
            for j in 0..3 {
                let first = corner + k * layer + j * row;
                let (from, to) = (neighbours.start[first], neighbours.start[first + 3]);
                for other in &neighbours.places[from as usize..to as usize] {
                    let d = [other[0] - x[0], other[1] - x[1], other[2] - x[2]];
                    let square = dot3(d, d);
                    let octant =
                        usize::from(d[0] > 0.0) | usize::from(d[1] > 0.0) << 1 | usize::from(d[2] > 0.0) << 2;
                    if square > 0.0 && square < nearest[octant] {
                        nearest[octant] = square;
                    }
                }
            }
        }
        for square in &mut nearest {
            if *square > reach * reach {
                *square = 0.0;
            }
        }
        nearest.sort_by(f32::total_cmp);
        (0.40 * nearest[5].sqrt() / radius).clamp(1.0, MOST)
    }

    /// Outward unit normal of the matter at a point (zero far inside), and sky visibility (about 1 on
    /// a flat surface, less in corners).
    pub(super) fn surface(&self, i: usize, x: [f64; 3]) -> ([f64; 3], f32) {
        if self.home[i] == NOWHERE {
            return ([0.0; 3], 1.0);
        }
        // Quadratic B-splines: continuous gradients from 27 values.
        let mut base = [0; 3];
        let mut w = [[0.0_f32; 3]; 3];
        let mut g = [[0.0_f32; 3]; 3];
        for d in 0..3 {
            let place = (x[d] - self.low[d]) * self.per_metre;
            base[d] = place as usize - 1;
            let t = (place - place.floor()) as f32;
            w[d] = [0.5 * (1.0 - t) * (1.0 - t), 0.5 + t * (1.0 - t), 0.5 * t * t];
            g[d] = [t - 1.0, 1.0 - 2.0 * t, t];
        }
        let (mut slope, mut around) = ([0.0_f32; 3], 0.0);
        for k in 0..3 {
            for j in 0..3 {
                let row = ((base[2] + k) * self.n[1] + base[1] + j) * self.n[0] + base[0];
                for i in 0..3 {
                    let value = self.fine[row + i];
                    slope[0] -= g[0][i] * w[1][j] * w[2][k] * value;
                    slope[1] -= w[0][i] * g[1][j] * w[2][k] * value;
                    slope[2] -= w[0][i] * w[1][j] * g[2][k] * value;
                    around += w[0][i] * w[1][j] * w[2][k] * self.wide[row + i];
                }
            }
        }
        let length = (slope[0] * slope[0] + slope[1] * slope[1] + slope[2] * slope[2]).sqrt();
        let full = 0.04 * self.usual;
        let normal = slope.map(|s| f64::from(s / length.max(full)));
        let crowd = around / self.usual;
        (normal, (1.0 - 0.9 * (crowd - 0.52)).clamp(0.55, 1.10))
    }
}

/// Smooth along one direction by 1/4, 1/2, 1/4. The empty margins of the lattice allow rows to be treated as one array.
fn blur(values: &mut [f32], stride: usize) {
    if stride == 1 {
        let mut before = 0.0;
        for i in 0..values.len().saturating_sub(1) {
            let here = values[i];
            values[i] = 0.25 * (before + values[i + 1]) + 0.5 * here;
            before = here;
        }
        return;
    }
    let mut before = vec![0.0_f32; stride];
    let mut start = 0;
    while start + 2 * stride <= values.len() {
        let (head, tail) = values[start..].split_at_mut(stride);
        for ((value, before), after) in head.iter_mut().zip(&mut before).zip(tail) {
            let here = *value;
            *value = 0.25 * (*before + *after) + 0.5 * here;
            *before = here;
        }
        start += stride;
    }
}

/// Erode: keep only cells whose two neighbours along one direction are kept.
fn erode(kept: &mut [bool], stride: usize) {
    if stride == 1 {
        let mut before = false;
        for i in 0..kept.len().saturating_sub(1) {
            let here = kept[i];
            kept[i] = before & here & kept[i + 1];
            before = here;
        }
        return;
    }
    let mut before = vec![false; stride];
    let mut start = 0;
    while start + 2 * stride <= kept.len() {
        let (head, tail) = kept[start..].split_at_mut(stride);
        for ((value, before), after) in head.iter_mut().zip(&mut before).zip(tail) {
            let here = *value;
            *value = *before & here & *after;
            *before = here;
        }
        start += stride;
    }
}

pub(super) fn dot3(a: [f32; 3], b: [f32; 3]) -> f32 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}
