//! Selection and merging of the particles of a cell.

use super::*;
use crate::dim::block_nodes;
use crate::particles::{Block, Columns, Place};
use crate::shape::Domain;
use crate::step::between_steps::splitting::{Splitting, longest, symmetric};
use crate::step::bodies::particle_body::ParticleBody;
use crate::step::mpm::Mpm;
use impactite_scene::error::SceneError;
use impactite_simd::{Float, Team};
use mpm_materials::Material;
use nalgebra::{Matrix3, Vector3};

/// Largest length of merged particles over that at which particles are cut: none is cut again at once.
const SHORTER: f64 = 0.8;
/// Angular momentum of a cluster that counts as zero, over sqrt(2 K M) times its radius.
const NO_SPIN: f64 = 1e-13;

/// Particle as a point: position in units of h from the bin's centre, velocity in m/s.
#[derive(Clone, Copy, Debug)]
struct Point {
    mass: f64,
    x: Vector3<f64>,
    v: Vector3<f64>,
}

/// Pair of particles that replaces a cluster: at `centre` +- `apart` with `velocity` +- `parting`, half of `mass` each.
#[derive(Clone, Copy, Debug)]
struct Pair {
    mass: f64,
    centre: Vector3<f64>,
    velocity: Vector3<f64>,
    apart: Vector3<f64>,
    parting: Vector3<f64>,
    /// Second moment of the cluster about its centre over its mass, h^2.
    moment: Matrix3<f64>,
}

impl Pair {
    /// Return the pair of a cluster, if it is within the bounding box of the cluster.
    fn of(points: &[Point]) -> Option<Pair> {
        let mass: f64 = points.iter().map(|p| p.mass).sum();
        let centre: Vector3<f64> = points.iter().map(|p| p.x * p.mass).sum::<Vector3<f64>>() / mass;
        let velocity: Vector3<f64> = points.iter().map(|p| p.v * p.mass).sum::<Vector3<f64>>() / mass;
        let mut moment = Matrix3::zeros();
        let (mut spin, mut twice, mut spreads) = (Vector3::zeros(), 0.0, 0.0);
        let mut farthest = Vector3::zeros();
        for p in points {
            let (r, u) = (p.x - centre, p.v - velocity);
            moment += r * r.transpose() * (p.mass / mass);
            spin += r.cross(&u) * p.mass;
            twice += p.mass * u.norm_squared();
            spreads += p.mass * r.dot(&u);
            if r.norm_squared() > farthest.norm_squared() {
                farthest = r;
            }
        }
        let scale = (twice * mass * moment.trace()).sqrt();
        let turns = spin.norm() > NO_SPIN * scale;
        if !turns {
            spin = Vector3::zeros();
        }
        // Plane that contains the pair.
        let across = if turns {
            let axis = spin.normalize();
            Matrix3::identity() - axis * axis.transpose()
        } else {
            Matrix3::identity()
        };
        let principal = (across * moment * across).symmetric_eigen();
        let widest = principal.eigenvectors.column(principal.eigenvalues.imax()).into_owned();
        let least = if twice > 0.0 { spin.norm_squared() / (twice * mass) } else { 0.0 };
        for direction in [widest, across * farthest] {
            let Some(n) = direction.try_normalize(0.0) else { continue };
            let square = n.dot(&(moment * n)).max(least);
            let apart = n * square.sqrt();
            if square <= 0.0 || !within_box(points, &centre, &apart) {
                continue;
            }
            let along = twice / mass - spin.norm_squared() / (mass * mass * square);
            let turn = spin.cross(&apart) / (mass * square);
            let parting = turn + n * along.max(0.0).sqrt().copysign(spreads);
            return Some(Pair { mass, centre, velocity, apart, parting, moment });
        }
        None
    }
}

/// True if both ends are within the bounding box of the points: then none crosses a plane of symmetry, a wall or the axis.
fn within_box(points: &[Point], centre: &Vector3<f64>, apart: &Vector3<f64>) -> bool {
    (0..3).all(|d| {
        let low = points.iter().map(|p| p.x[d]).fold(f64::INFINITY, f64::min);
        let high = points.iter().map(|p| p.x[d]).fold(f64::NEG_INFINITY, f64::max);
        let rounding = 1e-12;
        (centre[d] - apart[d].abs()) >= low - rounding && (centre[d] + apart[d].abs()) <= high + rounding
    })
}

