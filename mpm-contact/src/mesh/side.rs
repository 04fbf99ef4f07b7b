//! Points of one body against facets of another, or of the same: neighbour search.

use std::collections::HashMap;

use impactite_geometry::Facet;
use impactite_geometry::search::{Points, Reach, SearchError, VerletListsBetween};
use impactite_scene::{Archive, CheckpointError};
use impactite_simd::Team;

use super::body::{BESIDE, ContactBody, Sphere, Surface};
use crate::vector::{dot, sum, times};

/// Initial and largest skin of the lists, over the mean spacing of the points.
const SKIN: [f64; 2] = [0.5, 4.0];
/// Skin of lists of points with labels, which change in every step.
const BRIEF: f64 = 0.1;
/// Number of steps served by lists below which their skin is increased.
const OFTEN: u64 = 4;
/// Number of points per task.
const CHUNK: usize = 256;

/// Points of one body against the facets of another.
#[derive(Clone, Debug)]
pub(super) struct Facing<const D: usize> {
    /// Body of the points, and body of the facets.
    pub bodies: [usize; 2],
    /// True if contact is possible in the step.
    pub near: bool,
    lists: Option<VerletListsBetween<D>>,
    /// Number of updates since the last search.
    age: u64,
    searches: u64,
    /// Facet of the last contact of each point; [`Facet::NONE`] for none.
    pub held: Vec<u32>,
    /// Labels of these points, if any.
    labels: Vec<u64>,
    pub spheres: Vec<Sphere>,
    swept: [Swept<D>; 2],
    /// True after a step since the start, or since a checkpoint was loaded.
    seen: bool,
}

/// Spheres that contain moving objects through the whole step.
#[derive(Clone, Debug)]
struct Swept<const D: usize> {
    centres: Vec<[f64; D]>,
    radii: Vec<f64>,
}

impl<const D: usize> Default for Swept<D> {
    fn default() -> Self {
        Swept { centres: Vec::new(), radii: Vec::new() }
    }
}

impl<const D: usize> Swept<D> {
    fn fill(&mut self, count: usize, team: &Team, of: impl Fn(usize) -> ([f64; D], f64) + Send + Sync) {
        self.centres.resize(count, [0.0; D]);
        self.radii.resize(count, 0.0);
        let mut rows: Vec<_> = self.centres.chunks_mut(CHUNK).zip(self.radii.chunks_mut(CHUNK)).collect();
        team.each(&mut rows, |chunk, (centres, radii)| {
            for (i, (centre, radius)) in centres.iter_mut().zip(radii.iter_mut()).enumerate() {
                (*centre, *radius) = of(chunk * CHUNK + i);
            }
        });
    }
}

fn narrow<const D: usize>(x: [f64; 3]) -> [f64; D] {
    std::array::from_fn(|d| x[d])
}

impl<const D: usize> Facing<D> {
    pub fn new(bodies: [usize; 2]) -> Self {
        Facing {
            bodies,
            near: false,
            lists: None,
            age: 0,
            searches: 0,
            held: Vec::new(),
            labels: Vec::new(),
            spheres: Vec::new(),
            swept: [Swept::default(), Swept::default()],
            seen: false,
        }
    }

    /// True if points and facets belong to one body.
    pub fn is_within(&self) -> bool {
        self.bodies[0] == self.bodies[1]
    }

    pub fn searches(&self) -> u64 {
        self.searches
    }

    pub fn bytes(&self) -> usize {
        let swept = |s: &Swept<D>| s.centres.capacity() * size_of::<[f64; D]>() + s.radii.capacity() * 8;
        self.lists.as_ref().map_or(0, VerletListsBetween::bytes)
            + (self.held.capacity() + 2 * self.labels.capacity()) * 4
            + self.spheres.capacity() * size_of::<Sphere>()
            + self.swept.iter().map(swept).sum::<usize>()
    }

    /// Register that body `n` has another surface. The last contacts are kept where they may be valid: after a checkpoint, and for points
    /// with labels.
    pub fn is_of(&mut self, n: usize, body: &ContactBody<'_, D>) {
        let [points, facets] = self.bodies;
        let labelled = n == points && !body.labels.is_empty();
        if labelled && n != facets {
            return;
        }
        self.lists = None;
        let fits = (n != points || labelled || self.held.len() == body.positions.len())
            && (n != facets
                || self.held.iter().all(|&f| f == Facet::NONE || (f as usize) < body.facets.len()));
        if !fits || self.seen {
            self.held.clear();
            self.labels.clear();
        }
    }

