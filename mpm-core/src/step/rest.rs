//! States at rest: kinetic damping, and how far from balance a body is.

use std::collections::HashMap;

use super::scene::SceneError;
use super::solver::{Mpm, StepError};
use crate::parallel::Float;

/// Sums at nodes, kept in the order in which nodes were met.
#[derive(Clone, Debug)]
pub(super) struct Sums<const D: usize, X> {
    places: HashMap<[i32; D], usize>,
    sums: Vec<([i32; D], X)>,
}

impl<const D: usize, X> Default for Sums<D, X> {
    fn default() -> Self {
        Sums { places: HashMap::new(), sums: Vec::new() }
    }
}

impl<const D: usize, X: Default> Sums<D, X> {
    /// That of a node.
    pub(super) fn at(&mut self, node: [i32; D]) -> &mut X {
        let sums = &mut self.sums;
        let place = *self.places.entry(node).or_insert_with(|| {
            sums.push((node, X::default()));
            sums.len() - 1
        });
        &mut sums[place].1
    }
    /// That of a node, if it was met.
    fn get(&self, node: [i32; D]) -> Option<&X> {
        self.places.get(&node).map(|&place| &self.sums[place].1)
    }
    /// All.
    pub(super) fn iter(&self) -> impl Iterator<Item = &([i32; D], X)> {
        self.sums.iter()
    }
}

/// Forces at a node, N.
#[derive(Clone, Copy, Debug, Default)]
struct Forces {
    mass: f64,
    /// What is left of all.
    left: [f64; 3],
    /// Those from outside.
    outer: [f64; 3],
    /// Does a rigid body reach it?
    rigid: bool,
}

/// How far from balance a scene is.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Balance {
    /// Root of the sum over the particles of the squares of the force that accelerates each, m_p sum_i N_ip f_i / m_i, N.
    /// What is left at nodes and no particle feels is none: where there are fewer particles than nodes it never goes.
    pub unbalanced: f64,
    /// The same of the forces from outside: loads, weights and reactions of boundaries and rigid bodies, N.
    pub external: f64,
    /// Kinetic energy of the particles, J.
    pub kinetic: f64,
    /// Internal energy of the particles, J; without plastic flow and heat this is strain energy.
    pub internal: f64,
}

impl Balance {
    /// The unbalanced force over that from outside; 0 where nothing acts.
    #[must_use]
    pub fn force_ratio(&self) -> f64 {
        if self.unbalanced == 0.0 { 0.0 } else { self.unbalanced / self.external }
    }
    /// Kinetic over internal energy; 0 where nothing moves.
    #[must_use]
    pub fn energy_ratio(&self) -> f64 {
        if self.kinetic == 0.0 { 0.0 } else { self.kinetic / self.internal.abs() }
    }
}

/// What counts as rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rest {
    force: f64,
    energy: f64,
    lasting: f64,
    every: u64,
}

impl Rest {
    /// At rest is what has an unbalanced force below `force` of the force from outside ([`Balance::force_ratio`]) and a
    /// kinetic energy below `energy` of the internal one, at every look for `lasting` seconds: 1e-4, 1e-6 and the
    /// lowest period are usual. It is looked at every 20 steps.
    ///
    /// # Errors
    /// Ratios or a time that are not positive.
    pub fn new(force: f64, energy: f64, lasting: f64) -> Result<Self, SceneError> {
        for (field, value) in [("force ratio", force), ("energy ratio", energy), ("time to last", lasting)] {
            if !(value > 0.0 && value.is_finite()) {
                return Err(SceneError::Rest { field, value });
            }
        }
        Ok(Rest { force, energy, lasting, every: 20 })
    }

    /// The same, looked at every so many steps. A look costs some twenty steps.
    ///
    /// # Errors
    /// No steps.
    pub fn every(self, steps: u64) -> Result<Self, SceneError> {
        if steps == 0 {
            return Err(SceneError::Rest { field: "steps between looks", value: 0.0 });
        }
        Ok(Rest { every: steps, ..self })
    }

    /// Does this count?
    #[must_use]
    pub fn holds(&self, balance: &Balance) -> bool {
        balance.force_ratio() <= self.force && balance.energy_ratio() <= self.energy
    }
}

/// How a run to rest ended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rested {
    /// Is it at rest? If not, the time was over.
    pub reached: bool,
    /// The last look.
    pub balance: Balance,
}

/// Part of its peak that the kinetic energy falls by when the peak is past: a step or two later. Without it rounding would
/// stop what nodes hardly feel and pass on to the particles only in the course of time.
const PAST: f64 = 1e-3;

/// Kinetic damping at work.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Calm {
    /// The most kinetic energy of the nodes since the last stop, J.
    pub(super) most: f64,
    /// That of this step.
    pub(super) now: f64,
    /// How often all was stopped.
    pub(super) stops: u64,
}

/// What was in a body's motion when it was stopped.
#[derive(Clone, Copy, Debug, Default)]
pub struct Stilled {
    /// Momentum, kg m/s.
    pub momentum: [f64; 3],
    /// Kinetic energy, J.
    pub kinetic: f64,
}

