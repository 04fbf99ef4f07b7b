//! Conjugate gradients with the multigrid preconditioner against the Cholesky factorisation of the same system.

use std::collections::{HashMap, HashSet};
use std::sync::Arc;

use faer::Mat;
use faer::linalg::solvers::Solve;
use impactite_simd::Team;
use impactite_solve::{CellBlocks, Jacobi, Multigrid, Operator, Stencil, Stop, conjugate_gradients};
use proptest::prelude::*;

use crate::domains::hash;

/// Random system: unknown cells, face weights, excess, assembled twice: as a stencil and as a dense matrix.
struct System<const D: usize> {
    stencil: Stencil<D>,
    matrix: Mat<f64>,
    /// Slot of each row of the matrix.
    slots: Vec<usize>,
    /// Rows of each connected region without excess.
    singular: Vec<Vec<usize>>,
}

impl<const D: usize> System<D> {
    /// `filled` of the cells of a cube are unknowns, `held` of them have an excess, `closed` of the faces have no weight.
    fn random(seed: u64, side: i32, filled: f64, held: f64, closed: f64) -> Self {
        let random = |cell: [i32; D], salt: u64| {
            hash(cell.iter().fold(seed ^ (salt << 32), |h, x| h * 31 + *x as u64))
        };
        let cube = (0..side.pow(D as u32))
            .map(|i| -> [i32; D] { std::array::from_fn(|a| i / side.pow(a as u32) % side) });
        let list: Vec<[i32; D]> = cube.filter(|c| random(*c, 1) < filled).collect();
        let rows: HashMap<[i32; D], usize> = list.iter().enumerate().map(|(i, c)| (*c, i)).collect();
        let shift = |c: [i32; D]| c.map(|x| x - side / 2);
        let cells = Arc::new(CellBlocks::of_cells(list.iter().map(|c| shift(*c))));
        let mut weights: [Vec<f64>; D] = std::array::from_fn(|_| vec![0.0; cells.cells()]);
        let mut diagonal = vec![0.0; cells.cells()];
        let mut matrix = Mat::zeros(list.len(), list.len());
        let slots: Vec<usize> = list.iter().map(|c| cells.find(shift(*c)).expect("a slot")).collect();
        let (mut free, mut edges) = (HashSet::new(), vec![Vec::new(); list.len()]);
        for (i, cell) in list.iter().enumerate() {
            let excess = if random(*cell, 2) < held { 10.0_f64.powf(2.0 * random(*cell, 3)) } else { 0.0 };
            matrix[(i, i)] += excess;
            if excess == 0.0 {
                free.insert(i);
            }
            for axis in 0..D {
                let mut beside = *cell;
                beside[axis] += 1;
                if let Some(&j) = rows.get(&beside).filter(|_| random(*cell, 10 + axis as u64) >= closed) {
                    let w = 0.1 + 0.9 * random(*cell, 20 + axis as u64);
                    weights[axis][slots[i]] = w;
                    edges[i].push(j);
                    edges[j].push(i);
                    for (a, b) in [(i, j), (j, i)] {
                        matrix[(a, a)] += w;
                        matrix[(a, b)] -= w;
                    }
                }
            }
        }
        let mut singular = Vec::new();
        let mut seen = vec![false; list.len()];
        for first in 0..list.len() {
            let mut region = vec![];
            let mut stack = vec![first];
            while let Some(i) = stack.pop() {
                if !std::mem::replace(&mut seen[i], true) {
                    region.push(i);
                    stack.extend(&edges[i]);
                }
            }
            // A single cell without a weight has no diagonal: it is no unknown.
            if region.len() > 1 && region.iter().all(|i| free.contains(i)) {
                singular.push(region);
            }
        }
        for i in 0..list.len() {
            diagonal[slots[i]] = matrix[(i, i)];
            if diagonal[slots[i]] == 0.0 {
                matrix[(i, i)] = 1.0;
            }
        }
        let stencil = Stencil::new(&Team::one(), cells, weights, diagonal).expect("a stencil");
        System { stencil, matrix, slots, singular }
    }

