//! Bodies in a checkpoint.

use nalgebra::Matrix3;

use crate::step::between_steps::merging::MergeBook;
use crate::step::between_steps::splitting::SplitBook;
use crate::step::bodies::load::Loading;
use crate::step::bodies::particle_body::ParticleBody;
use crate::step::rigid::motion::{RigidState, Step};
use impactite_scene::{Archive, CheckpointError};
use impactite_simd::Float;

impl<T: Float, const D: usize> ParticleBody<T, D> {
    /// Write or read the particles and their map.
    pub(in crate::step) fn exchange_particles(&mut self, file: &mut Archive) -> Result<(), CheckpointError> {
        self.exchange_rest(file)?;
        let mut count = self.slots.len();
        file.count(&mut count)?;
        if file.reads() {
            self.slots.clear();
            self.spare.clear();
        }
        for s in 0..count {
            if file.reads() {
                self.slots.push(self.empty_slot([0; D]));
            }
            let rests = self.resting.is_some();
            let slot = &mut self.slots[s];
            slot.block.coordinates.iter_mut().try_for_each(|x| file.integer(x))?;
            if file.reads() {
                let mut slots = std::mem::take(&mut self.slots);
                self.set_border(&mut slots[s]);
                self.slots = slots;
            }
            let slot = &mut self.slots[s];
            file.word(&mut slot.linked)?;
            slot.block.exchange(file)?;
            file.word(&mut slot.rows)?;
            if !rests {
                file.numbers(slot.tile.all_mut().iter_mut().flatten())?;
                file.numbers(slot.affine.iter_mut().flatten())?;
            }
        }
        file.word(&mut self.numbered[1])?;
        file.reals(self.loading.numbers_mut())?;
        self.lead.archive(file)?;
        let SplitBook { cuts, kinetic } = &mut self.splits;
        file.word(cuts)?;
        file.real(kinetic)?;
        let MergeBook { merges, removed } = &mut self.merges;
        file.word(merges)?;
        file.word(removed)?;
        if file.reads() {
            self.link_slots();
            self.rest_as_read();
        }
        Ok(())
    }
}

impl<const D: usize> RigidState<D> {
    /// Write or read position and motion.
    pub(in crate::step) fn exchange(&mut self, file: &mut Archive) -> Result<(), CheckpointError> {
        let RigidState {
            prescribed: _,
            held: _,
            mass: _,
            inertia: _,
            surface: _,
            centre,
            rotation,
            velocity,
            angular_momentum,
            spin,
            force,
            step,
            inverse,
        } = self;
        let Step { way, turn, velocity: then, spin: spin_then, per_dt } = step;
        for vector in [centre, velocity, angular_momentum, spin, force, way, then, spin_then] {
            file.reals(vector.iter_mut())?;
        }
        for matrix in [rotation.matrix_mut_unchecked(), turn, inverse] {
            file.reals(matrix.iter_mut())?;
        }
        file.real(per_dt)?;
        if self.is_sound() { Ok(()) } else { Err(file.damaged("a rigid body moves as none can")) }
    }

    /// True if the values are those of a motion.
    fn is_sound(&self) -> bool {
        let Step { way, turn, velocity, spin, per_dt } = &self.step;
        let vectors = [
            &self.centre,
            &self.velocity,
            &self.angular_momentum,
            &self.spin,
            &self.force,
            way,
            velocity,
            spin,
        ];
        let r = self.rotation.matrix();
        let mut numbers = vectors.into_iter().flatten().chain([r, turn, &self.inverse].into_iter().flatten());
        let off = (r.transpose() * r - Matrix3::identity()).amax();
        numbers.all(|x| x.is_finite()) && per_dt.is_finite() && off < 1e-9
    }
}

impl Loading {
    /// Iterate over all values.
    pub(super) fn numbers_mut(&mut self) -> impl Iterator<Item = &mut f64> {
        let Loading { force, power } = self;
        force.iter_mut().chain([power])
    }
}
