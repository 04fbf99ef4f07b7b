//! Pictures of elements in water.

use mpm_core::output::{OutputError, Snapshot};

/// The snapshot with this field of the particles alone: elements, which have none, are drawn grey.
///
/// # Errors
/// A field that is not there.
pub fn immersed(snapshot: &Snapshot, field: &str) -> Result<Snapshot, OutputError> {
    let is_element = |n: usize| snapshot.cells().is_some_and(|cells| !cells.of(n).is_empty());
    let values = snapshot.scalar(field)?.iter().enumerate();
    let values = values.map(|(n, &value)| if is_element(n) { f64::NAN } else { value }).collect();
    snapshot.clone().with_scalar(field, values)
}
