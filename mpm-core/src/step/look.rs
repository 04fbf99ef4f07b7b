//! A look at the books and bodies of a run: [`crate::watch`].

use super::body::Totals;
use super::solver::{Mpm, StepError, Stopped};
use crate::parallel::Float;
use crate::watch::{
    Account, Alternation, Books, Cells, Finding, GainCause, Warning, Watch, Wholeness, share,
};

/// Looks at the bodies, among all looks.
const BODIES_EVERY: u64 = 16;
/// Steps after which a run is looked at the first times.
const EARLY: [u64; 2] = [16, 64];
/// A look at the end of a run is left out where one was made so few steps before.
const LATELY: u64 = 16;
/// Part of the speed of waves below which motion is noise that no book is judged by.
const NOISE: f64 = 1e-6;
/// A run whose largest energy grew by more than this since the last look gathers energy from nothing.
const GATHERS: f64 = 2.0;
/// Share of all energy whose gain at one look is no swing.
const EXPLODES: f64 = 0.5;
/// Waves cross this part of a cell in a step that may be too long.
const LONG: f64 = 0.65;
/// Share of a gain that is in motion that nodes do not see for that to be the likely cause.
const UNSEEN: f64 = 0.25;
/// An alternating pressure is locking where it is this part of all that the pressure varies, and of the von Mises stress.
const ALTERNATES: f64 = 0.35;
/// Fewer particles that failed alone say nothing.
const FEW_FAILED: u64 = 8;

/// What a run remembers of its looks.
#[derive(Clone, Debug, Default)]
pub(super) struct Looks<const D: usize> {
    pub(super) watch: Watch,
    pub(super) books: Books,
    /// The lowest unexplained energy so far, J.
    pub(super) lowest: f64,
    /// Steps at the first look and the last; none before the first.
    pub(super) first: Option<u64>,
    pub(super) last: u64,
    /// Gains that the last looks found, over the scale, the youngest first.
    pub(super) gains: [f64; 3],
    pub(super) warnings: Vec<Warning>,
    /// Parts of each body at the first look.
    pub(super) parts: Vec<u64>,
    /// The scale that energy was judged by at the last look, J.
    pub(super) scale: f64,
    cells: Option<Cells<D>>,
    totals: Vec<Totals>,
}

impl<const D: usize> Looks<D> {
    /// Open the books anew with the next step, as bodies came.
    pub(super) fn reopen(&mut self) {
        *self = Looks { watch: self.watch, warnings: std::mem::take(&mut self.warnings), ..Looks::default() };
    }
    pub(super) fn bytes(&self) -> usize {
        self.cells.as_ref().map_or(0, Cells::bytes) + self.totals.capacity() * size_of::<Totals>()
    }
}

impl<const D: usize, T: Float> Mpm<D, T> {
    /// Choose what the run watches over: [`Watch`]. A run that the watch stopped may go on after this.
    pub fn set_watch(&mut self, watch: Watch) {
        if let Some(StepError { what: Stopped::Watch(_), .. }) = self.stopped_by {
            self.stopped_by = None;
        }
        self.looks.watch = watch;
        self.looks.gains = [0.0; 3];
    }

    /// What the run warned of so far, each kind of finding once a body.
    pub fn warnings(&self) -> &[Warning] {
        &self.looks.warnings
    }

    /// The books as they stand; they open with the first step after the last body was added.
    pub fn account(&self) -> Account {
        let mut books = self.looks.books;
        books.enter(&self.totals(), &self.ledger(), self.facts().hoop)
    }

    /// Open the books before the first step.
    pub(super) fn open_books(&mut self) {
        if self.looks.first.is_none() && !self.looks.watch.is_off() {
            self.looks.first = Some(self.steps);
            self.looks.last = self.steps;
            self.enter_books();
            if self.looks.watch.bodies {
                for b in 0..self.bodies.len() {
                    let whole = self.look_at_body(b).map_or(1, |(_, whole, _)| whole.parts);
                    self.looks.parts.push(whole as u64);
                }
                self.looks.cells = None;
            }
        }
    }

