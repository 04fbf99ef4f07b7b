//! Notches: thin cuts that are there from the start.

use super::domain::Domain;
use super::error::{CellsError, parameter};
use super::polytope::measure;
use crate::vector::{along, difference, dot, norm, scaled};

/// Points nearer to a notch than this part of the spacing make place for those of its rows.
const NEAR: f64 = 1.1;

/// A piece of a line in the plane, or of a plane in space, that divides cells.
#[derive(Clone, Debug, PartialEq)]
pub struct Notch<const D: usize> {
    corners: Vec<[f64; D]>,
    /// Normal times area.
    normal: [f64; D],
    /// How wide it is, m.
    gap: f64,
}

impl Notch<2> {
    /// Between two places, m.
    ///
    /// # Errors
    /// Places that are not finite, or one.
    pub fn segment(from: [f64; 2], to: [f64; 2]) -> Result<Self, CellsError> {
        Notch::of(vec![from, to])
    }
}

impl Notch<2> {
    /// Points with two rows along the notch, `spacing` (m) apart from each other and as far along it, in place of those near it: then its faces lie on it
    /// and slide along each other, where those of other points would catch. What is not in the domain is left out.
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
    /// A convex polygon of a plane, m.
    ///
    /// # Errors
    /// Fewer than three corners, or such that are not finite or enclose no area.
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

    /// The same, so wide (m): cells stay as they are, but its sides touch no earlier than when they have come so much closer. Without this they
    /// touch from the start.
    ///
    /// # Errors
    /// Negative or not finite.
    pub fn with_gap(self, gap: f64) -> Result<Self, CellsError> {
        Ok(Notch { gap: parameter(gap >= 0.0, "notch", "gap", gap, "zero or positive, and finite")?, ..self })
    }

    /// How wide it is, m.
    pub(crate) fn gap(&self) -> f64 {
        self.gap
    }

    /// Does the way from `a` to `b` go through it?
    pub(crate) fn crosses(&self, a: &[f64; D], b: &[f64; D]) -> bool {
        let height = |x: &[f64; D]| dot(&self.normal, &difference(x, &self.corners[0]));
        let (at_a, at_b) = (height(a), height(b));
        // What lies on it belongs to one side.
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
