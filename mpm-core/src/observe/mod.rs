//! Observers: what looks at a run between its steps.
//!
//! Nothing here is inside a step. [`Mpm::run_observed`] makes steps until the end and shows the scene to every
//! [`Observer`] that is due, as a [`Moment`]. A run without observers does none of this work, and a run with
//! them makes the same steps, bit for bit: **an observer sees the first step that ends at or after its due
//! time; no step is shortened for it.** Only the end of a run is met exactly. Every observer also sees the
//! first and the last moment of a run.
//!
//! | observer | keeps or writes |
//! |---|---|
//! | [`Ledger`] | energy and momentum, and how well they are conserved |
//! | [`Probes`] | quantities of chosen particles |
//! | [`HistoryCsv`] | any numbers, one row a moment, as CSV |
//! | [`VtkSeries`] | frames for ParaView |
//! | [`Pictures`] | PNG pictures |
//! | [`Progress`] | a bar on the terminal |
//!
//! An observer of one's own is two methods:
//!
//! ```
//! use mpm_core::Float;
//! use mpm_core::observe::{Moment, ObserveError, Observer, Pace};
//!
//! /// The largest speed of any particle, m/s.
//! struct Fastest(Pace, f64);
//! impl<T: Float, const D: usize> Observer<T, D> for Fastest {
//!     fn pace(&mut self) -> &mut Pace {
//!         &mut self.0
//!     }
//!     fn observe(&mut self, now: &Moment<'_, T, D>) -> Result<(), ObserveError> {
//!         for body in now.bodies() {
//!             body.for_each(&mut |p| {
//!                 let [u, v, w] = p.velocity;
//!                 self.1 = self.1.max((u * u + v * v + w * w).sqrt());
//!             });
//!         }
//!         Ok(())
//!     }
//! }
//! let fastest = Fastest(Pace::interval(1.0e-6)?, 0.0);
//! # Ok::<(), ObserveError>(())
//! ```
//!
//! [`Mpm::run_observed`]: crate::Mpm::run_observed

mod history;
mod ledger;
mod moment;
mod pace;
mod pictures;
mod probe;
mod progress;
mod run;
#[cfg(test)]
mod tests;

pub use history::HistoryCsv;
pub use ledger::{Ledger, LedgerEntry};
pub use moment::Moment;
pub use pace::Pace;
pub use pictures::{Pictures, VtkSeries};
pub use probe::{Probe, ProbeRow, Probes, Quantity};
pub use progress::Progress;
pub use run::{RunError, RunSummary};

use crate::output::OutputError;
use crate::parallel::Float;
use crate::watch::Warning;

/// Something that looks at a run between its steps.
pub trait Observer<T: Float, const D: usize> {
    /// When it wants to look. The run asks this and keeps it up to date.
    fn pace(&mut self) -> &mut Pace;

    /// Look.
    ///
    /// # Errors
    /// Whatever keeps it from doing so; the run stops there.
    fn observe(&mut self, now: &Moment<'_, T, D>) -> Result<(), ObserveError>;

    /// The run warned of something ([`crate::watch`]).
    fn warned(&mut self, warning: &Warning) {
        let _ = warning;
    }

    /// The run is over, whether it reached its end or stopped.
    fn finish(&mut self) {}
}

/// Why an observer could not be made or could not look.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ObserveError {
    /// A file or a picture.
    #[error(transparent)]
    Output(#[from] OutputError),
    /// A pace that no run can keep.
    #[error("pace: {field} = {value} is not allowed; it must be {allowed}")]
    Pace {
        /// "steps" or "interval".
        field: &'static str,
        /// The number given.
        value: f64,
        /// What would have been allowed.
        allowed: &'static str,
    },
    /// A probe of a body that is not there.
    #[error("probe of body {body} is not allowed; the scene has {bodies} bodies, numbered from 0")]
    NoBody {
        /// The body asked for.
        body: usize,
        /// How many there are.
        bodies: usize,
    },
    /// A probe of a particle that is not there.
    #[error("probe of particle {particle} of body `{body}` is not allowed; it has {particles} particles")]
    NoParticle {
        /// The body.
        body: String,
        /// The particle asked for.
        particle: usize,
        /// How many there are.
        particles: usize,
    },
    /// A probe of a number that the law does not keep.
    #[error("probe of state `{name}` of body `{body}` is not allowed; its law keeps {available}")]
    NoState {
        /// The body.
        body: String,
        /// The name asked for.
        name: String,
        /// The names there are.
        available: String,
    },
    /// A measure of the user's own.
    #[error("{0}")]
    Other(String),
}
