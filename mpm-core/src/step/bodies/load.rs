//! Loads of a body besides its stress: tractions on surface particles, forces on all particles.

use std::sync::Arc;

use impactite_geometry::Shape;

/// Dead load: particles that start inside a region carry the force of a traction history on their initial face normal
/// to an axis. Choose a region that contains one layer of particles.
#[derive(Clone)]
pub struct Traction<const D: usize> {
    /// Initial region of the loaded particles.
    pub region: Arc<dyn Shape<D>>,
    /// Axis normal to the loaded faces.
    pub axis: usize,
    /// Traction history: Pa as a function of time, s.
    pub history: Arc<dyn Fn(f64) -> [f64; D] + Send + Sync>,
    /// True for areas per radian about x = 0 (axisymmetric), false for full areas or areas per metre of depth.
    pub revolved: bool,
}

impl<const D: usize> Traction<D> {
    /// Return the loaded area, m^2, of a particle with half sizes `half` (m) around `x` (m).
    #[must_use]
    pub fn area(&self, x: &[f64; D], half: &[f64; D]) -> f64 {
        if !self.region.contains(*x) {
            return 0.0;
        }
        let face: f64 = (0..D).filter(|&d| d != self.axis).map(|d| 2.0 * half[d]).product();
        if self.revolved { face * self.radius(x, half) } else { face }
    }

    /// Return the radius of the loaded face of a particle, m: for a face across r the side of the particle that the region contains.
    fn radius(&self, x: &[f64; D], half: &[f64; D]) -> f64 {
        if self.axis != 0 {
            return x[0];
        }
        for part in [0.999, 1.001] {
            let contains = |side: f64| {
                let mut at = *x;
                at[0] += side * part * half[0];
                self.region.contains(at)
            };
            match (contains(-1.0), contains(1.0)) {
                (true, false) => return x[0] - half[0],
                (false, true) => return x[0] + half[0],
                _ => {}
            }
        }
        x[0]
    }
}

/// Acceleration as a function of the initial position of a particle (m) and time (s), m/s^2.
pub type Field<const D: usize> = Arc<dyn Fn(&[f64; D], f64) -> [f64; D] + Send + Sync>;

/// Body force that varies in space and time, evaluated at the **initial** positions of the particles: for
/// manufactured solutions, or a force field that is frozen into the material. A particle stores D values for it.
#[derive(Clone)]
pub struct FieldForce<const D: usize> {
    /// Acceleration, m/s^2.
    pub acceleration: Field<D>,
}

/// Loads on the particles of a body besides their stress. A body without a load stores and computes nothing for it.
#[derive(Clone, Default)]
pub(in crate::step) struct Loads<const D: usize> {
    pub(in crate::step) tractions: Vec<Traction<D>>,
    /// Tractions that act in a pass, Pa.
    pub(in crate::step) acting: Vec<[f64; 3]>,
    pub(in crate::step) field: Option<FieldForce<D>>,
    /// Values of particles that are set in every step.
    pub(in crate::step) given: Given,
}

/// Values of particles that are set in every step.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(in crate::step) enum Given {
    /// No values.
    #[default]
    Nothing,
    /// Acceleration.
    Acceleration,
    /// Acceleration, and velocity gradient around the particle, per cell.
    Affine,
}

impl<const D: usize> Loads<D> {
    /// True if there are any loads.
    pub(in crate::step) fn act(&self) -> bool {
        !self.tractions.is_empty() || self.field.is_some()
    }
    /// Number of values per particle.
    pub(in crate::step) fn numbers(&self) -> usize {
        self.tractions.len()
            + match self.given {
                Given::Nothing if self.field.is_none() => 0,
                Given::Nothing | Given::Acceleration => D,
                Given::Affine => D + D * D,
            }
    }
    /// Rows of the loads of a particle, from the row `first` on.
    pub(in crate::step) fn rows(&self, first: usize) -> LoadRows {
        let areas = [first, first + self.tractions.len()];
        let carried = self.field.is_some() || self.given != Given::Nothing;
        let acceleration = carried.then_some(areas[1]);
        let affine = acceleration.filter(|_| self.given == Given::Affine).map(|row| row + D);
        LoadRows { areas, acceleration, affine }
    }
    /// Iterate over the tractions at a time (s), Pa, in order.
    pub(in crate::step) fn tractions(&self, time: f64) -> impl Iterator<Item = [f64; 3]> {
        self.tractions.iter().map(move |load| {
            let mut traction = [0.0; 3];
            traction[..D].copy_from_slice(&(load.history)(time));
            traction
        })
    }
}

/// Rows of the loads of a particle.
#[derive(Clone, Copy, Debug, Default)]
pub struct LoadRows {
    /// First and end row of the loaded areas, one per traction, m^2.
    pub(in crate::step) areas: [usize; 2],
    /// First of D rows of the acceleration by a field, m/s^2.
    pub(in crate::step) acceleration: Option<usize>,
    /// First of D x D rows of the velocity gradient with which a particle maps its momentum, m/s a cell.
    pub(in crate::step) affine: Option<usize>,
}

/// Total load on a body.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Loading {
    /// Force that was mapped last, N.
    pub force: [f64; 3],
    /// Power of the load that acted in the step, with mid-step velocities, W.
    pub power: f64,
}
