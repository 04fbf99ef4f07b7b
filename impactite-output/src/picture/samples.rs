//! Samples of a field picture: three by three a pixel, of the part of the picture that shows matter.

use std::ops::Range;

use super::axis::PAPER;
use super::canvas::Picture;
use super::colour::Rgb;
use super::refill;

/// Samples per pixel along each side (supersampling).
pub(super) const FINE: usize = 3;
/// Distance assigned to samples inside an element: less than that of any particle.
const ELEMENT: f32 = -1.0;

/// Projected particle, samples.
#[derive(Debug, Clone, Copy)]
pub(super) struct Point {
    pub(super) centre: [f32; 2],
    /// Half of the side of the square of its samples.
    pub(super) reach: f32,
    /// Square of the distance of its farthest sample from the centre.
    pub(super) farthest: f32,
    pub(super) colour: u32,
}

impl Point {
    /// Columns and rows of its samples.
    pub(super) fn range(&self, all: [usize; 2]) -> [Range<usize>; 2] {
        [0, 1].map(|d| {
            let low = (self.centre[d] - self.reach + 0.5).floor().max(0.0) as usize;
            let high = (self.centre[d] + self.reach + 0.5).floor().max(0.0) as usize;
            low.min(all[d])..high.min(all[d])
        })
    }
}

/// Columns and rows of samples around a polygon, `beyond` samples wider.
pub(super) fn range_of(polygon: &[[f32; 2]], beyond: f32, all: [usize; 2]) -> [Range<usize>; 2] {
    [0, 1].map(|d| {
        let (low, high) =
            polygon.iter().fold((f32::INFINITY, f32::NEG_INFINITY), |(l, h), x| (l.min(x[d]), h.max(x[d])));
        let low = (low - beyond).floor().max(0.0) as usize;
        low.min(all[d])..((high + beyond).ceil().max(0.0) as usize).min(all[d])
    })
}

/// Box of samples: first column and row, and those after the last.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Part {
    from: [usize; 2],
    to: [usize; 2],
}

impl Part {
    pub(super) const NONE: Self = Part { from: [usize::MAX; 2], to: [0; 2] };

    /// Include columns and rows.
    pub(super) fn cover(&mut self, range: &[Range<usize>; 2]) {
        if range.iter().all(|range| !range.is_empty()) {
            for (d, range) in range.iter().enumerate() {
                (self.from[d], self.to[d]) = (self.from[d].min(range.start), self.to[d].max(range.end));
            }
        }
    }

    /// Extend by a sample on each side and to whole pixels, within the picture.
    pub(super) fn widened(self, all: [usize; 2]) -> Self {
        if self.to[0] == 0 {
            return Part::default();
        }
        let from = self.from.map(|from| from.saturating_sub(1) / FINE * FINE);
        let to = [0, 1].map(|d| (self.to[d] + 1).next_multiple_of(FINE).min(all[d]));
        Part { from, to }
    }

    fn size(self) -> [usize; 2] {
        [0, 1].map(|d| self.to[d] - self.from[d])
    }
}

/// Samples of the part of a picture that shows matter.
#[derive(Debug, Default)]
pub(super) struct Samples {
    part: Part,
    /// Square of the distance of the nearest particle centre, infinite outside of cells, [`ELEMENT`] in elements.
    nearest: Vec<f32>,
    colour: Vec<u32>,
    kept: Vec<u8>,
    /// Projected particles: memory.
    pub(super) points: Vec<Point>,
}

impl Samples {
    /// Set the part, without matter.
    pub(super) fn clear(&mut self, part: Part) {
        let [columns, rows] = part.size();
        self.part = part;
        refill(&mut self.nearest, columns * rows, f32::INFINITY);
        refill(&mut self.colour, columns * rows, packed(PAPER));
    }

    /// Index of a sample of the part.
    fn index(&self, x: usize, y: usize) -> usize {
        (y - self.part.from[1]) * self.part.size()[0] + x - self.part.from[0]
    }

