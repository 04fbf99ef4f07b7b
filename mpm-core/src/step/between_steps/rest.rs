//! States at rest: kinetic damping, and how far from balance a body is.

use std::collections::HashMap;

use impactite_scene::error::SceneError;

/// AtNodes at nodes, kept in the order in which nodes were met.
#[derive(Clone, Debug)]
pub(in crate::step) struct AtNodes<const D: usize, X> {
    places: HashMap<[i32; D], usize>,
    pub(in crate::step) sums: Vec<([i32; D], X)>,
}

impl<const D: usize, X> Default for AtNodes<D, X> {
    fn default() -> Self {
        AtNodes { places: HashMap::new(), sums: Vec::new() }
    }
}

impl<const D: usize, X: Default> AtNodes<D, X> {
    /// That of a node.
    pub(in crate::step) fn at(&mut self, node: [i32; D]) -> &mut X {
        let sums = &mut self.sums;
        let place = *self.places.entry(node).or_insert_with(|| {
            sums.push((node, X::default()));
            sums.len() - 1
        });
        &mut sums[place].1
    }
    /// That of a node, if it was met.
    pub(in crate::step) fn get(&self, node: [i32; D]) -> Option<&X> {
        self.places.get(&node).map(|&place| &self.sums[place].1)
    }
    /// All.
    pub(in crate::step) fn iter(&self) -> impl Iterator<Item = &([i32; D], X)> {
        self.sums.iter()
    }
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
    pub(in crate::step) force: f64,
    pub(in crate::step) energy: f64,
    pub(in crate::step) lasting: f64,
    pub(in crate::step) every: u64,
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

/// Kinetic damping at work.
#[derive(Clone, Copy, Debug, Default)]
pub(in crate::step) struct KineticDamping {
    /// The most kinetic energy of the nodes since the last stop, J.
    pub(in crate::step) most: f64,
    /// That of this step.
    pub(in crate::step) now: f64,
    /// How often all was stopped.
    pub(in crate::step) stops: u64,
}

/// What was in a body's motion when it was stopped.
#[derive(Clone, Copy, Debug, Default)]
pub struct TakenMotion {
    /// Momentum, kg m/s.
    pub momentum: [f64; 3],
    /// Kinetic energy, J.
    pub kinetic: f64,
}

/// Of the particles as they stand.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Frequency {
    /// No vibration of the nodes, each with its lumped mass, is faster than this, rad/s.
    pub bound: f64,
    /// The largest speed of a particle, m/s.
    pub speed: f64,
}
