//! Operations between the steps of a scene.

use super::operations::StepEnd;
use crate::step::mpm::Mpm;
use impactite_simd::Float;

impl<const D: usize, T: Float> Mpm<D, T> {
    /// Apply filters, kinetic damping and merging where due.
    pub(in crate::step) fn apply_between_steps(&mut self) {
        let anew = self.between_steps.apply(StepEnd {
            bodies: &mut self.scene.bodies,
            team: &self.team,
            steps: self.clock.steps,
            ledger: &mut self.ledger,
        });
        self.stepper.mapped &= !anew;
    }
}
