//! Tests of the linear solves in one program, so that common code is compiled once.

#![allow(missing_docs)]

mod cholesky;
mod domains;
mod exact;
mod krylov;
mod multigrid;
