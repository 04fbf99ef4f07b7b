//! Energy and momentum over time, and their conservation errors.

use std::path::Path;

use super::{ObserveError, Observer, Pace, RunView};
use crate::archive::{Archive, CheckpointError};
use crate::balance::{Account, Books, share};
use impactite_output::{History, OutputError};

/// Energy and momentum at one time. Per radian in axisymmetric scenes, per metre of depth in plane strain.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LedgerEntry {
    /// Time, s.
    pub time: f64,
    /// Number of steps.
    pub step: u64,
    /// Kinetic energy of the particles, J: the balanced one ([`Account::kinetic`]).
    pub kinetic: f64,
    /// Internal energy, plastic work and heat included, J.
    pub internal: f64,
    /// Work of boundaries and body forces on the material since the first entry, J.
    pub work: f64,
    /// Work of friction between bodies since the first entry, J.
    pub friction: f64,
    /// Kinetic energy lost in plastic impacts of points since the first entry, J.
    pub impacts: f64,
    /// Energy dissipated by damping since the first entry, J.
    pub damping: f64,
    /// Energy dissipated by numerical viscosity since the first entry, J.
    pub viscosity: f64,
    /// Energy added by points that were split, merged, created or removed since the first entry, J.
    pub conversion: f64,
    /// Total energy, J: kinetic + internal - work + friction + impacts + damping + viscosity - conversion, constant if energy is conserved.
    pub total: f64,
    /// Change of `total` since the first entry over the largest energy so far ([`Account::energy_scale`]). Negative if the method lost
    /// energy.
    pub energy_error: f64,
    /// Momentum, kg m/s.
    pub momentum: [f64; 3],
    /// Momentum error |p - p0 - impulse of boundaries - impulse of body forces - dropped| over the largest sum of m |v| so far. In
    /// axisymmetric scenes along the axis only, since hoop stresses push outwards.
    pub momentum_error: f64,
}

impl LedgerEntry {
    fn archive(&mut self, file: &mut Archive) -> Result<(), CheckpointError> {
        let LedgerEntry { time, step, kinetic, internal, work, friction, impacts, conversion, total, .. } =
            self;
        file.word(step)?;
        file.reals([time, kinetic, internal, work, friction, impacts, conversion, total])?;
        file.reals([&mut self.damping, &mut self.viscosity])?;
        file.reals([&mut self.energy_error, &mut self.momentum_error])?;
        file.reals(&mut self.momentum)
    }
}

/// Observer that stores the energy and momentum of a run and optionally writes them as CSV.
///
/// ```
/// use impactite_scene::observe::{Ledger, Pace};
/// let mut ledger = Ledger::new(Pace::interval(1.0e-6)?);
/// // Run::new(&mut scene).observe(&mut ledger).until(80.0e-6)?;
/// assert!(ledger.worst_energy_error() < 0.01);
/// # Ok::<(), impactite_scene::observe::ObserveError>(())
/// ```
pub struct Ledger {
    pace: Pace,
    file: Option<History>,
    books: Books,
    /// Largest momentum error so far, kg m/s; NaN from the first NaN on.
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
    /// Create a ledger with this pace.
    #[must_use]
    pub fn new(pace: Pace) -> Self {
        Ledger { pace, file: None, books: Books::default(), worst_missing: 0.0, entries: Vec::new() }
    }

    /// Also write a CSV file at `path`.
    ///
    /// # Errors
    /// A file that cannot be created.
    pub fn with_csv(mut self, path: impl AsRef<Path>) -> Result<Self, ObserveError> {
        self.file = Some(History::create(path, COLUMNS)?);
        Ok(self)
    }

    /// Entries in order of time.
    #[must_use]
    pub fn entries(&self) -> &[LedgerEntry] {
        &self.entries
    }

    /// Return the total energy error of largest magnitude, with its sign, over the scale of the whole run.
    #[must_use]
    pub fn worst_energy_error(&self) -> f64 {
        let first = self.entries.first().map_or(0.0, |e| e.total);
        let errors = self.entries.iter().map(|e| self.books.energy_error(e.total - first));
        errors.fold(0.0, |worst: f64, e| if e.is_nan() || e.abs() > worst.abs() { e } else { worst })
    }

    /// Return the largest momentum error, over the scale of the whole run.
    #[must_use]
    pub fn worst_momentum_error(&self) -> f64 {
        share(self.worst_missing, self.books.scales()[1])
    }

    fn entry(&mut self, now: &RunView<'_>) -> LedgerEntry {
        let totals = now.totals();
        let account = self.books.enter(totals, &now.exchange(), now.axisymmetric());
        if !account.moves() || account.rest == 0.0 {
            self.books.enter_rest(now.account().rest);
        }
        let lost = account.missing();
        if lost.is_nan() || lost > self.worst_missing {
            self.worst_missing = lost;
        }
        let Account { kinetic, internal, work, friction, impacts, damping, viscosity, conversion, .. } =
            account;
        LedgerEntry {
            time: now.time(),
            step: now.step(),
            kinetic,
            internal,
            work,
            friction,
            impacts,
            damping,
            viscosity,
            conversion,
            total: account.total(),
            energy_error: account.energy_error(),
            momentum: totals.momentum_now(),
            momentum_error: share(lost, account.momentum_scale),
        }
    }
}

impl Observer for Ledger {
    fn pace(&mut self) -> &mut Pace {
        &mut self.pace
    }
    fn observe(&mut self, now: &RunView<'_>) -> Result<(), ObserveError> {
        let e = self.entry(now);
        self.entries.push(e);
        Ok(self.write(&e)?)
    }
    fn archive(&mut self, archive: &mut Archive) -> Result<(), CheckpointError> {
        self.books.archive(archive)?;
        archive.real(&mut self.worst_missing)?;
        archive.list(&mut self.entries, &LedgerEntry::default(), |archive, e| e.archive(archive))?;
        if archive.reads() {
            let entries = self.entries.clone();
            entries.iter().try_for_each(|e| self.write(e))?;
        }
        Ok(())
    }
}

impl Ledger {
    fn write(&mut self, e: &LedgerEntry) -> Result<(), OutputError> {
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
