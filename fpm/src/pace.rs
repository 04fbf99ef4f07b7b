//! The stable time step: a bound of the highest frequency by cell, sharpened by what iterations find of the whole body at rest.
//!
//! With the penalty alone the equations of points are M u'' = - sum over faces of k w w^T u, where w are the weights that displacements have
//! in the jump on a face. So omega^2 <= max over points of 1/m sum k |w| sum |w|, the largest sum of a row (Gershgorin); on square lattices
//! this is met by displacements that alternate from cell to cell, 4 d eta E / (rho h^2). What gradients of cells add is bounded alike by
//! the modulus of longitudinal waves. Both are not largest for the same motion, and disorder makes sums of amounts too large: at the start some
//! iterations of u <- M^-1 K u find the highest frequency of the body itself, and what that is over the bound is a factor of all that follows, when
//! stresses, strains and cracks change the bound of cells.

use impactite_simd::Float;

use crate::flux::Flux;
use crate::method::Composition;
use crate::solver::Fpm;
use crate::step::{square_of, subtract, with_identity};
use crate::sums::{BATCH, Deform, Force, Lift, Load, Trace, Traction, jump};
use crate::vector::{Tensor, add_dyad, along, apply, dot, inverse, norm, zero};

/// Iterations for the highest frequency. They find it from below, to some half per cent;
const ITERATIONS: usize = 60;
/// what is added to its square.
const MORE: f64 = 1.01;

impl<const D: usize, M: Composition<D>> Fpm<D, M> {
    /// The bounds of all cells, and how sharp they are.
    pub(crate) fn find_rates(&mut self) {
        self.find_rows();
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

    /// The bounds alone.
    pub(crate) fn find_rows(&mut self) {
        for cell in 0..self.reference.len() {
            self.batches[cell / BATCH].rates[cell % BATCH] = self.row(cell);
        }
    }

    /// Half the highest frequency, by cells as they stand.
    pub(crate) fn find_rate(&mut self) {
        let square = self.batches.iter().map(|b| b.report.rate).fold(0.0, f64::max);
        self.rate = 0.5 * self.sharpness * square.sqrt();
    }

    /// The bounds of a cell after faces near it opened.
    pub(crate) fn renew_rate(&mut self, cell: usize) {
        let rates = self.row(cell);
        let batch = &mut self.batches[cell / BATCH];
        let (said, h) = (&batch.said[cell % BATCH], &batch.gradient[cell % BATCH]);
        let square = square_of(&rates, said[7] / self.rest.speed, &inverse(&with_identity(h)));
        batch.rates[cell % BATCH] = rates;
        batch.report.rate = batch.report.rate.max(square);
    }

    /// The sums of the row of a cell, 1/s^2: of gradients, and of the penalty on all faces, open ones too.
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
            // Whichever side it is: the arms are swapped with the cells.
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

    /// The amounts of the vectors b of a cell: its own, and the sum.
    fn amounts(&self, cell: usize) -> (f64, f64) {
        let (mut own, mut all) = ([0.0; D], 0.0);
        for s in self.sides.intact_of(cell) {
            let b = &self.sides.gradient[s];
            (0..D).for_each(|d| own[d] -= b[d]);
            all += norm(b);
        }
        (norm(&own), all + norm(&own))
    }

    /// Add the weights that displacements have in that of a cell, so far from its point.
    fn weigh(&self, cell: usize, arm: &[f64; D], sign: f64, weights: &mut Vec<(usize, f64)>) {
        let mut own = sign;
        for s in self.sides.intact_of(cell) {
            let weight = sign * dot(&self.sides.gradient[s], arm);
            own -= weight;
            weights.push((self.sides.neighbour[s] as usize, weight));
        }
        weights.push((cell, own));
    }

    /// The square of the highest frequency at rest, from below, 1/s^2.
    fn highest_square(&self) -> f64 {
        let count = self.reference.len();
        let mut u: Vec<[f64; D]> = (0..count).map(|i| std::array::from_fn(|d| noise(i * D + d))).collect();
        let mut square = 0.0;
        let mut before = 0.0;
        for _ in 0..ITERATIONS {
            let length: f64 = (0..count).map(|i| self.mass[i] * dot(&u[i], &u[i])).sum::<f64>().sqrt();
            if !(length > 0.0 && length.is_finite()) {
                break;
            }
            u.iter_mut().flatten().for_each(|x| *x /= length);
            before = square;
            u = self.linear(&u);
            square = (0..count).map(|i| self.mass[i] * dot(&u[i], &u[i])).sum::<f64>().sqrt();
        }
        square.max(before)
    }

    /// Accelerations by small displacements at rest.
    fn linear(&self, u: &[[f64; D]]) -> Vec<[f64; D]> {
        let count = u.len();
        let Fpm { sides, volume, mass, rest, acting, .. } = self;
        let mut traces = vec![Default::default(); count];
        f64::dispatch(Deform { sides, displacement: u, first: 0, out: &mut traces });
        let mut lifting = vec![zero(); count];
        let held = || {
            let cells = self.batches.iter().enumerate().flat_map(|(b, batch)| {
                batch.outer.iter().map(move |outer| (b * BATCH + outer.cell as usize, outer))
            });
            cells.filter(|(_, outer)| acting[outer.load as usize].holds())
        };
        let mut seen: Vec<Tensor<D>> = traces.iter().map(|t: &Trace<D>| t.h).collect();
        if M::Flux::LIFTED {
            f64::dispatch(Lift { sides, traces: &traces, first: 0, out: &mut lifting });
            seen.iter_mut().enumerate().for_each(|(i, h)| subtract(h, 1.0 / volume[i], &lifting[i]));
        }
        for (cell, outer) in held() {
            let jump = acting[outer.load as usize].part(&traces[cell].at(&outer.arm));
            add_dyad(&mut seen[cell], -1.0 / volume[cell], &jump, &outer.area);
        }
        let stress: Vec<Tensor<D>> = seen.iter().map(|h| rest.stress(h)).collect();
        let mut loads = vec![Load::default(); count];
        f64::dispatch(Traction {
            sides,
            traces: &traces,
            stress: &stress,
            volume,
            first: 0,
            least: f64::INFINITY,
            out: &mut loads,
            lifting: &mut lifting,
            candidates: &mut Vec::new(),
            method: std::marker::PhantomData::<M>,
        });
        for (cell, outer) in held() {
            let flux = apply(&stress[cell], &outer.area);
            let force = along(&flux, -outer.stiffness, &traces[cell].at(&outer.arm));
            loads[cell].add(&acting[outer.load as usize].part(&force), &outer.arm);
        }
        // Notches may close, and stick.
        for crack in &self.cracks {
            let [a, b] = crack.cells.map(|c| c as usize);
            let force = jump(&traces[a], &traces[b], &crack.surface).map(|x| -crack.surface.stiffness * x);
            loads[a].add(&force, &crack.surface.own);
            loads[b].add(&force.map(|x| -x), &crack.surface.other);
        }
        let mut out = vec![[0.0; D]; count];
        f64::dispatch(Force { sides, loads: &loads, mass, first: 0, out: &mut out });
        out
    }
}

/// |w| of a cell times the sum over all, by sums of the weights of each.
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

/// A number in -1..1 for a number.
fn noise(n: usize) -> f64 {
    let mut z = (n as u64).wrapping_add(1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    ((z ^ (z >> 27)) >> 11) as f64 / (1u64 << 52) as f64 - 1.0
}
