//! Geometry and parameters.

use serde::Serialize;

/// Radius of the cylindrical charge, and edge of the cubic one's octant, m.
pub const CHARGE: f64 = 10.0e-3;
/// Thickness of the case, m; not in the deck's listing.
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
    /// Long cylinder lit along its axis: a quarter, one cell thick between planes of symmetry.
    Cylinder,
    /// Cube lit at its centre: an octant.
    Cube,
}

/// Parameters of a run.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Setup {
    /// Form of the charge.
    pub form: Form,
    /// Cells along the charge's radius or edge.
    pub cells: u32,
    /// End of the run, s.
    pub end: f64,
    /// Linear and quadratic coefficient of the bulk viscosity.
    pub viscosity: [f64; 2],
    /// Time constant of the FLIP-PIC blend, in transits of a cell by the detonation.
    pub memory: f64,
    /// Factor of the time step.
    pub factor: f64,
    /// Number of threads.
    pub threads: usize,
}

impl Setup {
    /// Node spacing, m.
    pub fn spacing(&self) -> f64 {
        CHARGE / f64::from(self.cells)
    }
    /// Return the name in file names.
    pub fn name(&self) -> &'static str {
        match self.form {
            Form::Cylinder => "cylinder",
            Form::Cube => "cube",
        }
    }
}

/// Return the mass of the case over that of the charge for the cylinder.
pub fn mass_ratio() -> f64 {
    let outer = CHARGE + CASE;
    DENSITY[1] * (outer * outer - CHARGE * CHARGE) / (DENSITY[0] * CHARGE * CHARGE)
}

/// Return the speed of the case by Gurney, m/s: sqrt(2 E) / sqrt(M/C + 1/2) for a cylinder, with a gas velocity proportional to the radius.
pub fn gurney() -> f64 {
    GURNEY / (mass_ratio() + 0.5).sqrt()
}
