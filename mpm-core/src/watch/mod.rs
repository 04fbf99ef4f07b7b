//! What every run watches over: its energy and momentum, and whether its bodies are what the method can represent.
//!
//! A scene keeps [`Books`](Account): what its particles have, and what boundaries, loads, body forces, friction, damping and splitting explain
//! of its change. [`Mpm::step`](crate::Mpm::step) looks at them now and then, by [`Watch`]: after 16 and 64 steps, every 256 steps, and at the
//! end of [`Mpm::run_until`](crate::Mpm::run_until) and [`Mpm::run_observed`](crate::Mpm::run_observed). A gain of energy that nothing explains stops
//! the run, with time, body, place, likely cause and remedy; what may be wrong becomes a [`Warning`].
//!
//! | finding | sign of | by default |
//! |---|---|---|
//! | energy gained | instability: noise that nodes do not see, a time step too long, walls and contacts that give more than they took | warns at 2 %, stops at 10 % |
//! | energy lost | dissipation of the transfer (PIC, APIC), contact that closes | warns at 10 % |
//! | momentum | a boundary or contact that is no pair of forces | stops at the root of the rounding unit |
//! | torn body | numerical fracture: particles drawn so far apart that they share no node | warns |
//! | alternating pressure | volumetric locking | warns |
//! | points that failed alone | stress noise that reached the strength | warns |
//!
//! All of it reads and changes nothing: results are the same bits with and without. A look at the books costs one to two steps, one at the bodies
//! (every sixteenth) some fifteen: below 1 % of a run together (book, "What the watch costs").
//!
//! ```
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

mod books;
mod cells;

pub use books::Account;
pub(crate) use books::{Books, share};
pub(crate) use cells::{Alternation, Cells, Wholeness};

use crate::step::SceneError;

/// What a run watches over, and what it does about it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Watch {
    pub(crate) every: u64,
    pub(crate) warn_gain: f64,
    pub(crate) stop_gain: f64,
    pub(crate) warn_loss: f64,
    /// Momentum, or the root of the rounding unit.
    pub(crate) momentum: Option<f64>,
    pub(crate) bodies: bool,
    pub(crate) stops: bool,
}

