//! Which boxes of space a surface comes near to in a step.

/// Most cells along an axis.
const MOST: f64 = 48.0;

/// Cells of a box around a surface, with those marked that its facets sweep.
#[derive(Clone, Debug, Default)]
pub(crate) struct SweptCells<const D: usize> {
    low: Vec<f64>,
    edge: f64,
    counts: Vec<usize>,
    marked: Vec<bool>,
}

impl<const D: usize> SweptCells<D> {
    /// Mark those of these boxes (lower and upper corner, m).
    pub fn mark(&mut self, boxes: &[([f64; D], [f64; D])]) {
        let (mut low, mut high, mut size) = ([f64::INFINITY; D], [f64::NEG_INFINITY; D], 0.0);
        for (a, b) in boxes {
            for d in 0..D {
                (low[d], high[d]) = (low[d].min(a[d]), high[d].max(b[d]));
                size += (b[d] - a[d]) / (D * boxes.len()) as f64;
            }
        }
        let longest = (0..D).map(|d| high[d] - low[d]).fold(0.0, f64::max);
        self.edge = size.max(longest / MOST).max(f64::MIN_POSITIVE);
        self.low = low.to_vec();
        self.counts = (0..D).map(|d| ((high[d] - low[d]) / self.edge) as usize + 1).collect();
        self.marked.clear();
        self.marked.resize(if boxes.is_empty() { 0 } else { self.counts.iter().product() }, false);
        for (a, b) in boxes {
            let (first, last) = (self.cell(a), self.cell(b));
            let mut marked = std::mem::take(&mut self.marked);
            self.each(&first, &last, |at| {
                marked[at] = true;
                false
            });
            self.marked = marked;
        }
    }

    /// Is one marked that this box touches?
    pub fn touches(&self, low: &[f64; D], high: &[f64; D]) -> bool {
        let within =
            |d: usize| high[d] >= self.low[d] && low[d] <= self.low[d] + self.edge * self.counts[d] as f64;
        !self.marked.is_empty()
            && (0..D).all(within)
            && self.each(&self.cell(low), &self.cell(high), |at| self.marked[at])
    }

    /// The cell of a point, or the nearest one.
    fn cell(&self, x: &[f64; D]) -> [usize; D] {
        std::array::from_fn(|d| {
            (((x[d] - self.low[d]) / self.edge).max(0.0) as usize).min(self.counts[d] - 1)
        })
    }

    /// Call `visit` for every cell from one to another until it says so. Did it?
    fn each(&self, first: &[usize; D], last: &[usize; D], mut visit: impl FnMut(usize) -> bool) -> bool {
        let mut at = *first;
        loop {
            if visit((0..D).rev().fold(0, |n, d| n * self.counts[d] + at[d])) {
                return true;
            }
            let Some(d) = (0..D).find(|&d| at[d] < last[d]) else { return false };
            at[d] += 1;
            at[..d].copy_from_slice(&first[..d]);
        }
    }

    pub fn bytes(&self) -> usize {
        self.marked.capacity()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn boxes_near_the_facets_are_found_and_others_are_not() {
        let mut cells = SweptCells::<2>::default();
        assert!(!{
            cells.mark(&[]);
            cells.touches(&[0.0; 2], &[1.0; 2])
        });
        // The four sides of a square of edge 1.
        let mut sides = Vec::new();
        for n in 0..20 {
            let (a, b) = (f64::from(n) / 20.0, f64::from(n + 1) / 20.0);
            sides.extend([
                ([a, 0.0], [b, 0.0]),
                ([a, 1.0], [b, 1.0]),
                ([0.0, a], [0.0, b]),
                ([1.0, a], [1.0, b]),
            ]);
        }
        cells.mark(&sides);
        for (low, high, near) in [
            ([0.4, -0.1], [0.5, 0.0], true),
            ([0.95, 0.3], [1.2, 0.35], true),
            ([-5.0; 2], [5.0; 2], true),
            ([0.3; 2], [0.7; 2], false),
            ([1.3, 0.3], [1.4, 0.4], false),
            ([f64::NAN; 2], [0.4; 2], false),
        ] {
            assert_eq!(cells.touches(&low, &high), near, "{low:?} to {high:?}");
        }
    }
}