/// Descent of a particle from a seed, encoded by the number that splitting assigns. No existing particle is an ancestor of another.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Descent {
    seed: u64,
    /// One bit per cut, the first one lowest: set for the second child.
    path: u64,
    cuts: u32,
}

impl Descent {
    fn of(number: f64, cuts: f64, seeds: u64) -> Self {
        let number = number as u64;
        Descent { seed: number % seeds, path: number / seeds, cuts: cuts as u32 }
    }
    fn number(self, seeds: u64) -> u64 {
        self.seed + seeds * self.path
    }
    /// Sort key along the family: siblings are neighbours.
    fn order(self) -> (u64, u64) {
        (self.seed, self.path.reverse_bits())
    }
    fn child(self, second: bool) -> Self {
        Descent { path: self.path | u64::from(second) << self.cuts, cuts: self.cuts + 1, ..self }
    }
    /// Return the parent of two siblings.
    fn parent(self, other: Self) -> Option<Self> {
        let cuts = self.cuts.checked_sub(1)?;
        let siblings =
            self.seed == other.seed && self.cuts == other.cuts && self.path ^ other.path == 1 << cuts;
        siblings.then_some(Descent { path: self.path & !(1 << cuts), cuts, ..self })
    }
}

/// Reduce a family to the fewest ancestors with the same descendants; `family` must be sorted.
fn ancestors(family: impl Iterator<Item = Descent>) -> Vec<Descent> {
    let mut found: Vec<Descent> = Vec::new();
    for mut who in family {
        while let Some(parent) = found.last().and_then(|before| before.parent(who)) {
            found.pop();
            who = parent;
        }
        found.push(who);
    }
    found
}

/// Return two numbers for the children of a cluster, the lower one first: those of its ancestors with the fewest cuts.
fn heirs(mut found: Vec<Descent>, seeds: u64) -> Option<[Descent; 2]> {
    found.sort_by_key(|who| (who.cuts, who.order()));
    let mut two = match found[..] {
        [] => return None,
        [one] => [one.child(false), one.child(true)],
        [one, other, ..] => [one, other],
    };
    two.sort_by_key(|who| who.number(seeds));
    Some(two)
}

/// Particle of a bin, removed for merging.
#[derive(Clone, Debug)]
struct Grain<T> {
    numbers: Vec<T>,
    who: Descent,
}

/// Properties of a body for merging.
struct Merger<'a, T: Float, const D: usize> {
    body: &'a ParticleBody<T, D>,
    splitting: Splitting,
    seeds: u64,
}

