//! Scene and run.
//!
//! The container is a rigid body at rest, and gravity is shaken, as in the container's frame. First the discs fall into a pile for
//! [`SETTLING`] seconds. Quadratic splines with APIC let the pile come to rest; linear shape functions with FLIP, as in \[Ma2010\], retain
//! noise, by which the pile sinks into itself (book, "Bodies under load for long"). \[Ma2010\] lacks sizes, materials and forcing. Chosen
//! here: discs of 8 and 24 mm, soft for long steps, and shaking of 6 g at 10 Hz, which frees rough discs from the crystal packing of the
//! small ones (book, "Discs in a shaken container").

use std::f64::consts::TAU;
use std::path::Path;

use examples::{CaseError, Detection, Restart, Totals};
use mpm_contact::{Choice, Coulomb, Gradients, Pairs, Weight};
use mpm_core::GridContact;
use mpm_core::geometry::{Compose, Cuboid, Filling, Lattice, fill, rings};
use mpm_core::observe::{Ledger, Observer, Pace, Progress, VtkSeries};
use mpm_core::output::Snapshot;
use mpm_core::{
    Apic, BlockGrid, Method, Mpm, PlaneStrain, QuadraticBSpline, Rigid, Solver, Team, Twist, Usl,
};
use mpm_materials::{Moduli, NeoHookean};

use crate::layout::{LARGE, Layout, RADIUS};
use crate::watch::{Row, Watch};

/// Density, kg/m^3, and Poisson's ratio of the discs.
pub const MATERIAL: [f64; 2] = [1000.0, 0.3];
/// Gravity, m/s^2.
pub const GRAVITY: f64 = 9.81;
/// Duration of the initial fall of the discs, s.
pub const SETTLING: f64 = 0.4;
/// Displacement of discs, in cells, after which their gaps are re-evaluated: a tenth of the allowed overlap.
const KEEPS: f64 = 0.02;
/// Number of snapshots for the picture.
pub const FRAMES: u32 = 4;
/// Rows of a history per period of the shaking.
const ENTRIES: f64 = 16.0;

/// Parameters of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Setup {
    pub large: usize,
    pub small: usize,
    /// Cells per radius of a small disc; two particles per cell along each axis.
    pub cells: u32,
    /// Young's modulus, Pa.
    pub young: f64,
    pub detection: Detection,
    pub friction: f64,
    /// Largest acceleration of the shaking over gravity.
    pub strength: f64,
    /// Frequency of the shaking, Hz.
    pub frequency: f64,
    /// Duration of the shaking, s.
    pub shaking: f64,
    pub threads: usize,
}

impl Setup {
    /// Cell size, m.
    pub fn spacing(&self) -> f64 {
        RADIUS / f64::from(self.cells)
    }
    /// Return gravity in the container's frame, m/s^2.
    fn gravity(&self, time: f64) -> f64 {
        let shaken = time - SETTLING;
        let wave = if shaken > 0.0 { (TAU * self.frequency * shaken).sin() } else { 0.0 };
        -GRAVITY * (1.0 + self.strength * wave)
    }
}

/// Results of a run.
pub struct Outcome {
    pub setup: Setup,
    pub layout: Layout,
    pub rows: Vec<Row>,
    pub snapshots: Vec<Snapshot>,
    /// Largest later rise of the energy beyond the work done, over the largest energy.
    pub growth: f64,
    pub totals: Totals,
}

/// Run the shaking.
pub fn shake(setup: &Setup, folder: &Path, restart: &Restart) -> Result<Outcome, CaseError> {
    let h = setup.spacing();
    let layout = Layout::new(setup.large, setup.small);
    let lattice = Lattice::new([0.0; 2], h)?;
    let method = Method::new(QuadraticBSpline, Apic, Usl, PlaneStrain);
    let normals = Gradients::new(Weight::Mass, Choice::Collinear);
    let detector = setup.detection.detector(normals)?;
    let contact = GridContact::new(detector, Pairs::new(Coulomb::new(setup.friction)?)).keeping(KEEPS)?;
    let mut mpm = Mpm::with_contact(method, BlockGrid::new(lattice), contact);
    let (young, [density, poisson]) = (setup.young, MATERIAL);
    let [width, height] = layout.inside;
    let wall = 2.0 * h;
    let box_of = Cuboid::new([-wall, -wall], [width + wall, height + wall])?
        .minus(Cuboid::new([0.0; 2], layout.inside)?);
    let still = Rigid::prescribed(density, |_| Twist::along([0.0; 2]))?;
    mpm.add_rigid("container", &still, &fill(&box_of, &lattice, 2, &Filling::new())?)?;
    let law = NeoHookean::new(density, Moduli::young_poisson(young, poisson)?)?;
    for (n, disc) in layout.discs.iter().enumerate() {
        let count = (2.0 * disc.radius / h).round() as usize;
        mpm.add(&format!("disc {n}"), law, &rings(disc.centre, disc.radius, count)?, |_| [0.0; 2])?;
    }
    let gravity = *setup;
    mpm.set_body_force(move |t| [0.0, gravity.gravity(t)]);
    mpm.set_team(Team::new(setup.threads)?);

    let end = SETTLING + setup.shaking;
    let mut watch = Watch::new(Pace::interval(1.0 / (ENTRIES * setup.frequency))?, &layout, 0.25 * h);
    let mut ledger = Ledger::new(Pace::interval(1.0 / (ENTRIES * setup.frequency))?)
        .with_csv(folder.join("ledger.csv"))?;
    let mut bar = Progress::new("shaken_discs");
    let mut frames = VtkSeries::create(folder.join("paraview"), "discs", Pace::interval(end / 40.0)?)?;
    let mut simulation = restart.scene("discs")?;
    for frame in 0..FRAMES {
        let until = SETTLING + setup.shaking * f64::from(frame) / f64::from(FRAMES - 1);
        let observers: [&mut dyn Observer; 4] = [&mut watch, &mut ledger, &mut bar, &mut frames];
        simulation.until(&mut mpm, observers, until)?;
        simulation.keep(|| mpm.snapshot())?;
    }
    let totals = Totals::of(&mpm, &simulation.summary(), &ledger);
    Ok(Outcome {
        setup: *setup,
        layout,
        rows: watch.rows,
        snapshots: simulation.into_snapshots(),
        growth: growth(&ledger),
        totals,
    })
}

/// Return the largest later rise of kinetic + internal - work, over the largest energy. Dissipation by friction and impacts is not added:
/// ideally the sum never rises.
fn growth(ledger: &Ledger) -> f64 {
    let (mut least, mut most, mut scale) = (f64::INFINITY, 0.0f64, 0.0f64);
    for entry in ledger.entries() {
        least = least.min(entry.total - entry.friction);
        most = most.max(entry.total - entry.friction - least);
        scale = scale.max(entry.kinetic + entry.internal);
    }
    most / scale
}

/// True for the radius of a large disc, m.
pub fn is_large(radius: f64) -> bool {
    radius > 0.5 * (RADIUS + LARGE)
}
