//! Axis-aligned bounding boxes.

/// Axis-aligned bounding box, possibly infinite, possibly empty.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds<const D: usize> {
    /// Smallest coordinates (m).
    pub min: [f64; D],
    /// Largest coordinates (m); a box with some `max < min` is empty.
    pub max: [f64; D],
}

impl<const D: usize> Bounds<D> {
    /// Whole space.
    pub const EVERYTHING: Self = Self { min: [f64::NEG_INFINITY; D], max: [f64::INFINITY; D] };
    /// Empty box.
    pub const NOTHING: Self = Self { min: [f64::INFINITY; D], max: [f64::NEG_INFINITY; D] };

    /// True if the box contains no point.
    pub fn is_empty(&self) -> bool {
        (0..D).any(|i| self.min[i] > self.max[i])
    }
    /// True if all coordinates are finite.
    pub fn is_finite(&self) -> bool {
        (0..D).all(|i| self.min[i].is_finite() && self.max[i].is_finite())
    }
    /// True if the box contains `x`, faces included.
    pub fn contains(&self, x: [f64; D]) -> bool {
        (0..D).all(|i| self.min[i] <= x[i] && x[i] <= self.max[i])
    }
    /// Intersection of two boxes.
    pub fn intersection(&self, other: &Self) -> Self {
        let mut b = *self;
        for i in 0..D {
            b.min[i] = b.min[i].max(other.min[i]);
            b.max[i] = b.max[i].min(other.max[i]);
        }
        b
    }
    /// Bounding box of two boxes.
    pub fn union(&self, other: &Self) -> Self {
        let mut b = *self;
        for i in 0..D {
            b.min[i] = b.min[i].min(other.min[i]);
            b.max[i] = b.max[i].max(other.max[i]);
        }
        b
    }
    /// Bounding box of points.
    pub fn around(points: impl IntoIterator<Item = [f64; D]>) -> Self {
        let mut b = Self::NOTHING;
        for x in points {
            for i in 0..D {
                b.min[i] = b.min[i].min(x[i]);
                b.max[i] = b.max[i].max(x[i]);
            }
        }
        b
    }
    /// True if the two boxes have no common volume. (They may touch.)
    pub fn apart(&self, other: &Self) -> bool {
        (0..D).any(|i| self.max[i] <= other.min[i] || other.max[i] <= self.min[i])
    }
    /// The `2^D` corners of the box.
    pub fn corners(&self) -> impl Iterator<Item = [f64; D]> + '_ {
        (0..1usize << D).map(|bits| {
            let mut x = self.min;
            for i in 0..D {
                if bits >> i & 1 == 1 {
                    x[i] = self.max[i];
                }
            }
            x
        })
    }
    /// Distance from `x` to the nearest point of the box (m); zero inside.
    pub fn distance(&self, x: [f64; D]) -> f64 {
        let mut s = 0.0;
        for i in 0..D {
            let gap = (self.min[i] - x[i]).max(x[i] - self.max[i]).max(0.0);
            s += gap * gap;
        }
        s.sqrt()
    }
}
