//! Measured shock line of a metal: front speed between two gauges, and state behind the front.
//!
//! The metal is a fluid with its equation of state only: with strength the stress behind the shock is p + 2Y/3, an elastic precursor
//! precedes slow shocks, and the line differs from that of the source.

use examples::{CaseError, Totals};
use mpm_materials::{Fluid, IntoMaterial};

use crate::metals::{Metal, Shocked};
use crate::plates::{self, Files, Look, Plates, Point};

/// Thickness of both plates, m. Only h over it matters: the flow is self-similar.
pub const THICKNESS: f64 = 0.02;
/// Positions of the two gauges over the thickness.
const GAUGES: [f64; 2] = [0.35, 0.85];
/// Expected position of the front at the end of the run, over the thickness.
const REACH: f64 = 0.92;
/// Lower bound of the averaging window, over the path of the front: the plane of impact is heated at the start.
const FROM: f64 = 0.5;
/// Distance of the averaging window from the front, in cells: the front has a width.
const BEHIND_FRONT: f64 = 15.0;

/// Parameters of a run.
#[derive(Clone, Copy, Debug)]
pub struct Setup {
    /// Cells along each plate.
    pub cells: u32,
    /// Linear and quadratic coefficient of the bulk viscosity.
    pub viscosity: [f64; 2],
}

/// Symmetric impact and its results.
pub struct Impact {
    /// Metal.
    pub metal: Metal,
    /// Cells along each plate.
    pub cells: u32,
    /// Particle speed behind the shock, m/s: half of the flyer's, by symmetry.
    pub particle_speed: f64,
    /// Measured state behind the front.
    pub measured: Shocked,
    /// Measured particle speed, m/s.
    pub measured_speed: f64,
    /// Largest pressure at the second gauge over that of theory, minus one.
    pub overshoot: f64,
    /// Target at the end.
    pub profile: Vec<Point>,
    /// Theoretical position of the front at the end, m.
    pub front: f64,
    /// Theoretical position of the plane of impact at the end, m.
    pub plane: f64,
    /// Totals of the run.
    pub totals: Totals,
}

impl Impact {
    /// Return the state by Rankine and Hugoniot.
    pub fn theory(&self) -> Shocked {
        self.metal.shocked(self.particle_speed)
    }

    /// Mean deviation of rho/rho0 - 1 along the shocked target from the step of theory, over its height.
    pub fn profile_error(&self) -> f64 {
        let behind = self.theory().compression;
        let along = self.profile.iter().map(|p| {
            let exact = if p.x < self.front { behind } else { 0.0 };
            (p.compression - exact).abs() * p.thickness
        });
        along.sum::<f64>() / (behind * THICKNESS)
    }

    /// Return the relative errors of front, pressure, compression and energy.
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

/// Run the impact of two plates of the same metal at twice the particle speed.
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

/// Return the arrival time at a gauge, s: when its velocity first reaches `speed`; NaN if never.
pub fn arrival(history: &[Look], speed: f64) -> f64 {
    let passed = history.windows(2).find(|w| w[0].speed < speed && w[1].speed >= speed);
    passed.map_or(f64::NAN, |w| {
        let share = (speed - w[0].speed) / (w[1].speed - w[0].speed);
        w[0].time + share * (w[1].time - w[0].time)
    })
}

/// Fit the line U_s = c0 + s u_p to points (u_p, U_s) by least squares: c0, m/s, and s.
pub fn line(points: &[[f64; 2]]) -> [f64; 2] {
    let count = points.len() as f64;
    let mean = |axis: usize| points.iter().map(|p| p[axis]).sum::<f64>() / count;
    let (u, front) = (mean(0), mean(1));
    let covariance: f64 = points.iter().map(|p| (p[0] - u) * (p[1] - front)).sum();
    let variance: f64 = points.iter().map(|p| (p[0] - u).powi(2)).sum();
    let slope = covariance / variance;
    [front - slope * u, slope]
}
