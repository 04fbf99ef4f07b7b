//! Loads on faces of the surface: tractions, and displacements prescribed weakly by the flux.

use std::sync::Arc;

use impactite_scene::constants::over;
use impactite_scene::{Archive, CheckpointError, SceneError};

use crate::sums::{Load, Outer, Trace};
use crate::vector::{Tensor, apply, cofactor, with_identity};

/// Traction history: Pa (N per area of the reference configuration, in fixed directions) at time t in s.
pub type TractionHistory<const D: usize> = Arc<dyn Fn(f64) -> [f64; D] + Send + Sync>;
/// History of a displacement, m, or velocity, m/s, at time t in s; `None` leaves a component free.
pub type FaceHistory<const D: usize> = Arc<dyn Fn(f64) -> [Option<f64>; D] + Send + Sync>;

/// Pressure history: Pa, compression positive, at time t in s.
pub type PressureHistory = Arc<dyn Fn(f64) -> f64 + Send + Sync>;

#[derive(Clone)]
enum Kind<const D: usize> {
    Traction(TractionHistory<D>),
    Pressure(PressureHistory),
    Displacement(FaceHistory<D>),
    Velocity(FaceHistory<D>),
}

/// Load on some faces.
#[derive(Clone)]
pub(crate) struct FaceLoad<const D: usize> {
    kind: Kind<D>,
    /// Description of the faces, for checkpoints.
    faces: String,
    /// Traction, Pa, or displacement, m, at present and at the start of the step; `given` is true for prescribed components.
    now: [f64; D],
    before: [f64; D],
    given: [bool; D],
    /// Account of the boundary condition that the load enforces ([`impactite_scene::BoundaryEntry::with_account`]).
    pub account: Option<usize>,
}

/// Work and penalty energy of loads on the surface in a step.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Given {
    /// Work on the body, J.
    pub work: f64,
    /// Energy of the penalty, J.
    pub penalty: f64,
}

impl<const D: usize> FaceLoad<D> {
    pub fn traction(of: TractionHistory<D>, faces: String) -> Self {
        FaceLoad::new(Kind::Traction(of), faces)
    }
    pub fn pressure(of: PressureHistory, faces: String) -> Self {
        FaceLoad::new(Kind::Pressure(of), faces)
    }
    pub fn displacement(of: FaceHistory<D>, faces: String) -> Self {
        FaceLoad::new(Kind::Displacement(of), faces)
    }
    pub fn velocity(of: FaceHistory<D>, faces: String) -> Self {
        FaceLoad::new(Kind::Velocity(of), faces)
    }
    fn new(kind: Kind<D>, faces: String) -> Self {
        FaceLoad { kind, faces, now: [0.0; D], before: [0.0; D], given: [false; D], account: None }
    }

    /// Book the load to an account, too.
    pub fn booked_to(self, account: Option<usize>) -> Self {
        FaceLoad { account, ..self }
    }

    /// True for a prescribed displacement or velocity.
    pub fn holds(&self) -> bool {
        !matches!(self.kind, Kind::Traction(_) | Kind::Pressure(_))
    }

    /// Check that the histories are finite.
    pub fn check(&self, time: f64, dt: f64) -> Result<(), SceneError> {
        for t in [time, time + 0.5 * dt, time + dt] {
            let (what, values): (_, [Option<f64>; D]) = match &self.kind {
                Kind::Traction(of) => ("traction on a face", of(t).map(Some)),
                Kind::Pressure(of) => ("pressure on a face", [Some(of(t)); D]),
                Kind::Displacement(of) => ("displacement of a face", of(t)),
                Kind::Velocity(of) => ("velocity of a face", of(t)),
            };
            if let Some(value) = values.into_iter().flatten().find(|x| !x.is_finite()) {
                return Err(SceneError::NotFinite { what: what.into(), value, time: t });
            }
        }
        Ok(())
    }

