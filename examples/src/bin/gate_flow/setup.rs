//! Parameters of a run \[Antoci2007\].

use std::f64::consts::SQRT_2;

use clap::ValueEnum;
use examples::martin_moyce::WIDTH;
use examples::{Coupling, Transfer, Water};
use serde::Serialize;

/// Gravity, m/s^2.
pub const GRAVITY: f64 = 9.81;
/// Width and height of the water behind the gate, m.
pub const WATER: [f64; 2] = [0.100, 0.140];
/// Length of the gate below its clamp, and thickness, m.
pub const GATE: [f64; 2] = [0.079, 0.005];
/// Density of the rubber, kg/m^3.
pub const RUBBER: f64 = 1100.0;
/// Height of the upper end of the wall that carries the gate, m.
pub const WALL: f64 = 0.160;

/// What the water is behind.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Gate {
    /// The rubber, which the water bends and leaves under
    Elastic,
    /// The rubber, and incompressible flow instead of material points
    Flow,
    /// A thousand times stiffer and heavier: it swings about its static bend, and nothing leaves
    Stiff,
    /// Nothing: a column of water of the size of an experiment collapses
    None,
}

/// Parameters of a run.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Setup {
    pub gate: Gate,
    pub coupling: Coupling,
    pub transfer: Transfer,
    /// Cells over the width of the water; two particles a cell along each axis.
    pub cells: u32,
    /// Elements through the gate.
    pub layers: u32,
    /// Young's modulus of the rubber, Pa, and its Poisson's ratio.
    pub young: f64,
    pub poisson: f64,
    /// True if the floor supports the gate's lower end.
    pub seated: bool,
    /// Sound speed over the speed of free fall from the height of the water.
    pub sound: f64,
    /// End of the run, s.
    pub end: f64,
    pub threads: usize,
}

impl Setup {
    /// Ratio of stiffness and of density of the gate to those of the rubber; its wave speed is the same.
    pub fn scale(&self) -> f64 {
        if self.gate == Gate::Stiff { 1000.0 } else { 1.0 }
    }
    /// Young's modulus of the gate, Pa.
    pub fn young(&self) -> f64 {
        self.scale() * self.young
    }
    /// Width and height of the water, m.
    pub fn size(&self) -> [f64; 2] {
        if self.gate == Gate::None { [WIDTH, 2.0 * WIDTH] } else { WATER }
    }
    /// Cell size, m.
    pub fn spacing(&self) -> f64 {
        self.size()[0] / f64::from(self.cells)
    }
    /// Distance of particles at the start, m.
    pub fn particle(&self) -> f64 {
        0.5 * self.spacing()
    }
    /// Speed of free fall over the height of the water, m/s.
    pub fn fall(&self) -> f64 {
        (2.0 * GRAVITY * self.size()[1]).sqrt()
    }
    /// Return the water.
    pub fn water(&self) -> Water {
        Water::of(self.sound * self.fall())
    }
    /// Hydrostatic pressure at this height over the floor, Pa.
    pub fn pressure(&self, height: f64) -> f64 {
        Water::DENSITY * GRAVITY * (self.size()[1] - height).max(0.0)
    }
    /// Potential energy of the water over the floor, J/m.
    pub fn potential(&self) -> f64 {
        let [width, height] = self.size();
        0.5 * Water::DENSITY * GRAVITY * height.powi(2) * width
    }
    /// Unit of the times T = t sqrt(2 g / a) of \[MartinMoyce1952\], s.
    pub fn second(&self) -> f64 {
        (WIDTH / GRAVITY).sqrt() / SQRT_2
    }
    /// Name in files.
    pub fn name(&self) -> String {
        match self.gate {
            Gate::Elastic => format!("elastic_{}_{}", self.coupling.name(), self.cells),
            Gate::Flow => format!("flow_{}", self.cells),
            Gate::Stiff => format!("stiff_{}_{}", self.coupling.name(), self.cells),
            Gate::None => format!("none_{}", self.cells),
        }
    }
}
