//! Scene of floor, wall and column, and its run.

use std::path::Path;

use examples::{CaseError, Heap, Restart, Totals, largest};
use mpm_core::geometry::{Cuboid, Filling, Lattice, fill};
use mpm_core::observe::{Ledger, LedgerEntry, Observer, Pace, Progress, VtkSeries};
use mpm_core::output::Snapshot;
use mpm_core::{
    Apic, BlockGrid, Boundary, Method, Mpm, PlaneStrain, QuadraticBSpline, Side, Solver, Team, Usl,
};
use mpm_materials::strength::{Cone, DruckerPrager};
use mpm_materials::{Ground, Moduli};
use serde::Serialize;

/// Gravity, m/s^2.
pub const GRAVITY: f64 = 9.81;
/// Constants of the bars \[Bui2008\]: density, kg/m^3, Young's modulus, Pa, and Poisson's ratio.
const DENSITY: f64 = 2650.0;
const YOUNG: f64 = 0.84e6;
const POISSON: f64 = 0.3;
/// Number of history rows of a run.
const ROWS: f64 = 200.0;

/// Parameters of a run.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Setup {
    /// Height of the column, m.
    pub height: f64,
    /// Height over width.
    pub aspect: f64,
    /// Angle of friction, radians.
    pub friction: f64,
    /// Cells over the height; two particles a cell along each axis.
    pub cells: u32,
    /// End of the run, in times sqrt(height / g).
    pub end: f64,
    pub threads: usize,
}

impl Setup {
    /// Cell size, m.
    pub fn spacing(&self) -> f64 {
        self.height / f64::from(self.cells)
    }
    /// Width of the column, m.
    pub fn width(&self) -> f64 {
        self.height / self.aspect
    }
    /// Time of free fall over half the height, s.
    pub fn fall(&self) -> f64 {
        (self.height / GRAVITY).sqrt()
    }
    /// Name in files.
    pub fn name(&self) -> String {
        format!("{:.1}_{:.1}deg_{}", self.aspect, self.friction.to_degrees(), self.cells)
    }
}

/// Result of a run.
pub struct Outcome {
    pub setup: Setup,
    pub snapshots: Vec<Snapshot>,
    /// Time, s, and position of the front, m.
    pub fronts: Vec<[f64; 2]>,
    /// Deposit at the end.
    pub heap: Heap,
    pub totals: Totals,
    pub ledger: Vec<LedgerEntry>,
}

impl Outcome {
    /// Run-out of the front, in widths of the column.
    pub fn run_out(&self) -> f64 {
        let last = self.fronts.last().map_or(f64::NAN, |f| f[1]);
        last / self.setup.width() - 1.0
    }
    /// Kinetic energy at the end, over the potential energy at the start.
    pub fn unrest(&self) -> f64 {
        let kinetic = self.ledger.last().map_or(f64::NAN, |e| e.kinetic);
        kinetic / self.potential()
    }
    /// Potential energy at the start over the floor, J/m.
    fn potential(&self) -> f64 {
        0.5 * DENSITY * GRAVITY * self.setup.height.powi(2) * self.setup.width()
    }
    /// Energy lost and energy gained by the method, over the potential energy.
    pub fn energy_errors(&self) -> [f64; 2] {
        let first = self.ledger.first().map_or(f64::NAN, |e| e.total);
        let errors = || self.ledger.iter().map(|e| (e.total - first) / self.potential());
        [largest(errors().map(|e| -e)), largest(errors())]
    }
}

/// Smallest height of the deposit that counts, m: half a particle.
fn least(setup: &Setup) -> f64 {
    0.25 * setup.spacing()
}

fn heap(setup: &Setup, snapshot: &Snapshot) -> Heap {
    Heap::new(snapshot, [0.0, setup.width() * (2.0 + 6.0 * setup.aspect)], setup.spacing())
}

/// Run the collapse, with snapshots at the given times over sqrt(height / g) and at the end.
pub fn collapse(
    setup: &Setup,
    times: &[f64],
    files: Option<&Path>,
    restart: &Restart,
) -> Result<Outcome, CaseError> {
    let lattice = Lattice::new([0.0; 2], setup.spacing())?;
    let method = Method::new(QuadraticBSpline, Apic, Usl, PlaneStrain);
    let mut mpm = Mpm::new(method, BlockGrid::new(lattice));
    let column = Cuboid::new([0.0; 2], [setup.width(), setup.height])?;
    let seeds = fill(&column, &lattice, 2, &Filling::new())?;
    let elastic = Moduli::young_poisson(YOUNG, POISSON)?;
    let bars = DruckerPrager::matching(DENSITY, elastic, Cone::PlaneStrain, setup.friction, 0.0, 0.0)?;
    mpm.add("column", Ground::new(bars), &seeds, |_| [0.0; 2])?;
    // Smooth wall on the left, no-slip floor.
    mpm.bound(Boundary::Wall { axis: 0, at: 0.0, side: Side::Above, velocity: 0.0 })?;
    mpm.bound(Boundary::Fixed { axis: 1, at: 0.0, side: Side::Above })?;
    mpm.set_body_force(|_| [0.0, -GRAVITY]);
    mpm.set_team(Team::new(setup.threads)?);

    let end = setup.end * setup.fall();
    let mut ledger = Ledger::new(Pace::interval(end / ROWS)?);
    let mut bar = Progress::new(setup.name());
    let mut frames = match files {
        Some(folder) => {
            ledger = ledger.with_csv(folder.join(format!("ledger_{}.csv", setup.name())))?;
            Some(VtkSeries::create(folder.join("paraview"), setup.name(), Pace::interval(end / 40.0)?)?)
        }
        None => None,
    };
    let mut simulation = restart.scene(setup.name())?;
    let mut fronts = Vec::new();
    let steps = 100;
    for n in 1..=steps {
        let now = end * f64::from(n) / f64::from(steps);
        let mut observers: Vec<&mut dyn Observer> = vec![&mut ledger, &mut bar];
        observers.extend(frames.as_mut().map(|f| f as &mut dyn Observer));
        simulation.until(&mut mpm, observers, now)?;
        let front = |snapshot: &Snapshot| heap(setup, snapshot).front(0.5 * setup.width(), least(setup));
        let [front] = simulation.note(|| Ok([front(&mpm.snapshot()?)]))?;
        fronts.push([now, front]);
        let look = times.get(simulation.snapshots().len());
        if look.is_some_and(|t| now >= t * setup.fall() * (1.0 - 1e-9)) || n == steps {
            simulation.keep(|| mpm.snapshot())?;
        }
    }
    let last = mpm.snapshot()?;
    let heap = heap(setup, &last);
    let totals = Totals::of(&mpm, &simulation.summary(), &ledger);
    let snapshots = simulation.into_snapshots();
    Ok(Outcome { setup: *setup, snapshots, fronts, heap, totals, ledger: ledger.entries().to_vec() })
}
