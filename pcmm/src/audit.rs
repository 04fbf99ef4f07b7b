//! What revisions did, and how elements cover particles.

use impactite_scene::{Archive, CheckpointError};

use crate::tessellation::Flaw;

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

/// How the elements cover the particles: per metre of depth in plane strain, per radian around an axis.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Coverage {
    /// Mass of the elements, kg: less than that of the particles where matter is uncovered, more where it is covered twice.
    pub mass: f64,
    /// Volume of the elements, m^3.
    pub volume: f64,
    /// Internal energy that particles hold in store ([`Audit`]), J; a part of the body's.
    pub stored: f64,
}

impl Coverage {
    /// The sum, of two bodies.
    #[must_use]
    pub fn plus(self, o: &Coverage) -> Coverage {
        Coverage { mass: self.mass + o.mass, volume: self.volume + o.volume, stored: self.stored + o.stored }
    }
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

impl Lot {
    fn archive(&mut self, file: &mut Archive) -> Result<(), CheckpointError> {
        file.word(&mut self.elements)?;
        file.reals([&mut self.volume, &mut self.mass, &mut self.energy])
    }
}

impl Audit {
    pub(crate) fn archive(&mut self, file: &mut Archive) -> Result<(), CheckpointError> {
        file.word(&mut self.revisions)?;
        self.removed.archive(file)?;
        self.created.archive(file)?;
        file.reals([&mut self.stored_mass, &mut self.stored_energy])?;
        self.flaws.iter_mut().try_for_each(|flaw| file.word(flaw))
    }
}
