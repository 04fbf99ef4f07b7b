//! What every solver and every boundary condition must do, as tests that one line applies to any of them, ours or yours. Behind the
//! feature `conformance`.

mod condition;
mod solver;

pub use condition::condition;
pub use solver::{Scene, SolverTests, balances, bodies, errors, observers, restart, steps, threads};

/// A property that does not hold.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{subject}: {property} does not hold: {detail}")]
pub struct Broken {
    /// What was tested.
    pub subject: String,
    /// The property, in words.
    pub property: &'static str,
    /// Where and by how much.
    pub detail: String,
}
