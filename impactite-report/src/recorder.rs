//! Recorder: balances, time steps and warnings of a run over time.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::SystemTime;

use impactite_scene::balance::{Books, share};
use impactite_scene::observe::{ObserveError, Observer, Pace, RunView};
use impactite_scene::{Archive, CheckpointError, Finding, StepLimit, Warning};

use crate::number::percent;

/// Maximum number of rows kept.
pub const MOST_ROWS: usize = 4096;
/// Limits of the relative energy gain and loss above which a warning is issued.
const BAD_GAIN: f64 = 0.10;
const BAD_LOSS: f64 = 0.03;

/// State of a run at one time. Per radian in axisymmetric scenes, per metre of depth in plane strain.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Row {
    /// Time, s.
    pub time: f64,
    /// Number of steps.
    pub step: u64,
    /// Size of the last step, s; NaN before the first step.
    pub dt: f64,
    /// Number of points with mass.
    pub points: usize,
    /// Mass, kg.
    pub mass: f64,
    /// Kinetic energy, J.
    pub kinetic: f64,
    /// Internal energy, plastic work and heat included, J.
    pub internal: f64,
    /// Work of boundaries, loads and body forces since the first row, J.
    pub work: f64,
    /// Work of friction since the first row, J.
    pub friction: f64,
    /// Kinetic energy dissipated by plastic impacts of points since the first row, J.
    pub impacts: f64,
    /// Energy dissipated by local damping, kinetic damping and the null-space filter since the first row, J.
    pub damping: f64,
    /// Energy dissipated by numerical viscosity since the first row, J, not included in the internal energy of a law.
    pub viscosity: f64,
    /// Heat of the artificial viscosity of laws since the first row, J: part of the internal energy.
    pub viscous_heat: f64,
    /// Staggered kinetic energy minus the energy in the balance, J, for velocities half a step behind positions.
    pub staggered: f64,
    /// Energy added by splitting, merging, creation and removal of points since the first row, J.
    pub conversion: f64,
    /// Unexplained energy, J ([`impactite_scene::Account::unexplained`]); negative: lost.
    pub unexplained: f64,
    /// Energy error: unexplained energy over the largest kinetic energy, or sum of kinetic and internal energy, so far.
    pub energy_error: f64,
    /// Momentum, kg m/s.
    pub momentum: [f64; 3],
    /// Momentum error: magnitude of the unexplained momentum over the largest sum of m |v| so far.
    pub momentum_error: f64,
    /// Wall-clock time spent in steps so far, s.
    pub wall_seconds: f64,
    /// Number of point updates so far.
    pub updates: f64,
}

impl Row {
    /// kinetic - staggered + internal - work + friction + impacts + damping + viscosity - conversion, J: constant if energy is conserved.
    #[must_use]
    pub fn total(&self) -> f64 {
        let taken = self.friction + self.impacts + self.damping + self.viscosity;
        self.kinetic - self.staggered + self.internal - self.work + taken - self.conversion
    }

    fn archive(&mut self, file: &mut Archive) -> Result<(), CheckpointError> {
        let Row { time, step, dt, points, mass, kinetic, internal, work, friction, impacts, .. } = self;
        file.word(step)?;
        file.count(points)?;
        file.reals([time, dt, mass, kinetic, internal, work, friction, impacts])?;
        file.reals([&mut self.damping, &mut self.viscosity, &mut self.viscous_heat, &mut self.staggered])?;
        file.reals([&mut self.conversion, &mut self.unexplained, &mut self.energy_error])?;
        file.reals(&mut self.momentum)?;
        file.reals([&mut self.momentum_error, &mut self.wall_seconds, &mut self.updates])
    }
}

/// Warning of a run, in words.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
#[non_exhaustive]
pub struct Warned {
    /// Number of steps.
    pub step: u64,
    /// Time, s.
    #[serde(with = "crate::number::real")]
    pub time: f64,
    /// Title, two or three words.
    pub title: String,
    /// Finding and its probable cause.
    pub found: String,
    /// Remedy.
    pub remedy: String,
}

