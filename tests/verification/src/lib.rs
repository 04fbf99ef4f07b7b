//! Problems with known exact solutions, run with every formulation of the framework.
//!
//! A [`Case`] is a problem, a scheme and a resolution; running it gives errors and work. The errors of the cases in
//! [`fast`] are stored in `data/errors.csv`. The tests compare with a tolerance of 2 %, so that they detect a
//! change in accuracy of a scheme. Orders of convergence are evaluated over at least three grids.
//!
//! | problem | exact solution |
//! |---|---|
//! | [`problems::axis_aligned`] | large axis-aligned stretch of a unit square or cube, manufactured (V3) |
//! | [`problems::vortex`] | rotation of an annulus within a block, shear up to 7, manufactured (V4) |
//! | [`problems::ring`] | expanding ring with free curved surfaces, manufactured (V5) |
//! | [`problems::bar`] | period of a bar (V1), energy of a drifting bar (V2), velocity pulse (V7) |
//! | [`problems::rigid`] | rigid translation and rotation (V6) |
//! | [`problems::column`] | stress of a column under its weight (V14) |
//! | [`problems::statics`] | static solutions of Cook's membrane (V17) and a cantilever (V15) |
//! | [`problems::gas`] | Sod's shock tube (V13), Taylor-Green vortices at low Mach number (V22) |
//! | [`problems::footing`] | limit load of a strip footing (V18), for any method |
//!
//! V8 to V12 (impact and contact) are in the case `bouncing_blocks` of the package `examples`, whose checks include
//! their errors.
//!
//! [`limit`] compares the stable time step of runs with eigenvalues and bounds.
//!
//! Every composition is compiled here once for tests and for the package `report`.

pub mod case;
pub mod empty;
pub mod fast;
pub mod formulation;
pub mod fragile;
pub mod limit;
pub mod origin;
pub mod problems;
pub mod scene;
pub mod scheme;
pub mod smoothed;
pub mod stored;
pub mod work;

pub use case::{Case, Outcome, Problem};
pub use scheme::{Kernel, Scheme, Velocity};
