//! Linear solves on blocks of cells.

mod cells;
mod coarsen;
mod coarsest;
mod colours;
mod conjugate_gradients;
mod error;
mod gmres;
mod krylov;
mod level;
mod minres;
mod multigrid;
mod operator;
mod regions;
mod stencil;
mod transfer;
mod vectors;

pub use cells::{CellBlocks, SIDE};
pub use conjugate_gradients::conjugate_gradients;
pub use error::{SolveError, StencilError};
pub use gmres::gmres;
pub use krylov::{Solved, Stop};
pub use minres::minres;
pub use multigrid::Multigrid;
pub use operator::{Identity, Jacobi, Operator, Preconditioner};
pub use stencil::Stencil;
