//! Taylor bar by methods other than particle contacts.

use examples::{CaseError, Totals};
use mpm_core::output::Snapshot;
use mpm_materials::IntoMaterial;
use mpm_materials::Solid;

use crate::STANDARD;
use crate::scene::{BULK_VISCOSITY, Space, eos, strength};

/// Parameters of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bar {
    pub space: Space,
    /// Impact speed, m/s.
    pub speed: f64,
    /// Cells or elements per radius.
    pub cells: u32,
    pub threads: usize,
}

/// Results of a run.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// Name of the method and its options.
    pub method: &'static str,
    pub bar: Bar,
    /// Length and radius of the face, m.
    pub sizes: [f64; 2],
    /// Energy of hourglass forces over internal energy; `None` for methods without hourglass control.
    pub hourglass: Option<f64>,
    /// Time, s, and cause of a premature stop.
    pub broke: Option<(f64, String)>,
    pub snapshot: Snapshot,
    pub totals: Totals,
}

impl Outcome {
    /// Return the name in tables.
    pub fn name(&self) -> String {
        format!("{}, {}", self.method, self.bar.space.words())
    }
}

/// Return copper with corrected constants, the law of all methods.
pub fn copper() -> Result<impl IntoMaterial<f64>, CaseError> {
    let [linear, quadratic] = BULK_VISCOSITY;
    Ok(Solid::new(strength(STANDARD)?, eos()?).with_bulk_viscosity(linear, quadratic)?)
}
