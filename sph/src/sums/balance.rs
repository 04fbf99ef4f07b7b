//! Balance of the artificial stress in linear velocity fields.

use super::batch::Near;
use crate::matrix::{Matrix, inverse_of_moments, times};
use crate::records::Records;

/// Balance R T M^-1 of the artificial stress R: with the quotients q of the kernel, T = sum_j A_j s_ij q_ij d (x) d; M is T without q.
pub(crate) struct Balance<'a, const D: usize> {
    pub records: &'a Records<D>,
    pub near: &'a Near,
    /// Place of the first particle of the batch.
    pub first: usize,
}

impl<const D: usize> Balance<'_, D> {
    /// Return the columns of the balance of a particle of the batch.
    pub fn of(&self, n: usize) -> [[f64; 4]; D] {
        let (records, i) = (self.records, self.first + n);
        let stress = &records.artificial[i];
        if stress.iter().flatten().all(|s| *s == 0.0) {
            return [[0.0; 4]; D];
        }
        let (own, start) = (&records.place[i], self.near.starts[n] as usize);
        let (mut close, mut all): (Matrix, Matrix) = ([[0.0; 3]; 3], [[0.0; 3]; 3]);
        let (index, slope) = self.near.of(n);
        for (k, (&j, &s)) in index.iter().zip(slope).enumerate() {
            let other = &records.place[j as usize];
            let (weight, q) = (s * other[3], self.near.close[start + k]);
            for a in 0..D {
                for c in 0..=a {
                    let product = weight * (other[a] - own[a]) * (other[c] - own[c]);
                    all[a][c] += product;
                    close[a][c] += q * product;
                }
            }
        }
        for a in 0..D {
            for c in a + 1..D {
                (all[a][c], close[a][c]) = (all[c][a], close[c][a]);
            }
        }
        let share = times(&close, &inverse_of_moments(&all, D), D);
        // (R K)_ac = sum_b R_ab K_bc, R by columns.
        let mut balance = [[0.0; 4]; D];
        for (c, column) in balance.iter_mut().enumerate() {
            for (a, out) in column[..D].iter_mut().enumerate() {
                *out = (0..D).map(|b| stress[b][a] * share[b][c]).sum();
            }
        }
        balance
    }
}