    /// Reassign the last contacts to points by their labels.
    pub fn follow(&mut self, labels: &[u64]) {
        if self.labels == labels {
            return;
        }
        let before = self.labels.iter().zip(&self.held).filter(|(_, facet)| **facet != Facet::NONE);
        let before: HashMap<u64, u32> = before.map(|(label, facet)| (*label, *facet)).collect();
        self.held = labels.iter().map(|label| before.get(label).copied().unwrap_or(Facet::NONE)).collect();
        self.labels = labels.to_vec();
    }

    /// Store or load the checkpoint data.
    pub fn archive(&mut self, file: &mut Archive) -> Result<(), CheckpointError> {
        file.list(&mut self.held, &Facet::NONE, |file, facet| file.index(facet, 1 << 32))?;
        file.list(&mut self.labels, &0, Archive::word)?;
        if file.reads() {
            (self.lists, self.seen) = (None, false);
        }
        Ok(())
    }

    /// Update the candidates for these velocities (of both bodies, by point), over a step `dt`.
    pub fn update(
        &mut self,
        points: &ContactBody<'_, D>,
        facets: &ContactBody<'_, D>,
        surface: &Surface,
        velocities: [&[[f64; 3]]; 2],
        dt: f64,
        team: &Team,
    ) -> Result<(), SearchError> {
        self.held.resize(points.positions.len(), Facet::NONE);
        self.seen = true;
        let mut spheres = std::mem::take(&mut self.spheres);
        let still = Sphere { centre: [0.0; 3], radius: 0.0, velocity: [0.0; 3], spread: 0.0 };
        spheres.resize(facets.facets.len(), still);
        let mut rows: Vec<_> = spheres.chunks_mut(CHUNK).collect();
        team.each(&mut rows, |chunk, spheres| {
            for (i, sphere) in spheres.iter_mut().enumerate() {
                let nodes = facets.facets[chunk * CHUNK + i].nodes();
                let (mut x, mut v) = ([[0.0; 3]; 4], [[0.0; 3]; 4]);
                for (k, &n) in nodes.iter().enumerate() {
                    (x[k], v[k]) = (facets.position(n as usize), velocities[1][n as usize]);
                }
                *sphere = Sphere::of(&x[..nodes.len()], &v[..nodes.len()]);
            }
        });
        let [of_points, of_facets] = &mut self.swept;
        of_points.fill(surface.touching.len(), team, |i| {
            let n = surface.touching[i] as usize;
            let half_way = times(velocities[0][n], 0.5 * dt);
            let centre = sum(points.position(n), half_way);
            let reach = points.half_size(n) + BESIDE * surface.spacing(points, n);
            (narrow(centre), reach + dot(half_way, half_way).sqrt())
        });
        of_facets.fill(spheres.len(), team, |f| {
            let Sphere { centre, radius, velocity, spread } = spheres[f];
            let half_way = times(velocity, 0.5 * dt);
            let radius = radius + spread * dt + dot(half_way, half_way).sqrt();
            // Rounding must not lose a facet that touches its sphere.
            (narrow(sum(centre, half_way)), radius * (1.0 + 1e-12))
        });
        self.spheres = spheres;
        self.search(points, surface, team)
    }

    fn search(
        &mut self,
        points: &ContactBody<'_, D>,
        surface: &Surface,
        team: &Team,
    ) -> Result<(), SearchError> {
        let count = surface.touching.len().max(1) as f64;
        let all = surface.touching.iter();
        let mut lists = match self.lists.take() {
            Some(lists) => lists,
            None => {
                let spacing = all.map(|&n| surface.spacing(points, n as usize)).sum::<f64>() / count;
                self.age = OFTEN;
                let skin = if self.labels.is_empty() { SKIN[0] } else { BRIEF };
                VerletListsBetween::new(Reach::sum(0.0), skin * spacing)?
            }
        };
        let [of_points, of_facets] = &self.swept;
        let facets = Points::new(&of_facets.centres, &of_facets.radii)?;
        if lists.update(&facets, &Points::new(&of_points.centres, &of_points.radii)?, team)? {
            self.searches += 1;
            // Increase the skin from the next search on.
            if self.age < OFTEN && self.labels.is_empty() {
                let spacing =
                    surface.touching.iter().map(|&n| surface.spacing(points, n as usize)).sum::<f64>()
                        / count;
                let thicker = (2.0 * lists.skin()).min(SKIN[1] * spacing);
                if thicker > lists.skin() {
                    lists.set_skin(thicker)?;
                }
            }
            self.age = 0;
        }
        self.age += 1;
        self.lists = Some(lists);
        Ok(())
    }

    /// Facets that may be near point `i` of those in `touching`, in ascending order.
    pub fn candidates(&self, i: usize) -> &[u32] {
        self.lists.as_ref().map_or(&[], |lists| lists.of(i))
    }
}
