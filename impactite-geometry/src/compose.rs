//! Boolean operations and transformations of shapes.

use nalgebra::Rotation;

use super::combine::{Difference, Intersection, Union};
use super::error::GeometryError;
use super::shape::Shape;
use super::transform::{Rotated, Scaled, Translated};

/// Constructive solid geometry by method chaining; implemented for every [`Shape`].
pub trait Compose<const D: usize>: Shape<D> + Sized {
    /// Union with `other`.
    fn or<B: Shape<D>>(self, other: B) -> Union<Self, B> {
        Union::new(self, other)
    }
    /// Intersection with `other`.
    fn and<B: Shape<D>>(self, other: B) -> Intersection<Self, B> {
        Intersection::new(self, other)
    }
    /// Difference: this shape without `other`.
    fn minus<B: Shape<D>>(self, other: B) -> Difference<Self, B> {
        Difference::new(self, other)
    }
    /// Translate the shape by `offset` (m).
    ///
    /// # Errors
    /// [`GeometryError::Parameter`] unless the offset is finite.
    fn translated(self, offset: [f64; D]) -> Result<Translated<Self, D>, GeometryError> {
        Translated::new(self, offset)
    }
    /// Rotate the shape about the point `pivot` (m).
    ///
    /// # Errors
    /// [`GeometryError::Parameter`] unless the rotation is orthogonal and finite and the pivot finite.
    fn rotated(self, rotation: Rotation<f64, D>, pivot: [f64; D]) -> Result<Rotated<Self, D>, GeometryError> {
        Rotated::new(self, rotation, pivot)
    }
    /// Scale the shape by `factor` about the fixed point `pivot` (m).
    ///
    /// # Errors
    /// [`GeometryError::Parameter`] unless the factor is positive and both are finite.
    fn scaled(self, factor: f64, pivot: [f64; D]) -> Result<Scaled<Self, D>, GeometryError> {
        Scaled::new(self, factor, pivot)
    }
}

impl<S: Shape<D>, const D: usize> Compose<D> for S {}
