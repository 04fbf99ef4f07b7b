//! Stable time step: a bound of the highest frequency by cell, scaled by power iterations for the whole body at rest.
//!
//! With the penalty alone the equations of points are M u'' = - sum over faces of k w w^T u, with w the weights of displacements in the
//! jump on a face. So omega^2 <= max over points of 1/m sum k |w| sum |w|, the largest row sum (Gershgorin); on square lattices
//! displacements that alternate from cell to cell attain it, 4 d eta E / (rho h^2). The contribution of the gradients of cells is bounded
//! alike by the modulus of longitudinal waves. The two bounds are not attained by the same motion, and disorder makes sums of magnitudes
//! too large: initial iterations of u <- M^-1 K u find the highest frequency of the body itself. Its ratio to the bound scales all later
//! bounds, which change with stresses, strains and cracks.

use impactite_simd::Float;

use crate::flux::Flux;
use crate::method::Composition;
use crate::solver::Fpm;
use crate::step::square_of;
use crate::sums::{BATCH, Force, Load, Trace, Traction, jump, lifting, trace};
use crate::vector::{Tensor, add_dyad, along, apply, dot, inverse, norm, subtract, with_identity, zero};

/// Power iterations for the highest frequency, from below to some half per cent.
const ITERATIONS: usize = 60;
/// Safety factor of the squared frequency.
const MORE: f64 = 1.01;
/// Largest number of cells in the iterations, and number of cells with the highest bounds among them.
const MEMBERS: usize = 4096;
const SEEDS: usize = 8;

impl<const D: usize, M: Composition<D>> Fpm<D, M> {
    /// Update the sharpness of the bounds, and the Courant rate.
    pub(crate) fn find_rates(&mut self) {
        let bound = self.batches.iter().flat_map(|b| &b.rates).map(|r| r[0] + r[1]).fold(0.0, f64::max);
        let highest = MORE * self.highest_square();
        self.sharpness = if highest > 0.0 && bound > 0.0 { (highest / bound).sqrt() } else { 1.0 };
        for batch in &mut self.batches {
            let rates = batch.rates.iter().zip(&batch.said).zip(&batch.gradient);
            let square = rates.map(|((rates, said), h)| {
                square_of(rates, said[7] / self.rest.speed, &inverse(&with_identity(h)))
            });
            batch.report.rate = square.fold(0.0, f64::max);
        }
        self.find_rate();
    }

    /// Update the bounds of all cells.
    pub(crate) fn find_rows(&mut self) {
        for cell in 0..self.reference.len() {
            self.batches[cell / BATCH].rates[cell % BATCH] = self.row(cell);
        }
    }

    /// Update the Courant rate, half the highest frequency, from the present bounds of cells.
    pub(crate) fn find_rate(&mut self) {
        let square = self.batches.iter().map(|b| b.report.rate).fold(0.0, f64::max);
        self.rate = 0.5 * self.sharpness * square.sqrt();
    }

    /// Update the bounds of a cell after faces near it opened.
    pub(crate) fn renew_rate(&mut self, cell: usize) {
        let rates = self.row(cell);
        let batch = &mut self.batches[cell / BATCH];
        let (said, h) = (&batch.said[cell % BATCH], &batch.gradient[cell % BATCH]);
        let square = square_of(&rates, said[7] / self.rest.speed, &inverse(&with_identity(h)));
        batch.rates[cell % BATCH] = rates;
        batch.report.rate = batch.report.rate.max(square);
    }

