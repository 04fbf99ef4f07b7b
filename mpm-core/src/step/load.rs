//! What a body's passes do beside its law's work: tractions on surface particles, forces on all particles, splitting.

use std::sync::Arc;

use super::splitting::Splitting;
use crate::geometry::Shape;
use crate::scheme::{Driven, Loaded, PassKind};

/// A load as a type, so that a body without one carries nothing for it.
pub trait Load<const D: usize>: Send + Sync + 'static {
    /// Is there one on surfaces?
    const ACTS: bool;
    /// Is there one on all particles?
    const FIELD: bool = false;
    /// The pass `K` of a body with this load.
    type Pass<K: PassKind>: PassKind;
    /// Traction at a time (s), Pa.
    fn traction(&self, time: f64) -> [f64; D];
    /// Loaded area of a particle that takes the half sizes `half` (m) around `x` (m), m^2.
    fn area(&self, x: &[f64; D], half: &[f64; D]) -> f64;
    /// Acceleration, m/s^2, at a time (s) of the particle that started at `start`, m.
    fn acceleration(&self, _start: &[f64; D], _time: f64) -> [f64; D] {
        [0.0; D]
    }
    /// When particles are split, if they are.
    fn splitting(&self) -> Option<Splitting> {
        None
    }
}

/// No surface load.
#[derive(Clone, Copy, Debug, Default)]
pub struct Unloaded;
impl<const D: usize> Load<D> for Unloaded {
    const ACTS: bool = false;
    type Pass<K: PassKind> = K;
    fn traction(&self, _time: f64) -> [f64; D] {
        [0.0; D]
    }
    fn area(&self, _x: &[f64; D], _half: &[f64; D]) -> f64 {
        0.0
    }
}

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
impl<const D: usize> Load<D> for Traction<D> {
    const ACTS: bool = true;
    type Pass<K: PassKind> = Loaded<K>;
    fn traction(&self, time: f64) -> [f64; D] {
        (self.history)(time)
    }
    fn area(&self, x: &[f64; D], half: &[f64; D]) -> f64 {
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
impl<const D: usize> Load<D> for FieldForce<D> {
    const ACTS: bool = false;
    const FIELD: bool = true;
    type Pass<K: PassKind> = Driven<K>;
    fn traction(&self, _time: f64) -> [f64; D] {
        [0.0; D]
    }
    fn area(&self, _x: &[f64; D], _half: &[f64; D]) -> f64 {
        0.0
    }
    fn acceleration(&self, start: &[f64; D], time: f64) -> [f64; D] {
        (self.acceleration)(start, time)
    }
}

/// What a load gives to a body.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Loading {
    /// Force that was mapped last, N.
    pub force: [f64; 3],
    /// Power of the one that acted in the step, with the velocities in its middle, W.
    pub power: f64,
}
