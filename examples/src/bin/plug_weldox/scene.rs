//! Scene of a shot.

use std::path::Path;

use examples::{CaseError, Restart, Totals};
use mpm_contact::{Coulomb, Pairs, SurfaceDistance};
use mpm_core::observe::{Ledger, Observer, Pace, Progress, VtkSeries};
use mpm_core::output::Snapshot;
use mpm_core::{Axisymmetric, Boundary, Side, Solver, Team};
use sph::{Composition, GradientCorrection, Method, TotalLagrangian, WendlandC2, ZeroEnergyPenalty};

use crate::setup::{Form, Setup};
use crate::track::{Row, Scene, Track};

/// Times of the pictures, s; the last one is the end.
const MOMENTS: [f64; 3] = [20e-6, 40e-6, 80e-6];
/// Stretch at which the reference configuration of the plate is updated, in that form.
const RENEWED: f64 = 1.05;
/// Interval between two rows of a history, s.
const HISTORY: f64 = 1e-6;

/// Results of a shot.
#[derive(Clone, Debug)]
pub struct Outcome {
    pub setup: Setup,
    pub rows: Vec<Row>,
    pub frames: Vec<Snapshot>,
    /// Mass of the particles over that of projectile and plate.
    pub mass: f64,
    /// Numbers of particles of projectile and plate.
    pub particles: [usize; 2],
    /// Descriptions of the methods.
    pub method: String,
    pub totals: Totals,
}

impl Outcome {
    /// Return the last row.
    pub fn last(&self) -> Row {
        self.rows.last().copied().unwrap_or_default()
    }
    /// Return the time from which plug and rim are disconnected, s.
    pub fn free_from(&self) -> Option<f64> {
        let tied = self.rows.iter().rposition(|row| !row.free).map_or(0, |n| n + 1);
        self.rows.get(tied).map(|row| row.time)
    }
}

/// Run a shot; ParaView files are written to a folder, if requested.
pub fn shoot(setup: &Setup, frames: u32, folder: &Path, restart: &Restart) -> Result<Outcome, CaseError> {
    let whole = Method::total_lagrangian(Axisymmetric);
    match setup.form {
        Form::Printed => {
            let method = Method::printed(Axisymmetric);
            fly(setup, scene(setup, method, method)?, frames, folder, restart)
        }
        Form::Updated => {
            let plate = Method::updated(Axisymmetric);
            fly(setup, scene(setup, whole, plate)?, frames, folder, restart)
        }
        Form::Renewed => {
            let form =
                TotalLagrangian::renewed(RENEWED).map_err(|error| CaseError::Other(error.to_string()))?;
            let (kernel, penalty) = (WendlandC2::default(), ZeroEnergyPenalty::default());
            let plate = Method::new(Axisymmetric, kernel, form, GradientCorrection, penalty);
            fly(setup, scene(setup, whole, plate)?, frames, folder, restart)
        }
    }
}

fn scene<P: Composition<2>, Q: Composition<2>>(
    setup: &Setup,
    projectile: P,
    plate: Q,
) -> Result<Scene, CaseError> {
    let laws = Pairs::new(Coulomb::new(setup.friction)?);
    let mut scene = Scene::new(SurfaceDistance::default(), laws);
    scene.add("projectile", setup.flying(projectile)?);
    let mut plate = setup.resting(plate)?;
    plate.bound(Boundary::Fixed { axis: 0, at: setup.rim(), side: Side::Below })?;
    scene.add("plate", plate);
    scene.set_team(Team::new(setup.threads)?);
    Ok(scene)
}

fn fly(
    setup: &Setup,
    mut scene: Scene,
    frames: u32,
    folder: &Path,
    restart: &Restart,
) -> Result<Outcome, CaseError> {
    let name = setup.name();
    let particles = [0, 1].map(|b| scene.body(b).map_or(0, |body| body.len()));
    let mass = scene.totals().mass / setup.masses().iter().sum::<f64>();
    let mut track = Track::new(setup, setup.plate()?, HISTORY)?;
    let mut ledger = Ledger::new(Pace::interval(HISTORY)?);
    let mut progress = Progress::new(name);
    let mut series = None;
    if frames > 0 {
        let pace = Pace::interval(setup.end / f64::from(frames))?;
        series = Some(VtkSeries::create(folder.join("paraview"), name, pace)?);
    }
    let mut simulation = restart.scene(name)?;
    for end in MOMENTS.into_iter().filter(|t| *t < setup.end).chain([setup.end]) {
        let mut observers: Vec<&mut dyn Observer> = vec![&mut track, &mut ledger, &mut progress];
        observers.extend(series.iter_mut().map(|s| s as &mut dyn Observer));
        simulation.until(&mut scene, observers, end)?;
        simulation.keep(|| scene.snapshot())?;
    }
    let totals = Totals::of(&scene, &simulation.summary(), &ledger);
    let method = scene.method();
    let frames = simulation.into_snapshots();
    Ok(Outcome { setup: *setup, rows: track.rows, frames, mass, particles, method, totals })
}