    fn enter_books(&mut self) -> Account {
        let (mut parts, mut sum) = (std::mem::take(&mut self.looks.totals), Totals::default());
        for body in &self.bodies {
            sum = sum.plus(&body.totals_on(&self.team, &mut parts));
        }
        self.looks.totals = parts;
        let (given, hoop) = (self.ledger(), self.facts().hoop);
        self.looks.books.enter(&sum, &given, hoop)
    }

    /// Look, if it is time to.
    pub(super) fn look_if_due(&mut self) -> Result<(), StepError> {
        let (Some(first), every) = (self.looks.first, self.looks.watch.every) else { return Ok(()) };
        let made = self.steps - first;
        if made.is_multiple_of(every) || EARLY.contains(&made) {
            let bodies = made.is_multiple_of(every.saturating_mul(BODIES_EVERY));
            return self.look(bodies);
        }
        Ok(())
    }

    /// Look at the end of a run.
    pub(crate) fn look_at_the_end_here(&mut self) -> Result<(), StepError> {
        let lately = self.steps < self.looks.last + LATELY;
        if self.looks.first.is_none() || self.looks.watch.is_off() || lately || self.stopped_by.is_some() {
            return Ok(());
        }
        let team = self.team.clone();
        let looked = team.run(|| self.look(true));
        self.stopped_by = looked.as_ref().err().cloned();
        looked
    }

    fn look(&mut self, bodies: bool) -> Result<(), StepError> {
        self.looks.last = self.steps;
        let account = self.enter_books();
        self.look_at_momentum(&account)?;
        self.look_at_energy(&account)?;
        if bodies && self.looks.watch.bodies {
            self.look_at_bodies();
        }
        self.looks.cells = None;
        Ok(())
    }

    fn look_at_momentum(&mut self, account: &Account) -> Result<(), StepError> {
        let missing = account.missing();
        if !(account.kinetic + account.internal + missing).is_finite() {
            let finite = |t: &Totals| (t.kinetic + t.internal + t.momentum_scale).is_finite();
            let body = self.bodies.iter().find(|b| !finite(&b.totals())).map(|b| b.name().to_string());
            let finding = Finding::NotFinite { body: body.unwrap_or_default() };
            return self.found(finding, true);
        }
        let given = self.ledger();
        let impulses = [given.impulse, given.load].iter().flatten().map(|p| p * p).sum::<f64>().sqrt();
        // Inner forces round, too: as if what is stored were in motion.
        let stored = (2.0 * self.mass() * account.energy_scale).sqrt();
        let missed = share(missing, account.momentum_scale.max(impulses).max(stored));
        let limit = self.looks.watch.momentum.unwrap_or(T::default_epsilon().to_double().sqrt());
        if missed > limit {
            return self.found(Finding::Momentum { share: missed, momentum: account.momentum }, true);
        }
        Ok(())
    }

