//! Scene and run.

use std::path::Path;
use std::sync::Arc;

use clap::ValueEnum;
use examples::{CaseError, Simulation, Totals, methods};
use mpm_core::geometry::{Compose, Cuboid, Cylinder, Filling, Lattice, Seeds, fill};
use mpm_core::observe::{HistoryCsv, Ledger, LedgerEntry, Observer, Pace, Progress, RunView, VtkSeries};
use mpm_core::output::Snapshot;
use mpm_core::{
    Apic, Axisymmetric, BlockGrid, Boundary, CpGimp, Flip, FullSpace, IntoKernels, Kernels, Linear, Method,
    Mpm, Musl, QuadraticBSpline, Side, Solver, Team, Usl,
};
use mpm_materials::{IntoMaterial, JohnsonCook, Material, MieGruneisen, Solid};
use serde::Serialize;

use crate::shape::{Outline, Sizes};

/// Radius of the bar, m.
pub const RADIUS: f64 = 3.8e-3;
/// Length of the bar, m.
pub const LENGTH: f64 = 25.4e-3;
/// Impact speed, m/s.
pub const SPEED: f64 = 190.0;
/// End of the run, s.
pub const END: f64 = 80.0e-6;
/// Interval between two entries of a history, s.
const HISTORY: f64 = 1.0e-6;
/// Linear and quadratic coefficient of the bulk viscosity, as in public decks.
const BULK_VISCOSITY: [f64; 2] = [0.06, 1.5];

/// How the bar lies in space.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Model {
    /// A quarter of the bar in three dimensions, between two planes of symmetry
    #[value(name = "3d")]
    #[serde(rename = "3d")]
    Quarter,
    /// Radius and height
    Axisymmetric,
}

/// The constants of the Johnson-Cook strength.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Constants {
    /// Fitted to these tests: A 157 MPa, B 425 MPa, n 1, no rate, no heat
    Taylor,
    /// The usual ones of OFHC copper: A 90 MPa, B 292 MPa, n 0.31, C 0.025, m 1.09, heating
    Standard,
}

/// Shape function, stress update and transfer.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Scheme {
    /// Trilinear shape functions, MUSL, FLIP
    LinearMusl,
    /// Uniform GIMP, USL, FLIP
    GimpUsl,
    /// GIMP with domains that follow the deformation, USL, FLIP
    CpgimpUsl,
    /// Quadratic B-splines, USL, APIC
    QuadraticApic,
}

macro_rules! names {
    ($($type:ty),*) => {$(
        impl $type {
            /// Return the name on the command line.
            pub fn name(self) -> String {
                self.to_possible_value().map_or(String::new(), |v| v.get_name().to_string())
            }
        }
    )*};
}
names!(Model, Constants, Scheme);

/// Parameters of a run.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Setup {
    pub model: Model,
    pub constants: Constants,
    pub scheme: Scheme,
    /// Cells per radius; two particles per cell along each axis.
    pub cells: u32,
    pub threads: usize,
}

impl Setup {
    /// Return the name in file names.
    pub fn name(&self) -> String {
        format!("{}_{}", self.model.name(), self.constants.name())
    }
    /// Cell size, m.
    pub fn spacing(&self) -> f64 {
        RADIUS / f64::from(self.cells)
    }
    /// Return the number of copies of the model in the whole bar.
    pub fn copies(&self) -> f64 {
        match self.model {
            Model::Quarter => 4.0,
            Model::Axisymmetric => std::f64::consts::TAU,
        }
    }
}

/// Output of a run.
#[derive(Clone, Copy, Debug)]
pub struct Files<'a> {
    pub folder: &'a Path,
    /// Number of ParaView frames; 0 for none.
    pub frames: u32,
}

/// Results of a run.
#[derive(Clone, Debug)]
pub struct Outcome {
    pub setup: Setup,
    pub sizes: Sizes,
    pub outline: Outline,
    pub ledger: Vec<LedgerEntry>,
    pub snapshot: Snapshot,
    pub totals: Totals,
}

/// Run the impact of the bar on the wall.
pub fn impact(setup: &Setup, files: Option<Files>, simulation: Simulation) -> Result<Outcome, CaseError> {
    with_scheme(setup, Task::Impact(files), simulation)
}

