//! Fragmentation of a fast ring in three dimensions, with sections of scattered strength.
//!
//! The half above the plane of symmetry z = 0 is computed.

use std::path::Path;

use examples::{CaseError, Fragments, Restart, Totals, mott_strains};
use mpm_core::geometry::{Compose, Cuboid, Filling, Lattice, Tube, fill};
use mpm_core::observe::{Ledger, Observer, Pace, Progress, VtkSeries};
use mpm_core::output::{ParticleSize, Snapshot};
use mpm_core::{BlockGrid, Boundary, Deformable, FullSpace, Method, Mpm, Side, Team};
use mpm_materials::{Constitutive, PlasticStrainLimit};

use crate::setup::{Break, law};

/// Number of pictures and counts of pieces.
pub const LOOKS: usize = 12;
/// Largest distance of particles of one piece, over that of neighbours along the ring at the mean stretch; the next but one
/// is twice as far.
const REACH: f64 = 1.6;

/// State of the ring at one time.
#[derive(Clone, Copy, Debug)]
pub struct Row {
    pub time: f64,
    /// Mean radius, m.
    pub radius: f64,
    /// Number of pieces heavier than a cube of the section's edge.
    pub pieces: usize,
    /// Mass of failed particles, over the whole.
    pub failed: f64,
}

/// Result of a run.
#[derive(Clone, Debug)]
pub struct Outcome {
    pub setup: Break,
    pub rows: Vec<Row>,
    /// Snapshots of positions, masses and failure.
    pub snapshots: Vec<Snapshot>,
    /// Masses of the pieces at the end, kg, of the whole ring.
    pub masses: Vec<f64>,
    /// Mass of the seeds over that of the shape.
    pub mass: f64,
    pub totals: Totals,
}

/// Return the failure strain of each section.
pub fn strains(setup: &Break) -> Vec<f64> {
    mott_strains(setup.strain, setup.scatter, setup.seed, setup.sections())
}

/// Run the ring until `end`, s.
pub fn burst(setup: &Break, end: f64, files: Option<&Path>, restart: &Restart) -> Result<Outcome, CaseError> {
    let (h, r0, t) = (setup.spacing(), setup.radius, setup.thickness);
    let lattice = Lattice::new([0.0; 3], h)?;
    let (low, high) = (r0 - 0.5 * t, r0 + 0.5 * t);
    let above = Cuboid::new([-high, -high, 0.0], [high, high, 0.5 * t])?;
    let ring = Tube::new([0.0, 0.0, -t], [0.0, 0.0, 1.0], 2.0 * t, low, high)?.and(above);
    let seeds = fill(&ring, &lattice, 2, &Filling::new().partial(4, 0.1))?;
    let strains = strains(setup);
    let most = strains.iter().fold(0.0_f64, |a, &b| a.max(b));
    let metal = law(&setup.metal)?.with_failure(PlasticStrainLimit::new(most)?);
    // Without hardening an initial plastic strain affects only the strain left until a point fails.
    let weakened = |x: [f64; 3]| {
        let turn = x[1].atan2(x[0]) / std::f64::consts::TAU;
        let section = ((turn - turn.floor()) * strains.len() as f64) as usize;
        let mut state = metal.virgin();
        state.strength.plastic_strain = most - strains[section.min(strains.len() - 1)];
        state
    };
    let speed = setup.metal.speed;
    let out = |x: [f64; 3]| {
        let r = x[0].hypot(x[1]);
        let across = speed * (1.0 - 0.5 * (r - r0) / r0);
        [across * x[0] / r, across * x[1] / r, -0.5 * speed * x[2] / r0]
    };
    let mut mpm = Mpm::new(Method::impact(FullSpace), BlockGrid::new(lattice));
    mpm.add_body(Deformable::new("ring", metal.compiled(), &seeds).in_state(weakened).moving(out))?;
    mpm.bound(Boundary::Symmetry { axis: 2, at: 0.0, side: Side::Above })?;
    mpm.set_team(Team::new(setup.threads)?);
    let mut ledger = Ledger::new(Pace::interval(end / 100.0)?);
    let mut bar = Progress::new(setup.name());
    let mut frames = None;
    if let Some(folder) = files {
        frames = Some(VtkSeries::create(folder.join("paraview"), setup.name(), Pace::interval(end / 20.0)?)?);
    }
    let mut simulation = restart.scene(setup.name())?;
    let cube = 0.5 * setup.metal.density * t.powi(3);
    let (mut rows, mut last) = (Vec::new(), Fragments::default());
    for look in 1..=LOOKS {
        let mut observers: Vec<&mut dyn Observer> = vec![&mut ledger, &mut bar];
        observers.extend(frames.as_mut().map(|f| f as &mut dyn Observer));
        simulation.until(&mut mpm, observers, end * look as f64 / LOOKS as f64)?;
        let snapshot = simulation.keep(|| taken(&mpm, 0.5 * h))?;
        // Snapshots come from the checkpoint if the run is resumed.
        let (masses, failed) = (snapshot.scalar("mass")?, snapshot.scalar("failed")?);
        let whole = masses.iter().sum::<f64>();
        let radius =
            snapshot.positions().iter().zip(masses).map(|(x, m)| m * x[0].hypot(x[1])).sum::<f64>() / whole;
        last = pieces(setup, snapshot, radius)?;
        rows.push(Row {
            time: snapshot.time(),
            radius,
            pieces: last.heavier(cube),
            failed: masses.iter().zip(failed).map(|(m, f)| m * f).sum::<f64>() / whole,
        });
    }
    let totals = Totals::of(&mpm, &simulation.summary(), &ledger);
    let shape = std::f64::consts::PI * (high * high - low * low) * 0.5 * t * setup.metal.density;
    let mass = mpm.totals().mass / shape;
    let snapshots = simulation.into_snapshots();
    Ok(Outcome {
        setup: *setup,
        rows,
        masses: last.masses.iter().map(|m| 2.0 * m).collect(),
        snapshots,
        mass,
        totals,
    })
}

/// Group the ring into pieces at this mean radius, m.
pub fn pieces(setup: &Break, snapshot: &Snapshot, radius: f64) -> Result<Fragments, CaseError> {
    let holds: Vec<bool> = snapshot.scalar("failed")?.iter().map(|&f| f == 0.0).collect();
    let reach = REACH * 0.5 * setup.spacing() * radius / setup.radius;
    Ok(Fragments::new(snapshot.positions(), snapshot.scalar("mass")?, &holds, reach))
}

/// Take a snapshot of positions, masses and failure.
fn taken(mpm: &Mpm<3>, size: f64) -> Result<Snapshot, CaseError> {
    let (mut places, mut masses, mut failed) = (Vec::new(), Vec::new(), Vec::new());
    mpm.bodies()[0].for_each(&mut |p| {
        places.push(p.position);
        masses.push(p.mass);
        failed.push(f64::from(u8::from(p.failed)));
    });
    let snapshot = Snapshot::new(3, mpm.time(), 0, places, ParticleSize::Uniform(size))?;
    Ok(snapshot.with_scalar("mass", masses)?.with_scalar("failed", failed)?)
}
