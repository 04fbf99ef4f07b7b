//! Rigid motion and scaling of shapes.

use nalgebra::{Rotation, SVector};

use super::bounds::Bounds;
use super::error::{Check, GeometryError};
use super::shape::Shape;
use super::vector::{add, sub};

/// Volume per radian from area and centroid (Pappus), for a shape on the side r >= 0.
fn pappus<const D: usize>(shape: &impl Shape<D>) -> Option<f64> {
    if D == 2 && shape.bounds().min[0] >= 0.0 { Some(shape.measure()? * shape.centroid()?[0]) } else { None }
}

/// Translated shape. The distance is exact if that of the shape is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Translated<S, const D: usize> {
    shape: S,
    offset: [f64; D],
}

impl<S, const D: usize> Translated<S, D> {
    pub(super) fn new(shape: S, offset: [f64; D]) -> Result<Self, GeometryError> {
        Ok(Self { shape, offset: Check("translated").point("offset", offset)? })
    }
}

impl<S: Shape<D>, const D: usize> Shape<D> for Translated<S, D> {
    fn signed_distance(&self, x: [f64; D]) -> f64 {
        self.shape.signed_distance(sub(x, self.offset))
    }
    fn signed_distance_within(&self, x: [f64; D], limit: f64) -> f64 {
        self.shape.signed_distance_within(sub(x, self.offset), limit)
    }
    fn bounds(&self) -> Bounds<D> {
        let b = self.shape.bounds();
        Bounds { min: add(b.min, self.offset), max: add(b.max, self.offset) }
    }
    fn exact_distance(&self) -> bool {
        self.shape.exact_distance()
    }
    fn measure(&self) -> Option<f64> {
        self.shape.measure()
    }
    fn centroid(&self) -> Option<[f64; D]> {
        Some(add(self.shape.centroid()?, self.offset))
    }
    fn revolved_measure(&self) -> Option<f64> {
        if D == 2 && self.offset[0] == 0.0 { self.shape.revolved_measure() } else { pappus(self) }
    }
    fn convex(&self) -> bool {
        self.shape.convex()
    }
    fn contains(&self, x: [f64; D]) -> bool {
        self.shape.contains(sub(x, self.offset))
    }
    fn contains_row(&self, first: [f64; D], last: &[f64], inside: &mut [bool]) {
        if D == 0 {
            return;
        }
        let moved: Vec<f64> = last.iter().map(|c| c - self.offset[D - 1]).collect();
        self.shape.contains_row(sub(first, self.offset), &moved, inside);
    }
}

/// Shape rotated about a point. The distance is exact if that of the shape is; the bounding box encloses the rotated
/// bounding box, hence is not the tightest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rotated<S, const D: usize> {
    shape: S,
    rotation: Rotation<f64, D>,
    pivot: [f64; D],
}

impl<S, const D: usize> Rotated<S, D> {
    pub(super) fn new(shape: S, rotation: Rotation<f64, D>, pivot: [f64; D]) -> Result<Self, GeometryError> {
        let check = Check("rotated");
        check.point("pivot", pivot)?;
        let m = rotation.matrix();
        for i in 0..D {
            for j in 0..D {
                let mut product = if i == j { -1.0 } else { 0.0 };
                for k in 0..D {
                    product += m[(i, k)] * m[(j, k)];
                }
                check.that(product.abs() < 1e-9, "rotation", m[(i, j)], "an orthogonal, finite matrix")?;
            }
        }
        Ok(Self { shape, rotation, pivot })
    }
    fn to_shape(&self, x: [f64; D]) -> [f64; D] {
        let turned = self.rotation.matrix().tr_mul(&SVector::from(sub(x, self.pivot)));
        add(turned.into(), self.pivot)
    }
    pub(super) fn to_world(&self, x: [f64; D]) -> [f64; D] {
        let turned = self.rotation.matrix() * SVector::from(sub(x, self.pivot));
        add(turned.into(), self.pivot)
    }
}

impl<S: Shape<D>, const D: usize> Shape<D> for Rotated<S, D> {
    fn signed_distance(&self, x: [f64; D]) -> f64 {
        self.shape.signed_distance(self.to_shape(x))
    }
    fn signed_distance_within(&self, x: [f64; D], limit: f64) -> f64 {
        self.shape.signed_distance_within(self.to_shape(x), limit)
    }
    fn bounds(&self) -> Bounds<D> {
        let b = self.shape.bounds();
        if b.is_empty() {
            b
        } else if b.is_finite() {
            Bounds::around(b.corners().map(|x| self.to_world(x)))
        } else {
            Bounds::EVERYTHING
        }
    }
    fn exact_distance(&self) -> bool {
        self.shape.exact_distance()
    }
    fn measure(&self) -> Option<f64> {
        self.shape.measure()
    }
    fn centroid(&self) -> Option<[f64; D]> {
        Some(self.to_world(self.shape.centroid()?))
    }
    fn convex(&self) -> bool {
        self.shape.convex()
    }
    fn contains(&self, x: [f64; D]) -> bool {
        self.shape.contains(self.to_shape(x))
    }
}

/// Shape scaled about a point. The distance is exact if that of the shape is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scaled<S, const D: usize> {
    shape: S,
    factor: f64,
    pivot: [f64; D],
}

impl<S, const D: usize> Scaled<S, D> {
    pub(super) fn new(shape: S, factor: f64, pivot: [f64; D]) -> Result<Self, GeometryError> {
        let check = Check("scaled");
        check.positive("factor", factor)?;
        check.point("pivot", pivot)?;
        Ok(Self { shape, factor, pivot })
    }
    fn to_shape(&self, x: [f64; D]) -> [f64; D] {
        add(sub(x, self.pivot).map(|c| c / self.factor), self.pivot)
    }
    fn to_world(&self, x: [f64; D]) -> [f64; D] {
        add(sub(x, self.pivot).map(|c| c * self.factor), self.pivot)
    }
}

impl<S: Shape<D>, const D: usize> Shape<D> for Scaled<S, D> {
    fn signed_distance(&self, x: [f64; D]) -> f64 {
        self.shape.signed_distance(self.to_shape(x)) * self.factor
    }
    fn signed_distance_within(&self, x: [f64; D], limit: f64) -> f64 {
        self.shape.signed_distance_within(self.to_shape(x), limit / self.factor) * self.factor
    }
    fn bounds(&self) -> Bounds<D> {
        let b = self.shape.bounds();
        Bounds { min: self.to_world(b.min), max: self.to_world(b.max) }
    }
    fn exact_distance(&self) -> bool {
        self.shape.exact_distance()
    }
    fn measure(&self) -> Option<f64> {
        Some(self.shape.measure()? * self.factor.powi(D as i32))
    }
    fn centroid(&self) -> Option<[f64; D]> {
        Some(self.to_world(self.shape.centroid()?))
    }
    fn revolved_measure(&self) -> Option<f64> {
        if D == 2 && self.pivot[0] == 0.0 {
            Some(self.shape.revolved_measure()? * self.factor.powi(3))
        } else {
            pappus(self)
        }
    }
    fn convex(&self) -> bool {
        self.shape.convex()
    }
    fn contains(&self, x: [f64; D]) -> bool {
        self.shape.contains(self.to_shape(x))
    }
    fn contains_row(&self, first: [f64; D], last: &[f64], inside: &mut [bool]) {
        if D == 0 {
            return;
        }
        let pivot = self.pivot[D - 1];
        let moved: Vec<f64> = last.iter().map(|c| (c - pivot) / self.factor + pivot).collect();
        self.shape.contains_row(self.to_shape(first), &moved, inside);
    }
}
