//! Scene of the cantilever, and its run.

use std::path::Path;
use std::sync::Arc;

use clap::ValueEnum;
use examples::fragile::{Fragile, Joint};
use examples::{CaseError, Restart, Totals};
use fpm::{Composition, Fpm, Method};
use mpm_core::observe::{HistoryCsv, Ledger, Observer, Pace, Progress, RunView, VtkSeries};
use mpm_core::output::Snapshot;
use mpm_core::{PlaneStrain, RunError, Solver, Team};
use mpm_materials::{IntoMaterial, LinearElastic, Moduli, PlaneStress};

/// Length and height, m.
pub const LENGTH: f64 = 48.0;
pub const HEIGHT: f64 = 12.0;
/// Length over height.
pub const SLENDER: usize = 4;
/// Young's modulus, Pa, and density, kg/m^3.
const YOUNG: f64 = 30e6;
const DENSITY: f64 = 1.0;
/// Shear traction at the end, Pa, downwards, and its duration, s.
pub const SHEAR: f64 = 100.0;
pub const PULSE: f64 = 0.5;
/// Time of the first minimum of the tip, s.
pub const LOWEST: f64 = 0.1115;
/// Points of the stress history, m from the middle of the clamped end: beside it, halfway between middle and surface.
pub const BESIDE: f64 = 0.5;
pub const QUARTER: f64 = 0.25 * HEIGHT;
/// Time between two entries of a history, s.
const HISTORY: f64 = 5e-4;

/// What plane.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Plane {
    /// No stress across, as in the paper
    Stress,
    /// No strain across
    Strain,
}

/// Poisson's ratio and plane state of the beam.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Beam {
    pub poisson: f64,
    pub plane: Plane,
}

impl Beam {
    /// Pass the law of the beam to a function of any law.
    pub fn with_law<T>(self, mut to: impl FnMut(Law) -> Result<T, CaseError>) -> Result<T, CaseError> {
        let law = LinearElastic::new(DENSITY, Moduli::young_poisson(YOUNG, self.poisson)?)?;
        to(match self.plane {
            Plane::Stress => Law::Stress(PlaneStress::new(law)),
            Plane::Strain => Law::Strain(law),
        })
    }
}

/// Law of the beam.
pub enum Law {
    Stress(PlaneStress<LinearElastic<f64>>),
    Strain(LinearElastic<f64>),
}

/// Parameters of a run.
#[derive(Clone, Copy, Debug)]
pub struct Setup {
    pub joint: Joint,
    pub fragile: Fragile,
    pub beam: Beam,
    /// Cells through the height.
    pub cells: usize,
    /// End of the run, s.
    pub end: f64,
    pub threads: usize,
}

/// Entry of the history.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Entry {
    pub time: f64,
    /// Displacement of the middle of the end, m.
    pub tip: f64,
    /// Axial stress beside the clamped end, above and below, Pa.
    pub stress: [f64; 2],
}

/// Result of a run.
#[derive(Clone, Debug)]
pub struct Outcome {
    pub setup: Setup,
    /// Description of the method.
    pub method: String,
    pub history: Vec<Entry>,
    /// Snapshot at the first minimum of the tip.
    pub frame: Snapshot,
    /// Time reached, s.
    pub time: f64,
    /// Error that stopped the run, if any.
    pub broke: Option<String>,
    pub totals: Totals,
}

/// Output folder, ParaView frames and checkpoints.
#[derive(Clone, Copy, Debug)]
pub struct Files<'a> {
    pub folder: &'a Path,
    pub frames: u32,
    pub restart: &'a Restart,
}

/// Run the cantilever.
pub fn swing(setup: &Setup, files: Files) -> Result<Outcome, CaseError> {
    let penalty = setup.fragile.penalty()?;
    let printed = Method::printed(PlaneStrain).with_penalty(penalty);
    let symmetric = Method::symmetric(PlaneStrain).with_penalty(penalty);
    setup.beam.with_law(|law| match (setup.joint, law) {
        (Joint::Incomplete, Law::Stress(law)) => run(setup, printed, law, files),
        (Joint::Incomplete, Law::Strain(law)) => run(setup, printed, law, files),
        (Joint::Symmetric, Law::Stress(law)) => run(setup, symmetric, law, files),
        (Joint::Symmetric, Law::Strain(law)) => run(setup, symmetric, law, files),
    })
}

