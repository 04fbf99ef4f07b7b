//! Loads of a body beside the work of its law: tractions on surface particles, forces on all particles.

use std::sync::Arc;

use impactite_geometry::Shape;

/// A dead load: the particles that start inside a region carry the force of a traction over time on their
/// face normal to an axis, sized as at the start. Choose the region to hold one layer of particles.
#[derive(Clone)]
pub struct Traction<const D: usize> {
    /// Where the loaded particles start.
    pub region: Arc<dyn Shape<D>>,
    /// The axis that the loaded faces are normal to.
    pub axis: usize,
    /// Traction over time: Pa at a time in s.
    pub history: Arc<dyn Fn(f64) -> [f64; D] + Send + Sync>,
    /// Are areas per radian about x = 0 (axisymmetric) instead of in full or per metre of depth?
    pub revolved: bool,
}

impl<const D: usize> Traction<D> {
    /// Loaded area of a particle that takes the half sizes `half` (m) around `x` (m), m^2.
    #[must_use]
    pub fn area(&self, x: &[f64; D], half: &[f64; D]) -> f64 {
        if !self.region.contains(*x) {
            return 0.0;
        }
        let face: f64 = (0..D).filter(|&d| d != self.axis).map(|d| 2.0 * half[d]).product();
        if self.revolved { face * x[0] } else { face }
    }
}

/// An acceleration by the place where a particle started (m) and time (s), m/s^2.
pub type Field<const D: usize> = Arc<dyn Fn(&[f64; D], f64) -> [f64; D] + Send + Sync>;

/// A body force that varies in space and time, given at the particles by where they **started**: what a manufactured
/// solution asks for, or a force field that is frozen into the material. A particle carries D numbers for it.
#[derive(Clone)]
pub struct FieldForce<const D: usize> {
    /// The acceleration.
    pub acceleration: Field<D>,
}

/// What acts on the particles of a body beside their stress. A body without a load carries and does nothing for it.
#[derive(Clone, Default)]
pub(in crate::step) struct Loads<const D: usize> {
    pub(in crate::step) tractions: Vec<Traction<D>>,
    /// As they act in a pass, Pa.
    pub(in crate::step) acting: Vec<[f64; 3]>,
    pub(in crate::step) field: Option<FieldForce<D>>,
    /// What particles carry that they are given, step by step.
    pub(in crate::step) given: Given,
}

/// What particles are given, step by step.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(in crate::step) enum Given {
    /// Nothing.
    #[default]
    Nothing,
    /// An acceleration.
    Acceleration,
    /// And the gradient of the velocity around them, in cells.
    Affine,
}

impl<const D: usize> Loads<D> {
    /// Is there any?
    pub(in crate::step) fn act(&self) -> bool {
        !self.tractions.is_empty() || self.field.is_some()
    }
    /// Numbers a particle carries for them.
    pub(in crate::step) fn numbers(&self) -> usize {
        self.tractions.len()
            + match self.given {
                Given::Nothing if self.field.is_none() => 0,
                Given::Nothing | Given::Acceleration => D,
                Given::Affine => D + D * D,
            }
    }
    /// Where it carries them, from the row `first` on.
    pub(in crate::step) fn rows(&self, first: usize) -> LoadRows {
        let areas = [first, first + self.tractions.len()];
        let carried = self.field.is_some() || self.given != Given::Nothing;
        let acceleration = carried.then_some(areas[1]);
        let affine = acceleration.filter(|_| self.given == Given::Affine).map(|row| row + D);
        LoadRows { areas, acceleration, affine }
    }
    /// Tractions at a time (s), Pa, in their order.
    pub(in crate::step) fn tractions(&self, time: f64) -> impl Iterator<Item = [f64; 3]> {
        self.tractions.iter().map(move |load| {
            let mut traction = [0.0; 3];
            traction[..D].copy_from_slice(&(load.history)(time));
            traction
        })
    }
}

/// Rows of a particle's loads.
#[derive(Clone, Copy, Debug, Default)]
pub struct LoadRows {
    /// First and end of the areas that each traction loads, m^2.
    pub(in crate::step) areas: [usize; 2],
    /// First of D of the acceleration by a field, m/s^2.
    pub(in crate::step) acceleration: Option<usize>,
    /// First of D x D of the velocity gradient that a particle maps its momentum with, m/s a cell.
    pub(in crate::step) affine: Option<usize>,
}

/// What a load gives to a body.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Loading {
    /// Force that was mapped last, N.
    pub force: [f64; 3],
    /// Power of the one that acted in the step, with the velocities in its middle, W.
    pub power: f64,
}
