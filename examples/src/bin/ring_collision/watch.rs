//! Observer of a run: surfaces, force, energy.

use mpm_core::observe::{ObserveError, Observer, Pace, RunView};
use mpm_core::output::Snapshot;
use mpm_core::{Archive, CheckpointError};

use crate::scene::{GAP, PICTURES, THICKNESS, TOO_MUCH};
use crate::surface::{Surface, closest};

/// State of a run at one time.
#[derive(Clone, Copy, Debug, Default)]
pub struct Row {
    /// Time, s.
    pub time: f64,
    /// Closest approach of the surfaces, m.
    pub gap: f64,
    /// Contact force on the right ring, mean of the last interval, N.
    pub force: f64,
    /// Velocity of the centre of mass of either ring, m/s.
    pub velocity: [f64; 2],
    /// Kinetic energy, J.
    pub kinetic: f64,
    /// Internal energy, J.
    pub internal: f64,
}

/// Level of detail of the observer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Look {
    /// Surfaces, contact, pictures.
    Closely,
    /// Energy and momentum.
    Ledger,
}

impl Look {
    /// Return the name in file names.
    pub fn name(self) -> &'static str {
        match self {
            Look::Closely => "closely",
            Look::Ledger => "ledger",
        }
    }
}

/// Return the velocities of the centres of mass along x, m/s.
pub fn velocities(now: &RunView<'_>) -> [f64; 2] {
    let of = |n: usize| now.bodies().get(n).map(|b| b.totals()).map_or(f64::NAN, |t| t.momentum[0] / t.mass);
    [of(0), of(1)]
}

/// Observer of contact in every step and of the surfaces: frequent shortly before contact, otherwise occasional.
pub struct Watch {
    pace: Pace,
    look: Look,
    surfaces: Vec<Surface>,
    /// Recorded states.
    pub rows: Vec<Row>,
    /// Snapshots at the times of the pictures.
    pub snapshots: Vec<Snapshot>,
    /// Closest approach at the start of the first step with contact, m; NaN without contact.
    pub onset: f64,
    /// End of the first and of the last step with contact, s.
    pub contact: [f64; 2],
    /// Last closest approach, m.
    gap: f64,
    /// Initial kinetic and internal energy, J/m.
    energy: Option<f64>,
}

impl Watch {
    /// Create the observer of the surfaces of the left and the right ring.
    pub fn new(surfaces: Vec<Surface>, look: Look) -> Result<Watch, ObserveError> {
        Ok(Watch {
            pace: if look == Look::Closely { Pace::every_step() } else { Pace::steps(20)? },
            look,
            surfaces,
            rows: Vec::new(),
            snapshots: Vec::new(),
            onset: f64::NAN,
            contact: [f64::NAN; 2],
            gap: f64::NAN,
            energy: None,
        })
    }

    fn stop_if_wrong(&mut self, energy: f64) -> Result<(), ObserveError> {
        let start = *self.energy.get_or_insert(energy);
        if energy <= TOO_MUCH * start {
            Ok(())
        } else {
            Err(ObserveError::Other(format!("{TOO_MUCH} times the energy of the start")))
        }
    }

    /// Record a step with contact; detection used the positions at the start of the step.
    fn note_contact(&mut self, now: &RunView<'_>) {
        if self.onset.is_nan() {
            self.onset = self.gap;
            self.contact[0] = now.time();
        }
        self.contact[1] = now.time();
    }
}

impl Observer for Watch {
    fn pace(&mut self) -> &mut Pace {
        &mut self.pace
    }
    fn observe(&mut self, now: &RunView<'_>) -> Result<(), ObserveError> {
        if now.contacts().iter().any(|p| p.places > 0) {
            self.note_contact(now);
        }
        let about_to_touch = self.onset.is_nan() && self.gap < 0.3 * GAP;
        if self.look == Look::Closely && !about_to_touch && !now.step().is_multiple_of(8) {
            return Ok(());
        }
        let totals = now.totals();
        self.stop_if_wrong(totals.kinetic + totals.internal)?;
        if self.look == Look::Ledger {
            return Ok(());
        }
        let polygons: Vec<_> = self.surfaces.iter().zip(now.bodies()).map(|(s, b)| s.now(b)).collect();
        let [left, right] = &polygons[..] else { return Ok(()) };
        self.gap = closest(left, right);
        if PICTURES.get(self.snapshots.len()).is_some_and(|t| now.time() >= *t) {
            self.snapshots.push(now.snapshot()?);
        }
        let force = now.contacts().iter().map(|p| p.force[0]).sum::<f64>();
        self.rows.push(Row {
            time: now.time(),
            gap: self.gap,
            force: THICKNESS * force,
            velocity: velocities(now),
            kinetic: THICKNESS * totals.kinetic,
            internal: THICKNESS * totals.internal,
        });
        Ok(())
    }
    fn archive(&mut self, file: &mut Archive) -> Result<(), CheckpointError> {
        file.list(&mut self.rows, &Row::default(), |file, row| {
            let Row { time, gap, force, velocity, kinetic, internal } = row;
            file.reals([time, gap, force, kinetic, internal].into_iter().chain(velocity))
        })?;
        file.snapshots(&mut self.snapshots)?;
        file.reals([&mut self.onset, &mut self.gap].into_iter().chain(&mut self.contact))?;
        file.option(&mut self.energy, Archive::real)
    }
}