/// The defaults of the table above.
impl Default for Watch {
    fn default() -> Self {
        Watch {
            every: 256,
            warn_gain: 0.02,
            stop_gain: 0.10,
            warn_loss: 0.10,
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

    pub(crate) fn is_off(&self) -> bool {
        self.every == u64::MAX
    }
}

fn positive(field: &'static str, value: f64) -> Result<f64, SceneError> {
    if value > 0.0 && value.is_finite() { Ok(value) } else { Err(SceneError::Watch { field, value }) }
}

/// Something that may be wrong with a run that goes on.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("after step {step}, t = {time:.6e} s: {finding}")]
pub struct Warning {
    /// Steps made.
    pub step: u64,
    /// Time, s.
    pub time: f64,
    /// What was found.
    pub finding: Finding,
}

/// What a look at a run found.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Finding {
    /// Energy that nothing explains.
    #[error(
        "{joules:.4e} J of energy came from nowhere, {:.1} % of the largest energy of the run, most likely in body `{body}` near {position:?} m: {cause}",
        100.0 * share
    )]
    EnergyGain {
        /// Of the largest energy so far.
        share: f64,
        /// Energy, J.
        joules: f64,
        /// The body where the signs are strongest.
        body: String,
        /// Where, m.
        position: [f64; 3],
        /// What most likely brought it about, and what to do.
        cause: GainCause,
    },
    /// Energy that went where no book has it.
    #[error(
        "{joules:.4e} J of energy are gone, {:.1} % of the largest energy of the run, by the transfer's filter or contacts that closed; what keeps more, \
         in this order: FLIP with MUSL where nothing spins, AFLIP with USF, AFLIP with USL (`Method::impact`), APIC; and smaller cells",
        100.0 * share
    )]
    EnergyLoss {
        /// Of the largest energy so far.
        share: f64,
        /// Energy, J.
        joules: f64,
    },
    /// An energy or momentum that is no number.
    #[error("the energy or momentum of body `{body}` is not finite; lower the time step")]
    NotFinite {
        /// The body.
        body: String,
    },
    /// Momentum that nothing explains.
    #[error(
        "{momentum:?} kg m/s of momentum came from nowhere, {share:.1e} of what moves or was given: a contact, boundary or \
         transfer of one's own that is no pair of forces"
    )]
    Momentum {
        /// Of the largest sum of m |v|, or of all impulses given.
        share: f64,
        /// Along x, y, z, kg m/s.
        momentum: [f64; 3],
    },
    /// A body came apart though no particle of the parts failed.
    #[error(
        "body `{body}` is in {parts} parts and was in {before}, {:.2} % of its particles in parts where none failed: numerical fracture, particles drawn so far apart \
         that they share no node; give it a failure criterion, split its particles (`Splitting`), or take a wider shape function, CPDI or the total-Lagrangian frame",
        100.0 * share
    )]
    Torn {
        /// The body.
        body: String,
        /// Parts now.
        parts: usize,
        /// Parts when it was added.
        before: usize,
        /// Share of the particles in parts without a failed one.
        share: f64,
    },
    /// A pressure that changes its sign from cell to cell.
    #[error(
        "the pressure of body `{body}` alternates from cell to cell by {pressure:.3e} Pa, {:.0} % of all that it varies, at a von Mises stress of {von_mises:.3e} Pa: \
         volumetric locking or a pressure mode; take `Method::mean_dilatation` or quadratic shape functions",
        100.0 * share
    )]
    Locking {
        /// The body.
        body: String,
        /// Root mean square of what alternates, Pa.
        pressure: f64,
        /// Of the variation of the pressure.
        share: f64,
        /// Root mean square of the von Mises stress, Pa.
        von_mises: f64,
    },
    /// Particles that failed without any in the cells around theirs.
    #[error(
        "{alone} of {failed} failed particles of body `{body}` have no failed particle in the cells around theirs, one near {position:?} m: stress noise fails points one by one where \
         a crack would fail a surface; take `Method::impact`, a wider shape function, or a time-dependent criterion (`TulerButcher`, `CohesiveSpall`)"
    )]
    LoneFailure {
        /// The body.
        body: String,
        /// Particles that failed.
        failed: u64,
        /// Those without one in the cells around.
        alone: u64,
        /// Where one is, m.
        position: [f64; 3],
    },
}

/// What most likely made energy.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum GainCause {
    /// A step beyond the limit of stability.
    #[error(
        "the time step of {dt:.3e} s is longer than the {limit:.3e} s that the mesh and its wave speeds bear; lower the Courant factor or take `TimeControl::Gershgorin`"
    )]
    TimeStep {
        /// The step, s.
        dt: f64,
        /// The longest stable one by Gershgorin's bound, s.
        limit: f64,
    },
    /// Motion that no node sees.
    #[error(
        "{joules:.3e} J are in motion of particles against their cell that no node sees (the null space of FLIP and its kin); take `Method::impact` or \
         `Method::contact_at_rest`, or filter it (`Mpm::set_null_space_filter`)"
    )]
    Unseen {
        /// Kinetic energy of such motion in all bodies, J.
        joules: f64,
    },
    /// Matter denser than the data of its equation of state.
    #[error(
        "{particles} particles are compressed beyond the data of their equation of state; take `Method::impact`, a shock viscosity, or a smaller Courant factor"
    )]
    OverCompressed {
        /// How many.
        particles: usize,
    },
    /// A contact.
    #[error(
        "bodies meet there; take the default detector `SurfaceDistance` and `Method::contact_at_rest` or `Method::impact`, or smaller cells"
    )]
    Contact,
    /// Particles that cross cells.
    #[error(
        "stresses of particles that cross cells are the usual cause; take `Method::impact`, a wider shape function or a smaller Courant factor"
    )]
    Crossing,
}