    fn look_at_energy(&mut self, account: &Account) -> Result<(), StepError> {
        // Kinetic damping closes its books to half a step.
        if self.calm.is_some() {
            return Ok(());
        }
        let speed = NOISE * self.rate.to_double() * self.grid.lattice().spacing();
        let least = 0.5 * self.mass() * speed * speed;
        let looks = &mut self.looks;
        looks.lowest = looks.lowest.min(account.unexplained);
        let scale = account.energy_scale.max(account.work.abs()).max(account.friction.abs());
        // While a run gathers energy from nothing, half a step of it is much of it.
        let grows = scale > GATHERS * std::mem::replace(&mut looks.scale, scale);
        if scale < least {
            return Ok(());
        }
        let joules = account.unexplained - looks.lowest;
        let (gain, loss) = (share(joules, scale), share(-account.unexplained, scale));
        let watch = looks.watch;
        if grows && gain < EXPLODES {
            return Ok(());
        }
        let [last, one_before, _] = looks.gains;
        looks.gains = [gain, last, one_before];
        // Kinetic and internal energy belong to times half a step apart, so that one look alone may show a swing.
        let stops = gain.min(last) > watch.stop_gain || gain > EXPLODES;
        let gain_that_lasts = gain.min(last).min(one_before);
        let warns = gain_that_lasts > watch.warn_gain;
        if (stops && watch.stops) || (warns && !self.knows(|f| matches!(f, Finding::EnergyGain { .. }))) {
            let finding = self.explain(gain, joules);
            self.found(finding, stops)?;
        }
        if loss > watch.warn_loss && !self.knows(|f| matches!(f, Finding::EnergyLoss { .. })) {
            self.found(Finding::EnergyLoss { share: loss, joules: -account.unexplained }, false)?;
        }
        Ok(())
    }

    /// Where an energy most likely came from.
    fn explain(&mut self, share: f64, joules: f64) -> Finding {
        let (mut unseen, mut most, mut who) = (0.0, (0.0, [0.0; 3]), 0);
        let mut dense = 0;
        for b in 0..self.bodies.len() {
            let Some((seen, _, beyond)) = self.look_at_body(b) else { continue };
            (unseen, dense) = (unseen + seen, dense + beyond);
            let noisiest = self.cells().noisiest();
            if noisiest.0 > most.0 {
                (most, who) = (noisiest, b);
            }
        }
        let spacing = self.grid.lattice().spacing();
        let near = |x: &[f64; 3]| (0..D).all(|d| (x[d] - most.1[d]).abs() < 2.0 * spacing);
        let limit = 1.0 / self.sharp_rate();
        let dt = self.last_dt.unwrap_or(0.0);
        // Gershgorin's bound is far below the limit where nodes are nearly empty: beyond half a wave a step it counts.
        let cause = if dt > 1.01 * limit && dt * self.rate.to_double() > LONG {
            GainCause::TimeStep { dt, limit }
        } else if dense > 0 {
            GainCause::OverCompressed { particles: dense }
        } else if unseen > UNSEEN * joules {
            GainCause::Unseen { joules: unseen }
        } else if self.contact_nodes().iter().any(|n| near(&n.position)) {
            GainCause::Contact
        } else {
            GainCause::Crossing
        };
        let body = self.bodies.get(who).map_or_else(String::new, |b| b.name().to_string());
        Finding::EnergyGain { share, joules, body, position: most.1, cause }
    }

    fn mass(&self) -> f64 {
        self.looks.books.start.map_or(0.0, |(totals, _)| totals.mass)
    }

    fn cells(&mut self) -> &mut Cells<D> {
        let spacing = self.grid.lattice().spacing();
        self.looks.cells.get_or_insert_with(|| Cells::new(spacing))
    }

    /// The cells of a body: energy that nodes do not see, how whole it is, particles out of the range of their law. None of a rigid body.
    fn look_at_body(&mut self, b: usize) -> Option<(f64, Wholeness, usize)> {
        if self.bodies[b].rigid().is_some() {
            return None;
        }
        self.cells();
        let mut cells = self.looks.cells.take()?;
        cells.clear();
        let mut beyond = 0;
        self.bodies[b].for_each(&mut |p| {
            beyond += usize::from(!p.in_range);
            cells.add(p);
        });
        let reach = self.facts().nodes as i32 - 1;
        let found = (cells.unseen().0, cells.wholeness(reach), beyond);
        self.looks.cells = Some(cells);
        Some(found)
    }

