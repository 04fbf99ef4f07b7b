//! Tessellation strategies, and limits on elements.

mod delaunay;
mod fan;

use std::sync::OnceLock;

use impactite_simd::Team;

pub use delaunay::LocalDelaunay;
pub use fan::AzimuthFan;

use crate::elements::Incidence;
use crate::particles::Particle;
use crate::search::Neighbours;
use crate::simplex::{Angles, Corners, distance_squared, measure};
use impactite_scene::SceneError;
use impactite_scene::error::parameter;

/// Input of a strategy.
#[derive(Debug)]
pub struct View<'a, const D: usize> {
    /// All particles.
    pub particles: &'a [Particle<D>],
    /// Neighbours in range, by [`Tessellation::reach`].
    pub neighbours: &'a Neighbours<D>,
    /// Present elements: `D + 1` particles each, positively oriented.
    pub nodes: &'a [u32],
    /// Incidence of elements at particles.
    pub incidence: &'a Incidence,
    /// Thread pool.
    pub team: &'a Team,
    /// Cache of [`View::open`].
    pub(crate) open: &'a OnceLock<Vec<bool>>,
}

impl<const D: usize> View<'_, D> {
    /// Number of elements.
    pub fn elements(&self) -> usize {
        self.nodes.len() / (D + 1)
    }
    /// Return the particles of element `e`.
    pub fn element(&self, e: usize) -> &[u32] {
        &self.nodes[e * (D + 1)..(e + 1) * (D + 1)]
    }
    /// Return the positions of the particles `nodes`.
    pub fn corners(&self, nodes: &[u32]) -> Corners<D> {
        corners(self.particles, nodes)
    }
    /// Return the element across the facet of element `e` opposite to its corner `k`, and that element's corner opposite to the facet; the
    /// first one if there are several.
    pub fn across(&self, e: usize, k: usize) -> Option<(usize, usize)> {
        let element = self.element(e);
        let mut facet = [0; 3];
        for i in 0..D {
            facet[i] = element[(k + 1 + i) % (D + 1)];
        }
        for &at in self.incidence.of(facet[0] as usize) {
            let other = at as usize / (D + 1);
            let nodes = self.element(other);
            if other != e && facet[1..D].iter().all(|n| nodes.contains(n)) {
                return nodes.iter().position(|n| !facet[..D].contains(n)).map(|corner| (other, corner));
            }
        }
        None
    }
    /// Flags of open particles: on a facet with one side only, or in no element.
    pub fn open(&self) -> &[bool] {
        self.open.get_or_init(|| {
            let mut open = vec![false; self.particles.len()];
            for (n, open) in open.iter_mut().enumerate() {
                *open = self.incidence.of(n).is_empty();
            }
            for e in 0..self.elements() {
                for k in (0..=D).filter(|&k| self.across(e, k).is_none()) {
                    for (a, &n) in self.element(e).iter().enumerate() {
                        open[n as usize] |= a != k;
                    }
                }
            }
            open
        })
    }
    /// True if there is an element of these particles, in any order.
    pub fn has(&self, nodes: &[u32]) -> bool {
        self.find(nodes).is_some()
    }
    /// Return the element of these particles, in any order.
    pub fn find(&self, nodes: &[u32]) -> Option<usize> {
        let of_first = self.incidence.of(nodes[0] as usize).iter().map(|&at| at as usize / (D + 1));
        of_first.into_iter().find(|&e| nodes[1..].iter().all(|n| self.element(e).contains(n)))
    }
}

/// Return the positions of the particles `nodes`.
pub(crate) fn corners<const D: usize>(particles: &[Particle<D>], nodes: &[u32]) -> Corners<D> {
    let mut x = [[0.0; D]; 4];
    for (a, &n) in nodes.iter().enumerate() {
        x[a] = particles[n as usize].position;
    }
    x
}

/// Return the particles of an element in ascending order; entries beyond the last are `u32::MAX`.
pub(crate) fn sorted(nodes: &[u32]) -> [u32; 4] {
    let mut list = [u32::MAX; 4];
    list[..nodes.len()].copy_from_slice(nodes);
    list.sort_unstable();
    list
}

/// Changes requested by a strategy.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Revision {
    /// Elements to delete, in ascending order.
    pub dead: Vec<u32>,
    /// Elements to create: `D + 1` particles each, positively oriented.
    pub born: Vec<u32>,
    /// Number of deleted elements by failed condition; those replaced by better ones are not counted.
    pub flaws: [usize; Flaw::COUNT],
}

impl Revision {
    /// True if there is nothing to change.
    pub fn is_empty(&self) -> bool {
        self.dead.is_empty() && self.born.is_empty()
    }
}

/// Strategy that creates and deletes elements.
pub trait Tessellation<const D: usize>: std::fmt::Debug + Clone + Send + Sync + 'static {
    /// The name in tables and messages.
    const NAME: &'static str;
    /// Contact tolerance (delta of \[Feng2014\]), m: particles closer than R_i + R_j + reach are neighbours.
    fn reach(&self) -> f64;
    /// Return the changes to make now. Without elements, create the first ones.
    fn revise(&self, view: &View<'_, D>) -> Revision;
}

/// Condition that an element fails.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Flaw {
    /// Two particles are not in contact: d > R_i + R_j + delta.
    Contact = 0,
    /// An angle is too small, or the element is flat or inverted.
    SmallAngle = 1,
    /// An angle is too large.
    LargeAngle = 2,
    /// An edge is too short against the mean radius.
    ShortEdge = 3,
}

impl Flaw {
    /// Number of conditions.
    pub const COUNT: usize = 4;
}

