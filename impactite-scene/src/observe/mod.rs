//! Observers: read access to a run between its steps.
//!
//! No observer is called within a step. A [`Run`](crate::Run) makes steps until the end and calls every [`Observer`] that is due, with a
//! [`RunView`]. Observers do not change the steps, bit for bit: **an observer is called after the first step that ends at or after its due
//! time; no step is shortened for it.** Only the end of a run is reached exactly. Every observer is also called at the start and at the end
//! of a run.
//!
//! | observer | output |
//! |---|---|
//! | [`Ledger`] | energy and momentum, and their conservation errors |
//! | [`Probes`] | quantities of chosen particles |
//! | [`HistoryCsv`] | custom quantities over time, as CSV |
//! | [`VtkSeries`] | frames for ParaView |
//! | [`Pictures`] | PNG pictures |
//! | [`Snapshots`] | snapshots, for pictures after the run |
//! | [`SmallStrain`] | bodies that stayed at small strain: finite elements suffice |
//! | [`Progress`] | progress bar on the terminal, progress lines in a log |
//!
//! Files and pictures are written in the observed step, or by a background thread: [`Background`].
//!
//! The state of observers is part of a run's checkpoints, so that an interrupted and resumed run writes the same files and numbers as an
//! uninterrupted one.
//!
//! A custom observer has three methods:
//!
//! ```
//! use impactite_scene::observe::{ObserveError, Observer, Pace, RunView};
//! use impactite_scene::{Archive, CheckpointError};
//!
//! /// The largest speed of any particle, m/s.
//! struct Fastest(Pace, f64);
//! impl Observer for Fastest {
//!     fn pace(&mut self) -> &mut Pace {
//!         &mut self.0
//!     }
//!     fn observe(&mut self, now: &RunView<'_>) -> Result<(), ObserveError> {
//!         for body in now.bodies() {
//!             body.for_each(&mut |p| {
//!                 let [u, v, w] = p.velocity;
//!                 self.1 = self.1.max((u * u + v * v + w * w).sqrt());
//!             });
//!         }
//!         Ok(())
//!     }
//!     fn archive(&mut self, file: &mut Archive) -> Result<(), CheckpointError> {
//!         file.real(&mut self.1)
//!     }
//! }
//! let fastest = Fastest(Pace::interval(1.0e-6)?, 0.0);
//! # Ok::<(), ObserveError>(())
//! ```

mod background;
mod displacement;
mod history;
mod ledger;
mod pace;
mod pictures;
mod probe;
mod progress;
mod strain;
mod view;

pub use background::Background;
pub use history::HistoryCsv;
pub use ledger::{Ledger, LedgerEntry};
pub use pace::Pace;
pub use pictures::{Draw, Pictures, Snapshots, VtkSeries};
pub use probe::{Probe, ProbeRow, Probes, Quantity};
pub use progress::{LineKind, Progress};
pub use strain::{BodyStrain, SmallStrain};
pub use view::RunView;

use crate::archive::{Archive, CheckpointError};
use crate::finding::Warning;
use impactite_output::OutputError;

/// Observer of a run between its steps.
pub trait Observer {
    /// Return the pace of observations. The run queries and updates it.
    fn pace(&mut self) -> &mut Pace;

    /// Observe the run.
    ///
    /// # Errors
    /// Any error; the run stops there.
    fn observe(&mut self, now: &RunView<'_>) -> Result<(), ObserveError>;

    /// Write or read the observer's state. The run saves the pace.
    ///
    /// # Errors
    /// I/O error; damaged file.
    fn archive(&mut self, file: &mut Archive) -> Result<(), CheckpointError>;

    /// Handle a warning of the run ([`crate::watch`]).
    fn warned(&mut self, warning: &Warning) {
        let _ = warning;
    }

    /// Return true to end the run here, as at the requested end. Called before the first step and after every step.
    fn ends_run(&self) -> bool {
        false
    }

    /// Finish after the run, whether it reached its end or stopped.
    ///
    /// # Errors
    /// Failure of deferred work.
    fn finish(&mut self) -> Result<(), ObserveError> {
        Ok(())
    }
}

/// Error of the set-up of an observer or of an observation.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ObserveError {
    /// Error of a file or a picture.
    #[error(transparent)]
    Output(#[from] OutputError),
    /// Invalid pace.
    #[error("pace: {field} = {value} is not allowed; it must be {allowed}")]
    Pace {
        /// Name of the field: "steps" or "interval".
        field: &'static str,
        /// Value given.
        value: f64,
        /// Allowed values, in words.
        allowed: &'static str,
    },
    /// Probe of a body that does not exist.
    #[error("probe of body {body} is not allowed; the scene has {bodies} bodies, numbered from 0")]
    NoBody {
        /// Body number given.
        body: usize,
        /// Number of bodies.
        bodies: usize,
    },
    /// Probe of a particle that does not exist.
    #[error("probe of particle {particle} of body `{body}` is not allowed; it has {particles} particles")]
    NoParticle {
        /// Name of the body.
        body: String,
        /// Particle number given.
        particle: usize,
        /// Number of particles.
        particles: usize,
    },
    /// Probe of a state variable that the law does not have.
    #[error("probe of state `{name}` of body `{body}` is not allowed; its law keeps {available}")]
    NoState {
        /// Name of the body.
        body: String,
        /// Name given.
        name: String,
        /// Available names.
        available: String,
    },
    /// Solver of another type than the observer requires.
    #[error("the solver is no `{wanted}`")]
    OtherSolver {
        /// Type that the observer requires.
        wanted: &'static str,
    },
    /// Error of a custom measure.
    #[error("{0}")]
    Other(String),
}
