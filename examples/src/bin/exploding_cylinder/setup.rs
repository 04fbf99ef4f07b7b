//! Dimensions and parameters of a run.

use serde::Serialize;

/// Radius of the charge, m.
pub const CHARGE: f64 = 10.0e-3;
/// Density of TNT and of the case, kg/m^3.
pub const DENSITY: [f64; 2] = [1630.0, 8900.0];
/// Hardening of the case, A + B eps^n: A, Pa, B, Pa, n.
pub const HARDENING: [f64; 3] = [90e6, 392e6, 0.5];
/// Gurney's constant of TNT, m/s, from two sources \[M\].
pub const GURNEY: [f64; 2] = [2370.0, 2440.0];

/// Where the charge is lit.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Lit {
    /// Along its axis
    Axis,
    /// Everywhere at once
    All,
}

impl Lit {
    /// Name in tables.
    pub fn words(self) -> &'static str {
        match self {
            Lit::Axis => "along its axis",
            Lit::All => "at once",
        }
    }
}

/// Parameters of a run.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Setup {
    /// Thickness of the case, m.
    pub case: f64,
    /// Initiation of the charge.
    pub lit: Lit,
    /// Cells along the radius of the charge.
    pub cells: u32,
    /// Volume of the products at the end over that of the charge.
    pub expansion: f64,
    /// Linear and quadratic coefficient of the bulk viscosity.
    pub viscosity: [f64; 2],
    /// Memory of FLIP, in transits of a cell by the detonation.
    pub memory: f64,
    /// Courant factor of the time step.
    pub factor: f64,
    /// Fragmentation of the case, if any.
    pub breaks: Option<Breaks>,
    /// Number of threads.
    pub threads: usize,
}

/// Fragmentation of a case.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Breaks {
    /// Plastic strain at which most sections fail in tension.
    pub strain: f64,
    /// Scatter of the failure strains: rate g of the hazard exp(g eps).
    pub scatter: f64,
    /// Seed of the scatter.
    pub seed: u64,
}

impl Setup {
    /// Node spacing, m.
    pub fn spacing(&self) -> f64 {
        CHARGE / f64::from(self.cells)
    }
    /// Number of zones along the radius of the charge in one dimension.
    pub fn zones(&self) -> usize {
        if self.cells < 40 { 200 } else { 400 }
    }
    /// Outer radius of the case, m.
    pub fn outer(&self) -> f64 {
        CHARGE + self.case
    }
    /// Mass of the case over that of the charge.
    pub fn mass_ratio(&self) -> f64 {
        DENSITY[1] * (self.outer().powi(2) - CHARGE * CHARGE) / (DENSITY[0] * CHARGE * CHARGE)
    }
    /// Volume of the products over that of the charge at this growth of the outer radius, of a case that keeps its section.
    pub fn volume(&self, growth: f64) -> f64 {
        ((growth * self.outer()).powi(2) - self.outer().powi(2)) / (CHARGE * CHARGE) + 1.0
    }
    /// Number of sections of the case with their own strength, each half as long as the case is thick.
    pub fn sections(&self) -> usize {
        (std::f64::consts::TAU * (CHARGE + 0.5 * self.case) / (0.5 * self.case)).round() as usize
    }
    /// Name in files.
    pub fn name(&self) -> String {
        let lit = match self.lit {
            Lit::Axis => "axis",
            Lit::All => "all",
        };
        let breaks = if self.breaks.is_some() { "_breaks" } else { "" };
        format!("{:.0}um_{lit}_{}{breaks}", 1e6 * self.case, self.cells)
    }
}
