//! Scene of disc and plate, and its run.

use std::path::Path;

use examples::{CaseError, Restart, Totals};
use mpm_core::geometry::{Ball, Compose, Cuboid, Filling, Lattice, fill};
use mpm_core::observe::{
    HistoryCsv, Ledger, ObserveError, Observer, Pace, Progress, RunView, Snapshots, VtkSeries,
};
use mpm_core::output::Snapshot;
use mpm_core::{Archive, CheckpointError, PlaneStrain, Team, TimeControl};
use mpm_materials::{TensilePressure, library};
use pcmm::{
    Audit, LocalDelaunay, Masses, Method, OfParticles, OverlapWeighted, Packing, Particle, Pcmm, StartOfStep,
};

/// Diameter of the disc, m.
pub const DIAMETER: f64 = 2.0e-3;
/// Thickness and height of the plate, m.
pub const PLATE: [f64; 2] = [1.0e-3, 16.0e-3];
/// Impact speed, m/s.
pub const SPEED: f64 = 5000.0;
/// End of a run, s.
pub const END: f64 = 2.68e-6;
/// Density, kg/m^3, bulk sound speed, m/s, slope of the Hugoniot, Grueneisen gamma.
pub const SHOCK: [f64; 4] = [2703.0, 5350.0, 1.34, 1.97];
/// Linear and quadratic coefficient of the bulk viscosity \[M\]; the paper states none.
const BULK_VISCOSITY: [f64; 2] = [0.1, 1.5];
/// Spall strength of aluminium at these rates, Pa \[M\]; the paper states no failure.
const SPALL: f64 = 1.2e9;
/// Time between two entries of the history, s.
const HISTORY: f64 = 0.01e-6;
/// Number of steps between two revisions.
const EVERY: u64 = 2;
/// Half width of the strip around the axis in which the shock is measured, m.
const STRIP: f64 = 0.2e-3;

/// Solver of disc and plate.
type Scene = Pcmm<2, Method<PlaneStrain, LocalDelaunay, OverlapWeighted, StartOfStep, OfParticles>>;

/// Result of the run.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// Shock pressure in the plate near the axis, Pa: median of the peak pressures of the particles two to five spacings
    /// behind its face. (The disc is round: pressure falls right behind the front, and along its path.)
    pub shock: f64,
    /// Time at which the last layer of the plate near the axis moved at 1 km/s, s after impact.
    pub arrival: f64,
    /// Mean position of the particles of the last layer near the axis, before impact, m.
    pub rear: f64,
    /// Front of the cloud, m behind the front face of the plate: particles within half the disc's radius of the axis. The
    /// jet from the rim of the contact is faster than any shock-driven material.
    pub front: f64,
    /// Mass fraction of particles faster than the impact.
    pub jet: f64,
    /// Largest speed of a particle, m/s.
    pub fastest: f64,
    /// Mean velocity of the material more than a plate's thickness behind the plate, m/s.
    pub cloud: f64,
    /// Fraction of particles in elements at the end.
    pub bound: f64,
    pub audit: Audit,
    /// Kinetic energy at the start, J.
    pub start: f64,
    /// Mass of the particles over that of disc and plate.
    pub mass: f64,
    pub frames: Vec<Snapshot>,
    pub totals: Totals,
}

