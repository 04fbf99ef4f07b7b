//! Pairs of particles of different bodies that may touch.

use impactite_geometry::search::{FARTHEST, NeighbourSearch, Points, Reach, SortedCells};

use super::body::ParticleBody;
use super::member::{Member, Place, particles};

/// Particles are looked at up to this many sums of radii apart: with surfaces through the centres, particles of two bodies
/// face each other half a spacing beside each other.
pub(super) const RANGE: f64 = 1.5;
/// The skin of the lists over the mean radius.
const SKIN: f64 = 1.0;

/// Pairs within range plus a skin, kept until something has moved half the skin. In ascending order: the list does not
/// depend on where cells lie.
#[derive(Clone, Debug, Default)]
pub(super) struct Candidates {
    pairs: Vec<[Place; 2]>,
    searched: bool,
    /// How far the fastest particle may have moved since the search, m.
    moved: f64,
    skin: f64,
    pub searches: u64,
}

impl Candidates {
    /// The lists are no longer of this scene.
    pub fn forget(&mut self) {
        self.searched = false;
    }

    /// Something moved at most this far.
    pub fn moved(&mut self, distance: f64) {
        self.moved += distance;
    }

    /// The pairs; searched anew if they may have changed.
    pub fn update<const D: usize>(&mut self, members: &[Member<D>]) -> &[[Place; 2]] {
        // Two that approach each other may both have moved.
        if !self.searched || 2.0 * self.moved > self.skin {
            self.search(members);
        }
        &self.pairs
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
        let reach = 2.0 * RANGE * largest + self.skin;
        let Found { positions, radii, owners } = near_others(members, reach);
        // Refused are only ranges that no distance reaches.
        let range = Reach::Sum { factor: RANGE, tolerance: self.skin };
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
                    if wall.height(&p.position) <= part.beyond(n) + self.skin {
                        let at = Place { body: b as u32, particle: n as u32 };
                        let wall = Place { body: w as u32, particle: 0 };
                        self.pairs.push(if b < w { [at, wall] } else { [wall, at] });
                    }
                }
            }
        }
        self.pairs.sort_unstable();
    }
}

type Box2<const D: usize> = ([f64; D], [f64; D]);

/// Some particles of all bodies.
#[derive(Default)]
struct Found<const D: usize> {
    positions: Vec<[f64; D]>,
    radii: Vec<f64>,
    owners: Vec<Place>,
}

/// The particles of each body that lie in the box of another, `reach` wider, and not where distances are no longer
/// told apart. Whether they may touch is asked in each step: it may change, and what a search finds must not hang on when it was made.
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
