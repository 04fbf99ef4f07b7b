//! Scene and run.
//!
//! The plate is normal to z, -thickness < z < 0; the rod moves along (sin, 0, -cos), and its axis intersects the front at the origin. y = 0
//! is a plane of symmetry: sums are those of the half model.

use std::f64::consts::PI;
use std::path::Path;

use coupling::{Conversion, ConversionBook, Elements};
use examples::{CaseError, Restart, Totals};
use fem::{Fem, MeshBody};
use mpm_contact::{AnyNormals, Gradients, SurfaceDistance};
use mpm_core::GridContact;
use mpm_core::geometry::structured::box_mesh;
use mpm_core::geometry::{Cuboid, Filling, Lattice, fill};
use mpm_core::observe::{Ledger, LedgerEntry, Observer, Pace, Progress, RunView, SmallStrain, VtkSeries};
use mpm_core::output::Snapshot;
use mpm_core::{
    Blend, BlockGrid, CpGimp, FullSpace, IntoKernels, Kernels, Linear, Method, Mpm, Musl, Solver, Team,
    TimeControl,
};
use mpm_materials::{Constitutive, Removed, library};

use crate::cells::Cells;
use crate::flight::{self, Flight};
use crate::rod;
use crate::setup::{Detection, Kernel, ROD, Setup, THICKNESS, Target};
use crate::track::{Row, Track};

/// Longitudinal wave speed in the plate, m/s, for the time constant of the FLIP-PIC blend.
const SOUND: f64 = 6100.0;
/// Limit of small strain, and the interval between its checks, s.
const SMALL: (f64, f64) = (0.05, 20.0e-6);
/// Interval between two rows of a history, s.
const HISTORY: f64 = 2.0e-6;

/// Results of a run.
pub struct Outcome {
    pub setup: Setup,
    pub rows: Vec<Row>,
    pub snapshots: Vec<Snapshot>,
    /// Largest number of occupied cells at a snapshot, and number of cells in the bounding box over all snapshots.
    pub cells: [usize; 2],
    pub totals: Totals,
    /// Free flight before impact, if any.
    pub flight: Option<Flight>,
    /// History of energy and momentum.
    pub ledger: Vec<LedgerEntry>,
    /// Conversion of a plate of elements to particles.
    pub converted: Option<ConversionBook>,
}

impl Outcome {
    /// Return the last row.
    pub fn last(&self) -> Row {
        self.rows.last().copied().unwrap_or_default()
    }
    /// Return the residual speed, m/s; 0 if the rod stuck in the plate, moving with it or not, or rebounded.
    pub fn residual(&self) -> f64 {
        let last = self.last();
        if last.tail - last.carried[0] < -THICKNESS { last.speed() } else { 0.0 }
    }
    /// Return the largest number of plate particles deeper than half a cell inside the rod, as their volume over that of the hole.
    pub fn overlap(&self) -> f64 {
        let most = self.rows.iter().map(|r| r.inside).max().unwrap_or(0) as f64;
        let particle = (self.setup.spacing() / f64::from(self.setup.parts)).powi(3);
        most * particle / (0.5 * PI * ROD.radius().powi(2) * self.setup.way())
    }
    /// Return the last entry of the ledger.
    pub fn books(&self) -> LedgerEntry {
        self.ledger.last().copied().unwrap_or_default()
    }
}

/// Run a shot; snapshots at the given path lengths of an undecelerated rod, m, and ParaView frames in a folder.
pub fn shoot(
    setup: &Setup,
    ways: &[f64],
    files: Option<&Path>,
    restart: &Restart,
) -> Result<Outcome, CaseError> {
    let blend = Blend::new(setup.memory * setup.spacing() / SOUND)?;
    match setup.kernel {
        Kernel::Impact => meet(setup, ways, (files, restart), Method::impact(FullSpace).into_kernels()),
        Kernel::Linear => {
            meet(setup, ways, (files, restart), Method::new(Linear, blend, Musl, FullSpace).into_kernels())
        }
        Kernel::Cpgimp => {
            meet(setup, ways, (files, restart), Method::new(CpGimp, blend, Musl, FullSpace).into_kernels())
        }
    }
}

/// Folder of frames, and checkpoints.
type Files<'a> = (Option<&'a Path>, &'a Restart);

fn meet(setup: &Setup, ways: &[f64], files: Files, method: Kernels<f64, 3>) -> Result<Outcome, CaseError> {
    let laws = setup.law.pairs(setup.friction, SOUND, setup.spacing())?;
    let gradients = SurfaceDistance::new(AnyNormals::Gradients(Gradients::default()), 0.0)?;
    let grid = BlockGrid::new(Lattice::new([0.0; 3], setup.spacing())?);
    let detector = match setup.detection {
        Detection::Off => return run(setup, ways, files, Mpm::new(method, grid)),
        Detection::Plane => SurfaceDistance::new(AnyNormals::Plane, 0.0)?.locally(),
        Detection::Distance => gradients,
        Detection::Local => gradients.locally(),
        Detection::Regression => SurfaceDistance::new(AnyNormals::Regression, 0.0)?.locally(),
    };
    run(setup, ways, files, Mpm::with_contact(method, grid, GridContact::new(detector, laws)))
}

