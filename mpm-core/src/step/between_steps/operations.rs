//! Operations on particles between steps: a list, each applied to the bodies at the end of a step.

use super::rest::KineticDamping;
use crate::step::bodies::body::GridBody;
use impactite_scene::Exchange;
use impactite_simd::{Float, Team};

/// Bodies at the end of a step.
pub(in crate::step) struct StepEnd<'a, T: Float, const D: usize> {
    pub(in crate::step) bodies: &'a mut [Box<dyn GridBody<T, D>>],
    pub(in crate::step) team: &'a Team,
    /// Number of steps made.
    pub(in crate::step) steps: u64,
    /// Book of the momentum and energy that operations add or remove.
    pub(in crate::step) ledger: &'a mut Exchange,
}

/// Operation on particles between steps.
pub(in crate::step) trait StepOperation<T: Float, const D: usize> {
    /// Apply the operation, if due. Return true if the particles must be mapped again.
    fn apply(&mut self, end: &mut StepEnd<'_, T, D>) -> bool;
}

/// Enabled operations of a scene. Splitting is not in the list: it is done where particles are moved ([`super::splitting`]).
#[derive(Default)]
pub(in crate::step) struct BetweenSteps {
    pub(in crate::step) filter: Option<NullSpaceFilter>,
    pub(in crate::step) kinetic_damping: Option<KineticDamping>,
}

impl BetweenSteps {
    /// Apply all operations that are due, in this order. Return true if the particles must be mapped again.
    pub(in crate::step) fn apply<T: Float, const D: usize>(&mut self, mut end: StepEnd<'_, T, D>) -> bool {
        let list: [Option<&mut dyn StepOperation<T, D>>; 3] = [
            self.filter.as_mut().map(|filter| filter as _),
            self.kinetic_damping.as_mut().map(|damping| damping as _),
            Some(&mut Merge),
        ];
        list.into_iter().flatten().fold(false, |anew, operation| operation.apply(&mut end) | anew)
    }
}

/// Null-space filter after every `every` steps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::step) struct NullSpaceFilter {
    pub(in crate::step) every: u64,
}

impl<T: Float, const D: usize> StepOperation<T, D> for NullSpaceFilter {
    /// Apply the filter. Nodal values are unchanged, and so is the map.
    fn apply(&mut self, end: &mut StepEnd<'_, T, D>) -> bool {
        if end.steps.is_multiple_of(self.every) {
            let bodies = end.bodies.iter_mut();
            let lost: f64 = bodies.filter_map(|body| Some(body.free_velocities()?.filter(end.team))).sum();
            end.ledger.damping += lost;
        }
        false
    }
}

/// Relative decrease of the kinetic energy at which its peak has passed: a step or two later. Without it rounding
/// would cause stops of motion that nodes hardly resolve and transfer to the particles only slowly.
const PAST: f64 = 1e-3;

impl<T: Float, const D: usize> StepOperation<T, D> for KineticDamping {
    fn apply(&mut self, end: &mut StepEnd<'_, T, D>) -> bool {
        if self.now >= self.most * (1.0 - PAST) {
            self.most = self.most.max(self.now);
            return false;
        }
        for body in end.bodies.iter_mut() {
            let Some(velocities) = body.free_velocities() else { continue };
            let taken = velocities.stop_motion();
            for d in 0..3 {
                end.ledger.load[d] -= taken.momentum[d];
            }
            end.ledger.damping += taken.kinetic;
        }
        *self = KineticDamping { most: 0.0, now: 0.0, stops: self.stops + 1 };
        true
    }
}

/// Merging of the particles of bodies that enable it.
struct Merge;

impl<T: Float, const D: usize> StepOperation<T, D> for Merge {
    fn apply(&mut self, end: &mut StepEnd<'_, T, D>) -> bool {
        let mut any = false;
        for body in end.bodies.iter_mut() {
            any |= body.division_mut().is_some_and(|body| body.merge(end.steps, end.team));
        }
        any
    }
}
