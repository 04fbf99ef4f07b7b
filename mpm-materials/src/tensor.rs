//! Second-order tensors in three dimensions over a [`Lane`].
//!
//! Other code uses nalgebra's matrices; these two types can be inlined completely into a vector kernel, and a symmetric
//! tensor stores six components, not nine.

use std::ops::{Add, Mul, Neg, Sub};

use nalgebra::Matrix3;

use crate::lane::Lane;

/// Positions in [`Sym3`] of the components `[i][j]`.
const INDEX: [[usize; 3]; 3] = [[0, 5, 4], [5, 1, 3], [4, 3, 2]];

/// A symmetric tensor: components `xx, yy, zz, yz, xz, xy` (true tensor components, shear not doubled).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sym3<L>(pub [L; 6]);

/// A general tensor, `self.0[i][j]` in row `i` and column `j`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mat3<L>(pub [[L; 3]; 3]);

impl<L: Lane> Sym3<L> {
    /// All components zero.
    #[inline(always)]
    pub fn zero() -> Self {
        Sym3([L::zero(); 6])
    }
    /// Isotropic tensor, `a` times the identity.
    #[inline(always)]
    pub fn isotropic(a: L) -> Self {
        let o = L::zero();
        Sym3([a, a, a, o, o, o])
    }
    /// Component in row `i` and column `j`.
    #[inline(always)]
    pub fn at(&self, i: usize, j: usize) -> L {
        self.0[INDEX[i][j]]
    }
    /// Sum of the diagonal.
    #[inline(always)]
    pub fn trace(&self) -> L {
        self.0[0] + self.0[1] + self.0[2]
    }
    /// One third of the trace; for a stress, minus the pressure.
    #[inline(always)]
    pub fn mean(&self) -> L {
        self.trace() * L::of(1.0 / 3.0)
    }
    /// The tensor minus its mean times the identity.
    #[inline(always)]
    pub fn deviator(&self) -> Self {
        self.plus_isotropic(-self.mean())
    }
    /// The tensor plus `a` times the identity.
    #[inline(always)]
    pub fn plus_isotropic(mut self, a: L) -> Self {
        for i in 0..3 {
            self.0[i] = self.0[i] + a;
        }
        self
    }
    /// Double contraction `self : other` (the sum over all nine components).
    #[inline(always)]
    pub fn dot(&self, o: &Self) -> L {
        let (a, b) = (&self.0, &o.0);
        let shear = a[3].mul_add(b[3], a[4].mul_add(b[4], a[5] * b[5]));
        a[0].mul_add(b[0], a[1].mul_add(b[1], a[2].mul_add(b[2], shear + shear)))
    }
    /// Von Mises equivalent of a **deviator**, sqrt(3/2 s:s).
    #[inline(always)]
    pub fn equivalent(&self) -> L {
        (self.dot(self) * L::of(1.5)).sqrt()
    }
    /// Determinant.
    #[inline(always)]
    pub fn determinant(&self) -> L {
        let [xx, yy, zz, yz, xz, xy] = self.0;
        let (x, y, z) = (minor(yy, yz, yz, zz), minor(xy, yz, xz, zz), minor(xy, yy, xz, yz));
        xx.mul_add(x, (-xy).mul_add(y, xz * z))
    }
    /// The tensor plus `a` times another tensor.
    #[inline(always)]
    pub fn plus_times(mut self, o: &Self, a: L) -> Self {
        for i in 0..6 {
            self.0[i] = o.0[i].mul_add(a, self.0[i]);
        }
        self
    }
    /// Convert to a general tensor.
    #[inline(always)]
    pub fn to_mat(&self) -> Mat3<L> {
        let s = &self.0;
        Mat3([[s[0], s[5], s[4]], [s[5], s[1], s[3]], [s[4], s[3], s[2]]])
    }
    /// Principal values, largest first, lane by lane (iterative eigenvalue solver; a few ulps of the largest value).
    pub fn principal(&self) -> [L; 3] {
        let mut r = [L::zero(); 3];
        for lane in 0..L::WIDTH {
            let m = Matrix3::from_fn(|i, j| self.at(i, j).lane(lane));
            let mut e: [L::Real; 3] = m.symmetric_eigenvalues().into();
            e.sort_by(|a, b| b.partial_cmp(a).unwrap_or(std::cmp::Ordering::Equal));
            for i in 0..3 {
                r[i] = r[i].with_lane(lane, e[i]);
            }
        }
        r
    }
}

/// Determinant a d - b c.
#[inline(always)]
fn minor<L: Lane>(a: L, b: L, c: L, d: L) -> L {
    (-b).mul_add(c, a * d)
}

