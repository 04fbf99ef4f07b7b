//! Contact in one step: facing pairs, detection, impulses, energy balance.

use std::collections::HashMap;

use super::body::{ContactParticle, Facing};
use super::candidates::{Candidates, RANGE};
use super::member::{Member, Place};
use super::met::{Met, PairOfParticles};
use super::places::{FacingPair, PairPlaces, Side};
use super::solve::{Touch, gather, solve};
use super::surface::meet_surfaces;
use crate::detect::{ContactDetector, Criterion};
use crate::field_points::FieldPoints;
use crate::law::{Contact, Pairs};
use crate::normal::{Memory, Nodal, NormalRule};
use crate::vector::{difference, dot, wide};

/// Number of pairs processed together, one bit each.
const BATCH: usize = 64;
/// Relative tolerance of equal distances to two partners.
const EQUALLY_NEAR: f64 = 1e-9;
/// Cosine of the angle between outward normals above which they have the same direction.
const SAME_WAY: f64 = 0.7;

/// Squared distance of two positions, m^2.
fn distance_squared<const D: usize>(a: &[f64; D], b: &[f64; D]) -> f64 {
    let apart = difference(wide(b), wide(a));
    dot(apart, apart)
}

/// Particle as one side, without a partner; a wall without a position.
fn alone<const D: usize>(members: &[Member<D>], place: Place) -> Side<D> {
    match &members[place.body as usize] {
        Member::Body { part, .. } => {
            let n = place.particle as usize;
            let ContactParticle { position, mass, radius, .. } = part.particle(n);
            Side { place, position, mass, facing: part.facing(n), radius, beyond: part.beyond(n) }
        }
        Member::Wall { wall } => {
            let facing = Facing { area: wall.normal(), mass: wall.normal(), lone: false };
            let mass = f64::INFINITY;
            Side { place, position: [0.0; D], mass, facing, radius: 0.0, beyond: 0.0 }
        }
    }
}

/// One side of a pair, oriented towards the other.
fn side<const D: usize>(members: &[Member<D>], mut one: Side<D>, two: &Side<D>) -> Side<D> {
    let (at, other) = (one.place, two.place);
    let towards = |normal: [f64; 3], amount: f64| normal.map(|c| c * amount);
    match (&members[at.body as usize], &members[other.body as usize]) {
        // Foot of the particle.
        (Member::Wall { wall }, _) => {
            one.position = two.position;
            let (height, normal) = (wall.height(&two.position), wall.normal());
            for d in 0..D {
                one.position[d] -= height * normal[d];
            }
        }
        // The plane is more accurate than the particle's surface.
        (_, Member::Wall { wall }) => {
            let amount = |v: [f64; 3]| if one.facing.lone { 1.0 } else { dot(v, v).sqrt() };
            let minus = wall.normal().map(|c| -c);
            let (area, mass) = (amount(one.facing.area), amount(one.facing.mass));
            one.facing.area = towards(minus, area);
            one.facing.mass = towards(minus, mass);
        }
        _ if one.facing.lone => {
            // Ball.
            let apart = difference(wide(&two.position), wide(&one.position));
            let length = dot(apart, apart).sqrt();
            if length > 0.0 {
                let normal = apart.map(|c| c / length);
                let extent = 2.0 * one.radius;
                one.facing.area = towards(normal, if D == 2 { extent } else { extent * extent });
                one.facing.mass = towards(normal, one.mass / extent);
            }
        }
        _ => {}
    }
    one
}

/// True if two surfaces with these normals face each other. Corners of two blocks in contact face to face are at angles of 90 degrees, in
/// space of 71; the far side of a sheet has the same direction as a surface that approaches the near one.
fn face(a: [f64; 3], b: [f64; 3]) -> bool {
    dot(a, b) < SAME_WAY * (dot(a, a) * dot(b, b)).sqrt()
}

fn in_range<const D: usize>(members: &[Member<D>], pair: [Place; 2]) -> bool {
    let particle = |p: Place| {
        let (part, n) = (members[p.body as usize].part()?, p.particle as usize);
        part.may_touch(n).then(|| part.particle(n))
    };
    let [Some(a), Some(b)] = pair.map(particle) else { return false };
    distance_squared(&a.position, &b.position) <= (RANGE * (a.radius + b.radius)).powi(2)
}