impl<T: Float, const D: usize> Merger<'_, T, D> {
    /// Merge the particles of a bin down to `above`.
    fn bin(&self, block: &mut Block<T, D>, bin: usize, above: usize, book: &mut MergeBook) {
        let places: Vec<Place> = block.bin_places(bin).collect();
        let (number, cuts) = (self.body.columns.number(), Columns::state(D) + self.body.splitter.place + 6);
        let mut grains: Vec<Grain<T>> = Vec::with_capacity(places.len());
        for at in places {
            let mut numbers = Vec::with_capacity(self.body.columns.count());
            block.read(at, &mut numbers);
            let who = Descent::of(numbers[number].to_double(), numbers[cuts].to_double(), self.seeds);
            grains.push(Grain { numbers, who });
        }
        // Sort by family, independent of the order of arrival in the bin.
        grains.sort_by_key(|grain| grain.who.order());
        let before = *book;
        for relatives in [true, false] {
            let mut first = 0;
            while grains.len() > above && first + 3 <= grains.len() {
                let excess = grains.len() - above;
                let merged = [4, 3].into_iter().filter(|&size| size <= excess + 2).find_map(|size| {
                    let cluster = grains.get(first..first + size)?;
                    Some((size, self.merge(cluster, relatives)?))
                });
                let Some((size, two)) = merged else {
                    first += 1;
                    continue;
                };
                grains.splice(first..first + size, two);
                // New particles are not merged again in this sweep.
                first += 2;
                book.merges += 1;
                book.removed += size as u64 - 2;
            }
        }
        if *book == before {
            return;
        }
        let mut numbers = vec![T::default(); block.particle_numbers()];
        while let Some((group, particles)) = block.last_group(bin) {
            block.take(bin, Place { group, lane: particles as u32 - 1 }, &mut numbers);
        }
        for grain in &grains {
            block.push(bin, &grain.numbers);
        }
    }

    /// Merge a cluster into two particles, if possible; with `relatives` only if it contains all descendants of one
    /// or two ancestors, so that no number is lost.
    fn merge(&self, cluster: &[Grain<T>], relatives: bool) -> Option<[Grain<T>; 2]> {
        let double = |grain: &Grain<T>, column: usize| grain.numbers[column].to_double();
        let mut family: Vec<Descent> = cluster.iter().map(|grain| grain.who).collect();
        family.sort_by_key(|who| who.order());
        let found = ancestors(family.into_iter());
        if relatives && found.len() > 2 {
            return None;
        }
        let vector = |grain: &Grain<T>, first: usize| {
            let mut v = Vector3::zeros();
            for d in 0..D {
                v[d] = double(grain, first + d);
            }
            v
        };
        let point = |g: &Grain<T>| {
            let (x, v) = (vector(g, Columns::position()), vector(g, Columns::velocity(D)));
            Point { mass: self.mass(g), x, v }
        };
        let points: Vec<Point> = cluster.iter().map(point).collect();
        let pair = Pair::of(&points)?;
        let heaviest = points.iter().map(|p| p.mass).fold(0.0, f64::max);
        if heaviest > 0.5 * pair.mass * (1.0 + 1e-6) {
            return None;
        }
        let heirs = heirs(found, self.seeds)?;

        let mut numbers = cluster[0].numbers.clone();
        self.average(cluster, &pair, &mut numbers)?;
        numbers[self.body.columns.mass()] = T::of(0.5 * pair.mass);
        let cuts = Columns::state(D) + self.body.splitter.place + 6;
        let mut two = heirs.map(|who| Grain { numbers: numbers.clone(), who });
        for (grain, side) in two.iter_mut().zip([-1.0, 1.0]) {
            let (x, v) = (pair.centre + pair.apart * side, pair.velocity + pair.parting * side);
            for d in 0..D {
                let xi = T::of(x[d]);
                // True only within the bin, and false for a value that is not a number.
                if !(xi >= T::of(-0.5) && xi < T::of(0.5)) {
                    return None;
                }
                grain.numbers[Columns::position() + d] = xi;
                grain.numbers[Columns::velocity(D) + d] = T::of(v[d]);
            }
            grain.numbers[cuts] = T::of(f64::from(grain.who.cuts));
            grain.numbers[self.body.columns.number()] = T::of(grain.who.number(self.seeds) as f64);
        }
        Some(two)
    }

    fn mass(&self, grain: &Grain<T>) -> f64 {
        self.body.masses.of(&grain.numbers).to_double()
    }

    /// Compute state, stretch, loaded area and domain of the two, and store them in `numbers`.
    fn average(&self, cluster: &[Grain<T>], pair: &Pair, numbers: &mut [T]) -> Option<()> {
        let columns = &self.body.columns;
        let state = |grain| -> (f64, &[T]) { (self.mass(grain), self.body.state_of(&grain.numbers)) };
        let states: Vec<(f64, &[T])> = cluster.iter().map(state).collect();
        let state = self.body.material.merged(&states)?;
        numbers[Columns::state(D)..][..state.len()].copy_from_slice(&state);
        // Half of the loaded areas each; a field force is that of the seed of their number.
        let loads = self.body.loads.rows(columns.load());
        for area in loads.areas[0]..loads.areas[1] {
            let sum: f64 = cluster.iter().map(|grain| grain.numbers[area].to_double()).sum();
            numbers[area] = T::of(0.5 * sum);
        }

        // Extent of the cluster across the pair; the length along the pair follows from the volume.
        let n = pair.apart.normalize();
        let across = Matrix3::identity() - n * n.transpose();
        let extent = across * pair.moment * across * 3.0;
        let share = |grain: &Grain<T>| self.mass(grain) / pair.mass;
        let place = Columns::state(D) + self.body.splitter.place;
        let half = self.body.half[0].to_double();
        let (mut b, mut volume) = (extent / (half * half), 0.0);
        for grain in cluster {
            let own = symmetric([0, 1, 2, 3, 4, 5].map(|i| grain.numbers[place + i].to_double()));
            b += own * share(grain);
            volume += 0.5 * own.determinant().sqrt();
        }
        let longer = volume / b.determinant().sqrt();
        let stretch = Matrix3::identity() + n * n.transpose() * (longer - 1.0);
        let b = stretch * b * stretch;
        let b = [b[(0, 0)], b[(1, 1)], b[(2, 2)], b[(1, 2)], b[(0, 2)], b[(0, 1)]].map(T::of);
        let limit = SHORTER * self.splitting.stretch();
        let short = longest::<T, D>(b).0 <= limit * limit; // false for a value that is not a number
        if !short {
            return None;
        }
        numbers[place..place + 6].copy_from_slice(&b);

        let (from, count) = columns.domains();
        if count == 0 {
            return Some(());
        }
        let (mut box_, mut volume) = ([0.0; 3], 0.0);
        for (d, square) in box_.iter_mut().enumerate().take(D) {
            *square = extent[(d, d)];
        }
        for grain in cluster {
            let mut own = 0.5;
            for (d, square) in box_.iter_mut().enumerate().take(D) {
                let half = grain.numbers[from + d].to_double();
                own *= half;
                *square += half * half * share(grain);
            }
            volume += own;
        }
        let product: f64 = box_[..D].iter().product::<f64>().sqrt();
        for d in 0..D {
            let half = T::of(box_[d].sqrt() * (volume / product).powf(n[d] * n[d]));
            if self.body.kernels.shape().stretch(half, T::default()) != half {
                return None; // larger than the range of the shape function
            }
            numbers[from + d] = half;
        }
        Some(())
    }
}

