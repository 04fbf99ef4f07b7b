//! An open face: what a crack bears, and what presses and rubs where it closes.

use impactite_scene::{Archive, CheckpointError};

use crate::sides::Surface;
use crate::sums::{Trace, jump};
use crate::vector::{Tensor, along, difference, dot, identity, norm, rotation, scaled};

/// A face that opened, or was open from the start.
///
/// Traction is a function of the opening w, the displacement of the second side less that of the first, turned back with the mean of both
/// cells: pieces of a crack may turn together.
#[derive(Clone, Copy, Debug)]
pub(crate) struct OpenFace<const D: usize> {
    /// Number of the face, and its cells, by place.
    pub face: u32,
    pub cells: [u32; 2],
    /// As the first cell sees it.
    pub surface: Surface<D>,
    /// When it opened, s; negative of a notch.
    pub opened: f64,
    /// When it began to bear nothing, s; negative of one that bears.
    pub parted: f64,
    /// The gap at which it is closed, m.
    closed: f64,
    /// The opening at which a cohesive face bears nothing, and the widest it had, m; zero of others.
    origin: [f64; D],
    first: f64,
    last: f64,
    peak: f64,
    widest: f64,
    /// Slip that friction took, m.
    slipped: [f64; D],
    /// Opening at the end of the step, m, turned back and as it is, and force on the first cell, N.
    opening: [f64; D],
    apart: [f64; D],
    pub force: [f64; D],
    /// Energy that it holds, J.
    pub stored: f64,
    /// Since it opened, J.
    pub dissipated: f64,
    pub rubbed: f64,
}

/// What an open face takes in a step, J.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Taken {
    pub dissipated: f64,
    pub rubbed: f64,
}

impl<const D: usize> OpenFace<D> {
    /// Of a notch, with this modulus for what presses it, Pa.
    pub fn notch(face: u32, cells: [u32; 2], mut surface: Surface<D>, modulus: f64) -> Self {
        surface.stiffness = norm(&surface.area) * modulus / surface.apart();
        OpenFace {
            face,
            cells,
            surface,
            opened: -1.0,
            parted: -1.0,
            closed: 0.0,
            origin: [0.0; D],
            first: 0.0,
            last: 0.0,
            peak: 0.0,
            widest: 0.0,
            slipped: [0.0; D],
            opening: [0.0; D],
            apart: [0.0; D],
            force: [0.0; D],
            stored: 0.0,
            dissipated: 0.0,
            rubbed: 0.0,
        }
    }

    /// The same, so wide from the start, m.
    pub fn with_gap(self, gap: f64) -> Self {
        OpenFace { closed: -gap, ..self }
    }

    /// One that opens now, under this force on its first cell, N, between these trial functions; with the work of an area of crack, J/m^2,
    /// if it is cohesive.
    pub fn opens(mut self, time: f64, force: &[f64; D], traces: [&Trace<D>; 2], work: Option<f64>) -> Self {
        self.opened = time;
        let turn = turned(traces);
        let (area, k) = (norm(&self.surface.area), self.surface.stiffness);
        let normal = scaled(&self.surface.area, 1.0 / area);
        self.look(&turn, traces);
        let (opening, pull) = (self.opening, back(&turn, force));
        let (across, pressed) = (dot(&opening, &normal), dot(&pull, &normal).min(0.0));
        // What presses it now goes on to do so.
        self.closed = across.min(if pressed < 0.0 { f64::INFINITY } else { 0.0 }) - pressed / k;
        let slip = along(&opening, -across, &normal);
        self.slipped = slip;
        if let Some(work) = work {
            let bears = along(&pull, -pressed, &normal);
            self.peak = norm(&bears);
            self.first = self.peak / k;
            self.last = self.first + 2.0 * work * area / self.peak;
            self.widest = self.first;
            self.origin = along(&opening, -1.0 / k, &bears);
            if pressed == 0.0 {
                self.closed = dot(&self.origin, &normal);
            }
        }
        self.bear(&turn, 0.0);
        if self.broken() {
            self.parted = time;
        }
        self
    }

    /// How far the second side is from the first.
    fn look(&mut self, turn: &Tensor<D>, [a, b]: [&Trace<D>; 2]) {
        self.apart = scaled(&jump(a, b, &self.surface), -1.0);
        self.opening = back(turn, &self.apart);
    }

