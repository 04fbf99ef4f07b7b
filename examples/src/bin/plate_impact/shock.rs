//! The shock line of a metal, measured: the front between two gauges, the state behind it.
//!
//! The metal is its equation of state alone, a fluid: with strength the stress behind the shock is p + 2Y/3, an
//! elastic precursor runs ahead of slow shocks, and the line is no longer that of the source.

use examples::{CaseError, Totals};
use mpm_materials::{Fluid, IntoMaterial};

use crate::metals::{Metal, Shocked};
use crate::plates::{self, Files, Look, Plates, Point};

/// Thickness of both plates, m. Nothing but h over it matters: the flow is self-similar.
pub const THICKNESS: f64 = 0.02;
/// The two gauges, parts of the thickness.
const GAUGES: [f64; 2] = [0.35, 0.85];
/// The run ends when the front should be here, a part of the thickness.
const REACH: f64 = 0.92;
/// The state is a mean from here, a part of the front's way: next to the plane of impact the start has left some heat.
const FROM: f64 = 0.5;
/// The state is a mean up to here behind the front, in cells: the front has a width.
const BEHIND_FRONT: f64 = 15.0;

/// How to run.
#[derive(Clone, Copy, Debug)]
pub struct Setup {
    /// Cells along each plate.
    pub cells: u32,
    /// Linear and quadratic coefficient of the bulk viscosity.
    pub viscosity: [f64; 2],
}

/// One symmetric impact.
pub struct Impact {
    /// Of what.
    pub metal: Metal,
    /// Cells along each plate.
    pub cells: u32,
    /// Particle speed behind the shock, m/s: half of the flyer's, by symmetry.
    pub particle_speed: f64,
    /// What was measured.
    pub measured: Shocked,
    /// What was measured of the particle speed, m/s.
    pub measured_speed: f64,
    /// Largest pressure at the second gauge over that of the theory, less one.
    pub overshoot: f64,
    /// The target at the end.
    pub profile: Vec<Point>,
    /// Where the front should then be, m.
    pub front: f64,
    /// Where the plane of impact should then be, m.
    pub plane: f64,
    /// Sums of the run.
    pub totals: Totals,
}

impl Impact {
    /// What Rankine and Hugoniot say.
    pub fn theory(&self) -> Shocked {
        self.metal.shocked(self.particle_speed)
    }

    /// Mean difference of rho/rho0 - 1 along the shocked target from the step of the theory, over its height.
    pub fn profile_error(&self) -> f64 {
        let behind = self.theory().compression;
        let along = self.profile.iter().map(|p| {
            let exact = if p.x < self.front { behind } else { 0.0 };
            (p.compression - exact).abs() * p.thickness
        });
        along.sum::<f64>() / (behind * THICKNESS)
    }

    /// Relative errors of front, pressure, compression and energy.
    pub fn errors(&self) -> [f64; 4] {
        let (m, t) = (self.measured, self.theory());
        [
            m.front / t.front - 1.0,
            m.pressure / t.pressure - 1.0,
            m.compression / t.compression - 1.0,
            m.energy / t.energy - 1.0,
        ]
    }
}

/// Let a plate hit another of the same metal at twice the particle speed.
pub fn impact(metal: Metal, particle_speed: f64, setup: &Setup, files: Files) -> Result<Impact, CaseError> {
    let Setup { cells, viscosity: [linear, quadratic] } = *setup;
    let theory = metal.shocked(particle_speed);
    let h = THICKNESS / f64::from(cells);
    let gauges = GAUGES.map(|part| (part * f64::from(cells)).floor() as u32);
    let plates = Plates {
        flyer: cells,
        target: cells,
        spacing: h,
        speed: 2.0 * particle_speed,
        sound_speed: metal.sound_speed,
        gauges: gauges.to_vec(),
        end: REACH * THICKNESS / theory.front,
    };
    let law = Fluid::new(metal.law).with_bulk_viscosity(linear, quadratic)?;
    let run = plates::collide(law.into_material(), &plates, files)?;

    let arrivals: Vec<f64> = run.gauges.iter().map(|g| arrival(g, 0.5 * particle_speed)).collect();
    let way = f64::from(gauges[1] - gauges[0]) * h;
    let front = theory.front * run.totals.simulated_seconds;
    let plane = particle_speed * run.totals.simulated_seconds;
    let from = plane + FROM * (front - plane);
    let shocked: Vec<&Point> =
        run.target.iter().filter(|p| p.x > from && p.x < front - BEHIND_FRONT * h).collect();
    let mean = |of: fn(&Point) -> f64| shocked.iter().map(|p| of(p)).sum::<f64>() / shocked.len() as f64;
    let peak = run.gauges[1].iter().map(|look| look.pressure).fold(0.0, f64::max);
    Ok(Impact {
        metal,
        cells,
        particle_speed,
        measured: Shocked {
            front: way / (arrivals[1] - arrivals[0]),
            pressure: mean(|p| p.pressure),
            compression: mean(|p| p.compression),
            energy: mean(|p| p.energy),
        },
        measured_speed: mean(|p| p.speed),
        overshoot: peak / theory.pressure - 1.0,
        profile: run.target,
        front,
        plane,
        totals: run.totals,
    })
}

/// When a gauge first moves at `speed`, s; not a number if it never does.
pub fn arrival(history: &[Look], speed: f64) -> f64 {
    let passed = history.windows(2).find(|w| w[0].speed < speed && w[1].speed >= speed);
    passed.map_or(f64::NAN, |w| {
        let share = (speed - w[0].speed) / (w[1].speed - w[0].speed);
        w[0].time + share * (w[1].time - w[0].time)
    })
}

/// The line U_s = c0 + s u_p through points (u_p, U_s) by least squares: c0, m/s, and s.
pub fn line(points: &[[f64; 2]]) -> [f64; 2] {
    let count = points.len() as f64;
    let mean = |axis: usize| points.iter().map(|p| p[axis]).sum::<f64>() / count;
    let (u, front) = (mean(0), mean(1));
    let covariance: f64 = points.iter().map(|p| (p[0] - u) * (p[1] - front)).sum();
    let variance: f64 = points.iter().map(|p| (p[0] - u).powi(2)).sum();
    let slope = covariance / variance;
    [front - slope * u, slope]
}
