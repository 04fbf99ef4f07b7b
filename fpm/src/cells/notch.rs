//! Notches: thin cuts that are there from the start.

use super::error::{CellsError, parameter};
use super::polytope::measure;
use crate::vector::{difference, dot, norm};

/// A piece of a line in the plane, or of a plane in space, that divides cells.
#[derive(Clone, Debug, PartialEq)]
pub struct Notch<const D: usize> {
    corners: Vec<[f64; D]>,
    /// Normal times area.
    normal: [f64; D],
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
        Ok(Notch { corners, normal })
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
            let (along, from) =
                (difference(&self.corners[1], &self.corners[0]), difference(&x, &self.corners[0]));
            let share = dot(&from, &along) / dot(&along, &along);
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
