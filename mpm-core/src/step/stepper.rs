//! What a run knows of its steps.

use std::time::Duration;

use super::bodies::body::BodyTrouble;
use super::bodies::load::Loading;
use super::rigid::planes::PlanePush;
use impactite_scene::TimeControl;
use impactite_simd::Float;

/// The time step, and what the passes over particles came to.
pub(super) struct Stepper<T, const D: usize> {
    pub(super) control: TimeControl,
    /// The last Gershgorin rate, 1/s, and the step it was found at.
    pub(super) gershgorin: Option<(u64, f64)>,
    /// The step that impulses on the grid are for, s.
    pub(super) planned: T,
    /// Largest (c + |v|) / h of the particles, 1/s.
    pub(super) rate: T,
    /// The body that it is of.
    pub(super) fastest: usize,
    /// Do the tiles hold the map of the particles as they stand?
    pub(super) mapped: bool,
    /// The surface loads on the grid.
    pub(super) acting: Loading,
    /// What the bodies' last pass came to, and whether their blocks changed after it.
    pub(super) passed: Vec<Result<T, BodyTrouble>>,
    pub(super) changed: Vec<bool>,
    /// What planes gave to free rigid bodies in this step.
    pub(super) plane_pushes: Vec<PlanePush<D>>,
    /// Time spent at particles so far.
    pub(super) at_particles: Duration,
}

impl<T: Float, const D: usize> Stepper<T, D> {
    /// Before the first step.
    pub(super) fn new(control: TimeControl) -> Self {
        Stepper {
            control,
            gershgorin: None,
            planned: T::default(),
            rate: T::default(),
            fastest: 0,
            mapped: false,
            acting: Loading::default(),
            passed: Vec::new(),
            changed: Vec::new(),
            plane_pushes: Vec::new(),
            at_particles: Duration::ZERO,
        }
    }
}
