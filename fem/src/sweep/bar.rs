//! Bars of two nodes, in uniaxial stress.
//!
//! Laws are three-dimensional. A bar finds the lateral strain at which the lateral stress vanishes by the secant method, always from the
//! state before the step. The first guess is the strain ratio of the last step, the first slope the elastic stiffness. The residual is
//! below a part in 1e10 of the moduli plus 1e-9 of the axial stress; no convergence in 40 iterations stops the run. Bars are few: the code
//! is scalar.

use super::batch::{Batch, GROUP, Left, OCTET, Reason, Record, Report, Row, Trouble, lane, lane_mut};
use super::work::{Leaving, Measure, Of, Pass, Scratch, Sweep};
use mpm_materials::Breakdown;

/// Maximum number of iterations for the lateral strain.
const ATTEMPTS: usize = 40;
/// Tolerance of the lateral stress, over the sum of the moduli, and over the axial stress.
const REMAINS: [f64; 2] = [1e-10, 1e-9];

/// Bars with the cross-section `section`, m^2 at rest (in two dimensions per metre of depth).
pub(super) struct Bar {
    pub section: f64,
}

/// Direction and lengths of a bar.
struct Line {
    /// Unit vector along the bar.
    along: [f64; 3],
    /// Length before the step and after it, m.
    lengths: [f64; 2],
}

fn line(batch: &Batch, scratch: &Scratch, e: usize, dt: f64) -> Line {
    let corner = |c: usize| batch.corners[(e / OCTET * 2 + c) * OCTET + e % OCTET] as usize;
    let (one, two) = (corner(0), corner(1));
    let mut now = [0.0; 3];
    let mut before = [0.0; 3];
    for d in 0..3 {
        let [a, b] = [one, two].map(|n| &scratch.moving[n].0);
        now[d] = b[d] - a[d];
        before[d] = now[d] - dt * (b[4 + d] - a[4 + d]);
    }
    let length = |v: &[f64; 3]| v.iter().map(|c| c * c).sum::<f64>().sqrt();
    let lengths = [length(&before), length(&now)];
    Line { along: now.map(|c| c / lengths[1]), lengths }
}

/// Secant iteration for the lateral strain of a bar.
#[derive(Clone, Copy, Default)]
struct Search {
    along: f64,
    across: f64,
    last: Option<[f64; 2]>,
    found: bool,
}

impl Bar {
    /// Compute axial strains, lateral strains at zero lateral stress, and states at the end of the step.
    fn strain(&self, of: &Of<'_>, batch: &mut Batch, scratch: &mut Scratch) {
        let count = batch.octets() * OCTET;
        let mut searches = vec![Search { found: true, ..Search::default() }; count];
        for (e, search) in searches.iter_mut().enumerate() {
            if !batch.alive(e, 1) {
                continue;
            }
            let [before, now] = line(batch, scratch, e, of.dt).lengths;
            if !(before > 0.0 && now > of.least * before) {
                batch.report.trouble = batch.report.trouble.or(Some((e, Trouble::Inverted)));
                continue;
            }
            let along = now / before - 1.0;
            let across = lane(&batch.kept[e / OCTET], e % OCTET) * along;
            *search = Search { along, across, last: None, found: false };
        }
        if batch.report.trouble.is_some() {
            return;
        }
        for octet in 0..batch.octets() {
            scratch.lengths[2 * octet..2 * octet + 2].copy_from_slice(&batch.sizes[octet][0].0);
        }
        scratch.before.clear();
        scratch.before.extend_from_slice(&batch.rows);
        let stiffness = 2.0 * of.probe.bulk + 2.0 / 3.0 * of.probe.shear;
        for _ in 0..ATTEMPTS {
            batch.rows.copy_from_slice(&scratch.before);
            for (e, search) in searches.iter().enumerate() {
                let to = &mut scratch.deformations[e / OCTET];
                for (place, strain) in [(0, search.along), (4, search.across), (8, search.across)] {
                    *lane_mut(&mut to.gradient[place], e % OCTET) = strain;
                }
                *lane_mut(&mut to.step, e % OCTET) = 1.0;
            }
            scratch.advance(of, &mut batch.rows, batch.sizes.len() * 2);
            for (e, search) in searches.iter_mut().enumerate() {
                let said = &scratch.response.outputs()[e / OCTET];
                let [along, across] = [0, 1].map(|i| lane(&said.stress[i], e % OCTET));
                search.next(of, stiffness, along, across);
            }
            if searches.iter().all(|s| s.found) {
                break;
            }
        }
        batch.report.trouble = scratch.first_fault(batch, 1);
        if let Some(e) = searches.iter().position(|s| !s.found) {
            batch.report.trouble = batch.report.trouble.or(Some((e, Trouble::Law(Breakdown::NotConverged))));
        }
        for (e, search) in searches.iter().enumerate().filter(|(_, s)| s.along != 0.0) {
            *lane_mut(&mut batch.kept[e / OCTET], e % OCTET) =
                (search.across / search.along).clamp(-1.0, 1.0);
        }
    }

