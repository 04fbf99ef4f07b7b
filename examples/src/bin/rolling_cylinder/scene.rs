//! Scene and run.
//!
//! The incline is along x, and gravity is rotated instead. In three dimensions z is along the axis, and z = 0 is a plane of symmetry: sums
//! are those of half a cylinder; in plane strain they are per metre. First the normal component of gravity grows smoothly from zero, so
//! that the cylinder settles without bouncing. Then the tangential component grows, smoothly and quickly: an elastic cylinder released at
//! once first winds up elastically, which costs 2 % of the spin after 1.5 s. The middle of that growth is time zero.

use std::f64::consts::PI;
use std::path::Path;

use examples::{CaseError, Detection, Law, Restart, Totals};
use mpm_contact::Gradients;
use mpm_core::GridContact;
use mpm_core::geometry::{Cuboid, Filling, GeometryError, Lattice, Seeds, fill, rings};
use mpm_core::observe::{Ledger, Observer, Pace, Progress, VtkSeries};
use mpm_core::output::Snapshot;
use mpm_core::{
    BlockGrid, Boundary, Flip, FullSpace, IntoKernels, Linear, Method, Mpm, Musl, PlaneStrain, Side, Solver,
    Team, Watch,
};
use mpm_materials::{Moduli, NeoHookean};

use crate::exact::{Cylinder, Incline};
use crate::track::{Row, Track};

/// Radius of the cylinder, m.
pub const RADIUS: f64 = 3.2;
/// Length of the incline, m.
pub const LENGTH: f64 = 20.0;
/// Length of the cylinder in three dimensions, m.
const LONG: f64 = 4.0;
/// Density, kg/m^3, and Young's modulus, Pa, of the cylinder and of the plane; Poisson's ratio of both.
const SOFT: [f64; 2] = [1.0e3, 42.0e6];
const HARD: [f64; 2] = [1.0e4, 420.0e6];
const POISSON: f64 = 0.4;
/// Speed of longitudinal waves in both bodies, m/s.
const WAVE: f64 = 300.0;
/// Extension of the plane beyond either end of the incline, m.
const MARGIN: f64 = 0.8;
/// Thickness of the plane, m; its lower side is fixed.
pub const THICKNESS: f64 = 1.6;
/// Gravity, m/s^2.
pub const GRAVITY: f64 = 10.0;
/// Duration of the settling phase, s.
const LAYING: f64 = 1.0;
/// Duration of the release, s.
const LETTING: f64 = 0.3;
/// Interval between two entries of a history, s.
const HISTORY: f64 = 1.0e-2;
/// Initial position of the cylinder, m from the upper end of the incline.
pub const START: f64 = RADIUS + 0.8;

/// Smooth ramp from 0 to 1.
fn grown(part: f64) -> f64 {
    0.5 - 0.5 * (PI * part.clamp(0.0, 1.0)).cos()
}

/// Return the fraction of the tangential component of gravity at a time, s.
pub fn along(time: f64) -> f64 {
    grown(0.5 + time / LETTING)
}

/// Parameters of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Setup {
    pub incline: Incline,
    /// Three dimensions as in \[Ma2010\], or two for plane strain.
    pub dimensions: u32,
    pub detection: Detection,
    pub law: Law,
    /// Cells per radius; two particles per cell along each axis.
    pub cells: u32,
    /// Moduli of both bodies over those of \[Ma2010\].
    pub stiffness: f64,
    /// Time on the incline, s.
    pub end: f64,
    pub threads: usize,
}

impl Setup {
    /// Cell size, m.
    pub fn spacing(&self) -> f64 {
        RADIUS / f64::from(self.cells)
    }
    /// Return the cylinder of the exact solution.
    pub fn cylinder(&self) -> Cylinder {
        let compliance: f64 = [SOFT, HARD].map(|[_, young]| (1.0 - POISSON * POISSON) / young).iter().sum();
        Cylinder::elastic(RADIUS, SOFT[0], self.stiffness / compliance, GRAVITY * self.incline.angle.cos())
    }
    /// Return the name in file names.
    pub fn name(&self) -> String {
        let hundredths = (100.0 * self.incline.friction).round();
        format!("{}d_{}_{hundredths:03}_{}", self.dimensions, self.detection.name(), self.cells)
    }
}

/// Results of a run.
#[derive(Clone, Debug)]
pub struct Outcome {
    pub setup: Setup,
    pub rows: Vec<Row>,
    pub snapshots: Vec<Snapshot>,
    pub totals: Totals,
}

impl Outcome {
    /// Return the initial polar angles of the cylinder's particles, rad, by number.
    pub fn angles(&self) -> Result<Vec<f64>, GeometryError> {
        let seeds = layered::<3>(&self.setup)?;
        Ok(seeds.positions.iter().map(|[x, y, _]| (y - RADIUS).atan2(x - START)).collect())
    }
    /// Return the rows since the release of the cylinder.
    pub fn free(&self) -> &[Row] {
        let start = self.rows.partition_point(|r| r.time < -0.5 * LETTING);
        &self.rows[start..]
    }
}

/// Run the motion of the cylinder; write ParaView files if a folder is given.
pub fn roll(setup: &Setup, files: Option<&Path>, restart: &Restart) -> Result<Outcome, CaseError> {
    if setup.dimensions == 3 {
        run::<3>(setup, files, Method::new(Linear, Flip, Musl, FullSpace), restart)
    } else {
        run::<2>(setup, files, Method::new(Linear, Flip, Musl, PlaneStrain), restart)
    }
}

