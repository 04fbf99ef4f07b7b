//! Normals of the separating plane of widest margin between the particles of two bodies.

use std::cell::RefCell;

use impactite_simd::Float;

use crate::field_points::{NearNode, are_apart};
use crate::normal::{Gradients, Memory, Nodal, NormalNodes, NormalRule};
use crate::places::{Places, each_place};
use crate::vector::{difference, dot, sum, times, unit};

/// Separating hyperplane of widest margin between the particles of two bodies near a node: the plane farthest from both. Its normal is the
/// direction of the least distance between the convex hulls of their centres, found by the algorithm of \[Gilbert1988\].
///
/// Gradients of mass tilt at edges, where half of a node's support is empty, and a sliding block ploughs into the other one. The plane of
/// widest margin is that of the faces even at their ends, and a tangent plane between a curved surface and a face or another curved
/// surface. Only the positions of particles count, not their masses: bodies may differ in density, in particles per cell, and in their
/// order.
///
/// Overlapping hulls (surfaces that are hollow or rough, or that penetrated each other) are both shrunk about their centroids, by a
/// quarter, then by half: faces keep their directions. If they still overlap, the normal is the direction between the centroids. Pairs of
/// particles without a grid, whose surfaces are facets, have the facets' normals (default [`Gradients`]).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SeparatingPlane;

/// Shrinkage of the hulls, in turn.
const SHRINKS: [f64; 3] = [0.0, 0.25, 0.5];
/// Distance of hulls, in cells, below which they overlap: the direction between them is rounding.
const NEAREST: f64 = 1e-3;
/// Maximum number of search steps; about five are usual.
const STEPS: usize = 40;
/// Convergence tolerance: largest possible relative reduction of the squared distance by another step.
const FOUND: f64 = 1e-13;

/// Distance in cells that exceeds the rounding of positions, in single precision too.
const ROUNDING: f64 = 1e-4;

/// Centres in cells, one vector per axis.
#[derive(Default)]
struct Centres([Vec<f64>; 3]);

impl Centres {
    fn clear(&mut self) {
        self.0.iter_mut().for_each(Vec::clear);
    }
    fn extend(&mut self, run: &[[f64; 3]]) {
        self.0.iter_mut().enumerate().for_each(|(d, axis)| axis.extend(run.iter().map(|x| x[d])));
    }
    fn len(&self) -> usize {
        self.0[0].len()
    }
    fn get(&self, i: usize) -> [f64; 3] {
        [self.0[0][i], self.0[1][i], self.0[2][i]]
    }
    fn centroid(&self) -> [f64; 3] {
        let share = 1.0 / self.len() as f64;
        [0, 1, 2].map(|d| self.0[d].iter().sum::<f64>() * share)
    }
    /// Find the first of the farthest centres along a direction. `along` is scratch memory.
    fn farthest(&self, direction: [f64; 3], along: &mut Vec<f64>) -> [f64; 3] {
        let [x, y, z] = &self.0;
        let count = self.len();
        if along.len() < count {
            along.resize(count, 0.0);
        }
        let (x, y, z, along) = (&x[..count], &y[..count], &z[..count], &mut along[..count]);
        // Find the largest of every fourth value first: a chain of single comparisons would wait for each.
        let mut four = [f64::NEG_INFINITY; 4];
        let whole = count - count % 4;
        for start in (0..whole).step_by(4) {
            for lane in 0..4 {
                let i = start + lane;
                along[i] = x[i] * direction[0] + y[i] * direction[1] + z[i] * direction[2];
                four[lane] = if along[i] > four[lane] { along[i] } else { four[lane] };
            }
        }
        for i in whole..count {
            along[i] = x[i] * direction[0] + y[i] * direction[1] + z[i] * direction[2];
        }
        let largest = four.iter().chain(&along[whole..]).fold(f64::NEG_INFINITY, |a, &b| a.max(b));
        let first = along.iter().position(|&a| a == largest).unwrap_or(0);
        self.get(first)
    }
}

/// Scratch memory of a thread, kept from block to block.
#[derive(Default)]
struct Workspace {
    near: [NearNode; 2],
    sets: [Centres; 2],
    along: Vec<f64>,
}

thread_local! {
    static WORKSPACE: RefCell<Workspace> = RefCell::default();
}