    /// What it bears between these trial functions at a time, s, with Coulomb friction.
    pub fn step(&mut self, time: f64, traces: [&Trace<D>; 2], friction: f64) -> Taken {
        let (before, force, stored) = (self.apart, self.force, self.stored);
        let turn = turned(traces);
        self.look(&turn, traces);
        let rubbed = self.bear(&turn, friction);
        let mut work = 0.0;
        for d in 0..D {
            work += 0.5 * (force[d] + self.force[d]) * (self.apart[d] - before[d]);
        }
        if self.parted < 0.0 && self.opened >= 0.0 && self.broken() {
            self.parted = time;
        }
        let taken = Taken { dissipated: work - (self.stored - stored) - rubbed, rubbed };
        self.dissipated += taken.dissipated;
        self.rubbed += rubbed;
        taken
    }

    /// The same between other trial functions of its cells, which changed at once: nothing moved.
    pub fn renew(&mut self, traces: [&Trace<D>; 2], friction: f64) {
        let turn = turned(traces);
        self.look(&turn, traces);
        self.bear(&turn, friction);
    }

    /// Begin, or go on, between these trial functions: force and energy at the opening as it is.
    pub fn resume(&mut self, traces: [&Trace<D>; 2]) {
        if self.opened < 0.0 && self.opening == [0.0; D] {
            self.bear(&turned(traces), 0.0);
        }
    }

    /// Force and energy at the opening as it is. Returns the work of friction, J.
    fn bear(&mut self, turn: &Tensor<D>, friction: f64) -> f64 {
        let k = self.surface.stiffness;
        let normal = scaled(&self.surface.area, 1.0 / norm(&self.surface.area));
        let across = dot(&self.opening, &normal);
        let slip = along(&self.opening, -across, &normal);
        let (mut pull, mut rubbed) = ([0.0; D], 0.0);
        self.stored = 0.0;
        if self.peak > 0.0 && !self.broken() {
            let mut apart = difference(&self.opening, &self.origin);
            let shut = dot(&apart, &normal).min(0.0);
            apart = along(&apart, -shut, &normal);
            let wide = norm(&apart);
            self.widest = self.widest.max(wide);
            if !self.broken() {
                let bears = self.peak * (self.last - self.widest) / (self.last - self.first);
                let secant = bears / self.widest;
                pull = scaled(&apart, secant);
                self.stored += 0.5 * secant * wide * wide;
            }
        }
        let shut = self.closed - across;
        if shut > 0.0 {
            pull = along(&pull, -k * shut, &normal);
            self.stored += 0.5 * k * shut * shut;
            let trial = scaled(&difference(&slip, &self.slipped), k);
            let (amount, limit) = (norm(&trial), friction * k * shut);
            let share = if amount > limit { limit / amount } else { 1.0 };
            let held = scaled(&trial, share);
            pull = along(&pull, 1.0, &held);
            self.stored += 0.5 * dot(&held, &held) / k;
            let slips = (amount - limit).max(0.0) / k;
            rubbed = limit * slips;
            self.slipped = along(&slip, -1.0 / k, &held);
        } else {
            self.slipped = slip;
        }
        self.force = crate::vector::apply(turn, &pull);
        rubbed
    }

    /// Does it bear nothing, unless it closes?
    pub fn broken(&self) -> bool {
        self.widest >= self.last
    }
    /// The part of its work that it took, 0 to 1.
    pub fn damage(&self) -> f64 {
        if self.broken() { 1.0 } else { (self.widest - self.first) / (self.last - self.first) }
    }
    /// How far it is open, across and along, m.
    pub fn gap(&self) -> [f64; 2] {
        let normal = scaled(&self.surface.area, 1.0 / norm(&self.surface.area));
        let across = dot(&self.opening, &normal);
        [across, norm(&along(&self.opening, -across, &normal))]
    }

    /// What changes, to a file or from one.
    pub fn archive(&mut self, file: &mut Archive) -> Result<(), CheckpointError> {
        let vectors =
            [&mut self.origin, &mut self.slipped, &mut self.opening, &mut self.apart, &mut self.force];
        file.reals(vectors.into_iter().flatten())?;
        file.reals([
            &mut self.opened,
            &mut self.parted,
            &mut self.closed,
            &mut self.first,
            &mut self.last,
            &mut self.peak,
            &mut self.widest,
            &mut self.stored,
            &mut self.dissipated,
            &mut self.rubbed,
        ])
    }
}

/// The rotation of the mean of two cells.
fn turned<const D: usize>([a, b]: [&Trace<D>; 2]) -> Tensor<D> {
    let mut mean = identity();
    for i in 0..D {
        for j in 0..D {
            mean[i][j] += 0.5 * (a.h[i][j] + b.h[i][j]);
        }
    }
    rotation(&mean)
}

/// A vector turned back.
fn back<const D: usize>(turn: &Tensor<D>, a: &[f64; D]) -> [f64; D] {
    let mut b = [0.0; D];
    for i in 0..D {
        for j in 0..D {
            b[i] += turn[j][i] * a[j];
        }
    }
    b
}
