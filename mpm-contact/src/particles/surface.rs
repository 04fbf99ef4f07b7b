//! Surfaces of bodies as points with normals, and contact of such points with the surface of another body.
//!
//! A surface point s is beyond a particle, where the volumes of the body end. It moves with a linear combination of particles, u = sum_k
//! W_k v_k, and an impulse J on it acts on particle k by W_k J: with sum_k W_k = 1 and sum_k W_k x_k = s momentum and angular momentum are
//! those of J at s. The surface of the other body is interpolated between its points,
//!
//! ```text
//! x = sum_j w_j s_j,   sum_j w_j = 1,   sum_j w_j (s_j - s) = g n
//! ```
//!
//! by moving least squares with weights that are singular at the points, so that x is on the line through s along the normal n, at the gap
//! g: the normal impulses on both bodies have the same line of action.

use std::ops::Range;

use impactite_scene::{Booking, Boundaries, Boundary, Exchange};

use super::body::{ParticleBody, SurfacePoint};
use super::candidates::Candidates;
use super::member::{Member, Place};
use super::met::{Met, PairOfParticles};
use super::system::{Mover, Row, SurfaceTouch, System};
use crate::friction::Coulomb;
use crate::law::{Contact, Pairs};
use crate::vector::{difference, dot, length, sum, times, unit, wide};

/// Largest cosine between the normals of two facing surfaces.
const OPPOSED: f64 = -0.3;
/// Radius of interpolation on the surface of the other body, in spacings.
const PATCH: f64 = 1.8;
/// Largest distance along the surface to its nearest point, in spacings: half the diagonal of a square, with a margin.
const BESIDE: f64 = 0.75;
/// Largest sum of the absolute weights: it is 3 at half a spacing outside the corner of a square of points. Beyond it the points are so
/// nearly collinear that weights of a mean are used.
const LARGEST: f64 = 3.2;
/// Least weight of a point between its interpolation points.
const WITHIN: f64 = -0.1;
/// Distance of two particles of different bodies, in sums of radii, below which they are in contact as balls: for surfaces so ragged that
/// particles passed through.
const CORE: f64 = 0.6;
/// Largest depth of a point in the other body, in spacings: deeper points belong to another face.
const DEEPEST: f64 = 1.0;
/// Regularisation of the interpolation: squared distance at which its singularity ends, in squared spacings.
const ROUNDED: f64 = 1e-3;
/// Gap up to which laws that pull act, in spacings.
pub(super) const BOND: f64 = 0.1;
/// Part of an overlap with a rigid plane that is corrected in a step.
const RETURN: f64 = 0.1;

/// Surface point of a particle, with the particle's size.
#[derive(Clone, Copy, Debug)]
struct Sample {
    point: SurfacePoint,
    place: Place,
    spacing: f64,
    velocity: [f64; 3],
}

/// Append the surface points of a particle of a body without a surface of its own: the one at the particle, or a ball.
fn of_facing<const D: usize>(part: &dyn ParticleBody<D>, n: usize, out: &mut Vec<SurfacePoint>) {
    if !part.may_touch(n) {
        return;
    }
    let (p, facing) = (part.particle(n), part.facing(n));
    let position = wide(&p.position);
    if facing.lone {
        out.push(SurfacePoint { position, reach: p.radius, corner: true, ..SurfacePoint::default() });
    } else if let Some(normal) = unit(facing.area) {
        let position = sum(position, times(normal, part.beyond(n)));
        out.push(SurfacePoint { position, normal, area: length(facing.area), corner: false, reach: 0.0 });
    }
}