    /// Update the load to `time`, after a step of `dt` (zero at the start), s.
    pub fn update(&mut self, time: f64, dt: f64) {
        self.before = self.now;
        match &self.kind {
            Kind::Traction(of) => self.now = of(time),
            Kind::Pressure(of) => self.now = [of(time); D],
            Kind::Displacement(of) => self.hold(of(time)),
            Kind::Velocity(of) => {
                let rate = of(time - 0.5 * dt);
                let moved = std::array::from_fn(|d| rate[d].map(|v| self.now[d] + dt * v));
                self.hold(moved);
            }
        }
        if dt == 0.0 {
            self.before = self.now;
        }
    }

    fn hold(&mut self, wanted: [Option<f64>; D]) {
        for d in 0..D {
            // A newly prescribed component has no increment.
            if let Some(u) = wanted[d] {
                if !self.given[d] {
                    self.before[d] = u;
                }
                self.now[d] = u;
            }
            self.given[d] = wanted[d].is_some();
        }
    }

    /// Apply the load to the cell of a face with this P and trial function: force, load of the cell, and with `books` the work of a step
    /// (without after faces opened).
    pub fn act(
        &self,
        outer: &mut Outer<D>,
        trace: &Trace<D>,
        p: &Tensor<D>,
        load: &mut Load<D>,
        books: bool,
    ) -> Given {
        let moved = trace.at(&outer.arm);
        let mut given = Given::default();
        let mut force = [0.0; D];
        if self.holds() {
            let jump = self.jump(&moved);
            for d in (0..D).filter(|&d| self.given[d]) {
                let flux: f64 = (0..D).map(|c| p[d][c] * outer.area[c]).sum();
                force[d] = flux - outer.stiffness * jump[d];
                given.penalty += 0.5 * outer.stiffness * jump[d] * jump[d];
                given.work += 0.5 * (force[d] + outer.force[d]) * (self.now[d] - self.before[d]);
            }
        } else if let Kind::Pressure(_) = self.kind {
            // Nanson: the present area vector is cof(F) times that of the reference configuration.
            let area = apply(&cofactor(&with_identity(&trace.h)), &outer.area);
            for d in 0..D {
                force[d] = -self.now[d] * area[d];
                given.work += 0.5 * (force[d] + outer.force[d]) * (moved[d] - outer.moved[d]);
            }
        } else {
            let size = outer.area.iter().map(|a| a * a).sum::<f64>().sqrt();
            for d in 0..D {
                force[d] = size * self.now[d];
                given.work += 0.5 * (force[d] + outer.force[d]) * (moved[d] - outer.moved[d]);
            }
        }
        if !books {
            given.work = 0.0;
        }
        load.add(&force, &outer.arm);
        (outer.force, outer.moved) = (force, moved);
        given
    }

    /// Return the jump of a face from its prescribed displacement, m; zero in free components.
    pub fn jump(&self, moved: &[f64; D]) -> [f64; D] {
        std::array::from_fn(|d| if self.given[d] { moved[d] - self.now[d] } else { 0.0 })
    }

    /// Return the prescribed components of a vector.
    pub fn part(&self, of: &[f64; D]) -> [f64; D] {
        std::array::from_fn(|d| if self.given[d] { of[d] } else { 0.0 })
    }

    /// Store the load in a checkpoint, or load it: history for comparison, and state.
    pub fn archive(&mut self, file: &mut Archive, what: &str, time: f64) -> Result<(), CheckpointError> {
        let times = [0.0, time];
        let history = match &self.kind {
            Kind::Traction(of) => format!("traction {}", over(times, |t| of(t))),
            Kind::Pressure(of) => format!("pressure {}", over(times, |t| of(t))),
            Kind::Displacement(of) => format!("displacement {}", over(times, |t| of(t))),
            Kind::Velocity(of) => format!("velocity {}", over(times, |t| of(t))),
        };
        file.same(what, &format!("{history} on {}", self.faces))?;
        file.reals(self.now.iter_mut().chain(&mut self.before))?;
        self.given.iter_mut().try_for_each(|given| file.flag(given))
    }
}
