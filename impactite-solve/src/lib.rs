//! Linear solves on blocks of cells: Krylov methods, and a multigrid preconditioner for the pressure equation of incompressible flow.
//!
//! The crate knows no method. It solves A x = b on vectors of `f64`; units are those of the caller.
//!
//! # Equations
//! A [`Stencil`] is the finite-volume operator of -div(k grad x) on the unknown cells of a [`CellBlocks`], with a symmetric (2D+1)-point
//! stencil,
//!
//! ```text
//! (A x)_c = d_c x_c - sum_f w_f x_n,    d_c = sum_f w_f + e_c,
//! ```
//!
//! w_f = k A_f / h for a face of the open area A_f between two unknowns, zero at walls, and e_c = w / theta for each face with a prescribed
//! value at the distance theta h, 0 < theta <= 1: a free surface (ghost fluid, \[Gibou2002\]). Connected regions of unknowns with e = 0 are singular: a
//! closed tank, a drop between walls. Their mean is removed from b and x; a right-hand side with a larger mean than
//! [`Stop::incompatible`] allows is an error.
//!
//! # Solvers
//! | solver | operator | source |
//! |---|---|---|
//! | [`conjugate_gradients`] | symmetric positive (semi)definite | \[HestenesStiefel1952\], flexible update \[Notay2000\] |
//! | [`minres`] | symmetric, indefinite | \[PaigeSaunders1975\] |
//! | [`gmres`] | any regular | \[SaadSchultz1986\], flexible \[Saad1993\] |
//!
//! Each of them takes an [`Operator`] and a [`Preconditioner`], and returns after it has computed and checked the true residual
//! |b - A x| <= max(relative |b|, absolute). All else is an error with its cause.
//!
//! ```
//! use std::sync::Arc;
//! use impactite_simd::Team;
//! use impactite_solve::{CellBlocks, Multigrid, Stencil, Stop, conjugate_gradients};
//!
//! // -x'' = 2 between walls, on a row of 40 cells of the width 1/40; the weight of a face is 40.
//! let team = Team::one();
//! let cells = Arc::new(CellBlocks::of_cells((0..40).map(|i| [i, 0])));
//! let (mut weights, mut diagonal) = ([vec![0.0; cells.cells()], vec![0.0; cells.cells()]], vec![0.0; cells.cells()]);
//! let mut b = vec![0.0; cells.cells()];
//! for i in 0..40 {
//!     let slot = cells.find([i, 0]).expect("a cell of the row");
//!     weights[0][slot] = if i < 39 { 40.0 } else { 0.0 };
//!     // The ends are prescribed, at half a cell from the outer cells.
//!     diagonal[slot] = if i == 0 || i == 39 { 40.0 + 80.0 } else { 80.0 };
//!     b[slot] = 2.0 / 40.0;
//! }
//! let stencil = Stencil::new(&team, cells.clone(), weights, diagonal)?;
//! let mut multigrid = Multigrid::new(&team, &stencil);
//! let mut x = vec![0.0; cells.cells()];
//! let solved = conjugate_gradients(&team, &stencil, &mut multigrid, &b, &mut x, &Stop::default())?;
//! let middle = x[cells.find([20, 0]).expect("a cell of the row")];
//! assert!(solved.iterations < 15 && (middle - 0.25).abs() < 1e-3);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Multigrid
//! [`Multigrid`] is a V-cycle for cell-centred multigrid on a sparse set of cells \[Trottenberg2001\], as a preconditioner of conjugate
//! gradients \[McAdams2010\].
//!
//! - **Coarse cells** are the cubes of 2^D cells that contain an unknown, down to at most 128 unknowns.
//! - **Coarse operator**: again a (2D+1)-point stencil. The weight of a coarse face is the conductance of the path between the centres of its cells:
//!   the sum of the weights of its fine faces, in series with half of the sums of the weights within both cells. On a uniform grid this is the weight of
//!   the discretisation with 2 h. An excess at the boundary of the coarse cell is in series with half of the cell, too.
//! - **Interpolation**: with the factor t = G / (2 G + 4 W) of each nearest neighbour of the coarse cell, for the conductance G to the neighbour
//!   and W within the cell; 1/8 on a uniform grid, half of linear interpolation. Restriction is its transpose.
//! - **Smoother**: red-black Gauss-Seidel, two sweeps (red, black) before and two sweeps (black, red) after the coarse correction, so that the cycle
//!   is symmetric. The residual of black cells is zero before the restriction, and black values are overwritten after the interpolation: both transfers
//!   visit red cells alone.
//! - **Coarsest level**: dense Cholesky factorisation (nalgebra), as an inverse that is checked against the identity; a null space is
//!   made regular.
//! - The cycle runs in **single precision** on r / max |r|. It is a preconditioner: the accuracy of x is that of the residual, in double precision.
//!
//! # Measurements
//! Iterations for a residual of 1e-8 |b| from x = 0, for noise and for a smooth b, and times per unknown of the smooth case: of the check of a new
//! [`Stencil`], of [`Multigrid::renew`], and of the solve. One thread of a shared AMD EPYC processor with AVX2, 2 cores, 32 MB of cache in all,
//! other programs running; times of repeated runs differ by 30 %. `cargo run --release -p impactite-solve --example iterations`:
//!
//! The domains (`tests/solve/domains.rs`) are a box with prescribed values, a tank without (closed), a ball, a column and a pool with 200 drops with free
//! surfaces, fluid with a free surface around two spheres that cut faces, a ball with a random theta from 0.01 to 1 at each face, a tank with a ball of a
//! density 1000 times larger, a tank with random openings of all faces (a tenth closed, else u^2 with u from 0.1 to 1 at random), and a tank of random
//! cubes of 5^D cells whose densities differ by 1000.
//!
//! | D = 3 | 16^3 | 32^3 | 64^3 | 128^3 | unknowns of the last | check, ns | set-up, ns | solve, ns |
//! |---|---|---|---|---|---|---|---|---|
//! | open box | 6, 7 | 7, 7 | 7, 7 | 7, 7 | 2097152 | 47 | 81 | 476 |
//! | closed tank | 6, 7 | 6, 7 | 7, 7 | 7, 7 | 2097152 | 40 | 75 | 497 |
//! | ball | 7, 7 | 7, 7 | 7, 8 | 7, 8 | 698401 | 43 | 88 | 650 |
//! | dam column | 6, 7 | 7, 7 | 7, 8 | 7, 8 | 539136 | 44 | 63 | 449 |
//! | splash | 7, 7 | 7, 8 | 7, 8 | 7, 9 | 665553 | 47 | 88 | 659 |
//! | obstacle | 6, 8 | 7, 8 | 7, 8 | 7, 8 | 1285940 | 47 | 91 | 630 |
//! | random theta | 7, 7 | 6, 7 | 7, 8 | 7, 9 | 698401 | 40 | 96 | 566 |
//! | jump 1000 | 7, 8 | 9, 9 | 10, 11 | 11, 13 | 2097152 | 39 | 84 | 860 |
//! | random faces | 11, 12 | 11, 12 | 12, 14 | 12, 15 | 2097148 | 37 | 61 | 969 |
//! | foam 1000 | 17, 18 | 26, 29 | 38, 46 | 70, 83 | 2097152 | 43 | 70 | 4599 |
//!
//! | D = 2 | 32^2 | 128^2 | 512^2 | 1024^2 | unknowns of the last | check, ns | set-up, ns | solve, ns |
//! |---|---|---|---|---|---|---|---|---|
//! | open box | 6, 6 | 6, 7 | 6, 7 | 6, 7 | 1048576 | 26 | 106 | 433 |
//! | closed tank | 6, 6 | 6, 7 | 6, 7 | 6, 7 | 1048576 | 30 | 116 | 550 |
//! | ball | 6, 6 | 6, 8 | 7, 9 | 8, 10 | 609076 | 30 | 92 | 449 |
//! | dam column | 6, 6 | 6, 7 | 6, 7 | 6, 8 | 270900 | 24 | 94 | 340 |
//! | splash | 6, 6 | 7, 8 | 8, 9 | 8, 10 | 578152 | 29 | 128 | 651 |
//! | obstacle | 7, 7 | 7, 8 | 7, 9 | 9, 11 | 392035 | 50 | 138 | 1214 |
//! | random theta | 6, 6 | 7, 8 | 7, 9 | 8, 10 | 609076 | 19 | 103 | 397 |
//! | jump 1000 | 10, 10 | 11, 12 | 12, 14 | 12, 15 | 1048576 | 30 | 113 | 893 |
//! | random faces | 15, 17 | 23, 27 | 36, 43 | 39, 51 | 1048471 | 29 | 98 | 2761 |
//! | foam 1000 | 17, 19 | 62, 72 | 125, 145 | 176, >200 | 1048576 | 24 | 116 | 10100 |
//!
//! Slots without an unknown cost as much as unknowns: 47 % of the slots of the obstacle in the plane, 14 % in space.
//!
//! **Not met:** fluids whose coefficients jump everywhere at the scale of a few cells (random faces in the plane, foam 1000) take more iterations the larger they
//! are. Their coarse cells join parts that hardly exchange anything, which a (2D+1)-point coarse operator cannot represent.
//!
//! With two threads of this machine the time of the calling thread on its processor falls from 476 to 235 ns for the open box of 128^3 cells, and from 659
//! to 400 ns for the splash.
//!
//! Alternatives that were measured, iterations for noise and smooth b on 64^3 cells (512^2 in the plane), unless said otherwise:
//!
//! | variant | ball | obstacle | jump 1000 | jump 1000, D = 2 | random faces, D = 2 |
//! |---|---|---|---|---|---|
//! | t halved, sums in series (taken) | 7, 8 | 7, 8 | 10, 11 | 12, 14 | 35, 43 |
//! | t halved, each column of faces in series | 7, 8 | 7, 8 | 9, 11 | 11, 14 | 39, 48 |
//! | linear interpolation, t = G / (G + 2 W), columns in series | 8, 9 | 8, 9 | 10, 11 | 11, 14 | 40, 47 |
//! | constant interpolation, t = 0, columns in series | 7, 8 | 7, 8 | 14, 16 | 25, 31 | 40, 49 |
//! | linear interpolation, one sweep instead of two, 128^3 and 1024^2 | 11, 13 | 11, 14 | 21, 24 | 23, 28 | |
//!
//! One sweep takes less time per iteration and, with 1.5 times the iterations, some 1.5 times the time of a solve.
//!
//! # Memory
//! Bytes per slot of a block: the stencil 8 (D + 1); a solve by conjugate gradients 32, and 16 for b and x; the multigrid levels 67 in space,
//! 65 in the plane. MINRES takes 48, GMRES 16 (m + 1) for a restart after m iterations.
//!
//! # Equal bits
//! Sums are made over pieces of 4096 slots and added in their order; loops write what their task owns. Results have the same bits for any number
//! of threads, on one kind of processor. Kernels fuse no product with a sum; the factorisation of the coarsest level does where the processor can.

mod cells;
mod coarsen;
mod coarsest;
mod colours;
mod conjugate_gradients;
mod error;
mod gmres;
mod krylov;
mod least_squares;
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
pub use least_squares::least_squares_weights;
pub use minres::minres;
pub use multigrid::Multigrid;
pub use operator::{Identity, Jacobi, Operator, Preconditioner};
pub use stencil::Stencil;