    pub(super) fn add_point(&mut self, point: &Point, all: [usize; 2]) {
        let [across, down] = point.range(all);
        if across.is_empty() {
            return;
        }
        let [cx, cy] = point.centre;
        for y in down {
            let dy = y as f32 + 0.5 - cy;
            let start = self.index(across.start, y);
            let row = start..start + across.len();
            // Branch-free, for vectorization over samples.
            let samples = self.nearest[row.clone()].iter_mut().zip(&mut self.colour[row]);
            for (n, (nearest, colour)) in (across.start as i32..).zip(samples) {
                let dx = n as f32 + 0.5 - cx;
                let distance = dx * dx + dy * dy;
                let wins = (distance < *nearest) & (distance <= point.farthest);
                *nearest = if wins { distance } else { *nearest };
                *colour = if wins { point.colour } else { *colour };
            }
        }
    }

    /// Draw the samples whose centre is inside a polygon, found by counting crossings of a ray to the right with its edges.
    pub(super) fn add_element(&mut self, outline: &[[f32; 2]], own: Rgb, all: [usize; 2]) {
        let edge = edge_strength(outline);
        let [across, down] = range_of(outline, 0.0, all);
        for y in down {
            for x in across.clone() {
                let at = [x as f32 + 0.5, y as f32 + 0.5];
                let crosses = |n: &usize| {
                    let (a, b) = (outline[*n], outline[(n + 1) % outline.len()]);
                    (a[1] > at[1]) != (b[1] > at[1])
                        && at[0] < a[0] + (at[1] - a[1]) / (b[1] - a[1]) * (b[0] - a[0])
                };
                if (0..outline.len()).filter(crosses).count() % 2 == 0 {
                    continue;
                }
                let light = if edge > 0.0 {
                    1.0 - edge * (EDGE + 0.5 - distance_to(outline, at, true)).clamp(0.0, 1.0)
                } else {
                    1.0
                };
                let sample = self.index(x, y);
                self.nearest[sample] = ELEMENT;
                self.colour[sample] = packed(own.map(|c| (f32::from(c) * light) as u8));
            }
        }
    }

    pub(super) fn add_bar(&mut self, line: &[[f32; 2]; 2], half: f32, own: Rgb, all: [usize; 2]) {
        let [across, down] = range_of(line, half, all);
        for y in down {
            for x in across.clone() {
                let distance = distance_to(line, [x as f32 + 0.5, y as f32 + 0.5], false);
                if distance <= half {
                    let light = if distance > half - EDGE { 0.4 } else { 1.0 };
                    let sample = self.index(x, y);
                    self.colour[sample] = packed(own.map(|c| (f32::from(c) * light) as u8));
                }
            }
        }
    }

    /// Remove the samples near the outside, elements excepted.
    pub(super) fn erode(&mut self, margin: usize) {
        let [columns, rows] = self.part.size();
        self.kept.clear();
        self.kept.extend(self.nearest.iter().map(|d| u8::from(d.is_finite())));
        shrink(&mut self.kept, columns, rows, margin);
        for ((colour, kept), nearest) in self.colour.iter_mut().zip(&self.kept).zip(&self.nearest) {
            if *kept == 0 && *nearest != ELEMENT {
                *colour = packed(PAPER);
            }
        }
    }

    /// Average the samples of each pixel of a picture whose frame has this corner.
    pub(super) fn average(&self, [left, top]: [usize; 2], picture: &mut Picture) {
        let [columns, rows] = self.part.size();
        let (left, top) = (left + self.part.from[0] / FINE, top + self.part.from[1] / FINE);
        let width = picture.width();
        let pixels = picture.pixels_mut();
        for py in 0..rows / FINE {
            for px in 0..columns / FINE {
                let mut sum = [0_u32; 3];
                for y in py * FINE..(py + 1) * FINE {
                    for sample in &self.colour[y * columns + px * FINE..][..FINE] {
                        for c in 0..3 {
                            sum[c] += sample >> (8 * c) & 0xff;
                        }
                    }
                }
                let all = (FINE * FINE) as u32;
                if let Some(pixel) = pixels.get_mut((top + py) * width + left + px) {
                    *pixel = sum.map(|s| ((s + all / 2) / all) as u8);
                }
            }
        }
    }
}

