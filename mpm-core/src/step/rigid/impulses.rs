//! Impulses on the nodes of free rigid bodies in a step, and their motion.

use super::motion::RigidState;
use super::nodes::rigid_of;
use crate::step::nodes::layout::numbers;
use crate::step::nodes::stages::GridStages;
use impactite_simd::Float;

/// Impulse on a block of nodes of a free body, N s, and its moment about the body's centre, N m s.
#[derive(Clone, Copy, Debug, Default)]
struct Push {
    impulse: [f64; 3],
    moment: [f64; 3],
}

impl<T: Float, const D: usize> GridStages<'_, T, D> {
    /// Return the impulse on the nodes of the free body `number` in this step, N s, and its moment about the centre, N m s.
    pub fn push_on(&self, number: usize, state: &RigidState<D>) -> ([f64; 3], [f64; 3]) {
        let (fields, takes, dt) = (self.fields, self.of.takes.to_double(), self.of.dt.to_double());
        let mirrors = self.planes.copied();
        let mut sum = Push::default();
        let layout = fields.layout();
        for block in (0..fields.len()).filter(|block| fields.owner(*block) as usize == number) {
            let place = fields.place(block);
            let nodes = layout.of(self.grid.nodes(), block);
            // Next to symmetry planes nodes include the body's mirror image: count only the share of its own particles.
            let own = self.planes.own_masses(layout.start(block), nodes.len());
            for (i, (n, node)) in numbers(layout.kept(block)).zip(nodes).enumerate() {
                let whole = if place.is_copy(n, mirrors) { 0.0 } else { 1.0 };
                let share = own.share(i, node).unwrap_or(whole);
                if node.first[0] <= self.cutoff || share == 0.0 {
                    continue;
                }
                let (x, mass) = (place.node(n), share * node.first[0].to_double());
                let now = state.velocity_at(&x);
                let (mut arm, mut given) = ([0.0; 3], [0.0; 3]);
                for d in 0..D {
                    arm[d] = x[d] - state.centre()[d];
                    let gained = node.second[d + 1].to_double() * dt;
                    let start = node.first[d + 1].to_double() - gained;
                    given[d] = mass * (gained + takes * (start - now[d]));
                    sum.impulse[d] += given[d];
                }
                let ([x, y, z], [u, v, w]) = (arm, given);
                let moment = [y * w - z * v, z * u - x * w, x * v - y * u];
                (0..3).for_each(|d| sum.moment[d] += moment[d]);
            }
        }
        (sum.impulse, sum.moment)
    }

    /// Set velocity and acceleration of the nodes of free bodies to those of the bodies in this step.
    pub fn move_rigid(&mut self) {
        let (bodies, fields) = (self.bodies, self.fields);
        let (layout, team) = (fields.layout(), self.team);
        layout.each(team, self.grid.nodes_mut(), self.books, |block, mut nodes, _| {
            let Some(body) = rigid_of(bodies, fields, block).filter(|b| !b.is_prescribed()) else { return };
            let place = fields.place(block);
            for (n, node) in nodes.numbered() {
                let x = place.node(n);
                let (way, gain) = (body.mean_velocity(&x), body.acceleration(&x));
                for d in 0..D {
                    node.first[d + 1] = T::of(way[d]);
                    node.second[d + 1] = T::of(gain[d]);
                }
            }
        });
    }
}
