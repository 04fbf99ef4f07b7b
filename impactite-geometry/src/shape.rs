//! Shape trait and metric.

use std::sync::Arc;

use super::bounds::Bounds;

/// Solid in D dimensions, defined by its signed distance. Coordinates in metres.
///
/// Implement [`Shape::signed_distance`] and [`Shape::bounds`] for a new shape; the other methods improve accuracy or
/// speed. In axisymmetric use D is 2, the first coordinate is the radius r and the second the axial z.
pub trait Shape<const D: usize>: Send + Sync {
    /// Signed distance to the surface (m): negative inside, positive outside.
    ///
    /// Its magnitude never exceeds the true distance to the surface: a ball of that radius about `x` is
    /// wholly inside or wholly outside. It is the true distance if [`Shape::exact_distance`] is true.
    fn signed_distance(&self, x: [f64; D]) -> f64;

    /// Signed distance with a cutoff: exact value where the magnitude is below `limit` (m, positive); elsewhere any value of the
    /// correct sign and a magnitude from `limit` up to that of the signed distance. For shapes for which a bound
    /// is cheaper than the distance.
    fn signed_distance_within(&self, x: [f64; D], limit: f64) -> f64 {
        let _ = limit;
        self.signed_distance(x)
    }

    /// Bounding box of the shape.
    fn bounds(&self) -> Bounds<D>;

    /// True if the signed distance is the true distance everywhere (rather than a lower bound).
    fn exact_distance(&self) -> bool {
        false
    }

    /// Exact volume (3D, m3), area (2D, m2) or length (1D, m), where known.
    fn measure(&self) -> Option<f64> {
        None
    }

    /// Centroid (m), where known exactly.
    fn centroid(&self) -> Option<[f64; D]> {
        None
    }

    /// Volume per radian (m3) of the body of revolution of the part with r > 0 about the axis r = 0:
    /// the integral of r over that part, where known exactly. By default from area and centroid (Pappus) if
    /// the shape is on the side r >= 0.
    fn revolved_measure(&self) -> Option<f64> {
        if D == 2 && self.bounds().min[0] >= 0.0 { Some(self.measure()? * self.centroid()?[0]) } else { None }
    }

    /// True if the shape is known to be convex.
    fn convex(&self) -> bool {
        false
    }

    /// True if `x` is inside. (Surface points are not.)
    fn contains(&self, x: [f64; D]) -> bool {
        self.signed_distance(x) < 0.0
    }

    /// Test a row of points for inside: point `i` is `first` with its last coordinate replaced by
    /// `last[i]`. `last` increases; `inside` has its length. By default, points within the signed distance are skipped.
    fn contains_row(&self, first: [f64; D], last: &[f64], inside: &mut [bool]) {
        let mut x = first;
        let mut i = 0;
        let limit = match last {
            [a, b, ..] => 16.0 * (b - a),
            _ => f64::INFINITY,
        };
        while i < last.len() {
            if D > 0 {
                x[D - 1] = last[i];
            }
            let distance = self.signed_distance_within(x, limit);
            let within = distance < 0.0;
            // The margin excludes points on the surface to within rounding from the skip.
            let safe = last[i] + (distance.abs() * (1.0 - 1e-9) - 1e-12 * last[i].abs());
            inside[i] = within;
            i += 1;
            while i < last.len() && last[i] < safe {
                inside[i] = within;
                i += 1;
            }
        }
    }
}

macro_rules! forward {
    ($pointer:ty) => {
        impl<S: Shape<D> + ?Sized, const D: usize> Shape<D> for $pointer {
            fn signed_distance(&self, x: [f64; D]) -> f64 {
                (**self).signed_distance(x)
            }
            fn signed_distance_within(&self, x: [f64; D], limit: f64) -> f64 {
                (**self).signed_distance_within(x, limit)
            }
            fn bounds(&self) -> Bounds<D> {
                (**self).bounds()
            }
            fn exact_distance(&self) -> bool {
                (**self).exact_distance()
            }
            fn measure(&self) -> Option<f64> {
                (**self).measure()
            }
            fn centroid(&self) -> Option<[f64; D]> {
                (**self).centroid()
            }
            fn revolved_measure(&self) -> Option<f64> {
                (**self).revolved_measure()
            }
            fn convex(&self) -> bool {
                (**self).convex()
            }
            fn contains(&self, x: [f64; D]) -> bool {
                (**self).contains(x)
            }
            fn contains_row(&self, first: [f64; D], last: &[f64], inside: &mut [bool]) {
                (**self).contains_row(first, last, inside);
            }
        }
    };
}
forward!(&S);
forward!(Box<S>);
forward!(Arc<S>);

/// Metric of volumes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Metric {
    /// Volume in 3D (m3), area in 2D (m2: volume per metre of depth), length in 1D (m).
    #[default]
    Cartesian,
    /// Coordinates (r, z); volume per radian (m3), the integral of r over the area with r > 0.
    Axisymmetric,
}

impl Metric {
    /// Exact measure of a shape in this metric, where known.
    pub fn measure<const D: usize>(self, shape: &(impl Shape<D> + ?Sized)) -> Option<f64> {
        match self {
            Metric::Cartesian => shape.measure(),
            Metric::Axisymmetric => shape.revolved_measure(),
        }
    }
}
