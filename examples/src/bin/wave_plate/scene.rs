//! Scene and run.

use std::path::Path;
use std::sync::Arc;

use examples::fragile::{Fragile, Joint};
use examples::{CaseError, Restart, Totals};
use fpm::{Composition, Fpm, Method};
use mpm_core::observe::{HistoryCsv, Ledger, Observer, Pace, Progress, RunView, VtkSeries};
use mpm_core::output::Snapshot;
use mpm_core::{PlaneStrain, Solver, Team};
use mpm_materials::{LinearElastic, Moduli};

use crate::load::{Exact, Load};

/// Length of the plate, m, and length over height.
pub const LENGTH: f64 = 4.0;
pub const HEIGHTS: usize = 2;
/// Young's modulus, Pa, and density, kg/m^3.
const YOUNG: f64 = 8e4;
const DENSITY: f64 = 1.0;
/// Interval between two entries of a history, s.
const HISTORY: f64 = 1e-4;

/// Return the wave speed, m/s: without lateral contraction.
pub fn speed() -> f64 {
    (YOUNG / DENSITY).sqrt()
}

/// Parameters of a run.
#[derive(Clone, Copy, Debug)]
pub struct Setup {
    pub load: Load,
    pub joint: Joint,
    pub fragile: Fragile,
    /// Number of cells along the plate, and across.
    pub counts: [usize; 2],
    /// End of the run, s.
    pub end: f64,
    pub threads: usize,
}

impl Setup {
    /// Return the name in files and rows.
    pub fn name(&self) -> String {
        format!("{}, {}", self.load.shape.name(), self.joint.name())
    }

    /// Return the exact solution.
    pub fn exact(&self) -> Exact {
        Exact { load: self.load, length: LENGTH, speed: speed(), young: YOUNG }
    }

    /// Return the height of the plate, m, for square cells.
    fn height(&self) -> f64 {
        LENGTH * self.counts[1] as f64 / self.counts[0] as f64
    }

    /// Build the plate, clamped at the left and loaded at the right.
    pub fn plate<M: Composition<2>>(&self, method: M) -> Result<Fpm<2, M>, CaseError> {
        let cells = self.fragile.cells([0.0; 2], [LENGTH, self.height()], self.counts)?;
        let law = LinearElastic::new(DENSITY, Moduli::young_poisson(YOUNG, 0.0)?)?;
        let mut plate = Fpm::new(method, law, &cells, |_| [0.0; 2])?.named("plate");
        plate.hold_faces(|f| f.normal[0] < -0.5, Arc::new(|_| [Some(0.0); 2]))?;
        let load = self.load;
        plate.load_faces(|f| f.normal[0] > 0.5, Arc::new(move |t| [load.at(t), 0.0]))?;
        plate.set_team(Team::new(self.threads)?);
        Ok(plate)
    }
}

/// Number of recorded quantities: displacements at the end and in the middle, m, stresses in the middle and at the clamped end, Pa.
pub const FOLLOWED: usize = 4;

/// Entry of the history.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Entry {
    pub time: f64,
    pub found: [f64; FOLLOWED],
    pub exact: [f64; FOLLOWED],
}

/// Results of a run.
#[derive(Clone, Debug)]
pub struct Outcome {
    pub setup: Setup,
    /// Description of the method.
    pub method: String,
    pub history: Vec<Entry>,
    /// Snapshots at the arrival of a wave at the clamped end, and at the end of the run.
    pub frames: Vec<Snapshot>,
    pub totals: Totals,
}

/// Output of a run.
#[derive(Clone, Copy, Debug)]
pub struct Files<'a> {
    pub folder: &'a Path,
    pub frames: u32,
    pub restart: &'a Restart,
}

