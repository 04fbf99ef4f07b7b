//! States at rest: kinetic damping, and unbalanced forces.

use std::collections::HashMap;

use impactite_scene::error::SceneError;

/// Values at nodes, in the order in which the nodes were added.
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
    /// Value at a node, added if missing.
    pub(in crate::step) fn at(&mut self, node: [i32; D]) -> &mut X {
        let sums = &mut self.sums;
        let place = *self.places.entry(node).or_insert_with(|| {
            sums.push((node, X::default()));
            sums.len() - 1
        });
        &mut sums[place].1
    }
    /// Value at a node, if it was added.
    pub(in crate::step) fn get(&self, node: [i32; D]) -> Option<&X> {
        self.places.get(&node).map(|&place| &self.sums[place].1)
    }
    /// Iterate over all values.
    pub(in crate::step) fn iter(&self) -> impl Iterator<Item = &([i32; D], X)> {
        self.sums.iter()
    }
}

/// Balance of forces and energies of a scene.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Balance {
    /// Root of the sum over the particles of the squares of the force that accelerates each, m_p sum_i N_ip f_i /
    /// m_i, N. Unbalanced nodal forces that accelerate no particle are excluded: with fewer particles than nodes they
    /// never vanish.
    pub unbalanced: f64,
    /// Root of the sum of squares for external forces: loads, weights and reactions of boundaries and rigid bodies, N.
    pub external: f64,
    /// Kinetic energy of the particles, J.
    pub kinetic: f64,
    /// Internal energy of the particles, J; without plastic flow and heat this is strain energy.
    pub internal: f64,
}

impl Balance {
    /// Ratio of the unbalanced to the external force; 0 where nothing acts.
    #[must_use]
    pub fn force_ratio(&self) -> f64 {
        if self.unbalanced == 0.0 { 0.0 } else { self.unbalanced / self.external }
    }
    /// Ratio of kinetic to internal energy; 0 where nothing moves.
    #[must_use]
    pub fn energy_ratio(&self) -> f64 {
        if self.kinetic == 0.0 { 0.0 } else { self.kinetic / self.internal.abs() }
    }
}

/// Criterion of rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rest {
    pub(in crate::step) force: f64,
    pub(in crate::step) energy: f64,
    pub(in crate::step) lasting: f64,
    pub(in crate::step) every: u64,
}

impl Rest {
    /// Create the criterion: an unbalanced force below `force` of the external force ([`Balance::force_ratio`]) and a
    /// kinetic energy below `energy` of the internal one, at every check for `lasting` seconds: 1e-4, 1e-6 and the
    /// lowest period are usual. It is checked every 20 steps.
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

    /// Set the number of steps between checks. A check costs some twenty steps.
    ///
    /// # Errors
    /// Zero steps.
    pub fn every(self, steps: u64) -> Result<Self, SceneError> {
        if steps == 0 {
            return Err(SceneError::Rest { field: "steps between looks", value: 0.0 });
        }
        Ok(Rest { every: steps, ..self })
    }

    /// True if the balance meets the criterion.
    #[must_use]
    pub fn holds(&self, balance: &Balance) -> bool {
        balance.force_ratio() <= self.force && balance.energy_ratio() <= self.energy
    }
}

/// Result of a run to rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rested {
    /// True at rest; false at the end of the time.
    pub reached: bool,
    /// Balance of the last check.
    pub balance: Balance,
}

/// State of kinetic damping.
#[derive(Clone, Copy, Debug, Default)]
pub(in crate::step) struct KineticDamping {
    /// Largest kinetic energy of the nodes since the last stop, J.
    pub(in crate::step) most: f64,
    /// Kinetic energy of the nodes in this step, J.
    pub(in crate::step) now: f64,
    /// Number of stops.
    pub(in crate::step) stops: u64,
}

/// Momentum and energy of a body that were removed when it was stopped.
#[derive(Clone, Copy, Debug, Default)]
pub struct TakenMotion {
    /// Momentum, kg m/s.
    pub momentum: [f64; 3],
    /// Kinetic energy, J.
    pub kinetic: f64,
}

/// Frequency and speed bounds of the particles in their present state.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Frequency {
    /// Upper bound of the frequencies of the nodes, with lumped masses, rad/s.
    pub bound: f64,
    /// Largest speed of a particle, m/s.
    pub speed: f64,
}
