//! Candidate pairs of particles of different bodies for contact.

use impactite_geometry::search::{FARTHEST, NeighbourSearch, Points, Reach, SortedCells};

use super::body::ParticleBody;
use super::member::{Member, Place, particles};

/// Range of candidate pairs, in sums of radii: with surfaces through the centres, particles of two bodies face each other half a spacing
/// beside each other.
pub(super) const RANGE: f64 = 1.5;
/// Range with surfaces, in sums of radii: their points are up to 1.8 spacings beside each other.
const SURFACE_RANGE: f64 = 2.25;
/// Skin of the lists, over the mean radius.
const SKIN: f64 = 1.0;

/// Pairs within range plus a skin, kept until something has moved half the skin. Ascending order: the list does not depend on the cell
/// grid.
#[derive(Clone, Debug, Default)]
pub(super) struct Candidates {
    pairs: Vec<[Place; 2]>,
    /// Particles and walls of pairs of which a body has a surface, ascending; `others`: the partners of each, ascending.
    pub near: Vec<Place>,
    starts: Vec<u32>,
    others: Vec<u32>,
    searched: bool,
    /// Largest motion of a particle since the search, m.
    moved: f64,
    skin: f64,
    pub searches: u64,
}

impl Candidates {
    /// Invalidate the lists.
    pub fn forget(&mut self) {
        self.searched = false;
    }

    /// Register a motion of at most this distance, m.
    pub fn moved(&mut self, distance: f64) {
        self.moved += distance;
    }

    /// Search again if pairs may have changed.
    pub fn update<const D: usize>(&mut self, members: &[Member<D>]) {
        // Two particles that approach each other may both have moved.
        if !self.searched || 2.0 * self.moved > self.skin {
            self.search(members);
        }
    }

    /// Pairs of bodies without surfaces.
    pub fn pairs(&self) -> &[[Place; 2]] {
        &self.pairs
    }

    /// Partners of number `p` of [`near`](Candidates::near), by their numbers there.
    pub fn others(&self, p: usize) -> &[u32] {
        &self.others[self.starts[p] as usize..self.starts[p + 1] as usize]
    }

    /// Move pairs of which a body has a surface to lists by particle.
    fn sort_by_particle<const D: usize>(&mut self, members: &[Member<D>]) {
        let has: Vec<bool> =
            members.iter().map(|m| m.part().is_some_and(ParticleBody::has_surface)).collect();
        let of_surface = |pair: &[Place; 2]| pair.iter().any(|p| has[p.body as usize]);
        let pairs: Vec<[Place; 2]> = self.pairs.iter().copied().filter(of_surface).collect();
        self.pairs.retain(|pair| !of_surface(pair));
        self.near = pairs.iter().flatten().copied().collect();
        self.near.sort_unstable();
        self.near.dedup();
        let number = |place: &Place| self.near.binary_search(place).unwrap_or(0) as u32;
        let mut both: Vec<[u32; 2]> = Vec::with_capacity(2 * pairs.len());
        for pair in &pairs {
            let [a, b] = [number(&pair[0]), number(&pair[1])];
            both.extend([[a, b], [b, a]]);
        }
        both.sort_unstable();
        self.starts = vec![0; self.near.len() + 1];
        both.iter().for_each(|pair| self.starts[pair[0] as usize + 1] += 1);
        (0..self.near.len()).for_each(|p| self.starts[p + 1] += self.starts[p]);
        self.others = both.iter().map(|pair| pair[1]).collect();
    }

    fn search<const D: usize>(&mut self, members: &[Member<D>]) {
        (self.searched, self.moved) = (true, 0.0);
        self.searches += 1;
        self.pairs.clear();
        let (mut radii, mut count, mut largest) = (0.0, 0usize, 0.0f64);
        for part in members.iter().filter_map(Member::part) {
            count += part.len();
            for p in particles(part) {
                radii += p.radius;
                largest = largest.max(p.radius);
            }
        }
        self.skin = SKIN * radii / count.max(1) as f64;
        let surfaces = members.iter().any(|m| m.part().is_some_and(ParticleBody::has_surface));
        let factor = if surfaces { SURFACE_RANGE } else { RANGE };
        let reach = 2.0 * factor * largest + self.skin;
        let Found { positions, radii, owners } = near_others(members, reach);
        // Only ranges that no distance reaches are refused.
        let range = Reach::Sum { factor, tolerance: self.skin };
        let sorted = Points::new(&positions, &radii).and_then(|points| SortedCells::new(&points, range));
        if let Ok(cells) = sorted {
            cells.each_pair(|i, j| {
                let (a, b) = (owners[i as usize], owners[j as usize]);
                if a.body != b.body {
                    self.pairs.push(if a.body < b.body { [a, b] } else { [b, a] });
                }
            });
        }
        for (w, member) in members.iter().enumerate() {
            let Member::Wall { wall } = member else { continue };
            for (b, part) in members.iter().enumerate().filter_map(|(b, m)| Some((b, m.part()?))) {
                for (n, p) in particles(part).enumerate() {
                    if wall.height(&p.position)
                        <= part.beyond(n).max(if surfaces { 3.0 * p.radius } else { 0.0 }) + self.skin
                    {
                        let at = Place { body: b as u32, particle: n as u32 };
                        let wall = Place { body: w as u32, particle: 0 };
                        self.pairs.push(if b < w { [at, wall] } else { [wall, at] });
                    }
                }
            }
        }
        self.pairs.sort_unstable();
        self.sort_by_particle(members);
    }
}

type Box2<const D: usize> = ([f64; D], [f64; D]);

/// Selected particles of all bodies.
#[derive(Default)]
struct Found<const D: usize> {
    positions: Vec<[f64; D]>,
    radii: Vec<f64>,
    owners: Vec<Place>,
}

/// Select the particles of each body within the bounding box of another, enlarged by `reach`, where distances can be resolved. Permission
/// for contact is checked in each step: it may change, and the result of a search must not depend on its time.
fn near_others<const D: usize>(members: &[Member<D>], reach: f64) -> Found<D> {
    let bounds = |part: &dyn ParticleBody<D>| -> Box2<D> {
        let mut range = ([f64::INFINITY; D], [f64::NEG_INFINITY; D]);
        for p in particles(part) {
            for d in 0..D {
                range.0[d] = range.0[d].min(p.position[d]);
                range.1[d] = range.1[d].max(p.position[d]);
            }
        }
        range
    };
    let boxes: Vec<Option<Box2<D>>> = members.iter().map(|m| m.part().map(bounds)).collect();
    let mut found = Found::default();
    for (b, part) in members.iter().enumerate().filter_map(|(b, m)| Some((b, m.part()?))) {
        let others: Vec<&Box2<D>> = boxes
            .iter()
            .enumerate()
            .filter(|(o, _)| *o != b)
            .filter_map(|(_, range)| range.as_ref())
            .collect();
        for (n, p) in particles(part).enumerate() {
            let within = |range: &&Box2<D>| {
                (0..D).all(|d| p.position[d] >= range.0[d] - reach && p.position[d] <= range.1[d] + reach)
            };
            if others.iter().any(within) && p.position.iter().all(|x| x.abs() <= FARTHEST) {
                found.positions.push(p.position);
                found.radii.push(p.radius);
                found.owners.push(Place { body: b as u32, particle: n as u32 });
            }
        }
    }
    found
}