/// Compute the weights that interpolate a point at the origin between points at tangential places: sum w = 1, sum w t = 0 as far as the
/// points span the tangent plane. Returns false if there are none near.
fn interpolate(points: &[([f64; 3], f64)], normal: [f64; 3], spacing: f64, out: &mut Vec<f64>) -> bool {
    out.clear();
    let square = spacing * spacing;
    let (mut all, mut mean, mut nearest) = (0.0, [0.0; 3], f64::INFINITY);
    for (t, _) in points {
        let q = dot(*t, *t) / square;
        nearest = nearest.min(q);
        let fall = (1.0 - q / (PATCH * PATCH)).max(0.0);
        let weight = fall * fall / (q + ROUNDED);
        out.push(weight);
        all += weight;
        mean = sum(mean, times(*t, weight));
    }
    if all <= 0.0 {
        return false;
    }
    mean = times(mean, 1.0 / all);
    // Second moments about the mean, in the tangent plane.
    let mut m = [[0.0; 3]; 3];
    let mut trace = 0.0;
    for ((t, _), weight) in points.iter().zip(&*out) {
        let c = difference(*t, mean);
        trace += weight * dot(c, c);
        (0..3).for_each(|a| (0..3).for_each(|b| m[a][b] += weight * c[a] * c[b]));
    }
    let slope =
        if trace <= 1e-9 * all * square { [0.0; 3] } else { times(solve(m, trace, normal, mean), -1.0) };
    let linear = |t: [f64; 3]| 1.0 / all + dot(difference(t, mean), slope);
    let size: f64 = points.iter().zip(&*out).map(|((t, _), weight)| (weight * linear(*t)).abs()).sum();
    for ((t, _), weight) in points.iter().zip(out.iter_mut()) {
        *weight *= if size <= LARGEST { linear(*t) } else { 1.0 / all };
    }
    if nearest <= BESIDE * BESIDE {
        return true;
    }
    // A point farther off must be between the points.
    let mut off = [0.0; 3];
    points.iter().zip(&*out).for_each(|((t, _), weight)| off = sum(off, times(*t, *weight)));
    dot(off, off) <= ROUNDED * square && out.iter().all(|weight| *weight >= WITHIN)
}

/// Solve M y = b in the tangent plane of a normal, M of rank 1 or 2 there with this trace; for rank 1 along its range.
fn solve(m: [[f64; 3]; 3], trace: f64, normal: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    // Two directions in the tangent plane.
    let least = (0..3).min_by(|a, c| normal[*a].abs().total_cmp(&normal[*c].abs())).unwrap_or(0);
    let mut e = [0.0; 3];
    e[least] = 1.0;
    let e = unit(difference(e, times(normal, normal[least]))).unwrap_or(e);
    let f = cross(normal, e);
    let of = |x: [f64; 3]| -> [f64; 3] { std::array::from_fn(|a| dot(m[a], x)) };
    let (me, mf) = (of(e), of(f));
    let (ee, ef, ff) = (dot(e, me), dot(e, mf), dot(f, mf));
    let (be, bf) = (dot(b, e), dot(b, f));
    let det = ee * ff - ef * ef;
    if det > 1e-2 * trace * trace {
        let (x, y) = ((ff * be - ef * bf) / det, (ee * bf - ef * be) / det);
        return sum(times(e, x), times(f, y));
    }
    // Collinear points: along the greater column.
    let line = if ee >= ff { me } else { mf };
    let Some(line) = unit(line) else { return [0.0; 3] };
    times(line, dot(b, line) / trace)
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// Contact of a surface point with the surface of another body, or a plane.
struct Meeting {
    slave: usize,
    /// Samples of the other body with their weights; empty for a wall.
    masters: Range<usize>,
    wall: Option<u32>,
    /// Normal from the point to the other body.
    normal: [f64; 3],
    gap: f64,
    /// Spacing of the other surface, m; zero for balls.
    spacing: f64,
}

impl Meeting {
    /// True for two particles as balls.
    fn is_of_balls(&self) -> bool {
        self.spacing == 0.0
    }
}

/// Surface points near contacts in a step.
struct Near<'a, const D: usize> {
    candidates: &'a Candidates,
    samples: Vec<Sample>,
    /// Samples of each near place.
    ranges: Vec<Range<usize>>,
    /// Near particles, as balls.
    cores: Vec<Option<Sample>>,
}

