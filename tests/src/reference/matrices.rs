//! 3x3 matrices.

pub(super) fn times(a: &[[f64; 3]; 3], b: &[[f64; 3]; 3]) -> [[f64; 3]; 3] {
    let mut r = [[0.0; 3]; 3];
    for i in 0..3 {
        for j in 0..3 {
            r[i][j] = (0..3).map(|k| a[i][k] * b[k][j]).sum();
        }
    }
    r
}

pub(super) fn transpose(a: &[[f64; 3]; 3]) -> [[f64; 3]; 3] {
    let mut r = *a;
    for i in 0..3 {
        for j in 0..3 {
            r[i][j] = a[j][i];
        }
    }
    r
}

/// Invert a matrix by Gauss-Jordan elimination without pivoting; the matrices here need no row exchange.
pub(super) fn inverse(a: &[[f64; 3]; 3]) -> [[f64; 3]; 3] {
    let (mut left, mut right) = (*a, [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]);
    for i in 0..3 {
        let pivot = left[i][i];
        for j in 0..3 {
            left[i][j] /= pivot;
            right[i][j] /= pivot;
        }
        for k in (0..3).filter(|&k| k != i) {
            let share = left[k][i];
            for j in 0..3 {
                left[k][j] -= share * left[i][j];
                right[k][j] -= share * right[i][j];
            }
        }
    }
    right
}