/// Pack a colour into one number.
pub(super) fn packed([r, g, b]: Rgb) -> u32 {
    u32::from_le_bytes([r, g, b, 0])
}

/// Half width of the edges of elements, samples.
const EDGE: f32 = 1.0;

/// Opacity of the edges of an element: 0 if edges would cover small elements.
fn edge_strength(outline: &[[f32; 2]]) -> f32 {
    let next = outline.iter().cycle().skip(1);
    let sides = outline.iter().zip(next).map(|(a, b)| (a[0] - b[0]).hypot(a[1] - b[1]));
    let shortest = sides.fold(f32::INFINITY, f32::min) / FINE as f32;
    0.45 * ((shortest - 4.0) / 6.0).clamp(0.0, 1.0)
}

/// Distance of a point from a polyline, closed or open.
fn distance_to(points: &[[f32; 2]], place: [f32; 2], closed: bool) -> f32 {
    let count = if closed { points.len() } else { points.len().saturating_sub(1) };
    let mut nearest = f32::INFINITY;
    for n in 0..count {
        let (a, b) = (points[n], points[(n + 1) % points.len()]);
        let (dx, dy, x, y) = (b[0] - a[0], b[1] - a[1], place[0] - a[0], place[1] - a[1]);
        let along = ((x * dx + y * dy) / (dx * dx + dy * dy).max(1e-12)).clamp(0.0, 1.0);
        nearest = nearest.min((x - along * dx).hypot(y - along * dy));
    }
    nearest
}

/// Erode: set to zero all samples within `margin` samples (along rows or columns, 254 at most) of a zero. Samples beyond the edges of the
/// picture do not count as zeros.
fn shrink(kept: &mut [u8], columns: usize, rows: usize, margin: usize) {
    if columns == 0 || rows == 0 {
        return;
    }
    let margin = margin.min(254);
    let next = |row: &[u8], from: usize, what: u8| {
        row[from..].iter().position(|kept| *kept == what).map_or(row.len(), |n| from + n)
    };
    for row in kept.chunks_exact_mut(columns) {
        // Alternate between runs of outside and inside samples.
        let mut from = next(row, 0, 0);
        if from < columns {
            row[from.saturating_sub(margin)..from].fill(0);
        }
        while from < columns {
            let to = next(row, from, 1);
            from = next(row, to, 0);
            row[to..(to + margin).min(from)].fill(0);
            if from < columns {
                row[from.saturating_sub(margin).max(to)..from].fill(0);
            }
        }
    }
    // Distance from the outside above and below in samples, for all columns of a row at once.
    let far = margin as u8 + 1;
    let mut since = vec![far; columns];
    for row in kept.chunks_exact_mut(columns).take(rows) {
        for (kept, since) in row.iter_mut().zip(&mut since) {
            *since = if *kept == 0 { 0 } else { since.saturating_add(1).min(far) };
            *kept = *since;
        }
    }
    since.fill(far);
    for row in kept.chunks_exact_mut(columns).take(rows).rev() {
        for (kept, since) in row.iter_mut().zip(&mut since) {
            *since = if *kept == 0 { 0 } else { since.saturating_add(1).min(far) };
            *kept = u8::from(*kept == far && *since == far);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_near_the_outside_is_taken_away() {
        let mut seed = 5_u64;
        for (columns, rows, margin) in [(1, 1, 0), (7, 5, 1), (40, 23, 3), (31, 17, 60), (12, 300, 60)] {
            let mut next = || {
                seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                (seed >> 33) % 60
            };
            let all: Vec<u8> = (0..columns * rows).map(|_| u8::from(next() > 0)).collect();
            let mut kept = all.clone();
            shrink(&mut kept, columns, rows, margin);
            let near =
                |place: usize, count: usize| place.saturating_sub(margin)..(place + margin + 1).min(count);
            for y in 0..rows {
                for x in 0..columns {
                    let inside = near(y, rows).all(|y| near(x, columns).all(|x| all[y * columns + x] == 1));
                    assert_eq!(
                        kept[y * columns + x],
                        u8::from(inside),
                        "{x} {y} of {columns} x {rows}, {margin}"
                    );
                }
            }
        }
    }
}
