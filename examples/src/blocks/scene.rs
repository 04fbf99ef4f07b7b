//! What the scenes share: an elastic solid, contact with friction, and a run that is watched.

use std::path::Path;

use mpm_contact::Gradients;
use mpm_core::GridContact;
use mpm_core::observe::{Ledger, ObserveError, Observer, Pace, RunView, VtkSeries};
use mpm_core::{Archive, CheckpointError, PointView, Solver, Team};
use mpm_materials::{BulkViscosity, Elastic, HughesWinget, LinearDensity, NoFailure, Solid};

use mpm_contact::AnyDetector;

use crate::{CaseError, Detection, Law, Simulation, Totals};

/// Linear elastic, with bulk viscosity.
pub type Rubber = Solid<Elastic<f64>, LinearDensity<f64>, NoFailure, BulkViscosity<f64>, HughesWinget>;
/// Any test of contact.
pub type Touch = GridContact<AnyDetector, f64>;

/// From density, kg/m^3, Young's modulus, Pa, Poisson's ratio, and the linear coefficient of bulk viscosity.
pub fn rubber(density: f64, young: f64, poisson: f64, viscosity: f64) -> Result<Rubber, CaseError> {
    let bulk = young / (3.0 * (1.0 - 2.0 * poisson));
    let shear = young / (2.0 * (1.0 + poisson));
    let eos = LinearDensity::new(density, (bulk / density).sqrt())?;
    Ok(Solid::new(Elastic::new(shear)?, eos).with_bulk_viscosity(viscosity, 0.0)?)
}

/// How a scene tells that bodies touch, and what they then do: as it is best for the scene, or as it was asked for.
#[derive(Clone, Copy, Debug)]
pub struct Asked {
    /// How contact is detected.
    pub detection: Option<Detection>,
    /// What bodies do where they touch.
    pub law: Option<Law>,
}

impl Asked {
    /// Contact with friction, as is `best` if nothing else was asked for, of bodies with a wave speed, m/s, in cells, m.
    ///
    /// # Errors
    /// A coefficient of friction that is negative.
    pub fn touch(
        self,
        friction: f64,
        best: (Detection, Law),
        [wave, h]: [f64; 2],
    ) -> Result<Touch, CaseError> {
        let detector = self.detection.unwrap_or(best.0).detector(Gradients::default())?;
        Ok(GridContact::new(detector, self.law.unwrap_or(best.1).pairs(friction, wave, h)?))
    }
}

/// What is asked of a scene, and the simulation of a case that it is: without checkpoints if it is none.
pub struct Task {
    /// What is asked.
    pub asked: Asked,
    /// What runs it.
    pub simulation: Simulation,
}

impl Asked {
    /// In this simulation.
    pub fn in_simulation(self, simulation: Simulation) -> Task {
        Task { asked: self, simulation }
    }
}

impl From<Asked> for Task {
    fn from(asked: Asked) -> Self {
        asked.in_simulation(Simulation::alone())
    }
}

/// Speed of pressure waves, m/s, from density, kg/m^3, Young's modulus, Pa, and Poisson's ratio.
pub fn wave(density: f64, young: f64, poisson: f64) -> f64 {
    (young * (1.0 - poisson) / ((1.0 + poisson) * (1.0 - 2.0 * poisson)) / density).sqrt()
}

/// How a run is watched.
#[derive(Clone, Copy, Debug)]
pub struct Watch<'a> {
    /// Seconds between looks; every step if zero.
    pub every: f64,
    /// Threads.
    pub threads: usize,
    /// Folder and name of a ParaView series, if there is to be one.
    pub series: Option<(&'a Path, &'a str)>,
}

impl Watch<'_> {
    /// Look at every step; one thread, for a few hundred particles.
    pub const STEPS: Watch<'static> = Watch { every: 0.0, threads: 1, series: None };
}

/// What is seen of a run.
pub trait Seen {
    /// To a checkpoint, or from one.
    ///
    /// # Errors
    /// The file.
    fn archive(&mut self, file: &mut Archive) -> Result<(), CheckpointError>;
}

/// Run until `end` (s), look now and then, and keep what is `seen`.
///
/// # Errors
/// A step that breaks, files that cannot be written.
pub fn run<S: Seen>(
    solver: &mut (dyn Solver + 'static),
    end: f64,
    watch: Watch<'_>,
    mut simulation: Simulation,
    seen: &mut S,
    look: impl FnMut(&mut S, &RunView<'_>),
) -> Result<Totals, CaseError> {
    solver.set_team(Team::new(watch.threads)?);
    let mut ledger = Ledger::new(Pace::interval(end / 200.0)?);
    let pace = if watch.every > 0.0 { Pace::interval(watch.every)? } else { Pace::every_step() };
    let mut eye = Eye { pace, seen, look };
    let mut observers: Vec<&mut dyn Observer> = vec![&mut ledger, &mut eye];
    let mut series;
    if let Some((folder, name)) = watch.series {
        series = VtkSeries::create(folder.join("paraview"), name, Pace::interval(end / 40.0)?)?;
        observers.push(&mut series);
    }
    simulation.until(solver, observers, end)?;
    Ok(Totals::of(solver, &simulation.summary(), &ledger))
}

struct Eye<'a, S, F> {
    pace: Pace,
    seen: &'a mut S,
    look: F,
}

impl<S: Seen, F: FnMut(&mut S, &RunView<'_>)> Observer for Eye<'_, S, F> {
    fn pace(&mut self) -> &mut Pace {
        &mut self.pace
    }
    fn observe(&mut self, now: &RunView<'_>) -> Result<(), ObserveError> {
        (self.look)(self.seen, now);
        Ok(())
    }
    fn archive(&mut self, file: &mut Archive) -> Result<(), CheckpointError> {
        self.seen.archive(file)
    }
}

/// Velocity of a body's centre of mass, m/s.
pub fn velocity(now: &RunView<'_>, body: usize) -> [f64; 2] {
    let totals = now.bodies().get(body).map(|b| b.totals()).unwrap_or_default();
    [totals.momentum[0] / totals.mass, totals.momentum[1] / totals.mass]
}

/// Mean of something over the particles of all bodies that are in a range of x, m.
pub fn mean(now: &RunView<'_>, range: [f64; 2], read: fn(&PointView) -> f64) -> f64 {
    let (mut sum, mut count) = (0.0, 0.0);
    for body in now.bodies() {
        body.for_each(&mut |p| {
            if (range[0]..range[1]).contains(&p.position[0]) {
                sum += read(p);
                count += 1.0;
            }
        });
    }
    sum / count
}
