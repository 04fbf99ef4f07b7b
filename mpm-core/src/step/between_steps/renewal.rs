//! Density renewal of liquids: volume ratios that follow the space which particles occupy.
//!
//! A weakly compressible liquid integrates its volume ratio J from rates. Two errors grow: differences between the particles of
//! a cell, which nodes do not resolve, and the difference between the sum of the volumes and the space that the particles
//! occupy, since positions and volumes follow the velocity field by different means. Every [`EVERY`] steps
//!
//! - J is moved halfway to a linear fit over its surroundings, J~(x) = sum_i N_i(x) (a_i + b_i . (x - x_i)), with a_i and b_i
//!   the least squares fit of the particles on node i, weighted by mass and N_i: linear fields (hydrostatic pressure) are
//!   unchanged, also at walls and at the surface; differences within a cell and from cell to cell decay;
//! - J is reduced by e times the rate below, where the liquid occupies more than its space, and increased where less. At a
//!   node e = phi_i - 1, phi_i = sum_p V_p N_i(x_p) / integral of N_i over the open space, of all bodies in the scene; planes
//!   bound the open space, and nodes behind a plane are added to their mirror images: a row of particles beside a wall, which is
//!   no integral, has no deviation. Near the free surface, where phi falls without an error, deviations of [`SURFACE`] are allowed and
//!   lower occupancy is no error. The deviation is smoothed over neighbouring nodes: pressure cannot remove one that
//!   alternates from node to node.
//!
//! The occupancy changes pressures through the equation of state, so that momentum is conserved. The change of the elastic
//! energy is booked as numerical viscosity. Sums are in the order of blocks: equal bits for any number of threads.
use crate::dim::{BLOCK, block_nodes, neighbours};
use crate::step::mpm::Mpm;
use crate::step::nodes::occupancy::{NODES, NodeBlocks, OPEN, Open, Tile, deviation, fit, moments, unfold};
use impactite_scene::error::SceneError;
use impactite_simd::Float;

/// Steps from one renewal to the next.
const EVERY: u64 = 10;
/// Times h / c in which a deviation of the occupancy decays: so slowly that pressures of the correction are small,
/// rho e (h / time)^2, and faster than flow causes it.
const TIME: f64 = 20.0;
/// Largest fraction of a deviation that is corrected in a renewal.
const MOST: f64 = 0.5;

impl<const D: usize, T: Float> Mpm<D, T> {
    /// Renew the densities of liquids, if due.
    pub(in crate::step) fn renew_densities(&mut self, dt: T) {
        if !self.clock.steps.is_multiple_of(EVERY) || !self.scene.bodies.iter().any(|b| b.renewed().is_some())
        {
            return;
        }
        let (team, lattice) = (self.team.clone(), *self.grid.lattice());
        let h = lattice.spacing();
        let wrap = self.wrap().unwrap_or_default();
        let wrapped = |at: [i32; D]| wrap.block(at);
        let open = Open::of(&self.scene.conditions.boundaries, self.clock.time, self.facts().hoop);
        let tiles: Vec<Vec<Tile<D>>> = self.scene.bodies.iter().map(|b| b.density_tiles(&team)).collect();
        for number in 0..self.scene.bodies.len() {
            let Some(speed) = self.scene.bodies[number].renewed() else { continue };
            let nodes = NodeBlocks::around_of(&tiles[number], &wrapped);
            let (size, mut each) = (block_nodes(D), vec![(); nodes.len()]);
            let count = 1 + moments(D);
            let mut sums = vec![0.0; nodes.len() * size * count];
            nodes.add(&tiles[number], &wrapped, count, &mut sums, &team);
            let mut others = vec![0.0; nodes.len() * size];
            for (n, list) in tiles.iter().enumerate().filter(|(n, list)| *n != number && !list.is_empty()) {
                let values = if self.scene.bodies[n].renewed().is_some() { count } else { 1 };
                let mut of = vec![0.0; nodes.len() * size * values];
                nodes.add(list, &wrapped, values, &mut of, &team);
                others.iter_mut().zip(of.chunks_exact(values)).for_each(|(to, of)| *to += of[0]);
            }
            let mut fits = vec![[0.0; 4]; nodes.len() * size];
            let mut phi = vec![[0.0; 2]; nodes.len() * size];
            team.each_piece(&mut fits, size, &mut each, |block, fits, ()| {
                for (n, to) in fits.iter_mut().enumerate() {
                    *to = fit::<D>(&sums[(block * size + n) * count + 1..][..count - 1]);
                }
            });
            team.each_piece(&mut phi, size, &mut each, |block, phi, ()| {
                for (n, to) in phi.iter_mut().enumerate() {
                    let inside: [i32; D] = unfold(n, BLOCK);
                    let x = std::array::from_fn(|d| {
                        let node = nodes.coordinates[block][d] * BLOCK as i32 + inside[d];
                        lattice.origin()[d] + h * f64::from(node)
                    });
                    let (node, share) = (block * size + n, open.share(&x, h));
                    *to = [sums[node * count] + others[node], share];
                }
            });
            for axis in 0..D {
                for (plane, sign) in [(open.low[axis], 1), (open.high[axis], -1)] {
                    if plane.is_finite() {
                        phi = nodes.mirrored(&phi, (axis, (plane - lattice.origin()[axis]) / h, sign), &team);
                    }
                }
            }
            for [occupied, share] in &mut phi {
                *occupied = if *share >= OPEN { *occupied / *share } else { 0.0 };
            }
            let mut raw = vec![0.0; nodes.len() * size];
            team.each_piece(&mut raw, size, &mut each, |block, raw, ()| {
                for (n, to) in raw.iter_mut().enumerate() {
                    *to = deviation(&nodes, &phi, block, &unfold(n, BLOCK));
                }
            });
            // Deviations smoothed over the neighbouring nodes, with their open fractions.
            let mut errors = vec![[0.0; 2]; nodes.len() * size];
            team.each_piece(&mut errors, size, &mut each, |block, errors, ()| {
                for (n, to) in errors.iter_mut().enumerate() {
                    let at: [i32; D] = unfold(n, BLOCK);
                    let (mut sum, mut weights) = (0.0, 0.0);
                    for n in 0..neighbours(D) {
                        let off: [i32; D] = unfold(n, 3);
                        let beside = nodes.node(block, &std::array::from_fn(|d| at[d] + off[d] - 1));
                        let Some(node) = beside else { continue };
                        let across = off.iter().filter(|off| **off != 1).count();
                        let weight = 0.5f64.powi((D + across) as i32) * phi[node][1];
                        sum += weight * raw[node];
                        weights += weight;
                    }
                    *to = [if weights > 0.0 { sum / weights } else { 0.0 }, phi[block * size + n][1]];
                }
            });
            let rate = (EVERY as f64 * dt.to_double() * speed / (TIME * h)).min(MOST);
            self.ledger.viscosity -=
                self.scene.bodies[number].take_density(&nodes, &fits, &errors, rate, &team);
        }
    }

    /// Check that densities of a body can be renewed.
    pub(in crate::step) fn check_renewed(&self, body: &str, place: Option<usize>) -> Result<(), SceneError> {
        let facts = self.facts();
        if place.is_none() {
            return Err(SceneError::NoRenewal(
                body.into(),
                "its law must be a fluid whose pressure depends on the volume alone",
            ));
        }
        if facts.nodes != NODES || facts.domain.carried() || facts.total || facts.before_forces || facts.remap
        {
            return Err(SceneError::NoRenewal(
                body.into(),
                "the method must have quadratic B-splines, USL and the updated Lagrangian frame",
            ));
        }
        Ok(())
    }
}
