//! State of the time integration.

use std::time::Duration;

use super::bodies::body::{BodyTrouble, GridBody};
use super::bodies::load::Loading;
use super::rigid::planes::PlanePush;
use impactite_scene::TimeControl;
use impactite_simd::{Float, Team};

/// Iterations for the affine velocity field of particles at the start of a run. Each gathers the field from the nodes
/// and reduces the remaining error by more than half.
const REFITS: usize = 8;

/// Wall-clock times of stages so far.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Spent {
    /// Passes over particles, and sorting them into bins.
    pub(super) particles: Duration,
    /// Contact between bodies at nodes.
    pub(super) contact: Duration,
    /// Arrangement of blocks.
    pub(super) arrangement: Duration,
}

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
    pub(super) spent: Spent,
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
            spent: Spent::default(),
        }
    }
}

/// Run `task` on every body and its entry of `found`: bodies in parallel where that keeps all threads busy, else one
/// after the other, each on all threads.
pub(super) fn each_body<T: Float, const D: usize, X: Send>(
    team: &Team,
    bodies: &mut [Box<dyn GridBody<T, D>>],
    found: &mut [X],
    task: impl Fn(&mut dyn GridBody<T, D>, &mut X) + Send + Sync,
) {
    let threads = team.threads();
    let beside = threads > 1 && bodies.len() >= 2 * threads && {
        let points = || bodies.iter().map(|body| body.len());
        points().max().unwrap_or_default() * threads <= points().sum()
    };
    if beside {
        team.each_piece(bodies, 1, found, |_, body, found| task(&mut *body[0], found));
    } else {
        bodies.iter_mut().zip(found).for_each(|(body, found)| task(&mut **body, found));
    }
}
