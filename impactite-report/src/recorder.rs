//! Keeps what a report shows of a run over its time.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::SystemTime;

use impactite_scene::balance::{Books, share};
use impactite_scene::observe::{ObserveError, Observer, Pace, RunView};
use impactite_scene::{Archive, CheckpointError, Finding, StepLimit, Warning};

use crate::number::percent;

/// Rows kept at most.
pub const MOST_ROWS: usize = 4096;
/// Shares of an energy gained, lost from which on an error is warned of.
const BAD_GAIN: f64 = 0.10;
const BAD_LOSS: f64 = 0.03;

/// A run at one moment. Per radian in axisymmetric scenes, per metre of depth in plane strain.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Row {
    /// Time, s.
    pub time: f64,
    /// Steps made.
    pub step: u64,
    /// Size of the last step, s; NaN before the first.
    pub dt: f64,
    /// Points that carry mass.
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
    /// Kinetic energy that plastic impacts of points took since the first row, J.
    pub impacts: f64,
    /// Energy that local damping, kinetic damping and the null-space filter took since the first row, J.
    pub damping: f64,
    /// Energy that numerical viscosity took since the first row, J, which no law has.
    pub viscosity: f64,
    /// Heat of the viscosity of laws since the first row, J: part of the internal energy.
    pub viscous_heat: f64,
    /// Kinetic energy less the balanced one, J, where velocities are half a step behind positions.
    pub staggered: f64,
    /// Energy that came with points split, merged, made or removed since the first row, J.
    pub conversion: f64,
    /// Energy that nothing explains, J ([`impactite_scene::Account::unexplained`]); negative: lost.
    pub unexplained: f64,
    /// The same over the largest kinetic energy, or sum of kinetic and internal energy, so far.
    pub energy_error: f64,
    /// Momentum, kg m/s.
    pub momentum: [f64; 3],
    /// Amount of the momentum that nothing explains over the largest sum of m |v| so far.
    pub momentum_error: f64,
    /// Seconds by the clock on the wall spent in steps so far.
    pub wall_seconds: f64,
    /// Point updates so far.
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

/// What a run warned of, in words.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
#[non_exhaustive]
pub struct Warned {
    /// Steps made.
    pub step: u64,
    /// Time, s.
    #[serde(with = "crate::number::real")]
    pub time: f64,
    /// What it is about, in two or three words.
    pub title: String,
    /// What was found, and its likely cause.
    pub found: String,
    /// Remedy.
    pub remedy: String,
}

/// In words: what it is about, and the body.
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

/// An observer that keeps the balances of a run, its steps and its rate over time, and what it warned of, for a
/// [`Record`](crate::Record).
///
/// It keeps [`MOST_ROWS`] rows at most: where there would be more, it drops every second one and keeps every second look from then on.
/// The first and the last look are always there, and errors are the worst of all looks, kept or not. What it keeps goes into
/// checkpoints: a run that is resumed has the rows, errors and warnings of one that was not broken off, bit for bit, but for what is a
/// matter of the clock on the wall.
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
    /// Looks so far, and one of how many is kept.
    looks: u64,
    stride: u64,
    rows: Vec<Row>,
    last: Option<Row>,
    /// The unexplained energy that is largest by amount, J, and the most momentum missing, kg m/s; NaN from the first look that found
    /// that.
    worst_unexplained: f64,
    worst_missing: f64,
    /// Step and time, s, of the former.
    worst_at: (u64, f64),
    /// The change of mass since the first look that is largest by amount, kg.
    worst_mass: f64,
    warnings: Vec<Warned>,
    /// What limited the step, in words, and at how many looks; first seen first.
    limits: Vec<(String, u64)>,
    /// Where the run is to end, s, and is it there?
    end: f64,
    reached: bool,
    clock: WallClock,
    /// Bits of the energy error of the last row.
    latest: Arc<AtomicU64>,
}

/// When a run began and ended by the clock on the wall.
#[derive(Clone, Copy, Debug, Default)]
struct WallClock {
    /// In earlier pieces of the run, s.
    before: f64,
    started: Option<SystemTime>,
    ended: Option<SystemTime>,
    looked: Option<std::time::Instant>,
    seconds: f64,
}

