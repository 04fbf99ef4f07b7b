//! Parameters of a run.

use clap::ValueEnum;
use serde::Serialize;

/// Gravity, m/s^2.
pub const GRAVITY: f64 = 9.81;
/// Density of the water, kg/m^3.
pub const WATER: f64 = 1000.0;
/// Width of the tank and depth of the water without the box, m.
pub const TANK: [f64; 2] = [1.0, 0.5];
/// Height of the tank, m.
pub const CEILING: f64 = 2.0;
/// Edge of the box, m, and its lower left corner along x.
pub const EDGE: f64 = 0.3;
pub const LEFT: f64 = 0.5 * (TANK[0] - EDGE);
/// Spin of boxes that may turn, at the start, rad/s.
pub const PUSHED: f64 = 0.1;

/// Motion to compute.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Study {
    /// Upright box released above its depth, one run a density: depth, period of heave
    Heave,
    /// Upright box in space: depth
    Space,
    /// Box of a twentieth of the density of water, free to turn, released below its depth
    Light,
    /// Box of half the density of water, free to turn: it rolls over
    Roll,
    /// Ball of water with a box in it in free fall: momentum
    Fall,
}

/// Parameters of a run.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Setup {
    pub study: Study,
    /// Cells over the width of the tank; two particles a cell along each axis.
    pub cells: u32,
    /// Density of the box, kg/m^3.
    pub density: f64,
    /// Height of the release above the depth at which the box floats in the water of the start, m.
    pub lifted: f64,
    /// End, s.
    pub end: f64,
}

impl Setup {
    /// Cell size, m.
    pub fn spacing(&self) -> f64 {
        TANK[0] / f64::from(self.cells)
    }
    /// Depth of the lower face below the surface at rest, by the law of Archimedes, m.
    pub fn draught(&self) -> f64 {
        EDGE * self.density / WATER
    }
    /// True if the box may turn and move along x.
    pub fn is_free(&self) -> bool {
        matches!(self.study, Study::Light | Study::Roll | Study::Fall)
    }
    /// Number of dimensions.
    pub fn dimensions(&self) -> i32 {
        if self.study == Study::Space { 3 } else { 2 }
    }
    /// Share of the surface of the tank that the box covers.
    pub fn covered(&self) -> f64 {
        (EDGE / TANK[0]).powi(self.dimensions() - 1)
    }
    /// Area of the tank, m^2 (m in the plane).
    pub fn area(&self) -> f64 {
        TANK[0].powi(self.dimensions() - 1)
    }
    /// Volume of the water, m^3 (m^2 in the plane).
    pub fn water(&self) -> f64 {
        let displaced = (self.draught() - self.lifted) * EDGE.powi(self.dimensions() - 1);
        TANK[1] * self.area() - displaced
    }
    /// Height of the surface when the box floats upright, m: the water of the start is displaced to the depth `TANK[1]` where the lower face
    /// is `lifted` higher.
    pub fn level(&self) -> f64 {
        TANK[1] + self.covered() * self.lifted
    }
    /// Height of the lower face at the start, m.
    pub fn bottom(&self) -> f64 {
        TANK[1] - self.draught() + self.lifted
    }
    /// Weight of the water and the box over a cell, J: the energy of particles is uncertain by a hundredth of it, half of their weight over a
    /// fiftieth of a cell by which the density correction moves their centroid.
    pub fn uncertain(&self) -> f64 {
        let boxed = EDGE.powi(self.dimensions()) * self.density;
        0.01 * GRAVITY * self.spacing() * (WATER * self.water() + boxed)
    }
    /// Name in files and tables.
    pub fn name(&self) -> String {
        match self.study {
            Study::Heave => format!("heave_{}_{}", self.density, self.cells),
            Study::Space => format!("space_{}", self.cells),
            Study::Light => "light".into(),
            Study::Roll => "roll".into(),
            Study::Fall => "fall".into(),
        }
    }
}