    /// Largest difference between the solution by conjugate gradients and by Cholesky, relative to the largest entry, and the number of
    /// iterations.
    fn check(mut self, seed: u64, multigrid: bool) -> (f64, usize) {
        let team = Team::one();
        assert_eq!(self.stencil.singular_regions(), self.singular.len());
        let mut b = vec![0.0; self.stencil.len()];
        for slot in (0..b.len()).filter(|s| self.stencil.diagonal()[*s] > 0.0) {
            b[slot] = hash(seed ^ (slot as u64 + 77)) - 0.5;
        }
        for region in &self.singular {
            let mean = region.iter().map(|i| b[self.slots[*i]]).sum::<f64>() / region.len() as f64;
            for i in region {
                b[self.slots[*i]] -= mean;
                for j in region {
                    self.matrix[(*i, *j)] += 1.0 / region.len() as f64;
                }
            }
        }
        let mut x: Vec<f64> =
            (0..b.len()).map(|i| if self.stencil.diagonal()[i] > 0.0 { i as f64 } else { 0.0 }).collect();
        let stop = Stop { relative: 1e-12, iterations: 2000, ..Stop::default() };
        let solved = if multigrid {
            let mut preconditioner = Multigrid::new(&team, &self.stencil);
            conjugate_gradients(&team, &self.stencil, &mut preconditioner, &b, &mut x, &stop)
        } else {
            let mut preconditioner = Jacobi::new(self.stencil.diagonal());
            conjugate_gradients(&team, &self.stencil, &mut preconditioner, &b, &mut x, &stop)
        }
        .expect("a solution");
        let right = Mat::from_fn(self.slots.len(), 1, |i, _| b[self.slots[i]]);
        let exact = self.matrix.llt(faer::Side::Lower).expect("positive definite").solve(&right);
        let size = (0..self.slots.len()).fold(1e-300, |m: f64, i| m.max(exact[(i, 0)].abs()));
        let error =
            (0..self.slots.len()).fold(0.0, |m: f64, i| m.max((x[self.slots[i]] - exact[(i, 0)]).abs()));
        let named: HashSet<usize> = self.slots.iter().copied().collect();
        assert!(
            (0..x.len()).all(|s| named.contains(&s) || x[s] == 0.0),
            "slots without an unknown keep zero"
        );
        (error / size, solved.iterations)
    }
}

/// The residual of 1e-12 |b| times the condition number, at most some 1e3 of these domains, with a factor of ten.
const TOLERANCE: f64 = 1e-8;

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn random_domains_in_the_plane(
        seed in any::<u64>(), side in 3..19, filled in 0.3..1.0_f64, held in 0.0..0.3_f64, closed in 0.0..0.4_f64, multigrid in any::<bool>(),
    ) {
        let (error, iterations) = System::<2>::random(seed, side, filled, held, closed).check(seed, multigrid);
        prop_assert!(error < TOLERANCE, "{error:e} after {iterations} iterations");
    }

    #[test]
    fn random_domains_in_space(
        seed in any::<u64>(), side in 3..9, filled in 0.3..1.0_f64, held in 0.0..0.3_f64, closed in 0.0..0.4_f64, multigrid in any::<bool>(),
    ) {
        let (error, iterations) = System::<3>::random(seed, side, filled, held, closed).check(seed, multigrid);
        prop_assert!(error < TOLERANCE, "{error:e} after {iterations} iterations");
    }
}

#[test]
fn random_domains_without_a_dirichlet_boundary() {
    for seed in 0..20 {
        let (plane, _) = System::<2>::random(seed, 16, 0.6, 0.0, 0.2).check(seed, true);
        let (space, _) = System::<3>::random(seed, 8, 0.4, 0.002, 0.2).check(seed, true);
        assert!(plane < TOLERANCE && space < TOLERANCE, "{seed}: {plane:e} {space:e}");
    }
}

/// Cells without neighbours are solved in one iteration but for round-off, which is no direction to go on in: of a start far away the residual
/// is of the size of the tolerance.
#[test]
fn round_off_is_no_direction() {
    for seed in 0..200 {
        let system = System::<2>::random(seed, 4, 0.3, 0.3, 1.0);
        let (error, iterations) = system.check(seed, false);
        assert!(error < 1e-11 && iterations < 12, "seed {seed}: {error:e} after {iterations} iterations");
    }
}