    /// Assemble internal forces, and frequency bounds sqrt(2 rho c^2 A / (l m)) with the least nodal mass m.
    fn give(&self, of: &Of<'_>, batch: &mut Batch, scratch: &mut Scratch, slots: &mut [Record]) {
        slots.fill([0.0; 4]);
        batch.report.rate = 0.0;
        for e in 0..batch.elements {
            if !batch.alive(e, 1) {
                *lane_mut(&mut scratch.rates[e / OCTET], e % OCTET) = 0.0;
                continue;
            }
            let said = &scratch.response.outputs()[e / OCTET];
            let volume = lane(&batch.reference[e / OCTET], e % OCTET);
            let ratio = lane(&said.volume_ratio, e % OCTET);
            let line = line(batch, scratch, e, of.dt);
            let section = volume * ratio / line.lengths[1];
            let pull = lane(&said.stress[0], e % OCTET) * section;
            for (c, sign) in [(0, 1.0), (1, -1.0)] {
                let slot = &mut slots[batch.corners[(e / OCTET * 2 + c) * OCTET + e % OCTET] as usize];
                for d in 0..3 {
                    slot[d] += sign * pull * line.along[d];
                }
            }
            let speed = lane(&said.step_speed, e % OCTET);
            let modulus = of.probe.density / ratio * speed * speed;
            let mass = lane(&batch.sizes[e / OCTET][1], e % OCTET);
            let mut rate = 0.5 * (2.0 * modulus * section / (line.lengths[1] * mass)).sqrt();
            let [linear, quadratic] = of.probe.shock;
            let closing = (line.lengths[0] - line.lengths[1]).max(0.0) / of.dt.max(f64::MIN_POSITIVE);
            let viscous = if speed > 0.0 { (linear + quadratic * closing) / speed } else { 0.0 };
            rate *= viscous + (1.0 + viscous * viscous).sqrt();
            *lane_mut(&mut scratch.rates[e / OCTET], e % OCTET) = rate;
            batch.report.rate = batch.report.rate.max(rate);
        }
    }

    fn remove(&self, of: &Of<'_>, batch: &mut Batch, e: usize, reason: Reason) {
        let mut state = vec![0.0; of.numbers];
        batch.read(e, (0, 1), &mut state);
        let volume = std::mem::take(lane_mut(&mut batch.reference[e / OCTET], e % OCTET));
        let energy = volume * of.material.energy_of(&state).unwrap_or_default();
        batch.report.left.push(Left { element: e, energy, hourglass: 0.0, reason });
    }
}

impl Search {
    /// Check the lateral stress, and choose the next lateral strain.
    fn next(&mut self, of: &Of<'_>, stiffness: f64, along: f64, across: f64) {
        let allowed = REMAINS[0] * (of.probe.bulk + of.probe.shear) + REMAINS[1] * along.abs();
        if self.found || across.abs() <= allowed {
            self.found = true;
            return;
        }
        let secant = self.last.map(|[strain, stress]| (across - stress) / (self.across - strain));
        // Follow the secant slope of a softening law, but not one near zero or negative.
        let slope = secant.filter(|s| *s > 1e-3 * stiffness && s.is_finite()).unwrap_or(stiffness);
        self.last = Some([self.across, across]);
        self.across -= across / slope;
    }
}

impl Sweep for Bar {
    fn nodes(&self) -> usize {
        2
    }
    fn points(&self) -> usize {
        1
    }
    fn kept(&self) -> usize {
        1
    }

    fn sweep(
        &self,
        pass: Pass,
        of: &Of<'_>,
        batch: &mut Batch,
        scratch: &mut Scratch,
        slots: &mut [Record],
        leaving: Leaving<'_>,
    ) {
        scratch.fit(batch.octets(), 1);
        scratch.deformations.fill(Default::default());
        batch.report = Report::default();
        if pass == Pass::Force {
            let groups = batch.octets() * 2;
            scratch.describe(of, &batch.rows, groups);
        } else {
            self.strain(of, batch, scratch);
            if batch.report.trouble.is_some() {
                return;
            }
        }
        self.give(of, batch, scratch, slots);
        let gone = leaving(batch, scratch);
        if !gone.is_empty() {
            gone.into_iter().for_each(|(e, reason)| self.remove(of, batch, e, reason));
            self.give(of, batch, scratch, slots);
        }
    }

    fn measure(&self, corners: &[[f64; 3]]) -> Measure {
        let length = (0..3).map(|d| (corners[1][d] - corners[0][d]).powi(2)).sum::<f64>().sqrt();
        let volume = length * self.section;
        let shares = vec![0.5 * volume; 2];
        Measure { volumes: vec![volume], shares, size: length, half_edges: None }
    }
}

/// The rows of a batch are whole octets.
const _: () = assert!(OCTET == 2 * GROUP && size_of::<Row>() == 32);
