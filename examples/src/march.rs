//! The run of a case of the particle-contact method: what the observers of `mpm_core` are to the material point method.

use std::ops::Range;
use std::time::Instant;

use mpm_contact::ContactDetector;
use mpm_core::output::Progress;
use pcmm::{Bodies, BodyError, Composition, Pcmm, StepError};

use crate::{CaseError, Totals, worst};

/// A scene that goes on by steps.
pub trait Steps {
    /// What breaks.
    type Broken: Into<CaseError>;
    /// s.
    fn time(&self) -> f64;
    /// Steps made.
    fn steps(&self) -> u64;
    /// Memory, bytes.
    fn bytes(&self) -> usize;
    /// One step, which ends at `end` (s) if it would go further.
    ///
    /// # Errors
    /// What breaks.
    fn step_towards(&mut self, end: f64) -> Result<(), Self::Broken>;
}

macro_rules! steps {
    ([$($generics:tt)*], $scene:ty, $broken:ty) => {
        impl<$($generics)*> Steps for $scene {
            type Broken = $broken;
            fn time(&self) -> f64 {
                self.time()
            }
            fn steps(&self) -> u64 {
                self.steps()
            }
            fn bytes(&self) -> usize {
                self.bytes()
            }
            fn step_towards(&mut self, end: f64) -> Result<(), $broken> {
                self.step_towards(end)
            }
        }
    };
}
steps!([const D: usize, M: Composition<D>], Pcmm<D, M>, StepError);
steps!([const D: usize, S: ContactDetector<f64, D>], Bodies<D, S>, BodyError);

/// A run from the start of a scene to its end.
#[derive(Clone, Copy, Debug)]
pub struct March<'a> {
    /// Beside the progress bar.
    pub name: &'a str,
    /// Particles of the scene.
    pub particles: usize,
    /// s.
    pub end: f64,
    /// Time between two entries of the history, s.
    pub history: f64,
}

impl March<'_> {
    /// Run, until the end or until a step breaks, which is told beside what was done.
    ///
    /// `entry` writes an entry of the history and gives the errors of energy and momentum. `look` sees the scene after
    /// every step, and at the start, and gives the next moment (s) that a step ends at.
    ///
    /// # Errors
    /// Those of `entry` and `look`.
    pub fn run<S: Steps>(
        &self,
        scene: &mut S,
        mut entry: impl FnMut(&mut S) -> Result<[f64; 2], CaseError>,
        mut look: impl FnMut(&mut S) -> Result<f64, CaseError>,
    ) -> Result<(Totals, Result<(), S::Broken>), CaseError> {
        let mut progress = Progress::new(self.name.to_string());
        let mut totals = Totals { particles: self.particles, ..Totals::default() };
        let (mut entries, mut broken) = (0, Ok(()));
        loop {
            if scene.time() >= (f64::from(entries) * self.history).min(self.end) {
                entries += 1;
                let [energy, momentum] = entry(scene)?;
                totals.energy_error = worst([totals.energy_error, energy]);
                totals.momentum_error = worst([totals.momentum_error, momentum]);
                let pace = totals.updates / totals.wall_seconds.max(1e-9);
                progress.update(scene.time(), self.end, scene.steps(), pace);
            }
            let moment = look(scene)?;
            if broken.is_err() || scene.time() >= self.end {
                break;
            }
            let clock = Instant::now();
            broken = scene.step_towards(moment.min(self.end));
            totals.wall_seconds += clock.elapsed().as_secs_f64();
            totals.updates += self.particles as f64;
        }
        progress.finish();
        totals.steps = scene.steps();
        totals.simulated_seconds = scene.time();
        totals.bytes = scene.bytes();
        Ok((totals, broken))
    }
}

/// Errors of a scene's energy, over the kinetic one at the start, and of its momentum along `axes`: what neither boundaries
/// nor revisions explain.
pub fn errors<const D: usize, M: Composition<D>>(
    scene: &Pcmm<D, M>,
    start: &pcmm::Totals,
    axes: Range<usize>,
) -> [f64; 2] {
    let (now, given) = (scene.totals(), scene.given());
    let explained = given.work + scene.audit().energy_added();
    let energy = (now.kinetic + now.internal - explained) / start.kinetic - 1.0;
    let missing = axes.map(|d| (now.momentum[d] - start.momentum[d] - given.impulse[d]).powi(2));
    [energy, missing.sum::<f64>().sqrt() / start.momentum_scale]
}
