//! Errors of operators and solves.

/// Invalid entries of a stencil.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum StencilError {
    /// Array of a length that differs from the number of slots.
    #[error(
        "stencil: {field} has length {value}, which is not allowed; it must be {cells}, the number of slots"
    )]
    Length {
        /// Name of the array.
        field: &'static str,
        /// Length of the array.
        value: usize,
        /// Number of slots.
        cells: usize,
    },
    /// Entry of a cell out of range.
    #[error("stencil: {field} = {value:e} of cell {cell:?} is not allowed; it must be {allowed}")]
    Entry {
        /// Name of the array.
        field: &'static str,
        /// Value given.
        value: f64,
        /// Coordinates of the cell.
        cell: Vec<i32>,
        /// Allowed values, in words.
        allowed: &'static str,
    },
}

/// Failed linear solve.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SolveError {
    /// Vector of a length that differs from that of the operator.
    #[error(
        "linear solve: {field} has length {value}, which is not allowed; it must be {unknowns}, the length of the operator"
    )]
    Length {
        /// Name of the vector.
        field: &'static str,
        /// Length of the vector.
        value: usize,
        /// Length of the operator.
        unknowns: usize,
    },
    /// Parameter out of range.
    #[error("linear solve: {field} = {value:e} is not allowed; it must be {allowed}")]
    Setting {
        /// Name of the parameter.
        field: &'static str,
        /// Value given.
        value: f64,
        /// Allowed values, in words.
        allowed: &'static str,
    },
    /// Entry of a vector that is not finite.
    #[error("linear solve: {field} = {value} at index {index} is not allowed; it must be finite")]
    NotFinite {
        /// Name of the vector.
        field: &'static str,
        /// Value of the entry.
        value: f64,
        /// Index of the first such entry.
        index: usize,
    },
    /// Entry of the right-hand side in a row of the operator that is zero.
    #[error(
        "linear solve: b = {value:e} at index {index} is not allowed; it must be zero where the operator has no unknown"
    )]
    NoUnknown {
        /// Value of the entry.
        value: f64,
        /// Index of the first such entry.
        index: usize,
    },
    /// Right-hand side with a component in the null space of a singular operator.
    #[error(
        "linear solve: the right-hand side is incompatible with the singular operator: its part in the null space has the norm {removed:e}, \
         of {norm:e} in all; at most {allowed:e} of the norm is allowed; sources of a region without a Dirichlet boundary (a closed tank) \
         must sum to zero"
    )]
    Incompatible {
        /// Norm of the part of b in the null space.
        removed: f64,
        /// Norm of b.
        norm: f64,
        /// Largest allowed ratio of both.
        allowed: f64,
    },
    /// Search direction p with p . A p <= 0: the operator is not positive definite.
    #[error(
        "conjugate gradients: curvature p . A p = {value:e} in iteration {iteration} is not allowed; it must be positive: the operator is not \
         symmetric positive definite; MINRES solves symmetric indefinite systems, GMRES any"
    )]
    Curvature {
        /// Curvature p . A p.
        value: f64,
        /// Number of the iteration.
        iteration: usize,
    },
    /// Residual r with r . z <= 0, z = M^-1 r: the preconditioner is not positive definite.
    #[error(
        "linear solve: r . z = {value:e} of the preconditioner in iteration {iteration} is not allowed; it must be positive: the preconditioner \
         is not symmetric positive definite"
    )]
    Preconditioner {
        /// Product r . z.
        value: f64,
        /// Number of the iteration.
        iteration: usize,
    },
    /// Tolerance that was not reached.
    #[error(
        "linear solve: residual {residual:e} after {iterations} iterations is not allowed; it must be at most {tolerance:e}; {advice}"
    )]
    NotReached {
        /// Norm of the true residual b - A x.
        residual: f64,
        /// Tolerance of the residual.
        tolerance: f64,
        /// Number of iterations.
        iterations: usize,
        /// Remedy, in words.
        advice: &'static str,
    },
}
