//! Slab: a row of cells between two planes of symmetry.
//!
//! Contiguous-particle GIMP, because the products expand to one and a half times their volume while they flow through the grid: contiguous
//! domains generate no force under uniform pressure. (A quadratic spline with APIC does, and dissipates a tenth of the energy at 4000
//! cells.) The noise of FLIP decays within a hundred transits of a cell.

use std::path::Path;

use examples::{CaseError, Restart, Totals};
use mpm_core::geometry::{Cuboid, Filling, Lattice, Seeds, fill};
use mpm_core::observe::{Ledger, Observer, Pace, Probe, ProbeRow, Probes, Progress, Quantity, VtkSeries};
use mpm_core::{
    Blend, BlockGrid, Boundary, CpGimp, Deformable, Method, Mpm, Musl, PlaneStrain, Side, Team, TimeControl,
};
use mpm_materials::{Constitutive, Detonation, Explosive, Jwl};

use crate::taylor_wave::{CHAPMAN_JOUGUET, TaylorWave};

/// Length of the slab, m.
pub const LENGTH: f64 = 0.1;
/// Positions of the pressure gauges, m (particles 500, 1600, 2800 and 3900 of the deck `Deto1k`).
pub const GAUGES: [f64; 4] = [0.0125, 0.04, 0.07, 0.0975];
/// End of the run, s: the front is then at 99.4 mm.
const END: f64 = 14.35e-6;
/// Cells across the slab.
const ROWS: f64 = 1.0;
/// Time constant of the FLIP-PIC blend, in transits of a cell by the detonation.
const FADING: f64 = 100.0;
/// Linear and quadratic coefficient of the bulk viscosity, of the same deck.
const BULK_VISCOSITY: [f64; 2] = [0.06, 1.5];
/// Number of rows of the gauges' histories.
const LOOKS: f64 = 1500.0;
/// Distance behind the front up to which the wave is compared, in cells: the front has a width.
const BEHIND_FRONT: f64 = 15.0;

/// Parameters of a run.
#[derive(Clone, Copy, Debug)]
pub struct Setup {
    /// Cells along the slab.
    pub cells: u32,
    /// Width of the burn, cells.
    pub burn_width: f64,
    /// True if compression ignites the explosive.
    pub compression_burn: bool,
    /// Courant number: time step over that of the sound speed.
    pub time_factor: f64,
    /// Number of threads.
    pub threads: usize,
}

impl Setup {
    /// Node spacing, m.
    pub fn spacing(&self) -> f64 {
        LENGTH / f64::from(self.cells)
    }
}

/// Record of a gauge.
#[derive(Clone, Debug)]
pub struct Gauge {
    /// Initial position of its cell, m.
    pub place: f64,
    /// Arrival time, s: the pressure exceeds half of its peak.
    pub arrival: f64,
    /// Largest pressure, Pa.
    pub peak: f64,
    /// History of time, s, and pressure, Pa.
    pub history: Vec<[f64; 2]>,
}

impl Gauge {
    fn of(place: f64, history: Vec<[f64; 2]>) -> Gauge {
        let peak = history.iter().map(|[_, p]| *p).fold(0.0, f64::max);
        let after = history.iter().position(|[_, p]| *p >= 0.5 * peak).unwrap_or(0);
        let ([t0, p0], [t1, p1]) = (history[after.saturating_sub(1)], history[after]);
        let share = if p1 > p0 { (0.5 * peak - p0) / (p1 - p0) } else { 1.0 };
        Gauge { place, arrival: t0 + share * (t1 - t0), peak, history }
    }
}

/// Particle at the end.
#[derive(Clone, Copy, Debug)]
pub struct Point {
    /// Position, m.
    pub x: f64,
    /// Velocity, m/s.
    pub speed: f64,
    /// Pressure, Pa.
    pub pressure: f64,
}

/// Results of a run.
pub struct Outcome {
    /// Gauges, by distance.
    pub gauges: Vec<Gauge>,
    /// Particles at the end, by position.
    pub profile: Vec<Point>,
    /// Exact flow.
    pub wave: TaylorWave,
    /// Time at the end, s.
    pub time: f64,
    /// Mean deviations from the exact flow, of u / u_CJ and of p / p_CJ.
    pub wave_errors: [f64; 2],
    /// Totals of the run.
    pub totals: Totals,
}

