//! Conformance tests of solvers and boundary conditions, built-in or custom, in one line each. Behind the feature `conformance`.

mod condition;
mod solver;

pub use condition::condition;
pub use solver::{Scene, SolverTests, balances, bodies, errors, observers, restart, steps, threads};

/// Violated property.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{subject}: {property} does not hold: {detail}")]
pub struct Broken {
    /// Subject of the test.
    pub subject: String,
    /// Property, in words.
    pub property: &'static str,
    /// Place and amount of the violation.
    pub detail: String,
}
