//! Direct solve on the coarsest level.

use nalgebra::DMatrix;

use crate::cells::slots;
use crate::colours::{half, split};
use crate::level::Level;

/// Largest number of unknowns of the coarsest level.
pub(crate) const MOST_UNKNOWNS: usize = 128;

/// Inverse of the coarsest operator, by the Cholesky factorisation of a dense matrix.
///
/// A singular region is made regular by its null space: d 1 1^T / m is added for its m unknowns, with the mean d of their diagonal, which does not
/// change the solution of a compatible system but for a constant.
#[derive(Clone, Debug, Default)]
pub(crate) struct Coarsest {
    /// Colour and entry of each unknown.
    places: Vec<(usize, usize)>,
    /// Inverse, by columns.
    inverse: Vec<f64>,
    b: Vec<f64>,
}

impl Coarsest {
    /// Allocated memory, bytes.
    pub fn bytes(&self) -> usize {
        8 * (self.inverse.capacity() + self.b.capacity()) + 16 * self.places.capacity()
    }

    /// Factorise the operator of a level.
    pub fn renew<const D: usize>(&mut self, level: &Level<D>) {
        let (n, h) = (slots::<D>(), half::<D>());
        let mut numbers = vec![usize::MAX; level.cells.cells()];
        self.places.clear();
        for slot in 0..level.cells.cells() {
            if level.natural.unknown[slot / n] >> (slot % n) & 1 == 1 {
                numbers[slot] = self.places.len();
                let (colour, place) = split(slot % n);
                self.places.push((colour, slot / n * h + place));
            }
        }
        let count = self.places.len();
        let mut matrix = DMatrix::<f64>::zeros(count, count);
        for slot in (0..level.cells.cells()).filter(|s| numbers[*s] != usize::MAX) {
            let i = numbers[slot];
            matrix[(i, i)] += f64::from(level.natural.excess[slot]);
            for axis in 0..D {
                let w = f64::from(level.natural.upper(slot / n, axis)[slot % n]);
                let beside = level.cells.neighbour(slot, axis, true).map(|s| numbers[s]);
                if let Some(j) = beside.filter(|j| w > 0.0 && *j != usize::MAX) {
                    for (a, b) in [(i, j), (j, i)] {
                        matrix[(a, a)] += w;
                        matrix[(a, b)] -= w;
                    }
                }
            }
        }
        let excess: Vec<f64> = (0..level.cells.cells())
            .filter(|s| numbers[*s] != usize::MAX)
            .map(|s| f64::from(level.natural.excess[s]))
            .collect();
        regularise(&mut matrix, &excess);
        self.inverse = invert(&matrix);
        self.b.resize(count, 0.0);
    }

    /// Solve the system of the level.
    pub fn solve<const D: usize>(&mut self, level: &mut Level<D>) {
        for (b, (colour, place)) in self.b.iter_mut().zip(&self.places) {
            *b = f64::from(level.b[*colour][*place]);
        }
        let count = self.places.len();
        for (i, (colour, place)) in self.places.iter().enumerate() {
            let row = &self.inverse[i * count..(i + 1) * count];
            level.x[*colour][*place] = crate::vectors::dot_piece(row, &self.b) as f32;
        }
    }
}

/// Add the null space of singular regions, connected unknowns without excess.
fn regularise(matrix: &mut DMatrix<f64>, excess: &[f64]) {
    let count = matrix.nrows();
    let mut seen = vec![false; count];
    for first in 0..count {
        if seen[first] {
            continue;
        }
        let (mut region, mut next) = (vec![first], 0);
        seen[first] = true;
        while next < region.len() {
            let i = region[next];
            next += 1;
            for j in 0..count {
                if !seen[j] && matrix[(i, j)] != 0.0 {
                    seen[j] = true;
                    region.push(j);
                }
            }
        }
        if region.iter().all(|i| excess[*i] == 0.0) {
            let size = region.len() as f64;
            let diagonal: f64 = region.iter().map(|i| matrix[(*i, *i)]).sum();
            let shift = if diagonal > 0.0 { diagonal / (size * size) } else { 1.0 };
            for i in &region {
                for j in &region {
                    matrix[(*i, *j)] += shift;
                }
            }
        }
    }
}

/// Largest entry of A A^-1 - I of an inverse that is accepted.
const ACCURACY: f64 = 1e-6;

/// Symmetric inverse of a matrix; that of its diagonal if the factorisation fails or is inaccurate, which is still a preconditioner.
fn invert(matrix: &DMatrix<f64>) -> Vec<f64> {
    let count = matrix.nrows();
    if let Some(factor) = matrix.clone().cholesky() {
        let inverse = factor.inverse();
        let product = matrix * &inverse;
        let error = |i: usize, j: usize| (product[(i, j)] - if i == j { 1.0 } else { 0.0 }).abs();
        if (0..count).all(|j| (0..count).all(|i| error(i, j) < ACCURACY)) {
            let mean = |i: usize, j: usize| 0.5 * (inverse[(i, j)] + inverse[(j, i)]);
            return (0..count * count).map(|k| mean(k % count, k / count)).collect();
        }
    }
    (0..count * count)
        .map(|k| if k % count == k / count { 1.0 / matrix[(k / count, k / count)] } else { 0.0 })
        .collect()
}