/// Select the candidates whose surfaces face each other, or balls in contact within a body, that are nearest to each other: every particle
/// with its nearest in every other body.
fn facing<const D: usize>(members: &[Member<D>], candidates: &[[Place; 2]]) -> Vec<FacingPair<D>> {
    let is_wall = |p: &Place| members[p.body as usize].part().is_none();
    let mut known: HashMap<Place, Side<D>> = HashMap::new();
    let mut pairs = Vec::new();
    for &[a, b] in candidates {
        let wall = is_wall(&a) || is_wall(&b);
        if !wall && !in_range(members, [a, b]) {
            continue;
        }
        let [mut one, mut two] = [a, b].map(|p| *known.entry(p).or_insert_with(|| alone(members, p)));
        // A particle surrounded by its body has no surface; it may be under a wall.
        let within = !wall && (one.facing.is_within() || two.facing.is_within());
        if within {
            // A particle that passed through the surface of a body is in contact with its inside, ball by ball: at the distance of surfaces
            // in contact, or at half of that where they go through the centres, since the layer behind a surface is then a spacing away.
            for ball in [&mut one, &mut two] {
                ball.facing.lone = true;
                ball.beyond = ball.beyond.max(0.5 * ball.radius);
            }
            let reach = one.beyond + two.beyond;
            if distance_squared(&one.position, &two.position) > reach * reach {
                continue;
            }
        }
        let pair = FacingPair { sides: [side(members, one, &two), side(members, two, &one)] };
        if wall || within || face(pair.sides[0].facing.area, pair.sides[1].facing.area) {
            pairs.push(pair);
        }
    }
    // Least distance by particle and other body.
    let mut nearest = HashMap::new();
    for pair in &pairs {
        let apart = pair.apart();
        let square = dot(apart, apart);
        for (s, o) in [(0, 1), (1, 0)] {
            let key = (pair.sides[s].place, pair.sides[o].place.body);
            let least = nearest.entry(key).or_insert(f64::INFINITY);
            *least = least.min(square);
        }
    }
    pairs.retain(|pair| {
        let apart = pair.apart();
        let square = dot(apart, apart) * (1.0 - EQUALLY_NEAR);
        let is_nearest = |s: usize, o: usize| {
            let key = (pair.sides[s].place, pair.sides[o].place.body);
            nearest.get(&key).is_some_and(|least| square <= *least)
        };
        pair.sides.iter().any(|s| is_wall(&s.place)) || is_nearest(0, 1) || is_nearest(1, 0)
    });
    pairs
}

/// Pair in contact.
struct Touching<const D: usize> {
    pair: FacingPair<D>,
    normal: [f64; 3],
    gap: Option<f64>,
}

/// Compute normals and detect contact, batch by batch.
fn touching<const D: usize, S: ContactDetector<f64, D>>(
    members: &[Member<D>],
    detector: &S,
    spacing: f64,
    pairs: &[FacingPair<D>],
) -> Vec<Touching<D>> {
    let bodies = |p: &FacingPair<D>| p.sides.map(|s| s.place.body);
    let mut list = Vec::new();
    let (mut scratch, mut points) = (Vec::new(), FieldPoints::default());
    for batch in pairs.chunk_by(|a, b| bodies(a) == bodies(b)).flat_map(|of_two| of_two.chunks(BATCH)) {
        let at = PairPlaces { pairs: batch, members, spacing };
        let all = if batch.len() == BATCH { u64::MAX } else { (1 << batch.len()) - 1 };
        scratch.clear();
        let mut memory = Memory { numbers: &mut scratch, points: &mut points, nodes: &[all, all] };
        let mut normals: Nodal<[f64; 3]> = [[0.0; 3]; BATCH];
        let mut gaps: Nodal<Option<f64>> = [None; BATCH];
        detector.normals().prepare(&at, &mut memory);
        let have = detector.normals().normals(&at, [0, 1], all, &memory, &mut normals);
        let touches = detector.touching(&at, [0, 1], have, &normals, &mut gaps);
        for (n, pair) in batch.iter().enumerate().filter(|(n, _)| touches & (1 << n) != 0) {
            // Particles beside each other by more than both radii pass.
            let (apart, normal) = (pair.apart(), normals[n]);
            let along = dot(apart, normal);
            let beside = dot(apart, apart) - along * along;
            let [a, b] = &pair.sides;
            let wall = a.mass.is_infinite() || b.mass.is_infinite();
            if wall || beside <= (a.radius + b.radius).powi(2) {
                list.push(Touching { pair: *pair, normal, gap: gaps[n] });
            }
        }
    }
    list
}

/// Exchange impulses between members with trial velocities: between surfaces where a body has one, else between pairs of particles.
pub(super) fn meet<const D: usize, S: ContactDetector<f64, D>>(
    members: &mut [Member<D>],
    detector: &S,
    laws: &Pairs<f64>,
    spacing: f64,
    candidates: &Candidates,
    (time, dt): (f64, f64),
) -> Met {
    let mut met = meet_pairs(members, detector, laws, spacing, candidates.pairs(), time, dt);
    // Detectors without gaps: contact at zero distance of surfaces.
    let threshold = if let Criterion::Gap(gap) = detector.criterion(spacing) { gap } else { 0.0 };
    meet_surfaces(members, laws, threshold, candidates, (time, dt), &mut met);
    met
}

