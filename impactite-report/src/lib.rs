//! Report of a run: a self-contained page, `report.html`.
//!
//! A program adds a [`Recorder`] to its [`Run`](impactite_scene::Run), collects the results in a [`Record`], saves it in the folder of
//! the run and writes the page:
//!
//! ```
//! use impactite_report::{Check, Record, Recorder, write_page};
//! use impactite_scene::observe::Pace;
//! use impactite_scene::{Run, Solver};
//!
//! fn run(solver: &mut dyn Solver, folder: &std::path::Path) -> Result<(), Box<dyn std::error::Error>> {
//!     let mut recorder = Recorder::new(Pace::interval(1.0e-7)?);
//!     let summary = Run::new(&mut *solver).observe(&mut recorder).until(80.0e-6)?;
//!     Record::new("Taylor bar")
//!         .symmetry_planes(2)
//!         .bodies_of(&*solver)
//!         .balances(&recorder)
//!         .summary(&summary, 2)
//!         .check(Check::within("length", 16.3e-3, "m", 16.2e-3, 0.02, "[S]"))
//!         .save(folder)?;
//!     write_page(folder)?;
//!     Ok(())
//! }
//! ```
//!
//! | module | contents |
//! |---|---|
//! | [`record`] | data of a run, stored as `run.json` |
//! | [`recorder`] | observer that records balances, time steps and warnings |
//! | [`folder`] | reader of the folder of a run, finished or not |
//! | [`page`] | page writer |
//! | [`animation`] | animated PNG files |
//! | [`convergence`] | measures of runs of several resolutions: order, extrapolated value, error band |
//!
//! Energy errors are always printed by [`percent`]: the change of the total energy over the largest energy so far, with its sign.

pub mod animation;
pub mod convergence;
mod error;
pub mod folder;
mod number;
pub mod page;
pub mod record;
pub mod recorder;

pub use error::ReportError;
pub use number::{checks_passed, energy_error, percent};
pub use page::{write_convergence, write_page};
pub use record::{Check, FILE, Frames, HistoryRecord, Progress, Record};
pub use recorder::{Recorder, Warned};
