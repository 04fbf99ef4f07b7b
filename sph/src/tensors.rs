//! Pair stresses by particle.

use nalgebra::Matrix3;

use crate::matrix::Matrix;

/// Index of a tensor component in the order xx, yy, zz, yz, xz, xy.
pub(crate) const PLACES: [[usize; 3]; 3] = [[0, 5, 4], [5, 1, 3], [4, 3, 2]];

/// Penalty stiffness, and data of the time step limit.
pub(crate) struct Scale {
    /// alpha rho0 c^2 of the zero-energy penalty, Pa.
    pub penalty: f64,
    /// Coefficient alpha of the zero-energy penalty.
    pub stiffer: f64,
    /// Row of `HIGHEST`: 0 in the plane, 1 around an axis, 2 in space; `corrected` is true with corrected gradients.
    pub space: usize,
    pub corrected: bool,
}

/// Squares of half the highest frequency of sums over neighbours, which limits the time step, over that of waves as long as the smoothing
/// length (c/h). Measured as the smallest step that makes noise grow in blocks, discs and balls, and in a slice of a cylinder. In the
/// plane, around an axis and in space, each without and with corrected gradients.
const HIGHEST: [[f64; 2]; 3] = [[0.29, 0.12], [1.9, 0.25], [0.34, 0.17]];
/// Contribution of a zero-energy penalty of 1.
const PENALISED: f64 = 0.52;

impl Scale {
    /// Return the Courant rate of a particle, 1/s, half the highest frequency, from the wave speed, m/s, the size of the gradient
    /// correction, which grows as particles approach each other, and the smoothing length, m.
    #[inline]
    pub fn rate(&self, speed: f64, correction: f64, smoothing: f64) -> f64 {
        let highest = HIGHEST[self.space][usize::from(self.corrected)];
        let square = highest * correction * correction + PENALISED * self.stiffer;
        speed * square.sqrt() / smoothing
    }
}

/// Return the columns of sigma C^T times a factor.
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

/// Subtract the penalty's q F; in the plane it is stored beside the stress.
#[inline]
pub(crate) fn less_penalty<const D: usize>(columns: &mut [[f64; 4]; D], q: f64, deformation: &Matrix) {
    let first = if D == 2 { 2 } else { 0 };
    for (c, column) in columns.iter_mut().enumerate() {
        for a in 0..D {
            column[first + a] -= q * deformation[a][c];
        }
    }
}

/// Delay of the artificial stress, in wave passages through the smoothing length.
const DELAY: f64 = 20.0;

/// Relaxation factor of the artificial stress in a step of this number of wave passages through the smoothing length: 0 for a step of zero,
/// 1 for an infinite step.
#[inline]
pub(crate) fn followed(passages: f64) -> f64 {
    if passages.is_finite() { passages / (passages + DELAY) } else { 1.0 }
}

/// Return the columns of a tensor rotated by a small spin with components yx, zx, zy: T + W T - T W.
pub(crate) fn turned<const D: usize>(columns: &[[f64; 4]; D], spin: &[f64; 3]) -> [[f64; 4]; D] {
    let w = |a: usize, b: usize| match (a, b) {
        (1, 0) => spin[0],
        (2, 0) => spin[1],
        (2, 1) => spin[2],
        (0, 1) => -spin[0],
        (0, 2) => -spin[1],
        (1, 2) => -spin[2],
        _ => 0.0,
    };
    let mut turned = *columns;
    for c in 0..D {
        for a in 0..D {
            turned[c][a] += (0..D).map(|b| w(a, b) * columns[c][b] - columns[b][a] * w(b, c)).sum::<f64>();
        }
    }
    turned
}

/// Return the columns of minus the tensile part of the stress, times a factor \[Gray2001\].
pub(crate) fn artificial<const D: usize>(said: &[f64; 8], factor: f64) -> [[f64; 4]; D] {
    let mut columns = [[0.0; 4]; D];
    // No principal stress exceeds the largest row sum (Gershgorin).
    let most = (0..D).map(|a| {
        let others: f64 = (0..D).filter(|&b| b != a).map(|b| said[PLACES[a][b]].abs()).sum();
        said[PLACES[a][a]] + others
    });
    if most.fold(f64::NEG_INFINITY, f64::max) <= 0.0 {
        return columns;
    }
    let tensile = if D == 2 { tensile_in_plane(said[0], said[1], said[5]) } else { tensile_in_space(said) };
    for c in 0..D {
        for a in 0..D {
            columns[c][a] = -factor * tensile[a][c];
        }
    }
    columns
}

/// Return the tensile part of a stress in the plane: its positive principal values along their axes.
fn tensile_in_plane(xx: f64, yy: f64, xy: f64) -> Matrix {
    let (mean, half) = (0.5 * (xx + yy), 0.5 * (xx - yy));
    let radius = half.hypot(xy);
    let [most, least] = [mean + radius, mean - radius];
    let mut tensile = [[xx, xy, 0.0], [xy, yy, 0.0], [0.0; 3]];
    if least < 0.0 {
        // Projection on the axis of the larger principal stress: most (S - least I) / (most - least).
        let scale = if radius > 0.0 { most.max(0.0) / (2.0 * radius) } else { 0.0 };
        (tensile[0][0], tensile[1][1]) = (scale * (xx - least), scale * (yy - least));
        (tensile[0][1], tensile[1][0]) = (scale * xy, scale * xy);
    }
    tensile
}

/// Return the tensile part of a stress in space.
fn tensile_in_space(said: &[f64; 8]) -> Matrix {
    let stress = Matrix3::from_fn(|a, b| said[PLACES[a][b]]);
    let principal = stress.symmetric_eigen();
    let mut tensile = [[0.0; 3]; 3];
    for (value, axis) in principal.eigenvalues.iter().zip(principal.eigenvectors.column_iter()) {
        for a in 0..3 {
            for c in 0..3 {
                tensile[a][c] += value.max(0.0) * axis[a] * axis[c];
            }
        }
    }
    tensile
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tensile_parts_agree_in_plane_and_space() {
        for [xx, yy, xy] in [
            [1.0, 2.0, 0.3],
            [-1.0, 2.0, 0.7],
            [-3.0, -1.0, 0.2],
            [1.0, -1.0, 0.0],
            [2.0, 2.0, 0.0],
            [-1.0, -1.0, 0.0],
        ] {
            let space = tensile_in_space(&[xx, yy, -1.0, 0.0, 0.0, xy, 1.0, 0.0]);
            let plane = tensile_in_plane(xx, yy, xy);
            for a in 0..2 {
                for c in 0..2 {
                    assert!((space[a][c] - plane[a][c]).abs() < 1e-14, "{xx} {yy} {xy}: {space:?} {plane:?}");
                }
            }
        }
    }
}
