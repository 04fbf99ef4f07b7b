//! Scene and run.

use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering};

use examples::{CaseError, Restart, Simulation, Totals, largest, methods, worst};
use mpm_contact::Gradients;
use mpm_core::GridContact;
use mpm_core::geometry::{Filling, Lattice, Ring, Seeds, fill};
use mpm_core::observe::{Ledger, LedgerEntry, Observer, Pace, RunView, VtkSeries};
use mpm_core::output::Snapshot;
use mpm_core::{
    BlockGrid, CpGimp, Flip, IntoKernels, Kernels, Linear, Method, Mpm, Musl, PlaneStrain, RunError,
    RunSummary, Team, TimeControl,
};
use mpm_materials::{Moduli, NeoHookean};

use crate::setup::{Kernel, Scheme, Seeding, Setup};
use crate::surface::Surface;
use crate::watch::{Look, Row, Watch, velocities};

/// Inner radius of the rings, m.
pub const INNER: f64 = 30.0e-3;
/// Outer radius of the rings, m.
pub const OUTER: f64 = 40.0e-3;
/// Thickness of the rings, m: plane strain is per metre.
pub const THICKNESS: f64 = 10.0e-3;
/// Speed of each ring, m/s.
pub const SPEED: f64 = 30.0;
/// Bulk and shear modulus, Pa; density, kg/m^3.
const MODULI: [f64; 2] = [121.7e6, 26.1e6];
const DENSITY: f64 = 1010.0;
/// Initial gap between the rings, m.
pub const GAP: f64 = 20.0e-3;
/// End of the run, s.
pub const END: f64 = 3.5e-3;
/// Energy over its initial value above which a run is stopped.
pub const TOO_MUCH: f64 = 3.0;
/// Times of the pictures, s.
pub const PICTURES: [f64; 4] = [0.0, 0.6e-3, 1.2e-3, 3.0e-3];

/// Seed a ring about `centre` with particles of size `particle`, m.
fn ring(
    centre: [f64; 2],
    particle: f64,
    seeding: Seeding,
    lattice: &Lattice<2>,
) -> Result<Seeds<2>, CaseError> {
    if seeding == Seeding::Lattice {
        return Ok(fill(&Ring::new(centre, INNER, OUTER)?, lattice, 2, &Filling::new())?);
    }
    let layers = ((OUTER - INNER) / particle).round();
    // An even number, so that both halves are alike.
    let around = 2.0 * (std::f64::consts::PI * 0.5 * (INNER + OUTER) / particle).round();
    let (depth, angle) = ((OUTER - INNER) / layers, std::f64::consts::TAU / around);
    let (mut positions, mut volumes) = (Vec::new(), Vec::new());
    for i in 0..layers as usize {
        let radius = INNER + (i as f64 + 0.5) * depth;
        for j in 0..around as usize {
            let (sin, cos) = ((j as f64 + 0.5) * angle).sin_cos();
            positions.push([centre[0] + radius * cos, centre[1] + radius * sin]);
            volumes.push(radius * depth * angle);
        }
    }
    Ok(Seeds::placed(positions, volumes, [0.5 * depth; 2]))
}

/// Results of a run.
#[derive(Clone, Debug)]
pub struct Outcome {
    pub setup: Setup,
    pub rows: Vec<Row>,
    /// Closest approach at the start of the first step with contact, m; NaN without contact.
    pub onset: f64,
    /// End times of the first and last step with contact, s.
    pub contact: [f64; 2],
    pub snapshots: Vec<Snapshot>,
    /// Change of kinetic and internal energy at the end, over the initial energy. Frictional work counts as lost.
    pub error: f64,
    /// Largest rise of the energy above the initial one, over the initial energy.
    pub rise: f64,
    /// Work of friction by the ledger, over the initial energy.
    pub friction: f64,
    /// Reason for an early stop: more than [`TOO_MUCH`] times the energy, or a failed particle.
    pub stopped: Option<String>,
    /// Relative velocity of the rings at the end over that at impact (coefficient of restitution).
    pub rebound: f64,
    pub totals: Totals,
}

impl Outcome {
    /// Return the force-weighted mean of the closest approach during contact, m.
    pub fn pressed(&self) -> f64 {
        let sum = |of: fn(&Row) -> f64| self.rows.iter().map(of).sum::<f64>();
        sum(|r| r.force * r.gap) / sum(|r| r.force)
    }
    /// Return the smallest closest approach, m.
    pub fn least(&self) -> f64 {
        self.rows.iter().map(|r| r.gap).fold(f64::INFINITY, f64::min)
    }
    /// Return the largest contact force, N.
    pub fn most_force(&self) -> f64 {
        self.rows.iter().map(|r| r.force).fold(0.0, f64::max)
    }
}

