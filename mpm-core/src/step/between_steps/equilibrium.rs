//! Runs to equilibrium: kinetic damping, and unbalanced forces of a scene.

use super::rest::*;
use crate::step::mpm::Mpm;
use impactite_scene::error::SceneError;
use impactite_scene::{Condition, Place, StepError};
use impactite_simd::Float;

/// Forces at a node, N.
#[derive(Clone, Copy, Debug, Default)]
struct Forces {
    mass: f64,
    /// Mass along each axis, images behind planes of symmetry negative: the mass that body forces act on, kg.
    heavy: [f64; 3],
    /// Unbalanced force, N.
    left: [f64; 3],
    /// External force, N.
    outer: [f64; 3],
    /// True if a rigid body reaches the node.
    rigid: bool,
}

impl<const D: usize, T: Float> Mpm<D, T> {
    /// Enable or disable kinetic damping (Cundall 1976; Barnes 1999): stop all particles whenever the kinetic energy
    /// of the nodes has passed a peak. It finds states at rest without a parameter. A scene released under its loads
    /// has the most kinetic energy where it passes the state at rest; stopped there, it starts again much nearer to
    /// it. The momentum of the stopped particles is booked as a load, their energy as damping. This includes particle
    /// velocities that nodes do not resolve, which local damping ([`Mpm::set_local_damping`]) cannot reach.
    ///
    /// The method is for loads that are constant or change slowly: the path to rest is not that of the dynamics, and
    /// path-dependent processes (plastic flow, friction) may end elsewhere. A step costs one more reading of the
    /// nodes, a stop one map. With FLIP on wide stencils some 1e-3 of the forces remain, in directions that nodes
    /// hardly resolve and that start again with every stop; with linear shape functions they vanish. Balances close
    /// to first order of the step: half a step's share of the strain energy between the peak and the stop is missing.
    ///
    /// # Errors
    /// A free rigid body, which would continue to move; a method that maps momentum and impulse together
    /// ([`Composition::MAPS_TOGETHER`](crate::Composition::MAPS_TOGETHER): APIC and related transfers), whose states
    /// at rest were found wrong (book, "Equilibrium by damping").
    pub fn set_kinetic_damping(&mut self, on: bool) -> Result<(), SceneError> {
        if on && self.facts().maps_together {
            return Err(SceneError::RestOfTogether(self.facts().description.clone()));
        }
        if on && let Some(body) = self.free_rigid_body() {
            return Err(SceneError::RestOfFree(body));
        }
        if on {
            self.check_clients("kinetic damping")?;
        }
        self.between_steps.kinetic_damping = on.then(KineticDamping::default);
        Ok(())
    }

    /// Number of stops by kinetic damping.
    pub fn stops(&self) -> u64 {
        self.between_steps.kinetic_damping.map_or(0, |damping| damping.stops)
    }

    /// Name of a free rigid body, if there is one.
    pub(in crate::step) fn free_rigid_body(&self) -> Option<String> {
        let free = |&&body: &&usize| self.scene.bodies[body].rigid().is_some_and(|r| !r.is_prescribed());
        self.scene.rigid.iter().find(free).map(|&body| self.scene.bodies[body].name().to_string())
    }

    /// Store the kinetic energy of the nodes after the momentum update, for kinetic damping. Blocks are summed in the
    /// order of their coordinates, so that the result does not depend on the grid.
    pub(in crate::step) fn watch_motion(&mut self) {
        let Some(damping) = &mut self.between_steps.kinetic_damping else { return };
        let (layout, nodes) = (self.grid.fields.layout(), self.grid.nodes());
        let mut blocks = Vec::with_capacity(self.grid.fields.len());
        for (block, coordinates) in self.grid.fields.coordinates().iter().enumerate() {
            let mut kinetic = 0.0;
            for node in layout.of(nodes, block) {
                let square: f64 = node.first[1..=D].iter().map(|v| v.to_double().powi(2)).sum();
                kinetic += 0.5 * node.first[0].to_double() * square;
            }
            blocks.push((*coordinates, kinetic));
        }
        // Stable sort: fields of one block stay in the order of their bodies.
        blocks.sort_by_key(|b| b.0);
        damping.now = blocks.iter().map(|b| b.1).sum();
    }

    /// Balance of the scene: forces of stresses, loads and weights that are unbalanced at the nodes, as they act on
    /// the particles, and energies.
    ///
    /// Where a boundary constrains a node, or a rigid body reaches it, the force is a reaction. A wall reacts to
    /// material that presses against it. Forces between deformable bodies cancel in the sum at a node: only the joint
    /// balance of bodies in contact is visible. It is assembled from the particles one by one, at some twenty times
    /// the work of a step.
    pub fn balance(&self) -> Balance {
        self.work.balance(self)
    }

