//! Scene of sphere and plate, and its run: the sphere flies along x and touches the plate, 0 < x < thickness, at t = 0;
//! y = 0 and z = 0 are planes of symmetry. Both move in one velocity field.

use std::path::Path;

use coupling::{Conversion, ConversionBook, Elements};
use examples::{CaseError, Restart, Totals};
use fem::{Criterion, Fem, MeshBody};
use mpm_core::geometry::structured::box_mesh;
use mpm_core::geometry::{Ball, Compose, Cuboid, Filling, Lattice, fill};
use mpm_core::observe::{Ledger, ObserveError, Observer, Pace, Progress, RunView, VtkSeries};
use mpm_core::output::Snapshot;
use mpm_core::{
    Archive, Blend, BlockGrid, Boundary, CheckpointError, CpGimp, FullSpace, Method, Mpm, Musl, Side, Solver,
    Team, TimeControl,
};
use mpm_materials::{Constitutive, IntoMaterial, TensilePressure, library};

/// Radius of the sphere, m \[Piekutowski1996\].
pub const RADIUS: f64 = 4.765e-3;
/// Thickness of the plate, m.
pub const THICKNESS: f64 = 2.2e-3;
/// Constants of aluminium: density, kg/m^3, sound speed, m/s, slope of the Hugoniot.
pub const SHOCK: [f64; 3] = [2703.0, 5350.0, 1.34];
/// Spall strength of aluminium at these rates, Pa \[M\].
const SPALL: f64 = 1.2e9;
/// Linear and quadratic coefficient of the bulk viscosity \[M\].
const BULK_VISCOSITY: [f64; 2] = [0.1, 1.5];
/// End of a run: travel of an undecelerated sphere, radii.
const WAY: f64 = 10.0;
/// Memory of FLIP: decay time of velocities that the nodes do not resolve, in transits of a cell by sound.
const MEMORY: f64 = 100.0;
/// Courant factor of the time step.
const FACTOR: f64 = 0.3;
/// Number of history rows.
const ROWS: f64 = 100.0;

/// Discretisation of the plate.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Plate {
    Mpm,
    Afemp,
}

/// Parameters of a run.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Setup {
    pub plate: Plate,
    /// Impact speed, m/s.
    pub speed: f64,
    /// Cells across the plate.
    pub cells: u32,
    /// Half the edge of the plate, m.
    pub half_width: f64,
    pub threads: usize,
}

impl Setup {
    /// Cell size, m.
    pub fn spacing(&self) -> f64 {
        THICKNESS / f64::from(self.cells)
    }
    /// Name in tables, and label of the run.
    pub fn name(&self) -> String {
        let plate = if self.plate == Plate::Afemp { "afemp" } else { "mpm" };
        format!("{plate} at {} m/s", self.speed)
    }
    /// Name in files.
    pub fn file(&self) -> String {
        self.name().replace([' ', '/'], "_")
    }
}

/// State of the cloud at one time: a quarter of the material more than a cell behind the plate.
#[derive(Clone, Copy, Debug, Default)]
pub struct Row {
    /// Time, s.
    pub time: f64,
    /// Largest x of a point, m.
    pub front: f64,
    /// Mass, kg, and momentum along x, kg m/s.
    pub mass: f64,
    pub momentum: f64,
}

impl Row {
    /// Mean speed, m/s.
    pub fn speed(&self) -> f64 {
        if self.mass > 0.0 { self.momentum / self.mass } else { 0.0 }
    }
}

/// Result of a run.
pub struct Outcome {
    pub setup: Setup,
    pub rows: Vec<Row>,
    pub snapshot: Snapshot,
    /// Time at the end, s.
    pub time: f64,
    /// Mass at the end over that at the start.
    pub mass: f64,
    /// Energy at the start, J.
    pub energy: f64,
    pub converted: Option<ConversionBook>,
    pub totals: Totals,
}

impl Outcome {
    pub fn last(&self) -> Row {
        self.rows.last().copied().unwrap_or_default()
    }
}

fn aluminium() -> Result<impl IntoMaterial<f64>, CaseError> {
    let [linear, quadratic] = BULK_VISCOSITY;
    let law = library::aluminium_feng_2014().with_failure(TensilePressure::new(SPALL)?);
    Ok(law.with_bulk_viscosity(linear, quadratic)?.compiled())
}

