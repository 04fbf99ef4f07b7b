//! Scene and run.

use std::sync::Arc;

use clap::ValueEnum;
use examples::{CaseError, Detection, Restart, Totals};
use mpm_contact::{Coulomb, Gradients, Pairs};
use mpm_core::GridContact;
use mpm_core::geometry::{Ball, Cuboid, Filling, Lattice, fill};
use mpm_core::observe::{Ledger, ObserveError, Observer, Pace, Progress, RunView, VtkSeries};
use mpm_core::output::Snapshot;
use mpm_core::{
    Archive, Blend, BlockGrid, Boundary, CheckpointError, ContactAlgorithm, Deformable, FullSpace, Linear,
    Method, Mpm, Musl, OneField, Side, Solver, Team, Traction,
};
use mpm_materials::{Moduli, NeoHookean};
use serde::Serialize;

use crate::chain;

/// Aluminium; the paper has no further constants.
pub const ALUMINIUM: chain::Ball =
    chain::Ball { diameter: 0.01, density: 2700.0, young: 70.0e9, poisson: 0.33 };
/// Cells per diameter; two particles per cell along each axis.
pub const CELLS: u32 = 5;
/// Cell size, m.
pub const SPACING: f64 = ALUMINIUM.diameter / CELLS as f64;

/// Time constant of the FLIP-PIC blend, in cell transits of sound. Without it, contacts that open and close on balls at rest keep the
/// particles vibrating, and finally gain energy.
const MEMORY: f64 = 5.0;

/// Are the balls kept apart?
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Switch {
    /// Contact by the distance of surfaces
    On,
    /// One velocity field for all: balls stick where they touch
    Off,
}

/// Parameters of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Setup {
    /// Balls along each edge of the pack.
    pub balls: u32,
    pub contact: Switch,
    pub detection: Detection,
    pub friction: f64,
    /// Pressure on the plate from the start, Pa.
    pub pressure: f64,
    pub threads: usize,
}

impl Setup {
    /// Edge of the pack, m.
    pub fn edge(&self) -> f64 {
        f64::from(self.balls) * ALUMINIUM.diameter
    }
    /// Return the transit time of the longitudinal wave through balls and plate as one block, s.
    pub fn transit(&self) -> f64 {
        f64::from(self.balls + 1) * ALUMINIUM.diameter / ALUMINIUM.wave_speed()
    }
    /// Return the end of the run, s.
    pub fn end(&self) -> f64 {
        END * self.transit()
    }
    /// Return the load on the whole plate, N.
    pub fn load(&self) -> f64 {
        self.pressure * self.edge() * self.edge()
    }
}

/// Results of a run.
pub struct Outcome {
    /// Time, s, and reaction of the ground over the load, every step.
    pub reaction: Vec<[f64; 2]>,
    pub snapshots: Vec<Snapshot>,
    /// Largest number of body pairs in contact in a step.
    pub faces: usize,
    pub totals: Totals,
}

/// Return the contact algorithm.
pub fn contact(setup: &Setup) -> Result<impl ContactAlgorithm<f64, 3> + use<>, CaseError> {
    let laws = Pairs::new(Coulomb::new(setup.friction)?);
    Ok(GridContact::new(setup.detection.detector(Gradients::default())?, laws))
}

/// Build the pack in its container of five symmetry planes, under the plate. (Unilateral walls would let the outer balls separate, but gain
/// as much energy as the load supplies within 200 microseconds.)
pub fn pack(setup: &Setup, contact: impl ContactAlgorithm<f64, 3>) -> Result<Mpm<3>, CaseError> {
    let (edge, d) = (setup.edge(), ALUMINIUM.diameter);
    let lattice = Lattice::new([0.0; 3], SPACING)?;
    let memory = MEMORY * SPACING / ALUMINIUM.wave_speed();
    let blend = Blend::new(memory)?;
    let method = Method::new(Linear, blend, Musl, FullSpace);
    let mut mpm = Mpm::with_contact(method, BlockGrid::new(lattice), contact);
    let moduli = Moduli::young_poisson(ALUMINIUM.young, ALUMINIUM.poisson)?;
    let law = NeoHookean::new(ALUMINIUM.density, moduli)?;
    for n in 0..setup.balls.pow(3) {
        let place = [n, n / setup.balls, n / setup.balls.pow(2)];
        let centre = place.map(|i| (f64::from(i % setup.balls) + 0.5) * d);
        let seeds = fill(&Ball::new(centre, 0.5 * d)?, &lattice, 2, &Filling::new())?;
        mpm.add(&format!("ball {n}"), law, &seeds, |_| [0.0; 3])?;
    }
    let plate = fill(&Cuboid::new([0.0, 0.0, edge], [edge, edge, edge + d])?, &lattice, 2, &Filling::new())?;
    let top = Cuboid::new([0.0, 0.0, edge + d - 0.5 * SPACING], [edge, edge, edge + d])?;
    let pressure = setup.pressure;
    let load = Traction {
        region: Arc::new(top),
        axis: 2,
        history: Arc::new(move |_| [0.0, 0.0, -pressure]),
        revolved: false,
    };
    mpm.add_body(Deformable::new("plate", law, &plate).with_traction(load))?;
    for axis in 0..3 {
        mpm.bound(Boundary::Symmetry { axis, at: 0.0, side: Side::Above })?;
        if axis < 2 {
            mpm.bound(Boundary::Symmetry { axis, at: edge, side: Side::Below })?;
        }
    }
    mpm.set_team(Team::new(setup.threads)?);
    Ok(mpm)
}

