//! Observers: what looks at a run between its steps.
//!
//! Nothing here is inside a step. A [`Run`](crate::Run) makes steps until the end and shows the scene to every
//! [`Observer`] that is due, as a [`RunView`]. A run without observers does none of this work, and a run with
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
//! | [`Snapshots`] | snapshots, for pictures after the run |
//! | [`SmallStrain`] | which bodies stayed at small strain: where elements would have done |
//! | [`Progress`] | a bar on the terminal, lines in a log |
//!
//! Files and pictures are made in the step that they show, or by a thread beside the run: [`Background`].
//!
//! What they keep goes into the checkpoints of a run, so that a run that is broken off and resumed leaves the files and numbers of
//! one that was not.
//!
//! An observer of one's own is three methods:
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

/// Something that looks at a run between its steps.
pub trait Observer {
    /// When it wants to look. The run asks this and keeps it up to date.
    fn pace(&mut self) -> &mut Pace;

    /// Look.
    ///
    /// # Errors
    /// Whatever keeps it from doing so; the run stops there.
    fn observe(&mut self, now: &RunView<'_>) -> Result<(), ObserveError>;

    /// What it keeps, to a checkpoint or from one. Its pace is kept by the run.
    ///
    /// # Errors
    /// The file.
    fn archive(&mut self, file: &mut Archive) -> Result<(), CheckpointError>;

    /// The run warned of something ([`crate::watch`]).
    fn warned(&mut self, warning: &Warning) {
        let _ = warning;
    }

    /// Does it end the run here, as if this were the end that was asked for? Asked after every step, and before the first one.
    fn ends_run(&self) -> bool {
        false
    }

    /// The run is over, whether it reached its end or stopped.
    ///
    /// # Errors
    /// Work that it left for the end and cannot do.
    fn finish(&mut self) -> Result<(), ObserveError> {
        Ok(())
    }
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
    /// A solver of another type than an observer looks at.
    #[error("the solver is no `{wanted}`")]
    OtherSolver {
        /// The type that the observer looks at.
        wanted: &'static str,
    },
    /// A measure of the user's own.
    #[error("{0}")]
    Other(String),
}
