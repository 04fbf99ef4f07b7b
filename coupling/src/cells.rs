//! Bounding boxes swept by a surface in a step, in a cell list.

/// Maximum number of cells along an axis.
const MOST: f64 = 64.0;

/// Boxes swept by the facets of a surface, in a cell list over their bounding box.
#[derive(Clone, Debug, Default)]
pub(crate) struct SweptBoxes<const D: usize> {
    low: Vec<f64>,
    edge: f64,
    counts: Vec<usize>,
    boxes: Vec<([f64; D], [f64; D])>,
    /// Offset of the boxes of each cell in `sorted`; one more than the number of cells.
    starts: Vec<u32>,
    sorted: Vec<u32>,
}

impl<const D: usize> SweptBoxes<D> {
    /// Replace the boxes by these (lower and upper corner, m).
    pub fn fill(&mut self, boxes: impl Iterator<Item = ([f64; D], [f64; D])>) {
        self.boxes.clear();
        self.boxes.extend(boxes);
        let boxes = std::mem::take(&mut self.boxes);
        let (mut low, mut high, mut size) = ([f64::INFINITY; D], [f64::NEG_INFINITY; D], 0.0);
        for (a, b) in &boxes {
            for d in 0..D {
                (low[d], high[d]) = (low[d].min(a[d]), high[d].max(b[d]));
                size += (b[d] - a[d]) / (D * boxes.len()) as f64;
            }
        }
        let longest = (0..D).map(|d| high[d] - low[d]).fold(0.0, f64::max);
        self.edge = size.max(longest / MOST).max(f64::MIN_POSITIVE);
        self.low = low.to_vec();
        self.counts = (0..D).map(|d| ((high[d] - low[d]) / self.edge) as usize + 1).collect();
        let cells = if boxes.is_empty() { 0 } else { self.counts.iter().product() };
        // Counting sort: number of boxes of each cell, then end of each cell, then start.
        let mut starts = std::mem::take(&mut self.starts);
        starts.clear();
        starts.resize(cells + 1, 0);
        let each = |this: &Self, (a, b): &([f64; D], [f64; D]), take: &mut dyn FnMut(usize)| {
            this.any(&this.cell(a), &this.cell(b), |at| {
                take(at);
                false
            });
        };
        boxes.iter().for_each(|swept| each(self, swept, &mut |at| starts[at] += 1));
        let mut end = 0;
        for count in &mut starts {
            end += *count;
            *count = end;
        }
        self.sorted.clear();
        self.sorted.resize(end as usize, 0);
        let mut sorted = std::mem::take(&mut self.sorted);
        for (n, swept) in boxes.iter().enumerate().rev() {
            each(self, swept, &mut |at| {
                starts[at] -= 1;
                sorted[starts[at] as usize] = n as u32;
            });
        }
        (self.boxes, self.starts, self.sorted) = (boxes, starts, sorted);
    }

    /// True if a stored box overlaps this one.
    pub fn touches(&self, low: &[f64; D], high: &[f64; D]) -> bool {
        let within =
            |d: usize| high[d] >= self.low[d] && low[d] <= self.low[d] + self.edge * self.counts[d] as f64;
        let overlaps = |n: &u32| {
            let (a, b) = &self.boxes[*n as usize];
            (0..D).all(|d| high[d] >= a[d] && low[d] <= b[d])
        };
        !self.boxes.is_empty()
            && (0..D).all(within)
            && self.any(&self.cell(low), &self.cell(high), |at| {
                self.sorted[self.starts[at] as usize..self.starts[at + 1] as usize].iter().any(overlaps)
            })
    }

    /// Cell of a point, or the nearest cell.
    fn cell(&self, x: &[f64; D]) -> [usize; D] {
        std::array::from_fn(|d| {
            (((x[d] - self.low[d]) / self.edge).max(0.0) as usize).min(self.counts[d] - 1)
        })
    }

    /// Call `visit` for every cell from `first` to `last` until it returns true. Returns true if it did.
    fn any(&self, first: &[usize; D], last: &[usize; D], mut visit: impl FnMut(usize) -> bool) -> bool {
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
        self.boxes.capacity() * size_of::<([f64; D], [f64; D])>()
            + (self.starts.capacity() + self.sorted.capacity()) * size_of::<u32>()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn boxes_near_the_facets_are_found_and_others_are_not() {
        let mut cells = SweptBoxes::<2>::default();
        assert!(!{
            cells.fill(std::iter::empty());
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
        cells.fill(sides.into_iter());
        for (low, high, near) in [
            ([0.4, -0.1], [0.5, 0.0], true),
            ([0.95, 0.3], [1.2, 0.35], true),
            ([1.01, 0.3], [1.2, 0.35], false),
            ([-5.0; 2], [5.0; 2], true),
            ([0.3; 2], [0.7; 2], false),
            ([1.3, 0.3], [1.4, 0.4], false),
            ([f64::NAN; 2], [0.4; 2], false),
        ] {
            assert_eq!(cells.touches(&low, &high), near, "{low:?} to {high:?}");
        }
    }
}
