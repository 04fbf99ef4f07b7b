//! Checks of the balances of a run.

use super::Watch;
use crate::archive::{Archive, CheckpointError};
use crate::balance::{Account, Books, share};
use crate::body::Totals;
use crate::clock::Clock;
use crate::error::{StepError, Stopped};
use crate::exchange::Exchange;
use crate::finding::{Booked, Finding, Loss, Warning};

/// Interval between checks of the bodies, in checks.
const BODIES_EVERY: u64 = 16;
/// Step counts of the first two checks.
const EARLY: [u64; 2] = [16, 64];
/// Number of steps after a check in which the check at the end of a run is omitted, unless the last check found a gain.
const LATELY: u64 = 16;
/// Number of steps below which the check at the end judges a run alone, since there were no two checks before.
const FEW_STEPS: u64 = EARLY[1];
/// Allowed error of the energy balance after few steps, as a share of the largest energy: half a step of work.
const OFF: f64 = 0.10;
/// Share of the wave speed below which motion is noise and balances are not judged.
const NOISE: f64 = 1e-6;
/// Growth of the largest energy since the last check above which the gain is not judged, since half a step of work is large then.
const GATHERS: f64 = 2.0;
/// Share of the largest energy above which a gain at one check is no oscillation.
const EXPLODES: f64 = 0.5;

/// State of the checks of a run: balances, findings and warnings.
#[derive(Clone, Debug, Default)]
pub struct Watcher {
    watch: Watch,
    books: Books,
    /// Lowest unexplained energy so far, J.
    lowest: f64,
    /// Steps at the first check and at the last one; none before the first.
    first: Option<u64>,
    last: u64,
    /// Energy gains of the last three checks over the energy scale, the latest first.
    gains: [f64; 3],
    warnings: Vec<Warning>,
    /// Energy scale of the last check, J.
    scale: f64,
    /// Error that stopped the run.
    stopped_by: Option<StepError>,
}

/// Input of a check beside the totals.
#[derive(Clone, Copy, Debug)]
pub struct Look<'a> {
    /// Simulated time and step count.
    pub clock: &'a Clock,
    /// Exchange since the start.
    pub exchange: &'a Exchange,
    /// Relative rounding error of the points' numbers.
    pub rounding: f64,
    /// Speed of waves and points, m/s.
    pub speed: f64,
    /// True if energy is judged.
    pub energy: bool,
    /// Gain of energy, J, that does not stop a run: what the method's own corrections may add.
    pub uncertain: f64,
    /// Likely sink of lost energy, and the remedy.
    pub loss: Loss,
}

impl<'a> Look<'a> {
    /// Look at numbers in double precision, of which energy is judged.
    #[must_use]
    pub fn new(clock: &'a Clock, exchange: &'a Exchange, speed: f64, loss: Loss) -> Self {
        Look { clock, exchange, rounding: f64::EPSILON, speed, energy: true, uncertain: 0.0, loss }
    }
}

/// Largest energy of a run so far, J: energy of the points, work and friction.
fn scale(account: &Account) -> f64 {
    account.energy_scale.max(account.work.abs()).max(account.friction.abs())
}

impl Watcher {
    /// Set the thresholds. A run that a check stopped can continue after this.
    pub fn set(&mut self, watch: Watch) {
        if let Some(StepError { what: Stopped::Watch(_), .. }) = self.stopped_by {
            self.stopped_by = None;
        }
        self.watch = watch;
        self.gains = [0.0; 3];
    }
    /// Settings of the checks.
    #[must_use]
    pub fn watch(&self) -> &Watch {
        &self.watch
    }
    /// Warnings so far.
    #[must_use]
    pub fn warnings(&self) -> &[Warning] {
        &self.warnings
    }
    /// Return the balance for the totals `now` and the given `exchange`, without entering it.
    #[must_use]
    pub fn account(&self, now: &Totals, exchange: &Exchange, axisymmetric: bool) -> Account {
        let mut books = self.books;
        books.enter(now, exchange, axisymmetric)
    }
    /// Restart the balance at the next step, after bodies were added.
    pub fn reopen(&mut self) {
        *self = Watcher {
            watch: self.watch,
            warnings: std::mem::take(&mut self.warnings),
            stopped_by: self.stopped_by.take(),
            ..Watcher::default()
        };
    }

