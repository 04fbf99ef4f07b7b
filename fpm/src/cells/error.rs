//! What cells are refused for.

use impactite_geometry::{GeometryError, search::SearchError};

/// Cells, or points to make cells of, that cannot be.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CellsError {
    /// A shape or a mesh.
    #[error(transparent)]
    Geometry(#[from] GeometryError),
    /// Points that no search for neighbours can use.
    #[error(transparent)]
    Search(#[from] SearchError),
    /// A number of a cell.
    #[error("cell {cell} at {position:?} m: {field} = {value:e} is not allowed; it must be {allowed}")]
    Cell {
        /// The cell.
        cell: usize,
        /// Its point, m.
        position: Vec<f64>,
        /// Which number.
        field: &'static str,
        /// Its value.
        value: f64,
        /// What is allowed, in words.
        allowed: &'static str,
    },
    /// A number of what cells are made by.
    #[error("{owner}: {field} = {value} is not allowed; it must be {allowed}")]
    Parameter {
        /// What it belongs to.
        owner: &'static str,
        /// Which number.
        field: &'static str,
        /// Its value.
        value: f64,
        /// What is allowed, in words.
        allowed: &'static str,
    },
}

/// Refuse a parameter unless it `holds` and is finite.
pub(crate) fn parameter(
    holds: bool,
    owner: &'static str,
    field: &'static str,
    value: f64,
    allowed: &'static str,
) -> Result<f64, CellsError> {
    if holds && value.is_finite() {
        Ok(value)
    } else {
        Err(CellsError::Parameter { owner, field, value, allowed })
    }
}