impl<T: Float, const D: usize> NormalRule<T, D> for SeparatingPlane {
    fn prepare(&self, at: &dyn Places<T, D>, memory: &mut Memory<'_, T>) {
        if at.around_nodes() {
            memory.points.collect(at, memory.nodes);
        } else {
            Gradients::default().prepare(at, memory);
        }
    }

    fn normals(
        &self,
        at: &dyn Places<T, D>,
        pair: [usize; 2],
        nodes: u64,
        memory: &Memory<'_, T>,
        normals: &mut Nodal<[T; 3]>,
    ) -> u64 {
        if !at.around_nodes() {
            return Gradients::default().normals(at, pair, nodes, memory, normals);
        }
        self.normals_within(at, pair, nodes, f64::INFINITY, memory, normals).found
    }

    fn normals_within(
        &self,
        at: &dyn Places<T, D>,
        pair: [usize; 2],
        nodes: u64,
        gap: f64,
        memory: &Memory<'_, T>,
        normals: &mut Nodal<[T; 3]>,
    ) -> NormalNodes {
        if !at.around_nodes() {
            return NormalNodes { found: self.normals(at, pair, nodes, memory, normals), apart: 0 };
        }
        let sides = pair.map(|field| memory.points.of(field));
        // Distance of the hulls beyond which surfaces are more than the gap apart: the normal is along the shortest vector between the hulls,
        // and no two centres are closer along it than that.
        let room = gap / at.spacing() + sides[0].radius + sides[1].radius + ROUNDING;
        WORKSPACE.with_borrow_mut(|Workspace { near, sets, along }| {
            let mut asked = NormalNodes::default();
            for node in each_place(nodes) {
                sides.iter().zip(&mut *near).for_each(|(side, near)| side.select(node, near));
                if are_apart(&sides, near, room) {
                    asked.apart |= 1 << node;
                    continue;
                }
                for side in 0..2 {
                    sets[side].clear();
                    sides[side].runs(&near[side]).for_each(|run| sets[side].extend(run));
                }
                match separating(sets, room, along) {
                    Separation::Along(normal) => {
                        normals[node] = normal.map(T::of);
                        asked.found |= 1 << node;
                    }
                    Separation::Apart => asked.apart |= 1 << node,
                    Separation::Unknown => {}
                }
            }
            asked
        })
    }
}

/// Separation of the particles of two bodies near a node.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Separation {
    /// Unit normal from the first to the second.
    Along([f64; 3]),
    /// Hulls too far apart to touch.
    Apart,
    /// One set is empty, or both have the same centroid.
    Unknown,
}

/// Separation of two sets, apart if their hulls are farther from each other than `room`.
fn separating(sets: &[Centres; 2], room: f64, along: &mut Vec<f64>) -> Separation {
    if sets[0].len() == 0 || sets[1].len() == 0 {
        return Separation::Unknown;
    }
    let centroids = difference(sets[1].centroid(), sets[0].centroid());
    let mut apart = centroids;
    for shrink in SHRINKS {
        // The distance of shrunk hulls is not that of the particles.
        let room = if shrink == 0.0 { room } else { f64::INFINITY };
        match nearest(sets, centroids, (shrink, room), along) {
            Hulls::Overlap => continue,
            Hulls::Apart => return Separation::Apart,
            Hulls::Nearest(v) => apart = v,
        }
        break;
    }
    unit(apart).map_or(Separation::Unknown, Separation::Along)
}

/// Places of two hulls.
enum Hulls {
    Overlap,
    /// Farther from each other than needed.
    Apart,
    /// Shortest vector from the first to the second.
    Nearest([f64; 3]),
}

/// Places of the hulls of two sets, both shrunk by `shrink` about their centroids, which are `centroids` apart; the search ends once they
/// are known to be farther from each other than `room`.
fn nearest(
    sets: &[Centres; 2],
    centroids: [f64; 3],
    (shrink, room): (f64, f64),
    along: &mut Vec<f64>,
) -> Hulls {
    let mut v = centroids;
    let mut simplex = Simplex::default();
    for step in 0..STEPS {
        let square = dot(v, v);
        if square < NEAREST * NEAREST {
            return Hulls::Overlap;
        }
        let (first, second) = (sets[0].farthest(v, along), sets[1].farthest(times(v, -1.0), along));
        let whole = times(difference(second, first), 1.0 - shrink);
        let vertex = sum(whole, times(centroids, shrink));
        // Both hulls are beyond their farthest points along v, on either side.
        let slab = dot(v, vertex);
        if slab > room * square.sqrt() {
            return Hulls::Apart;
        }
        if square - slab <= FOUND * square || simplex.has(vertex) {
            break;
        }
        simplex.add(vertex);
        let next = simplex.nearest();
        // The centroid was not a vertex: the first one may be farther.
        if step > 0 && dot(next, next) >= square {
            break;
        }
        v = next;
    }
    Hulls::Nearest(v)
}