impl<const D: usize> Near<'_, D> {
    fn find<'a>(members: &mut [Member<D>], candidates: &'a Candidates) -> Near<'a, D> {
        for of_body in candidates.near.chunk_by(|a, b| a.body == b.body) {
            if let Member::Body { part, .. } = &mut members[of_body[0].body as usize]
                && part.has_surface()
            {
                let list: Vec<usize> = of_body.iter().map(|p| p.particle as usize).collect();
                part.find_surface(&list);
            }
        }
        let mut near = Near { candidates, samples: Vec::new(), ranges: Vec::new(), cores: Vec::new() };
        let mut points = Vec::new();
        for place in &candidates.near {
            let first = near.samples.len();
            near.cores.push(members[place.body as usize].part().map(|part| {
                let n = place.particle as usize;
                points.clear();
                if part.has_surface() {
                    part.surface(n, &mut points)
                } else {
                    of_facing(part, n, &mut points)
                }
                let p = part.particle(n);
                let sample = |point: SurfacePoint| Sample {
                    point,
                    place: *place,
                    spacing: 2.0 * p.radius,
                    velocity: wide(&p.velocity),
                };
                near.samples.extend(points.iter().map(|point| sample(*point)));
                let position = wide(&p.position);
                sample(SurfacePoint {
                    position,
                    reach: CORE * p.radius,
                    corner: true,
                    ..SurfacePoint::default()
                })
            }));
            near.ranges.push(first..near.samples.len());
        }
        near
    }

    /// Find all points with the bodies or walls of possible contact in the step. Weights of masters are appended to `weights`.
    fn meetings(&mut self, members: &[Member<D>], dt: f64, weights: &mut Vec<(u32, f64)>) -> Vec<Meeting> {
        let mut found = Vec::new();
        self.balls(dt, weights, &mut found);
        for (p, own) in self.ranges.iter().enumerate().filter(|(_, own)| !own.is_empty()) {
            let others = self.candidates.others(p);
            for of_body in others.chunk_by(|a, b| self.body(*a) == self.body(*b)) {
                for slave in own.clone() {
                    match &members[self.body(of_body[0]) as usize] {
                        Member::Wall { wall } => {
                            let s = &self.samples[slave];
                            let (normal, x) = (times(wall.normal(), -1.0), s.point.position);
                            if s.point.reach == 0.0 && dot(normal, s.point.normal) <= 0.0 {
                                continue;
                            }
                            let place: [f64; D] = std::array::from_fn(|d| x[d]);
                            let gap = wall.height(&place) - s.point.reach;
                            let wall = Some(self.body(of_body[0]));
                            let spacing = s.spacing;
                            found.push(Meeting { slave, masters: 0..0, wall, normal, gap, spacing });
                        }
                        Member::Body { .. } => found.extend(self.meeting(slave, of_body, dt, weights)),
                    }
                }
            }
        }
        found
    }

    /// Find particles so near to each other that one passed through the surface of the other's body.
    fn balls(&mut self, dt: f64, weights: &mut Vec<(u32, f64)>, found: &mut Vec<Meeting>) {
        for (p, one) in self.cores.iter().enumerate() {
            let Some(one) = one else { continue };
            for &q in self.candidates.others(p).iter().filter(|q| **q as usize > p) {
                let Some(two) = &self.cores[q as usize] else { continue };
                let apart = difference(two.point.position, one.point.position);
                let reach = one.point.reach + two.point.reach;
                let closing = length(difference(one.velocity, two.velocity));
                let square = dot(apart, apart);
                if square > (reach + closing * dt).powi(2) {
                    continue;
                }
                let Some(normal) = unit(apart) else { continue };
                let slave = self.samples.len();
                self.samples.extend([*one, *two]);
                let first = weights.len();
                weights.push((slave as u32 + 1, 1.0));
                let gap = square.sqrt() - reach;
                let masters = first..weights.len();
                found.push(Meeting { slave, masters, wall: None, normal, gap, spacing: 0.0 });
            }
        }
    }

    fn body(&self, p: u32) -> u32 {
        self.candidates.near[p as usize].body
    }

    fn meeting(
        &self,
        slave: usize,
        others: &[u32],
        dt: f64,
        weights: &mut Vec<(u32, f64)>,
    ) -> Option<Meeting> {
        let s = &self.samples[slave];
        let ball = s.point.reach > 0.0;
        // Facing points, and their mean normal.
        let mut facing: Vec<(usize, [f64; 3])> = Vec::new();
        let (mut normal, mut spacing) = ([0.0; 3], 0.0f64);
        for q in others.iter().flat_map(|q| self.ranges[*q as usize].clone()) {
            let m = &self.samples[q];
            if m.point.corner || (!ball && dot(m.point.normal, s.point.normal) > OPPOSED) {
                continue;
            }
            let apart = difference(m.point.position, s.point.position);
            let q2 = dot(apart, apart) / (m.spacing * m.spacing);
            if q2 < 6.0 {
                facing.push((q, apart));
                spacing = spacing.max(m.spacing);
                normal = sum(normal, times(m.point.normal, 1.0 / (q2 * q2 + 0.1)));
            }
        }
        // Direction from the point to the body.
        let mut normal = times(unit(normal)?, -1.0);
        if !s.point.corner {
            normal = unit(sum(normal, s.point.normal))?;
        }
        let mut tangential: Vec<([f64; 3], f64)> = Vec::new();
        let first = weights.len();
        for (q, apart) in facing {
            let (m, along) = (&self.samples[q], dot(apart, normal));
            let t = difference(apart, times(normal, along));
            if dot(t, t) >= (PATCH * spacing).powi(2) || along.abs() > 1.5 * DEEPEST * spacing {
                continue;
            }
            // Keep points of the other body that have this point in front of them, or not deep inside.
            if dot(apart, m.point.normal) > DEEPEST * spacing {
                continue;
            }
            tangential.push((t, along));
            weights.push((q as u32, 0.0));
        }
        let mut of = Vec::new();
        if tangential.is_empty() || !interpolate(&tangential, normal, spacing, &mut of) {
            weights.truncate(first);
            return None;
        }
        let mut gap = -s.point.reach;
        let mut other = [0.0; 3];
        for (((_, along), weight), to) in tangential.iter().zip(&of).zip(&mut weights[first..]) {
            gap += weight * along;
            other = sum(other, times(self.samples[to.0 as usize].velocity, *weight));
            to.1 = *weight;
        }
        let closing = length(difference(s.velocity, other));
        if gap < -DEEPEST * spacing || gap > 3.0 * closing * dt + BOND * spacing {
            weights.truncate(first);
            return None;
        }
        Some(Meeting { slave, masters: first..weights.len(), wall: None, normal, gap, spacing })
    }
}