    /// Return the row sums of a cell, 1/s^2: of gradients, and of the penalty on all faces, open ones too.
    fn row(&self, cell: usize) -> [f64; 2] {
        let sides = &self.sides;
        let modulus = self.rest.density * self.rest.speed * self.rest.speed;
        let near = || std::iter::once(cell).chain(sides.of(cell).map(|s| sides.neighbour[s] as usize));
        let mut bulk = 0.0;
        for c in near() {
            let (own, all) = self.amounts(c);
            let here: f64 = if c == cell {
                own
            } else {
                let to = sides.intact_of(c).filter(|&s| sides.neighbour[s] as usize == cell);
                to.map(|s| norm(&sides.gradient[s])).sum()
            };
            bulk += self.volume[c] * modulus * here * all;
        }
        let mut faces: Vec<(u32, usize)> =
            near().flat_map(|c| sides.of(c).map(move |s| (sides.face[s], s))).collect();
        faces.sort_unstable();
        faces.dedup_by_key(|(face, _)| *face);
        let mut penalty = 0.0;
        let mut weights = Vec::new();
        for (face, s) in faces {
            let cells = self.faces[face as usize].cells;
            // Either side will do: the arms are swapped with the cells.
            let surface = &sides.surface[s];
            let [a, b] = if sides.neighbour[s] == cells[1] { cells } else { [cells[1], cells[0]] };
            weights.clear();
            self.weigh(a as usize, &surface.own, 1.0, &mut weights);
            self.weigh(b as usize, &surface.other, -1.0, &mut weights);
            penalty += surface.stiffness * share(&mut weights, cell);
        }
        for c in near() {
            for outer in &self.batches[c / BATCH].outer {
                if outer.cell as usize == c % BATCH && self.acting[outer.load as usize].holds() {
                    weights.clear();
                    self.weigh(c, &outer.arm, 1.0, &mut weights);
                    penalty += outer.stiffness * share(&mut weights, cell);
                }
            }
        }
        [bulk / self.mass[cell], penalty / self.mass[cell]]
    }

    /// Return the magnitudes of the vectors b of a cell: its own, and the sum.
    fn amounts(&self, cell: usize) -> (f64, f64) {
        let (mut own, mut all) = ([0.0; D], 0.0);
        for s in self.sides.intact_of(cell) {
            let b = &self.sides.gradient[s];
            (0..D).for_each(|d| own[d] -= b[d]);
            all += norm(b);
        }
        (norm(&own), all + norm(&own))
    }

    /// Append the weights of displacements in that of a cell, at an arm from its point.
    fn weigh(&self, cell: usize, arm: &[f64; D], sign: f64, weights: &mut Vec<(usize, f64)>) {
        let mut own = sign;
        for s in self.sides.intact_of(cell) {
            let weight = sign * dot(&self.sides.gradient[s], arm);
            own -= weight;
            weights.push((self.sides.neighbour[s] as usize, weight));
        }
        weights.push((cell, own));
    }

    /// Return the square of the highest frequency at rest, from below, 1/s^2, for a limited number of cells around the highest bounds.
    fn highest_square(&self) -> f64 {
        let members = self.members();
        let mut small = Small::new(self, &members);
        let mut square = 0.0;
        let mut before = 0.0;
        for &i in &members {
            small.u[i as usize] = std::array::from_fn(|d| noise(i as usize * D + d));
        }
        for _ in 0..ITERATIONS {
            let length = small.norm(self, &members);
            if !(length > 0.0 && length.is_finite()) {
                break;
            }
            members.iter().for_each(|&i| small.u[i as usize].iter_mut().for_each(|x| *x /= length));
            before = square;
            small.accelerate(self, &members);
            square = small.norm(self, &members);
        }
        square.max(before)
    }

    /// Return the cells of the highest bounds, and cells around them.
    fn members(&self) -> Vec<u32> {
        let count = self.reference.len();
        if count <= MEMBERS {
            return (0..count as u32).collect();
        }
        let bound = |i: u32| {
            let [bulk, penalty] = self.batches[i as usize / BATCH].rates[i as usize % BATCH];
            bulk + penalty
        };
        let mut order: Vec<u32> = (0..count as u32).collect();
        order.select_nth_unstable_by(SEEDS, |&a, &b| bound(b).total_cmp(&bound(a)).then(a.cmp(&b)));
        let mut found: Vec<u32> = order[..SEEDS].to_vec();
        found.sort_unstable();
        let mut seen = vec![false; count];
        found.iter().for_each(|&c| seen[c as usize] = true);
        let mut next = 0;
        while found.len() < MEMBERS && next < found.len() {
            for s in self.sides.of(found[next] as usize) {
                let c = self.sides.neighbour[s];
                if !std::mem::replace(&mut seen[c as usize], true) {
                    found.push(c);
                }
            }
            next += 1;
        }
        found.sort_unstable();
        found
    }
}

