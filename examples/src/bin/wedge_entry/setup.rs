//! What a run is made of.

use std::f64::consts::PI;

use examples::{Coupling, Transfer, Water};
use serde::Serialize;

/// Half the breadth of the wedge, m.
pub const HALF: f64 = 0.25;
/// Half the width of the pool and its depth, in half breadths of the wedge.
pub const POOL: [f64; 2] = [4.0, 3.0];
/// Density of the wedge, kg/m^3.
pub const DENSITY: f64 = 1100.0;

/// One run: half of the wedge and of the pool behind a plane of symmetry.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Setup {
    pub coupling: Coupling,
    pub transfer: Transfer,
    /// Deadrise angle, radians.
    pub deadrise: f64,
    /// m/s.
    pub speed: f64,
    /// Cells over half the breadth of the wedge; two particles a cell along each axis.
    pub cells: u32,
    /// Edge of the elements on the wetted side, cells.
    pub edge: f64,
    /// Young's modulus, Pa, of an elastic wedge.
    pub young: Option<f64>,
    /// Sound speed over that of the jet by Wagner.
    pub sound: f64,
    /// Wetted part of the breadth by Wagner at the end.
    pub wetted: f64,
    pub threads: usize,
}

impl Setup {
    /// Cell size, m.
    pub fn spacing(&self) -> f64 {
        HALF / f64::from(self.cells)
    }
    /// Distance of particles at the start, m.
    pub fn particle(&self) -> f64 {
        0.5 * self.spacing()
    }
    /// Height of the wedge, m.
    pub fn height(&self) -> f64 {
        HALF * self.deadrise.tan()
    }
    /// Elements along each side of the wedge: an even number.
    pub fn count(&self) -> usize {
        let side = HALF / self.deadrise.cos();
        2 * (0.5 * side / (self.edge * self.spacing())).round().max(1.0) as usize
    }
    /// The water: its fastest part is the jet along the wedge, twice as fast as the wetted half breadth grows, pi V / tan(beta).
    pub fn water(&self) -> Water {
        Water::of(self.sound * PI * self.speed / self.deadrise.tan())
    }
    /// When so much is wetted, s: c = pi V t / (2 tan(beta)) (Wagner).
    pub fn end(&self) -> f64 {
        self.wetted * HALF * 2.0 * self.deadrise.tan() / (PI * self.speed)
    }
    /// How far along the wedge pressures are looked at, over V t: beyond the root of the jet by Wagner.
    pub fn reach(&self) -> f64 {
        0.75 * PI / self.deadrise.tan()
    }
    /// Force over rho V^3 t, both halves, of an impulse on one half between two times, N s/m and s.
    pub fn factor(&self, impulse: f64, [from, to]: [f64; 2]) -> f64 {
        4.0 * impulse / (Water::DENSITY * self.speed.powi(3) * (to * to - from * from))
    }
    /// Stagnation pressure, Pa.
    pub fn stagnation(&self) -> f64 {
        0.5 * Water::DENSITY * self.speed.powi(2)
    }
    /// As in the names of files.
    pub fn name(&self) -> String {
        let kind = if self.young.is_some() { "elastic" } else { "rigid" };
        format!("{kind}_{}_{}", self.coupling.name(), self.edge)
    }
}