/// Run the impact, with ParaView frames in a folder.
pub fn shoot(setup: &Setup, files: Option<&Path>, restart: &Restart) -> Result<Outcome, CaseError> {
    let lattice = Lattice::new([0.0; 3], setup.spacing())?;
    // Method of the lead in `debris_cloud`: the affine transfer loses more energy of a cloud, 6 % in cells of half the plate.
    let blend = Blend::new(MEMORY * setup.spacing() / SHOCK[1])?;
    let method = Method::new(CpGimp, blend, Musl, FullSpace);
    let mut mpm = Mpm::new(method, BlockGrid::new(lattice));
    let quarter = Cuboid::new([-2.0 * RADIUS, 0.0, 0.0], [0.0, RADIUS, RADIUS])?;
    let ball = fill(&Ball::new([-RADIUS, 0.0, 0.0], RADIUS)?.and(quarter), &lattice, 2, &Filling::new())?;
    mpm.add("sphere", aluminium()?, &ball, |_| [setup.speed, 0.0, 0.0])?;
    let half = setup.half_width;
    let plate = Cuboid::new([0.0; 3], [THICKNESS, half, half])?;
    let mut log = None;
    match setup.plate {
        Plate::Mpm => {
            let seeds = fill(&plate, &lattice, 2, &Filling::new())?;
            mpm.add("plate", aluminium()?, &seeds, |_| [0.0; 3])?;
        }
        Plate::Afemp => {
            let side = (half / setup.spacing()).round() as usize;
            let mut fem = Fem::new(FullSpace);
            fem.add(MeshBody::new(
                "plate",
                box_mesh(&plate, [setup.cells as usize, side, side])?,
                aluminium()?,
            ))?;
            let conversion = Conversion::adaptive().or("failure", Criterion::Failed);
            let (elements, conversions) = Elements::converting(fem, "debris", conversion)?;
            mpm.add_client(elements)?;
            log = Some(conversions);
        }
    }
    for axis in [1, 2] {
        mpm.bound(Boundary::Symmetry { axis, at: 0.0, side: Side::Above })?;
    }
    mpm.set_time_control(TimeControl::Courant { factor: FACTOR, growth: 1.1 })?;
    mpm.set_team(Team::new(setup.threads)?);

    let end = WAY * RADIUS / setup.speed;
    let start = mpm.totals();
    let mut track =
        Track { pace: Pace::interval(end / ROWS)?, behind: THICKNESS + setup.spacing(), rows: Vec::new() };
    let mut ledger = Ledger::new(Pace::interval(end / ROWS)?);
    let mut bar = Progress::new(setup.name());
    let mut frames = None;
    if let Some(folder) = files {
        frames = Some(VtkSeries::create(folder.join("paraview"), setup.file(), Pace::interval(end / 8.0)?)?);
    }
    let mut observers: Vec<&mut dyn Observer> = vec![&mut track, &mut ledger, &mut bar];
    observers.extend(frames.as_mut().map(|f| f as &mut dyn Observer));
    let mut simulation = restart.scene(setup.file())?;
    simulation.until(&mut mpm, observers, end)?;
    let totals = Totals::of(&mpm, &simulation.summary(), &ledger);
    Ok(Outcome {
        setup: *setup,
        rows: track.rows,
        snapshot: mpm.snapshot()?,
        time: mpm.time(),
        mass: mpm.totals().mass / start.mass,
        energy: start.kinetic,
        converted: log.map(|log| log.book()),
        totals,
    })
}

/// Observer of the cloud.
struct Track {
    pace: Pace,
    /// Lower limit of x of the cloud, m.
    behind: f64,
    rows: Vec<Row>,
}

impl Observer for Track {
    fn pace(&mut self) -> &mut Pace {
        &mut self.pace
    }
    fn observe(&mut self, now: &RunView<'_>) -> Result<(), ObserveError> {
        let mut row = Row { time: now.time(), ..Row::default() };
        for body in now.bodies() {
            body.for_each(&mut |p| {
                row.front = row.front.max(p.position[0]);
                if p.position[0] > self.behind {
                    row.mass += p.mass;
                    row.momentum += p.mass * p.velocity[0];
                }
            });
        }
        self.rows.push(row);
        Ok(())
    }
    fn archive(&mut self, file: &mut Archive) -> Result<(), CheckpointError> {
        file.list(&mut self.rows, &Row::default(), |file, row| {
            let Row { time, front, mass, momentum } = row;
            file.reals([time, front, mass, momentum])
        })
    }
}