/// Movers of a step, numbered on first use.
#[derive(Default)]
struct Movers {
    system: System,
    of: std::collections::HashMap<Place, u32>,
    places: Vec<Place>,
    start: Vec<[f64; 3]>,
    trial: Vec<[f64; 3]>,
    mass: Vec<f64>,
}

impl Movers {
    fn number<const D: usize>(&mut self, part: &dyn ParticleBody<D>, start: [f64; D], place: Place) -> u32 {
        if let Some(&number) = self.of.get(&place) {
            return number;
        }
        let (n, number) = (place.particle as usize, self.places.len() as u32);
        let (p, held) = (part.particle(n), part.held(n));
        let (start, trial) = (wide(&start), wide(&p.velocity));
        self.system.movers.push(Mover {
            velocity: std::array::from_fn(|d| if held[d] { start[d] } else { trial[d] }),
            inverse: held.map(|held| if held { 0.0 } else { 1.0 / p.mass }),
        });
        self.of.insert(place, number);
        self.places.push(place);
        self.start.push(start);
        self.trial.push(trial);
        self.mass.push(p.mass);
        number
    }

    /// Append the movers of a weighted sum of surface points, all shifted by `beyond` (m).
    fn row<const D: usize>(
        &mut self,
        part: &dyn ParticleBody<D>,
        start: &dyn Fn(usize) -> [f64; D],
        body: u32,
        points: &[(&Sample, f64)],
        beyond: [f64; 3],
    ) -> Row {
        let mut entries: Vec<(u32, [f64; 3])> = Vec::new();
        for (sample, weight) in points {
            let n = sample.place.particle as usize;
            let point = SurfacePoint { position: sum(sample.point.position, beyond), ..sample.point };
            part.carriers(n, &point, &mut |k, share| {
                let at = Place { body, particle: k as u32 };
                let number = self.number(part, start(k), at);
                entries.push((number, times(share, *weight)));
            });
        }
        entries.sort_by_key(|entry| entry.0);
        let pool = &mut self.system.pool;
        let first = pool.len();
        for (number, share) in entries {
            match pool[first..].last_mut() {
                Some(last) if last.0 == number => last.1 = sum(last.1, share),
                _ => pool.push((number, share)),
            }
        }
        first..pool.len()
    }

