//! An open face: what bears while it softens, and what presses and rubs where it closes.

use impactite_scene::{Archive, CheckpointError};

use crate::sides::{Sides, Surface};
use crate::sums::{Load, Trace, jump};
use crate::vector::{
    Tensor, add_dyad, along, difference, dot, identity, largest_row, norm, rotation, scaled,
};

/// A face that opened, or was open from the start.
///
/// Traction is a function of the opening, the displacement of the second side less that of the first, turned back with the mean of both
/// cells: pieces of a crack may turn together. While a face softens between cells that stay joined ([`crate::soften`]) the opening is a variable
/// of its own; of others it is how far trial functions are apart.
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
    /// Does it soften between cells that stay joined?
    pub softens: bool,
    /// The gap at which it is closed, m.
    closed: f64,
    /// Force at which it began to soften, N, the opening at which it bears nothing, and the widest it had, m; zero of others.
    pub peak: f64,
    last: f64,
    widest: f64,
    /// Of a cohesive face whose cells parted as it began to soften: where its opening counts from, and how wide it was then, m; zero of others.
    origin: [f64; D],
    first: f64,
    /// Slip that friction took, m.
    slipped: [f64; D],
    /// Opening at the end of the step, m, turned back and as it is.
    pub opening: [f64; D],
    pub apart: [f64; D],
    /// Force on the first cell, N: of one that softens what its opening takes off the penalty's.
    pub force: [f64; D],
    /// Of one that softens the force between its cells, N, the rotation of both, and the opening at the start of the step, m.
    pull: [f64; D],
    turn: Tensor<D>,
    was: [f64; D],
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
            softens: false,
            closed: 0.0,
            peak: 0.0,
            last: 0.0,
            widest: 0.0,
            origin: [0.0; D],
            first: 0.0,
            slipped: [0.0; D],
            opening: [0.0; D],
            apart: [0.0; D],
            force: [0.0; D],
            pull: [0.0; D],
            turn: identity(),
            was: [0.0; D],
            stored: 0.0,
            dissipated: 0.0,
            rubbed: 0.0,
        }
    }

    /// The same, so wide from the start, m.
    pub fn with_gap(self, gap: f64) -> Self {
        OpenFace { closed: -gap, ..self }
    }

    /// One whose cells part now, under this force on the first of them, N, between these trial functions; with the work of an area, J/m^2, if it
    /// bears tension and shear from then on.
    pub fn opens(mut self, time: f64, force: &[f64; D], traces: [&Trace<D>; 2], work: Option<f64>) -> Self {
        self.opened = time;
        self.part(time, force, traces, work);
        self
    }

    /// The same of one that softened: its cells see each other no more.
    pub fn parts(&mut self, time: f64, traces: [&Trace<D>; 2]) {
        let pull = self.pull;
        self.softens = false;
        self.part(time, &pull, traces, None);
    }

    fn part(&mut self, time: f64, force: &[f64; D], traces: [&Trace<D>; 2], work: Option<f64>) {
        let turn = turned(traces);
        let (area, k) = (norm(&self.surface.area), self.surface.stiffness);
        let normal = scaled(&self.surface.area, 1.0 / area);
        self.look(&turn, traces);
        let (opening, pull) = (self.opening, back(&turn, force));
        let (across, pressed) = (dot(&opening, &normal), dot(&pull, &normal).min(0.0));
        // What presses it now goes on to do so.
        self.closed = across.min(if pressed < 0.0 { f64::INFINITY } else { 0.0 }) - pressed / k;
        self.slipped = along(&opening, -across, &normal);
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
        self.notice(time);
    }

    /// Note when it began to bear nothing.
    fn notice(&mut self, time: f64) {
        if self.parted < 0.0 && self.opened >= 0.0 && self.broken() {
            self.parted = time;
        }
    }

    /// One that begins to soften now, under this force between its cells, N, with the work of an area, J/m^2.
    pub fn begins(mut self, time: f64, force: &[f64; D], traces: [&Trace<D>; 2], work: f64) -> Self {
        self.opened = time;
        self.softens = true;
        self.turn = turned(traces);
        self.pull = *force;
        let area = norm(&self.surface.area);
        let normal = scaled(&self.surface.area, 1.0 / area);
        let pull = self.turned_back(force);
        let bears = along(&pull, -dot(&pull, &normal).min(0.0), &normal);
        self.peak = norm(&bears);
        self.last = 2.0 * work * area / self.peak;
        self
    }

    /// Begin a step: the opening of what bears nothing any more, which may be wide, goes on as it did, so that little is left to be found.
    pub fn go_on(&mut self) {
        let before = std::mem::replace(&mut self.was, self.apart);
        if self.broken() {
            self.apart = along(&scaled(&self.apart, 2.0), -1.0, &before);
        }
    }

    /// Turn on with its cells.
    pub fn turn(&mut self, turn: Tensor<D>) {
        self.turn = turn;
        if self.broken() {
            self.opening = self.turned_back(&self.apart);
        }
        self.follow();
    }

    /// The opening at the start of the step, turned back.
    pub fn start(&self) -> [f64; D] {
        if self.broken() { self.turned_back(&self.was) } else { self.opening }
    }

    /// What is left of a force that is too little to go on for, over `part` of the strength, N: less where it is wide open and moves far.
    pub fn little(&self, part: f64) -> f64 {
        part * self.peak * self.last / self.last.max(norm(&self.opening))
    }

    /// A vector turned back as they are.
    pub fn turned_back(&self, a: &[f64; D]) -> [f64; D] {
        back(&self.turn, a)
    }

    fn follow(&mut self) {
        self.apart = crate::vector::apply(&self.turn, &self.opening);
        self.force = scaled(&self.apart, -self.surface.stiffness);
    }

    /// The opening at which it bears what is left of a force between its cells, N, that falls by `stiff`, N/m, with the opening, from
    /// that at the start of the step.
    pub fn balanced(&self, start: &[f64; D], force: &[f64; D], stiff: f64, friction: f64) -> [f64; D] {
        let normal = scaled(&self.surface.area, 1.0 / norm(&self.surface.area));
        let mut trial = along(force, stiff, &self.opening);
        let pressed = dot(&trial, &normal);
        if pressed < 0.0 {
            // It is closed, and matter bears across it; what is left slides.
            trial = along(&trial, -pressed, &normal);
            if friction > 0.0 {
                let slip = along(start, -dot(start, &normal), &normal);
                let moves = along(&trial, -stiff - self.secant(), &slip);
                let (amount, limit) = (norm(&moves), -friction * pressed);
                if amount <= limit {
                    return slip;
                }
                trial = along(&trial, -limit / amount, &moves);
            }
        }
        let amount = norm(&trial);
        let wide = self.wide(amount, stiff);
        if wide > 0.0 { scaled(&trial, wide / amount) } else { [0.0; D] }
    }

    /// How wide it is where it bears what `stiff` times that leaves of a force.
    fn wide(&self, force: f64, stiff: f64) -> f64 {
        if self.broken() {
            return force / stiff;
        }
        if force <= stiff * self.widest + self.bears() {
            return if self.widest > 0.0 { force / (stiff + self.secant()) } else { 0.0 };
        }
        let falls = self.peak / self.last;
        let wide = (force - self.peak) / (stiff - falls);
        // Beyond, or where it falls faster than matter gives way, it bears nothing.
        if stiff > falls && wide < self.last { wide } else { self.last.max(force / stiff) }
    }

    /// What it bears at the widest, N, and over that, N/m: zero of one that has not opened yet.
    fn bears(&self) -> f64 {
        if self.broken() { 0.0 } else { self.peak * (1.0 - self.widest / self.last) }
    }
    fn secant(&self) -> f64 {
        if self.widest > 0.0 { self.bears() / self.widest } else { 0.0 }
    }

    /// Keep the opening as it is.
    pub fn opened_further(&mut self) {
        self.widest = self.widest.max(norm(&self.opening));
        self.follow();
    }

    /// What it took in a step that ended at a time, s, with this force between its cells, N.
    pub fn takes(&mut self, time: f64, force: &[f64; D], friction: f64) -> Taken {
        self.notice(time);
        let change = difference(&self.apart, &self.was);
        let work = 0.5 * (dot(&self.pull, &change) + dot(force, &change));
        self.pull = *force;
        let wide = norm(&self.opening);
        let stored = 0.5 * self.secant() * wide * wide;
        let normal = scaled(&self.surface.area, 1.0 / norm(&self.surface.area));
        let pressed = dot(&self.turned_back(force), &normal).min(0.0);
        let slip = self.turned_back(&change);
        let rubbed = -friction * pressed * norm(&along(&slip, -dot(&slip, &normal), &normal));
        let taken = Taken { dissipated: work - (stored - self.stored) - rubbed, rubbed };
        self.stored = stored;
        self.dissipated += taken.dissipated;
        self.rubbed += rubbed;
        taken
    }

    /// Take what one of its cells sees of its opening off the gradient.
    pub fn take_from_gradient(&self, sides: &Sides<D>, end: u8, h: &mut Tensor<D>) {
        let cell = self.cells[end as usize] as usize;
        for s in sides.intact_of(cell) {
            if sides.face[s] == self.face {
                let sign = if end == 0 { -1.0 } else { 1.0 };
                add_dyad(h, sign, &self.apart, &sides.gradient[s]);
            }
        }
    }

    /// What its opening changes of half the energy of the penalty, J.
    pub fn off_the_penalty(&self, [a, b]: [&Trace<D>; 2]) -> f64 {
        let jump = jump(a, b, &self.surface);
        0.25 * self.surface.stiffness * (2.0 * dot(&jump, &self.apart) + dot(&self.apart, &self.apart))
    }

    /// What it does to one of its cells.
    pub fn load(&self, end: u8, load: &mut Load<D>) {
        if end == 0 {
            load.add(&self.force, &self.surface.own);
        } else {
            load.add(&self.force.map(|x| -x), &self.surface.other);
        }
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
        self.notice(time);
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

    /// Did trial functions of its cells turn so far from each other that one rotation does not stand for both any more?
    pub fn strayed(&self, [a, b]: [&Trace<D>; 2]) -> bool {
        self.broken() && largest_row(&less(&a.h, &b.h)) > STRAYED
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
        let vectors = [
            &mut self.origin,
            &mut self.slipped,
            &mut self.opening,
            &mut self.apart,
            &mut self.was,
            &mut self.force,
            &mut self.pull,
        ];
        file.flag(&mut self.softens)?;
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

/// The largest sum of a row of the difference of gradients of two cells that see each other across a face that bears nothing.
const STRAYED: f64 = 0.25;

fn less<const D: usize>(a: &Tensor<D>, b: &Tensor<D>) -> Tensor<D> {
    let mut c = *a;
    crate::vector::subtract(&mut c, 1.0, b);
    c
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
