//! Plates of fragile points with a notch that tear: what the cases of cracks share. Compiled here, once for all binaries.

use std::path::Path;
use std::sync::Arc;

use clap::ValueEnum;
use fpm::{
    AnyCriterion, Cells, Cohesive, Composition, Crack, Criterion, Domain, FaceHistory, Fpm, Incomplete,
    MaximumTension, Method, MixedTensionShear, NoCracks, Notch, OuterFace, Penalty, Symmetric, TipPath,
    TractionHistory, relaxed, scattered,
};
use mpm_core::observe::{Ledger, LedgerEntry, ObserveError, Observer, Pace, Progress, RunView, VtkSeries};
use mpm_core::output::{History, Snapshot};
use mpm_core::{Archive, Boundary, CheckpointError, PlaneStrain, SceneError, Side, Solver, Team, Warning};
use mpm_materials::{Constitutive, IntoMaterial, LinearElastic, Material, PlaneStress};
use serde::Serialize;

use crate::fragile::Joint;
use crate::{CaseError, Restart, Totals};

/// When faces open.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum CrackOption {
    /// At a tension, as printed: then they bear nothing
    Strength,
    /// At tension and shear together: then they bear nothing
    Mixed,
    /// Cohesive from a tension on, with fracture energy
    Cohesive,
    /// Cohesive from tension and shear together on, with fracture energy
    CohesiveMixed,
    /// Never
    None,
}

/// Cells of a cohesive face while it softens.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Softening {
    /// They stay joined: an area takes the energy that is given
    Joined,
    /// They part as the face begins to soften
    Parted,
}

/// Plane strain, or plane stress.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Plane {
    /// A thick body: no strain across
    Strain,
    /// A thin plate: no stress across
    Stress,
}

/// What is said of speeds, m/s, over a time of this, s.
pub const WINDOW: f64 = 8e-6;

impl CrackOption {
    /// In tables.
    pub fn words(self) -> &'static str {
        match self {
            CrackOption::Strength => "strength",
            CrackOption::Mixed => "mixed",
            CrackOption::Cohesive => "cohesive",
            CrackOption::CohesiveMixed => "cohesive mixed",
            CrackOption::None => "no cracks",
        }
    }

    /// The criterion with a strength in tension and in shear, Pa, and fracture energy, J/m^2.
    ///
    /// # Errors
    /// Numbers that the criterion refuses.
    pub fn criterion(
        self,
        tension: f64,
        shear: f64,
        work: f64,
        softening: Softening,
    ) -> Result<AnyCriterion, SceneError> {
        let mixed = || MixedTensionShear::new(tension, shear);
        Ok(match self {
            CrackOption::Strength => AnyCriterion::Tension(MaximumTension::new(tension)?),
            CrackOption::Mixed => AnyCriterion::Mixed(mixed()?),
            CrackOption::Cohesive => AnyCriterion::Cohesive(softening.of(Cohesive::new(tension, work)?)),
            CrackOption::CohesiveMixed => {
                AnyCriterion::CohesiveMixed(softening.of(Cohesive::by(mixed()?, work)?))
            }
            CrackOption::None => AnyCriterion::None(NoCracks),
        })
    }

    /// Does a crack take an energy that is given?
    pub fn has_energy(self) -> bool {
        matches!(self, CrackOption::Cohesive | CrackOption::CohesiveMixed)
    }
}

impl Softening {
    fn of<S: Criterion>(self, cohesive: Cohesive<S>) -> Cohesive<S> {
        match self {
            Softening::Joined => cohesive,
            Softening::Parted => cohesive.parted(),
        }
    }
}

impl Plane {
    /// In tables.
    pub fn words(self) -> &'static str {
        match self {
            Plane::Strain => "plane strain",
            Plane::Stress => "plane stress",
        }
    }

    /// A linear elastic law in it.
    pub fn elastic(self, law: LinearElastic<f64>) -> Arc<dyn Material<f64>> {
        self.law(law)
    }

    /// Any law in it.
    pub fn law<C: Constitutive<f64> + IntoMaterial<f64>>(self, law: C) -> Arc<dyn Material<f64>>
    where
        PlaneStress<C>: IntoMaterial<f64>,
    {
        match self {
            Plane::Strain => law.into_material(),
            Plane::Stress => PlaneStress::new(law).into_material(),
        }
    }
}

/// Random cells of a plate with a notch, along which points are lined up; about `spacing` (m, at a place) wide and `at_notch` there.
///
/// # Errors
/// What cells refuse.
pub fn random_cells(
    domain: &Domain<2>,
    notch: &Notch<2>,
    seed: u64,
    spacing: impl Fn([f64; 2]) -> f64,
    at_notch: f64,
) -> Result<Cells<2>, CaseError> {
    let refused = |e: fpm::CellsError| CaseError::Other(e.to_string());
    let points = relaxed(scattered(domain, seed, spacing).map_err(refused)?, domain, 3).map_err(refused)?;
    let points = notch.lined(points, domain, at_notch).map_err(refused)?;
    Cells::voronoi(&points, domain).and_then(|cells| cells.with_notch(notch)).map_err(refused)
}

