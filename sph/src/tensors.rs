//! What acts on a pair of particles, by particle.

use nalgebra::Matrix3;

use crate::matrix::Matrix;

/// Places of xx, yy, zz, yz, xz, xy.
pub(crate) const PLACES: [[usize; 3]; 3] = [[0, 5, 4], [5, 1, 3], [4, 3, 2]];

/// Moduli and what they do to the time step.
pub(crate) struct Scale {
    /// alpha rho0 c^2 of the zero-energy penalty, Pa.
    pub penalty: f64,
    /// alpha.
    pub stiffer: f64,
    /// Is there an axis, and are gradients corrected?
    pub hoop: bool,
    pub corrected: bool,
}

/// Squares of the highest frequency of sums over neighbours, over that of waves as long as the smoothing length (c/h), and halved as a step
/// is bounded by it: measured, as the smallest step that makes noise grow, with and without corrected gradients; and the same near an axis.
const HIGHEST: [[f64; 2]; 2] = [[0.29, 0.12], [1.9, 0.25]];
/// What a zero-energy penalty of 1 adds.
const PENALISED: f64 = 0.52;

impl Scale {
    /// The Courant rate of a particle, 1/s: half the highest frequency, from the wave speed, m/s, the size of the correction of gradients,
    /// which grows as particles come nearer to each other, and the smoothing length, m.
    #[inline]
    pub fn rate(&self, speed: f64, correction: f64, smoothing: f64) -> f64 {
        let highest = HIGHEST[usize::from(self.hoop)][usize::from(self.corrected)];
        let square = highest * correction * correction + PENALISED * self.stiffer;
        speed * square.sqrt() / smoothing
    }
}

/// Columns of sigma C^T times a factor.
#[inline]
pub(crate) fn columns<const D: usize>(said: &[f64; 8], factor: f64, correction: &Matrix) -> [[f64; 4]; D] {
    let mut columns = [[0.0; 4]; D];
    for c in 0..D {
        for a in 0..D {
            let sum: f64 = (0..D).map(|b| said[PLACES[a][b]] * correction[c][b]).sum();
            columns[c][a] = factor * sum;
        }
    }
    columns
}

/// Take the penalty's q F off, in the plane beside the stress.
#[inline]
pub(crate) fn less_penalty<const D: usize>(columns: &mut [[f64; 4]; D], q: f64, deformation: &Matrix) {
    let first = if D == 2 { 2 } else { 0 };
    for (c, column) in columns.iter_mut().enumerate() {
        for a in 0..D {
            column[first + a] -= q * deformation[a][c];
        }
    }
}

/// Columns of minus the tensile part of the stress, times a factor \[Gray2001\].
pub(crate) fn artificial<const D: usize>(said: &[f64; 8], factor: f64) -> [[f64; 4]; D] {
    let mut columns = [[0.0; 4]; D];
    // No principal stress is above the largest sum of a row.
    let most = (0..D).map(|a| {
        let others: f64 = (0..D).filter(|&b| b != a).map(|b| said[PLACES[a][b]].abs()).sum();
        said[PLACES[a][a]] + others
    });
    if most.fold(f64::NEG_INFINITY, f64::max) <= 0.0 {
        return columns;
    }
    let mut stress = Matrix3::zeros();
    for a in 0..D {
        for b in 0..D {
            stress[(a, b)] = said[PLACES[a][b]];
        }
    }
    let principal = stress.symmetric_eigen();
    for (value, axis) in principal.eigenvalues.iter().zip(principal.eigenvectors.column_iter()) {
        if *value > 0.0 {
            for c in 0..D {
                for a in 0..D {
                    columns[c][a] -= factor * value * axis[a] * axis[c];
                }
            }
        }
    }
    columns
}