/// Simplex of up to four vertices of the difference of two hulls, which contains its nearest point to the origin.
#[derive(Default)]
struct Simplex {
    vertices: [[f64; 3]; 4],
    count: usize,
}

impl Simplex {
    fn has(&self, vertex: [f64; 3]) -> bool {
        self.vertices[..self.count].contains(&vertex)
    }
    fn add(&mut self, vertex: [f64; 3]) {
        self.vertices[self.count] = vertex;
        self.count += 1;
    }
    /// Find the point nearest to the origin; keep the vertices of its face. Every face with the newest vertex is tried, since the nearest
    /// point of the others was known: there are eight at most, and degenerate ones need no special care.
    fn nearest(&mut self) -> [f64; 3] {
        let mut best = (f64::INFINITY, [0.0; 3], 0u32);
        for set in 1u32 << (self.count - 1)..1 << self.count {
            let mut face = [[0.0; 3]; 4];
            let mut count = 0;
            for i in (0..self.count).filter(|i| set >> i & 1 != 0) {
                face[count] = self.vertices[i];
                count += 1;
            }
            let Some(point) = within(&face[..count]) else { continue };
            let square = dot(point, point);
            if square < best.0 {
                best = (square, point, set);
            }
        }
        let mut count = 0;
        for i in 0..self.count {
            if best.2 >> i & 1 != 0 {
                self.vertices[count] = self.vertices[i];
                count += 1;
            }
        }
        self.count = count;
        best.1
    }
}

