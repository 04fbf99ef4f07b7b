//! Deformation of a particle that is mapped in its reference configuration ([`crate::frame`]).

use std::ops::Deref;

use mpm_materials::{Lane, Mat3, Sym3};

use super::rows::{Rows, RowsMut};
use impactite_simd::{Float, Pack};

/// Number of rows of a particle in `d` dimensions: displacement, in units of h, then deformation gradient (its D x D part,
/// and the hoop stretch about an axis).
pub(in crate::step) const fn rows(total: bool, hoop: bool, d: usize) -> usize {
    match (total, hoop) {
        (false, _) => 0,
        (true, false) => d + d * d,
        (true, true) => d + d * d + 1,
    }
}

/// Return the initial rows of a particle: zero displacement, deformation gradient I.
pub(in crate::step) fn undeformed<T: Float>(total: bool, hoop: bool, d: usize) -> Vec<T> {
    let mut numbers = vec![T::default(); rows(total, hoop, d)];
    for i in 0..if total { d } else { 0 } {
        numbers[d + i * (d + 1)] = T::of(1.0);
    }
    if total && hoop {
        numbers[d + d * d] = T::of(1.0);
    }
    numbers
}

/// Load the deformation gradient from the rows from `first` on.
#[inline(always)]
pub(in crate::step) fn load<T: Float, P: Pack<T>, const D: usize, S: Deref<Target = [T::Row]>>(
    rows: &Rows<T, S>,
    first: usize,
    hoop: bool,
) -> Mat3<P> {
    let mut f = Mat3::identity();
    for i in 0..D {
        for j in 0..D {
            f.0[i][j] = rows.load(first + D + i * D + j);
        }
    }
    if hoop {
        f.0[2][2] = rows.load(first + D + D * D);
    }
    f
}

/// Read the deformation gradient from the numbers of a particle.
pub(in crate::step) fn gradient<T: Float, const D: usize>(numbers: &[T], hoop: bool) -> Mat3<T::Single> {
    let mut f = Mat3::identity();
    for i in 0..D {
        for j in 0..D {
            f.0[i][j] = numbers[D + i * D + j].into();
        }
    }
    if hoop {
        f.0[2][2] = numbers[D + D * D].into();
    }
    f
}

/// Store the deformation gradient in the rows from `first` on.
#[inline(always)]
pub(in crate::step) fn store<T: Float, P: Pack<T>, const D: usize>(
    f: &Mat3<P>,
    rows: &mut RowsMut<'_, T>,
    first: usize,
    hoop: bool,
) {
    for i in 0..D {
        for j in 0..D {
            rows.store(first + D + i * D + j, f.0[i][j]);
        }
    }
    if hoop {
        rows.store(first + D + D * D, f.0[2][2]);
    }
}

/// Return F^-1. In two dimensions F has no shear with the third axis.
#[inline(always)]
pub(in crate::step) fn inverse<P: Lane, const D: usize>(f: &Mat3<P>) -> Mat3<P> {
    let m = &f.0;
    let mut r = Mat3::zero();
    if D == 2 {
        let per = (m[0][0] * m[1][1] - m[0][1] * m[1][0]).recip();
        r.0[0] = [m[1][1] * per, -(m[0][1] * per), P::zero()];
        r.0[1] = [-(m[1][0] * per), m[0][0] * per, P::zero()];
        r.0[2][2] = m[2][2].recip();
        return r;
    }
    let per = f.determinant().recip();
    for i in 0..3 {
        for j in 0..3 {
            // Rows and columns other than those of m[j][i]; the cyclic order yields the signs.
            let (a, b, c, d) = ((j + 1) % 3, (j + 2) % 3, (i + 1) % 3, (i + 2) % 3);
            r.0[i][j] = (m[a][c] * m[b][d] - m[a][d] * m[b][c]) * per;
        }
    }
    r
}

/// Return `a . b`; in two dimensions the third axis is decoupled.
#[inline(always)]
pub(in crate::step) fn product<P: Lane, const D: usize>(a: &Mat3<P>, b: &Mat3<P>) -> Mat3<P> {
    if D == 3 {
        return a.times(b);
    }
    let mut r = Mat3::zero();
    for i in 0..2 {
        for j in 0..2 {
            r.0[i][j] = a.0[i][0].mul_add(b.0[0][j], a.0[i][1] * b.0[1][j]);
        }
    }
    r.0[2][2] = a.0[2][2] * b.0[2][2];
    r
}

/// Return sigma F^-T; times the current volume, it is the first Piola-Kirchhoff stress times the reference volume.
#[inline(always)]
pub(in crate::step) fn nominal<P: Lane, const D: usize>(stress: &Sym3<P>, inverse: &Mat3<P>) -> Mat3<P> {
    product::<P, D>(&stress.to_mat(), &inverse.transpose())
}

/// Return a bound of |F^-1|, the factor from wave speed to signal speed over the cells of the reference configuration. The
/// square of the largest stretch of F^-1 is at most the mean of the eigenvalues of F^-1 F^-T plus sqrt(2/3) of the norm of
/// their deviator. Exact if the two smaller stretches are equal.
#[inline(always)]
pub(in crate::step) fn stretch<P: Lane>(inverse: &Mat3<P>) -> P {
    let square = inverse.times_transpose();
    (square.mean() + square.deviator().equivalent() * P::of(2.0 / 3.0)).sqrt()
}
