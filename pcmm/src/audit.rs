//! Audit of revisions, and coverage of particles by elements.

use impactite_scene::{Archive, CheckpointError};

use crate::tessellation::Flaw;

/// Totals of the elements removed or created by revisions.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Lot {
    /// Number of elements.
    pub elements: u64,
    /// Volume of the elements, m^3 (per metre of depth, or per radian).
    pub volume: f64,
    /// Mass of the elements (reference density times reference volume), kg. The inertial mass is that of the particles, which revisions do
    /// not change.
    pub mass: f64,
    /// Internal energy of the elements, J.
    pub energy: f64,
}

/// Audit of revisions. Masses and velocities of particles do not change, nor do momentum and kinetic energy.
///
/// Material that loses its element is kept: particles store, as heat, the part of a deleted element that no new element inherited, until
/// new elements take it up. Only the excess of a new element over this store is added.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Audit {
    /// Number of revisions with changes.
    pub revisions: u64,
    /// Deleted elements.
    pub removed: Lot,
    /// Created elements.
    pub created: Lot,
    /// Mass stored outside elements, kg.
    pub stored_mass: f64,
    /// Internal energy stored outside elements, J.
    pub stored_energy: f64,
    /// Deleted elements by failed condition: contact, small angle, large angle, short edge (see [`Flaw`]). Elements replaced by better ones
    /// are not counted.
    pub flaws: [u64; Flaw::COUNT],
}

impl Audit {
    /// Internal energy that revisions added without a source, J.
    pub fn energy_added(&self) -> f64 {
        self.created.energy - self.removed.energy + self.stored_energy
    }
    /// Mass of elements that revisions added without a source, kg.
    pub fn mass_added(&self) -> f64 {
        self.created.mass - self.removed.mass + self.stored_mass
    }
}

/// Coverage of the particles by elements: per metre of depth in plane strain, per radian around an axis.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Coverage {
    /// Mass of the elements, kg: less than that of the particles for uncovered material, more for material covered twice.
    pub mass: f64,
    /// Volume of the elements, m^3.
    pub volume: f64,
    /// Internal energy stored at particles ([`Audit`]), J; a part of the body's.
    pub stored: f64,
}

impl Coverage {
    /// Return the sum of two bodies.
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
    /// Return the sum of two bodies.
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