/// Title of a finding, and name of the body.
fn title(finding: &Finding) -> (&'static str, &str) {
    match finding {
        Finding::EnergyGain { body, .. } => ("energy gained", body),
        Finding::EnergyLoss { .. } => ("energy lost", ""),
        Finding::FewSteps { .. } => ("energy balance of few steps", ""),
        Finding::NotFinite { body } => ("not finite", body),
        Finding::Momentum { .. } => ("momentum from nowhere", ""),
        Finding::Torn { body, .. } => ("body torn", body),
        Finding::Locking { body, .. } => ("locking suspected", body),
        Finding::Hourglass { body, .. } => ("hourglass energy", body),
        Finding::WidePoints { body, .. } => ("points too far apart", body),
        Finding::LoneFailure { body, .. } => ("points failed alone", body),
        Finding::Localised { body, .. } => ("plastic strain localised", body),
        _ => ("warning", ""),
    }
}

impl From<&Warning> for Warned {
    fn from(warning: &Warning) -> Self {
        let (found, remedy) = (warning.finding.found(), warning.finding.remedy().into());
        let (about, body) = title(&warning.finding);
        let title = if body.is_empty() { about.to_string() } else { format!("{about}: {body}") };
        Warned { step: warning.step, time: warning.time, title, found, remedy }
    }
}

impl Warned {
    fn archive(&mut self, file: &mut Archive) -> Result<(), CheckpointError> {
        let Warned { step, time, title, found, remedy } = self;
        file.word(step)?;
        file.real(time)?;
        [title, found, remedy].into_iter().try_for_each(|text| file.text(text))
    }
}

/// Observer that records balances, time steps, rates and warnings of a run over time, for a
/// [`Record`](crate::Record).
///
/// It keeps at most [`MOST_ROWS`] rows: beyond that, it drops every second row and doubles the sampling stride.
/// The first and the last look are always kept, and errors are the worst of all looks, kept or not. The data are part of
/// checkpoints: a resumed run has the same rows, errors and warnings as an uninterrupted one, bit for bit, except for
/// wall-clock times.
///
/// The energy error is that of [`impactite_scene::observe::Ledger`].
///
/// ```
/// use impactite_report::Recorder;
/// use impactite_scene::observe::Pace;
/// let mut recorder = Recorder::new(Pace::interval(1.0e-7)?);
/// // Run::new(&mut scene).observe(&mut recorder).until(80.0e-6)?;
/// assert_eq!(recorder.rows().len(), 0);
/// # Ok::<(), impactite_scene::observe::ObserveError>(())
/// ```
pub struct Recorder {
    pace: Pace,
    books: Books,
    /// Number of looks so far; `stride`: one of how many is kept.
    looks: u64,
    stride: u64,
    rows: Vec<Row>,
    last: Option<Row>,
    /// Unexplained energy of largest magnitude, J; `worst_missing`: largest missing momentum, kg m/s. NaN once NaN occurred.
    worst_unexplained: f64,
    worst_missing: f64,
    /// Step and time, s, of `worst_unexplained`.
    worst_at: (u64, f64),
    /// Change of mass of largest magnitude since the first look, kg.
    worst_mass: f64,
    warnings: Vec<Warned>,
    /// Causes of the time step limit, in words, and number of looks of each; in order of first occurrence.
    limits: Vec<(String, u64)>,
    /// End time of the run, s; `reached`: true once the run is there.
    end: f64,
    reached: bool,
    clock: WallClock,
    /// Bits of the energy error of the last row.
    latest: Arc<AtomicU64>,
}

/// Wall-clock start and end of a run.
#[derive(Clone, Copy, Debug, Default)]
struct WallClock {
    /// Wall-clock time of earlier parts of a resumed run, s.
    before: f64,
    started: Option<SystemTime>,
    ended: Option<SystemTime>,
    looked: Option<std::time::Instant>,
    seconds: f64,
}

impl Recorder {
    /// Create a recorder that looks at this pace.
    #[must_use]
    pub fn new(pace: Pace) -> Self {
        Recorder {
            pace,
            books: Books::default(),
            looks: 0,
            stride: 1,
            rows: Vec::new(),
            last: None,
            worst_unexplained: 0.0,
            worst_missing: 0.0,
            worst_at: (0, 0.0),
            worst_mass: 0.0,
            warnings: Vec::new(),
            limits: Vec::new(),
            end: f64::NAN,
            reached: false,
            clock: WallClock::default(),
            latest: Arc::default(),
        }
    }

