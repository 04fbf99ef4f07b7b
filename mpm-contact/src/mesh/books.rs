//! Results of a contact step: impulses on points, forces of pairs, energies.

use impactite_scene::{ContactPoint, Exchange, PairContact};

use super::body::ContactBody;
use super::detect::Touch;
use super::solve::World;
use crate::vector::{difference, dot, sum, times, wide};

/// Impulse on a point of a body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointImpulse<const D: usize> {
    /// Number of the point or node.
    pub point: u32,
    /// Impulse, N s: change of momentum of the point, or reaction of a body of prescribed motion.
    pub impulse: [f64; D],
}

/// Summary of a contact step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MeshStep {
    /// Number of contacts of points and facets, solved together.
    pub contacts: usize,
    /// Largest number of sweeps of a solution, at most 200 each.
    pub sweeps: usize,
    /// Number of solutions: one, and another for each set of contacts found only then.
    pub rounds: usize,
    /// Change of a gap in the last sweep, m; zero if converged.
    pub residual: f64,
    /// Largest penetration at the end of the step, over the spacing of the point; at most 0.05 unless the step began deeper, springs push,
    /// or rounds did not suffice.
    pub depth: f64,
    /// Exchange in this step: impulse and work of bodies of prescribed motion on others, work of friction, and plastic impact loss
    /// (negative by the small energy of penetration correction): kinetic energy after = before + work - friction - impacts.
    pub exchange: Exchange,
    /// Couple of the impulses: their angular momentum about positions at the start of the step, N m s: sum of (x_p - sum N_a x_a) x J.
    pub couple: [f64; 3],
}

/// Collector of the results of a step.
pub(super) struct Books<'a, const D: usize> {
    pub impulses: &'a mut [Vec<PointImpulse<D>>],
    pub places: &'a mut Vec<ContactPoint>,
    pub pairs: &'a mut Vec<PairContact>,
}

impl<const D: usize> Books<'_, D> {
    /// Enter the results of all contacts.
    pub fn enter(mut self, world: &mut World<'_, D>, touches: &[Touch], step: &mut MeshStep) {
        self.sum_up(world, touches);
        for pair in &mut *self.pairs {
            (pair.force, pair.places, pair.gap) = ([0.0; 3], 0, None);
        }
        self.places.clear();
        for touch in touches {
            let (mut before, mut left, mut arm, mut place) = ([0.0; 3], [0.0; 3], [0.0; 3], [0.0; 3]);
            for (k, (body, n, share)) in world.shares(touch).enumerate() {
                let (x, trial) = (world.bodies[body].position(n), wide(&world.bodies[body].velocities[n]));
                let now = world.velocities[body][n];
                before = sum(before, times(trial, share));
                left = sum(left, times(now, share));
                arm = sum(arm, times(x, share));
                if k > 0 {
                    place = difference(place, times(x, share));
                }
                if world.bodies[body].is_prescribed(n) {
                    let given = times(touch.impulse, -share);
                    step.exchange.impulse = sum(step.exchange.impulse, given);
                    step.exchange.work += dot(given, trial);
                }
            }
            let gap = touch.gap + dot(left, touch.normal) * world.dt;
            if touch.impulse == [0.0; 3] && gap > 0.0 {
                continue;
            }
            let along = dot(touch.impulse, touch.normal);
            let across = difference(touch.impulse, times(touch.normal, along));
            let friction = -dot(across, left);
            let taken = -0.5 * dot(touch.impulse, sum(before, left)) - friction;
            step.exchange.friction += friction;
            step.exchange.impacts += taken;
            for d in 0..3 {
                let (e, f) = ((d + 1) % 3, (d + 2) % 3);
                step.couple[d] += arm[e] * touch.impulse[f] - arm[f] * touch.impulse[e];
            }
            let [of_point, of_facet] = world.sides[touch.side as usize].bodies;
            let point_first = of_point <= of_facet;
            let on_second = times(touch.impulse, if point_first { -1.0 } else { 1.0 });
            let normal = times(touch.normal, if point_first { -1.0 } else { 1.0 });
            let bodies = [of_point.min(of_facet), of_point.max(of_facet)];
            self.places.push(ContactPoint {
                position: place,
                bodies,
                normal,
                gap: Some(gap),
                impulse: on_second,
            });
            if let Some(pair) = self.pairs.iter_mut().find(|pair| pair.bodies == bodies) {
                if bodies[0] != bodies[1] {
                    pair.force = sum(pair.force, times(on_second, 1.0 / world.dt));
                }
                pair.places += 1;
                pair.gap = Some(pair.gap.map_or(gap, |least| least.min(gap)));
                pair.friction += friction;
                pair.taken += taken;
            }
        }
    }

    /// Sum the impulses on each point; set the velocities of the world to those after them, without the rounding of sweeps.
    fn sum_up(&mut self, world: &mut World<'_, D>, touches: &[Touch]) {
        let still = |body: &ContactBody<'_, D>| vec![[0.0; 3]; body.positions.len()];
        let mut sums: Vec<Vec<[f64; 3]>> = world.bodies.iter().map(still).collect();
        for touch in touches.iter().filter(|touch| touch.impulse != [0.0; 3]) {
            for (body, n, share) in world.shares(touch) {
                sums[body][n] = sum(sums[body][n], times(touch.impulse, share));
            }
        }
        for (body, sums) in sums.iter().enumerate() {
            let ContactBody { velocities, masses, carriers, .. } = world.bodies[body];
            self.impulses[body].clear();
            for (n, total) in sums.iter().enumerate().filter(|(_, total)| **total != [0.0; 3]) {
                let impulse = std::array::from_fn(|d| total[d]);
                self.impulses[body].push(PointImpulse { point: n as u32, impulse });
                if carriers.is_none() {
                    world.velocities[body][n] = sum(wide(&velocities[n]), times(*total, 1.0 / masses[n]));
                }
            }
            if let Some(carriers) = carriers {
                let mut now: Vec<_> = carriers.velocities.iter().map(wide).collect();
                for PointImpulse { point, impulse } in &self.impulses[body] {
                    for (node, weight) in carriers.of(*point as usize) {
                        let v = &mut now[*node as usize];
                        (0..D).for_each(|d| v[d] += weight[d] * impulse[d] / carriers.masses[*node as usize]);
                    }
                }
                world.velocities[body] = carriers.carried(&now);
            }
        }
    }
}
