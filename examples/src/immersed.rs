//! Pictures of elements in water.

use mpm_core::output::{OutputError, Snapshot};

/// Name of the field that [`immersed`] adds.
pub const WATER_PRESSURE: &str = "pressure of the water";

/// Add the pressure of particles as the field [`WATER_PRESSURE`], Pa; it is NaN on elements, which are drawn grey.
///
/// # Errors
/// Snapshot without `pressure`.
pub fn immersed(snapshot: &Snapshot) -> Result<Snapshot, OutputError> {
    let is_element = |n: usize| snapshot.cells().is_some_and(|cells| !cells.of(n).is_empty());
    let values = snapshot.scalar("pressure")?.iter().enumerate();
    let values = values.map(|(n, &value)| if is_element(n) { f64::NAN } else { value }).collect();
    snapshot.clone().with_scalar(WATER_PRESSURE, values)
}
