//! The fragile points method \[Shen2022\]: cells with one point each, joined by numerical fluxes on their faces, which open as cracks.
//!
//! A body is divided into [`Cells`]: Voronoi cells of any points, or the elements of a mesh. The displacement is linear in each cell, with
//! a gradient by generalised finite differences over the neighbours that share a face. It jumps at faces, where a numerical flux joins the
//! cells ([`Flux`]) with a [`Penalty`]. A face that fails by a [`Criterion`] opens: its flux ends, and its cells are no longer neighbours.
//! Only adjacent cells change.
//!
//! Constitutive laws are from [`mpm_materials`], at finite strain; conditions, the run loop, observers and checkpoints from
//! [`impactite_scene`]. An [`Fpm`] is a [`Solver`](impactite_scene::Solver), and a body of [`mpm_contact::particles::Bodies`].
//!
//! ```
//! use fpm::{Cells, Domain, Fpm, Method, scattered};
//! use impactite_scene::PlaneStrain;
//! use mpm_materials::{LinearElastic, Moduli};
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! // A bar of steel, 20 mm x 4 mm, of cells of about 1 mm, pulled at its right end from t = 0.
//! let domain = Domain::cuboid([0.0, 0.0], [0.02, 0.004])?;
//! let cells = Cells::voronoi(&scattered(&domain, 1, |_| 1e-3)?, &domain)?;
//! let steel = LinearElastic::new(7850.0, Moduli::young_poisson(200e9, 0.3)?)?;
//! let mut bar = Fpm::new(Method::symmetric(PlaneStrain), steel, &cells, |_| [0.0; 2])?;
//! bar.hold_faces(|f| f.normal[0] < -0.5, std::sync::Arc::new(|_| [Some(0.0), None]))?;
//! bar.load_faces(|f| f.normal[0] > 0.5, std::sync::Arc::new(|_| [1e6, 0.0]))?;
//! bar.run_until(3e-6)?;
//! # Ok(())
//! # }
//! ```

mod cells;
mod contact;
mod crack;
mod damage;
mod flux;
mod fracture;
mod loads;
mod method;
mod open;
mod pace;
mod path;
mod rest;
mod sides;
mod soften;
mod softening;
mod solver;
mod step;
mod sums;
mod vector;
mod view;

pub use cells::{Cells, CellsError, Domain, Face, Notch, OuterFace, relaxed, scattered};
pub use crack::{AnyCriterion, Cohesive, Criterion, FaceStress, MaximumTension, MixedTensionShear, NoCracks};
pub use flux::{Flux, Incomplete, Penalty, Symmetric};
pub use fracture::Crack;
pub use loads::{FaceHistory, PressureHistory, TractionHistory};
pub use method::{Composition, Method, Space};
pub use path::{Tip, TipPath};
pub use solver::{Fpm, SMALL};