/// Run a free flight of the whole bar with stretching and spin, without a wall, in three dimensions or axisymmetric (without spin). Return
/// the momentum error.
pub fn free_flight(setup: &Setup, simulation: Simulation) -> Result<f64, CaseError> {
    Ok(with_scheme(setup, Task::FreeFlight, simulation)?.totals.momentum_error)
}

#[derive(Clone, Copy)]
enum Task<'a> {
    Impact(Option<Files<'a>>),
    FreeFlight,
}

fn with_scheme(setup: &Setup, task: Task, simulation: Simulation) -> Result<Outcome, CaseError> {
    let [linear, quadratic] = BULK_VISCOSITY;
    let eos = MieGruneisen::copper();
    let law = match setup.constants {
        Constants::Taylor => {
            let law = Solid::new(JohnsonCook::copper_taylor(), eos).with_bulk_viscosity(linear, quadratic)?;
            law.into_material()
        }
        Constants::Standard => {
            let law = Solid::new(JohnsonCook::copper(), eos).with_bulk_viscosity(linear, quadratic)?;
            law.into_material()
        }
    };
    match setup.model {
        Model::Quarter => in_space(setup, task, scheme_in_space(setup.scheme), law, simulation),
        Model::Axisymmetric => axisymmetric(setup, task, scheme_revolved(setup.scheme), law, simulation),
    }
}

fn scheme_in_space(scheme: Scheme) -> Kernels<f64, 3> {
    match scheme {
        Scheme::LinearMusl => Method::new(Linear, Flip, Musl, FullSpace).into_kernels(),
        Scheme::GimpUsl => methods::gimp_usl_in_space(),
        Scheme::CpgimpUsl => Method::new(CpGimp, Flip, Usl, FullSpace).into_kernels(),
        Scheme::QuadraticApic => Method::new(QuadraticBSpline, Apic, Usl, FullSpace).into_kernels(),
    }
}

fn scheme_revolved(scheme: Scheme) -> Kernels<f64, 2> {
    match scheme {
        Scheme::LinearMusl => Method::new(Linear, Flip, Musl, Axisymmetric).into_kernels(),
        Scheme::GimpUsl => methods::gimp_usl_revolved(),
        Scheme::CpgimpUsl => Method::new(CpGimp, Flip, Usl, Axisymmetric).into_kernels(),
        Scheme::QuadraticApic => Method::new(QuadraticBSpline, Apic, Usl, Axisymmetric).into_kernels(),
    }
}

/// Run in three dimensions: a quarter of the bar on the wall z = 0, or the whole bar in flight.
fn in_space(
    setup: &Setup,
    task: Task,
    method: Kernels<f64, 3>,
    law: Arc<dyn Material<f64>>,
    simulation: Simulation,
) -> Result<Outcome, CaseError> {
    let lattice = Lattice::new([0.0; 3], setup.spacing())?;
    let bar = Cylinder::new([0.0; 3], [0.0, 0.0, 1.0], LENGTH, RADIUS)?;
    let mut mpm = Mpm::new(method, BlockGrid::new(lattice));
    let seeds;
    match task {
        Task::Impact(_) => {
            let quadrant = Cuboid::new([0.0; 3], [2.0 * RADIUS, 2.0 * RADIUS, 2.0 * LENGTH])?;
            seeds = fill(&bar.and(quadrant), &lattice, 2, &Filling::new())?;
            mpm.add("bar", law, &seeds, |_| [0.0, 0.0, -SPEED])?;
            mpm.bound(Boundary::Symmetry { axis: 0, at: 0.0, side: Side::Above })?;
            mpm.bound(Boundary::Symmetry { axis: 1, at: 0.0, side: Side::Above })?;
            mpm.bound(Boundary::Wall { axis: 2, at: 0.0, side: Side::Above, velocity: 0.0 })?;
        }
        Task::FreeFlight => {
            seeds = fill(&bar, &lattice, 2, &Filling::new())?;
            mpm.add("bar", law, &seeds, |[x, y, z]| {
                let spin = 40.0 / RADIUS;
                [-spin * y, spin * x, -SPEED + 40.0 * z / LENGTH]
            })?;
        }
    }
    run(setup, task, mpm, &seeds, simulation)
}

