//! Automatic checks of a run: energy and momentum balances, and bodies beyond the validity of the method.
//!
//! A scene keeps a balance ([`Account`]) of its points' mass, momentum and energy against the contributions of boundaries, loads, body
//! forces, friction, damping and splitting. A solver with a [`Watcher`] checks it at the intervals of [`Watch`]: after 16 and 64 steps,
//! every 256 steps, and at the end of [`Solver::run_until`](crate::Solver::run_until) and of a [`Run`](crate::Run). Severe findings stop
//! the run and are reported with time, body, position, likely cause and remedy; other findings become a [`Warning`].
//!
//! | finding | sign of | by default |
//! |---|---|---|
//! | energy gain | instability: null-space noise, too long a time step, walls and contacts that add energy | warns at 2 %, stops at 10 % |
//! | energy loss | dissipation of the transfer (PIC, APIC), closing contact | warns at 3 % |
//! | energy error | half a step of work: kinetic and internal energy are half a step apart | warns at 10 % after fewer than 64 steps |
//! | momentum | a boundary or contact without equal and opposite forces | stops at the root of the rounding unit |
//! | torn body | numerical fracture: particles so far apart that they share no node | warns |
//! | alternating pressure | volumetric locking | warns |
//! | points that failed alone | stress noise above the strength | warns |
//! | localised plastic strain | bands of one or two cells, whose width is that of the cells | warns |
//! | fast weakly compressible liquid | densities that differ by more than 1 % from the motion | warns above 0.15 of the speed of sound |
//!
//! The checks do not change the run: results are the same bits with and without them. A balance check costs one to two steps, a check of
//! the bodies (every sixteenth) some fifteen: together below 1 % of a run (book, "What the watch costs").
//!
//! ```ignore
//! use mpm_core::Watch;
//! # use mpm_core::{BlockGrid, FullSpace, Method, Mpm, geometry::Lattice};
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! # let mut mpm = Mpm::new(Method::impact(FullSpace), BlockGrid::new(Lattice::new([0.0; 3], 0.1)?));
//! mpm.set_watch(Watch::default().stop_at_gain(0.02)?); // stricter
//! mpm.set_watch(Watch::default().only_warn()); // goes on, whatever happens
//! mpm.set_watch(Watch::off());
//! for warning in mpm.warnings() {
//!     println!("{warning}");
//! }
//! # Ok(())
//! # }
//! ```

mod bands;
mod compression;
mod suspects;
mod watcher;

pub use crate::balance::Account;
pub use crate::finding::{Booked, Finding, GainCause, Loss, Warning};
pub use suspects::{gain_at_the_fastest, not_finite};
pub use watcher::{Look, Watcher};

use crate::error::SceneError;

/// Settings of the checks: interval, thresholds, and permission to stop the run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Watch {
    every: u64,
    warn_gain: f64,
    stop_gain: f64,
    warn_loss: f64,
    /// Threshold of the momentum error; if none, the root of the rounding unit.
    momentum: Option<f64>,
    bodies: bool,
    stops: bool,
}

/// The defaults of the module's table.
impl Default for Watch {
    fn default() -> Self {
        Watch {
            every: 256,
            warn_gain: 0.02,
            stop_gain: 0.10,
            warn_loss: 0.03,
            momentum: None,
            bodies: true,
            stops: true,
        }
    }
}

impl Watch {
    /// Disable all checks, and keep no balance.
    #[must_use]
    pub fn off() -> Self {
        Watch { every: u64::MAX, ..Watch::default() }
    }
    /// Issue warnings only; never stop the run.
    #[must_use]
    pub fn only_warn(self) -> Self {
        Watch { stops: false, ..self }
    }
    /// Check every so many steps, and the bodies at every sixteenth check.
    ///
    /// # Errors
    /// Zero steps.
    pub fn every(self, steps: u64) -> Result<Self, SceneError> {
        let every = if steps == 0 { None } else { Some(steps) };
        let every = every.ok_or(SceneError::Watch { field: "every", value: 0.0 })?;
        Ok(Watch { every, ..self })
    }
    /// Check energy and momentum only, not parts, pressure and failure of bodies.
    #[must_use]
    pub fn without_bodies(self) -> Self {
        Watch { bodies: false, ..self }
    }
    /// Warn of an energy gain above this share of the largest energy of the run, found at three consecutive checks.
    ///
    /// # Errors
    /// A share that is not positive.
    pub fn warn_at_gain(self, share: f64) -> Result<Self, SceneError> {
        Ok(Watch { warn_gain: positive("warn at gain", share)?, ..self })
    }
    /// Stop at an energy gain above this share of the largest energy of the run, found at two consecutive checks, or above half of that
    /// energy at one. A single check may see an oscillation, since kinetic and internal energy belong to times half a step apart. While the
    /// largest energy more than doubles between checks, a smaller gain is not judged. With kinetic damping energy is not judged.
    ///
    /// # Errors
    /// A share that is not positive.
    pub fn stop_at_gain(self, share: f64) -> Result<Self, SceneError> {
        Ok(Watch { stop_gain: positive("stop at gain", share)?, ..self })
    }
    /// Warn of an energy loss above this share.
    ///
    /// # Errors
    /// A share that is not positive.
    pub fn warn_at_loss(self, share: f64) -> Result<Self, SceneError> {
        Ok(Watch { warn_loss: positive("warn at loss", share)?, ..self })
    }
    /// Stop if an unexplained momentum exceeds this share of the largest sum of m |v| or of all applied impulses.
    ///
    /// # Errors
    /// A share that is not positive.
    pub fn stop_at_momentum(self, share: f64) -> Result<Self, SceneError> {
        Ok(Watch { momentum: Some(positive("stop at momentum", share)?), ..self })
    }

    /// True if all checks are disabled.
    #[must_use]
    pub fn is_off(&self) -> bool {
        self.every == u64::MAX
    }
}

fn positive(field: &'static str, value: f64) -> Result<f64, SceneError> {
    if value > 0.0 && value.is_finite() { Ok(value) } else { Err(SceneError::Watch { field, value }) }
}
