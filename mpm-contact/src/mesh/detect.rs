//! Contact detection of points and facets in a step: at its start, and within it for fast points or turning facets.

use super::body::{BESIDE, ContactBody, Surface};
use super::closest::{closest, cross};
use super::features::{Feature, Near, Side, features, turn_away};
use super::side::Facing;
use crate::vector::{difference, dot, length, sum, times};

use impactite_geometry::Facet;
use impactite_simd::Team;

/// Penetration, over the spacing, that contact neither causes nor corrects.
pub(super) const ALLOWED: f64 = 0.02;
/// Penetration at the end of a step, over the spacing, beyond which another contact is sought.
const DEEP: f64 = 0.04;
/// Approach in a step, over the spacing, below which a point does not pass through.
const SEEN: f64 = 1e-3;
/// Correction in a step of the penetration beyond the allowed one: relative, and at most, over the spacing.
const MENDED: [f64; 2] = [0.1, 0.01];
/// Depth, over the spacing, behind an open sheet, or behind a second facet at a corner, at which a point counts as having passed through.
const BACK: f64 = 0.1;
/// Motion along a facet, over the radius of its sphere, up to which its plane at the start represents it.
const SLOW: f64 = 0.5;
/// Maximum number of positions checked along the path of a point.
const PLACES: f64 = 256.0;
/// Number of points per task.
const CHUNK: usize = 128;

/// Contact of a point with a facet.
#[derive(Clone, Copy, Debug)]
pub(super) struct Touch {
    /// Number of its [`Facing`].
    pub side: u32,
    pub point: u32,
    pub facet: u32,
    pub nodes: [u32; 4],
    /// Shape weights of the contact place.
    pub weights: [f64; 4],
    /// Normal out of the surface.
    pub normal: [f64; 3],
    /// Gap (x_p - sum N_a x_a) . n - r_p at the start of the step, m.
    pub gap: f64,
    /// Least gap permitted at the end, m.
    pub target: f64,
    /// Spacing of the point, m.
    pub spacing: f64,
    /// Impulse on the point, N s.
    pub impulse: [f64; 3],
}

