//! Scalars and SIMD lanes: the scalar [`Real`], and [`Lane`], a scalar or a pack of scalars processed by one
//! instruction.
//!
//! A law is written once, generic over `L: Lane`. The same code then runs on one point (`L = f64`) and on the four or
//! eight points of a vector register. A branch on a point becomes a [`Lane::select`] under a [`Mask`]; a law that
//! cannot be written so uses `pointwise` (in `mpm-materials`).

use std::fmt::Debug;
use std::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Not, Sub};

use nalgebra::RealField;
use num_traits::{FromPrimitive, ToPrimitive};

/// Real scalar, `f32` or `f64`: a number type of nalgebra plus conversions from literals.
pub trait Real: RealField + Copy + Default + FromPrimitive + ToPrimitive {
    /// The one-lane [`Lane`] of this scalar, which is the scalar itself.
    type Single: Lane<Real = Self, Mask = bool> + Into<Self> + From<Self>;

    /// The literal `x`, rounded to this precision.
    fn of(x: f64) -> Self;

    /// The value in double precision.
    fn to_double(self) -> f64;
}

/// A scalar or a pack of scalars with arithmetic lane by lane.
///
/// All methods are `#[inline(always)]` where implemented: vector instructions are only generated when the
/// whole law is inlined into a kernel compiled for them. Mark the generic functions of a law likewise.
pub trait Lane:
    Copy
    + Debug
    + Send
    + Sync
    + 'static
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
{
    /// The scalar of one lane.
    type Real: Real;
    /// The result of a comparison.
    type Mask: Mask;
    /// Number of lanes.
    const WIDTH: usize;

    /// Broadcast a value to every lane.
    fn splat(x: Self::Real) -> Self;
    /// Return the value of lane `i`, `i < WIDTH`.
    fn lane(self, i: usize) -> Self::Real;
    /// Replace the value of lane `i`.
    fn with_lane(self, i: usize, x: Self::Real) -> Self;
    /// `self * b + c`; fused where the machine has it.
    fn mul_add(self, b: Self, c: Self) -> Self;
    /// Square root.
    fn sqrt(self) -> Self;
    /// Natural logarithm of a positive, finite value.
    fn ln(self) -> Self;
    /// Exponential.
    fn exp(self) -> Self;
    /// Absolute value.
    fn abs(self) -> Self;
    /// The smaller value.
    fn min(self, other: Self) -> Self;
    /// The larger value.
    fn max(self, other: Self) -> Self;
    /// `self < other`; false where either is not a number.
    fn lt(self, other: Self) -> Self::Mask;
    /// `self <= other`; false where either is not a number.
    fn le(self, other: Self) -> Self::Mask;
    /// Select `yes` where the mask is set, else `no`.
    fn select(mask: Self::Mask, yes: Self, no: Self) -> Self;

    /// Zero.
    #[inline(always)]
    fn zero() -> Self {
        Self::splat(Self::Real::default())
    }
    /// One.
    #[inline(always)]
    fn one() -> Self {
        Self::of(1.0)
    }
    /// Broadcast the literal `x` to every lane.
    #[inline(always)]
    fn of(x: f64) -> Self {
        Self::splat(Self::Real::of(x))
    }
    /// `self > other`; false where either is not a number.
    #[inline(always)]
    fn gt(self, other: Self) -> Self::Mask {
        other.lt(self)
    }
    /// `self >= other`; false where either is not a number.
    #[inline(always)]
    fn ge(self, other: Self) -> Self::Mask {
        other.le(self)
    }
    /// True if neither infinite nor NaN.
    #[inline(always)]
    fn is_finite(self) -> Self::Mask {
        // 0 * x is zero for finite x only.
        (self * Self::zero()).le(Self::zero())
    }
    /// `self` raised to `e`, for `self > 0`.
    #[inline(always)]
    fn powf(self, e: Self) -> Self {
        (self.ln() * e).exp()
    }
    /// `1 / self`.
    #[inline(always)]
    fn recip(self) -> Self {
        Self::one() / self
    }
    /// `self` limited to `[low, high]`.
    #[inline(always)]
    fn clamp(self, low: Self, high: Self) -> Self {
        self.max(low).min(high)
    }
}

/// Result of comparing [`Lane`]s: a truth value per lane.
pub trait Mask: Copy + Debug + BitAnd<Output = Self> + BitOr<Output = Self> + Not<Output = Self> {
    /// Broadcast a truth value to every lane.
    fn splat(truth: bool) -> Self;
    /// True if any lane is true.
    fn any(self) -> bool;
    /// Return the truth value of lane `i`.
    fn lane(self, i: usize) -> bool;
    /// True if every lane is true.
    #[inline(always)]
    fn all(self) -> bool {
        !(!self).any()
    }
}

impl Mask for bool {
    #[inline(always)]
    fn splat(truth: bool) -> bool {
        truth
    }
    #[inline(always)]
    fn any(self) -> bool {
        self
    }
    #[inline(always)]
    fn lane(self, _: usize) -> bool {
        self
    }
}

