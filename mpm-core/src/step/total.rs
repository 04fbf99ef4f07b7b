//! The deformation of a particle that is mapped in its reference configuration ([`crate::frame`]).

use std::ops::Deref;

use mpm_materials::{Constitutive, Lane, Mat3, Sym3};

use super::rows::{Rows, RowsMut};
use crate::embedding::Embedding;
use crate::frame::Frame;
use crate::method::Composition;
use crate::parallel::{Float, Pack};

/// Rows that a particle of the method `M` has for it: displacement, in units of h, then deformation gradient (its D x
/// D part, and the hoop stretch about an axis).
pub(super) const fn rows<T: Float, const D: usize, M: Composition<T, D>>() -> usize {
    match (M::Frame::TOTAL, M::Embedding::HOOP) {
        (false, _) => 0,
        (true, false) => D + D * D,
        (true, true) => D + D * D + 1,
    }
}

/// Displacement zero, deformation gradient I: what a particle starts with.
pub(super) fn undeformed<T: Float, const D: usize, M: Composition<T, D>>() -> Vec<T> {
    let mut numbers = vec![T::default(); rows::<T, D, M>()];
    for d in 0..if M::Frame::TOTAL { D } else { 0 } {
        numbers[D + d * (D + 1)] = T::of(1.0);
    }
    if M::Frame::TOTAL && M::Embedding::HOOP {
        numbers[D + D * D] = T::of(1.0);
    }
    numbers
}

/// The deformation gradient in rows from `first` on.
#[inline(always)]
pub(super) fn load<
    T: Float,
    P: Pack<T>,
    const D: usize,
    M: Composition<T, D>,
    S: Deref<Target = [T::Row]>,
>(
    rows: &Rows<T, S>,
    first: usize,
) -> Mat3<P> {
    let mut f = Mat3::identity();
    for i in 0..D {
        for j in 0..D {
            f.0[i][j] = rows.load(first + D + i * D + j);
        }
    }
    if M::Embedding::HOOP {
        f.0[2][2] = rows.load(first + D + D * D);
    }
    f
}

/// The deformation gradient among the numbers of a particle.
pub(super) fn gradient<T: Float, const D: usize, M: Composition<T, D>>(numbers: &[T]) -> Mat3<T::Single> {
    let mut f = Mat3::identity();
    for i in 0..D {
        for j in 0..D {
            f.0[i][j] = numbers[D + i * D + j].into();
        }
    }
    if M::Embedding::HOOP {
        f.0[2][2] = numbers[D + D * D].into();
    }
    f
}

/// Write it back.
#[inline(always)]
pub(super) fn store<T: Float, P: Pack<T>, const D: usize, M: Composition<T, D>>(
    f: &Mat3<P>,
    rows: &mut RowsMut<'_, T>,
    first: usize,
) {
    for i in 0..D {
        for j in 0..D {
            rows.store(first + D + i * D + j, f.0[i][j]);
        }
    }
    if M::Embedding::HOOP {
        rows.store(first + D + D * D, f.0[2][2]);
    }
}

/// F^-1. In two dimensions F has no shear with the third axis.
#[inline(always)]
pub(super) fn inverse<P: Lane, const D: usize>(f: &Mat3<P>) -> Mat3<P> {
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
            // Rows and columns left when those of m[j][i] go, in cyclic order, which sees to the signs.
            let (a, b, c, d) = ((j + 1) % 3, (j + 2) % 3, (i + 1) % 3, (i + 2) % 3);
            r.0[i][j] = (m[a][c] * m[b][d] - m[a][d] * m[b][c]) * per;
        }
    }
    r
}

/// `a . b`, of which the third axis is apart in two dimensions.
#[inline(always)]
pub(super) fn product<P: Lane, const D: usize>(a: &Mat3<P>, b: &Mat3<P>) -> Mat3<P> {
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

/// sigma F^-T, which times the current volume is the first Piola-Kirchhoff stress times the reference volume.
#[inline(always)]
pub(super) fn nominal<P: Lane, const D: usize>(stress: &Sym3<P>, inverse: &Mat3<P>) -> Mat3<P> {
    product::<P, D>(&stress.to_mat(), &inverse.transpose())
}

/// Speed of signals over the cells of the reference configuration, c |F^-1|, m/s, with a bound for the largest
/// stretch of F^-1: its square is at most the mean of the eigenvalues of F^-1 F^-T and sqrt(2/3) of the norm of
/// their deviator. Exact where the two smaller stretches are equal.
#[inline(always)]
pub(super) fn speed<T, P, C>(law: &C, now: &C::State<P>, inverse: &Mat3<P>) -> P
where
    T: Float,
    P: Lane<Real = T>,
    C: Constitutive<T>,
{
    let square = inverse.times_transpose();
    let largest = square.mean() + square.deviator().equivalent() * P::of(2.0 / 3.0);
    law.wave_speed(now) * largest.sqrt()
}