/// Run the detonation of the slab, lit at the wall x = 0.
pub fn burn(setup: &Setup, folder: &Path, frames: u32, restart: &Restart) -> Result<Outcome, CaseError> {
    let h = setup.spacing();
    let lattice = Lattice::new([0.0; 2], h)?;
    let seeds = fill(&Cuboid::new([0.0; 2], [LENGTH, ROWS * h])?, &lattice, 2, &Filling::new())?;
    let mut charge = Explosive::<f64>::tnt().with_burn_width(setup.burn_width)?;
    if !setup.compression_burn {
        charge = charge.without_compression_burn();
    }
    let [linear, quadratic] = BULK_VISCOSITY;
    let charge = charge.with_bulk_viscosity(linear, quadratic)?;
    let wave = Detonation::new(charge.detonation_speed())?.from_plane([0.0; 3], [1.0, 0.0, 0.0], 0.0)?;
    let lit = |[x, y]: [f64; 2]| {
        let arrival = wave.arrival([x, y, 0.0]);
        arrival.and_then(|t| charge.lit_after(t).ok()).unwrap_or_else(|| charge.virgin())
    };

    let fading = Blend::new(FADING * h / charge.detonation_speed())?;
    let method = Method::new(CpGimp, fading, Musl, PlaneStrain);
    let mut mpm = Mpm::new(method, BlockGrid::new(lattice));
    mpm.add_body(Deformable::new("TNT", charge, &seeds).in_state(lit))?;
    mpm.bound(Boundary::Wall { axis: 0, at: 0.0, side: Side::Above, velocity: 0.0 })?;
    mpm.bound(Boundary::Symmetry { axis: 1, at: 0.0, side: Side::Above })?;
    mpm.bound(Boundary::Symmetry { axis: 1, at: ROWS * h, side: Side::Below })?;
    mpm.set_time_control(TimeControl::Courant { factor: setup.time_factor, growth: 1.1 })?;
    mpm.set_team(Team::new(setup.threads)?);

    let cells = GAUGES.map(|x| in_cell(&seeds, x, h));
    let probes = cells.iter().flatten().map(|p| Probe::new(0, *p, Quantity::Pressure));
    let mut probes = Probes::new(probes, Pace::interval(END / LOOKS)?).with_csv(folder.join("gauges.csv"))?;
    let mut ledger = Ledger::new(Pace::interval(END / 200.0)?).with_csv(folder.join("ledger.csv"))?;
    let mut progress = Progress::new("slab");
    let mut series = None;
    if frames > 0 {
        let pace = Pace::interval(END / f64::from(frames))?;
        series = Some(VtkSeries::create(folder.join("paraview"), "slab", pace)?);
    }
    let mut observers: Vec<&mut dyn Observer> = vec![&mut probes, &mut ledger, &mut progress];
    observers.extend(series.iter_mut().map(|s| s as &mut dyn Observer));
    let mut simulation = restart.scene("slab")?;
    simulation.until(&mut mpm, observers, END)?;

    let mut profile = Vec::new();
    mpm.bodies()[0].for_each(&mut |p| {
        let pressure = p.pressure();
        profile.push(Point { x: p.position[0], speed: p.velocity[0], pressure });
    });
    profile.sort_by(|a, b| a.x.total_cmp(&b.x));
    let exact = TaylorWave::of(&Jwl::tnt());
    let totals = Totals::of(&mpm, &simulation.summary(), &ledger);
    let mut first = 0;
    let gauges = cells.iter().map(|cell| {
        let own = first..first + cell.len();
        first = own.end;
        let mean = |row: &ProbeRow| row.values[own.clone()].iter().sum::<f64>() / own.len() as f64;
        let place = cell.iter().map(|&n| seeds.positions[n][0]).sum::<f64>() / cell.len() as f64;
        Gauge::of(place, probes.rows().iter().map(|row| [row.time, mean(row)]).collect())
    });
    Ok(Outcome {
        gauges: gauges.collect(),
        wave_errors: wave_errors(&profile, &exact, mpm.time(), h),
        profile,
        wave: exact,
        time: mpm.time(),
        totals,
    })
}
/// Return the indices of the seeds in the cell at a position: behind a front their states differ slightly.
fn in_cell(seeds: &Seeds<2>, place: f64, h: f64) -> Vec<usize> {
    let cell = (place / h).floor();
    let numbered = seeds.positions.iter().enumerate();
    numbered.filter(|(_, x)| (x[0] / h).floor() == cell).map(|(n, _)| n).collect()
}

/// Return the mean deviations of the particles behind the front from the exact flow.
fn wave_errors(profile: &[Point], wave: &TaylorWave, time: f64, h: f64) -> [f64; 2] {
    let [detonation, pressure, _, speed] = CHAPMAN_JOUGUET;
    let front = detonation * time - BEHIND_FRONT * h;
    let behind: Vec<&Point> = profile.iter().filter(|p| p.x < front).collect();
    let mut sums = [0.0; 2];
    for p in &behind {
        let exact = wave.at(p.x / time);
        sums[0] += (p.speed - exact.speed).abs() / speed;
        sums[1] += (p.pressure - exact.pressure).abs() / pressure;
    }
    sums.map(|s| s / behind.len().max(1) as f64)
}