/// Run the tension test.
pub fn draw_out(setup: &Setup, files: Files) -> Result<Outcome, CaseError> {
    let penalty = setup.fragile.penalty()?;
    match setup.joint {
        Joint::Incomplete => run(setup, Method::printed(PlaneStrain).with_penalty(penalty), files),
        Joint::Symmetric => run(setup, Method::symmetric(PlaneStrain).with_penalty(penalty), files),
    }
}

/// Return the cell whose point is nearest to a position.
fn nearest<M: Composition<2>>(plate: &Fpm<2, M>, to: [f64; 2]) -> usize {
    let off = |i: &usize| plate.reference()[*i].iter().zip(to).map(|(x, y)| (x - y).powi(2)).sum::<f64>();
    (0..plate.reference().len()).min_by(|a, b| off(a).total_cmp(&off(b))).unwrap_or(0)
}

fn run<M: Composition<2>>(setup: &Setup, method: M, files: Files) -> Result<Outcome, CaseError> {
    let mut plate = setup.plate(method)?;
    let (exact, half) = (setup.exact(), 0.5 * setup.height());
    let places = [[LENGTH, half], [0.5 * LENGTH, half], [0.0, half]];
    let cells = places.map(|place| nearest(&plate, place));
    let stretched = [cells[1], cells[2]].map(|i| plate.reference()[i][0]);
    let columns = [
        ("time", "s"),
        ("displacement of the end", "m"),
        ("displacement of the middle", "m"),
        ("stress in the middle", "Pa"),
        ("stress where it is held", "Pa"),
        ("exact displacement of the end", "m"),
        ("exact displacement of the middle", "m"),
        ("exact stress in the middle", "Pa"),
        ("exact stress where it is held", "Pa"),
        ("kinetic energy", "J"),
        ("internal energy", "J"),
        ("work of the load", "J"),
    ];
    let name = setup.name().replace(", ", "_").replace(' ', "-");
    let path = files.folder.join(format!("history_{name}.csv"));
    let mut history = HistoryCsv::create(path, columns, Pace::interval(HISTORY)?, |now: &RunView<'_>| {
        let (t, plate) = (now.time(), now.solver_as::<Fpm<2, M>>()?);
        let along = |n: usize| plate.displacement_at(cells[n], places[n])[0];
        let stress = |n: usize| plate.nominal_stresses()[cells[n]][0][0];
        Ok(vec![
            t,
            along(0),
            along(1),
            stress(1),
            stress(2),
            exact.displacement(LENGTH, t),
            exact.displacement(0.5 * LENGTH, t),
            exact.stress(stretched[0], t),
            exact.stress(stretched[1], t),
            now.totals().kinetic,
            now.totals().internal,
            now.exchange().work,
        ])
    })?;
    let mut ledger = Ledger::new(Pace::interval(HISTORY)?);
    let mut progress = Progress::new(format!("{:<24}", setup.name()));
    let mut series = None;
    if files.frames > 0 {
        let pace = Pace::interval(setup.end / f64::from(files.frames))?;
        series = Some(VtkSeries::create(files.folder.join("paraview"), &name, pace)?);
    }
    let mut simulation = files.restart.scene(&name)?;
    for end in [LENGTH / speed(), setup.end] {
        let mut observers: Vec<&mut dyn Observer> = vec![&mut history, &mut ledger, &mut progress];
        observers.extend(series.iter_mut().map(|s| s as &mut dyn Observer));
        simulation.until(&mut plate, observers, end.min(setup.end))?;
        simulation.keep(|| plate.snapshot())?;
    }
    let entry = |row: &Vec<f64>| {
        let four = |from: usize| row[from..from + FOLLOWED].try_into().ok();
        Some(Entry { time: row[0], found: four(1)?, exact: four(1 + FOLLOWED)? })
    };
    Ok(Outcome {
        setup: *setup,
        method: plate.describe(),
        history: history.rows().iter().filter_map(entry).collect(),
        totals: Totals::of(&plate, &simulation.summary(), &ledger),
        frames: simulation.into_snapshots(),
    })
}
