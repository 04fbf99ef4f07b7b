//! Small matrices: only the first `D` rows and columns are used.

/// Matrix by rows.
pub(crate) type Matrix = [[f64; 3]; 3];

/// Largest row sum of the inverse moments of a neighbourhood for a corrected gradient. Above it there are too few neighbours, or all of
/// them are in a line or plane. It is 1 within a body, 2 at a face and about 6 at a corner in space.
const MOST: f64 = 10.0;

/// Identity in `d` dimensions.
pub(crate) fn identity(d: usize) -> Matrix {
    let mut one = [[0.0; 3]; 3];
    for i in 0..d {
        one[i][i] = 1.0;
    }
    one
}

/// The determinant in `d` dimensions.
#[inline]
pub(crate) fn determinant(m: &Matrix, d: usize) -> f64 {
    if d == 2 {
        return m[0][0] * m[1][1] - m[0][1] * m[1][0];
    }
    m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) - m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0])
        + m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0])
}

/// The inverse in `d` dimensions of a matrix with this determinant.
#[inline]
fn over(m: &Matrix, det: f64, d: usize) -> Matrix {
    let per = 1.0 / det;
    if d == 2 {
        let mut inverse = [[0.0; 3]; 3];
        inverse[0] = [m[1][1] * per, -m[0][1] * per, 0.0];
        inverse[1] = [-m[1][0] * per, m[0][0] * per, 0.0];
        return inverse;
    }
    let mut inverse = [[0.0; 3]; 3];
    for i in 0..3 {
        let (a, b) = ((i + 1) % 3, (i + 2) % 3);
        for j in 0..3 {
            let (p, q) = ((j + 1) % 3, (j + 2) % 3);
            inverse[j][i] = (m[a][p] * m[b][q] - m[a][q] * m[b][p]) * per;
        }
    }
    inverse
}

/// Return the inverse of the moments of a neighbourhood. For singular moments return a multiple of the identity that scales gradients
/// correctly on average, or zero: a lone particle is not strained.
#[inline]
pub(crate) fn inverse_of_moments(m: &Matrix, d: usize) -> Matrix {
    let det = determinant(m, d);
    if det > 0.0 {
        let inverse = over(m, det, d);
        if largest_row(&inverse, d) <= MOST {
            return inverse;
        }
    }
    let trace: f64 = (0..d).map(|i| m[i][i]).sum();
    let size = if trace > 0.1 { d as f64 / trace } else { 0.0 };
    let mut inverse = identity(d);
    (0..d).for_each(|i| inverse[i][i] = size);
    inverse
}

/// Return the inverse, or zero for a singular matrix.
#[inline]
pub(crate) fn inverse(m: &Matrix, d: usize) -> Matrix {
    let det = determinant(m, d);
    if det.abs() > 0.0 { over(m, det, d) } else { [[0.0; 3]; 3] }
}

#[inline]
pub(crate) fn times(a: &Matrix, b: &Matrix, d: usize) -> Matrix {
    let mut product = [[0.0; 3]; 3];
    for i in 0..d {
        for k in 0..d {
            for j in 0..d {
                product[i][j] += a[i][k] * b[k][j];
            }
        }
    }
    product
}

/// Return the largest sum of the magnitudes of a row, a bound of the stretch of any vector.
#[inline]
pub(crate) fn largest_row(m: &Matrix, d: usize) -> f64 {
    m[..d].iter().map(|row| row[..d].iter().map(|x| x.abs()).sum()).fold(0.0, f64::max)
}

/// Return the root mean square of the principal values.
#[inline]
pub(crate) fn mean_size(m: &Matrix, d: usize) -> f64 {
    let squares: f64 = m[..d].iter().flat_map(|row| &row[..d]).map(|x| x * x).sum();
    (squares / d as f64).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn inverses_are_such() {
        let m = [[2.0, 0.3, -0.1], [0.4, 1.5, 0.2], [-0.3, 0.1, 0.9]];
        for d in [2, 3] {
            let one = times(&inverse_of_moments(&m, d), &m, d);
            for i in 0..d {
                for j in 0..d {
                    assert!((one[i][j] - f64::from(u8::from(i == j))).abs() < 1e-15, "{d} {one:?}");
                }
            }
            assert_eq!(inverse(&m, d), inverse_of_moments(&m, d));
        }
        // Particles in a line, and a lone particle.
        let line = [[1.5, 0.0, 0.0], [0.0; 3], [0.0; 3]];
        assert_eq!(inverse_of_moments(&line, 3)[1][1], 2.0);
        assert_eq!(inverse_of_moments(&[[0.0; 3]; 3], 2), [[0.0; 3]; 3]);
        assert_eq!(mean_size(&identity(2), 2), 1.0);
    }
}