impl Recorder {
    /// Look at this pace.
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

    /// The energy error of the last look, for an observer that looks after this one at the same pace. Its scale is the largest energy of all
    /// looks, which [`impactite_scene::Solver::account`] sees fewer of.
    pub fn latest_energy_error(&self) -> impl Fn() -> f64 + Send + 'static {
        let latest = self.latest.clone();
        move || f64::from_bits(latest.load(Ordering::Relaxed))
    }

    /// What was seen, in order of time.
    #[must_use]
    pub fn rows(&self) -> Vec<Row> {
        let kept = self.rows.last().map(|row| row.step);
        self.rows.iter().chain(self.last.iter().filter(|last| Some(last.step) != kept)).copied().collect()
    }

    /// What the run warned of, in order of time.
    #[must_use]
    pub fn warnings(&self) -> &[Warned] {
        &self.warnings
    }

    /// What limited the step that was next, in words, and at how many looks.
    #[must_use]
    pub fn limits(&self) -> &[(String, u64)] {
        &self.limits
    }

    fn limited(&mut self, now: &RunView<'_>) {
        // Before the first step nothing is known of waves.
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

    /// The energy that nothing explains, the largest by amount of all looks, with its sign, over the largest energy of the whole run; 0 where
    /// nothing moves.
    #[must_use]
    pub fn worst_energy_error(&self) -> f64 {
        self.books.energy_error(self.worst_unexplained)
    }

    /// The same, and none where nothing moves ([`impactite_scene::Account::moves`]): an error of rounding over rounding says nothing.
    #[must_use]
    pub fn energy_error(&self) -> Option<f64> {
        let rests = self.books.rest() > 0.0 && !self.books.moves();
        (!rests || self.worst_unexplained.is_nan()).then(|| self.worst_energy_error())
    }

    /// The largest amount of momentum that nothing explains, of all looks, over the largest sum of m |v| of the whole run.
    #[must_use]
    pub fn worst_momentum_error(&self) -> f64 {
        share(self.worst_missing, self.books.scales()[1])
    }

    /// The change of the mass since the first look, the largest by amount of all looks, with its sign, over the mass at that look.
    #[must_use]
    pub fn worst_mass_error(&self) -> f64 {
        share(self.worst_mass, self.books.mass())
    }

    /// The largest energy of the run, J, and the largest sum of m |v|, kg m/s, which errors are relative to.
    #[must_use]
    pub fn scales(&self) -> [f64; 2] {
        self.books.scales()
    }

    /// The time that the run has come to, and the one it is to end at, s; none before the first look.
    #[must_use]
    pub fn time_and_end(&self) -> Option<[f64; 2]> {
        self.last.map(|last| [last.time, self.end])
    }

    /// Has the run come to its end?
    #[must_use]
    pub fn reached(&self) -> bool {
        self.reached
    }

    /// When it looked first, in this process, and when the run was over or it looked last.
    #[must_use]
    pub fn started_and_ended(&self) -> Option<[SystemTime; 2]> {
        let started = self.clock.started?;
        Some([started, self.clock.ended.unwrap_or(started)])
    }

    /// Seconds by the clock on the wall from the first look to the last, observers and files included, pieces of a run added up.
    #[must_use]
    pub fn seconds(&self) -> f64 {
        self.clock.before + self.clock.seconds
    }

    /// Warnings at the end of a run, beside those of the run itself: points that are gone, and a large energy error that
    /// was there between two looks of the watch.
    #[must_use]
    pub fn late_warnings(&self) -> Vec<Warned> {
        self.removed().into_iter().chain(self.unseen_error()).collect()
    }

    /// A warning of points that are gone since the first look.
    fn removed(&self) -> Option<Warned> {
        removed(self.rows.first()?, self.last.as_ref()?)
    }

    /// A warning of the largest energy error, where it is large and no warning of the run is about energy.
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

    /// Where the largest energy error is, if it is at this row.
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

/// A warning of points that are gone.
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

/// Where `worst` keeps what is largest by amount, and what is no number.
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
            self.books.enter_rest(now.solver().account().rest);
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
            // A count, that division and multiplication by a time may have moved off its whole number.
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
        // A run that is resumed finds again what it warned of before.
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
        // Split, or added.
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