/// What acts on a plate.
pub enum Load {
    /// On faces of the surface for which the rule holds a traction, Pa.
    Traction(fn(&OuterFace<2>) -> bool, TractionHistory<2>),
    /// A velocity, m/s.
    Velocity(fn(&OuterFace<2>) -> bool, FaceHistory<2>),
    /// A plane of symmetry with the plate above it: axis and place, m.
    Symmetry(usize, f64),
}

/// A plate that will tear.
pub struct Torn<'a> {
    /// Its label, and name in files.
    pub name: String,
    /// In the line of progress.
    pub words: String,
    /// With its notch.
    pub cells: &'a Cells<2>,
    /// In plane strain.
    pub law: Arc<dyn Material<f64>>,
    /// What joins cells.
    pub flux: Joint,
    /// Penalty over Young's modulus.
    pub eta: f64,
    /// When faces open.
    pub criterion: AnyCriterion,
    /// Coulomb friction of cracks that close.
    pub friction: f64,
    /// What acts on it.
    pub loads: Vec<Load>,
    /// Where the notch ends, m: cracks are measured from there.
    pub tip: [f64; 2],
    /// s.
    pub end: f64,
    /// Threads.
    pub threads: usize,
    /// Where files go.
    pub folder: &'a Path,
    /// ParaView frames.
    pub frames: u32,
}

/// A moment of a plate that tears.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Row {
    /// s.
    pub time: f64,
    /// Area of cracks in metres of length, for a depth of one metre.
    pub area: f64,
    /// Energy that cracks took, J for a depth of one metre.
    pub dissipated: f64,
    /// Kinetic energy, J/m.
    pub kinetic: f64,
    /// By the law, J/m.
    pub internal: f64,
    /// Of the penalty, J/m.
    pub penalty: f64,
    /// Pieces.
    pub fragments: f64,
}

/// What became of it.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// Faces that opened, in their order, without the notch.
    pub cracks: Vec<Crack<2>>,
    /// Way of the tip from that of the notch: where faces that are broken through at the end began to open.
    pub path: TipPath<2>,
    /// The same of where faces bear nothing any more: ahead of it there is a cohesive zone.
    pub parted: TipPath<2>,
    /// Cells of the pieces, the largest first.
    pub fragments: Vec<usize>,
    /// Energy that cracks took, J a metre of depth.
    pub dissipated: f64,
    /// The area that they have, m^2 a metre of depth.
    pub area: f64,
    /// At the end, with a field `crack`.
    pub snapshot: Snapshot,
    /// Sides of the open faces then, m.
    pub lines: Vec<[[f64; 2]; 2]>,
    /// Its history.
    pub rows: Vec<Row>,
    /// Of conserved quantities.
    pub ledger: Vec<LedgerEntry>,
    /// For the report.
    pub totals: Totals,
    /// What the watch found.
    pub warnings: Vec<Warning>,
}

impl Outcome {
    /// When the tip was this far from the notch, s, and where it was then, m.
    pub fn reached(&self, distance: f64) -> Option<(f64, [f64; 2])> {
        self.path.tips().iter().find(|t| t.distance > distance).map(|t| (t.time, t.position))
    }

    /// Write its history to a file.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn write_history(&self, path: &Path) -> Result<(), CaseError> {
        let columns = [
            ("time", "s"),
            ("area of cracks a metre of depth", "m"),
            ("energy taken by cracks", "J/m"),
            ("kinetic energy", "J/m"),
            ("energy by the law", "J/m"),
            ("energy of the penalty", "J/m"),
            ("pieces", "-"),
        ];
        let mut file = History::create(path, columns)?;
        for row in &self.rows {
            let Row { time, area, dissipated, kinetic, internal, penalty, fragments } = *row;
            file.push(&[time, area, dissipated, kinetic, internal, penalty, fragments])?;
        }
        Ok(())
    }
}

/// Speeds of a tip, every microsecond from the start to its last: time, s, and m/s.
pub fn speeds(path: &TipPath<2>) -> Vec<[f64; 2]> {
    let last = path.tips().last().map_or(0.0, |t| t.time) * 1e6;
    let of = |t: u32| {
        let time = 1e-6 * f64::from(t);
        path.speed(time, WINDOW).map(|speed| [time, speed])
    };
    (0..=last as u32).filter_map(of).collect()
}

