//! Plane shock: state behind it, measured on a row of cells as wide as those of the cloud, and highest speed of a free surface.

use examples::{CaseError, Restart, Totals};
use mpm_core::geometry::{Cuboid, Filling, Lattice, fill};
use mpm_core::observe::{Ledger, Observer, Pace};
use mpm_core::{BlockGrid, Boundary, Mpm, PlaneStrain, Side, TimeControl};
use mpm_materials::eos::Terms;
use mpm_materials::{Constitutive, Eos, Wide};

use crate::setup::{SHOCK, SPEED, Setup, equation_of_state, lead};

/// Cells along each of the two plates of the row.
const CELLS: f64 = 80.0;
/// Averaging range of the state in the target: from this part of the front's path (the start leaves heat next to the plane
/// of impact) to this many cells behind the front.
const FROM: f64 = 0.4;
const BEHIND: f64 = 15.0;

/// State behind a plane shock between like materials: particle speed, m/s, front, m/s, pressure, Pa, rho0/rho.
#[derive(Clone, Copy, Debug)]
pub struct Shocked {
    pub particle: f64,
    pub front: f64,
    pub pressure: f64,
    pub volume_ratio: f64,
}

/// Compute the state by the Rankine-Hugoniot relations, with the Hugoniot line of lead.
pub fn shocked() -> Shocked {
    let [density, sound, slope] = SHOCK;
    let particle = 0.5 * SPEED;
    let front = sound + slope * particle;
    Shocked { particle, front, pressure: density * front * particle, volume_ratio: 1.0 - particle / front }
}

/// Speed of a free surface after the shock, m/s: u + int sqrt(-dp dV) along the isentrope of lead's equation of state, from
/// the state behind the shock to zero pressure. Released metal that is this hot is faster than 2 u.
pub fn free_surface() -> f64 {
    const STEPS: usize = 200_000;
    let metal = equation_of_state();
    let density = SHOCK[0];
    let from = shocked();
    let pressure = |ratio: f64, energy: f64| {
        let Terms { cold: Wide([cold]), thermal: Wide([thermal]) } = metal.terms(Wide([ratio]));
        cold + thermal * energy
    };
    let mut ratio = from.volume_ratio;
    let mut energy = 0.5 * density * from.particle * from.particle;
    let mut p = pressure(ratio, energy);
    let mut speed = from.particle;
    let step = 4.0 / STEPS as f64;
    while p > 0.0 && ratio < 4.0 {
        // Trapezoidal rule; the end pressure uses the energy by the old pressure.
        let guess = pressure(ratio + step, energy - p * step);
        energy -= 0.5 * (p + guess) * step;
        ratio += step;
        let next = pressure(ratio, energy).max(0.0);
        speed += ((p - next).max(0.0) * step / density).sqrt();
        p = next;
    }
    speed
}

/// Result of the row of cells.
#[derive(Clone, Debug)]
pub struct Row {
    /// Mean pressure, Pa, and rho0/rho behind the front.
    pub pressure: f64,
    pub volume_ratio: f64,
    /// Position over the front's path, pressure over that of the theory.
    pub profile: Vec<[f64; 2]>,
    pub totals: Totals,
}

/// Run a plane impact of lead on lead at the speed of the case.
pub fn row(setup: &Setup, restart: &Restart) -> Result<Row, CaseError> {
    let theory = shocked();
    let h = setup.spacing();
    let lattice = Lattice::new([0.0; 2], h)?;
    let mut mpm = Mpm::new(setup.method(PlaneStrain)?, BlockGrid::new(lattice));
    for (name, cells, speed) in [("target", [0.0, CELLS], 0.0), ("flyer", [-CELLS, 0.0], SPEED)] {
        let plate = Cuboid::new([cells[0] * h, 0.0], [cells[1] * h, h])?;
        mpm.add(
            name,
            lead(setup.viscosity)?.compiled(),
            &fill(&plate, &lattice, 2, &Filling::new())?,
            |_| [speed, 0.0],
        )?;
    }
    mpm.bound(Boundary::Symmetry { axis: 1, at: 0.0, side: Side::Above })?;
    mpm.bound(Boundary::Symmetry { axis: 1, at: h, side: Side::Below })?;
    mpm.set_time_control(TimeControl::Courant { factor: setup.factor, growth: 1.1 })?;
    let end = 0.95 * CELLS * h / theory.front;
    let mut ledger = Ledger::new(Pace::interval(end / 50.0)?);
    let mut simulation = restart.scene("plane")?;
    let observers: [&mut dyn Observer; 1] = [&mut ledger];
    simulation.until(&mut mpm, observers, end)?;

    let (front, plane) = (theory.front * end, theory.particle * end);
    let mut points = Vec::new();
    mpm.bodies()[0].for_each(&mut |p| {
        let pressure = p.pressure();
        points.push([p.position[0], pressure, p.volume * SHOCK[0] / p.mass]);
    });
    points.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let from = plane + FROM * (front - plane);
    let behind: Vec<[f64; 3]> =
        points.iter().filter(|p| p[0] > from && p[0] < front - BEHIND * h).copied().collect();
    let mean = |column: usize| behind.iter().map(|p| p[column]).sum::<f64>() / behind.len() as f64;
    let pressure = mean(1);
    Ok(Row {
        pressure,
        volume_ratio: mean(2),
        profile: points.iter().map(|p| [p[0] / front, p[1] / theory.pressure]).collect(),
        totals: Totals::of(&mpm, &simulation.summary(), &ledger),
    })
}
