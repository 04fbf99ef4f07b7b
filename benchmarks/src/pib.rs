//! Points in a box: two sorted coordinates, and what lies in both ranges.

use pcmm::Particle;

use crate::{Lists, half_box, largest_radius, touch};

/// Some particles, sorted along both axes.
struct Sorted {
    /// Numbers by rank, an axis each.
    order: [Vec<u32>; 2],
    /// Coordinates by rank.
    places: [Vec<f64>; 2],
    /// Rank along x of the particle that has a rank along y, and the other way round.
    other: [Vec<u32>; 2],
}

impl Sorted {
    /// Sort the particles `numbers`. `rank` is memory, one a particle of all.
    fn new(particles: &[Particle<2>], numbers: &[u32], rank: &mut [[u32; 2]]) -> Self {
        let sorted = |axis: usize| {
            let mut list = numbers.to_vec();
            let along = |i: &u32| particles[*i as usize].position[axis];
            list.sort_unstable_by(|a, b| along(a).total_cmp(&along(b)).then(a.cmp(b)));
            list
        };
        let order = [sorted(0), sorted(1)];
        for axis in 0..2 {
            for (r, &i) in order[axis].iter().enumerate() {
                rank[i as usize][axis] = r as u32;
            }
        }
        let places = [0, 1].map(|axis: usize| {
            order[axis].iter().map(|&i| particles[i as usize].position[axis]).collect::<Vec<_>>()
        });
        let other = [0, 1]
            .map(|axis: usize| order[axis].iter().map(|&i| rank[i as usize][1 - axis]).collect::<Vec<_>>());
        Sorted { order, places, other }
    }

    /// Ranks within a range along an axis.
    fn ranks(&self, axis: usize, low: f64, high: f64) -> std::ops::Range<usize> {
        let places = &self.places[axis];
        places.partition_point(|&x| x < low)..places.partition_point(|&x| x <= high)
    }

    /// The particles in the box around `x`: the shorter of the two lists is walked.
    fn visit(&self, x: &[f64; 2], half: f64, found: &mut dyn FnMut(u32)) {
        let ranges = [0, 1].map(|axis| self.ranks(axis, x[axis] - half, x[axis] + half));
        let walk = usize::from(ranges[1].len() < ranges[0].len());
        let across = &ranges[1 - walk];
        for r in ranges[walk].clone() {
            if across.contains(&(self.other[walk][r] as usize)) {
                found(self.order[walk][r]);
            }
        }
    }

    /// The particles in a range along one axis.
    fn along(&self, axis: usize, low: f64, high: f64, found: &mut dyn FnMut(u32)) {
        self.order[axis][self.ranks(axis, low, high)].iter().for_each(|&i| found(i));
    }
}

/// Neighbours by point in box: fast where a body is thin, O(N^(3/2)) where it is not.
pub fn pib(particles: &[Particle<2>], reach: f64) -> Lists {
    let numbers: Vec<u32> = (0..particles.len() as u32).collect();
    let sorted = Sorted::new(particles, &numbers, &mut vec![[0; 2]; particles.len()]);
    collect(particles, reach, |x, half, found| sorted.visit(x, half, found))
}

/// Neighbours by point in box in strips along the longer side, of a width of `width` largest ranges (the width of the paper
/// is lost; 2 was the fastest here).
pub fn strip_pib(particles: &[Particle<2>], reach: f64, width: f64) -> Lists {
    if particles.is_empty() {
        return Lists::new(0);
    }
    let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
    for p in particles {
        for d in 0..2 {
            low[d] = low[d].min(p.position[d]);
            high[d] = high[d].max(p.position[d]);
        }
    }
    let along = usize::from(high[1] - low[1] > high[0] - low[0]);
    let across = 1 - along;
    let step = width * (2.0 * largest_radius(particles) + reach);
    let strips = ((high[across] - low[across]) / step) as usize + 1;
    let strip = |x: f64| (((x - low[across]) / step).max(0.0) as usize).min(strips - 1);
    let mut members = vec![Vec::new(); strips];
    for (i, p) in particles.iter().enumerate() {
        members[strip(p.position[across])].push(i as u32);
    }
    let mut rank = vec![[0; 2]; particles.len()];
    let sorted: Vec<Sorted> = members.iter().map(|m| Sorted::new(particles, m, &mut rank)).collect();
    collect(particles, reach, |x, half, found| {
        let (first, last) = (strip(x[across] - half), strip(x[across] + half));
        for s in first..=last {
            if s == first || s == last {
                sorted[s].visit(x, half, found);
            } else {
                sorted[s].along(along, x[along] - half, x[along] + half, found);
            }
        }
    })
}

fn collect(
    particles: &[Particle<2>],
    reach: f64,
    visit: impl Fn(&[f64; 2], f64, &mut dyn FnMut(u32)),
) -> Lists {
    let largest = largest_radius(particles);
    let mut lists = Lists::new(particles.len());
    for (i, p) in particles.iter().enumerate() {
        visit(&p.position, half_box(p, largest, reach), &mut |j| {
            if j as usize != i && touch(p, &particles[j as usize], reach) {
                lists.list.push(j);
            }
        });
        lists.close();
    }
    lists
}
