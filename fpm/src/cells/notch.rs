//! Notches: thin cuts that are present from the start.

use super::domain::Domain;
use super::error::{CellsError, parameter};
use super::polytope::measure;
use crate::vector::{along, difference, dot, norm, scaled};

/// Exclusion distance around a notch over the spacing: nearer points are replaced by rows.
const NEAR: f64 = 1.1;

/// Notch that separates cells: a segment of a line in the plane, a polygon of a plane in space.
#[derive(Clone, Debug, PartialEq)]
pub struct Notch<const D: usize> {
    corners: Vec<[f64; D]>,
    /// Normal times area.
    normal: [f64; D],
    /// Width, m.
    gap: f64,
}

impl Notch<2> {
    /// Create a notch between two places, m.
    ///
    /// # Errors
    /// Places that are not finite, or coincide.
    pub fn segment(from: [f64; 2], to: [f64; 2]) -> Result<Self, CellsError> {
        Notch::of(vec![from, to])
    }
}

impl Notch<2> {
    /// Replace the points near the notch by two rows, `spacing` (m) apart from each other and along the notch. Its faces then lie on it and
    /// slide along each other; faces of other points would interlock. Points outside the domain are left out.
    ///
    /// # Errors
    /// A spacing that is not positive and finite.
    pub fn lined(
        &self,
        points: Vec<[f64; 2]>,
        domain: &Domain<2>,
        spacing: f64,
    ) -> Result<Vec<[f64; 2]>, CellsError> {
        parameter(spacing > 0.0, "rows along a notch", "spacing", spacing, "positive and finite")?;
        let (start, length) = (self.corners[0], norm(&self.normal));
        let way = scaled(&difference(&self.corners[1], &start), 1.0 / length);
        let side = scaled(&self.normal, 1.0 / length);
        let far = |x: &[f64; 2]| {
            let from = difference(x, &start);
            let nearest = along(&start, dot(&from, &way).clamp(0.0, length), &way);
            norm(&difference(x, &nearest)) > NEAR * spacing
        };
        let mut points: Vec<[f64; 2]> = points.into_iter().filter(far).collect();
        let count = (length / spacing).round().max(1.0);
        for k in 0..count as usize {
            let middle = along(&start, (k as f64 + 0.5) * length / count, &way);
            let pair = [-0.5, 0.5].map(|part| along(&middle, part * spacing, &side));
            points.extend(pair.into_iter().filter(|x| domain.contains(*x)));
        }
        Ok(points)
    }
}

impl Notch<3> {
    /// Create a notch from a convex plane polygon, m.
    ///
    /// # Errors
    /// Fewer than three corners; corners that are not finite or enclose no area.
    pub fn polygon(corners: Vec<[f64; 3]>) -> Result<Self, CellsError> {
        Notch::of(corners)
    }
}

impl<const D: usize> Notch<D> {
    fn of(corners: Vec<[f64; D]>) -> Result<Self, CellsError> {
        let count = corners.len();
        parameter(count >= D, "notch", "corners", count as f64, "two in the plane, three or more in space")?;
        for &x in corners.iter().flatten() {
            parameter(true, "notch", "corner", x, "finite")?;
        }
        let (normal, _) = measure(&corners);
        parameter(norm(&normal) > 0.0, "notch", "length or area", norm(&normal), "positive")?;
        Ok(Notch { corners, normal, gap: 0.0 })
    }

    /// Set the width, m: cells are unchanged, but the sides are in contact only after an approach by this width. By default they are in
    /// contact from the start.
    ///
    /// # Errors
    /// A negative or non-finite width.
    pub fn with_gap(self, gap: f64) -> Result<Self, CellsError> {
        Ok(Notch { gap: parameter(gap >= 0.0, "notch", "gap", gap, "zero or positive, and finite")?, ..self })
    }

    /// Width, m.
    pub(crate) fn gap(&self) -> f64 {
        self.gap
    }

    /// True if the segment from `a` to `b` crosses the notch.
    pub(crate) fn crosses(&self, a: &[f64; D], b: &[f64; D]) -> bool {
        let height = |x: &[f64; D]| dot(&self.normal, &difference(x, &self.corners[0]));
        let (at_a, at_b) = (height(a), height(b));
        // A point on the notch belongs to one side.
        if (at_a < 0.0) == (at_b < 0.0) {
            return false;
        }
        let part = at_a / (at_a - at_b);
        let mut x = *a;
        (0..D).for_each(|d| x[d] += part * (b[d] - a[d]));
        if D == 2 {
            let way = difference(&self.corners[1], &self.corners[0]);
            let share = dot(&difference(&x, &self.corners[0]), &way) / dot(&way, &way);
            return (0.0..=1.0).contains(&share);
        }
        let count = self.corners.len();
        (0..count).all(|i| {
            let (c, next) = (&self.corners[i], &self.corners[(i + 1) % count]);
            let (twice, _) = measure(&[*c, *next, x]);
            dot(&twice, &self.normal) >= 0.0
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_goes_through_a_notch_is_told() {
        let notch = Notch::segment([0.0, 1.0], [2.0, 1.0]).expect("a notch");
        assert!(notch.crosses(&[1.0, 0.5], &[1.2, 1.5]) && notch.crosses(&[1.2, 1.5], &[1.0, 0.5]));
        assert!(!notch.crosses(&[2.1, 0.5], &[2.2, 1.5]) && !notch.crosses(&[1.0, 0.1], &[1.2, 0.9]));
        let corners = vec![[0.0, 0.0, 1.0], [1.0, 0.0, 1.0], [1.0, 1.0, 1.0], [0.0, 1.0, 1.0]];
        let notch = Notch::polygon(corners).expect("a notch");
        assert!(notch.crosses(&[0.5, 0.5, 0.0], &[0.6, 0.6, 2.0]));
        assert!(!notch.crosses(&[1.5, 0.5, 0.0], &[1.6, 0.6, 2.0]));
        assert!(Notch::segment([1.0; 2], [1.0; 2]).is_err());
    }
}