impl<L: Lane> Mat3<L> {
    /// All components zero.
    #[inline(always)]
    pub fn zero() -> Self {
        Mat3([[L::zero(); 3]; 3])
    }
    /// The identity.
    #[inline(always)]
    pub fn identity() -> Self {
        let (o, i) = (L::zero(), L::one());
        Mat3([[i, o, o], [o, i, o], [o, o, i]])
    }
    /// Sum of the diagonal.
    #[inline(always)]
    pub fn trace(&self) -> L {
        self.0[0][0] + self.0[1][1] + self.0[2][2]
    }
    /// Determinant.
    #[inline(always)]
    pub fn determinant(&self) -> L {
        let [a, b, c] = &self.0;
        let x = minor(b[1], b[2], c[1], c[2]);
        let y = minor(b[0], b[2], c[0], c[2]);
        let z = minor(b[0], b[1], c[0], c[1]);
        a[0].mul_add(x, (-a[1]).mul_add(y, a[2] * z))
    }
    /// The transpose.
    #[inline(always)]
    pub fn transpose(&self) -> Self {
        let m = &self.0;
        Mat3([[m[0][0], m[1][0], m[2][0]], [m[0][1], m[1][1], m[2][1]], [m[0][2], m[1][2], m[2][2]]])
    }
    /// The product `self . other`.
    #[inline(always)]
    pub fn times(&self, o: &Self) -> Self {
        let mut r = Self::zero();
        for i in 0..3 {
            for j in 0..3 {
                r.0[i][j] = self.0[i][0]
                    .mul_add(o.0[0][j], self.0[i][1].mul_add(o.0[1][j], self.0[i][2] * o.0[2][j]));
            }
        }
        r
    }
    /// The sum of `self . other` and `rest`.
    #[inline(always)]
    pub fn times_plus(&self, o: &Self, mut rest: Self) -> Self {
        for i in 0..3 {
            for j in 0..3 {
                let sum = self.0[i][2].mul_add(o.0[2][j], rest.0[i][j]);
                rest.0[i][j] = self.0[i][0].mul_add(o.0[0][j], self.0[i][1].mul_add(o.0[1][j], sum));
            }
        }
        rest
    }
    /// The symmetric part.
    #[inline(always)]
    pub fn symmetric(&self) -> Sym3<L> {
        let (m, h) = (&self.0, L::of(0.5));
        Sym3([
            m[0][0],
            m[1][1],
            m[2][2],
            (m[1][2] + m[2][1]) * h,
            (m[0][2] + m[2][0]) * h,
            (m[0][1] + m[1][0]) * h,
        ])
    }
    /// The axial vector `w` of the antisymmetric part `W`: `W x = w cross x`.
    #[inline(always)]
    pub fn axial(&self) -> [L; 3] {
        let (m, h) = (&self.0, L::of(0.5));
        [(m[2][1] - m[1][2]) * h, (m[0][2] - m[2][0]) * h, (m[1][0] - m[0][1]) * h]
    }
    /// Product `self . self^T`.
    #[inline(always)]
    pub fn times_transpose(&self) -> Sym3<L> {
        // Not a closure: inside an inlined function it would be compiled without the caller's vector instructions.
        Sym3([
            self.rows_dot(0, 0),
            self.rows_dot(1, 1),
            self.rows_dot(2, 2),
            self.rows_dot(1, 2),
            self.rows_dot(0, 2),
            self.rows_dot(0, 1),
        ])
    }
    #[inline(always)]
    fn rows_dot(&self, i: usize, j: usize) -> L {
        self.row_times(i, self, j)
    }
    /// Row `i` times row `j` of another tensor.
    #[inline(always)]
    fn row_times(&self, i: usize, o: &Self, j: usize) -> L {
        let (a, b) = (&self.0[i], &o.0[j]);
        a[0].mul_add(b[0], a[1].mul_add(b[1], a[2] * b[2]))
    }
    /// Congruence `self . s . self^T`.
    #[inline(always)]
    pub fn congruence(&self, s: &Sym3<L>) -> Sym3<L> {
        let once = self.times(&s.to_mat());
        Sym3([
            once.row_times(0, self, 0),
            once.row_times(1, self, 1),
            once.row_times(2, self, 2),
            once.row_times(1, self, 2),
            once.row_times(0, self, 2),
            once.row_times(0, self, 1),
        ])
    }
}

macro_rules! componentwise {
    ($t:ident, $tr:ident, $f:ident) => {
        impl<L: Lane> $tr for $t<L> {
            type Output = Self;
            #[inline(always)]
            fn $f(mut self, o: Self) -> Self {
                for i in 0..self.0.len() {
                    self.0[i] = self.0[i].$f(o.0[i]);
                }
                self
            }
        }
    };
}
componentwise!(Sym3, Add, add);
componentwise!(Sym3, Sub, sub);

impl<L: Lane> Mul<L> for Sym3<L> {
    type Output = Self;
    #[inline(always)]
    fn mul(mut self, a: L) -> Self {
        for i in 0..6 {
            self.0[i] = self.0[i] * a;
        }
        self
    }
}
impl<L: Lane> Neg for Sym3<L> {
    type Output = Self;
    #[inline(always)]
    fn neg(mut self) -> Self {
        for i in 0..6 {
            self.0[i] = -self.0[i];
        }
        self
    }
}
impl<L: Lane> Add for Mat3<L> {
    type Output = Self;
    #[inline(always)]
    fn add(mut self, o: Self) -> Self {
        for i in 0..3 {
            for j in 0..3 {
                self.0[i][j] = self.0[i][j] + o.0[i][j];
            }
        }
        self
    }
}
impl<L: Lane> Mul<L> for Mat3<L> {
    type Output = Self;
    #[inline(always)]
    fn mul(mut self, a: L) -> Self {
        for i in 0..3 {
            for j in 0..3 {
                self.0[i][j] = self.0[i][j] * a;
            }
        }
        self
    }
}