    /// Error that stopped the run. A stopped run makes no step.
    #[must_use]
    pub fn stopped_by(&self) -> Option<&StepError> {
        self.stopped_by.as_ref()
    }
    /// Check before a step that the run was not stopped.
    ///
    /// # Errors
    /// The error that stopped the run.
    pub fn may_go_on(&self) -> Result<(), StepError> {
        self.stopped_by.clone().map_or(Ok(()), Err)
    }
    /// Record the result of a step or a check. Errors of the clock do not stop the run.
    ///
    /// # Errors
    /// The error of the step.
    pub fn note<X>(&mut self, made: Result<X, StepError>) -> Result<X, StepError> {
        if let Err(error) = &made
            && !matches!(error.what, Stopped::Clock { .. })
        {
            self.stopped_by = Some(error.clone());
        }
        made
    }

    /// True before the first step of a run with checks: [`Watcher::open`] is due.
    #[must_use]
    pub fn opens(&self) -> bool {
        self.first.is_none() && !self.watch.is_off()
    }
    /// Open the balance with the initial totals.
    pub fn open(&mut self, steps: u64, now: &Totals, exchange: &Exchange, axisymmetric: bool) {
        self.first = Some(steps);
        self.last = steps;
        self.books.enter(now, exchange, axisymmetric);
    }
    /// Return `Some` if a check is due after a step: true if it includes the bodies.
    #[must_use]
    pub fn due(&self, steps: u64) -> Option<bool> {
        let (every, made) = (self.watch.every, steps - self.first?);
        let due = made.is_multiple_of(every) || EARLY.contains(&made);
        due.then(|| made.is_multiple_of(every.saturating_mul(BODIES_EVERY)))
    }
    /// True if a check is due at the end of a run.
    #[must_use]
    pub fn due_at_the_end(&self, steps: u64) -> bool {
        let Some(first) = self.first.filter(|_| self.stopped_by.is_none() && !self.watch.is_off()) else {
            return false;
        };
        let few = steps - first < FEW_STEPS && steps > self.last;
        few || steps >= self.last + LATELY || self.has_a_gain_to_judge()
    }
    /// True if the last check found a gain above the stop threshold of which no warning exists yet.
    fn has_a_gain_to_judge(&self) -> bool {
        self.gains[0] > self.watch.stop_gain && !self.knows(|f| matches!(f, Finding::EnergyGain { .. }))
    }
    /// True if localisation is checked after this number of steps: with the bodies, at checks 1, 2, 4, 8, and at the end of a run.
    pub(super) fn looks_for_bands(&self, steps: u64) -> bool {
        let Some(made) = self.first.map(|first| steps - first).filter(|_| self.watch.bodies) else {
            return false;
        };
        let checks = made / self.watch.every;
        match self.due(steps) {
            Some(_) => checks.is_power_of_two() || checks.is_multiple_of(BODIES_EVERY) && checks > 0,
            None => true,
        }
    }
    /// True if bodies are checked.
    #[must_use]
    pub fn sees_bodies(&self) -> bool {
        self.watch.bodies
    }

    /// Enter the totals `now`, and judge momentum and energy. `broken` returns the name of a body with non-finite numbers. `explain` makes
    /// a finding from an energy gain: its share of the largest energy, and the gain in J.
    ///
    /// # Errors
    /// A finding that stops the run.
    pub fn look(
        &mut self,
        now: &Totals,
        axisymmetric: bool,
        at: &Look<'_>,
        broken: impl FnOnce() -> String,
        explain: impl FnOnce(f64, f64) -> Finding,
    ) -> Result<(), StepError> {
        let steps = at.clock.steps;
        let again = self.last == steps;
        let at_the_end = again || self.due(steps).is_none();
        self.last = steps;
        let speed = NOISE * at.speed;
        let account = self.books.enter(now, at.exchange, axisymmetric);
        self.books.enter_rest(0.5 * self.books.mass() * speed * speed);
        self.look_at_momentum(&account, at, broken)?;
        if at_the_end && self.first.is_some_and(|first| steps - first < FEW_STEPS) {
            self.judge_few_steps(&account, at);
            return Ok(());
        }
        if again {
            // The end of a run right after a check: this gain replaces that of the last check.
            self.gains = [self.gains[1], self.gains[2], 0.0];
        }
        self.look_at_energy(&account, at, at_the_end, explain)
    }

    /// Check the end of a run of few steps. Only the warning is kept, since the run may continue.
    fn judge_few_steps(&mut self, account: &Account, at: &Look<'_>) {
        let scale = scale(account);
        let off = share(account.unexplained, scale);
        if at.energy && scale > self.books.rest() && (off.abs() > OFF || off.is_nan()) {
            let steps = at.clock.steps - self.first.unwrap_or(0);
            let finding = Finding::FewSteps { steps, share: off, joules: account.unexplained };
            self.warn_once(at.clock, finding, |f| matches!(f, Finding::FewSteps { .. }));
        }
    }

