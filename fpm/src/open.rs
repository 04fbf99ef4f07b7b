//! Open face: cohesive traction while it softens, contact pressure and friction while it is closed.

use impactite_scene::{Archive, CheckpointError};

use crate::sides::{Sides, Surface};
use crate::sums::{Load, Trace, jump};
use crate::vector::{
    Tensor, add_dyad, along, difference, dot, identity, largest_row, norm, rotation, scaled,
};

/// Face that opened, or was open from the start.
///
/// Traction is a function of the opening, the displacement of the second side minus that of the first, rotated back by the mean rotation of
/// both cells: pieces of a crack may rotate together. For a face that softens between joined cells ([`crate::soften`]) the opening is a
/// separate variable; for others it is the distance between the trial functions.
#[derive(Clone, Copy, Debug)]
pub(crate) struct OpenFace<const D: usize> {
    /// Number of the face, and its cells, by place.
    pub face: u32,
    pub cells: [u32; 2],
    /// Surface as seen from the first cell.
    pub surface: Surface<D>,
    /// Time of opening, s; negative for a notch.
    pub opened: f64,
    /// Time of the loss of tension, s; negative for a face that carries tension.
    pub parted: f64,
    /// True if the face softens between joined cells.
    pub softens: bool,
    /// Normal opening at closure, m.
    closed: f64,
    /// Force at the onset of softening, N, opening at the loss of tension, and widest opening so far, m; zero for other faces.
    pub peak: f64,
    last: f64,
    widest: f64,
    /// For a cohesive face whose cells parted at the onset: origin of its opening, and its width at the onset, m; zero for others.
    origin: [f64; D],
    first: f64,
    /// Frictional slip, m.
    slipped: [f64; D],
    /// Opening at the end of the step, m, rotated back and not rotated.
    pub opening: [f64; D],
    pub apart: [f64; D],
    /// Force on the first cell, N; for a softening face the part of its opening in the penalty force.
    pub force: [f64; D],
    /// For a softening face: force between its cells, N, rotation of both, and opening at the start of the step, m.
    pull: [f64; D],
    turn: Tensor<D>,
    was: [f64; D],
    /// Stored energy, J.
    pub stored: f64,
    /// Dissipated energy and frictional work since opening, J.
    pub dissipated: f64,
    pub rubbed: f64,
}

/// Dissipation and frictional work of an open face in a step, J.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Taken {
    pub dissipated: f64,
    pub rubbed: f64,
}

impl<const D: usize> OpenFace<D> {
    /// Create an open face of a notch, with this contact modulus, Pa.
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

    /// Set the initial width, m.
    pub fn with_gap(self, gap: f64) -> Self {
        OpenFace { closed: -gap, ..self }
    }

    /// Open a face whose cells part now, under this force on the first of them, N, between these trial functions; with the work of an area,
    /// J/m^2, if it carries tension and shear from then on.
    pub fn opens(mut self, time: f64, force: &[f64; D], traces: [&Trace<D>; 2], work: Option<f64>) -> Self {
        self.opened = time;
        self.part(time, force, traces, work);
        self
    }

    /// Part the cells of a softened face: they are no longer neighbours.
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
        // Present contact pressure continues.
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

    /// Register the time of the loss of tension.
    fn notice(&mut self, time: f64) {
        if self.parted < 0.0 && self.opened >= 0.0 && self.broken() {
            self.parted = time;
        }
    }

    /// Begin to soften now, under this force between the cells, N, with the work of an area, J/m^2.
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

    /// Begin a step. Extrapolate the opening of a face without tension, which may be wide, so that few iterations are needed.
    pub fn go_on(&mut self) {
        let before = std::mem::replace(&mut self.was, self.apart);
        if self.broken() {
            self.apart = along(&scaled(&self.apart, 2.0), -1.0, &before);
        }
    }

    /// Update the rotation to that of the cells.
    pub fn turn(&mut self, turn: Tensor<D>) {
        self.turn = turn;
        if self.broken() {
            self.opening = self.turned_back(&self.apart);
        }
        self.follow();
    }

    /// Return the opening at the start of the step, rotated back.
    pub fn start(&self) -> [f64; D] {
        if self.broken() { self.turned_back(&self.was) } else { self.opening }
    }

    /// Tolerance of a residual force, N: `part` of the strength, less for a wide opening, which moves far.
    pub fn little(&self, part: f64) -> f64 {
        part * self.peak * self.last / self.last.max(norm(&self.opening))
    }

    /// Rotate a vector back by the rotation of the face.
    pub fn turned_back(&self, a: &[f64; D]) -> [f64; D] {
        back(&self.turn, a)
    }

    fn follow(&mut self) {
        self.apart = crate::vector::apply(&self.turn, &self.opening);
        self.force = scaled(&self.apart, -self.surface.stiffness);
    }