/// Small displacements at rest of some cells; the others are fixed.
struct Small<const D: usize> {
    u: Vec<[f64; D]>,
    traces: Vec<Trace<D>>,
    stress: Vec<Tensor<D>>,
    loads: Vec<Load<D>>,
    /// These cells and their neighbours.
    around: Vec<u32>,
}

impl<const D: usize> Small<D> {
    fn new<M: Composition<D>>(body: &Fpm<D, M>, members: &[u32]) -> Self {
        let count = body.reference.len();
        Small {
            u: vec![[0.0; D]; count],
            traces: vec![Trace::default(); count],
            stress: vec![zero(); count],
            loads: vec![Load::default(); count],
            around: body.ring(members),
        }
    }

    fn norm<M: Composition<D>>(&self, body: &Fpm<D, M>, members: &[u32]) -> f64 {
        let of = |&i: &u32| body.mass[i as usize] * dot(&self.u[i as usize], &self.u[i as usize]);
        members.iter().map(of).sum::<f64>().sqrt()
    }

    /// Replace displacements by accelerations.
    fn accelerate<M: Composition<D>>(&mut self, body: &Fpm<D, M>, members: &[u32]) {
        let Fpm { sides, volume, mass, rest, acting, batches, .. } = body;
        let Small { u, traces, stress, loads, around } = self;
        for &c in around.iter() {
            traces[c as usize] = trace(sides, u, c as usize);
        }
        let held = |c: usize| {
            let own = batches[c / BATCH].outer.iter().filter(move |o| o.cell as usize == c % BATCH);
            own.filter(|o| acting[o.load as usize].holds())
        };
        for &c in around.iter() {
            let (c, per) = (c as usize, 1.0 / volume[c as usize]);
            let mut seen = traces[c].h;
            if M::Flux::LIFTED {
                subtract(&mut seen, per, &lifting(sides, traces, c));
            }
            for outer in held(c) {
                let jump = acting[outer.load as usize].part(&traces[c].at(&outer.arm));
                add_dyad(&mut seen, -per, &jump, &outer.area);
            }
            stress[c] = rest.stress(&seen);
        }
        let (mut lifted, mut candidates) = ([zero()], Vec::new());
        for &c in around.iter() {
            let first = c as usize;
            let (out, lifting, candidates) = (&mut loads[first..=first], &mut lifted[..], &mut candidates);
            let (least, method) = (f64::INFINITY, std::marker::PhantomData::<M>);
            f64::dispatch(Traction {
                sides,
                traces,
                stress,
                volume,
                first,
                least,
                out,
                lifting,
                candidates,
                method,
            });
            for outer in held(first) {
                let flux = apply(&stress[first], &outer.area);
                let force = along(&flux, -outer.stiffness, &traces[first].at(&outer.arm));
                loads[first].add(&acting[outer.load as usize].part(&force), &outer.arm);
            }
            // Include notches, which may close and stick.
            for (crack, end) in body.cracks_of(first) {
                let crack = &body.cracks[crack as usize];
                if crack.softens {
                    continue;
                }
                let [a, b] = crack.cells.map(|c| &traces[c as usize]);
                let force = jump(a, b, &crack.surface).map(|x| -crack.surface.stiffness * x);
                if end == 0 {
                    loads[first].add(&force, &crack.surface.own);
                } else {
                    loads[first].add(&force.map(|x| -x), &crack.surface.other);
                }
            }
        }
        for &c in members {
            let first = c as usize;
            f64::dispatch(Force { sides, loads, mass, first, out: &mut u[first..=first] });
        }
    }
}

/// Return |w| of a cell times the sum of |w| over all cells, after adding the weights of each.
fn share(weights: &mut Vec<(usize, f64)>, cell: usize) -> f64 {
    weights.sort_unstable_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)));
    weights.dedup_by(|next, kept| {
        let same = next.0 == kept.0;
        if same {
            kept.1 += next.1;
        }
        same
    });
    let all: f64 = weights.iter().map(|w| w.1.abs()).sum();
    let own = weights.iter().find(|w| w.0 == cell).map_or(0.0, |w| w.1.abs());
    own * all
}

/// Return a pseudo-random number in -1..1.
fn noise(n: usize) -> f64 {
    let mut z = (n as u64).wrapping_add(1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    ((z ^ (z >> 27)) >> 11) as f64 / (1u64 << 52) as f64 - 1.0
}