/// Truncate a point to its first `D` coordinates.
fn cut<const D: usize>(point: [f64; 3]) -> [f64; D] {
    let mut x = [0.0; D];
    x.copy_from_slice(&point[..D]);
    x
}

/// Return the number of particle layers along half the cylinder's axis.
fn layers(setup: &Setup) -> usize {
    if setup.dimensions == 3 { (LONG * f64::from(setup.cells) / RADIUS).round().max(1.0) as usize } else { 1 }
}

/// Seed the cylinder with concentric rings of particles; in three dimensions layers of them over half its length.
fn layered<const D: usize>(setup: &Setup) -> Result<Seeds<D>, GeometryError> {
    let layers = layers(setup);
    let disc = rings([START, RADIUS], RADIUS, 2 * setup.cells as usize)?;
    let depth = if D == 3 { 0.5 * LONG / layers as f64 } else { 1.0 };
    let (mut positions, mut volumes) = (Vec::new(), Vec::new());
    for layer in 0..layers {
        let z = (layer as f64 + 0.5) * depth;
        positions.extend(disc.positions.iter().map(|[x, y]| cut([*x, *y, z])));
        volumes.extend(disc.volumes.iter().map(|v| v * depth));
    }
    let [edge, _] = disc.half_size;
    Ok(Seeds::placed(positions, volumes, cut([edge, edge, 0.5 * depth])))
}

fn run<const D: usize>(
    setup: &Setup,
    files: Option<&Path>,
    method: impl IntoKernels<f64, D>,
    restart: &Restart,
) -> Result<Outcome, CaseError> {
    let h = setup.spacing();
    let friction = setup.law.pairs(setup.incline.friction, WAVE * setup.stiffness.sqrt(), h)?;
    let contact = GridContact::new(setup.detection.detector(Gradients::default())?, friction);
    let lattice = Lattice::new([0.0; D], h)?;
    let mut mpm = Mpm::with_contact(method, BlockGrid::new(lattice), contact);
    let [hard, soft] = [HARD, SOFT].map(|[density, young]| -> Result<NeoHookean<f64>, CaseError> {
        Ok(NeoHookean::new(density, Moduli::young_poisson(young * setup.stiffness, POISSON)?)?)
    });
    let (hard, soft) = (hard?, soft?);
    let bed = Cuboid::new(cut([0.0, -THICKNESS, 0.0]), cut([LENGTH, 0.0, 0.5 * LONG + MARGIN]))?;
    mpm.add("plane", hard, &fill(&bed, &lattice, 2, &Filling::new())?, |_| [0.0; D])?;
    let seeds = layered::<D>(setup)?;
    mpm.add("cylinder", soft, &seeds, |_| [0.0; D])?;
    mpm.bound(Boundary::Fixed { axis: 1, at: -THICKNESS, side: Side::Above })?;
    if D == 3 {
        mpm.bound(Boundary::Symmetry { axis: 2, at: 0.0, side: Side::Above })?;
    }
    let (sine, cosine) = setup.incline.angle.sin_cos();
    let zero = LAYING + 0.5 * LETTING;
    mpm.set_body_force(move |t| {
        cut([GRAVITY * sine * along(t - zero), -GRAVITY * cosine * grown(t / LAYING), 0.0])
    });
    mpm.set_team(Team::new(setup.threads)?);
    if setup.detection != Detection::Plane {
        // Other detections run to the end for comparison: the old test gains energy.
        mpm.set_watch(Watch::default().only_warn());
    }

    let mut track = Track::new(Pace::interval(HISTORY)?, h, seeds.half_size[0], zero);
    let mut bar = Progress::new(format!("{:<20}", setup.name()));
    let mut frames = match files {
        Some(folder) => {
            let pace = Pace::interval((zero + setup.end) / 10.0)?;
            Some(VtkSeries::create(folder.join("paraview"), setup.name(), pace)?)
        }
        None => None,
    };
    // Energy and momentum are recorded on the incline only.
    let mut ledger = Ledger::new(Pace::interval(HISTORY)?);
    let mut simulation = restart.scene(setup.name())?;
    for part in 0..=FRAMES {
        let end = if part == 0 { LAYING } else { zero + setup.end * f64::from(part) / f64::from(FRAMES) };
        let mut observers: Vec<&mut dyn Observer> = vec![&mut track, &mut bar];
        observers.extend(frames.as_mut().map(|f| f as &mut dyn Observer));
        if part > 0 {
            observers.push(&mut ledger);
        }
        simulation.until(&mut mpm, observers, end)?;
        if part > 0 {
            simulation.keep(|| mpm.snapshot())?;
        }
    }
    // Errors at the end, where the reference momentum is that of the rolling cylinder.
    let last = ledger.entries().last().copied().unwrap_or_default();
    let totals = Totals {
        energy_error: last.energy_error,
        momentum_error: last.momentum_error,
        ..Totals::of(&mpm, &simulation.summary(), &ledger)
    };
    Ok(Outcome { setup: *setup, rows: track.rows, snapshots: simulation.into_snapshots(), totals })
}

/// Number of snapshots for the picture.
pub const FRAMES: u32 = 3;