/// Run the impact: the disc flies along x into the plate, whose front face is x = 0.
pub fn impact(
    spacing: f64,
    threads: usize,
    folder: &Path,
    frames: u32,
    restart: &Restart,
) -> Result<Outcome, CaseError> {
    let [linear, quadratic] = BULK_VISCOSITY;
    let law = library::aluminium_feng_2014()
        .with_failure(TensilePressure::new(SPALL)?)
        .with_bulk_viscosity(linear, quadratic)?;

    // Random displacement of every particle by up to a quarter of a spacing.
    let lattice = Lattice::new([0.0; 2], spacing)?;
    let plate = Cuboid::new([0.0, -0.5 * PLATE[1]], [PLATE[0], 0.5 * PLATE[1]])?;
    let disc = Ball::new([-0.5 * DIAMETER, 0.0], 0.5 * DIAMETER)?;
    let exact = PLATE[0] * PLATE[1] + std::f64::consts::FRAC_PI_4 * DIAMETER * DIAMETER;
    let packing = Packing::of_seeds(&fill(&plate.or(disc), &lattice, 1, &Filling::new().jittered(14, 0.5))?);
    let is_disc = |x: &[f64; 2]| x[0] < 0.0;
    let method = Method::consistent(PlaneStrain, LocalDelaunay::new(0.8 * spacing, 3.0)?);
    let velocity = |x: [f64; 2]| [if is_disc(&x) { SPEED } else { 0.0 }, 0.0];
    let mut scene = Pcmm::new(method, law, &packing, velocity, Masses::FromVolumes)?;
    scene.set_team(Team::new(threads)?);
    scene.set_time_control(TimeControl::Courant { factor: 0.3, growth: 1.1 })?;
    scene.set_revision_interval(EVERY)?;

    let near_axis = |x: &[f64; 2]| x[1].abs() < STRIP;
    // Particles behind the shock and away from the layer between disc and plate.
    let middle: Vec<usize> = (0..packing.positions.len())
        .filter(|&n| {
            let x = &packing.positions[n];
            near_axis(x) && x[0] > 2.0 * spacing && x[0] < 5.0 * spacing
        })
        .collect();
    let rear: Vec<usize> = (0..packing.positions.len())
        .filter(|&n| near_axis(&packing.positions[n]) && packing.positions[n][0] > PLATE[0] - spacing)
        .collect();
    let rear_place = rear.iter().map(|&n| packing.positions[n][0]).sum::<f64>() / rear.len() as f64;
    let columns =
        [("time", "s"), ("kinetic", "J"), ("internal", "J"), ("added by revisions", "J"), ("elements", "-")];
    let start = scene.totals();
    let path = folder.join("history.csv");
    let mut history = HistoryCsv::create(path, columns, Pace::interval(HISTORY)?, |now: &RunView<'_>| {
        let elements = now.solver_as::<Scene>()?.elements() as f64;
        let totals = now.totals();
        Ok(vec![now.time(), totals.kinetic, totals.internal, now.exchange().conversion, elements])
    })?;
    let highest = vec![0.0; middle.len()];
    let mut shock = Shock { pace: Pace::interval(HISTORY)?, middle, highest };
    let mut arrival = Arrival { pace: Pace::every_step(), rear, time: f64::NAN };
    let mut ledger = Ledger::new(Pace::interval(HISTORY)?);
    let mut bar = Progress::new("debris cloud");
    let (mut shown, mut series) = (None, None);
    if frames > 0 {
        let pace = Pace::interval(END / f64::from(frames))?;
        shown = Some(Snapshots::new(pace));
        series = Some(VtkSeries::create(folder.join("paraview"), "cloud", pace)?);
    }
    let mut observers: Vec<&mut dyn Observer> =
        vec![&mut history, &mut shock, &mut arrival, &mut ledger, &mut bar];
    observers.extend(shown.iter_mut().map(|s| s as &mut dyn Observer));
    observers.extend(series.iter_mut().map(|s| s as &mut dyn Observer));
    let mut simulation = restart.scene("cloud")?;
    simulation.until(&mut scene, observers, END)?;
    let totals = Totals::of(&scene, &simulation.summary(), &ledger);
    let mut highest = shock.highest;
    highest.sort_by(f64::total_cmp);
    let particles = scene.particles();
    let through = particles.iter().filter(|p| p.position[0] > 2.0 * PLATE[0]);
    let (mass, momentum) = through.fold((0.0, 0.0), |(m, q), p| (m + p.mass, q + p.mass * p.velocity[0]));
    let speed_of = |p: &Particle<2>| p.velocity[0].hypot(p.velocity[1]);
    let mut bound = vec![false; particles.len()];
    for &n in scene.element_nodes() {
        bound[n as usize] = true;
    }
    Ok(Outcome {
        shock: highest.get(highest.len() / 2).copied().unwrap_or(f64::NAN),
        arrival: arrival.time,
        rear: rear_place,
        front: particles
            .iter()
            .filter(|p| p.position[1].abs() < 0.25 * DIAMETER)
            .map(|p| p.position[0])
            .fold(0.0, f64::max),
        jet: particles.iter().filter(|p| speed_of(p) > SPEED).map(|p| p.mass).sum::<f64>() / start.mass,
        fastest: particles.iter().map(speed_of).fold(0.0, f64::max),
        cloud: momentum / mass,
        bound: bound.iter().filter(|b| **b).count() as f64 / bound.len() as f64,
        audit: *scene.audit(),
        start: start.kinetic,
        mass: start.mass / (SHOCK[0] * exact),
        frames: shown.map_or(Vec::new(), Snapshots::into_list),
        totals,
    })
}

/// Observer of the peak pressure of some particles before a wave can return to them.
struct Shock {
    pace: Pace,
    middle: Vec<usize>,
    /// Peak pressures, Pa.
    highest: Vec<f64>,
}

impl Observer for Shock {
    fn pace(&mut self) -> &mut Pace {
        &mut self.pace
    }
    fn observe(&mut self, now: &RunView<'_>) -> Result<(), ObserveError> {
        if now.time() < PLATE[0] / SPEED {
            let snapshot = now.snapshot()?;
            let pressure = snapshot.scalar("pressure")?;
            for (most, &n) in self.highest.iter_mut().zip(&self.middle) {
                *most = most.max(pressure[n]);
            }
        }
        Ok(())
    }
    fn archive(&mut self, file: &mut Archive) -> Result<(), CheckpointError> {
        file.reals(&mut self.highest)
    }
}

/// Observer of the time at which the mean speed of some particles exceeds 1 km/s.
struct Arrival {
    pace: Pace,
    rear: Vec<usize>,
    /// Time, s; NaN before.
    time: f64,
}

impl Observer for Arrival {
    fn pace(&mut self) -> &mut Pace {
        &mut self.pace
    }
    fn observe(&mut self, now: &RunView<'_>) -> Result<(), ObserveError> {
        let particles = now.solver_as::<Scene>()?.particles();
        let speed: f64 = self.rear.iter().map(|&n| particles[n].velocity[0]).sum();
        if self.time.is_nan() && speed > 1000.0 * self.rear.len() as f64 {
            self.time = now.time();
        }
        Ok(())
    }
    fn archive(&mut self, file: &mut Archive) -> Result<(), CheckpointError> {
        file.real(&mut self.time)
    }
}
