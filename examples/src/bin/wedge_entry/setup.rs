//! Parameters of a run.

use std::f64::consts::PI;

use clap::ValueEnum;
use examples::{Coupling, Transfer, Water};
use serde::Serialize;

/// Half breadth of the wedge, m.
pub const HALF: f64 = 0.25;
/// Half width and depth of the pool, in half breadths of the wedge.
pub const POOL: [f64; 2] = [4.0, 3.0];
/// Density of the wedge, kg/m^3.
pub const DENSITY: f64 = 1100.0;

/// Method of the water.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Method {
    /// Weakly compressible material points; a wedge of elements
    Mpm,
    /// Incompressible flow; a rigid wedge
    Flow,
}

/// Parameters of a run: half of the wedge and of the pool behind a plane of symmetry, whole ones
/// with [`Method::Flow`].
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Setup {
    pub method: Method,
    pub coupling: Coupling,
    pub transfer: Transfer,
    /// Deadrise angle, rad.
    pub deadrise: f64,
    /// Speed of entry, m/s.
    pub speed: f64,
    /// Cells over the half breadth of the wedge; two particles per cell along each axis.
    pub cells: u32,
    /// Edge of the elements on the wetted side, cells.
    pub edge: f64,
    /// Young's modulus of an elastic wedge, Pa; rigid if `None`.
    pub young: Option<f64>,
    /// Sound speed of the water over that of the jet by Wagner.
    pub sound: f64,
    /// Wetted fraction of the breadth at the end, by Wagner.
    pub wetted: f64,
    pub threads: usize,
}

impl Setup {
    /// Cell size, m.
    pub fn spacing(&self) -> f64 {
        HALF / f64::from(self.cells)
    }
    /// Return the initial particle distance, m.
    pub fn particle(&self) -> f64 {
        0.5 * self.spacing()
    }
    /// Height of the wedge, m.
    pub fn height(&self) -> f64 {
        HALF * self.deadrise.tan()
    }
    /// Corners of the whole wedge when its keel is `sunk` below the water level, m, anticlockwise.
    pub fn corners(&self, sunk: f64) -> Vec<[f64; 2]> {
        let top = self.height() - sunk;
        vec![[0.0, -sunk], [HALF, top], [-HALF, top]]
    }
    /// Return the label in charts.
    pub fn label(&self) -> String {
        match self.method {
            Method::Mpm => format!("elements as long as {} cells", self.edge),
            Method::Flow => format!("incompressible, {} cells", self.cells),
        }
    }
    /// Return the number of elements along each side of the wedge: an even number.
    pub fn count(&self) -> usize {
        let side = HALF / self.deadrise.cos();
        2 * (0.5 * side / (self.edge * self.spacing())).round().max(1.0) as usize
    }
    /// Return the water: its fastest part is the jet along the wedge, at twice the growth rate of the wetted half breadth, pi V /
    /// tan(beta).
    pub fn water(&self) -> Water {
        Water::of(self.sound * PI * self.speed / self.deadrise.tan())
    }
    /// Return the end time, s, at which the wetted fraction is reached: c = pi V t / (2 tan(beta)) (Wagner).
    pub fn end(&self) -> f64 {
        self.wetted * HALF * 2.0 * self.deadrise.tan() / (PI * self.speed)
    }
    /// Return the extent of the pressure profile along the wedge, over V t: beyond the root of the jet by Wagner.
    pub fn reach(&self) -> f64 {
        0.75 * PI / self.deadrise.tan()
    }
    /// Return the force over rho V^3 t, both halves, from an impulse on one half between two times, N s/m and s.
    pub fn factor(&self, impulse: f64, [from, to]: [f64; 2]) -> f64 {
        4.0 * impulse / (Water::DENSITY * self.speed.powi(3) * (to * to - from * from))
    }
    /// Return the stagnation pressure, Pa.
    pub fn stagnation(&self) -> f64 {
        0.5 * Water::DENSITY * self.speed.powi(2)
    }
    /// Return the name in file names.
    pub fn name(&self) -> String {
        if self.method == Method::Flow {
            return "flow".into();
        }
        let kind = if self.young.is_some() { "elastic" } else { "rigid" };
        format!("{kind}_{}_{}", self.coupling.name(), self.edge)
    }
}