/// Points and facets in one step, at the present velocities.
pub(super) struct View<'a, const D: usize> {
    pub number: u32,
    pub side: &'a Facing<D>,
    pub points: &'a ContactBody<'a, D>,
    pub facets: &'a ContactBody<'a, D>,
    pub surfaces: [&'a Surface; 2],
    /// Velocities of the points and of the nodes, m/s.
    pub velocities: [&'a [[f64; 3]]; 2],
    pub dt: f64,
}

/// Path of a point through the step.
struct Way {
    n: usize,
    x: [f64; 3],
    v: [f64; 3],
    half: f64,
    spacing: f64,
    /// Normal of a node on the surface of a mesh.
    normal: Option<[f64; 3]>,
    rules: Side,
}

/// Scratch memory of a task.
#[derive(Default)]
struct Scratch {
    facets: Vec<u32>,
    near: Vec<Near>,
    features: Vec<Feature>,
}

/// Results of a task.
#[derive(Clone, Default)]
struct Row {
    touches: Vec<Touch>,
    depth: f64,
}

impl<const D: usize> View<'_, D> {
    /// Find the contacts at the start of the step that may close in it.
    pub fn at_the_start(&self, team: &Team) -> Vec<Touch> {
        self.each(team, |way, scratch, row| self.start(way, scratch, &mut row.touches)).0
    }

    /// Find penetrations at the end of the step beyond the known contacts: the first passage of each point, and the largest penetration,
    /// over the spacing.
    pub fn at_the_end(&self, team: &Team) -> (Vec<Touch>, f64) {
        self.each(team, |way, scratch, row| {
            let depth = -self.look(way, 1.0, false, 0.0, scratch)[0] / way.spacing;
            row.depth = row.depth.max(depth);
            // A ball that is pressed into facets smaller than itself has many contacts. A ball that flies by has its path ahead only where
            // the distance is least.
            let fast = self.is_fast(way, &scratch.facets);
            if depth > DEEP || fast {
                self.first_on_the_way(way, way.half > 0.0 && !fast, scratch, &mut row.touches);
            }
        })
    }

    fn each(
        &self,
        team: &Team,
        task: impl Fn(&Way, &mut Scratch, &mut Row) + Send + Sync,
    ) -> (Vec<Touch>, f64) {
        let touching = &self.surfaces[0].touching;
        let mut rows = vec![Row::default(); touching.len().div_ceil(CHUNK)];
        team.each(&mut rows, |chunk, row| {
            let mut scratch = Scratch::default();
            for i in chunk * CHUNK..((chunk + 1) * CHUNK).min(touching.len()) {
                let candidates = self.side.candidates(i);
                if candidates.is_empty() {
                    continue;
                }
                let way = self.way(touching[i] as usize);
                self.reached(&way, candidates, &mut scratch.facets);
                if !scratch.facets.is_empty() {
                    task(&way, &mut scratch, row);
                }
            }
        });
        let depth = rows.iter().fold(0.0, |depth: f64, row| depth.max(row.depth));
        (rows.into_iter().flat_map(|row| row.touches).collect(), depth)
    }

    fn way(&self, n: usize) -> Way {
        let spacing = self.surfaces[0].spacing(self.points, n);
        let held = self.side.held[n];
        let held = (held != Facet::NONE).then(|| self.facets.facets[held as usize].nodes);
        let half = self.points.half_size(n);
        let normal = self.surfaces[0].normals.get(n).copied();
        let own = normal.filter(|_| self.side.is_within()).map(|normal| (n as u32, normal));
        // The middle surface of a shell has two sides.
        let normal = normal.filter(|_| half == 0.0);
        let rules = Side { closed: self.surfaces[1].closed, back: BACK * spacing, held, own };
        let (x, v) = (self.points.position(n), self.velocities[0][n]);
        Way { n, x, v, half, spacing, normal, rules }
    }

    /// Find the candidates whose spheres the point passes on its path.
    fn reached(&self, way: &Way, candidates: &[u32], reached: &mut Vec<u32>) {
        reached.clear();
        let prescribed = self.points.is_prescribed(way.n);
        reached.extend(candidates.iter().copied().filter(|&f| {
            let sphere = &self.side.spheres[f as usize];
            let apart = difference(way.x, sphere.centre);
            let path = times(difference(way.v, sphere.velocity), self.dt);
            let square = dot(path, path);
            let reach = sphere.radius + sphere.spread * self.dt + way.half + BESIDE * way.spacing;
            // (a + b)^2 <= 2 (a^2 + b^2): rejects most candidates without a root or a division.
            if dot(apart, apart) > 2.0001 * (reach * reach + square) {
                return false;
            }
            let at = if square > 0.0 { (-dot(apart, path) / square).clamp(0.0, 1.0) } else { 0.0 };
            let least = sum(apart, times(path, at));
            dot(least, least) <= reach * reach * (1.0 + 1e-12) && !(prescribed && self.is_prescribed(f))
        }));
    }

    fn is_prescribed(&self, facet: u32) -> bool {
        let nodes = self.facets.facets[facet as usize].nodes;
        nodes.iter().filter(|&&n| n != Facet::NONE).all(|&n| self.facets.is_prescribed(n as usize))
    }

    /// Path length of the point relative to a facet in the step, m.
    fn travel(&self, way: &Way, facet: u32) -> f64 {
        length(difference(way.v, self.side.spheres[facet as usize].velocity)) * self.dt
    }

    /// True if the point moves so far relative to one of these facets that a check at the end of the step may miss contacts on its path.
    fn is_fast(&self, way: &Way, facets: &[u32]) -> bool {
        facets.iter().any(|&f| {
            let sphere = &self.side.spheres[f as usize];
            let seen = (SLOW * sphere.radius).min(way.half + way.rules.back);
            self.travel(way, f) + sphere.spread * self.dt > seen
        })
    }

    /// Find the features at a fraction of the step, into `scratch`: those no farther than `ahead` (m) beyond the search margin. Returns the
    /// smallest gap, and a lower bound of the distance to the nearest facet, on either side.
    fn look(&self, way: &Way, part: f64, every: bool, ahead: f64, scratch: &mut Scratch) -> [f64; 2] {
        let reach = way.half + BESIDE * way.spacing + ahead;
        let [least, clear] = self.look_within(way, part, every, reach, scratch);
        // Farther facets matter for a point that is deep inside: the nearest one, which is no farther than any facet centre.
        if least.is_infinite() && (way.rules.closed || way.rules.held.is_some()) {
            let nearest = self.nearest_centre(way, part, &scratch.facets);
            let [least, _] = self.look_within(way, part, every, nearest, scratch);
            // The last contact must not influence how far the path is followed.
            return [least, clear];
        }
        [least, clear]
    }

    /// Distance of the point to the nearest centre of these facets at a fraction of the step, m.
    fn nearest_centre(&self, way: &Way, part: f64, facets: &[u32]) -> f64 {
        let time = part * self.dt;
        let x = sum(way.x, times(way.v, time));
        let square = |f: &u32| {
            let sphere = &self.side.spheres[*f as usize];
            let apart = difference(x, sum(sphere.centre, times(sphere.velocity, time)));
            dot(apart, apart)
        };
        // The centre of a bilinear quadrilateral is the mean of its corners, like that of the others.
        facets.iter().map(square).fold(f64::INFINITY, f64::min).sqrt() * (1.0 + 1e-9)
    }

    /// Largest path length of the point relative to these facets or their nodes, m.
    fn farthest(&self, way: &Way, facets: &[u32]) -> f64 {
        let spread = |f: u32| self.side.spheres[f as usize].spread * self.dt;
        facets.iter().map(|&f| self.travel(way, f) + spread(f)).fold(0.0, f64::max)
    }

    fn look_within(&self, way: &Way, part: f64, every: bool, reach: f64, scratch: &mut Scratch) -> [f64; 2] {
        let Scratch { facets, near, features: found } = scratch;
        let time = part * self.dt;
        let x = sum(way.x, times(way.v, time));
        near.clear();
        let mut clear = f64::INFINITY;
        for &facet in &*facets {
            let nodes = self.facets.facets[facet as usize].nodes;
            let (mut corners, mut count) = ([[0.0; 3]; 4], 0);
            let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
            for &n in nodes.iter().take_while(|&&n| n != Facet::NONE) {
                let corner =
                    sum(self.facets.position(n as usize), times(self.velocities[1][n as usize], time));
                corners[count] = corner;
                count += 1;
                for d in 0..3 {
                    low[d] = low[d].min(corner[d]);
                    high[d] = high[d].max(corner[d]);
                }
            }
            let mut square = 0.0;
            for d in 0..3 {
                let off = (low[d] - x[d]).max(x[d] - high[d]).max(0.0);
                square += off * off;
            }
            if square > reach * reach {
                clear = clear.min(square.sqrt());
                continue;
            }
            // The whole facet is between two planes through its corners.
            let off = off_planes(x, &corners[..count]);
            if off > reach {
                clear = clear.min(off);
                continue;
            }
            let closest = closest(x, &corners[..count]);
            clear = clear.min(closest.distance);
            let centre = times(corners[..count].iter().fold([0.0; 3], |a, b| sum(a, *b)), 1.0 / count as f64);
            let size = self.side.spheres[facet as usize].radius;
            near.push(Near { facet, nodes, centre, size, closest, turned: false });
        }
        near.retain(|near| near.closest.distance <= reach);
        if let Some(normal) = way.normal {
            turn_away(near, normal, way.rules.back);
        }
        features(x, near, &way.rules, every, found);
        let least = found.iter().map(|feature| feature.height - way.half).fold(f64::INFINITY, f64::min);
        [least, clear]
    }

    /// Separation velocity of the point along the normal, relative to the place on the surface, m/s.
    fn parting(&self, way: &Way, feature: &Feature) -> f64 {
        let mut relative = way.v;
        for (&n, w) in feature.nodes.iter().zip(feature.weights).filter(|(_, w)| *w > 0.0) {
            relative = difference(relative, times(self.velocities[1][n as usize], w));
        }
        dot(relative, feature.normal)
    }

    fn touch(&self, way: &Way, feature: &Feature, gap: f64) -> Touch {
        let Feature { facet, nodes, weights, normal, .. } = *feature;
        let &Way { n, spacing, .. } = way;
        let deeper = -gap - ALLOWED * spacing;
        let mended = if deeper > 0.0 { (MENDED[0] * deeper).min(MENDED[1] * spacing) } else { 0.0 };
        let target = gap.min(0.0) + mended;
        let (side, point, impulse) = (self.number, n as u32, [0.0; 3]);
        Touch { side, point, facet, nodes, weights, normal, gap, target, spacing, impulse }
    }

    fn start(&self, way: &Way, scratch: &mut Scratch, touches: &mut Vec<Touch>) {
        let ahead = self.farthest(way, &scratch.facets);
        self.look(way, 0.0, false, ahead, scratch);
        for feature in &scratch.features {
            let gap = feature.height - way.half;
            let near = gap + self.parting(way, feature) * self.dt < BESIDE * way.spacing;
            let radius = self.side.spheres[feature.facet as usize].radius;
            let upon = gap <= ALLOWED * way.spacing;
            if near && (upon || self.travel(way, feature.facet) <= SLOW * radius) {
                touches.push(self.touch(way, feature, gap));
            }
        }
    }

    /// Find the first passage of the point: advance along its path by its clearance from every facet, at least by the allowed penetration
    /// (conservative advancement \[Mirtich1996\]).
    fn first_on_the_way(&self, way: &Way, every: bool, scratch: &mut Scratch, touches: &mut Vec<Touch>) {
        let travel = self.farthest(way, &scratch.facets);
        let shortest = (ALLOWED * way.spacing).max(travel / PLACES);
        let (mut part, before) = (0.0, touches.len());
        loop {
            let [_, clear] = self.look(way, part, every, 0.0, scratch);
            let seen = -SEEN * way.spacing;
            for feature in &scratch.features {
                let gap = feature.height - way.half;
                let motion = self.parting(way, feature) * self.dt;
                if gap <= 0.0 && motion <= seen && gap + (1.0 - part) * motion <= seen {
                    touches.push(self.touch(way, feature, gap - part * motion));
                }
            }
            if touches.len() > before || part >= 1.0 || travel <= 0.0 {
                return;
            }
            part = (part + (clear - way.half).max(shortest) / travel).min(1.0);
        }
    }
}

/// Distance of a point to the slab between two parallel planes that contains these corners, along the mean normal of the facet; zero in the
/// plane.
fn off_planes(x: [f64; 3], corners: &[[f64; 3]]) -> f64 {
    let normal = match *corners {
        [a, b, c] => cross(difference(b, a), difference(c, a)),
        [a, b, c, d] => cross(difference(c, a), difference(d, b)),
        _ => return 0.0,
    };
    let square = dot(normal, normal);
    if square == 0.0 {
        return 0.0;
    }
    let height = |corner: &[f64; 3]| dot(normal, difference(*corner, x));
    let (low, high) = corners
        .iter()
        .map(height)
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), h| (low.min(h), high.max(h)));
    // Rounding must not exclude a contact.
    low.max(-high).max(0.0) / square.sqrt() * (1.0 - 1e-9)
}
