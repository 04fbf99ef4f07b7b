//! State of the time integration.

use std::time::Duration;

use super::bodies::body::BodyTrouble;
use super::bodies::load::Loading;
use super::rigid::planes::PlanePush;
use impactite_scene::TimeControl;
use impactite_simd::Float;

/// Iterations for the affine velocity field of particles at the start of a run. Each gathers the field from the nodes
/// and reduces the remaining error by more than half.
const REFITS: usize = 8;

/// Time step, and results of the passes over particles.
pub(super) struct Stepper<T, const D: usize> {
    pub(super) control: TimeControl,
    /// Step number of the last Gershgorin rate, and that rate, 1/s.
    pub(super) gershgorin: Option<(u64, f64)>,
    /// Step size for which impulses are on the grid, s.
    pub(super) planned: T,
    /// Largest (c + |v|) / h of the particles, 1/s.
    pub(super) rate: T,
    /// Index of the body with the largest rate.
    pub(super) fastest: usize,
    /// True if the tiles contain the map of the particles in their present state.
    pub(super) mapped: bool,
    /// Iterations for the affine velocity field at the start of a run.
    pub(super) refits: usize,
    /// Surface loads on the grid.
    pub(super) acting: Loading,
    /// Rates or failures of the bodies in the last pass, and flags of changed blocks after it.
    pub(super) passed: Vec<Result<T, BodyTrouble>>,
    pub(super) changed: Vec<bool>,
    /// Impulses of planes on free rigid bodies in this step.
    pub(super) plane_pushes: Vec<PlanePush<D>>,
    /// Wall-clock time spent at particles so far.
    pub(super) at_particles: Duration,
}

impl<T: Float, const D: usize> Stepper<T, D> {
    /// Create the state before the first step.
    pub(super) fn new(control: TimeControl) -> Self {
        Stepper {
            control,
            gershgorin: None,
            planned: T::default(),
            rate: T::default(),
            fastest: 0,
            mapped: false,
            refits: REFITS,
            acting: Loading::default(),
            passed: Vec::new(),
            changed: Vec::new(),
            plane_pushes: Vec::new(),
            at_particles: Duration::ZERO,
        }
    }
}
