//! Sums, the audit of revisions, and pictures of an instant.

use mpm_core::output::{OutputError, ParticleSize, Snapshot};
use mpm_materials::material::Described;

use crate::method::Composition;
use crate::simplex::volume;
use crate::solver::Pcmm;
use crate::tessellation::{Flaw, corners};
use mpm_core::Embedding;

/// Elements removed or created by revisions, with what they held.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Lot {
    /// How many.
    pub elements: u64,
    /// Their volume, m^3 (per metre of depth, or per radian).
    pub volume: f64,
    /// Their mass (reference density times reference volume), kg. The mass that moves is that of the particles, which
    /// no revision touches.
    pub mass: f64,
    /// Their internal energy, J.
    pub energy: f64,
}

/// What revisions did. Masses and velocities of particles stay, and with them momentum and kinetic energy.
///
/// Matter that loses its element is still there: what a dead element held and left to no newborn, its particles hold
/// in store, as heat, until newborns take it up again. Only what a newborn has beyond that is added.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Audit {
    /// Revisions that changed something.
    pub revisions: u64,
    /// What was deleted.
    pub removed: Lot,
    /// What was created.
    pub created: Lot,
    /// Mass that left elements and is in none, kg.
    pub stored_mass: f64,
    /// Internal energy of that, J.
    pub stored_energy: f64,
    /// Deleted elements by the condition they failed: contact, small angle, large angle, short edge (see [`Flaw`]). Those
    /// that made room for better ones are not among them.
    pub flaws: [u64; Flaw::COUNT],
}

impl Audit {
    /// Internal energy that revisions made of nothing, J.
    pub fn energy_added(&self) -> f64 {
        self.created.energy - self.removed.energy + self.stored_energy
    }
    /// Mass of elements that revisions made of nothing, kg.
    pub fn mass_added(&self) -> f64 {
        self.created.mass - self.removed.mass + self.stored_mass
    }
}

/// Sums over particles and elements: per metre of depth in plane strain, per radian around an axis.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Totals {
    /// Mass of the particles, kg.
    pub mass: f64,
    /// Mass of the elements, kg: less where matter is uncovered, more where it is covered twice.
    pub covered: f64,
    /// Volume of the elements, m^3.
    pub volume: f64,
    /// Momentum, kg m/s.
    pub momentum: [f64; 3],
    /// Sum of m |v|, kg m/s: what momentum errors are relative to.
    pub momentum_scale: f64,
    /// Angular momentum about the origin, kg m^2/s.
    pub angular_momentum: [f64; 3],
    /// Kinetic energy, J, with the velocities of the particles, which are those of the middle of the last step.
    pub kinetic: f64,
    /// Internal energy, J: of the elements, and what particles hold in store ([`Audit`]).
    pub internal: f64,
    /// The part of it in store, J.
    pub stored: f64,
}

impl Lot {
    fn plus(self, o: &Lot) -> Lot {
        Lot {
            elements: self.elements + o.elements,
            volume: self.volume + o.volume,
            mass: self.mass + o.mass,
            energy: self.energy + o.energy,
        }
    }
}

impl Audit {
    /// The sum, of two bodies.
    #[must_use]
    pub fn plus(mut self, o: &Audit) -> Audit {
        self.revisions += o.revisions;
        self.removed = self.removed.plus(&o.removed);
        self.created = self.created.plus(&o.created);
        self.stored_mass += o.stored_mass;
        self.stored_energy += o.stored_energy;
        for k in 0..Flaw::COUNT {
            self.flaws[k] += o.flaws[k];
        }
        self
    }
}

impl Totals {
    /// The sum, of two bodies.
    #[must_use]
    pub fn plus(mut self, o: &Totals) -> Totals {
        self.mass += o.mass;
        self.covered += o.covered;
        self.volume += o.volume;
        for d in 0..3 {
            self.momentum[d] += o.momentum[d];
            self.angular_momentum[d] += o.angular_momentum[d];
        }
        self.momentum_scale += o.momentum_scale;
        self.kinetic += o.kinetic;
        self.internal += o.internal;
        self.stored += o.stored;
        self
    }
}

