//! Problems whose exact solutions are known, run with every formulation the framework has.
//!
//! A [`Case`] is a problem, a scheme and a resolution; running it gives errors and work. The errors of the cases in
//! [`fast`] are stored in `data/errors.csv`, and the tests hold them to 2 %: a change of a scheme that changes its
//! accuracy is seen. Orders of convergence are judged over at least three grids.
//!
//! | problem | what is exact |
//! |---|---|
//! | [`problems::axis_aligned`] | large axis-aligned stretch of a unit square or cube, manufactured (V3) |
//! | [`problems::vortex`] | turning of an annulus within a block, shear up to 7, manufactured (V4) |
//! | [`problems::ring`] | a ring with free curved surfaces that expands, manufactured (V5) |
//! | [`problems::bar`] | period of a bar (V1), energy of a drifting one (V2), a pulse (V7) |
//! | [`problems::rigid`] | rigid flight and turn (V6) |
//! | [`problems::column`] | stress of a column under its weight (V14) |
//! | [`problems::statics`] | Cook's membrane (V17) and a cantilever (V15) at rest |
//! | [`problems::gas`] | Sod's shock tube (V13), Taylor-Green vortices at low Mach number (V22) |
//! | [`problems::footing`] | limit load of a strip footing (V18), by any method |
//!
//! V8 to V12 (impact and contact) are the case `bouncing_blocks` of the package `examples`, its errors among its
//! checks.
//!
//! [`limit`] has the longest stable step of runs, eigenvalues and bounds.
//!
//! Every composition is compiled once, here, for tests and for the package `report`.

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