    /// Return a reader of the energy error of the last look, for an observer that looks after this one at the same pace. It is relative
    /// to the largest energy of all looks, of which [`impactite_scene::Solver::account`] sees fewer.
    pub fn latest_energy_error(&self) -> impl Fn() -> f64 + Send + 'static {
        let latest = self.latest.clone();
        move || f64::from_bits(latest.load(Ordering::Relaxed))
    }

    /// Recorded rows, in order of time.
    #[must_use]
    pub fn rows(&self) -> Vec<Row> {
        let kept = self.rows.last().map(|row| row.step);
        self.rows.iter().chain(self.last.iter().filter(|last| Some(last.step) != kept)).copied().collect()
    }

    /// Warnings of the run, in order of time.
    #[must_use]
    pub fn warnings(&self) -> &[Warned] {
        &self.warnings
    }

    /// Causes of the time step limit of the next step, in words, and number of looks of each.
    #[must_use]
    pub fn limits(&self) -> &[(String, u64)] {
        &self.limits
    }

    fn limited(&mut self, now: &RunView<'_>) {
        // Before the first step, wave speeds are not known.
        let Some(limit) = now.solver().limited_by().filter(|_| now.solver().clock().last.is_some()) else {
            return;
        };
        let cause = match limit {
            StepLimit::Body(n) => match now.bodies().get(n) {
                Some(body) => format!("waves and velocities in {}", body.name()),
                None => return,
            },
            StepLimit::Nodes => "nodes of the grid".into(),
            StepLimit::Growth => "growth from one step to the next".into(),
            StepLimit::Fixed => "the step that was asked for".into(),
            _ => return,
        };
        match self.limits.iter_mut().find(|known| known.0 == cause) {
            Some(known) => known.1 += 1,
            None => self.limits.push((cause, 1)),
        }
    }

    /// Worst energy error: unexplained energy of largest magnitude of all looks, with its sign, over the largest energy of the whole run; 0
    /// if nothing moves.
    #[must_use]
    pub fn worst_energy_error(&self) -> f64 {
        self.books.energy_error(self.worst_unexplained)
    }

    /// Worst energy error, `None` if nothing moves ([`impactite_scene::Account::moves`]): a ratio of rounding errors is meaningless.
    #[must_use]
    pub fn energy_error(&self) -> Option<f64> {
        let rests = self.books.rest() > 0.0 && !self.books.moves();
        (!rests || self.worst_unexplained.is_nan()).then(|| self.worst_energy_error())
    }

    /// Worst momentum error: largest unexplained momentum of all looks over the largest sum of m |v| of the whole run.
    #[must_use]
    pub fn worst_momentum_error(&self) -> f64 {
        share(self.worst_missing, self.books.scales()[1])
    }

    /// Worst mass error: change of mass since the first look, of largest magnitude, with its sign, over the mass at that look.
    #[must_use]
    pub fn worst_mass_error(&self) -> f64 {
        share(self.worst_mass, self.books.mass())
    }

    /// Scales of the errors: largest energy of the run, J, and largest sum of m |v|, kg m/s.
    #[must_use]
    pub fn scales(&self) -> [f64; 2] {
        self.books.scales()
    }

    /// Current time and end time of the run, s; `None` before the first look.
    #[must_use]
    pub fn time_and_end(&self) -> Option<[f64; 2]> {
        self.last.map(|last| [last.time, self.end])
    }

    /// True if the run has reached its end.
    #[must_use]
    pub fn reached(&self) -> bool {
        self.reached
    }

    /// Time of the first look in this process, and time of the end of the run or else of the last look.
    #[must_use]
    pub fn started_and_ended(&self) -> Option<[SystemTime; 2]> {
        let started = self.clock.started?;
        Some([started, self.clock.ended.unwrap_or(started)])
    }

    /// Wall-clock time from the first look to the last, s, with observers and files, summed over the parts of a resumed run.
    #[must_use]
    pub fn seconds(&self) -> f64 {
        self.clock.before + self.clock.seconds
    }

    /// Warnings at the end of a run, in addition to those of the run itself: removed points, and a large energy error
    /// between two checks of the watch.
    #[must_use]
    pub fn late_warnings(&self) -> Vec<Warned> {
        self.removed().into_iter().chain(self.unseen_error()).collect()
    }

    /// Warning of points removed since the first look.
    fn removed(&self) -> Option<Warned> {
        removed(self.rows.first()?, self.last.as_ref()?)
    }

    /// Warning of a large energy error, if no warning of the run is about energy.
    fn unseen_error(&self) -> Option<Warned> {
        let error = self.energy_error()?;
        let large = !(-BAD_LOSS..=BAD_GAIN).contains(&error);
        let (step, time) = self.worst_at;
        (large && !self.warnings.iter().any(|w| w.title.starts_with("energy"))).then(|| Warned {
            step,
            time,
            title: "energy error".into(),
            found: format!("the largest energy error was {}, which no check of the watch found", percent(error)),
            remedy: "look at the energy error over time: one that stays calls for a smaller Courant factor or smaller cells, one that comes and \
                     goes is of kinetic and internal energy half a step apart"
                .into(),
        })
    }

    /// Update step and time of the worst energy error, if it occurs in this row.
    fn note_worst(&mut self, row: &Row) {
        if self.worst_unexplained == row.unexplained {
            self.worst_at = (row.step, row.time);
        }
    }

    fn keep(&mut self, row: Row) {
        if self.looks.is_multiple_of(self.stride) {
            self.rows.push(row);
            if self.rows.len() > MOST_ROWS {
                let mut n = 0;
                self.rows.retain(|_| {
                    n += 1;
                    n % 2 == 1
                });
                self.stride *= 2;
            }
        }
        self.looks += 1;
        self.last = Some(row);
        self.latest.store(row.energy_error.to_bits(), Ordering::Relaxed);
    }
}

