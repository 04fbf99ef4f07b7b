//! Scenes of [`impactite`] from files.
//!
//! A scene file is TOML (or JSON of the same shape). Quantities are numbers in SI units or texts with units; named parameters can be used
//! in all of them; velocities and loads may be formulas of position and time. Errors contain file, line, column, key, value and the allowed
//! values.
//!
//! ```
//! use impactite_input::Source;
//!
//! let source = Source::new("ball.toml", r#"
//! title = "A ball on a wall"
//! space = "axisymmetric"
//! end = "1 us"
//! parameters = { radius = "2 mm" }
//! method.mpm = { cell = "radius / 4" }
//! materials.copper.library = "copper_taylor"
//! conditions = [
//!     { symmetry = { axis = "r", at = 0 } },
//!     { wall = { axis = "z", at = 0 } },
//! ]
//!
//! [bodies.ball]
//! material = "copper"
//! shape.ball = { centre = [0, "radius"], radius = "radius" }
//! velocity = [0, "-200 m/s"]
//! "#);
//! let scene = source.parse()?;
//! let mut solver = source.build(&scene)?;
//! solver.run_until(scene.end.value)?;
//! assert!(solver.totals().internal > 0.0);
//!
//! let wrong = source.set("bodies.ball.velocity=[0, \"-200 m\"]")?;
//! let said = wrong.parse().unwrap_err().to_string();
//! assert!(said.contains("bodies.ball.velocity[1]") && said.contains("speed"), "{said}");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod build;
mod document;
mod error;
mod estimate;
mod hint;
mod json;
pub mod keys;
pub mod list;
pub mod measured;
mod refine;
mod sets;

pub use build::size::bytes_a_point;
pub use document::{RESUMABLE, Source};
pub use error::{Fault, InputError, shown};
pub use estimate::{BodyEstimate, SceneEstimate};
pub use impactite_scene_file::{SceneFile, formula, model, quantity, remedy, schema, table};
pub use refine::Size;
