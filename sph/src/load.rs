//! Surface tractions.

use std::sync::Arc;

/// Traction history: Pa at a time in s.
pub type TractionHistory<const D: usize> = Arc<dyn Fn(f64) -> [f64; D] + Send + Sync>;

/// Dead load: a traction history on the initial areas.
#[derive(Clone)]
pub(crate) struct SurfaceLoad<const D: usize> {
    /// Loaded area of each particle by layout number, m^2 (per metre of depth or per radian).
    pub areas: Vec<f64>,
    pub history: TractionHistory<D>,
}

impl<const D: usize> SurfaceLoad<D> {
    /// Return the total loaded area, m^2.
    pub fn area(&self) -> f64 {
        self.areas.iter().sum()
    }
}

/// External accelerations at a time: body force and surface loads.
pub(crate) struct Outer<'a, const D: usize> {
    /// Acceleration of the body force, m/s^2.
    pub force: [f64; D],
    loads: &'a [SurfaceLoad<D>],
    /// Tractions of the loads, Pa.
    tractions: Vec<[f64; D]>,
    numbers: &'a [u32],
}

impl<'a, const D: usize> Outer<'a, D> {
    pub fn new(force: [f64; D], loads: &'a [SurfaceLoad<D>], numbers: &'a [u32], time: f64) -> Self {
        Outer { force, loads, tractions: loads.iter().map(|load| (load.history)(time)).collect(), numbers }
    }

    /// Return the external acceleration of a particle of this mass, kg, in m/s^2.
    #[inline(always)]
    pub fn at(&self, particle: usize, mass: f64) -> [f64; D] {
        let mut acceleration = self.force;
        for (load, traction) in self.loads.iter().zip(&self.tractions) {
            let per = load.areas[self.numbers[particle] as usize] / mass;
            (0..D).for_each(|d| acceleration[d] += per * traction[d]);
        }
        acceleration
    }
}