/// Times of the pictures, in transits of the longitudinal wave through pack and plate.
const MOMENTS: [f64; 6] = [0.5, 1.0, 1.5, 2.5, 4.0, 6.0];
/// End of a run, in transits of the longitudinal wave.
pub const END: f64 = 40.0;

/// Run the loading, with snapshots at [`MOMENTS`].
pub fn press(setup: &Setup, files: Option<VtkSeries>, restart: &Restart) -> Result<Outcome, CaseError> {
    match setup.contact {
        Switch::On => run(setup, files, pack(setup, contact(setup)?)?, restart),
        Switch::Off => run(setup, files, pack(setup, OneField)?, restart),
    }
}

fn run(
    setup: &Setup,
    mut files: Option<VtkSeries>,
    mut mpm: Mpm<3>,
    restart: &Restart,
) -> Result<Outcome, CaseError> {
    let mut ground =
        Ground { pace: Pace::every_step(), load: setup.load(), last: [0.0; 2], rows: vec![], faces: 0 };
    let mut ledger = Ledger::new(Pace::interval(setup.end() / 20.0)?);
    let mut bar = Progress::new("pressed balls");
    let mut simulation = restart.scene("balls")?;
    for moment in MOMENTS.into_iter().chain([END]) {
        let mut observers: Vec<&mut dyn Observer> = vec![&mut ground, &mut ledger, &mut bar];
        observers.extend(files.as_mut().map(|f| f as &mut dyn Observer));
        simulation.until(&mut mpm, observers, moment * setup.transit())?;
        if moment < END {
            simulation.keep(|| mpm.snapshot())?;
        }
    }
    let last = ledger.entries().last().copied().unwrap_or_default();
    let totals = Totals {
        energy_error: ledger
            .entries()
            .iter()
            .map(|e| e.energy_error)
            .fold(f64::NEG_INFINITY, |a, b| if b.is_nan() || b > a { b } else { a }),
        momentum_error: last.momentum_error,
        ..Totals::of(&mpm, &simulation.summary(), &ledger)
    };
    let snapshots = simulation.into_snapshots();
    Ok(Outcome { reaction: ground.rows, snapshots, faces: ground.faces, totals })
}

/// Observer of the reaction of the ground, the only plane normal to z.
struct Ground {
    pace: Pace,
    load: f64,
    /// Time, s, and impulse so far, N s.
    last: [f64; 2],
    rows: Vec<[f64; 2]>,
    faces: usize,
}

impl Observer for Ground {
    fn pace(&mut self) -> &mut Pace {
        &mut self.pace
    }

    fn observe(&mut self, now: &RunView<'_>) -> Result<(), ObserveError> {
        let impulse = now.exchange().impulse[2];
        if now.time() > self.last[0] {
            let force = (impulse - self.last[1]) / (now.time() - self.last[0]);
            self.rows.push([now.time(), force / self.load]);
        }
        self.last = [now.time(), impulse];
        self.faces = self.faces.max(now.contacts().iter().filter(|c| c.places > 0).count());
        Ok(())
    }

    fn archive(&mut self, file: &mut Archive) -> Result<(), CheckpointError> {
        file.reals(&mut self.last)?;
        file.list(&mut self.rows, &[0.0; 2], |file, row| file.reals(row))?;
        file.count(&mut self.faces)
    }
}
