//! Parameters of a run.

use clap::ValueEnum;
use examples::FlowScheme;
use examples::martin_moyce::WIDTH;
use serde::Serialize;

/// Gravity, m/s^2.
pub const GRAVITY: f64 = 9.81;
/// Density, kg/m^3.
pub const DENSITY: f64 = 1000.0;

/// Dam break to compute.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Study {
    /// First pressure of a column at its release, three widths
    Release,
    /// Long reservoir on a dry bed, against Ritter's shallow flow
    Shallow,
    /// Column 57.15 mm wide, against Martin and Moyce's front
    Column,
    /// Column of 2 by 1 heights in a tank of 5.37 heights: pressure at the far wall
    Tank,
    /// Shallow flow by incompressible flow, material points and smoothed particles: error and core-seconds
    Cost,
}

impl Study {
    /// Name in files and tables.
    pub fn name(self) -> &'static str {
        match self {
            Study::Release => "release",
            Study::Shallow => "shallow",
            Study::Column => "column",
            Study::Tank => "tank",
            Study::Cost => "cost",
        }
    }
}

/// Parameters of a run.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Setup {
    pub study: Study,
    /// Height of the column H, m.
    pub height: f64,
    /// Width over height.
    pub aspect: f64,
    /// Cells over the height; two particles a cell along each axis.
    pub cells: u32,
    /// Dynamic viscosity, Pa s.
    pub viscosity: f64,
    /// End of the run over sqrt(H / g).
    pub end: f64,
    pub scheme: FlowScheme,
}

impl Setup {
    /// Unit of time sqrt(H / g), s.
    pub fn second(&self) -> f64 {
        (self.height / GRAVITY).sqrt()
    }
    /// Pressure rho g H, Pa.
    pub fn pressure(&self) -> f64 {
        DENSITY * GRAVITY * self.height
    }
    /// Cell size, m.
    pub fn spacing(&self) -> f64 {
        self.height / f64::from(self.cells)
    }
    /// Width of the columns in which depths are measured, m: a cell, or three in shallow flow, whose depth is that of a few particles.
    pub fn column(&self) -> f64 {
        if self.study == Study::Shallow { 3.0 * self.spacing() } else { self.spacing() }
    }
    /// Depth at which the front is measured, m: three cells in shallow flow, else a quarter of a cell.
    pub fn front_depth(&self) -> f64 {
        self.spacing() * if self.study == Study::Shallow { 3.0 } else { 0.25 }
    }
    /// Width of the column, m.
    pub fn width(&self) -> f64 {
        self.aspect * self.height
    }
    /// Volume of the column, m^2.
    pub fn volume(&self) -> f64 {
        self.width() * self.height
    }
    /// Left and right end of the tank, m, from the left end of the column; a multiple of the height, except in the tank of the experiment.
    pub fn tank(&self) -> [f64; 2] {
        let right = match self.study {
            Study::Release => 2.0 * self.aspect + 1.0,
            Study::Shallow | Study::Cost => self.aspect + 2.0 * self.end + 1.0,
            Study::Column => 4.0,
            Study::Tank => TANK,
        };
        [0.0, right * self.height]
    }
    /// Height of the tank, m.
    pub fn ceiling(&self) -> f64 {
        3.0 * self.height
    }
    /// Corners of the part of the tank that pictures show, m.
    pub fn window(&self) -> [[f64; 2]; 2] {
        let dam = self.aspect;
        let [left, right, top] = match self.study {
            Study::Release => [0.0, dam + 0.3, 1.15],
            Study::Shallow | Study::Cost => [dam - 4.0, dam + 8.0, 1.4],
            Study::Column => [0.0, 2.3, 1.15],
            Study::Tank => [0.0, TANK, 2.0],
        };
        [[left, 0.0], [right, top]].map(|x| x.map(|x| x * self.height))
    }
    /// Name in file names.
    pub fn name(&self) -> String {
        match self.study {
            Study::Release => format!("release_{}_{}", self.aspect, self.cells),
            study => study.name().into(),
        }
    }
}

/// Length of the tank of the experiment over the height of the column: 3.22 m and 0.6 m.
pub const TANK: f64 = 3.22 / 0.6;
/// Centre and diameter of the pressure gauge over the height of the column: 160 and 90 mm.
pub const GAUGE: [f64; 2] = [0.16 / 0.6, 0.09 / 0.6];
/// Height of the column of Martin and Moyce, m.
pub const COLUMN: f64 = 2.0 * WIDTH;