/// Conditions of \[Feng2014\] on an element:
///
/// 1. d_ij <= R_i + R_j + delta for all pairs;
/// 2. all angles between facets (in a triangle the inner angles, in a tetrahedron the dihedral ones) in a range;
/// 3. d_ij >= a part of the mean radius of its particles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    tolerance: f64,
    cosine_small: f64,
    cosine_large: f64,
    shortest_edge: f64,
}

impl Limits {
    /// Create the original limits, angles from 30 to 150 degrees and edges of at least half the mean radius, for a tolerance delta (m;
    /// \[Feng2014\] gives no value).
    ///
    /// # Errors
    /// A negative or non-finite tolerance.
    pub fn printed(tolerance: f64) -> Result<Self, SceneError> {
        Self::new(tolerance, [30.0, 150.0], 0.5)
    }

    /// Create limits with the tolerance delta, m, the smallest and the largest angle, degrees, and the shortest edge over the mean radius.
    ///
    /// # Errors
    /// A negative tolerance or edge; angles that are not 0 <= smallest < largest <= 180.
    pub fn new(
        tolerance: f64,
        [smallest, largest]: [f64; 2],
        shortest_edge: f64,
    ) -> Result<Self, SceneError> {
        let owner = "limits of an element";
        let zero_or_more = "zero or positive, and finite";
        let good = |x: f64| x >= 0.0 && x.is_finite();
        parameter(good(tolerance), owner, "tolerance delta", tolerance, zero_or_more)?;
        parameter(
            (0.0..180.0).contains(&smallest),
            owner,
            "smallest angle",
            smallest,
            "from 0 to below 180",
        )?;
        let above = largest > smallest && largest <= 180.0;
        parameter(above, owner, "largest angle", largest, "above the smallest and at most 180")?;
        parameter(good(shortest_edge), owner, "shortest edge", shortest_edge, zero_or_more)?;
        Ok(Limits {
            tolerance,
            cosine_small: smallest.to_radians().cos(),
            cosine_large: largest.to_radians().cos(),
            shortest_edge,
        })
    }

    /// Contact tolerance delta, m.
    pub fn tolerance(&self) -> f64 {
        self.tolerance
    }

    /// True if two particles are in contact.
    pub fn touch<const D: usize>(&self, a: &Particle<D>, b: &Particle<D>) -> bool {
        distance_squared(&a.position, &b.position) <= self.range(a, b).powi(2)
    }

    /// Largest distance of two particles in contact, m.
    fn range<const D: usize>(&self, a: &Particle<D>, b: &Particle<D>) -> f64 {
        a.radius + b.radius + self.tolerance
    }

    /// Return the first condition that the element of the particles `nodes` fails, if any. An inverted element has a [`Flaw::SmallAngle`].
    pub fn flaw<const D: usize>(&self, particles: &[Particle<D>], nodes: &[u32]) -> Option<Flaw> {
        self.flaw_of(particles, nodes, &Angles::of(&corners(particles, nodes)))
    }

    /// Return the first failed condition, with the element's angles.
    fn flaw_of<const D: usize>(
        &self,
        particles: &[Particle<D>],
        nodes: &[u32],
        angles: &Angles<D>,
    ) -> Option<Flaw> {
        let mean = nodes.iter().map(|&n| particles[n as usize].radius).sum::<f64>() / nodes.len() as f64;
        let shortest = (self.shortest_edge * mean).powi(2);
        let mut short = false;
        for (k, &a) in nodes.iter().enumerate() {
            for &b in &nodes[..k] {
                let (a, b) = (&particles[a as usize], &particles[b as usize]);
                let squared = distance_squared(&a.position, &b.position);
                if squared > self.range(a, b).powi(2) {
                    return Some(Flaw::Contact);
                }
                short |= squared < shortest;
            }
        }
        // A flat simplex has no angles.
        if !(angles.measure > 0.0 && angles.none_above(self.cosine_small)) {
            return Some(Flaw::SmallAngle);
        }
        if !angles.none_below(self.cosine_large) {
            return Some(Flaw::LargeAngle);
        }
        short.then_some(Flaw::ShortEdge)
    }
}

/// Put the particles of an element in positive orientation.
pub(crate) fn orient<const D: usize>(particles: &[Particle<D>], nodes: &mut [u32]) {
    if measure(&corners(particles, nodes)) < 0.0 {
        nodes.swap(0, 1);
    }
}

/// Results of an inspection of all elements.
pub(crate) struct Inspected {
    /// Elements that fail the limits, and their number by condition.
    pub failing: Revision,
    /// Elements with a smallest angle whose cosine is above a limit, and flat elements.
    pub poor: Vec<u32>,
}

/// Inspect all elements.
pub(crate) fn inspect<const D: usize>(view: &View<'_, D>, limits: &Limits, poor: f64) -> Inspected {
    const CHUNK: usize = 1024;
    let elements = view.elements();
    let none = || Inspected { failing: Revision::default(), poor: Vec::new() };
    let mut parts: Vec<Inspected> = (0..elements.div_ceil(CHUNK)).map(|_| none()).collect();
    view.team.each(&mut parts, |chunk, part| {
        for e in chunk * CHUNK..((chunk + 1) * CHUNK).min(elements) {
            let angles = Angles::of(&view.corners(view.element(e)));
            if !angles.none_above(poor) {
                part.poor.push(e as u32);
            }
            if let Some(flaw) = limits.flaw_of(view.particles, view.element(e), &angles) {
                part.failing.dead.push(e as u32);
                part.failing.flaws[flaw as usize] += 1;
            }
        }
    });
    let mut all = none();
    for part in parts {
        all.poor.extend(part.poor);
        all.failing.dead.extend(part.failing.dead);
        for k in 0..Flaw::COUNT {
            all.failing.flaws[k] += part.failing.flaws[k];
        }
    }
    all
}