/// Run many pairs of rings, `workers` at a time: each has too few particles for several threads. Detailed runs write a ParaView series to
/// `folder`.
pub fn collide_all(
    setups: &[(Setup, Look)],
    folder: &Path,
    workers: usize,
    restart: &Restart,
) -> Result<Vec<Outcome>, CaseError> {
    let next = AtomicUsize::new(0);
    let work = || {
        let mut done = Vec::new();
        while let Some((setup, look)) = setups.get(next.fetch_add(1, Ordering::Relaxed)) {
            done.push((*setup, *look, collide(setup, *look, folder, restart)));
        }
        done
    };
    let mut done = Vec::new();
    std::thread::scope(|scope| {
        let threads: Vec<_> = (0..workers).map(|_| scope.spawn(work)).collect();
        for thread in threads {
            done.extend(thread.join().unwrap_or_default());
        }
    });
    let mut ordered = Vec::new();
    for wanted in setups {
        let place = done.iter().position(|d| (d.0, d.1) == *wanted);
        let outcome = place.map(|p| done.swap_remove(p).2);
        ordered.push(outcome.ok_or_else(|| CaseError::Other("a run was lost".into()))??);
    }
    Ok(ordered)
}

/// Run the collision of one pair of rings.
fn collide(setup: &Setup, look: Look, folder: &Path, restart: &Restart) -> Result<Outcome, CaseError> {
    let method = match (setup.kernel, setup.scheme) {
        (Kernel::Linear, Scheme::Usf) => methods::linear_usf(),
        (Kernel::Linear, Scheme::Musl) => Method::new(Linear, Flip, Musl, PlaneStrain).into_kernels(),
        (Kernel::Cpgimp, Scheme::Usf) => methods::cpgimp_usf(),
        (Kernel::Cpgimp, Scheme::Musl) => Method::new(CpGimp, Flip, Musl, PlaneStrain).into_kernels(),
    };
    // Label unique among all runs.
    let label = format!("{}_{}_{}", setup.name(), setup.factor, look.name());
    run(setup, (look, folder), method, restart.scene(label)?)
}

fn run(
    setup: &Setup,
    (look, folder): (Look, &Path),
    method: Kernels<f64, 2>,
    mut simulation: Simulation,
) -> Result<Outcome, CaseError> {
    let lattice = Lattice::new([0.0; 2], setup.cell)?;
    let law = NeoHookean::new(DENSITY, Moduli::bulk_shear(MODULI[0], MODULI[1])?)?;
    let fast = ((MODULI[0] + MODULI[1] * 4.0 / 3.0) / DENSITY).sqrt();
    let laws = setup.law.pairs(setup.friction, fast, setup.cell)?;
    let contact = GridContact::new(setup.detection.detector(Gradients::default())?, laws);
    let mut mpm = Mpm::with_contact(method, BlockGrid::new(lattice), contact);
    mpm.set_team(Team::new(1)?);
    mpm.set_time_control(TimeControl::Courant { factor: setup.factor, growth: 1.1 })?;
    let apart = OUTER + 0.5 * GAP;
    let mut surfaces = Vec::new();
    for (name, side) in [("left", -1.0), ("right", 1.0)] {
        // The middle of the gap is at x = 100 mm, a node.
        let centre = [0.1 + side * apart, 0.05 + 0.5 * side * setup.offset];
        let seeds = ring(centre, 0.5 * setup.cell, setup.seeding, &lattice)?;
        surfaces.push(Surface::new(&seeds, centre, -side, 0.5 * setup.cell));
        mpm.add(name, law, &seeds, |_| [-side * SPEED, 0.0])?;
    }
    let start = THICKNESS * mpm.totals().kinetic;
    let mut ledger = Ledger::new(Pace::interval(END / 350.0)?);
    let mut watch = Watch::new(surfaces, look)?;
    let mut observers: Vec<&mut dyn Observer> = vec![&mut ledger, &mut watch];
    let mut series;
    if look == Look::Closely {
        series = VtkSeries::create(folder.join("paraview"), setup.name(), Pace::interval(END / 35.0)?)?;
        observers.push(&mut series);
    }
    let (summary, stopped) = match simulation.until(&mut mpm, observers, END) {
        Ok(()) => (simulation.summary(), None),
        Err(e @ (RunError::Observe { .. } | RunError::Step(_))) => {
            (RunSummary::default(), Some(e.to_string()))
        }
        Err(e) => return Err(e.into()),
    };
    let entries = ledger.entries();
    let velocity = velocities(&RunView::of(&mpm));
    let energy = |e: &LedgerEntry| THICKNESS * (e.kinetic + e.internal) / start - 1.0;
    Ok(Outcome {
        setup: *setup,
        onset: watch.onset,
        contact: watch.contact,
        snapshots: watch.snapshots,
        error: if stopped.is_some() { f64::INFINITY } else { entries.last().map_or(f64::NAN, energy) },
        rise: largest(entries.iter().map(energy)),
        friction: entries.last().map_or(0.0, |e| THICKNESS * e.friction / start),
        stopped,
        rebound: (velocity[1] - velocity[0]) / (2.0 * SPEED),
        totals: Totals {
            energy_error: worst(entries.iter().map(energy)),
            ..Totals::of(&mpm, &summary, &ledger)
        },
        rows: watch.rows,
    })
}