    pub(in crate::step) fn balance_here(&self) -> Balance {
        let nodes = self.forces();
        let (mut unbalanced, mut external) = (0.0, 0.0);
        self.for_each_footprint(&mut |p| {
            let (mut left, mut outer) = ([0.0; 3], [0.0; 3]);
            for w in p.nodes {
                let Some(node) = nodes.get(w.node).filter(|node| node.mass > 0.0) else { continue };
                for d in 0..D {
                    let share = w.sign[d] * w.value * p.mass / node.mass;
                    left[d] += share * node.left[d];
                    outer[d] += share * node.outer[d];
                }
            }
            for d in 0..D {
                unbalanced += left[d] * left[d];
                external += outer[d] * outer[d];
            }
        });
        let totals = self.totals();
        Balance {
            unbalanced: unbalanced.sqrt(),
            external: external.sqrt(),
            kinetic: totals.kinetic,
            internal: totals.internal,
        }
    }

    /// Assemble the forces at the nodes.
    fn forces(&self) -> AtNodes<D, Forces> {
        let mut nodes = AtNodes::<D, Forces>::default();
        self.for_each_footprint(&mut |p| {
            for w in p.nodes {
                let node = nodes.at(w.node);
                node.mass += p.mass * w.value;
                (0..D).for_each(|d| node.heavy[d] += w.sign[d] * p.mass * w.value);
                node.rigid |= p.rigid && w.value != 0.0;
                for c in 0..D {
                    let pull: f64 = (0..D).map(|d| p.stress[c][d] * w.gradient[d]).sum();
                    node.left[c] += w.sign[c] * (w.value * p.hoop[c] - pull);
                    node.outer[c] += w.sign[c] * w.value * p.load[c];
                }
            }
        });
        let (lattice, lattices) = (*self.grid.lattice(), self.grid.fields.lattices());
        let tolerance = 1e-6 * lattice.spacing();
        let gravity = self.scene.conditions.gravity.as_ref().map_or([0.0; D], |g| g(self.clock.time));
        for (index, node) in &mut nodes.sums {
            let x = lattices.position(index);
            for d in 0..D {
                node.outer[d] += node.heavy[d] * gravity[d];
                node.left[d] += node.outer[d];
            }
            // The forces of conditions that react are evaluated over a time so short that nothing moves.
            let moment = 1e-6 * self.clock.last.unwrap_or(1.0);
            for boundary in self.scene.conditions.boundaries.iter().filter(|b| b.reacts()) {
                let reaction = boundary.react(&Place {
                    position: x,
                    mass: node.mass,
                    depth: 0.5 * lattice.spacing(),
                    tolerance,
                    start: Some([0.0; D]),
                    trial: std::array::from_fn(|d| node.left[d] * moment / node.mass),
                    time: self.clock.time,
                    dt: moment,
                });
                for d in 0..D {
                    node.outer[d] += reaction.impulse[d] / moment;
                    node.left[d] += reaction.impulse[d] / moment;
                }
            }
            let mut v = node.left;
            for boundary in &self.scene.conditions.boundaries {
                boundary.constrain(&x, &mut v, self.clock.time, tolerance, 0.0);
            }
            for d in 0..D {
                if node.rigid || v[d] != node.left[d] {
                    node.outer[d] -= node.left[d];
                    node.left[d] = 0.0;
                }
            }
        }
        nodes
    }

    /// Step until the scene is at rest, or until `end`, s.
    ///
    /// ```
    /// # use mpm_core::{BlockGrid, Boundary, Flip, Linear, Method, Mpm, Musl, PlaneStrain, Rest, Side, geometry::*};
    /// # use mpm_materials::{LinearElastic, Moduli};
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// # let lattice = Lattice::new([0.0; 2], 0.25)?;
    /// # let seeds = fill(&Cuboid::new([0.0; 2], [1.0, 1.0])?, &lattice, 2, &Filling::new())?;
    /// # let law = LinearElastic::new(1.0, Moduli::young_poisson(1.0, 0.3)?)?;
    /// # let mut mpm = Mpm::new(Method::new(Linear, Flip, Musl, PlaneStrain), BlockGrid::new(lattice));
    /// # mpm.add("block", law, &seeds, |_| [0.0; 2])?;
    /// # mpm.bound(Boundary::Fixed { axis: 1, at: 0.0, side: Side::Above })?;
    /// mpm.set_body_force(|_| [0.0, -1e-3]);
    /// mpm.set_kinetic_damping(true)?;
    /// let rested = mpm.run_to_rest(&Rest::new(1e-3, 1e-6, 4.0)?, 1e3)?;
    /// assert!(rested.reached);
    /// # Ok(())
    /// # }
    /// ```
    ///
    /// # Errors
    /// Errors of [`Mpm::step`].
    pub fn run_to_rest(&mut self, rest: &Rest, end: f64) -> Result<Rested, StepError> {
        self.work.run_to_rest(self, rest, end)
    }

    pub(in crate::step) fn run_to_rest_here(&mut self, rest: &Rest, end: f64) -> Result<Rested, StepError> {
        let mut since = None;
        loop {
            let balance = self.balance();
            since = if rest.holds(&balance) { Some(since.unwrap_or(self.clock.time)) } else { None };
            let reached = since.is_some_and(|start| self.clock.time - start >= rest.lasting);
            if reached || self.reached(end) {
                return Ok(Rested { reached, balance });
            }
            for _ in 0..rest.every {
                if !self.reached(end) {
                    self.step_towards(end)?;
                }
            }
        }
    }
}
