//! Plane polygons.

use super::bounds::Bounds;
use super::error::{Check, GeometryError};
use super::primitives::segment_distance;
use super::shape::Shape;
use super::vector::{sub, sum};

/// Simple polygon, defined by its corners in order (either orientation). Its edges must not cross, which is not
/// checked. In axisymmetric use: the profile (r, z) of any body of revolution. Exact distance.
#[derive(Clone, Debug, PartialEq)]
pub struct Polygon {
    corners: Vec<[f64; 2]>,
    area: f64,
    centroid: [f64; 2],
}

impl Polygon {
    /// Build the polygon with these corners (m); the last is joined to the first.
    ///
    /// # Errors
    /// [`GeometryError::Parameter`] unless there are at least three corners, all finite, that enclose an area,
    /// and area and centroid are finite.
    pub fn new(corners: Vec<[f64; 2]>) -> Result<Self, GeometryError> {
        let check = Check("Polygon");
        check.that(corners.len() >= 3, "corners", corners.len() as f64, "three or more")?;
        for x in &corners {
            check.point("corners", *x)?;
        }
        // Relative to a corner, against cancellation in a polygon far from the origin.
        let base = corners[0];
        let local: Vec<[f64; 2]> = corners.iter().map(|x| sub(*x, base)).collect();
        let doubled = |[a, b]: [[f64; 2]; 2]| a[0] * b[1] - a[1] * b[0];
        let edges = || local.iter().zip(local.iter().cycle().skip(1)).map(|(a, b)| [*a, *b]);
        let signed = 0.5 * sum(edges().map(doubled));
        check.that(signed != 0.0, "area", signed, "not zero")?;
        let mut centroid = base;
        for i in 0..2 {
            centroid[i] += sum(edges().map(|e| (e[0][i] + e[1][i]) * doubled(e))) / (6.0 * signed);
        }
        check.point("centroid", centroid)?;
        Ok(Self { corners, area: signed.abs(), centroid })
    }
    /// Corners in order (m).
    pub fn corners(&self) -> &[[f64; 2]] {
        &self.corners
    }
    fn edges(&self) -> impl Iterator<Item = ([f64; 2], [f64; 2])> + '_ {
        self.corners.iter().copied().zip(self.corners.iter().copied().cycle().skip(1))
    }
}

impl Shape<2> for Polygon {
    fn signed_distance(&self, x: [f64; 2]) -> f64 {
        let mut distance = f64::INFINITY;
        for (a, b) in self.edges() {
            distance = distance.min(segment_distance(x, a, b));
        }
        if self.contains(x) { -distance } else { distance }
    }
    fn bounds(&self) -> Bounds<2> {
        Bounds::around(self.corners.iter().copied())
    }
    fn exact_distance(&self) -> bool {
        true
    }
    fn measure(&self) -> Option<f64> {
        Some(self.area)
    }
    fn centroid(&self) -> Option<[f64; 2]> {
        Some(self.centroid)
    }
    fn contains(&self, x: [f64; 2]) -> bool {
        let mut inside = false;
        for (a, b) in self.edges() {
            if (a[1] > x[1]) != (b[1] > x[1]) {
                // Orient each edge upwards, so that the test does not depend on its direction.
                let (low, high) = if a[1] < b[1] { (a, b) } else { (b, a) };
                let crossing = low[0] + (x[1] - low[1]) / (high[1] - low[1]) * (high[0] - low[0]);
                inside ^= x[0] < crossing;
            }
        }
        inside
    }
}
