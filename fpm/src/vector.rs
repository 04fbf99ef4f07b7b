//! Plain functions on vectors and tensors of `D` dimensions.

/// Tensor by rows.
pub(crate) type Tensor<const D: usize> = [[f64; D]; D];

#[inline(always)]
pub(crate) fn zero<const D: usize>() -> Tensor<D> {
    [[0.0; D]; D]
}

#[inline(always)]
pub(crate) fn identity<const D: usize>() -> Tensor<D> {
    let mut one = zero();
    for d in 0..D {
        one[d][d] = 1.0;
    }
    one
}

#[inline(always)]
pub(crate) fn dot<const D: usize>(a: &[f64; D], b: &[f64; D]) -> f64 {
    let mut sum = 0.0;
    for d in 0..D {
        sum += a[d] * b[d];
    }
    sum
}

#[inline(always)]
pub(crate) fn norm<const D: usize>(a: &[f64; D]) -> f64 {
    dot(a, a).sqrt()
}

#[inline(always)]
pub(crate) fn difference<const D: usize>(a: &[f64; D], b: &[f64; D]) -> [f64; D] {
    let mut c = *a;
    for d in 0..D {
        c[d] -= b[d];
    }
    c
}

/// Return `a + s b`.
#[inline(always)]
pub(crate) fn along<const D: usize>(a: &[f64; D], s: f64, b: &[f64; D]) -> [f64; D] {
    let mut c = *a;
    for d in 0..D {
        c[d] += s * b[d];
    }
    c
}

#[inline(always)]
pub(crate) fn scaled<const D: usize>(a: &[f64; D], s: f64) -> [f64; D] {
    let mut c = *a;
    for d in 0..D {
        c[d] *= s;
    }
    c
}

/// Return the product of a tensor and a vector.
#[inline(always)]
pub(crate) fn apply<const D: usize>(m: &Tensor<D>, a: &[f64; D]) -> [f64; D] {
    let mut b = [0.0; D];
    for d in 0..D {
        b[d] = dot(&m[d], a);
    }
    b
}

/// Add `s a (x) b`.
#[inline(always)]
pub(crate) fn add_dyad<const D: usize>(m: &mut Tensor<D>, s: f64, a: &[f64; D], b: &[f64; D]) {
    for i in 0..D {
        let left = s * a[i];
        for j in 0..D {
            m[i][j] += left * b[j];
        }
    }
}

/// Double contraction: sum over all products of components.
#[inline(always)]
pub(crate) fn contract<const D: usize>(a: &Tensor<D>, b: &Tensor<D>) -> f64 {
    let mut sum = 0.0;
    for i in 0..D {
        for j in 0..D {
            sum += a[i][j] * b[i][j];
        }
    }
    sum
}

#[inline(always)]
pub(crate) fn product<const D: usize>(a: &Tensor<D>, b: &Tensor<D>) -> Tensor<D> {
    let mut c = zero();
    for i in 0..D {
        for k in 0..D {
            for j in 0..D {
                c[i][j] += a[i][k] * b[k][j];
            }
        }
    }
    c
}

/// Cofactor det(m) m^-T, which maps areas.
#[inline(always)]
pub(crate) fn cofactor<const D: usize>(m: &Tensor<D>) -> Tensor<D> {
    let mut c = zero();
    if D == 2 {
        (c[0][0], c[0][1], c[1][0], c[1][1]) = (m[1][1], -m[1][0], -m[0][1], m[0][0]);
        return c;
    }
    for i in 0..D {
        for j in 0..D {
            let (p, q, r, s) = ((i + 1) % D, (i + 2) % D, (j + 1) % D, (j + 2) % D);
            c[i][j] = m[p][r] * m[q][s] - m[p][s] * m[q][r];
        }
    }
    c
}

#[inline(always)]
pub(crate) fn determinant<const D: usize>(m: &Tensor<D>) -> f64 {
    dot(&m[0], &cofactor(m)[0])
}

/// Return the inverse; not finite for a singular tensor.
#[inline(always)]
pub(crate) fn inverse<const D: usize>(m: &Tensor<D>) -> Tensor<D> {
    let c = cofactor(m);
    let per = 1.0 / dot(&m[0], &c[0]);
    let mut inverse = zero();
    for i in 0..D {
        for j in 0..D {
            inverse[i][j] = c[j][i] * per;
        }
    }
    inverse
}

/// Return the largest sum of the magnitudes of a row, a bound of the stretch of any vector.
#[inline(always)]
pub(crate) fn largest_row<const D: usize>(m: &Tensor<D>) -> f64 {
    let mut largest = 0.0f64;
    for row in m {
        let mut sum = 0.0;
        for x in row {
            sum += x.abs();
        }
        largest = largest.max(sum);
    }
    largest
}

/// Return the rotation R of m = R U with a positive determinant, by Newton's iteration R <- (R + R^-T) / 2.
pub(crate) fn rotation<const D: usize>(m: &Tensor<D>) -> Tensor<D> {
    let mut r = *m;
    for _ in 0..30 {
        let (c, per) = (cofactor(&r), 1.0 / determinant(&r));
        let mut moved = 0.0f64;
        for i in 0..D {
            for j in 0..D {
                let next = 0.5 * (r[i][j] + per * c[i][j]);
                moved = moved.max((next - r[i][j]).abs());
                r[i][j] = next;
            }
        }
        if moved < 1e-15 {
            break;
        }
    }
    if r.iter().flatten().all(|x| x.is_finite()) { r } else { identity() }
}

/// Subtract `s` times a tensor.
#[inline(always)]
pub(crate) fn subtract<const D: usize>(from: &mut Tensor<D>, s: f64, m: &Tensor<D>) {
    for a in 0..D {
        for c in 0..D {
            from[a][c] -= s * m[a][c];
        }
    }
}

/// Return the deformation gradient F of a displacement gradient.
#[inline(always)]
pub(crate) fn with_identity<const D: usize>(h: &Tensor<D>) -> Tensor<D> {
    let mut f = *h;
    for d in 0..D {
        f[d][d] += 1.0;
    }
    f
}

#[cfg(test)]
mod tests {
    use super::*;

    fn near<const D: usize>(a: &Tensor<D>, b: &Tensor<D>) -> bool {
        a.iter().flatten().zip(b.iter().flatten()).all(|(a, b)| (a - b).abs() < 1e-14)
    }

    #[test]
    fn inverses_and_rotations_are_such() {
        let plane = [[1.1, 0.2], [-0.3, 0.9]];
        assert!(near(&product(&inverse(&plane), &plane), &identity()));
        let space = [[1.1, 0.2, 0.1], [-0.3, 0.9, 0.05], [0.1, -0.2, 1.2]];
        assert!(near(&product(&inverse(&space), &space), &identity()));
        let (s, c) = 0.4f64.sin_cos();
        let turn = [[c, -s], [s, c]];
        let stretch = [[1.3, 0.1], [0.1, 0.8]];
        assert!(near(&rotation(&product(&turn, &stretch)), &turn));
        let r = rotation(&space);
        let mut transpose = r;
        (0..3).for_each(|i| (0..3).for_each(|j| transpose[i][j] = r[j][i]));
        assert!(near(&product(&r, &transpose), &identity()));
        assert!((determinant(&r) - 1.0).abs() < 1e-14);
    }
}