/// Return the `count` cells nearest to a position, in order of distance.
fn nearest<M: Composition<2>>(beam: &Fpm<2, M>, to: [f64; 2], count: usize) -> Vec<usize> {
    let off = |i: &usize| beam.reference()[*i].iter().zip(to).map(|(x, y)| (x - y).powi(2)).sum::<f64>();
    let mut all: Vec<usize> = (0..beam.reference().len()).collect();
    all.sort_by(|a, b| off(a).total_cmp(&off(b)));
    all.truncate(count);
    all
}

fn run<M: Composition<2>>(
    setup: &Setup,
    method: M,
    law: impl IntoMaterial<f64>,
    files: Files,
) -> Result<Outcome, CaseError> {
    let (low, high) = ([0.0, -0.5 * HEIGHT], [LENGTH, 0.5 * HEIGHT]);
    let cells = setup.fragile.cells(low, high, [SLENDER * setup.cells, setup.cells])?;
    let mut beam = Fpm::new(method, law, &cells, |_| [0.0; 2])?.named("beam");
    beam.hold_faces(|f| f.normal[0] < -0.5, Arc::new(|_| [Some(0.0); 2]))?;
    beam.load_faces(|f| f.normal[0] > 0.5, Arc::new(|t| [0.0, if t <= PULSE { -SHEAR } else { 0.0 }]))?;
    beam.set_team(Team::new(setup.threads)?);
    let tip = nearest(&beam, [LENGTH, 0.0], 2);
    // Stress is the mean of the two cells around the point.
    let root = [QUARTER, -QUARTER].map(|y| nearest(&beam, [BESIDE, y], 2));
    let columns = [
        ("time", "s"),
        ("displacement of the tip", "m"),
        ("stress above", "Pa"),
        ("stress below", "Pa"),
        ("kinetic energy", "J"),
        ("internal energy", "J"),
        ("work of the load", "J"),
    ];
    let name = setup.joint.name();
    let path = files.folder.join(format!("history_{name}.csv"));
    let mut history = HistoryCsv::create(path, columns, Pace::interval(HISTORY)?, |now: &RunView<'_>| {
        let beam = now.solver_as::<Fpm<2, M>>()?;
        let mean = |cells: &[usize], of: &dyn Fn(usize) -> f64| {
            cells.iter().map(|&i| of(i)).sum::<f64>() / cells.len() as f64
        };
        let [above, below] =
            [0, 1].map(|side: usize| mean(&root[side], &|i| beam.nominal_stresses()[i][0][0]));
        let tip = mean(&tip, &|i| beam.displacement_at(i, [LENGTH, 0.0])[1]);
        let totals = now.totals();
        Ok(vec![now.time(), tip, above, below, totals.kinetic, totals.internal, now.exchange().work])
    })?;
    let mut ledger = Ledger::new(Pace::interval(HISTORY)?);
    let mut progress = Progress::new(format!("{name:<12}"));
    let mut series = None;
    if files.frames > 0 {
        let pace = Pace::interval(setup.end / f64::from(files.frames))?;
        series = Some(VtkSeries::create(files.folder.join("paraview"), name, pace)?);
    }
    let mut simulation = files.restart.scene(name)?;
    let mut broke = None;
    for end in [LOWEST, setup.end] {
        let mut observers: Vec<&mut dyn Observer> = vec![&mut history, &mut ledger, &mut progress];
        observers.extend(series.iter_mut().map(|s| s as &mut dyn Observer));
        match simulation.until(&mut beam, observers, end) {
            Ok(()) => {}
            // A step that fails is a result.
            Err(RunError::Step(error)) => broke = Some(error.to_string()),
            Err(error) => return Err(error.into()),
        }
        if end == LOWEST || broke.is_some() {
            simulation.keep(|| beam.snapshot())?;
        }
        if broke.is_some() {
            break;
        }
    }
    let entry = |row: &Vec<f64>| match row[..] {
        [time, tip, above, below, ..] => Some(Entry { time, tip, stress: [above, below] }),
        _ => None,
    };
    let frame = simulation.snapshots().first().cloned();
    Ok(Outcome {
        setup: *setup,
        method: beam.describe(),
        history: history.rows().iter().filter_map(entry).collect(),
        frame: frame.ok_or_else(|| CaseError::Other("no snapshot was taken".into()))?,
        time: beam.time(),
        broke,
        totals: Totals::of(&beam, &simulation.summary(), &ledger),
    })
}