fn run(setup: &Setup, ways: &[f64], (files, restart): Files, mut mpm: Mpm<3>) -> Result<Outcome, CaseError> {
    let h = setup.spacing();
    let lattice = *mpm.grid().lattice();
    let (sine, cosine) = setup.angle.sin_cos();
    // Start a quarter of a cell before the plate, plus the free flight.
    let before = 0.25 * h + setup.flight();
    let tip = [-before * sine, 0.0, before * cosine];
    let from_tail = rod::add(setup, &mut mpm, tip)?;
    let aluminium = library::aluminium_6061_t6()
        .with_failure(Removed(setup.ductility()?))
        .with_bulk_viscosity(0.06, 1.5)?;
    let middle = 0.5 * THICKNESS * setup.angle.tan();
    let half = setup.half_width;
    let plate = Cuboid::new([middle - half, 0.0, -THICKNESS], [middle + half, half, 0.0])?;
    let mut converted = None;
    match setup.target {
        Target::Particles => {
            let plate = fill(&plate, &lattice, setup.parts as usize, &Filling::new())?;
            mpm.add("plate", aluminium.compiled(), &plate, |_| [0.0; 3])?;
        }
        Target::Afemp => {
            let along = |length: f64| (length / h).round() as usize;
            let mesh = box_mesh(&plate, [along(2.0 * half), along(half), along(THICKNESS)])?;
            let mut fem = Fem::new(FullSpace);
            fem.add(MeshBody::new("plate", mesh, aluminium.compiled()))?;
            let (elements, log) = Elements::converting(fem, "hole", Conversion::adaptive())?;
            mpm.add_client(elements)?;
            converted = Some(log);
        }
    }
    mpm.bound(rod::symmetry())?;
    mpm.set_time_control(TimeControl::Courant { factor: setup.factor, growth: 1.1 })?;
    mpm.set_team(Team::new(setup.threads)?);
    let flies = setup.stand_off > 0.0;
    if flies && setup.rest && setup.target == Target::Particles {
        mpm.deactivate(&["plate"])?;
    }

    let mut track = Track::new(Pace::interval(HISTORY)?, from_tail, setup);
    let mut ledger = Ledger::new(Pace::interval(HISTORY)?);
    if let Some(folder) = files {
        ledger = ledger.with_csv(folder.join(format!("ledger_{}.csv", setup.name())))?;
    }
    let mut strain = SmallStrain::new(Pace::interval(SMALL.1)?, SMALL.0);
    let mut bar = Progress::new(setup.name());
    let mut frames = match files {
        Some(folder) => {
            let pace = Pace::interval(40.0e-6)?;
            Some(VtkSeries::create(folder.join("paraview"), setup.name(), pace)?)
        }
        None => None,
    };
    let mut simulation = restart.scene(setup.name())?;
    let mut occupied = Cells::default();
    let mut flown = None;
    if flies {
        flown = Some(flight::fly(setup, &mut mpm, &mut ledger, &mut bar, &mut simulation)?);
    }
    let [impact] = simulation.note(|| Ok([mpm.time()]))?;
    // A rod still in the plate after four times the undecelerated transit time counts as stuck.
    let through = (ROD.length + setup.way()) / setup.speed;
    let mut ends: Vec<f64> = ways.iter().map(|w| w / setup.speed).collect();
    ends.extend((0..60).map(|n| through * (1.0 + 0.05 * f64::from(n))));
    ends.sort_by(f64::total_cmp);
    for end in ends {
        let mut observers: Vec<&mut dyn Observer> = vec![&mut track, &mut ledger, &mut strain, &mut bar];
        observers.extend(frames.as_mut().map(|f| f as &mut dyn Observer));
        simulation.until(&mut mpm, observers, impact + end)?;
        occupied.add(simulation.note(|| Ok(Cells::seen(&RunView::of(&mpm), h)))?);
        if simulation.snapshots().len() < ways.len() {
            simulation.keep(|| mpm.snapshot())?;
        }
        if track.over() {
            break;
        }
    }
    if let Some(flight) = &mut flown {
        flight.fingerprint = flight::fingerprint(&mpm);
    }
    strain.report().iter().for_each(|body| eprintln!("{}: {body}", setup.name()));
    let totals = Totals::of(&mpm, &simulation.summary(), &ledger);
    let ledger = ledger.entries().to_vec();
    let (cells, snapshots) = (occupied.share(), simulation.into_snapshots());
    let (setup, converted) = (*setup, converted.map(|log| log.book()));
    Ok(Outcome { setup, rows: track.rows, snapshots, cells, totals, flight: flown, ledger, converted })
}
