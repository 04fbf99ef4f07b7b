//! The same bar by methods beside particle contacts.

use examples::{CaseError, Totals};
use mpm_core::output::Snapshot;
use mpm_materials::IntoMaterial;
use mpm_materials::Solid;

use crate::STANDARD;
use crate::scene::{BULK_VISCOSITY, Space, eos, strength};

/// One run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bar {
    pub space: Space,
    /// Impact speed, m/s.
    pub speed: f64,
    /// Cells or elements on the radius.
    pub cells: u32,
    pub threads: usize,
}

/// What came of it.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// The method, and how it was set up.
    pub method: &'static str,
    pub bar: Bar,
    /// Length and radius of the face, m.
    pub sizes: [f64; 2],
    /// Energy of hourglass forces over internal energy; none of methods without any.
    pub hourglass: Option<f64>,
    /// When it stopped, s, and why, if it did not come to its end.
    pub broke: Option<(f64, String)>,
    pub snapshot: Snapshot,
    pub totals: Totals,
}

impl Outcome {
    /// Its name in tables.
    pub fn name(&self) -> String {
        format!("{}, {}", self.method, self.bar.space.words())
    }
}

/// Copper with the constants put right, the law of all methods.
pub fn copper() -> Result<impl IntoMaterial<f64>, CaseError> {
    let [linear, quadratic] = BULK_VISCOSITY;
    Ok(Solid::new(strength(STANDARD)?, eos()?).with_bulk_viscosity(linear, quadratic)?)
}
