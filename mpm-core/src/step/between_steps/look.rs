//! Checks of the balances and bodies of a run: [`impactite_scene::watch`].

use impactite_scene::error::{StepError, Stopped};
use impactite_scene::watch::{Account, Finding, GainCause, Look, Loss, Warning, Watch, Watcher};
use impactite_scene::{Body, Solver, Totals};

use super::cells::{Alternation, Cells, Wholeness};

use crate::step::mpm::Mpm;
use crate::step::passes::kernels::Facts;
use impactite_simd::Float;

/// Part of a cell that waves cross in a step, beyond which the step may be too long.
const LONG: f64 = 0.65;
/// Part of an energy gain in unresolved motion, beyond which that motion is the likely cause.
const UNSEEN: f64 = 0.25;
/// Ratios of the alternating pressure to the pressure variation and to the von Mises stress, beyond which it is locking.
const ALTERNATES: f64 = 0.35;
/// Number of failed particles below which isolated failures are not reported.
const FEW_FAILED: u64 = 8;

/// Energy sinks that are not in the balance.
const FILTER: &str = "the filter of the transfer";
const CONTACT: &str = "contacts that closed";
const BOTH: &str = "the filter of the transfer or contacts that closed";
const WALLS: &str = "the filter of the transfer, or the stress update (USL) where bodies press on walls";
const ALL: &str = "the filter of the transfer, contacts that closed, or the stress update (USL) where bodies press on walls";
const NEITHER: &str = "the motion of particles through cells";

/// Return the energy sink outside the balance, and remedies for the transfer in use: transfers that keep more of the
/// energy, the best first. FLIP with MUSL keeps most, then AFLIP, then all others.
fn loss(facts: &Facts, [filters, contact, walls]: [bool; 3]) -> Loss {
    let by = match (filters, contact) {
        (true, true) if walls => ALL,
        (true, false) if walls => WALLS,
        (true, true) => BOTH,
        (true, false) => FILTER,
        (false, true) => CONTACT,
        (false, false) => NEITHER,
    };
    let remedy = match (facts.affine, facts.reads_increment) {
        (false, true) if facts.remap => "take smaller cells",
        (true, true) => {
            "take smaller cells, or a transfer that keeps more: FLIP with MUSL where nothing spins, AFLIP with USF"
        }
        _ => {
            "take smaller cells, or a transfer that keeps more: FLIP with MUSL where nothing spins, AFLIP with USF, AFLIP with USL \
             (`Method::impact`)"
        }
    };
    Loss { by, remedy }
}

impl<const D: usize, T: Float> Mpm<D, T> {
    /// Set the checks of the run: [`Watch`]. A run that the watch stopped may continue afterwards.
    pub fn set_watch(&mut self, watch: Watch) {
        if let Some(StepError { what: Stopped::Watch(_), .. }) = self.stopped_by {
            self.stopped_by = None;
        }
        self.looks.watcher.set(watch);
    }

    /// Warnings of the run so far, each kind of finding once per body.
    pub fn warnings(&self) -> &[Warning] {
        self.looks.watcher.warnings()
    }

    /// Present balance; it opens with the first step after the last body was added.
    pub fn account(&self) -> Account {
        Solver::account(self)
    }

    /// Open the balance before the first step.
    pub(in crate::step) fn open_books(&mut self) {
        if self.looks.watcher.opens() {
            let (totals, exchange) = (self.totals_on_team(), self.exchange());
            self.looks.watcher.open(self.clock.steps, &totals, &exchange, self.facts().hoop);
            if self.looks.watcher.sees_bodies() {
                for b in 0..self.scene.bodies.len() {
                    let whole = self.look_at_body(b).map_or(1, |(_, whole, _)| whole.parts);
                    self.looks.parts.push(whole as u64);
                }
                self.looks.cells = None;
            }
        }
    }

