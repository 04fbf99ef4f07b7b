//! How shapes combine.

use nalgebra::Rotation;

use super::combine::{Difference, Intersection, Union};
use super::error::GeometryError;
use super::shape::Shape;
use super::transform::{Rotated, Scaled, Translated};

/// Shapes of shapes, by method chaining; every [`Shape`] has it.
pub trait Compose<const D: usize>: Shape<D> + Sized {
    /// What is in this shape or in `other`.
    fn or<B: Shape<D>>(self, other: B) -> Union<Self, B> {
        Union::new(self, other)
    }
    /// What is in this shape and in `other`.
    fn and<B: Shape<D>>(self, other: B) -> Intersection<Self, B> {
        Intersection::new(self, other)
    }
    /// What is in this shape but not in `other`.
    fn minus<B: Shape<D>>(self, other: B) -> Difference<Self, B> {
        Difference::new(self, other)
    }
    /// The shape moved by `offset` (m).
    ///
    /// # Errors
    /// [`GeometryError::Parameter`] unless the offset is finite.
    fn translated(self, offset: [f64; D]) -> Result<Translated<Self, D>, GeometryError> {
        Translated::new(self, offset)
    }
    /// The shape rotated about the point `pivot` (m).
    ///
    /// # Errors
    /// [`GeometryError::Parameter`] unless the rotation is one (orthogonal, finite) and the pivot finite.
    fn rotated(self, rotation: Rotation<f64, D>, pivot: [f64; D]) -> Result<Rotated<Self, D>, GeometryError> {
        Rotated::new(self, rotation, pivot)
    }
    /// The shape made `factor` times as large, the point `pivot` (m) staying where it is.
    ///
    /// # Errors
    /// [`GeometryError::Parameter`] unless the factor is positive and all is finite.
    fn scaled(self, factor: f64, pivot: [f64; D]) -> Result<Scaled<Self, D>, GeometryError> {
        Scaled::new(self, factor, pivot)
    }
}

impl<S: Shape<D>, const D: usize> Compose<D> for S {}