impl<T: Float, const D: usize> ParticleBody<T, D> {
    /// Merge particles, if due after so many steps. Return true if any were merged.
    pub(in crate::step) fn merge_cells(&mut self, steps: u64, team: &Team) -> bool {
        let Some(splitting) = self.splitting else { return false };
        let Some(Merging { above, every }) = splitting.merging() else { return false };
        if !steps.is_multiple_of(every) || self.resting.is_some() {
            return false;
        }
        let mut slots = std::mem::take(&mut self.slots);
        let mut books = vec![MergeBook::default(); slots.len()];
        let merger = Merger { body: &*self, splitting, seeds: self.splitter.seeds() };
        team.each_piece(&mut slots, 1, &mut books, |_, slot, book| {
            let block = &mut slot[0].block;
            for bin in 0..block_nodes(D) {
                if block.bin_len(bin) > above {
                    merger.bin(block, bin, above, book);
                }
            }
        });
        self.slots = slots;
        let mut any = false;
        for book in books {
            any |= book.merges > 0;
            self.merges.merges += book.merges;
            self.merges.removed += book.removed;
        }
        any
    }
}

impl<const D: usize, T: Float> Mpm<D, T> {
    /// Check that particles of this law can be merged with this method.
    pub(in crate::step) fn check_merging(&self, body: &str, law: &dyn Material<T>) -> Result<(), SceneError> {
        let refuse = |what: String| Err(SceneError::NoMerging { body: body.into(), what });
        let facts = self.facts();
        if facts.affine {
            return refuse(format!("`{}`, whose particles vary within", facts.description));
        }
        if !matches!(facts.domain, Domain::Fixed | Domain::Axes) {
            return refuse(format!("`{}`, whose domains are no boxes", facts.description));
        }
        let virgin = law.virgin();
        if law.merged(&[(1.0, &virgin), (1.0, &virgin)]).is_none() {
            return refuse(format!("the law `{}`, whose states have no mean", law.name()));
        }
        self.check_clients("merging")
    }
}
