//! Surface profile of a heap of particles in two dimensions.

use mpm_core::output::Snapshot;

/// Heights above a floor in columns of equal width, from the particle volume in each.
#[derive(Clone, Debug, PartialEq)]
pub struct Heap {
    /// Left edge of the first column, m.
    pub left: f64,
    /// Width of a column, m.
    pub width: f64,
    /// Mean height of each column above the floor, m.
    pub heights: Vec<f64>,
    /// Area of all particles, m^2.
    pub area: f64,
}

impl Heap {
    /// Measure a plane snapshot: heights between `left` and `right` in columns of `width`, m, and the area of all particles.
    pub fn new(snapshot: &Snapshot, [left, right]: [f64; 2], width: f64) -> Self {
        let count = ((right - left) / width).ceil().max(1.0) as usize;
        let mut heights = vec![0.0; count];
        let mut area = 0.0;
        for (n, x) in snapshot.positions().iter().enumerate() {
            let (size, column) = (snapshot.size_of(n), (x[0] - left) / width);
            area += size * size;
            if (0.0..count as f64).contains(&column) {
                heights[column as usize] += size * size / width;
            }
        }
        Heap { left, width, heights, area }
    }

    /// Centre of a column, m.
    pub fn middle(&self, column: usize) -> f64 {
        self.left + (column as f64 + 0.5) * self.width
    }
    /// Return the position of the front, m: the height falls below `least`, m, going right from the column at `from`, m.
    pub fn front(&self, from: f64, least: f64) -> f64 {
        let start = ((from - self.left) / self.width).max(0.0) as usize;
        let end = (start..self.heights.len()).find(|&n| self.heights[n] < least);
        let end = end.unwrap_or(self.heights.len());
        let [a, b] = [end.checked_sub(1), Some(end)]
            .map(|n| n.and_then(|n| self.heights.get(n)).copied().unwrap_or(0.0));
        // Interpolate between the centres of the last column above and the first below.
        let part = if a > b { ((a - least) / (a - b)).clamp(0.0, 1.0) } else { 0.5 };
        self.left + (end as f64 - 0.5 + part) * self.width
    }
    /// Return the steepest fall to the right, radians: lines fitted to stretches of `length`, m, higher than `least`, m, throughout.
    pub fn steepest(&self, length: f64, least: f64) -> f64 {
        let count = ((length / self.width).round() as usize).max(2);
        let fall = |stretch: &[f64]| {
            let middle = 0.5 * (count as f64 - 1.0);
            let (mut up, mut down) = (0.0, 0.0);
            for (n, h) in stretch.iter().enumerate() {
                up += (n as f64 - middle) * h;
                down += (n as f64 - middle).powi(2) * self.width;
            }
            -up / down
        };
        let high = self.heights.windows(count).filter(|s| s.iter().all(|h| *h > least));
        high.map(fall).fold(0.0, f64::max).atan()
    }
}

#[cfg(test)]
mod tests {
    use mpm_core::output::ParticleSize;

    use super::*;

    /// Triangle of particles 0.01 wide, with a slope of 1 : 2 down from (0, 1).
    fn triangle() -> Snapshot {
        let edge = 0.01;
        let mut places = Vec::new();
        for i in 0..200 {
            for j in 0..100 {
                let (x, z) = ((f64::from(i) + 0.5) * edge, (f64::from(j) + 0.5) * edge);
                if z < 1.0 - 0.5 * x {
                    places.push([x, z, 0.0]);
                }
            }
        }
        Snapshot::new(2, 0.0, 0, places, ParticleSize::Uniform(edge)).expect("a snapshot")
    }

    #[test]
    fn a_triangle_has_its_area_front_and_slope() {
        let heap = Heap::new(&triangle(), [0.0, 3.0], 0.04);
        assert!((heap.area - 1.0).abs() < 0.01, "{}", heap.area);
        // Columns are 0.04 wide; the particle height is half the least height.
        assert!((heap.front(0.0, 0.02) - 1.96).abs() < 0.03, "{}", heap.front(0.0, 0.02));
        assert!((heap.steepest(0.4, 0.02).tan() - 0.5).abs() < 0.02);
        assert!((heap.heights[0] - 0.99).abs() < 0.011);
    }
}
