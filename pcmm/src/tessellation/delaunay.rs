//! Tessellation with single coverage.

use super::{Inspected, Limits, Revision, Tessellation, View, corners, inspect, orient, sorted};
use crate::simplex::{Angles, Corners, circumsphere, distance_squared, measure, overlap};
use impactite_scene::SceneError;
use impactite_scene::error::parameter;

/// Shear of the coordinates for the test of spheres, against the degeneracy of lattices: a square is cut along one diagonal, a cube into
/// six tetrahedra around one (Freudenthal's), everywhere the same. For that the edges of a cube must form obtuse angles, so that the shear
/// is negative. Rounding is far below it.
const SHEAR: f64 = -1e-3;
/// Largest overlap of two adjacent elements, over the smaller one.
const TOUCHING: f64 = 1e-9;
/// Tolerance of the sphere test: relative difference of squared distances by which a particle is within a sphere.
const INSIDE: f64 = 1e-9;

/// Elements with an empty circumsphere (Delaunay), created in uncovered space only; hysteresis between creation and deletion; in two
/// dimensions poor pairs of triangles exchange their diagonal.
///
/// A revision
/// 1. exchanges the diagonal of pairs of triangles with an angle below `improve`, if the smallest angle of the pair
///    grows by a fifth or more (two dimensions);
/// 2. deletes elements that fail the limits `keep`;
/// 3. searches the particles that are not surrounded for elements with an empty circumsphere that pass the limits `create` and overlap no
///    element, and creates these, smallest sphere first.
///
/// Overlapping elements are not created, so that material is never covered twice. A new element needs better angles and shorter edges than
/// an old one, so that none is created and deleted in turn. A slight shear of the coordinates breaks ties of lattices.
///
/// Limits: overlap is checked with the elements at the new element's particles and at the neighbours of its first one; the check may miss
/// two sheets that pass through each other with elements longer than the contact range. In three dimensions there is no exchange.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LocalDelaunay {
    create: Limits,
    keep: Limits,
    improve: f64,
    gain: f64,
}

impl LocalDelaunay {
    /// Create a tessellation with a contact tolerance delta, m: elements are created with angles from 10 to 160 degrees and edges of at
    /// least half the mean radius, kept with angles from 0.5 to 179 degrees, edges of at least a tenth of the mean radius and gaps up to
    /// `stretch` times delta. Diagonals are exchanged below 25 degrees.
    ///
    /// On a square lattice of spacing h with radii h/2 the diagonals are in contact with delta of 0.42 h or more. A body with large plastic
    /// flow needs a large `stretch`: elements that lose contact are cracks.
    ///
    /// # Errors
    /// A tolerance that is not positive and finite, a stretch below 1.
    pub fn new(tolerance: f64, stretch: f64) -> Result<Self, SceneError> {
        let owner = "local Delaunay";
        parameter(tolerance > 0.0, owner, "tolerance delta", tolerance, "positive and finite")?;
        parameter(stretch >= 1.0, owner, "stretch", stretch, "at least 1 and finite")?;
        let create = Limits::new(tolerance, [10.0, 160.0], 0.5)?;
        let keep = Limits::new(tolerance * stretch, [0.5, 179.0], 0.1)?;
        Ok(LocalDelaunay { create, keep, improve: 25f64.to_radians().cos(), gain: 1.2 })
    }

    /// Set the limits for creating and keeping elements.
    #[must_use]
    pub fn with_limits(self, create: Limits, keep: Limits) -> Self {
        LocalDelaunay { create, keep, ..self }
    }

    /// Set the angle below which pairs exchange their diagonals, degrees; 0 for never.
    ///
    /// # Errors
    /// An angle outside [0, 60).
    pub fn with_exchange_below(self, angle: f64) -> Result<Self, SceneError> {
        let good = (0.0..60.0).contains(&angle);
        parameter(good, "local Delaunay", "angle of exchange", angle, "from 0 to below 60 degrees")?;
        Ok(LocalDelaunay { improve: angle.to_radians().cos(), ..self })
    }
}

/// Cosine of the smallest angle of a triangle; one for a triangle that is not positively oriented.
fn cosine<const D: usize>(angles: &Angles<D>) -> f64 {
    if angles.measure > 0.0 { angles.largest_cosine() } else { 1.0 }
}

