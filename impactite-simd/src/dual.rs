//! Dual numbers: a lane with its derivative in one direction, so that generic code is differentiated as it runs.

use std::ops::{Add, Div, Mul, Neg, Sub};

use crate::lane::{Lane, Real};

/// Dual number x + x' e with e^2 = 0: a value and its derivative with respect to one parameter. As a [`Lane`] it differentiates
/// any law exactly, to rounding, along the branch that its value takes; comparisons are those of the values.
///
/// A value that is set lane by lane ([`Lane::with_lane`], as by code for single points) has no known derivative: it becomes NaN.
/// At a kink, such as the start of yielding, the derivative is that of the side that the comparison chooses.
///
/// ```
/// use impactite_simd::{Dual, Lane};
/// let x = Dual::variable(2.0_f64);
/// let y = (x * x + Dual::of(1.0)).sqrt();
/// assert!((y.slope - 2.0 / 5.0_f64.sqrt()).abs() < 1e-15);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dual<L> {
    /// Value.
    pub value: L,
    /// Derivative.
    pub slope: L,
}

impl<L: Lane> Dual<L> {
    /// Create the parameter itself: derivative one.
    #[inline(always)]
    pub fn variable(value: L) -> Self {
        Dual { value, slope: L::one() }
    }
    /// Create a number that does not depend on the parameter.
    #[inline(always)]
    pub fn constant(value: L) -> Self {
        Dual { value, slope: L::zero() }
    }
}

impl<L: Lane> Add for Dual<L> {
    type Output = Self;
    #[inline(always)]
    fn add(self, b: Self) -> Self {
        Dual { value: self.value + b.value, slope: self.slope + b.slope }
    }
}
impl<L: Lane> Sub for Dual<L> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, b: Self) -> Self {
        Dual { value: self.value - b.value, slope: self.slope - b.slope }
    }
}
impl<L: Lane> Mul for Dual<L> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, b: Self) -> Self {
        Dual { value: self.value * b.value, slope: self.slope * b.value + self.value * b.slope }
    }
}
impl<L: Lane> Div for Dual<L> {
    type Output = Self;
    #[inline(always)]
    fn div(self, b: Self) -> Self {
        let value = self.value / b.value;
        Dual { value, slope: (self.slope - value * b.slope) / b.value }
    }
}
impl<L: Lane> Neg for Dual<L> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Dual { value: -self.value, slope: -self.slope }
    }
}

impl<L: Lane> Dual<L> {
    /// Multiply a factor by the derivative, which is zero where the derivative is, whatever the factor: sqrt(0) and 0^n have
    /// infinite factors.
    #[inline(always)]
    fn chain(self, factor: L) -> L {
        let moves = self.slope.lt(L::zero()) | self.slope.gt(L::zero()) | !self.slope.le(self.slope);
        L::select(moves, factor * self.slope, L::zero())
    }
}

impl<L: Lane> Lane for Dual<L> {
    type Real = L::Real;
    type Mask = L::Mask;
    const WIDTH: usize = L::WIDTH;

    #[inline(always)]
    fn splat(x: L::Real) -> Self {
        Dual::constant(L::splat(x))
    }
    #[inline(always)]
    fn lane(self, i: usize) -> L::Real {
        self.value.lane(i)
    }
    #[inline(always)]
    fn with_lane(self, i: usize, x: L::Real) -> Self {
        let unknown = L::Real::of(f64::NAN);
        Dual { value: self.value.with_lane(i, x), slope: self.slope.with_lane(i, unknown) }
    }
    #[inline(always)]
    fn mul_add(self, b: Self, c: Self) -> Self {
        let slope = self.slope * b.value + self.value * b.slope + c.slope;
        Dual { value: self.value.mul_add(b.value, c.value), slope }
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        let value = self.value.sqrt();
        Dual { value, slope: self.chain(L::of(0.5) / value) }
    }
    #[inline(always)]
    fn ln(self) -> Self {
        Dual { value: self.value.ln(), slope: self.chain(self.value.recip()) }
    }
    #[inline(always)]
    fn exp(self) -> Self {
        let value = self.value.exp();
        Dual { value, slope: self.chain(value) }
    }
    #[inline(always)]
    fn abs(self) -> Self {
        let slope = L::select(self.value.lt(L::zero()), -self.slope, self.slope);
        Dual { value: self.value.abs(), slope }
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        let less = other.value.lt(self.value);
        Dual { value: self.value.min(other.value), slope: L::select(less, other.slope, self.slope) }
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        let more = self.value.lt(other.value);
        Dual { value: self.value.max(other.value), slope: L::select(more, other.slope, self.slope) }
    }
    #[inline(always)]
    fn lt(self, other: Self) -> L::Mask {
        self.value.lt(other.value)
    }
    #[inline(always)]
    fn le(self, other: Self) -> L::Mask {
        self.value.le(other.value)
    }
    #[inline(always)]
    fn select(mask: L::Mask, yes: Self, no: Self) -> Self {
        Dual { value: L::select(mask, yes.value, no.value), slope: L::select(mask, yes.slope, no.slope) }
    }
    #[inline(always)]
    fn is_finite(self) -> L::Mask {
        self.value.is_finite()
    }
    #[inline(always)]
    fn powf(self, e: Self) -> Self {
        let value = self.value.powf(e.value);
        let of_base = self.chain(e.value * value / self.value);
        Dual { value, slope: of_base + e.chain(value * self.value.ln()) }
    }
    #[inline(always)]
    fn recip(self) -> Self {
        let value = self.value.recip();
        Dual { value, slope: -(value * value) * self.slope }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Compare the derivative of a function with central differences.
    fn check(f: impl Fn(Dual<f64>) -> Dual<f64>, x: f64) {
        let h = 1e-6 * x.abs().max(1e-3);
        let value = |x: f64| f(Dual::constant(x)).value;
        let due = (value(x + h) - value(x - h)) / (2.0 * h);
        let got = f(Dual::variable(x));
        assert!((got.slope - due).abs() < 1e-7 * due.abs().max(1.0), "{} and {due} at {x}", got.slope);
        assert_eq!(got.value, value(x));
    }

    #[test]
    fn derivatives_are_those_of_differences() {
        for x in [0.3, 0.9, 2.5] {
            check(|x| x * x + Dual::of(3.0) * x - Dual::of(1.0), x);
            check(|x| (x / (x + Dual::of(2.0))).sqrt(), x);
            check(|x| (-x).exp() * x.ln(), x);
            check(|x| x.powf(x), x);
            check(|x| x.powf(Dual::of(0.3)).recip(), x);
            check(|x| (x - Dual::of(1.0)).abs().max(Dual::of(0.2)).min(Dual::of(1.2)), x);
            check(|x| x.mul_add(x.sqrt(), x.clamp(Dual::of(0.5), Dual::of(2.0))), x);
            check(|x| Dual::select(x.lt(Dual::of(1.0)), x * x, Dual::of(2.0) * x), x);
        }
    }

    #[test]
    fn constants_of_singular_functions_have_no_slope_and_set_lanes_have_none_that_is_known() {
        let zero = Dual::constant(0.0_f64);
        assert_eq!(zero.sqrt().slope, 0.0);
        assert_eq!((zero + Dual::of(1e-300)).powf(Dual::of(0.5)).slope, 0.0);
        assert!(Dual::variable(1.0_f64).with_lane(0, 2.0).slope.is_nan());
        assert!(Dual::variable(f64::INFINITY).slope == 1.0 && !Dual::variable(f64::INFINITY).is_finite());
    }
}