    /// Interpolate the velocity of a row from those of movers.
    fn of_row(&self, row: &Row, velocities: &[[f64; 3]]) -> [f64; 3] {
        let mut u = [0.0; 3];
        for (number, share) in &self.system.pool[row.clone()] {
            let v = velocities[*number as usize];
            (0..3).for_each(|d| u[d] += share[d] * v[d]);
        }
        u
    }

    /// Sum the impulses on all movers, N s.
    fn impulses(&self, touches: &[SurfaceTouch<'_>]) -> Vec<[f64; 3]> {
        let mut sums = vec![[0.0; 3]; self.places.len()];
        for touch in touches {
            for (row, sign) in touch.rows.iter().zip([-1.0, 1.0]) {
                for (number, share) in &self.system.pool[row.clone()] {
                    let of = &mut sums[*number as usize];
                    (0..3).for_each(|d| of[d] += sign * share[d] * touch.impulse[d]);
                }
            }
        }
        sums
    }

    /// Book the impulses of a wall on its movers, without those along held axes, and their work.
    fn book(&self, touches: &[SurfaceTouch<'_>], booking: &mut Booking) {
        for (sum, mover) in self.impulses(touches).iter().zip(&self.system.movers) {
            (0..3).filter(|&d| mover.inverse[d] > 0.0).for_each(|d| booking.impulse[d] += sum[d]);
        }
        booking.work -= touches.iter().map(|touch| dot(touch.impulse, touch.rigid[1])).sum::<f64>();
    }

    /// Compute the velocities of all movers after impulses, m/s.
    fn after(&self, impulses: &[[f64; 3]]) -> Vec<[f64; 3]> {
        let end = |n: usize| std::array::from_fn(|d| self.trial[n][d] + impulses[n][d] / self.mass[n]);
        (0..impulses.len()).map(end).collect()
    }
}

/// Exchange impulses between surfaces of members with trial velocities.
pub(super) fn meet_surfaces<const D: usize>(
    members: &mut [Member<D>],
    laws: &Pairs<f64>,
    threshold: f64,
    candidates: &Candidates,
    (time, dt): (f64, f64),
    met: &mut Met,
) {
    if candidates.near.is_empty() {
        return;
    }
    let mut near = Near::find(members, candidates);
    let mut weights = Vec::new();
    let meetings = near.meetings(members, dt, &mut weights);
    let mut movers = Movers::default();
    let mut touches: Vec<SurfaceTouch<'_>> = Vec::new();
    let mut made = Vec::new();
    for meeting in &meetings {
        let s = &near.samples[meeting.slave];
        let masters: Vec<(&Sample, f64)> =
            weights[meeting.masters.clone()].iter().map(|(q, w)| (&near.samples[*q as usize], *w)).collect();
        let nearest = masters.iter().max_by(|a, b| a.1.total_cmp(&b.1)).map(|m| m.0.place);
        let other = match (meeting.wall, nearest) {
            (Some(body), _) => Place { body, particle: 0 },
            (None, Some(place)) => place,
            (None, None) => continue,
        };
        let law = laws.law(s.place.body as usize, other.body as usize);
        let near_enough = if law.pulls() { threshold.max(BOND * meeting.spacing) } else { threshold };
        let rows_at = movers.system.pool.len();
        // The impulse acts on both sides at the midpoint; on balls, and on particles at planes, at their centres.
        let half = if meeting.is_of_balls() || meeting.wall.is_some() { 0.0 } else { 0.5 * meeting.gap };
        let mut row = |place: Place, points: &[(&Sample, f64)], sign: f64| match &members[place.body as usize]
        {
            Member::Body { part, start } => {
                let beyond = times(meeting.normal, sign * half);
                movers.row(part.as_ref(), &|k| start[k], place.body, points, beyond)
            }
            Member::Wall { .. } => 0..0,
        };
        let rows = [row(s.place, &[(s, 1.0)], 1.0), row(other, &masters, -1.0)];
        let rigid = [s.place, other].map(|place| match &members[place.body as usize] {
            Member::Wall { wall } => wall.velocity(),
            Member::Body { .. } => [0.0; 3],
        });
        let seen = |velocities: &[[f64; 3]]| -> [[f64; 3]; 2] {
            std::array::from_fn(|side| {
                if rows[side].is_empty() { rigid[side] } else { movers.of_row(&rows[side], velocities) }
            })
        };
        let [u, v] = seen(&movers.trial);
        let closing = dot(difference(u, v), meeting.normal);
        let open = meeting.gap - threshold;
        if open - closing * dt > 0.0 && meeting.gap > near_enough {
            movers.system.pool.truncate(rows_at);
            continue;
        }
        let [u, v] = seen(&movers.start);
        let parting = dot(difference(v, u), meeting.normal).max(0.0);
        // Approach velocity that leaves no overlap; for separating bodies at most the opposite (no work is done on them).
        let allowed = match () {
            () if law.springs() || (law.pulls() && meeting.gap <= near_enough) => 0.0,
            () => parting.max(open / dt),
        };
        let flip = s.place.body > other.body;
        let (mut normal, mut bodies) = (meeting.normal, [s.place.body as usize, other.body as usize]);
        let (mut rows, mut rigid) = (rows, rigid);
        if flip {
            normal = times(normal, -1.0);
            bodies.reverse();
            rows.reverse();
            rigid.reverse();
        }
        let middle = sum(s.point.position, times(meeting.normal, 0.5 * meeting.gap));
        let contact = Contact {
            bodies,
            position: middle,
            time,
            gap: Some(meeting.gap),
            // Points of both surfaces are in contact: each has half of the area; on a wall all of it.
            area: if meeting.wall.is_some() { s.point.area } else { 0.5 * s.point.area },
            ..Contact::new(normal, [f64::INFINITY; 2], [[0.0; 3]; 2], dt)
        };
        let central = meeting.is_of_balls();
        touches.push(SurfaceTouch { law, contact, rows, rigid, allowed, central, impulse: [0.0; 3] });
        made.push((s.place, other));
    }
    if touches.is_empty() {
        return;
    }
    movers.system.solve(&mut touches);
    let sums = movers.impulses(&touches);
    let after = movers.after(&sums);
    for (touch, (slave, other)) in touches.iter().zip(&made) {
        if touch.impulse == [0.0; 3] {
            continue;
        }
        let Contact { bodies, position, normal, gap, .. } = touch.contact;
        let relative = |velocities: &[[f64; 3]]| {
            let [u, v] = std::array::from_fn(|side| {
                let row = &touch.rows[side];
                if row.is_empty() { touch.rigid[side] } else { movers.of_row(row, velocities) }
            });
            difference(u, v)
        };
        let (before, end) = (relative(&movers.start), relative(&after));
        let along = dot(touch.impulse, normal);
        let friction = dot(touch.impulse, end) - along * dot(end, normal);
        let all = 0.5 * (dot(touch.impulse, before) + dot(touch.impulse, end));
        for (side, sign) in [(0, -1.0), (1, 1.0)] {
            // Exchange with a wall: the reaction of its impulse.
            if let Member::Wall { wall } = &members[bodies[side]] {
                for d in 0..3 {
                    met.impulse[d] -= sign * touch.impulse[d];
                    met.work -= sign * touch.impulse[d] * wall.velocity()[d];
                }
            }
        }
        let (a, b) = if slave.body < other.body { (slave, other) } else { (other, slave) };
        met.contacts.push(PairOfParticles {
            bodies,
            particles: [a.particle as usize, b.particle as usize],
            position,
            normal,
            gap,
            impulse: touch.impulse,
            friction,
            taken: all - friction,
        });
    }
    drop(touches);
    for (place, impulse) in movers.places.iter().zip(&sums) {
        if let Member::Body { part, .. } = &mut members[place.body as usize] {
            part.push(place.particle as usize, impulse);
        }
    }
}

/// Keep the surface of a body in front of walls across axes ([`Boundary::Wall`], [`Boundary::FrictionWall`]; others are ignored), in the
/// step of `dt` seconds from `time`. The body has its trial velocities; `start` returns those at the start of the step, by particle.
/// Returns the exchange with the walls, and the particles that they moved with a bit for each axis.
pub fn press_on_walls<const D: usize, B: ParticleBody<D>>(
    body: &mut B,
    walls: &Boundaries<D>,
    start: &dyn Fn(&B, usize) -> [f64; D],
    (time, dt): (f64, f64),
) -> (Exchange, Vec<(usize, u8)>) {
    let mut given = Exchange::default();
    let mut moved = Vec::new();
    let planes: Vec<(usize, f64, f64, [f64; 3], f64)> = walls
        .iter()
        .filter_map(|wall| match *wall {
            Boundary::Wall { axis, at, side, velocity } => {
                let mut along = [0.0; 3];
                along[axis] = velocity;
                Some((axis, at + velocity * time, side.sign(), along, 0.0))
            }
            Boundary::FrictionWall { axis, at, side, velocity, friction } => {
                Some((axis, at + velocity[axis] * time, side.sign(), wide(&velocity), friction))
            }
            _ => None,
        })
        .collect();
    let mut near: Vec<Vec<usize>> = vec![Vec::new(); planes.len()];
    for n in 0..body.len() {
        let p = body.particle(n);
        for ((axis, at, sign, velocity, _), near) in planes.iter().zip(&mut near) {
            let height = (p.position[*axis] - at) * sign;
            let closing = ((velocity[*axis] - p.velocity[*axis]) * sign).max(0.0);
            // A point beyond a corner in space is 1.8 radii from its particle.
            if height <= 3.0 * p.radius + 3.0 * closing * dt {
                near.push(n);
            }
        }
    }
    if near.iter().all(Vec::is_empty) {
        return (given, moved);
    }
    let mut all: Vec<usize> = near.iter().flatten().copied().collect();
    all.sort_unstable();
    all.dedup();
    body.find_surface(&all);
    let mut movers = Movers::default();
    let mut touches: Vec<SurfaceTouch<'_>> = Vec::new();
    let laws: Vec<Option<Coulomb<f64>>> = planes.iter().map(|plane| Coulomb::new(plane.4).ok()).collect();
    let mut points = Vec::new();
    // Account of each wall, and the number of its first contact.
    let accounts = (0..walls.len()).filter(|&n| walls[n].is_wall()).map(|n| walls.account(n));
    let mut firsts = Vec::new();
    for ((((axis, at, sign, velocity, _), law), near), account) in
        planes.iter().zip(&laws).zip(&near).zip(accounts)
    {
        firsts.push((account, touches.len()));
        let Some(law) = law else { continue };
        let mut normal = [0.0; 3];
        normal[*axis] = -sign;
        for &n in near {
            points.clear();
            body.surface(n, &mut points);
            for point in points.iter().filter(|p| dot(p.normal, normal) > 0.0) {
                let gap = (point.position[*axis] - at) * sign;
                let place = Place { body: 0, particle: n as u32 };
                let sample = Sample { point: *point, place, spacing: 0.0, velocity: [0.0; 3] };
                let rows_at = movers.system.pool.len();
                let row = movers.row(body, &|k| start(body, k), 0, &[(&sample, 1.0)], [0.0; 3]);
                let closing = dot(difference(movers.of_row(&row, &movers.trial), *velocity), normal);
                if gap - closing * dt > 0.0 {
                    movers.system.pool.truncate(rows_at);
                    continue;
                }
                let parting = -dot(difference(movers.of_row(&row, &movers.start), *velocity), normal);
                let open = if gap > 0.0 { gap } else { RETURN * gap } / dt;
                let contact = Contact {
                    position: point.position,
                    time,
                    gap: Some(gap),
                    ..Contact::new(normal, [f64::INFINITY; 2], [[0.0; 3]; 2], dt)
                };
                let allowed = if gap > 0.0 { open.max(parting) } else { open };
                touches.push(SurfaceTouch {
                    law,
                    contact,
                    rows: [row, 0..0],
                    rigid: [[0.0; 3], *velocity],
                    allowed,
                    central: false,
                    impulse: [0.0; 3],
                });
            }
        }
    }
    if touches.is_empty() {
        return (given, moved);
    }
    movers.system.solve(&mut touches);
    let sums = movers.impulses(&touches);
    // Conditions bear the impulses along held axes; velocities do not change there.
    let free: Vec<[f64; 3]> = (sums.iter().zip(&movers.system.movers))
        .map(|(sum, mover)| std::array::from_fn(|d| if mover.inverse[d] > 0.0 { sum[d] } else { 0.0 }))
        .collect();
    let after = movers.after(&free);
    let ends = firsts.iter().skip(1).map(|(_, first)| *first).chain([touches.len()]);
    for ((account, first), end) in firsts.iter().zip(ends) {
        let Some(account) = account else { continue };
        movers.book(&touches[*first..end], &mut given.accounts[*account]);
    }
    for touch in touches.iter().filter(|touch| touch.impulse != [0.0; 3]) {
        let (normal, wall) = (touch.contact.normal, touch.rigid[1]);
        // Impulse on the body.
        let impulse = times(touch.impulse, -1.0);
        let [before, end] =
            [&movers.start, &after].map(|v| difference(movers.of_row(&touch.rows[0], v), wall));
        let mean = times(sum(before, end), 0.5);
        let along = dot(impulse, normal);
        let across = dot(impulse, mean) - along * dot(mean, normal);
        let heat = (-across).max(0.0);
        given.work += dot(impulse, wall);
        given.friction += heat;
        given.impacts -= dot(impulse, mean) + heat;
    }
    drop(touches);
    for (n, (place, impulse)) in movers.places.iter().zip(&free).enumerate() {
        // The share of an image behind a plane of symmetry is no impulse on the body.
        (0..3).for_each(|d| given.impulse[d] += impulse[d]);
        let held = difference(sums[n], *impulse);
        given.work -= 0.5 * dot(held, sum(movers.start[n], after[n]));
        if *impulse != [0.0; 3] {
            body.push(place.particle as usize, impulse);
            let bits = (0..3).filter(|d| impulse[*d] != 0.0).fold(0, |bits, d| bits | 1 << d);
            moved.push((place.particle as usize, bits));
        }
    }
    (given, moved)
}