impl LocalDelaunay {
    /// Exchange diagonals of pairs of triangles; add deleted and new elements to the revision.
    fn exchange<const D: usize>(&self, view: &View<'_, D>, worst: &[u32], revision: &mut Revision) {
        if worst.is_empty() {
            return;
        }
        let mut used = vec![false; view.elements()];
        for e in worst.iter().map(|&e| e as usize) {
            if used[e] {
                continue;
            }
            let element = view.element(e);
            let angles = |nodes: &[u32]| Angles::of(&corners(view.particles, nodes));
            let own = cosine(&angles(element));
            let mut best: Option<(f64, usize, [u32; 6])> = None;
            for k in 0..3 {
                let Some((other, opposite)) = view.across(e, k) else { continue };
                if used[other] {
                    continue;
                }
                let (top, a, b) = (element[k], element[(k + 1) % 3], element[(k + 2) % 3]);
                let foot = view.element(other)[opposite];
                let pair = [top, a, foot, top, foot, b];
                let halves = [angles(&pair[..3]), angles(&pair[3..])];
                if halves.iter().any(|half| half.measure <= 0.0) {
                    continue;
                }
                let across = angles(view.element(other));
                let before = if across.measure > 0.0 && across.none_above(own) {
                    own
                } else {
                    own.max(cosine(&across))
                };
                let all_below = |cosine: f64| halves.iter().all(|half| half.none_above(cosine));
                // The angle must grow by a factor: most do not grow at all.
                if !all_below(before) || !all_below((self.gain * before.acos()).cos()) {
                    continue;
                }
                let after = cosine(&halves[0]).max(cosine(&halves[1]));
                let sound = |nodes: &[u32]| self.keep.flaw(view.particles, nodes).is_none();
                let better = best.is_none_or(|(least, ..)| after < least);
                if better && sound(&pair[..3]) && sound(&pair[3..]) {
                    best = Some((after, other, pair));
                }
            }
            if let Some((_, other, pair)) = best {
                used[e] = true;
                used[other] = true;
                revision.dead.extend([e as u32, other as u32]);
                revision.born.extend(pair);
            }
        }
    }

    /// Return elements with an empty circumsphere among particles that are `open`, smallest sphere first, but for present ones that are not
    /// `dead`.
    fn candidates<const D: usize>(
        &self,
        view: &View<'_, D>,
        open: &[bool],
        dead: &[u32],
    ) -> Vec<(f64, [u32; 4])> {
        const CHUNK: usize = 128;
        let particles = view.particles.len();
        let mut parts: Vec<Vec<(f64, [u32; 4])>> = vec![Vec::new(); particles.div_ceil(CHUNK)];
        view.team.each(&mut parts, |chunk, found| {
            let mut partners = Vec::new();
            for a in chunk * CHUNK..((chunk + 1) * CHUNK).min(particles) {
                if open[a] {
                    let near = |&n: &u32| {
                        n as usize > a
                            && open[n as usize]
                            && self.create.touch(&view.particles[a], &view.particles[n as usize])
                    };
                    partners.clear();
                    partners.extend(view.neighbours.of(a).iter().copied().filter(near));
                    let mut nodes = [u32::MAX; 4];
                    nodes[0] = a as u32;
                    self.choose(view, &partners, &mut nodes, 1, &mut |element: &[u32; 4]| {
                        let there = view.find(&element[..=D]);
                        if there.is_none_or(|e| dead.binary_search(&(e as u32)).is_ok()) {
                            found.extend(self.sound(view, element));
                        }
                    });
                }
            }
        });
        let mut found = parts.concat();
        found.sort_unstable_by(|p, q| p.0.total_cmp(&q.0).then(p.1.cmp(&q.1)));
        found
    }

    /// Complete `nodes`, of which `chosen` are set, by partners in ascending order that touch each other.
    fn choose<const D: usize>(
        &self,
        view: &View<'_, D>,
        partners: &[u32],
        nodes: &mut [u32; 4],
        chosen: usize,
        found: &mut impl FnMut(&[u32; 4]),
    ) {
        if chosen == D + 1 {
            return found(nodes);
        }
        for (k, &n) in partners.iter().enumerate() {
            let touches =
                |&m: &u32| self.create.touch(&view.particles[m as usize], &view.particles[n as usize]);
            // All partners touch the first one.
            if nodes[1..chosen].iter().all(touches) {
                nodes[chosen] = n;
                self.choose(view, &partners[k + 1..], nodes, chosen + 1, found);
            }
        }
    }

