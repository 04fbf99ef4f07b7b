//! Dimensions, metals and parameters of a run.

use clap::ValueEnum;
use examples::CaseError;
use mpm_materials::{J2, LogarithmicBulk, Solid};
use serde::Serialize;

/// Poisson's ratio of all rings.
pub const POISSON: f64 = 0.3;

/// Constants of a thin ring.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Metal {
    /// Name in files.
    pub name: &'static str,
    /// Density, kg/m^3.
    pub density: f64,
    /// Yield stress, Pa.
    pub yields: f64,
    /// Speed at the start, m/s.
    pub speed: f64,
    /// Young's modulus, Pa.
    pub young: f64,
}

/// A heavy slow ring and a light fast one. Young's modulus is some eight times that of metals: the reference is the rigid limit.
pub const METALS: [Metal; 2] = [
    Metal { name: "heavy", density: 8930.0, yields: 400e6, speed: 100.0, young: 1e12 },
    Metal { name: "light", density: 2700.0, yields: 300e6, speed: 200.0, young: 1e12 },
];

/// How the ring is computed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Means {
    /// Material points: quadratic B-splines, AFLIP
    Mpm,
    /// Finite elements: quadrilaterals with the mean dilatation
    Fem,
}

impl Means {
    /// Name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Means::Mpm => "mpm",
            Means::Fem => "fem",
        }
    }
}

/// A ring of square section that expands and comes to rest.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Setup {
    /// Metal of the ring.
    pub metal: Metal,
    /// Method of computation.
    pub means: Means,
    /// Radius of the middle of the section, m.
    pub radius: f64,
    /// Edge of the section, m.
    pub thickness: f64,
    /// Cells or elements across the section.
    pub cells: u32,
    /// Number of threads.
    pub threads: usize,
}

impl Setup {
    /// Edge of a cell or an element, m.
    pub fn spacing(&self) -> f64 {
        self.thickness / f64::from(self.cells)
    }
    /// Name in files.
    pub fn name(&self) -> String {
        format!(
            "{}_{}_{:.0}um_{}_{:.0}gpa",
            self.metal.name,
            self.means.name(),
            1e6 * self.thickness,
            self.cells,
            1e-9 * self.metal.young
        )
    }
}

/// A ring in three dimensions that breaks.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Break {
    /// Metal of the ring.
    pub metal: Metal,
    /// Radius of the middle of the section, m.
    pub radius: f64,
    /// Edge of the section, m.
    pub thickness: f64,
    /// Cells across the section, an even number.
    pub cells: u32,
    /// Plastic strain near which most sections fail.
    pub strain: f64,
    /// Scatter of the failure strains: rate g of Mott's hazard, proportional to exp(g eps).
    pub scatter: f64,
    /// Seed of the scatter.
    pub seed: u64,
    /// Number of threads.
    pub threads: usize,
}

impl Break {
    /// Node spacing, m.
    pub fn spacing(&self) -> f64 {
        self.thickness / f64::from(self.cells)
    }
    /// Number of sections with their own strength, each as long as the ring is thick.
    pub fn sections(&self) -> usize {
        (std::f64::consts::TAU * self.radius / self.thickness).round() as usize
    }
    /// Name in files.
    pub fn name(&self) -> String {
        format!("break_{:.0}_{}", self.metal.speed, self.cells)
    }
}

/// Return the law: elastic, perfectly plastic.
pub fn law(metal: &Metal) -> Result<Solid<J2<f64>, LogarithmicBulk<f64>>, CaseError> {
    let shear = metal.young / (2.0 * (1.0 + POISSON));
    let bulk = metal.young / (3.0 * (1.0 - 2.0 * POISSON));
    Ok(Solid::new(J2::linear(shear, metal.yields, 0.0)?, LogarithmicBulk::new(metal.density, bulk)?))
}
