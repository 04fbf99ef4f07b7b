//! Parameters of a run.

use clap::ValueEnum;
use examples::FlowScheme;
use serde::Serialize;

/// Gravity, m/s^2.
pub const GRAVITY: f64 = 9.81;
/// Density, kg/m^3.
pub const DENSITY: f64 = 1000.0;

/// Motion to compute.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Study {
    /// Standing wave, one run a mode: period, amplitude after four periods
    Wave,
    /// Tank that sways from rest at 0.8 of the first frequency, against linear theory
    Sway,
    /// Standing wave of a viscous liquid: rate of decay
    Decay,
    /// Sway near resonance for 6 s, then 14 s of free sloshing: volume, energy
    Long,
    /// Standing wave by incompressible flow, material points and smoothed particles: error and core-seconds
    Cost,
}

/// Parameters of a run.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Setup {
    pub study: Study,
    /// Length of the tank and depth of the liquid, m.
    pub length: f64,
    pub depth: f64,
    /// Cells over the length; two particles a cell along each axis.
    pub cells: u32,
    /// Mode of a standing wave.
    pub mode: u32,
    /// Amplitude of a standing wave, m.
    pub amplitude: f64,
    /// Kinematic viscosity of a wave that decays, m^2/s.
    pub viscosity: f64,
    pub scheme: FlowScheme,
}

impl Setup {
    /// Cell size, m.
    pub fn spacing(&self) -> f64 {
        self.length / f64::from(self.cells)
    }
    /// Volume, m^2.
    pub fn volume(&self) -> f64 {
        self.length * self.depth
    }
    /// Name in files and tables.
    pub fn name(&self) -> String {
        match self.study {
            Study::Wave => format!("mode_{}", self.mode),
            Study::Sway => "sway".into(),
            Study::Decay => "decay".into(),
            Study::Long => "long".into(),
            Study::Cost => "cost".into(),
        }
    }
}

/// Amplitude of the small sway, m, and its frequency over the first of the tank.
pub const SWAY: [f64; 2] = [2e-3, 0.8];
/// Largest acceleration of the strong sway, m/s^2, its frequency over the first of the tank, and its end, s.
pub const STRONG: [f64; 3] = [0.2, 0.95, 6.0];