    fn totals_on_team(&mut self) -> Totals {
        let (mut parts, mut sum) = (std::mem::take(&mut self.looks.totals), Totals::default());
        for body in &self.scene.bodies {
            sum = sum.plus(&body.totals_on(&self.team, &mut parts));
        }
        self.looks.totals = parts;
        sum
    }

    /// Check balances and bodies, if due.
    pub(in crate::step) fn look_if_due(&mut self) -> Result<(), StepError> {
        self.looks.watcher.due(self.clock.steps).map_or(Ok(()), |bodies| self.look(bodies))
    }

    /// Check balances and bodies at the end of a run.
    pub(crate) fn look_at_the_end_here(&mut self) -> Result<(), StepError> {
        if self.stopped_by.is_some() || !self.looks.watcher.due_at_the_end(self.clock.steps) {
            return Ok(());
        }
        let team = self.team.clone();
        let looked = team.run(|| self.look(true));
        self.stopped_by = looked.as_ref().err().cloned();
        looked
    }

    fn look(&mut self, bodies: bool) -> Result<(), StepError> {
        let totals = self.totals_on_team();
        let mut watcher = std::mem::take(&mut self.looks.watcher);
        let (clock, exchange) = (self.clock, self.exchange());
        // FLIP gathers velocity changes only; with MUSL and USF no stress update dissipates either.
        let of_nodes = self.kernels.taken(T::of(clock.last.unwrap_or(0.0)));
        let filters = of_nodes != T::default() || !self.facts().symplectic();
        // Nodes behind a wall have little mass: USL dissipates most there.
        let walls = !self.facts().symplectic() && !self.grid.walls.is_empty();
        let speed = self.stepper.rate.to_double() * self.grid.lattice().spacing();
        let loss = loss(self.facts(), [filters, exchange.node_contact > 0.0, walls]);
        let at = Look {
            rounding: T::default_epsilon().to_double(),
            // With kinetic damping the balance closes to half a step only.
            energy: self.between_steps.kinetic_damping.is_none(),
            ..Look::new(&clock, &exchange, speed, loss)
        };
        let broken = || {
            let broken = self.scene.bodies.iter().find(|b| !b.totals().is_finite());
            broken.map(|b| b.name().to_string()).unwrap_or_default()
        };
        let name = if totals.is_finite() { String::new() } else { broken() };
        let hoop = self.facts().hoop;
        let looked = watcher.look(&totals, hoop, &at, || name, |share, joules| self.explain(share, joules));
        if looked.is_ok() && bodies && watcher.sees_bodies() {
            self.look_at_bodies(&mut watcher);
        }
        if looked.is_ok() {
            // Bodies that are not on the grid are checked by their own solver.
            let on_grid =
                self.scene.bodies.iter().filter(|body| body.client().is_none_or(|client| client.on_grid()));
            let bodies: Vec<&dyn Body> = on_grid.map(|body| &**body as &dyn Body).collect();
            watcher.look_at_fields(&clock, &bodies, (D, hoop), Some(self.grid.lattice().spacing()));
        }
        self.looks.watcher = watcher;
        self.looks.cells = None;
        looked
    }

    /// Find the most likely cause of an energy gain.
    fn explain(&mut self, share: f64, joules: f64) -> Finding {
        let (mut unseen, mut most, mut who) = (0.0, (0.0, [0.0; 3]), 0);
        let mut dense = 0;
        for b in 0..self.scene.bodies.len() {
            let Some((seen, _, beyond)) = self.look_at_body(b) else { continue };
            (unseen, dense) = (unseen + seen, dense + beyond);
            let noisiest = self.cells().noisiest();
            if noisiest.0 > most.0 {
                (most, who) = (noisiest, b);
            }
        }
        let spacing = self.grid.lattice().spacing();
        let near = |x: &[f64; 3]| (0..D).all(|d| (x[d] - most.1[d]).abs() < 2.0 * spacing);
        let limit = 1.0 / self.gershgorin_rate();
        let dt = self.clock.last.unwrap_or(0.0);
        // Gershgorin's bound is far below the limit where nodes are nearly empty: it counts only if waves cross more
        // than `LONG` of a cell.
        let cause = if dt > 1.01 * limit && dt * self.stepper.rate.to_double() > LONG {
            GainCause::TimeStep { dt, limit }
        } else if dense > 0 {
            GainCause::OverCompressed { particles: dense }
        } else if unseen > UNSEEN * joules {
            GainCause::Unseen { joules: unseen }
        } else if self.contact_points().iter().any(|n| near(&n.position)) {
            GainCause::Contact
        } else {
            GainCause::Crossing
        };
        let body = self.scene.bodies.get(who).map_or_else(String::new, |b| b.name().to_string());
        Finding::EnergyGain { share, joules, body, position: most.1, cause }
    }