/// Exchange impulses between pairs of particles.
fn meet_pairs<const D: usize, S: ContactDetector<f64, D>>(
    members: &mut [Member<D>],
    detector: &S,
    laws: &Pairs<f64>,
    spacing: f64,
    candidates: &[[Place; 2]],
    time: f64,
    dt: f64,
) -> Met {
    let found = touching(members, detector, spacing, &facing(members, candidates));
    if found.is_empty() {
        return Met::default();
    }
    let mut movers: Vec<Place> = found.iter().flat_map(|t| t.pair.sides.map(|s| s.place)).collect();
    movers.sort_unstable();
    movers.dedup();
    let number = |place: &Place| movers.binary_search(place).unwrap_or(0);
    let velocities = |place: &Place| match &members[place.body as usize] {
        Member::Body { part, start, .. } => {
            let n = place.particle as usize;
            [wide(&start[n]), wide(&part.particle(n).velocity)]
        }
        Member::Wall { wall } => [wall.velocity(); 2],
    };
    let mut touches: Vec<Touch<'_>> = Vec::with_capacity(found.len());
    for Touching { pair, normal, gap } in &found {
        let [a, b] = &pair.sides;
        let law = laws.law(a.place.body as usize, b.place.body as usize);
        let [[old_a, new_a], [old_b, new_b]] = [velocities(&a.place), velocities(&b.place)];
        let mut seen = [new_a, new_b];
        if !law.pulls() && !law.springs() {
            // An impulse would do work on separating bodies: their approach at the end may be at most the separation velocity at the start
            // (as on the grid, `mpm_core::GridContact`).
            let parting = dot(difference(old_b, old_a), *normal).max(0.0);
            for d in 0..3 {
                seen[0][d] -= parting * normal[d];
            }
        }
        let extent = |s: &Side<D>| {
            if s.mass.is_infinite() { f64::INFINITY } else { dot(s.facing.area, s.facing.area).sqrt() }
        };
        let area = if law.needs_area() { extent(a).min(extent(b)) } else { 0.0 };
        let (x, y) = (wide(&a.position), wide(&b.position));
        let contact = Contact {
            bodies: [a.place.body as usize, b.place.body as usize],
            position: std::array::from_fn(|d| 0.5 * (x[d] + y[d])),
            time,
            gap: *gap,
            area,
            // Laws with memory treat every contact as new.
            ..Contact::new(*normal, [a.mass, b.mass], seen, dt)
        };
        touches.push(Touch { law, contact, movers: [number(&a.place), number(&b.place)], impulse: [0.0; 3] });
    }
    solve(&mut touches, movers.len());
    let sums = gather(&touches, movers.len(), touches.iter().map(|t| t.impulse));
    let mut met = Met::default();
    for (touch, Touching { pair, normal, gap }) in touches.iter().zip(&found) {
        if touch.impulse == [0.0; 3] {
            continue;
        }
        let [a, b] = &pair.sides;
        let change = |s: &Side<D>, m: usize| sums[m].map(|j| j / s.mass);
        let [[old_a, new_a], [old_b, new_b]] = [velocities(&a.place), velocities(&b.place)];
        let (on_a, on_b) = (change(a, touch.movers[0]), change(b, touch.movers[1]));
        // Relative velocity of the first to the second, at the start and at the end of the step.
        let before = difference(old_a, old_b);
        let mut after = difference(new_a, new_b);
        for d in 0..3 {
            after[d] += on_a[d] - on_b[d];
        }
        let along = dot(touch.impulse, *normal);
        let friction = dot(touch.impulse, after) - along * dot(after, *normal);
        let all = 0.5 * (dot(touch.impulse, before) + dot(touch.impulse, after));
        for (sign, other, wall) in
            [(1.0, b, &members[a.place.body as usize]), (-1.0, a, &members[b.place.body as usize])]
        {
            if let Member::Wall { wall } = wall {
                debug_assert!(other.mass.is_finite());
                for d in 0..3 {
                    met.impulse[d] += sign * touch.impulse[d];
                    met.work += sign * touch.impulse[d] * wall.velocity()[d];
                }
            }
        }
        let (x, y) = (wide(&a.position), wide(&b.position));
        met.contacts.push(PairOfParticles {
            bodies: [a.place.body as usize, b.place.body as usize],
            particles: [a.place.particle as usize, b.place.particle as usize],
            position: std::array::from_fn(|d| 0.5 * (x[d] + y[d])),
            normal: *normal,
            gap: *gap,
            impulse: touch.impulse,
            friction,
            taken: all - friction,
        });
    }
    drop(touches);
    for (place, impulse) in movers.iter().zip(&sums) {
        if let Member::Body { part, .. } = &mut members[place.body as usize] {
            part.push(place.particle as usize, impulse);
        }
    }
    met
}