/// Run in radius and height, with the axis r = 0 and the wall z = 0.
fn axisymmetric(
    setup: &Setup,
    task: Task,
    method: Kernels<f64, 2>,
    law: Arc<dyn Material<f64>>,
    simulation: Simulation,
) -> Result<Outcome, CaseError> {
    let lattice = Lattice::new([0.0; 2], setup.spacing())?;
    let bar = Cuboid::new([0.0; 2], [RADIUS, LENGTH])?;
    let seeds = fill(&bar, &lattice, 2, &Filling::new().axisymmetric())?;
    let mut mpm = Mpm::new(method, BlockGrid::new(lattice));
    mpm.bound(Boundary::Symmetry { axis: 0, at: 0.0, side: Side::Above })?;
    match task {
        Task::Impact(_) => {
            mpm.add("bar", law, &seeds, |_| [0.0, -SPEED])?;
            mpm.bound(Boundary::Wall { axis: 1, at: 0.0, side: Side::Above, velocity: 0.0 })?;
        }
        Task::FreeFlight => {
            mpm.add("bar", law, &seeds, |[_, z]| [0.0, -SPEED + 40.0 * z / LENGTH])?;
        }
    }
    run(setup, task, mpm, &seeds, simulation)
}

/// Run with observers, and measure the bar.
fn run<const D: usize>(
    setup: &Setup,
    task: Task,
    mut mpm: Mpm<D>,
    seeds: &Seeds<D>,
    mut simulation: Simulation,
) -> Result<Outcome, CaseError> {
    mpm.set_team(Team::new(setup.threads)?);
    let mut ledger = Ledger::new(Pace::interval(HISTORY)?);
    let mut bar = Progress::new(format!("{:<22}", setup.name()));
    let mut extra: Vec<Box<dyn Observer + '_>> = Vec::new();
    let end = match task {
        Task::Impact(Some(files)) => {
            ledger = ledger.with_csv(files.folder.join(format!("ledger_{}.csv", setup.name())))?;
            extra = files_of(setup, files, seeds)?;
            END
        }
        Task::Impact(None) => END,
        Task::FreeFlight => 0.1 * END,
    };
    let mut observers: Vec<&mut dyn Observer> = vec![&mut ledger, &mut bar];
    observers.extend(extra.iter_mut().map(|o| &mut **o as &mut dyn Observer));
    simulation.until(&mut mpm, observers, end)?;
    drop(extra);
    let outline = Outline::of(&RunView::of(&mpm), seeds, setup.spacing());
    let sizes = outline.sizes();
    let totals = Totals::of(&mpm, &simulation.summary(), &ledger);
    let (ledger, snapshot) = (ledger.entries().to_vec(), mpm.snapshot()?);
    Ok(Outcome { setup: *setup, sizes, outline, ledger, snapshot, totals })
}

/// Create the history of the sizes, and frames for ParaView.
fn files_of<'a, const D: usize>(
    setup: &Setup,
    files: Files,
    seeds: &'a Seeds<D>,
) -> Result<Vec<Box<dyn Observer + 'a>>, CaseError> {
    let spacing = setup.spacing();
    let columns = [("time", "s"), ("length", "m"), ("foot diameter", "m"), ("diameter at 0.2 L0", "m")];
    let sizes = HistoryCsv::create(
        files.folder.join(format!("sizes_{}.csv", setup.name())),
        columns,
        Pace::interval(HISTORY)?,
        move |now: &RunView<'_>| {
            let s = Outline::of(now, seeds, spacing).sizes();
            Ok(vec![now.time(), s.length, s.foot, s.waist])
        },
    )?;
    let mut observers: Vec<Box<dyn Observer + 'a>> = vec![Box::new(sizes)];
    if files.frames > 0 {
        let pace = Pace::interval(END / f64::from(files.frames))?;
        observers.push(Box::new(VtkSeries::create(files.folder.join("paraview"), setup.name(), pace)?));
    }
    Ok(observers)
}
