//! Who touches whom: cell-linked search, kept over steps by a skin.

use mpm_core::Team;

use crate::particles::Particle;
use crate::simplex::distance_squared;

/// Particles a task looks after.
const CHUNK: usize = 512;
/// Cells a particle, at most: memory stays proportional to matter however far debris flies.
const CELLS_PER_PARTICLE: usize = 4;

/// The particles within contact range of each, plus a skin: distance <= R_i + R_j + tolerance + skin.
///
/// Cells of an edge not below the largest such range are filled by a counting sort; each particle looks into the 3^D
/// cells around it (\[Feng2014\]; static cells, O(N)). The lists stay valid until some particle has moved half
/// the skin. Every list is in ascending order, so that it does not depend on where the cells lie.
#[derive(Clone, Debug)]
pub struct Neighbours<const D: usize> {
    tolerance: f64,
    skin: f64,
    starts: Vec<u32>,
    list: Vec<u32>,
    searched_at: Vec<[f64; D]>,
    searches: u64,
}

impl<const D: usize> Neighbours<D> {
    /// With the tolerance of contact and the skin, m; both zero or more.
    pub fn new(tolerance: f64, skin: f64) -> Self {
        Neighbours {
            tolerance,
            skin,
            starts: Vec::new(),
            list: Vec::new(),
            searched_at: Vec::new(),
            searches: 0,
        }
    }

    /// The neighbours of particle `i`, in ascending order; some may be up to two skins out of range.
    pub fn of(&self, i: usize) -> &[u32] {
        &self.list[self.starts[i] as usize..self.starts[i + 1] as usize]
    }

    /// How many searches were made.
    pub fn searches(&self) -> u64 {
        self.searches
    }

    /// Search again if some particle moved more than half the skin since the last search.
    pub fn update(&mut self, particles: &[Particle<D>], team: &Team) {
        let far = 0.25 * self.skin * self.skin;
        let valid = self.searched_at.len() == particles.len()
            && self.searched_at.iter().zip(particles).all(|(x, p)| distance_squared(x, &p.position) <= far);
        if !valid {
            self.search(particles, team);
        }
    }

    fn search(&mut self, particles: &[Particle<D>], team: &Team) {
        self.searches += 1;
        let reach = self.tolerance + self.skin;
        let largest = particles.iter().fold(0.0f64, |m, p| m.max(p.radius));
        let cells = Cells::sort(particles, 2.0 * largest + reach);
        // In the order of cells, so that what is looked at is near in memory.
        let mut rows: Vec<(Vec<u32>, Vec<u32>)> = vec![Default::default(); particles.len().div_ceil(CHUNK)];
        team.each(&mut rows, |chunk, (counts, found)| {
            let first = chunk * CHUNK;
            for place in first..(first + CHUNK).min(particles.len()) {
                let before = found.len();
                let (i, x, radius) = cells.sorted[place];
                cells.around(&x, |j, y, other| {
                    let range = radius + other + reach;
                    if j != i && distance_squared(&x, y) <= range * range {
                        found.push(j);
                    }
                });
                found[before..].sort_unstable();
                counts.push((found.len() - before) as u32);
            }
        });
        self.starts.clear();
        self.starts.resize(particles.len() + 1, 0);
        let counts = rows.iter().flat_map(|(counts, _)| counts);
        for (&(i, ..), &count) in cells.sorted.iter().zip(counts) {
            self.starts[i as usize + 1] = count;
        }
        for i in 0..particles.len() {
            self.starts[i + 1] += self.starts[i];
        }
        self.list.resize(self.starts[particles.len()] as usize, 0);
        let mut place = 0;
        for (counts, found) in &rows {
            let mut rest = &found[..];
            for &count in counts {
                let (mine, others) = rest.split_at(count as usize);
                let start = self.starts[cells.sorted[place].0 as usize] as usize;
                self.list[start..start + mine.len()].copy_from_slice(mine);
                (rest, place) = (others, place + 1);
            }
        }
        self.searched_at.clear();
        self.searched_at.extend(particles.iter().map(|p| p.position));
    }
}

/// Particles sorted by cell.
pub(crate) struct Cells<const D: usize> {
    low: [f64; D],
    edge: f64,
    counts: [usize; D],
    starts: Vec<u32>,
    /// Number, position and radius of the particles, cell by cell.
    sorted: Vec<(u32, [f64; D], f64)>,
}

impl<const D: usize> Cells<D> {
    pub(crate) fn sort(particles: &[Particle<D>], range: f64) -> Self {
        let mut low = [f64::INFINITY; D];
        let mut high = [f64::NEG_INFINITY; D];
        for p in particles {
            for d in 0..D {
                low[d] = low[d].min(p.position[d]);
                high[d] = high[d].max(p.position[d]);
            }
        }
        let most = (CELLS_PER_PARTICLE * particles.len()).max(64) as f64;
        let mut edge = range;
        let along = |edge: f64, d: usize| ((high[d] - low[d]) / edge).floor() + 1.0;
        while (0..D).map(|d| along(edge, d)).product::<f64>() > most {
            edge *= 1.25;
        }
        let mut counts = [1; D];
        for d in 0..D {
            counts[d] = along(edge, d) as usize;
        }
        let mut cells =
            Cells { low, edge, counts, starts: Vec::new(), sorted: vec![(0, low, 0.0); particles.len()] };
        let of: Vec<usize> = particles.iter().map(|p| cells.index(&cells.cell(&p.position))).collect();
        let mut starts = vec![0u32; counts.iter().product::<usize>() + 1];
        for &c in &of {
            starts[c + 1] += 1;
        }
        for c in 1..starts.len() {
            starts[c] += starts[c - 1];
        }
        let mut next = starts.clone();
        for (i, &c) in of.iter().enumerate() {
            cells.sorted[next[c] as usize] = (i as u32, particles[i].position, particles[i].radius);
            next[c] += 1;
        }
        cells.starts = starts;
        cells
    }

    fn cell(&self, x: &[f64; D]) -> [usize; D] {
        let mut cell = [0; D];
        for d in 0..D {
            cell[d] = (((x[d] - self.low[d]) / self.edge) as usize).min(self.counts[d] - 1);
        }
        cell
    }

    fn index(&self, cell: &[usize; D]) -> usize {
        (0..D).rev().fold(0, |n, d| n * self.counts[d] + cell[d])
    }

    pub(crate) fn around(&self, x: &[f64; D], mut visit: impl FnMut(u32, &[f64; D], f64)) {
        let centre = self.cell(x);
        for offset in 0..3usize.pow(D as u32) {
            let mut cell = [0; D];
            let mut rest = offset;
            let inside = (0..D).all(|d| {
                let c = (centre[d] + rest % 3).wrapping_sub(1);
                rest /= 3;
                cell[d] = c;
                c < self.counts[d]
            });
            if inside {
                let n = self.index(&cell);
                for (j, y, radius) in &self.sorted[self.starts[n] as usize..self.starts[n + 1] as usize] {
                    visit(*j, y, *radius);
                }
            }
        }
    }
}