    fn look_at_momentum(
        &mut self,
        account: &Account,
        at: &Look<'_>,
        broken: impl FnOnce() -> String,
    ) -> Result<(), StepError> {
        let missing = account.missing();
        if !(account.kinetic + account.internal + missing).is_finite() {
            return self.found(at.clock, Finding::NotFinite { body: broken() }, true);
        }
        let given = at.exchange;
        let impulses = [given.impulse, given.load].iter().flatten().map(|p| p * p).sum::<f64>().sqrt();
        // Scale of the rounding of internal forces: momentum of all stored energy as kinetic energy.
        let stored = (2.0 * self.books.mass() * account.energy_scale).sqrt();
        let missed = share(missing, account.momentum_scale.max(impulses).max(stored));
        let limit = self.watch.momentum.unwrap_or(at.rounding.sqrt());
        if missed > limit {
            let finding = Finding::Momentum { share: missed, momentum: account.momentum };
            return self.found(at.clock, finding, true);
        }
        Ok(())
    }

    fn look_at_energy(
        &mut self,
        account: &Account,
        at: &Look<'_>,
        at_the_end: bool,
        explain: impl FnOnce(f64, f64) -> Finding,
    ) -> Result<(), StepError> {
        if !at.energy {
            return Ok(());
        }
        self.lowest = self.lowest.min(account.unexplained);
        let scale = scale(account);
        // While the energy scale grows fast, half a step of work is a large share of it.
        let grows = scale > GATHERS * std::mem::replace(&mut self.scale, scale);
        if scale <= self.books.rest() {
            return Ok(());
        }
        let joules = account.unexplained - self.lowest;
        let (gain, loss) = (share(joules, scale), share(-account.unexplained, scale));
        if grows && gain < EXPLODES {
            return Ok(());
        }
        let [last, one_before, _] = self.gains;
        self.gains = [gain, last, one_before];
        // A single check may show an oscillation, since kinetic and internal energy belong to times half a step apart.
        let certain = share((joules - at.uncertain).max(0.0), scale);
        let stops = certain.min(last) > self.watch.stop_gain || certain > EXPLODES;
        let gain_that_lasts = gain.min(last).min(one_before);
        // No later check judges a gain at the end of a run.
        let warns = gain_that_lasts > self.watch.warn_gain || (at_the_end && gain > self.watch.stop_gain);
        if (stops && self.watch.stops) || (warns && !self.knows(|f| matches!(f, Finding::EnergyGain { .. })))
        {
            let finding = explain(gain, joules);
            self.found(at.clock, finding, stops)?;
        }
        if loss > self.watch.warn_loss && !self.knows(|f| matches!(f, Finding::EnergyLoss { .. })) {
            let contact = at.exchange.node_contact.max(0.0);
            let booked = Booked {
                friction: account.friction,
                impacts: account.impacts,
                damping: account.damping,
                viscosity: account.viscosity + account.viscous_heat,
            };
            let joules = -account.unexplained;
            let finding = Finding::EnergyLoss { share: loss, joules, contact, booked, loss: at.loss };
            self.found(at.clock, finding, false)?;
        }
        Ok(())
    }

    pub(super) fn knows(&self, which: impl Fn(&Finding) -> bool) -> bool {
        self.warnings.iter().any(|w| which(&w.finding))
    }

    /// Add a warning unless a `same` finding is among the warnings.
    pub fn warn_once(&mut self, clock: &Clock, finding: Finding, same: impl Fn(&Finding) -> bool) {
        if !self.knows(same) {
            self.warnings.push(Warning { step: clock.steps, time: clock.time, finding });
        }
    }

    /// Return an error for a severe finding if stopping is enabled; else warn once.
    fn found(&mut self, clock: &Clock, finding: Finding, stops: bool) -> Result<(), StepError> {
        if stops && self.watch.stops {
            return Err(StepError {
                step: clock.steps,
                time: clock.time,
                what: Stopped::Watch(Box::new(finding)),
            });
        }
        let kind = std::mem::discriminant(&finding);
        self.warn_once(clock, finding, |f| std::mem::discriminant(f) == kind);
        Ok(())
    }

