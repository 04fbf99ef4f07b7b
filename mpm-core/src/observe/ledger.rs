//! Energy and momentum, and how well they are conserved.

use std::path::Path;

use super::{Moment, ObserveError, Observer, Pace};
use crate::output::History;
use crate::parallel::Float;
use crate::step::Totals;
use crate::step::nodes::NodeLedger;

/// Energy and momentum at one moment. Per radian in axisymmetric scenes, per metre of depth in plane strain.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LedgerEntry {
    /// Time, s.
    pub time: f64,
    /// Steps made.
    pub step: u64,
    /// Kinetic energy of the particles, J.
    pub kinetic: f64,
    /// Internal energy, plastic work and heat included, J.
    pub internal: f64,
    /// Work that boundaries and body forces did on the material since the first entry, J.
    pub work: f64,
    /// Work of friction between bodies since the first entry, J.
    pub friction: f64,
    /// Kinetic energy of the motion within particles that splitting brought to light since the first entry, J.
    pub split: f64,
    /// kinetic + internal - work + friction - split, J: constant if energy is conserved.
    pub total: f64,
    /// Change of `total` since the first entry, relative to the largest kinetic energy, or sum of kinetic and
    /// internal energy, so far. Negative: the method lost energy.
    pub energy_error: f64,
    /// Momentum, kg m/s.
    pub momentum: [f64; 3],
    /// |p - p0 - impulse of boundaries - impulse of body forces - dropped| over the largest sum of m |v| so
    /// far. In axisymmetric scenes along the axis only: hoop stresses push outwards.
    pub momentum_error: f64,
}

/// Keeps the energy and momentum of a run and, if asked, writes them as CSV.
///
/// ```
/// use mpm_core::observe::{Ledger, Pace};
/// let mut ledger = Ledger::new(Pace::interval(1.0e-6)?);
/// // mpm.run_observed(80.0e-6, &mut [&mut ledger])?;
/// assert!(ledger.worst_energy_error() < 0.01);
/// # Ok::<(), mpm_core::observe::ObserveError>(())
/// ```
pub struct Ledger {
    pace: Pace,
    file: Option<History>,
    start: Option<(Totals, NodeLedger)>,
    energy_scale: f64,
    momentum_scale: f64,
    /// The most momentum missing so far, kg m/s; NaN from the first look that found that.
    worst_missing: f64,
    entries: Vec<LedgerEntry>,
}

const COLUMNS: [(&str, &str); 12] = [
    ("time", "s"),
    ("step", "-"),
    ("kinetic energy", "J"),
    ("internal energy", "J"),
    ("work on the material", "J"),
    ("friction", "J"),
    ("total", "J"),
    ("energy error", "-"),
    ("momentum x", "kg m/s"),
    ("momentum y", "kg m/s"),
    ("momentum z", "kg m/s"),
    ("momentum error", "-"),
];

impl Ledger {
    /// Look at this pace.
    #[must_use]
    pub fn new(pace: Pace) -> Self {
        Ledger {
            pace,
            file: None,
            start: None,
            energy_scale: 0.0,
            momentum_scale: 0.0,
            worst_missing: 0.0,
            entries: Vec::new(),
        }
    }

    /// Also write a CSV file at `path`.
    ///
    /// # Errors
    /// A file that cannot be created.
    pub fn with_csv(mut self, path: impl AsRef<Path>) -> Result<Self, ObserveError> {
        self.file = Some(History::create(path, COLUMNS)?);
        Ok(self)
    }

    /// What was seen, in order of time.
    #[must_use]
    pub fn entries(&self) -> &[LedgerEntry] {
        &self.entries
    }

    /// The change of the total energy that is largest by amount, with its sign, over the scale of the whole run.
    #[must_use]
    pub fn worst_energy_error(&self) -> f64 {
        let first = self.entries.first().map_or(0.0, |e| e.total);
        let errors = self.entries.iter().map(|e| relative(e.total - first, self.energy_scale));
        errors.fold(0.0, |worst: f64, e| if e.is_nan() || e.abs() > worst.abs() { e } else { worst })
    }

    /// The largest momentum error, over the scale of the whole run.
    #[must_use]
    pub fn worst_momentum_error(&self) -> f64 {
        relative(self.worst_missing, self.momentum_scale)
    }

    fn entry<T: Float, const D: usize>(&mut self, now: &Moment<'_, T, D>) -> LedgerEntry {
        let (totals, given) = (*now.totals(), now.ledger());
        let (first, before) = *self.start.get_or_insert((totals, given));
        let work = given.work - before.work;
        let friction = given.friction - before.friction;
        let split = given.split - before.split;
        let total = totals.kinetic + totals.internal - work + friction - split;
        // An explosive's energies are opposite: their sum says nothing about their size.
        self.energy_scale =
            self.energy_scale.max((totals.kinetic + totals.internal).abs()).max(totals.kinetic);
        self.momentum_scale = self.momentum_scale.max(totals.momentum_scale);
        let along = if now.axisymmetric() { 1..2 } else { 0..3 };
        let square: f64 = along.map(|d| missing(d, &totals, &first, &given, &before).powi(2)).sum();
        let lost = square.sqrt();
        if lost.is_nan() || lost > self.worst_missing {
            self.worst_missing = lost;
        }
        LedgerEntry {
            time: now.time(),
            step: now.step(),
            kinetic: totals.kinetic,
            internal: totals.internal,
            work,
            friction,
            split,
            total,
            energy_error: relative(total - first.kinetic - first.internal, self.energy_scale),
            momentum: totals.momentum,
            momentum_error: relative(lost, self.momentum_scale),
        }
    }
}

/// Momentum along an axis that nothing accounts for.
fn missing(d: usize, now: &Totals, first: &Totals, given: &NodeLedger, before: &NodeLedger) -> f64 {
    let given = [
        given.impulse[d] - before.impulse[d],
        given.load[d] - before.load[d],
        given.dropped[d] - before.dropped[d],
    ];
    now.momentum[d] - first.momentum[d] - given[0] - given[1] - given[2]
}

/// 0 / 0 is 0: nothing is missing of nothing.
fn relative(error: f64, scale: f64) -> f64 {
    if error == 0.0 { 0.0 } else { error / scale }
}

impl<T: Float, const D: usize> Observer<T, D> for Ledger {
    fn pace(&mut self) -> &mut Pace {
        &mut self.pace
    }
    fn observe(&mut self, now: &Moment<'_, T, D>) -> Result<(), ObserveError> {
        let e = self.entry(now);
        self.entries.push(e);
        if let Some(file) = &mut self.file {
            let [x, y, z] = e.momentum;
            let step = e.step as f64;
            file.push(&[
                e.time,
                step,
                e.kinetic,
                e.internal,
                e.work,
                e.friction,
                e.total,
                e.energy_error,
                x,
                y,
                z,
                e.momentum_error,
            ])?;
        }
        Ok(())
    }
}