    /// Return the opening in balance with a force between the cells, N, that falls by `stiff`, N/m, with the opening; `start` is the
    /// opening at the start of the step.
    pub fn balanced(&self, start: &[f64; D], force: &[f64; D], stiff: f64, friction: f64) -> [f64; D] {
        let normal = scaled(&self.surface.area, 1.0 / norm(&self.surface.area));
        let mut trial = along(force, stiff, &self.opening);
        let pressed = dot(&trial, &normal);
        if pressed < 0.0 {
            // Closed: the material carries the pressure, and the face slides.
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

    /// Return the width at which the face carries a force minus `stiff` times the width.
    fn wide(&self, force: f64, stiff: f64) -> f64 {
        if self.broken() {
            return force / stiff;
        }
        if force <= stiff * self.widest + self.bears() {
            return if self.widest > 0.0 { force / (stiff + self.secant()) } else { 0.0 };
        }
        let falls = self.peak / self.last;
        let wide = (force - self.peak) / (stiff - falls);
        // Beyond, or if the face softens faster than the material unloads, it carries nothing.
        if stiff > falls && wide < self.last { wide } else { self.last.max(force / stiff) }
    }

    /// Force at the widest opening, N, and secant stiffness, N/m: zero for a face that has not opened yet.
    fn bears(&self) -> f64 {
        if self.broken() { 0.0 } else { self.peak * (1.0 - self.widest / self.last) }
    }
    fn secant(&self) -> f64 {
        if self.widest > 0.0 { self.bears() / self.widest } else { 0.0 }
    }

    /// Commit the opening.
    pub fn opened_further(&mut self) {
        self.widest = self.widest.max(norm(&self.opening));
        self.follow();
    }

    /// Return the dissipation of a step that ended at a time, s, with this force between the cells, N.
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

    /// Subtract the opening, as seen from one of its cells, from the gradient.
    pub fn take_from_gradient(&self, sides: &Sides<D>, end: u8, h: &mut Tensor<D>) {
        let cell = self.cells[end as usize] as usize;
        for s in sides.intact_of(cell) {
            if sides.face[s] == self.face {
                let sign = if end == 0 { -1.0 } else { 1.0 };
                add_dyad(h, sign, &self.apart, &sides.gradient[s]);
            }
        }
    }

    /// Return the change of half the penalty energy by the opening, J.
    pub fn off_the_penalty(&self, [a, b]: [&Trace<D>; 2]) -> f64 {
        let jump = jump(a, b, &self.surface);
        0.25 * self.surface.stiffness * (2.0 * dot(&jump, &self.apart) + dot(&self.apart, &self.apart))
    }

    /// Add the force to the load of one of its cells.
    pub fn load(&self, end: u8, load: &mut Load<D>) {
        if end == 0 {
            load.add(&self.force, &self.surface.own);
        } else {
            load.add(&self.force.map(|x| -x), &self.surface.other);
        }
    }

    /// Update the opening from the trial functions.
    fn look(&mut self, turn: &Tensor<D>, [a, b]: [&Trace<D>; 2]) {
        self.apart = scaled(&jump(a, b, &self.surface), -1.0);
        self.opening = back(turn, &self.apart);
    }

    /// Update the face between these trial functions at a time, s, with Coulomb friction; return the dissipation.
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

    /// Update the face after a jump of the trial functions of its cells, without motion.
    pub fn renew(&mut self, traces: [&Trace<D>; 2], friction: f64) {
        let turn = turned(traces);
        self.look(&turn, traces);
        self.bear(&turn, friction);
    }

    /// Initialise force and energy of an unopened notch between these trial functions.
    pub fn resume(&mut self, traces: [&Trace<D>; 2]) {
        if self.opened < 0.0 && self.opening == [0.0; D] {
            self.bear(&turned(traces), 0.0);
        }
    }

    /// Update force and energy at the present opening. Return the work of friction, J.
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

    /// True if the face carries nothing, and the trial functions of its cells rotated too far apart for one common rotation.
    pub fn strayed(&self, [a, b]: [&Trace<D>; 2]) -> bool {
        self.broken() && largest_row(&less(&a.h, &b.h)) > STRAYED
    }

    /// True if the face carries nothing unless it closes.
    pub fn broken(&self) -> bool {
        self.widest >= self.last
    }
    /// Dissipated part of the work, 0 to 1.
    pub fn damage(&self) -> f64 {
        if self.broken() { 1.0 } else { (self.widest - self.first) / (self.last - self.first) }
    }
    /// Normal and tangential opening, m.
    pub fn gap(&self) -> [f64; 2] {
        let normal = scaled(&self.surface.area, 1.0 / norm(&self.surface.area));
        let across = dot(&self.opening, &normal);
        [across, norm(&along(&self.opening, -across, &normal))]
    }

    /// Store the state in a checkpoint, or load it.
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

/// Largest row sum of the difference of gradients of two joined cells across a face without tension.
const STRAYED: f64 = 0.25;

fn less<const D: usize>(a: &Tensor<D>, b: &Tensor<D>) -> Tensor<D> {
    let mut c = *a;
    crate::vector::subtract(&mut c, 1.0, b);
    c
}

/// Return the mean rotation of two cells.
fn turned<const D: usize>([a, b]: [&Trace<D>; 2]) -> Tensor<D> {
    let mut mean = identity();
    for i in 0..D {
        for j in 0..D {
            mean[i][j] += 0.5 * (a.h[i][j] + b.h[i][j]);
        }
    }
    rotation(&mean)
}

/// Rotate a vector back.
fn back<const D: usize>(turn: &Tensor<D>, a: &[f64; D]) -> [f64; D] {
    let mut b = [0.0; D];
    for i in 0..D {
        for j in 0..D {
            b[i] += turn[j][i] * a[j];
        }
    }
    b
}
