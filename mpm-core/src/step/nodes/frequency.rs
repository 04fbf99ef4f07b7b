//! Gershgorin bound of the highest frequency, for the time step limit.

use super::constraints::free_directions;
use super::stages::mass_cutoff;
use crate::step::between_steps::rest::{AtNodes, Frequency};
use crate::step::mpm::Mpm;
use impactite_simd::Float;

/// Contributions of a node to the bound.
#[derive(Clone, Copy, Debug, Default)]
struct Row {
    mass: f64,
    sum: f64,
}

impl<const D: usize, T: Float> Mpm<D, T> {
    /// Return a bound of the highest frequency by Gershgorin circles,
    ///
    /// ```text
    /// omega_i^2 <= (1/m_i) sum_p m_p c_p^2 |G_ip| sum_j |G_jp|
    /// ```
    ///
    /// with the largest wave speed c; m_p c_p^2 is the volume times the P-wave modulus. Nodes that boundaries constrain in
    /// every direction are excluded. Unlike h / c, the bound includes the positions of particles in their cells. Computed
    /// particle by particle: about ten times the cost of a step.
    pub fn frequency_bound(&self) -> Frequency {
        self.work.frequency_bound(self)
    }

    pub(in crate::step) fn frequency_bound_here(&self) -> Frequency {
        let mut rows = AtNodes::<D, Row>::default();
        let (mut speed, mut lightest) = (0.0f64, f64::MAX);
        self.for_each_footprint(&mut |p| {
            speed = larger(speed, p.velocity.iter().map(|v| v * v).sum::<f64>().sqrt());
            lightest = lightest.min(p.mass);
            let around: f64 = p.nodes.iter().map(|w| w.steepness()).sum();
            for w in p.nodes {
                let row = rows.at(w.node);
                row.mass += p.mass * w.value;
                row.sum += p.mass * p.wave_speed * p.wave_speed * w.steepness() * around;
            }
        });
        let (lattice, lattices) = (*self.grid.lattice(), self.grid.fields.lattices());
        let cutoff = lightest * mass_cutoff::<T>().to_double();
        let mut square = 0.0f64;
        for (node, row) in rows.iter() {
            let x = lattices.position(node);
            let free = free_directions(&self.scene.conditions, &x, self.clock.time, lattice.spacing(), 0.0);
            if row.mass > cutoff && free[..D].contains(&true) {
                square = larger(square, row.sum / row.mass);
            }
        }
        Frequency { bound: square.sqrt(), speed }
    }

    /// Return the inverse of the time step limit of [`Frequency`], 1/s: sqrt(2) / omega with USL, 2 / omega with MUSL and
    /// USF; in the updated frame particles move half a cell at most.
    pub(in crate::step) fn gershgorin_rate(&self) -> f64 {
        let Frequency { bound, speed } = self.frequency_bound();
        let rate = bound / if self.facts().symplectic() { 2.0 } else { 2.0f64.sqrt() };
        let crossing = if self.facts().total { 0.0 } else { 2.0 * speed / self.smallest_cell() };
        larger(rate, crossing)
    }
}

/// Return the larger value; NaN is kept.
fn larger(a: f64, b: f64) -> f64 {
    if b.is_nan() || b > a { b } else { a }
}
