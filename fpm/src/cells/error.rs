//! Errors of cells.

use impactite_geometry::{GeometryError, search::SearchError};

/// Invalid cells, or invalid points for cells.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CellsError {
    /// Invalid shape or mesh.
    #[error(transparent)]
    Geometry(#[from] GeometryError),
    /// Points that the neighbour search cannot use.
    #[error(transparent)]
    Search(#[from] SearchError),
    /// Invalid number of a cell.
    #[error("cell {cell} at {position:?} m: {field} = {value:e} is not allowed; it must be {allowed}")]
    Cell {
        /// Number of the cell.
        cell: usize,
        /// Point of the cell, m.
        position: Vec<f64>,
        /// Name of the number.
        field: &'static str,
        /// Value of the number.
        value: f64,
        /// Allowed values, in words.
        allowed: &'static str,
    },
    /// Invalid parameter of the construction of cells.
    #[error("{owner}: {field} = {value} is not allowed; it must be {allowed}")]
    Parameter {
        /// Owner of the parameter.
        owner: &'static str,
        /// Name of the parameter.
        field: &'static str,
        /// Value of the parameter.
        value: f64,
        /// Allowed values, in words.
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