    /// Return an element, oriented, and the squared radius of its circumsphere, if that is empty and the element passes the limits.
    fn sound<const D: usize>(&self, view: &View<'_, D>, nodes: &[u32; 4]) -> Option<(f64, [u32; 4])> {
        let mut element = *nodes;
        orient(view.particles, &mut element[..=D]);
        if self.create.flaw(view.particles, &element[..=D]).is_some() {
            return None;
        }
        Some((empty_sphere(view, &element[..=D])?, element))
    }
}

/// Return sheared coordinates relative to `origin`.
fn sheared<const D: usize>(x: &[f64; D], origin: &[f64; D]) -> [f64; D] {
    let mut y = [0.0; D];
    for d in 0..D {
        y[d] = x[d] - origin[d];
    }
    let sum: f64 = y.iter().sum();
    for d in 0..D {
        y[d] += SHEAR * (sum - y[d]);
    }
    y
}

/// Return the squared radius of the circumsphere (in sheared coordinates), if no neighbour is within.
fn empty_sphere<const D: usize>(view: &View<'_, D>, nodes: &[u32]) -> Option<f64> {
    let at = |n: u32| &view.particles[n as usize].position;
    let origin = at(nodes[0]);
    let mut x: Corners<D> = [[0.0; D]; 4];
    for (a, &n) in nodes.iter().enumerate() {
        x[a] = sheared(at(n), origin);
    }
    let (centre, squared) = circumsphere(&x);
    let within = |&n: &u32| {
        !nodes.contains(&n) && distance_squared(&sheared(at(n), origin), &centre) < squared * (1.0 - INSIDE)
    };
    let blocked = nodes.iter().any(|&n| view.neighbours.of(n as usize).iter().any(within));
    (!blocked && squared.is_finite()).then_some(squared)
}

/// Growing list of elements, by particle.
struct Laid {
    nodes: Vec<u32>,
    at: Vec<Vec<u32>>,
}

impl Laid {
    fn push(&mut self, element: &[u32]) {
        let e = (self.nodes.len() / element.len()) as u32;
        for &n in element {
            self.at[n as usize].push(e);
        }
        self.nodes.extend_from_slice(element);
    }
}

impl<const D: usize> Tessellation<D> for LocalDelaunay {
    const NAME: &'static str = "local Delaunay with hysteresis";

    fn reach(&self) -> f64 {
        self.create.tolerance()
    }

    fn revise(&self, view: &View<'_, D>) -> Revision {
        let mut revision = Revision::default();
        let Inspected { failing: bad, poor } = inspect(view, &self.keep, self.improve);
        if D == 2 {
            self.exchange(view, &poor, &mut revision);
        }
        revision.dead.sort_unstable();
        let exchanged = revision.dead.clone();
        for e in bad.dead {
            if exchanged.binary_search(&e).is_err() {
                revision.dead.push(e);
            }
        }
        revision.flaws = bad.flaws;
        revision.dead.sort_unstable();

        // Particles of deleted elements may take part in new ones.
        let mut open = std::borrow::Cow::Borrowed(view.open());
        for &e in &revision.dead {
            for &n in view.element(e as usize) {
                open.to_mut()[n as usize] = true;
            }
        }
        let candidates = self.candidates(view, &open, &revision.dead);
        if candidates.is_empty() {
            return revision;
        }
        // Present elements: the survivors and the exchanged pairs.
        let mut laid = Laid { nodes: Vec::new(), at: vec![Vec::new(); view.particles.len()] };
        let mut dead = revision.dead.iter().peekable();
        for (e, element) in view.nodes.chunks_exact(D + 1).enumerate() {
            if dead.next_if(|d| **d as usize == e).is_none() {
                laid.push(element);
            }
        }
        for element in revision.born.chunks_exact(D + 1) {
            laid.push(element);
        }
        for (_, element) in &candidates {
            let element = &element[..=D];
            if !overlaps(view, &laid, element) {
                laid.push(element);
                revision.born.extend_from_slice(element);
            }
        }
        revision
    }
}

/// True if the element overlaps one in the list.
fn overlaps<const D: usize>(view: &View<'_, D>, laid: &Laid, element: &[u32]) -> bool {
    let x = view.corners(element);
    let size = measure(&x);
    let over = |&e: &u32| {
        let other = &laid.nodes[e as usize * (D + 1)..(e as usize + 1) * (D + 1)];
        let y = view.corners(other);
        sorted(other) == sorted(element) || overlap(&x, &y, false) > TOUCHING * size.min(measure(&y))
    };
    let first = view.neighbours.of(element[0] as usize);
    element.iter().chain(first).any(|&n| laid.at[n as usize].iter().any(over))
}