impl WallClock {
    fn look(&mut self) {
        let now = std::time::Instant::now();
        let first = *self.looked.get_or_insert(now);
        self.seconds = (now - first).as_secs_f64();
        let time = SystemTime::now();
        self.started.get_or_insert(time);
        self.ended = Some(time);
    }
}

/// Warning of removed points.
fn removed(first: &Row, last: &Row) -> Option<Warned> {
    let gone = first.points.checked_sub(last.points).filter(|gone| *gone > 0)?;
    let mass = percent(share(last.mass - first.mass, first.mass));
    Some(Warned {
        step: last.step,
        time: last.time,
        title: "points removed".into(),
        found: format!(
            "{gone} of {} points that carried mass are gone, and {mass} of the mass with them: eroded, merged, or removed",
            first.points
        ),
        remedy:
            "if nothing of the scene is to be eroded or merged, look for points that failed or left the grid"
                .into(),
    })
}

/// Update `worst` by a value of larger magnitude, or by NaN.
fn worse(worst: &mut f64, now: f64) {
    if now.is_nan() || now.abs() > worst.abs() {
        *worst = now;
    }
}

impl Observer for Recorder {
    fn pace(&mut self) -> &mut Pace {
        &mut self.pace
    }

    fn observe(&mut self, now: &RunView<'_>) -> Result<(), ObserveError> {
        let totals = now.totals();
        let account = self.books.enter(totals, &now.exchange(), now.axisymmetric());
        if self.books.rest() == 0.0 || !self.books.moves() {
            self.books.enter_rest(now.account().rest);
        }
        worse(&mut self.worst_unexplained, account.unexplained);
        worse(&mut self.worst_missing, account.missing());
        worse(&mut self.worst_mass, totals.mass - self.books.mass());
        let clock = now.solver().clock();
        let row = Row {
            time: now.time(),
            step: now.step(),
            dt: clock.last.unwrap_or(f64::NAN),
            points: totals.particles,
            mass: totals.mass,
            kinetic: account.kinetic + account.staggered,
            internal: account.internal,
            work: account.work,
            friction: account.friction,
            impacts: account.impacts,
            damping: account.damping,
            viscosity: account.viscosity,
            viscous_heat: account.viscous_heat,
            staggered: account.staggered,
            conversion: account.conversion,
            unexplained: account.unexplained,
            energy_error: self.books.energy_error(account.unexplained),
            momentum: totals.momentum_now(),
            momentum_error: share(account.missing(), account.momentum_scale),
            wall_seconds: now.wall_seconds(),
            // A whole number, restored after division and multiplication by a time.
            updates: (now.rate() * now.wall_seconds()).round(),
        };
        self.note_worst(&row);
        self.keep(row);
        self.limited(now);
        self.end = now.end();
        self.reached = clock.reached(now.end());
        self.clock.look();
        Ok(())
    }