    fn look_at_bodies(&mut self) {
        for b in 0..self.bodies.len() {
            let Some((_, whole, _)) = self.look_at_body(b) else { continue };
            let name = self.bodies[b].name().to_string();
            let before = self.looks.parts.get(b).map_or(1, |&n| n as usize);
            // Weights of the reference configuration hold particles together, however far apart they are.
            let tears =
                !self.facts().total && self.bodies[b].in_reference().is_none() && self.bodies[b].coheres();
            if tears && whole.parts > before && whole.whole_parts > before.saturating_sub(1) {
                let found =
                    Finding::Torn { body: name.clone(), parts: whole.parts, before, share: whole.share };
                self.warn_once(found, |f| matches!(f, Finding::Torn { body, .. } if *body == name));
            }
            if whole.failed >= FEW_FAILED && 2 * whole.alone > whole.failed {
                let Wholeness { failed, alone, position, .. } = whole;
                let found = Finding::LoneFailure { body: name.clone(), failed, alone, position };
                self.warn_once(found, |f| matches!(f, Finding::LoneFailure { body, .. } if *body == name));
            }
            let Alternation { pressure, whole, von_mises } = self.cells().alternation();
            if pressure > ALTERNATES * whole && pressure > ALTERNATES * von_mises {
                let found =
                    Finding::Locking { body: name.clone(), pressure, share: pressure / whole, von_mises };
                self.warn_once(found, |f| matches!(f, Finding::Locking { body, .. } if *body == name));
            }
        }
    }

    fn knows(&self, which: impl Fn(&Finding) -> bool) -> bool {
        self.looks.warnings.iter().any(|w| which(&w.finding))
    }

    fn warn_once(&mut self, finding: Finding, same: impl Fn(&Finding) -> bool) {
        if !self.knows(same) {
            self.warn(finding);
        }
    }

    fn warn(&mut self, finding: Finding) {
        let (step, time) = (self.steps, self.time);
        self.looks.warnings.push(Warning { step, time, finding });
    }

    /// Stop for what was found, if it is so bad and the watch may; else warn, once.
    fn found(&mut self, finding: Finding, stops: bool) -> Result<(), StepError> {
        if stops && self.looks.watch.stops {
            return Err(StepError {
                step: self.steps,
                time: self.time,
                what: Stopped::Watch(Box::new(finding)),
            });
        }
        let kind = std::mem::discriminant(&finding);
        self.warn_once(finding, |f| std::mem::discriminant(f) == kind);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::super::solver::Stopped;
    use crate::geometry::{Ball, Filling, Lattice, fill};
    use crate::{BlockGrid, Finding, Method, Mpm, PlaneStrain};
    use mpm_materials::{Moduli, NeoHookean};

    /// Books that a scene of sound parts never has: an impulse that no particle got.
    #[test]
    fn momentum_from_nowhere_stops_the_run() {
        let lattice = Lattice::new([0.0; 2], 0.1).unwrap();
        let seeds = fill(&Ball::new([0.0, 0.5], 0.3).unwrap(), &lattice, 2, &Filling::new()).unwrap();
        let law = NeoHookean::new(1000.0, Moduli::young_poisson(1e6, 0.3).unwrap()).unwrap();
        let mut mpm = Mpm::new(Method::impact(PlaneStrain), BlockGrid::new(lattice));
        mpm.add("ball", law, &seeds, |_| [-1.0, 0.0]).unwrap();
        let scale = mpm.totals().momentum_scale;
        let (small, large) = (1e-12 * scale, 1e-3 * scale);
        mpm.ledger.impulse[0] += small;
        mpm.run_until(0.05).unwrap();
        mpm.ledger.impulse[0] += large;
        let stopped = mpm.run_until(1.0).unwrap_err();
        let Stopped::Watch(finding) = &stopped.what else { panic!("{stopped}") };
        let Finding::Momentum { share, momentum } = **finding else { panic!("{stopped}") };
        assert!((share / 1e-3 - 1.0).abs() < 0.01 && (momentum[0] / -large - 1.0).abs() < 1e-6, "{stopped}");
        assert!(stopped.to_string().contains("came from nowhere"), "{stopped}");
    }
}
