//! Scene of rod and slab, and its run.
//!
//! The slab is normal to z at -thickness < z < 0; the rod comes from above along -z, on the axis. The model is a quarter,
//! or the half plane of revolution; the slab's edges are free.

use std::f64::consts::PI;
use std::path::Path;

use examples::{CaseError, Restart, Totals};
use mpm_contact::{AnyNormals, Choice, Coulomb, Gradients, Pairs, SurfaceDistance, Weight};
use mpm_core::GridContact;
use mpm_core::geometry::{Cuboid, Filling, Lattice, Seeds, fill};
use mpm_core::observe::{Ledger, LedgerEntry, Observer, Pace, Progress, SmallStrain, VtkSeries};
use mpm_core::output::Snapshot;
use mpm_core::{
    Axisymmetric, Blend, BlockGrid, CpGimp, FullSpace, IntoKernels, Kernels, Linear, Method, Mpm, Musl,
    Solver, Team, TimeControl,
};
use mpm_materials::library;

use crate::rod::RodOf;
use crate::setup::{Detection, Kernel, Model, ROD, Setup, THICKNESS};
use crate::track::{Row, Track};

/// Longitudinal wave speed in the concrete, m/s, for the memory of the blend.
const SOUND: f64 = 3830.0;
/// Limit of small strain, and time between two checks of it, s.
const SMALL: (f64, f64) = (0.05, 20.0e-6);
/// Time between two rows of a history, s.
const HISTORY: f64 = 4.0e-6;

/// Result of a run.
pub struct Outcome {
    pub setup: Setup,
    pub rows: Vec<Row>,
    pub snapshots: Vec<Snapshot>,
    /// True if the rod perforated the slab.
    pub through: bool,
    pub totals: Totals,
    /// Energy and momentum over time.
    pub ledger: Vec<LedgerEntry>,
}

impl Outcome {
    /// Return the last row.
    pub fn last(&self) -> Row {
        self.rows.last().copied().unwrap_or_default()
    }
    /// Residual speed, m/s; 0 if the rod stayed in the slab or rebounded.
    pub fn residual(&self) -> f64 {
        if self.through { self.last().speed } else { 0.0 }
    }
    /// Largest volume of slab more than half a cell inside the rod, over the volume of the hole.
    pub fn overlap(&self) -> f64 {
        let most = self.rows.iter().map(|r| r.inside).fold(0.0, f64::max);
        most / (PI * ROD.radius().powi(2) * THICKNESS)
    }
}

/// Run a shot, with snapshots at the given travels of an undecelerated rod, m, and at the end, if there are any travels;
/// and ParaView frames in a folder.
pub fn shoot(
    setup: &Setup,
    ways: &[f64],
    files: Option<&Path>,
    restart: &Restart,
) -> Result<Outcome, CaseError> {
    let memory = setup.memory * setup.spacing() / SOUND;
    let blend = Blend::new(memory)?;
    let task = Task { setup: *setup, ways, files, restart };
    match (setup.model, setup.kernel) {
        (Model::Quarter, Kernel::Impact) => quarter(task, Method::impact(FullSpace).into_kernels()),
        (Model::Axisymmetric, Kernel::Impact) => revolved(task, Method::impact(Axisymmetric).into_kernels()),
        (Model::Quarter, Kernel::Linear) => {
            quarter(task, Method::new(Linear, blend, Musl, FullSpace).into_kernels())
        }
        (Model::Quarter, Kernel::Cpgimp) => {
            quarter(task, Method::new(CpGimp, blend, Musl, FullSpace).into_kernels())
        }
        (Model::Axisymmetric, Kernel::Linear) => {
            revolved(task, Method::new(Linear, blend, Musl, Axisymmetric).into_kernels())
        }
        (Model::Axisymmetric, Kernel::Cpgimp) => {
            revolved(task, Method::new(CpGimp, blend, Musl, Axisymmetric).into_kernels())
        }
    }
}

#[derive(Clone, Copy)]
struct Task<'a> {
    setup: Setup,
    ways: &'a [f64],
    files: Option<&'a Path>,
    restart: &'a Restart,
}

/// Lattice, rod, and seeds of the slab.
struct Bodies<const D: usize> {
    lattice: Lattice<D>,
    rod: RodOf<D>,
    slab: Seeds<D>,
}

