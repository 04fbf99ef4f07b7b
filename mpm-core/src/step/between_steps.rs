//! What is done between steps.

use super::solver::Mpm;
use crate::parallel::Float;

impl<const D: usize, T: Float> Mpm<D, T> {
    /// What is done to particles between steps: filtered, stopped, merged.
    pub(super) fn apply_between_step_operations(&mut self) {
        self.filter();
        self.stop_motion();
        for body in &mut self.bodies {
            if body.division_mut().is_some_and(|body| body.merge(self.clock.steps, &self.team)) {
                self.mapped = false;
            }
        }
    }
}