/// The fastest of them, m/s.
pub fn fastest(path: &TipPath<2>) -> f64 {
    speeds(path).into_iter().map(|[_, speed]| speed).fold(0.0, f64::max)
}

/// Broken through: bears nothing unless it closes.
pub fn broken(crack: &Crack<2>) -> bool {
    crack.damage > 0.99
}

/// Run a plate to its end.
///
/// # Errors
/// A scene that is refused, a run that stops, files that cannot be written.
pub fn tear(torn: &Torn, restart: &Restart) -> Result<Outcome, CaseError> {
    let penalty = Penalty::new(torn.eta)?;
    match torn.flux {
        Joint::Incomplete => {
            run(Method::new(PlaneStrain, Incomplete, penalty, torn.criterion), torn, restart)
        }
        Joint::Symmetric => run(Method::new(PlaneStrain, Symmetric, penalty, torn.criterion), torn, restart),
    }
}

/// Rows a run.
const ROWS: f64 = 200.0;

fn run<M: Composition<2>>(method: M, torn: &Torn, restart: &Restart) -> Result<Outcome, CaseError> {
    let mut plate = Fpm::new(method, Arc::clone(&torn.law), torn.cells, |_| [0.0; 2])?.named("plate");
    plate.set_friction(torn.friction)?;
    for load in &torn.loads {
        match load {
            Load::Traction(on, traction) => {
                plate.load_faces(on, Arc::clone(traction))?;
            }
            Load::Velocity(on, velocity) => {
                plate.drive_faces(on, Arc::clone(velocity))?;
            }
            &Load::Symmetry(axis, at) => plate.bound(Boundary::Symmetry { axis, at, side: Side::Above })?,
        }
    }
    plate.set_team(Team::new(torn.threads)?);
    let mut ledger = Ledger::new(Pace::interval(torn.end / ROWS)?);
    let mut track = Track::<M>::new(torn.end / ROWS)?;
    let mut progress = Progress::new(format!("{:<40}", torn.words));
    let mut series = None;
    if torn.frames > 0 {
        let pace = Pace::interval(torn.end / f64::from(torn.frames))?;
        series = Some(VtkSeries::create(torn.folder.join("paraview"), &torn.name, pace)?);
    }
    let mut simulation = restart.scene(&torn.name)?;
    let mut observers: Vec<&mut dyn Observer> = vec![&mut ledger, &mut track, &mut progress];
    observers.extend(series.iter_mut().map(|s| s as &mut dyn Observer));
    simulation.until(&mut plate, observers, torn.end)?;
    let mut cracks = plate.cracks();
    let path = TipPath::new(&cracks, torn.tip, |c| c.opened.filter(|_| broken(c)));
    let parted = TipPath::new(&cracks, torn.tip, |c| c.parted);
    cracks.retain(|c| c.opened.is_some());
    Ok(Outcome {
        path,
        parted,
        cracks,
        fragments: plate.fragments(),
        dissipated: plate.dissipated(),
        area: plate.crack_area(),
        snapshot: Solver::snapshot(&plate)?.with_scalar("crack", plate.damage())?,
        lines: plate.crack_lines(broken),
        rows: track.rows,
        ledger: ledger.entries().to_vec(),
        totals: Totals::of(&plate, &simulation.summary(), &ledger),
        warnings: plate.warnings().to_vec(),
    })
}

/// Notes of a plate that tears.
struct Track<M> {
    pace: Pace,
    rows: Vec<Row>,
    method: std::marker::PhantomData<fn() -> M>,
}

impl<M> Track<M> {
    fn new(every: f64) -> Result<Self, CaseError> {
        Ok(Track { pace: Pace::interval(every)?, rows: Vec::new(), method: std::marker::PhantomData })
    }
}

impl<M: Composition<2>> Observer for Track<M> {
    fn pace(&mut self) -> &mut Pace {
        &mut self.pace
    }
    fn observe(&mut self, now: &RunView<'_>) -> Result<(), ObserveError> {
        let plate = now.solver_as::<Fpm<2, M>>()?;
        let totals = now.totals();
        self.rows.push(Row {
            time: now.time(),
            area: plate.crack_area(),
            dissipated: plate.dissipated(),
            kinetic: totals.kinetic,
            internal: plate.internal_energy(),
            penalty: plate.penalty_energy(),
            fragments: plate.fragments().len() as f64,
        });
        Ok(())
    }
    fn archive(&mut self, file: &mut Archive) -> Result<(), CheckpointError> {
        file.list(&mut self.rows, &Row::default(), |file, row| {
            file.reals([
                &mut row.time,
                &mut row.area,
                &mut row.dissipated,
                &mut row.kinetic,
                &mut row.internal,
                &mut row.penalty,
                &mut row.fragments,
            ])
        })
    }
}