fn quarter(task: Task, method: Kernels<f64, 3>) -> Result<Outcome, CaseError> {
    let setup = task.setup;
    let lattice = Lattice::new([0.0; 3], setup.spacing())?;
    let rod = RodOf::quarter(&setup)?;
    let slab = Cuboid::new([0.0, 0.0, -THICKNESS], [setup.half_width, setup.half_width, 0.0])?;
    let slab = fill(&slab, &lattice, setup.parts as usize, &Filling::new())?;
    run(task, method, Bodies { lattice, rod, slab })
}

fn revolved(task: Task, method: Kernels<f64, 2>) -> Result<Outcome, CaseError> {
    let setup = task.setup;
    let lattice = Lattice::new([0.0; 2], setup.spacing())?;
    let rod = RodOf::revolved(&setup)?;
    let slab = Cuboid::new([0.0, -THICKNESS], [setup.half_width, 0.0])?;
    let slab = fill(&slab, &lattice, setup.parts as usize, &Filling::new().axisymmetric())?;
    run(task, method, Bodies { lattice, rod, slab })
}

fn run<const D: usize>(task: Task, method: Kernels<f64, D>, bodies: Bodies<D>) -> Result<Outcome, CaseError> {
    let Task { setup, ways, files, restart } = task;
    let laws = Pairs::new(Coulomb::new(setup.friction)?);
    let normals = match setup.detection {
        Detection::Gradients => AnyNormals::Gradients(Gradients::default()),
        Detection::Regression => AnyNormals::Regression,
        Detection::Rod => AnyNormals::Gradients(Gradients::new(Weight::Volume, Choice::OneBody(vec![0]))),
    };
    let contact = GridContact::new(SurfaceDistance::new(normals, 0.0)?.locally(), laws);
    let mut mpm = Mpm::with_contact(method, BlockGrid::new(bodies.lattice), contact);
    bodies.rod.add(&setup, &mut mpm)?;
    let concrete = library::concrete_48().with_bulk_viscosity(0.06, 1.5)?;
    mpm.add("slab", concrete, &bodies.slab, |_| [0.0; D])?;
    for plane in bodies.rod.planes() {
        mpm.bound(plane)?;
    }
    mpm.set_time_control(TimeControl::Courant { factor: setup.factor, growth: 1.1 })?;
    mpm.set_team(Team::new(setup.threads)?);

    let mut track = Track::new(Pace::interval(HISTORY)?, &setup);
    let mut ledger = Ledger::new(Pace::interval(HISTORY)?);
    let mut strain = SmallStrain::new(Pace::interval(SMALL.1)?, SMALL.0);
    let mut bar = Progress::new(setup.name());
    let mut frames = match files {
        Some(folder) => {
            ledger = ledger.with_csv(folder.join(format!("ledger_{}.csv", setup.name())))?;
            let pace = Pace::interval(100.0e-6)?;
            Some(VtkSeries::create(folder.join("paraview"), setup.name(), pace)?)
        }
        None => None,
    };
    let mut simulation = restart.scene(setup.name())?;
    // A rod that is still in the slab after eight times the transit time at full speed stays there.
    let through = (ROD.length + THICKNESS) / setup.speed;
    let looks: Vec<f64> = ways.iter().map(|w| w / setup.speed).collect();
    let mut ends = looks.clone();
    ends.extend((0..360).map(|n| through * (0.5 + 0.02 * f64::from(n))));
    ends.sort_by(f64::total_cmp);
    for end in ends {
        let mut observers: Vec<&mut dyn Observer> = vec![&mut track, &mut ledger, &mut strain, &mut bar];
        observers.extend(frames.as_mut().map(|f| f as &mut dyn Observer));
        simulation.until(&mut mpm, observers, end)?;
        let over = track.through() || track.stopped();
        // The last snapshot shows the remaining slab.
        if looks.contains(&end) || (over && !looks.is_empty()) {
            simulation.keep(|| mpm.snapshot())?;
        }
        if over {
            break;
        }
    }
    strain.report().iter().for_each(|body| eprintln!("{}: {body}", setup.name()));
    let totals = Totals::of(&mpm, &simulation.summary(), &ledger);
    let (through, ledger) = (track.through(), ledger.entries().to_vec());
    let snapshots = simulation.into_snapshots();
    Ok(Outcome { setup, rows: track.rows, snapshots, through, totals, ledger })
}
