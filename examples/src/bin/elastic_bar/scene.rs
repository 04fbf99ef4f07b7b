//! Scene of bar and wall, and its run.

use std::path::Path;

use clap::ValueEnum;
use examples::{CaseError, Restart, Totals};
use mpm_core::geometry::{Cuboid, Lattice};
use mpm_core::observe::{HistoryCsv, Ledger, Observer, Pace, Progress, RunView, VtkSeries};
use mpm_core::{Boundary, PlaneStrain, Side, Team};
use mpm_materials::{Constitutive, Elastic, IntoMaterial, LogarithmicBulk, Moduli, Solid};
use pcmm::{AzimuthFan, Composition, LocalDelaunay, Masses, Method, NoRotation, Packing, Pcmm};
use serde::Serialize;

/// Width of the bar, m.
pub const WIDTH: f64 = 1.0e-3;
/// Length, m.
pub const LENGTH: f64 = 20.0e-3;
/// Impact speed, m/s.
pub const SPEED: f64 = 50.0;
/// End of the run, s; the bar leaves the wall at 7.45 us.
pub const END: f64 = 9.0e-6;
const DENSITY: f64 = 7850.0;
const YOUNG: f64 = 206e9;
/// Poisson's ratio.
pub const POISSON: f64 = 0.3;
/// Linear and quadratic coefficient of the bulk viscosity \[M\]; the paper states none.
const BULK_VISCOSITY: [f64; 2] = [0.06, 1.5];
/// Time between two entries of a history, s.
const HISTORY: f64 = 0.02e-6;

/// Longitudinal wave speed in a strip with free sides in plane strain, sqrt(E / (1 - nu^2) rho), m/s.
pub fn wave_speed() -> f64 {
    (YOUNG / ((1.0 - POISSON * POISSON) * DENSITY)).sqrt()
}

/// Which parts.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Which {
    /// The paper's: fans, every square covered twice, no rotation of stress
    Printed,
    /// Ours: local Delaunay, averaged volumes
    Consistent,
    /// Ours, on a bar of a fifth of the width: less lateral inertia
    Narrow,
}

impl Which {
    /// Name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Which::Printed => "printed",
            Which::Consistent => "consistent",
            Which::Narrow => "narrow",
        }
    }
    /// Width of the bar, m.
    pub fn width(self) -> f64 {
        if self == Which::Narrow { 0.2 * WIDTH } else { WIDTH }
    }
}

/// Parameters of a run.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Setup {
    pub which: Which,
    /// Number of particles across the width, less one.
    pub cells: u32,
    /// Impact speed, m/s.
    pub speed: f64,
    pub threads: usize,
}

/// Entry of the history.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Entry {
    pub time: f64,
    /// Mean velocity towards the wall at half the length, m/s.
    pub middle: f64,
    /// Kinetic energy over that at the start.
    pub kinetic: f64,
    /// Internal energy over the kinetic energy at the start.
    pub internal: f64,
    /// Energy of the particles stopped by the wall, over the kinetic energy at the start.
    pub lost: f64,
}

/// Result of a run.
#[derive(Clone, Debug)]
pub struct Outcome {
    pub setup: Setup,
    pub history: Vec<Entry>,
    pub totals: Totals,
    /// Mass of the particles over that of the bar.
    pub mass: f64,
    pub deleted: u64,
}

/// Run the impact.
pub fn impact(setup: &Setup, folder: &Path, frames: u32, restart: &Restart) -> Result<Outcome, CaseError> {
    let h = setup.which.width() / f64::from(setup.cells);
    // Particles are in contact along the diagonals of the lattice: 0.414 h and a little more.
    let tolerance = 0.45 * h;
    let moduli = Moduli::young_poisson(YOUNG, POISSON)?;
    let [linear, quadratic] = BULK_VISCOSITY;
    let steel = Solid::new(Elastic::new(moduli.shear)?, LogarithmicBulk::new(DENSITY, moduli.bulk)?)
        .with_bulk_viscosity(linear, quadratic)?;
    match setup.which {
        Which::Printed => {
            let method = Method::printed(PlaneStrain, AzimuthFan::new(tolerance)?);
            run(setup, method, steel.with_rate(NoRotation).compiled(), folder, frames, restart)
        }
        Which::Consistent | Which::Narrow => {
            let method = Method::consistent(PlaneStrain, LocalDelaunay::new(tolerance, 2.0)?);
            run(setup, method, steel, folder, frames, restart)
        }
    }
}

fn run<M: Composition<2>>(
    setup: &Setup,
    method: M,
    law: impl IntoMaterial<f64>,
    folder: &Path,
    frames: u32,
    restart: &Restart,
) -> Result<Outcome, CaseError> {
    let h = setup.which.width() / f64::from(setup.cells);
    let shape = Cuboid::new([0.0; 2], [setup.which.width(), LENGTH])?;
    let packing = Packing::on_nodes(&shape, &Lattice::new([0.0; 2], h)?)?;
    let mut bar = Pcmm::new(method, law, &packing, |_| [0.0, -setup.speed], Masses::FromElements)?;
    bar.bound(Boundary::Wall { axis: 1, at: 0.0, side: Side::Above, velocity: 0.0 })?;
    bar.set_team(Team::new(setup.threads)?);

    let middle: Vec<usize> = (0..packing.positions.len())
        .filter(|&n| (packing.positions[n][1] - 0.5 * LENGTH).abs() < 0.5 * h)
        .collect();
    let name = setup.which.name();
    let columns = [
        ("time", "s"),
        ("middle velocity towards the wall", "m/s"),
        ("kinetic energy", "-"),
        ("internal energy", "-"),
        ("stopped by the wall", "-"),
    ];
    let start = bar.totals();
    let path = folder.join(format!("history_{name}.csv"));
    let mut history = HistoryCsv::create(path, columns, Pace::interval(HISTORY)?, |now: &RunView<'_>| {
        let particles = now.solver_as::<Pcmm<2, M>>()?.particles();
        let velocities = middle.iter().map(|&n| -particles[n].velocity[1]);
        Ok(vec![
            now.time(),
            velocities.sum::<f64>() / middle.len() as f64,
            now.totals().kinetic / start.kinetic,
            now.totals().internal / start.kinetic,
            now.exchange().impacts / start.kinetic,
        ])
    })?;
    let mut ledger = Ledger::new(Pace::interval(HISTORY)?);
    let mut progress = Progress::new(format!("{name:<12}"));
    let mut series = None;
    if frames > 0 {
        let pace = Pace::interval(END / f64::from(frames))?;
        series = Some(VtkSeries::create(folder.join("paraview"), name, pace)?);
    }
    let mut observers: Vec<&mut dyn Observer> = vec![&mut history, &mut ledger, &mut progress];
    observers.extend(series.iter_mut().map(|s| s as &mut dyn Observer));
    let mut simulation = restart.scene(name)?;
    simulation.until(&mut bar, observers, END)?;
    let totals = Totals::of(&bar, &simulation.summary(), &ledger);
    let entry = |row: &Vec<f64>| match row[..] {
        [time, middle, kinetic, internal, lost] => Some(Entry { time, middle, kinetic, internal, lost }),
        _ => None,
    };
    let history = history.rows().iter().filter_map(entry).collect();
    let mass = start.mass / (DENSITY * setup.which.width() * LENGTH);
    let deleted = bar.audit().removed.elements;
    Ok(Outcome { setup: *setup, history, totals, mass, deleted })
}
