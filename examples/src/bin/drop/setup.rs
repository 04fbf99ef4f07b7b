//! Parameters of a run.

use std::f64::consts::PI;

use clap::ValueEnum;
use examples::FlowScheme;
use serde::Serialize;

use crate::theory::Drop;

/// Density, kg/m^3.
pub const DENSITY: f64 = 1000.0;

/// Drop to compute.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Study {
    /// Circle that a linear velocity stretches, without surface tension: exact
    Elliptic,
    /// Oscillation by surface tension in the plane
    Rayleigh,
    /// Oscillation by surface tension in space
    Lamb,
    /// Viscous square that becomes a circle
    Square,
    /// Viscous cube that becomes a sphere
    Cube,
    /// Circle at rest: pressure, parasitic currents
    Rest,
}

impl Study {
    /// Name in files and tables.
    pub fn name(self) -> &'static str {
        match self {
            Study::Elliptic => "elliptic",
            Study::Rayleigh => "rayleigh",
            Study::Lamb => "lamb",
            Study::Square => "square",
            Study::Cube => "cube",
            Study::Rest => "rest",
        }
    }
    /// 2 or 3.
    pub fn dimensions(self) -> usize {
        if matches!(self, Study::Lamb | Study::Cube) { 3 } else { 2 }
    }
    /// True if the drop starts as a square or a cube.
    pub fn has_edges(self) -> bool {
        matches!(self, Study::Square | Study::Cube)
    }
}

/// Parameters of a run.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Setup {
    pub study: Study,
    /// Radius, or half of the edge of a square or a cube, m.
    pub size: f64,
    /// Cells over `size`; two particles a cell along each axis.
    pub cells: u32,
    /// Surface tension, N/m.
    pub tension: f64,
    /// Dynamic viscosity, Pa s.
    pub viscosity: f64,
    /// Stretch along x at the start, less 1.
    pub stretch: f64,
    /// End of the run, s.
    pub end: f64,
    pub scheme: FlowScheme,
}

impl Setup {
    /// Cell size, m.
    pub fn spacing(&self) -> f64 {
        self.size / f64::from(self.cells)
    }
    /// Radius of the circle or sphere of its volume, m.
    pub fn radius(&self) -> f64 {
        match self.study {
            Study::Square => 2.0 * self.size / PI.sqrt(),
            Study::Cube => 2.0 * self.size * (0.75 / PI).cbrt(),
            _ => self.size,
        }
    }
    /// Drop of its volume under surface tension.
    pub fn drop(&self) -> Drop {
        let (dimensions, radius) = (self.study.dimensions(), self.radius());
        Drop { dimensions, radius, tension: self.tension, density: DENSITY }
    }
    /// Name in file names.
    pub fn name(&self) -> String {
        format!("{}_{}", self.study.name(), self.cells)
    }
}