    fn cells(&mut self) -> &mut Cells<D> {
        let spacing = self.grid.lattice().spacing();
        // Invalid periodic planes were refused earlier.
        let period = self.wrap().map_or([0; D], |wrap| wrap.cells());
        self.looks.cells.get_or_insert_with(|| Cells::new(spacing, period))
    }

    /// Analyse the cells of a body: energy of unresolved motion, fragmentation, particles out of the range of their
    /// law. None for a rigid body, and for a body that is not on the grid: its own solver checks it.
    fn look_at_body(&mut self, b: usize) -> Option<(f64, Wholeness, usize)> {
        let body = &self.scene.bodies[b];
        if body.rigid().is_some() || body.client().is_some_and(|client| !client.on_grid()) {
            return None;
        }
        self.cells();
        let mut cells = self.looks.cells.take()?;
        cells.clear();
        let mut beyond = 0;
        self.scene.bodies[b].for_each(&mut |p| {
            beyond += usize::from(!p.in_range);
            cells.add(p);
        });
        let reach = self.facts().nodes as i32 - 1;
        let found = (cells.unseen().0, cells.wholeness(reach), beyond);
        self.looks.cells = Some(cells);
        Some(found)
    }

    fn look_at_bodies(&mut self, watcher: &mut Watcher) {
        let clock = self.clock;
        for b in 0..self.scene.bodies.len() {
            let Some((_, whole, _)) = self.look_at_body(b) else { continue };
            let name = self.scene.bodies[b].name().to_string();
            let before = self.looks.parts.get(b).map_or(1, |&n| n as usize);
            // Weights of the reference configuration connect particles at any distance.
            let tears = !self.facts().total
                && self.scene.bodies[b].client().is_none()
                && self.scene.growing.iter().all(|(_, body)| *body != b)
                && self.scene.bodies[b].coheres();
            if tears && whole.parts > before && whole.whole_parts > before.saturating_sub(1) {
                let found =
                    Finding::Torn { body: name.clone(), parts: whole.parts, before, share: whole.share };
                watcher.warn_once(
                    &clock,
                    found,
                    |f| matches!(f, Finding::Torn { body, .. } if *body == name),
                );
            }
            if whole.failed >= FEW_FAILED && 2 * whole.alone > whole.failed {
                let Wholeness { failed, alone, position, .. } = whole;
                let found = Finding::LoneFailure { body: name.clone(), failed, alone, position };
                watcher.warn_once(
                    &clock,
                    found,
                    |f| matches!(f, Finding::LoneFailure { body, .. } if *body == name),
                );
            }
            let Alternation { pressure, whole, von_mises } = self.cells().alternation();
            if pressure > ALTERNATES * whole && pressure > ALTERNATES * von_mises {
                let found =
                    Finding::Locking { body: name.clone(), pressure, share: pressure / whole, von_mises };
                watcher.warn_once(
                    &clock,
                    found,
                    |f| matches!(f, Finding::Locking { body, .. } if *body == name),
                );
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::Stopped;
    use crate::{BlockGrid, Finding, Method, Mpm, PlaneStrain};
    use impactite_geometry::{Ball, Filling, Lattice, fill};
    use mpm_materials::{Moduli, NeoHookean};

    /// An impulse that no particle received, which a valid scene never books.
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