macro_rules! scalar {
    ($t:ty) => {
        impl Real for $t {
            type Single = $t;
            #[inline(always)]
            fn of(x: f64) -> $t {
                x as $t
            }
            #[inline(always)]
            fn to_double(self) -> f64 {
                f64::from(self)
            }
        }
        impl Lane for $t {
            type Real = $t;
            type Mask = bool;
            const WIDTH: usize = 1;
            #[inline(always)]
            fn splat(x: $t) -> $t {
                x
            }
            #[inline(always)]
            fn lane(self, _: usize) -> $t {
                self
            }
            #[inline(always)]
            fn with_lane(self, _: usize, x: $t) -> $t {
                x
            }
            #[inline(always)]
            fn mul_add(self, b: $t, c: $t) -> $t {
                // Not `f64::mul_add`: without an FMA instruction it is a slow library call.
                self * b + c
            }
            #[inline(always)]
            fn sqrt(self) -> $t {
                <$t>::sqrt(self)
            }
            #[inline(always)]
            fn ln(self) -> $t {
                <$t>::ln(self)
            }
            #[inline(always)]
            fn exp(self) -> $t {
                <$t>::exp(self)
            }
            #[inline(always)]
            fn powf(self, e: $t) -> $t {
                <$t>::powf(self, e)
            }
            #[inline(always)]
            fn abs(self) -> $t {
                <$t>::abs(self)
            }
            #[inline(always)]
            fn min(self, other: $t) -> $t {
                if other < self { other } else { self }
            }
            #[inline(always)]
            fn max(self, other: $t) -> $t {
                if other > self { other } else { self }
            }
            #[inline(always)]
            fn lt(self, other: $t) -> bool {
                self < other
            }
            #[inline(always)]
            fn le(self, other: $t) -> bool {
                self <= other
            }
            #[inline(always)]
            fn select(mask: bool, yes: $t, no: $t) -> $t {
                if mask { yes } else { no }
            }
        }
    };
}
scalar!(f32);
scalar!(f64);

/// Pack of `N` scalars in plain Rust: for kernels on a machine without wide vector instructions, and the reference of
/// tests of vector packs and laws.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(align(32))]
pub struct Wide<T, const N: usize>(pub [T; N]);

/// Mask of a [`Wide`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct WideMask<const N: usize>(pub [bool; N]);

impl<const N: usize> BitAnd for WideMask<N> {
    type Output = Self;
    #[inline(always)]
    fn bitand(mut self, o: Self) -> Self {
        for i in 0..N {
            self.0[i] &= o.0[i];
        }
        self
    }
}
impl<const N: usize> BitOr for WideMask<N> {
    type Output = Self;
    #[inline(always)]
    fn bitor(mut self, o: Self) -> Self {
        for i in 0..N {
            self.0[i] |= o.0[i];
        }
        self
    }
}
impl<const N: usize> Not for WideMask<N> {
    type Output = Self;
    #[inline(always)]
    fn not(mut self) -> Self {
        for i in 0..N {
            self.0[i] = !self.0[i];
        }
        self
    }
}
impl<const N: usize> Mask for WideMask<N> {
    #[inline(always)]
    fn splat(truth: bool) -> Self {
        WideMask([truth; N])
    }
    #[inline(always)]
    fn any(self) -> bool {
        let mut r = false;
        for i in 0..N {
            r |= self.0[i];
        }
        r
    }
    #[inline(always)]
    fn lane(self, i: usize) -> bool {
        self.0[i]
    }
}

macro_rules! wide_op {
    ($($tr:ident $f:ident),*) => {$(
        impl<T: Real, const N: usize> $tr for Wide<T, N> {
            type Output = Self;
            #[inline(always)]
            fn $f(mut self, o: Self) -> Self {
                for i in 0..N {
                    self.0[i] = self.0[i].$f(o.0[i]);
                }
                self
            }
        }
    )*};
}
wide_op!(Add add, Sub sub, Mul mul, Div div);

impl<T: Real, const N: usize> Neg for Wide<T, N> {
    type Output = Self;
    #[inline(always)]
    fn neg(mut self) -> Self {
        for i in 0..N {
            self.0[i] = -self.0[i];
        }
        self
    }
}

macro_rules! wide_map {
    ($($f:ident),*) => {$(
        #[inline(always)]
        fn $f(mut self) -> Self {
            for i in 0..N {
                self.0[i] = Lane::$f(T::Single::from(self.0[i])).into();
            }
            self
        }
    )*};
}

impl<T: Real, const N: usize> Lane for Wide<T, N> {
    type Real = T;
    type Mask = WideMask<N>;
    const WIDTH: usize = N;
    wide_map!(sqrt, ln, exp, abs);
    #[inline(always)]
    fn splat(x: T) -> Self {
        Wide([x; N])
    }
    #[inline(always)]
    fn lane(self, i: usize) -> T {
        self.0[i]
    }
    #[inline(always)]
    fn with_lane(mut self, i: usize, x: T) -> Self {
        self.0[i] = x;
        self
    }
    #[inline(always)]
    fn mul_add(self, b: Self, c: Self) -> Self {
        self * b + c
    }
    #[inline(always)]
    fn min(mut self, o: Self) -> Self {
        for i in 0..N {
            self.0[i] = if o.0[i] < self.0[i] { o.0[i] } else { self.0[i] };
        }
        self
    }
    #[inline(always)]
    fn max(mut self, o: Self) -> Self {
        for i in 0..N {
            self.0[i] = if o.0[i] > self.0[i] { o.0[i] } else { self.0[i] };
        }
        self
    }
    #[inline(always)]
    fn lt(self, o: Self) -> WideMask<N> {
        let mut m = [false; N];
        for i in 0..N {
            m[i] = self.0[i] < o.0[i];
        }
        WideMask(m)
    }
    #[inline(always)]
    fn le(self, o: Self) -> WideMask<N> {
        let mut m = [false; N];
        for i in 0..N {
            m[i] = self.0[i] <= o.0[i];
        }
        WideMask(m)
    }
    #[inline(always)]
    fn select(mask: WideMask<N>, yes: Self, mut no: Self) -> Self {
        for i in 0..N {
            if mask.0[i] {
                no.0[i] = yes.0[i];
            }
        }
        no
    }
}
