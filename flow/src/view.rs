//! Observer interface of a liquid.

use impactite_scene::{Body, Parts, PointView, Totals};

use crate::particles::Liquid;

/// Pad a vector to three components.
pub(crate) fn wide<const D: usize>(a: &[f64; D]) -> [f64; 3] {
    let mut wide = [0.0; 3];
    wide[..D].copy_from_slice(a);
    wide
}

impl<const D: usize> Body for Liquid<D> {
    fn name(&self) -> &str {
        &self.name
    }
    fn law(&self) -> &'static str {
        "incompressible liquid"
    }
    fn len(&self) -> usize {
        self.particles.len()
    }
    fn state_names(&self) -> Vec<String> {
        Vec::new()
    }
    /// Sums over the particles. Velocities are those of the middle of the last step; the balanced kinetic energy is the sum of
    /// m v- . v- / 2, the power of the body force over the time from there to the positions, since pressures do no work, and the energy of the
    /// acceleration over this time.
    fn totals(&self) -> Totals {
        let mut sum = Totals::default();
        for p in &self.particles {
            sum.add_point(self.density * p.volume, &p.x, &p.v);
        }
        for d in 0..D {
            sum.kinetic += self.lag * self.force[d] * sum.momentum[d];
            sum.staggered.momentum[d] = self.lag * self.momentum_rate[d];
        }
        sum.kinetic += self.lag * self.power + 0.5 * self.lag * self.lag * self.acceleration;
        (sum.internal, sum.viscous_heat) = (self.heat, self.heat);
        sum
    }
    fn for_each(&self, visit: &mut dyn FnMut(&PointView)) {
        self.for_each_with(Parts::ALL, visit);
    }
    fn for_each_with(&self, _: Parts, visit: &mut dyn FnMut(&PointView)) {
        let mut point = PointView { in_range: true, ..PointView::default() };
        for p in &self.particles {
            point.number = p.number as usize;
            point.position = wide(&p.x);
            point.velocity = wide(&p.v);
            point.mass = self.density * p.volume;
            point.volume = p.volume;
            point.stress = [-p.pressure, -p.pressure, -p.pressure, 0.0, 0.0, 0.0];
            visit(&point);
        }
    }
    fn bytes(&self) -> usize {
        Liquid::bytes(self)
    }
}