impl<const D: usize, T: Float> Mpm<D, T> {
    /// Stop all particles whenever the kinetic energy of the nodes has passed a peak, or do so no longer: kinetic damping
    /// (Cundall 1976; Barnes 1999), the way to states at rest that has no parameter. A scene let go under its loads has
    /// the most kinetic energy where it passes the state at rest; stopped there, it starts again much nearer to it.
    /// Velocities become zero; what they held of momentum and energy is booked as a load. Stopped are particles with all that nodes do not see of their velocities, which local damping
    /// ([`Mpm::set_local_damping`]) cannot reach.
    ///
    /// For loads that do not change, or slowly: the way there is not that of the dynamics, and what remembers the way
    /// (plastic flow, friction) may end elsewhere. A step costs one reading of the nodes more, a stop one map.
    /// With FLIP on wide stencils some 1e-3 of the forces stay, in directions that nodes hardly see and that start anew with
    /// every stop; with hats they go.
    /// The books close to first order of the step: of what was strain energy between the peak and the stop, half a step's
    /// is missing.
    ///
    /// # Errors
    /// A free rigid body, which would go on; a method that maps momentum and impulse together
    /// ([`Composition::MAPS_TOGETHER`](crate::Composition::MAPS_TOGETHER): APIC and its kin), whose states at rest were found wrong (book, "Equilibrium by damping").
    pub fn set_kinetic_damping(&mut self, on: bool) -> Result<(), SceneError> {
        if on && self.facts().maps_together {
            return Err(SceneError::RestOfTogether(self.facts().description.clone()));
        }
        if on && let Some(body) = self.free_rigid_body() {
            return Err(SceneError::RestOfFree(body));
        }
        if on {
            self.check_references("kinetic damping")?;
        }
        self.calm = on.then(Calm::default);
        Ok(())
    }

    /// How often kinetic damping stopped everything.
    pub fn stops(&self) -> u64 {
        self.calm.map_or(0, |calm| calm.stops)
    }

    /// The name of a rigid body that moves as it is pushed.
    pub(super) fn free_rigid_body(&self) -> Option<String> {
        let free = |&&body: &&usize| self.bodies[body].rigid().is_some_and(|r| !r.is_prescribed());
        self.rigid.iter().find(free).map(|&body| self.bodies[body].name().to_string())
    }

    /// Note the kinetic energy of the nodes after the momentum update, if kinetic damping asks for it. Blocks are summed in
    /// the order of their coordinates, so that no grid matters.
    pub(super) fn watch_motion(&mut self) {
        let Some(calm) = &mut self.calm else { return };
        let (layout, nodes) = (self.fields.layout(), self.grid.nodes());
        let mut blocks = Vec::with_capacity(self.fields.len());
        for (block, coordinates) in self.fields.coordinates().iter().enumerate() {
            let mut kinetic = 0.0;
            for node in layout.of(nodes, block) {
                let square: f64 = node.first[1..=D].iter().map(|v| v.to_double().powi(2)).sum();
                kinetic += 0.5 * node.first[0].to_double() * square;
            }
            blocks.push((*coordinates, kinetic));
        }
        // Stable: fields of one block stay in the order of their bodies.
        blocks.sort_by_key(|b| b.0);
        calm.now = blocks.iter().map(|b| b.1).sum();
    }

    /// Kinetic damping at the end of a step.
    pub(super) fn still(&mut self) {
        let Some(calm) = self.calm else { return };
        if calm.now >= calm.most * (1.0 - PAST) {
            self.calm = Some(Calm { most: calm.most.max(calm.now), ..calm });
            return;
        }
        for body in &mut self.bodies {
            let stilled = body.still();
            for d in 0..3 {
                self.ledger.load[d] -= stilled.momentum[d];
            }
            self.ledger.work -= stilled.kinetic;
        }
        self.calm = Some(Calm { most: 0.0, now: 0.0, stops: calm.stops + 1 });
        self.mapped = false;
    }

    /// How far from balance the scene is now: the forces that stresses, loads and weights leave at the nodes, as the
    /// particles feel them, and the energies.
    ///
    /// Where a boundary holds a node, or a rigid body reaches it, what acts there is a reaction. A wall holds what is
    /// pushed against it. Forces between deformable bodies cancel in the sum at a node: of a contact the balance of
    /// both together is seen. Made from the particles one by one, some twenty times the work of a step.
    pub fn balance(&self) -> Balance {
        self.work.balance(self)
    }

    pub(super) fn balance_here(&self) -> Balance {
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

    /// The forces at the nodes.
    fn forces(&self) -> Sums<D, Forces> {
        let mut nodes = Sums::<D, Forces>::default();
        self.for_each_footprint(&mut |p| {
            for w in p.nodes {
                let node = nodes.at(w.node);
                node.mass += p.mass * w.value;
                node.rigid |= p.rigid && w.value != 0.0;
                for c in 0..D {
                    let pull: f64 = (0..D).map(|d| p.stress[c][d] * w.gradient[d]).sum();
                    node.left[c] += w.sign[c] * (w.value * p.hoop[c] - pull);
                    node.outer[c] += w.sign[c] * w.value * p.load[c];
                }
            }
        });
        let lattice = *self.grid.lattice();
        let tolerance = 1e-6 * lattice.spacing();
        let gravity = self.conditions.gravity.as_ref().map_or([0.0; D], |g| g(self.time));
        for (index, node) in &mut nodes.sums {
            let x = lattice.node(index.map(i64::from));
            for d in 0..D {
                node.outer[d] += node.mass * gravity[d];
                node.left[d] += node.outer[d];
            }
            let mut v = node.left;
            for boundary in &self.conditions.boundaries {
                boundary.constrain(&x, &mut v, self.time, tolerance, 0.0);
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
    /// As [`Mpm::step`].
    pub fn run_to_rest(&mut self, rest: &Rest, end: f64) -> Result<Rested, StepError> {
        self.work.run_to_rest(self, rest, end)
    }

    pub(super) fn run_to_rest_here(&mut self, rest: &Rest, end: f64) -> Result<Rested, StepError> {
        let mut since = None;
        loop {
            let balance = self.balance();
            since = if rest.holds(&balance) { Some(since.unwrap_or(self.time)) } else { None };
            let reached = since.is_some_and(|start| self.time - start >= rest.lasting);
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