    fn archive(&mut self, file: &mut Archive) -> Result<(), CheckpointError> {
        self.books.archive(file)?;
        file.word(&mut self.looks)?;
        file.word(&mut self.stride)?;
        if self.stride == 0 {
            return Err(file.damaged("of 0 looks one is kept"));
        }
        file.list(&mut self.rows, &Row::default(), |file, row| row.archive(file))?;
        file.option(&mut self.last, |file, row| row.archive(file))?;
        file.reals([
            &mut self.worst_unexplained,
            &mut self.worst_missing,
            &mut self.worst_mass,
            &mut self.end,
            &mut self.worst_at.1,
        ])?;
        file.word(&mut self.worst_at.0)?;
        file.list(&mut self.warnings, &Warned::default(), |file, warned| warned.archive(file))?;
        file.list(&mut self.limits, &Default::default(), |file, (cause, looks)| {
            file.text(cause)?;
            file.word(looks)
        })?;
        let mut seconds = self.seconds();
        file.real(&mut seconds)?;
        if file.reads() {
            self.clock = WallClock { before: seconds, ..WallClock::default() };
            self.reached = false;
            let error = self.last.map_or(0.0, |row| row.energy_error);
            self.latest.store(error.to_bits(), Ordering::Relaxed);
        }
        Ok(())
    }

    fn warned(&mut self, warning: &Warning) {
        let warned = Warned::from(warning);
        // A resumed run repeats findings of earlier warnings.
        if self.warnings.iter().all(|known| known.title != warned.title) {
            self.warnings.push(warned);
        }
    }

    fn finish(&mut self) -> Result<(), ObserveError> {
        self.clock.look();
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use impactite_scene::watch::Loss;
    use impactite_scene::{Exchange, Totals};

    #[test]
    fn points_that_are_gone_are_warned_of() {
        let row = |points, mass| Row { points, mass, step: 7, ..Row::default() };
        assert_eq!(removed(&row(160, 2.0), &row(160, 2.0)), None);
        // Points were split or added.
        assert_eq!(removed(&row(160, 2.0), &row(170, 2.0)), None);
        let warned = removed(&row(160, 2.0), &row(150, 1.9)).expect("a warning");
        assert!(
            warned.found.starts_with("10 of 160 points that carried mass are gone, and -5.00 % of the mass")
        );
        assert_eq!(warned.step, 7);
    }

    #[test]
    fn a_warning_has_what_was_found_and_what_to_do() {
        let loss = Loss { by: "contacts that closed", remedy: "take smaller cells; or a larger step" };
        let booked = impactite_scene::watch::Booked::default();
        let finding = Finding::EnergyLoss { share: 0.12, joules: 3.0, contact: 0.0, booked, loss };
        let warned = Warned::from(&Warning { step: 1, time: 0.5, finding });
        assert_eq!(
            warned.found,
            "3.0000e0 J of energy are lost, 12.0 % of the largest energy of the run, in contacts that closed"
        );
        assert_eq!(
            (&*warned.title, &*warned.remedy),
            ("energy lost", "take smaller cells; or a larger step")
        );
    }

    #[test]
    fn a_large_energy_error_that_no_look_of_the_watch_saw_is_warned_of() {
        let row = |time, unexplained| Row { time, unexplained, ..Row::default() };
        let mut recorder = Recorder::new(Pace::every_step());
        let mut enter = |row: Row, kinetic| {
            recorder.books.enter(&Totals { kinetic, ..Totals::default() }, &Exchange::default(), false);
            worse(&mut recorder.worst_unexplained, row.unexplained);
            recorder.note_worst(&row);
            recorder.keep(row);
            recorder.unseen_error()
        };
        assert_eq!(enter(row(0.0, 0.0), 10.0), None);
        assert_eq!(enter(row(1.0, -0.29), 10.0), None);
        let lost = enter(row(2.0, -0.31), 10.0).expect("a warning");
        assert!(lost.found.contains("-3.10 %") && lost.time == 2.0, "{lost:?}");
        let gained = enter(row(3.0, 1.1), 10.0).expect("a warning");
        assert!(gained.found.contains("+11.00 %") && gained.time == 3.0, "{gained:?}");
        recorder.books.enter_rest(1e3);
        assert_eq!((recorder.energy_error(), recorder.worst_energy_error()), (None, 0.0), "nothing moves");
        assert_eq!(recorder.unseen_error(), None);
        recorder.books = Books::default();
        recorder.warnings.push(Warned { title: "energy gained: body".into(), ..Warned::default() });
        assert_eq!(recorder.unseen_error(), None, "the watch has said so");
    }
}