/// Point nearest to the origin on the plane through some vertices, if it is between them.
fn within(face: &[[f64; 3]]) -> Option<[f64; 3]> {
    match *face {
        [a] => Some(a),
        [a, b] => {
            let edge = difference(b, a);
            let (along, square) = (-dot(a, edge), dot(edge, edge));
            (along > 0.0 && along < square).then(|| sum(a, times(edge, along / square)))
        }
        [a, b, c] => {
            let (p, q) = (difference(b, a), difference(c, a));
            let (pp, pq, qq) = (dot(p, p), dot(p, q), dot(q, q));
            let (ap, aq) = (-dot(a, p), -dot(a, q));
            let area = pp * qq - pq * pq;
            let (s, t) = (ap * qq - aq * pq, aq * pp - ap * pq);
            (area > 1e-14 * pp * qq && s > 0.0 && t > 0.0 && s + t < area).then(|| {
                // Across the face: exact in direction, where a + s p + t q would cancel.
                let across = cross(p, q);
                times(across, dot(a, across) / dot(across, across))
            })
        }
        [a, b, c, d] => {
            let (p, q, r) = (difference(b, a), difference(c, a), difference(d, a));
            let volume = dot(p, cross(q, r));
            let o = times(a, -1.0);
            let parts = [dot(o, cross(q, r)), dot(p, cross(o, r)), dot(p, cross(q, o))];
            let all: f64 = parts.iter().sum();
            let inside = if volume > 0.0 {
                parts.iter().all(|x| *x >= 0.0) && all <= volume
            } else {
                parts.iter().all(|x| *x <= 0.0) && all >= volume
            };
            (volume != 0.0 && inside).then_some([0.0; 3])
        }
        _ => None,
    }
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

#[cfg(test)]
mod tests {
    use std::f64::consts::FRAC_PI_4;

    use super::*;

    fn set(points: impl IntoIterator<Item = [f64; 3]>) -> Centres {
        let mut centres = Centres::default();
        points.into_iter().for_each(|p| centres.extend(&[p]));
        centres
    }

    fn normal(sets: &[Centres; 2]) -> Option<[f64; 3]> {
        match separating(sets, f64::INFINITY, &mut Vec::new()) {
            Separation::Along(normal) => Some(normal),
            Separation::Apart | Separation::Unknown => None,
        }
    }

    /// Rows of a block, rotated by an angle about z.
    fn block(
        x: std::ops::Range<i32>,
        y: std::ops::Range<i32>,
        z: std::ops::Range<i32>,
        angle: f64,
    ) -> Centres {
        let (s, c) = angle.sin_cos();
        let all = x.flat_map(|i| {
            let z = z.clone();
            y.clone().flat_map(move |j| {
                z.clone()
                    .map(move |k| [0.25 + 0.5 * f64::from(i), 0.25 + 0.5 * f64::from(j), 0.5 * f64::from(k)])
            })
        });
        set(all.map(|[x, y, z]| [c * x - s * y, s * x + c * y, z]))
    }

    #[test]
    fn faces_keep_their_normal_at_edges() {
        for angle in [0.0, 0.3, FRAC_PI_4, 2.0, -1.1] {
            for depth in [0..1, 0..3] {
                for right in -1..4 {
                    // The upper block ends anywhere over the lower one.
                    let low = block(-3..3, -3..0, depth.clone(), angle);
                    let high = block(-3..right, 0..3, depth.clone(), angle);
                    let exact = [-f64::sin(angle), f64::cos(angle), 0.0];
                    let found = normal(&[low, high]).unwrap();
                    let off = difference(found, exact);
                    assert!(dot(off, off).sqrt() < 1e-12, "{angle} {right} {found:?}");
                }
            }
        }
    }

    #[test]
    fn a_body_and_the_other_see_opposite_normals() {
        // Points of two nearly touching balls, without order.
        let ball = |seed: u32, at: [f64; 3]| {
            let mut x = seed;
            let mut next = move || {
                x = x.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                f64::from(x >> 8) / f64::from(1u32 << 24) - 0.5
            };
            let all = (0..400).map(move |_| [next(), next(), next()]);
            set(all.filter(|p| dot(*p, *p) < 0.25).map(move |p| sum(p, at)))
        };
        let make = || [ball(1, [0.0; 3]), ball(2, [0.8, 0.5, 0.4])];
        let [a, b] = make();
        let there = normal(&[a, b]).unwrap();
        let [a, b] = make();
        let back = normal(&[b, a]).unwrap();
        assert_eq!(there, times(back, -1.0));
        let line = unit([0.8, 0.5, 0.4]).unwrap();
        assert!(dot(line, there) > 0.97, "{there:?}");
    }

    #[test]
    fn only_hulls_beyond_the_room_are_apart() {
        let mut x = 3u32;
        let mut next = || {
            x = x.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            f64::from(x >> 8) / f64::from(1u32 << 24) - 0.5
        };
        let room = 0.6;
        let mut counts = [0; 2];
        for _ in 0..400 {
            let gap = 1.2 + next();
            let first: Vec<[f64; 3]> = (0..12).map(|_| [next(), next(), next()]).collect();
            let second: Vec<[f64; 3]> = (0..9).map(|_| [next() + gap, next() + 0.3, next()]).collect();
            let sets = [set(first.clone()), set(second.clone())];
            let exact = normal(&sets).unwrap();
            let end = first.iter().map(|x| dot(*x, exact)).fold(f64::NEG_INFINITY, f64::max);
            let start = second.iter().map(|x| dot(*x, exact)).fold(f64::INFINITY, f64::min);
            let apart = start - end > room;
            counts[usize::from(apart)] += 1;
            match separating(&sets, room, &mut Vec::new()) {
                Separation::Apart => assert!(apart, "{} {room}", start - end),
                other => assert_eq!(other, Separation::Along(exact)),
            }
        }
        assert!(counts[0] > 50 && counts[1] > 50, "{counts:?}");
    }

    #[test]
    fn hulls_that_overlap_are_shrunk() {
        // Block with a lip below its face, and one that penetrated it by half a particle.
        let low = set((-4..4).flat_map(|i| [[f64::from(i), -0.2, 0.0], [f64::from(i), -1.2, 0.0]]));
        let high =
            set((-4..4).flat_map(|i| [[f64::from(i) + 0.3, -0.3, 0.0], [f64::from(i) + 0.3, 0.7, 0.0]]));
        let found = normal(&[low, high]).unwrap();
        assert!(found[1] > 0.999, "{found:?}");
        assert_eq!(normal(&[set([[1.0; 3]]), set([])]), None);
        assert_eq!(normal(&[set([[1.0; 3]]), set([[1.0; 3]])]), None);
    }
}
