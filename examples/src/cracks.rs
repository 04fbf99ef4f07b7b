//! Notched plates of fragile points that crack: shared code of the crack cases, compiled here once for all binaries.

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

/// Time window of a crack speed, s.
pub const WINDOW: f64 = 8e-6;

impl CrackOption {
    /// Name in tables.
    pub fn words(self) -> &'static str {
        match self {
            CrackOption::Strength => "strength",
            CrackOption::Mixed => "mixed",
            CrackOption::Cohesive => "cohesive",
            CrackOption::CohesiveMixed => "cohesive mixed",
            CrackOption::None => "no cracks",
        }
    }

    /// Return the criterion with a strength in tension and in shear, Pa, and fracture energy, J/m^2.
    ///
    /// # Errors
    /// Invalid strength or fracture energy.
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

    /// True if cracks dissipate a given fracture energy.
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
    /// Name in tables.
    pub fn words(self) -> &'static str {
        match self {
            Plane::Strain => "plane strain",
            Plane::Stress => "plane stress",
        }
    }

    /// Return a linear elastic law as a material of this plane state.
    pub fn elastic(self, law: LinearElastic<f64>) -> Arc<dyn Material<f64>> {
        self.law(law)
    }

    /// Return any law as a material of this plane state.
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

/// Build random cells of a plate with a notch, along which points are aligned; cells are about `spacing`, m (a function of
/// position), wide, and `at_notch`, m, at the notch.
///
/// # Errors
/// Invalid cells.
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

/// Load on a plate.
pub enum Load {
    /// Traction, Pa, on the surface faces that the rule selects.
    Traction(fn(&OuterFace<2>) -> bool, TractionHistory<2>),
    /// Velocity, m/s, of the surface faces that the rule selects.
    Velocity(fn(&OuterFace<2>) -> bool, FaceHistory<2>),
    /// Plane of symmetry with the plate above it: axis and position, m.
    Symmetry(usize, f64),
}

/// Definition of a plate that cracks.
pub struct Torn<'a> {
    /// Label of the simulation, and name in files.
    pub name: String,
    /// Label of the progress bar.
    pub words: String,
    /// Cells with the notch.
    pub cells: &'a Cells<2>,
    /// Material law for plane-strain kinematics.
    pub law: Arc<dyn Material<f64>>,
    /// Flux between cells.
    pub flux: Joint,
    /// Penalty over Young's modulus.
    pub eta: f64,
    /// Crack criterion of faces.
    pub criterion: AnyCriterion,
    /// Coulomb friction of closed cracks.
    pub friction: f64,
    /// Loads on the plate.
    pub loads: Vec<Load>,
    /// Tip of the notch, m: origin of crack lengths.
    pub tip: [f64; 2],
    /// End time, s.
    pub end: f64,
    /// Number of threads.
    pub threads: usize,
    /// Output folder.
    pub folder: &'a Path,
    /// Number of ParaView frames.
    pub frames: u32,
}

/// State of a cracking plate at one time.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Row {
    /// Time, s.
    pub time: f64,
    /// Crack area a metre of depth, m.
    pub area: f64,
    /// Energy dissipated by cracks, J a metre of depth.
    pub dissipated: f64,
    /// Kinetic energy, J/m.
    pub kinetic: f64,
    /// Internal energy by the law, J/m.
    pub internal: f64,
    /// Penalty energy, J/m.
    pub penalty: f64,
    /// Number of fragments.
    pub fragments: f64,
}

/// Result of a run.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// Faces that opened, in the order of opening, without the notch.
    pub cracks: Vec<Crack<2>>,
    /// Path of the crack tip from the notch: faces that are broken through at the end, at the time of first opening.
    pub path: TipPath<2>,
    /// Path of the traction-free tip; a cohesive zone lies ahead of it.
    pub parted: TipPath<2>,
    /// Number of cells of each fragment, the largest first.
    pub fragments: Vec<usize>,
    /// Energy dissipated by cracks, J a metre of depth.
    pub dissipated: f64,
    /// Crack area, m^2 a metre of depth.
    pub area: f64,
    /// Snapshot at the end, with a field `crack`.
    pub snapshot: Snapshot,
    /// Sides of the broken faces at the end, m.
    pub lines: Vec<[[f64; 2]; 2]>,
    /// History of the run.
    pub rows: Vec<Row>,
    /// Ledger of conserved quantities.
    pub ledger: Vec<LedgerEntry>,
    /// Totals for the report.
    pub totals: Totals,
    /// Warnings of the watch.
    pub warnings: Vec<Warning>,
}

impl Outcome {
    /// Return the time, s, and position, m, of the tip when it passes this distance from the notch, m.
    pub fn reached(&self, distance: f64) -> Option<(f64, [f64; 2])> {
        self.path.tips().iter().find(|t| t.distance > distance).map(|t| (t.time, t.position))
    }

    /// Write the history to a file.
    ///
    /// # Errors
    /// File that cannot be written.
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

/// Compute the speeds of a crack tip at every microsecond up to its last advance: time, s, and speed, m/s.
pub fn speeds(path: &TipPath<2>) -> Vec<[f64; 2]> {
    let last = path.tips().last().map_or(0.0, |t| t.time) * 1e6;
    let of = |t: u32| {
        let time = 1e-6 * f64::from(t);
        path.speed(time, WINDOW).map(|speed| [time, speed])
    };
    (0..=last as u32).filter_map(of).collect()
}

/// Return the highest speed of a crack tip, m/s.
pub fn fastest(path: &TipPath<2>) -> f64 {
    speeds(path).into_iter().map(|[_, speed]| speed).fold(0.0, f64::max)
}

/// True if a face is broken through: it transmits no traction unless closed.
pub fn broken(crack: &Crack<2>) -> bool {
    crack.damage > 0.99
}

/// Run a plate to its end time.
///
/// # Errors
/// Invalid scene definition, run that stops, file that cannot be written.
pub fn tear(torn: &Torn, restart: &Restart) -> Result<Outcome, CaseError> {
    let penalty = Penalty::new(torn.eta)?;
    match torn.flux {
        Joint::Incomplete => {
            run(Method::new(PlaneStrain, Incomplete, penalty, torn.criterion), torn, restart)
        }
        Joint::Symmetric => run(Method::new(PlaneStrain, Symmetric, penalty, torn.criterion), torn, restart),
    }
}

/// Number of history rows of a run.
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

/// Observer of a cracking plate.
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