    /// Write or read balances and past gains. Warnings are not saved.
    ///
    /// # Errors
    /// I/O error; damaged file.
    pub fn archive(&mut self, file: &mut Archive) -> Result<(), CheckpointError> {
        self.books.archive(file)?;
        file.reals([&mut self.lowest, &mut self.scale])?;
        file.option(&mut self.first, Archive::word)?;
        file.word(&mut self.last)?;
        file.reals(&mut self.gains)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::finding::GainCause;

    const LOSS: Loss = Loss { by: "a sink", remedy: "mend it" };

    /// Watcher of a scene of 1 kg with 1 J at the start.
    fn watcher() -> Watcher {
        let mut watcher = Watcher::default();
        watcher.open(0, &totals(1.0), &Exchange::default(), false);
        watcher
    }
    fn totals(kinetic: f64) -> Totals {
        Totals { mass: 1.0, kinetic, momentum_scale: 1.0, ..Totals::default() }
    }
    fn look(watcher: &mut Watcher, steps: u64, kinetic: f64, speed: f64) -> Result<(), StepError> {
        look_with(watcher, steps, kinetic, speed, 0.0)
    }
    fn look_with(
        watcher: &mut Watcher,
        steps: u64,
        kinetic: f64,
        speed: f64,
        uncertain: f64,
    ) -> Result<(), StepError> {
        let clock = Clock { steps, ..Clock::default() };
        let exchange = Exchange::default();
        let at = Look { uncertain, ..Look::new(&clock, &exchange, speed, LOSS) };
        watcher.look(&totals(kinetic), false, &at, String::new, |share, joules| Finding::EnergyGain {
            share,
            joules,
            body: String::new(),
            position: [0.0; 3],
            cause: GainCause::Crossing,
        })
    }

    #[test]
    fn the_end_of_a_run_of_few_steps_is_judged() {
        for (kinetic, warns) in
            [(1.0, false), (1.09, false), (0.91, false), (1.2, true), (0.85, true), (3.0, true)]
        {
            let mut watcher = watcher();
            assert!(!watcher.due_at_the_end(0) && watcher.due_at_the_end(3));
            look(&mut watcher, 3, kinetic, 1.0).expect("it may go on");
            let found =
                watcher.warnings().iter().any(|w| matches!(w.finding, Finding::FewSteps { steps: 3, .. }));
            assert_eq!((found, watcher.warnings().len()), (warns, usize::from(warns)), "{kinetic}");
            // After the check at the end the run continues, and the stored gains are unchanged.
            look(&mut watcher, 16, 1.0, 1.0).expect("a look");
            assert_eq!(watcher.gains, [0.0; 3]);
            assert_eq!(watcher.warnings().len(), usize::from(warns));
        }
    }

    #[test]
    fn a_gain_that_only_the_end_shows_is_warned_of() {
        let mut watcher = watcher();
        look(&mut watcher, 16, 1.0, 1.0).expect("a look");
        look(&mut watcher, 64, 1.2, 1.0).expect("one look alone may show a swing");
        assert!(watcher.warnings().is_empty() && watcher.due_at_the_end(64));
        look(&mut watcher, 64, 1.2, 1.0).expect("the same look is no second one");
        assert!(matches!(watcher.warnings(), [Warning { finding: Finding::EnergyGain { .. }, .. }]));
        assert!(!watcher.due_at_the_end(64));
        look(&mut watcher, 256, 1.2, 1.0).expect_err("two looks with a gain stop");
        let mut watcher = self::watcher();
        for steps in EARLY.into_iter().chain([256]) {
            look(&mut watcher, steps, 1.0, 1.0).expect("a look");
        }
        assert!(!watcher.due_at_the_end(256) && !watcher.due_at_the_end(271) && watcher.due_at_the_end(272));
        look(&mut watcher, 300, 1.2, 1.0).expect("a warning");
        assert!(matches!(watcher.warnings(), [Warning { finding: Finding::EnergyGain { .. }, .. }]));
    }

    #[test]
    fn an_uncertain_gain_warns_and_does_not_stop() {
        let mut watcher = watcher();
        for steps in [16, 64, 256, 512] {
            look_with(&mut watcher, steps, 1.8, 1.0, 0.9).expect("0.8 J of 0.9 J");
        }
        assert!(matches!(watcher.warnings(), [Warning { finding: Finding::EnergyGain { .. }, .. }]));
        look_with(&mut watcher, 768, 2.5, 1.0, 0.9).expect_err("0.6 J more than 0.9 J");
    }

    #[test]
    fn a_loss_of_three_per_cent_is_warned_of_and_rest_is_none() {
        let mut watcher = watcher();
        look(&mut watcher, 64, 0.975, 1.0).expect("a look");
        assert!(watcher.warnings().is_empty());
        look(&mut watcher, 256, 0.96, 1.0).expect("a look");
        assert!(matches!(watcher.warnings(), [Warning { finding: Finding::EnergyLoss { .. }, .. }]));
        // Waves of 1e7 m/s: 1 J of 1 kg is rounding.
        let mut watcher = self::watcher();
        look(&mut watcher, 64, 0.1, 1e7).expect("a look");
        let account = watcher.account(&totals(0.1), &Exchange::default(), false);
        assert!(watcher.warnings().is_empty() && !account.moves() && account.energy_error() == 0.0);
    }
}