impl<const D: usize, M: Composition<D>> Pcmm<D, M> {
    /// Sums over all particles and elements.
    pub fn totals(&self) -> Totals {
        let mut sum = Totals::default();
        for p in &self.particles {
            let (mut x, mut v) = ([0.0; 3], [0.0; 3]);
            x[..D].copy_from_slice(&p.position);
            v[..D].copy_from_slice(&p.velocity);
            let square: f64 = v.iter().map(|c| c * c).sum();
            sum.mass += p.mass;
            sum.kinetic += 0.5 * p.mass * square;
            sum.momentum_scale += p.mass * square.sqrt();
            for d in 0..3 {
                let (i, j) = ((d + 1) % 3, (d + 2) % 3);
                sum.momentum[d] += p.mass * v[d];
                sum.angular_momentum[d] += p.mass * (x[i] * v[j] - x[j] * v[i]);
            }
        }
        let mut state = vec![0.0; self.virgin.len()];
        for (e, nodes) in self.elements.nodes.chunks_exact(D + 1).enumerate() {
            self.elements.read(e, &mut state);
            let reference = self.elements.reference[e];
            sum.covered += self.material.density() * reference;
            sum.volume += volume(&corners(&self.particles, nodes), M::Embedding::HOOP);
            sum.internal += reference * self.energy_of(&state);
        }
        sum.stored = self.stored()[1];
        sum.internal += sum.stored;
        sum
    }

    /// The numbers of the state of element `e`, named by [`Pcmm::state_names`]; `None` if there is none.
    pub fn element_state(&self, e: usize) -> Option<Vec<f64>> {
        if e >= self.elements.len() {
            return None;
        }
        let mut numbers = vec![0.0; self.virgin.len()];
        self.elements.read(e, &mut numbers);
        Some(numbers)
    }

    /// What the law says of element `e`: stress, volume ratio, wave speed, energy; `None` if there is none.
    pub fn describe_element(&self, e: usize) -> Option<Described<f64>> {
        self.material.describe_point(&self.element_state(e)?)
    }

    /// The numbers that the states hold, at each particle: the mean over its elements, weighted by mass, or what it had
    /// last. Named by [`Pcmm::state_names`].
    pub fn particle_states(&mut self) -> Vec<&[f64]> {
        for n in 0..self.particles.len() {
            self.remember_at(n);
        }
        self.memory.chunks_exact(self.virgin.len().max(1)).collect()
    }

    /// Names of the numbers of a state.
    pub fn state_names(&self) -> Vec<String> {
        self.material.state_names()
    }

    /// This instant for pictures and files: positions, velocity, stress (tensor), pressure, and every other number of
    /// the law's state as means at the particles.
    ///
    /// # Errors
    /// A law with names that cannot be written.
    pub fn snapshot(&mut self) -> Result<Snapshot, OutputError> {
        let wide = |x: &[f64; D]| {
            let mut y = [0.0; 3];
            y[..D].copy_from_slice(x);
            y
        };
        let positions = self.particles.iter().map(|p| wide(&p.position)).collect();
        let velocities = self.particles.iter().map(|p| wide(&p.velocity)).collect();
        let sizes = self.particles.iter().map(|p| 2.0 * p.radius).collect();
        let mut snapshot = Snapshot::new(D, self.time, self.steps, positions, ParticleSize::Each(sizes))?
            .with_vector("velocity", velocities)?;
        let names = self.state_names();
        let law = self.material.clone();
        let states = self.particle_states();
        let stress: Vec<[f64; 6]> =
            states.iter().map(|s| law.describe_point(s).map_or([f64::NAN; 6], |said| said.stress)).collect();
        let pressure = stress.iter().map(|s| -(s[0] + s[1] + s[2]) / 3.0).collect();
        for (k, name) in names.iter().enumerate() {
            if !name.starts_with("stress_") {
                snapshot = snapshot.with_scalar(name.clone(), states.iter().map(|s| s[k]).collect())?;
            }
        }
        snapshot.with_scalar("pressure", pressure)?.with_tensor("stress", stress)
    }
}
