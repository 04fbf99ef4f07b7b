//! Sizes, and what to run.

use serde::Serialize;

/// Radius of the cylindrical charge, and edge of the cubic one's octant, m.
pub const CHARGE: f64 = 10.0e-3;
/// Thickness of the case, m. (The deck's listing does not say it.)
pub const CASE: f64 = 2.0e-3;
/// Density of TNT and of the case, kg/m^3.
pub const DENSITY: [f64; 2] = [1630.0, 8900.0];
/// Chemical energy of TNT, J/m^3.
pub const CHEMICAL: f64 = 6.993e9;
/// Gurney's constant of TNT, m/s \[M\].
pub const GURNEY: f64 = 2370.0;

/// Form of the charge.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Form {
    /// A long cylinder lit along its axis: a quarter, a cell thick between planes of symmetry.
    Cylinder,
    /// A cube lit in its middle: an octant.
    Cube,
}

/// What to run.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Setup {
    /// The form.
    pub form: Form,
    /// Cells along the charge's radius or edge.
    pub cells: u32,
    /// End, s.
    pub end: f64,
    /// Linear and quadratic coefficient of the bulk viscosity.
    pub viscosity: [f64; 2],
    /// FLIP's memory, in transits of a cell by the detonation.
    pub memory: f64,
    /// Of the time step.
    pub factor: f64,
    /// Threads.
    pub threads: usize,
}

impl Setup {
    /// Node spacing, m.
    pub fn spacing(&self) -> f64 {
        CHARGE / f64::from(self.cells)
    }
    /// As in the names of files.
    pub fn name(&self) -> &'static str {
        match self.form {
            Form::Cylinder => "cylinder",
            Form::Cube => "cube",
        }
    }
}

/// Mass of the case over that of the charge, of the cylinder.
pub fn mass_ratio() -> f64 {
    let outer = CHARGE + CASE;
    DENSITY[1] * (outer * outer - CHARGE * CHARGE) / (DENSITY[0] * CHARGE * CHARGE)
}

/// Speed of the case by Gurney, m/s: sqrt(2 E) / sqrt(M/C + 1/2) for a cylinder, the gas moving as its radius does.
pub fn gurney() -> f64 {
    GURNEY / (mass_ratio() + 0.5).sqrt()
}
