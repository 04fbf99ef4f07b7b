//! What every run watches over: its energy and momentum, and whether its bodies are what the method can represent.
//!
//! A scene keeps a balance ([`Account`]): what its points have, and what boundaries, loads, body forces, friction, damping and splitting explain
//! of its change. A solver that has a [`Watcher`] looks at it now and then, by [`Watch`]: after 16 and 64 steps, every 256 steps, and at the
//! end of [`Solver::run_until`](crate::Solver::run_until) and of a [`Run`](crate::Run). A gain of energy that nothing explains stops
//! the run, with time, body, place, likely cause and remedy; what may be wrong becomes a [`Warning`].
//!
//! | finding | sign of | by default |
//! |---|---|---|
//! | energy gained | instability: noise that nodes do not see, a time step too long, walls and contacts that give more than they took | warns at 2 %, stops at 10 % |
//! | energy lost | dissipation of the transfer (PIC, APIC), contact that closes | warns at 3 % |
//! | energy off after few steps | half a step of work: kinetic and internal energy belong to times half a step apart | warns at 10 % at the end of a run of fewer than 64 steps |
//! | momentum | a boundary or contact that is no pair of forces | stops at the root of the rounding unit |
//! | torn body | numerical fracture: particles drawn so far apart that they share no node | warns |
//! | alternating pressure | volumetric locking | warns |
//! | points that failed alone | stress noise that reached the strength | warns |
//!
//! All of it reads and changes nothing: results are the same bits with and without. A look at the books costs one to two steps, one at the bodies
//! (every sixteenth) some fifteen: below 1 % of a run together (book, "What the watch costs").
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

mod suspects;
mod watcher;

pub use crate::balance::Account;
pub use crate::finding::{Booked, Finding, GainCause, Loss, Warning};
pub use suspects::{gain_at_the_fastest, not_finite};
pub use watcher::{Look, Watcher};

use crate::error::SceneError;

/// What a run watches over, and what it does about it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Watch {
    every: u64,
    warn_gain: f64,
    stop_gain: f64,
    warn_loss: f64,
    /// Momentum, or the root of the rounding unit.
    momentum: Option<f64>,
    bodies: bool,
    stops: bool,
}

/// The defaults of the table above.
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
    /// Nothing is watched, and no books are kept.
    #[must_use]
    pub fn off() -> Self {
        Watch { every: u64::MAX, ..Watch::default() }
    }
    /// Warn of everything and stop for nothing.
    #[must_use]
    pub fn only_warn(self) -> Self {
        Watch { stops: false, ..self }
    }
    /// Look every so many steps; at the bodies at every sixteenth look.
    ///
    /// # Errors
    /// No steps.
    pub fn every(self, steps: u64) -> Result<Self, SceneError> {
        let every = if steps == 0 { None } else { Some(steps) };
        let every = every.ok_or(SceneError::Watch { field: "every", value: 0.0 })?;
        Ok(Watch { every, ..self })
    }
    /// Look at energy and momentum alone, and not at parts, pressure and failure of bodies.
    #[must_use]
    pub fn without_bodies(self) -> Self {
        Watch { bodies: false, ..self }
    }
    /// Warn of an energy gain above this share of the largest energy of the run, found at three looks one after the other.
    ///
    /// # Errors
    /// A share that is not positive.
    pub fn warn_at_gain(self, share: f64) -> Result<Self, SceneError> {
        Ok(Watch { warn_gain: positive("warn at gain", share)?, ..self })
    }
    /// Stop at an energy gain above this share of the largest energy of the run, found at two looks one after the other, or above half of that
    /// energy at one. Kinetic and internal energy belong to times half a step apart: a look alone may show a swing, and a run that gathers energy from nothing
    /// is judged when that no longer doubles from look to look. With kinetic damping energy is not judged.
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
    /// Stop where momentum above this share of the largest sum of m |v|, or of all impulses given, is not explained.
    ///
    /// # Errors
    /// A share that is not positive.
    pub fn stop_at_momentum(self, share: f64) -> Result<Self, SceneError> {
        Ok(Watch { momentum: Some(positive("stop at momentum", share)?), ..self })
    }

    /// Is nothing watched?
    #[must_use]
    pub fn is_off(&self) -> bool {
        self.every == u64::MAX
    }
}

fn positive(field: &'static str, value: f64) -> Result<f64, SceneError> {
    if value > 0.0 && value.is_finite() { Ok(value) } else { Err(SceneError::Watch { field, value }) }
}
