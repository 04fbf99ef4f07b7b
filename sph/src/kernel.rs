//! Smoothing kernels.

use impactite_simd::Lane;

/// Isotropic smoothing kernel W(r, h) with support 2 h: sigma / h^D times a profile of q = r / h.
#[diagnostic::on_unimplemented(
    message = "`{Self}` is no kernel",
    note = "take `CubicSpline`, `WendlandC2`, or a type of your own that implements `Kernel`"
)]
pub trait Kernel: Copy + std::fmt::Debug + Send + Sync + 'static {
    /// The name in tables and messages.
    const NAME: &'static str;
    /// Normalisation sigma in `dimensions` (2 or 3): the integral of W is one.
    fn norm(&self, dimensions: usize) -> f64;
    /// Kernel profile W h^D / sigma at q >= 0.
    fn value<L: Lane<Real = f64>>(&self, q: L) -> L;
    /// Slope of the profile over its argument, (dW/dq) / q at q >= 0: finite at zero, zero from q = 2 on.
    fn slope<L: Lane<Real = f64>>(&self, q: L) -> L;
    /// Smoothing length h over the particle spacing.
    fn ratio(&self) -> f64;
}

/// Cubic spline kernel \[Monaghan1985\]: 1 - 3/2 q^2 + 3/4 q^3 below 1, (2 - q)^3 / 4 below 2. By default h is 1.3 spacings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CubicSpline(f64);

/// C2 kernel of Wendland \[Wendland1995\]: (1 - q/2)^4 (1 + 2 q). It has no pairing instability, unlike the cubic spline under compression.
/// By default h is 1.3 spacings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WendlandC2(f64);

/// Allowed smoothing lengths, in spacings: neither too few neighbours nor too many.
const RATIOS: std::ops::RangeInclusive<f64> = 0.8..=3.0;

/// Smoothing length out of range.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SmoothingError(f64);

impl std::fmt::Display for SmoothingError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let SmoothingError(ratio) = self;
        write!(f, "kernel: smoothing length = {ratio} spacings is not allowed; it must be 0.8 to 3")
    }
}
impl std::error::Error for SmoothingError {}

macro_rules! kernel_of_ratio {
    ($kernel:ident) => {
        impl Default for $kernel {
            fn default() -> Self {
                $kernel(1.3)
            }
        }
        impl $kernel {
            /// Create a kernel of smoothing length h over the spacing, `ratio`.
            ///
            /// # Errors
            /// A ratio below 0.8 (too few neighbours) or above 3.
            pub fn new(ratio: f64) -> Result<Self, SmoothingError> {
                if RATIOS.contains(&ratio) { Ok($kernel(ratio)) } else { Err(SmoothingError(ratio)) }
            }
        }
    };
}
kernel_of_ratio!(CubicSpline);
kernel_of_ratio!(WendlandC2);

impl WendlandC2 {
    /// Kernel with h of 1.1 spacings, for corrected gradients.
    pub const NARROW: WendlandC2 = WendlandC2(1.1);
    /// Kernel with h of 1.55 spacings, for liquids: a lattice under pressure has next to no stiffness in shear. Sums of gradients that are
    /// not corrected, K = sum_j V_j (-W'/r) d (x) d, of a lattice that is strained by e and -e along its axes have K_xx - K_yy = 4 k e with k of
    /// -0.05, 0.015, 0.05 at 1.5, 1.55, 1.6 spacings in the plane, and -0.07, -0.016, 0.03 in space: work against the pressure that a liquid
    /// does not have. With 1.5 the period of a standing wave is 1.3 % short at any spacing.
    pub const WIDE: WendlandC2 = WendlandC2(1.55);
}

impl Kernel for CubicSpline {
    const NAME: &'static str = "cubic spline";
    fn norm(&self, dimensions: usize) -> f64 {
        use std::f64::consts::PI;
        if dimensions == 2 { 10.0 / (7.0 * PI) } else { 1.0 / PI }
    }
    #[inline(always)]
    fn value<L: Lane<Real = f64>>(&self, q: L) -> L {
        let rest = (L::of(2.0) - q).max(L::zero());
        let inner = (L::one() - q).max(L::zero());
        // (2 - q)^3 / 4 - (1 - q)^3, each where it is positive.
        (rest * rest * rest).mul_add(L::of(0.25), -(inner * inner * inner))
    }
    #[inline(always)]
    fn slope<L: Lane<Real = f64>>(&self, q: L) -> L {
        let rest = (L::of(2.0) - q).max(L::zero());
        let near = q.mul_add(L::of(2.25), L::of(-3.0));
        let far = -(rest * rest * L::of(0.75)) / q.max(L::of(0.5));
        L::select(q.lt(L::one()), near, far)
    }
    fn ratio(&self) -> f64 {
        self.0
    }
}

impl Kernel for WendlandC2 {
    const NAME: &'static str = "Wendland C2";
    fn norm(&self, dimensions: usize) -> f64 {
        use std::f64::consts::PI;
        if dimensions == 2 { 7.0 / (4.0 * PI) } else { 21.0 / (16.0 * PI) }
    }
    #[inline(always)]
    fn value<L: Lane<Real = f64>>(&self, q: L) -> L {
        let rest = q.mul_add(L::of(-0.5), L::one()).max(L::zero());
        let square = rest * rest;
        square * square * q.mul_add(L::of(2.0), L::one())
    }
    #[inline(always)]
    fn slope<L: Lane<Real = f64>>(&self, q: L) -> L {
        let rest = q.mul_add(L::of(-0.5), L::one()).max(L::zero());
        -(rest * rest * rest * L::of(5.0))
    }
    fn ratio(&self) -> f64 {
        self.0
    }
}

/// Return the factor with which the gradients of a lattice of unit spacing are exact: D / sum_j (-W'/r) r^2.
pub(crate) fn lattice_scale<K: Kernel>(kernel: &K, dimensions: usize) -> f64 {
    let h = kernel.ratio();
    let reach = (2.0 * h).ceil() as i32;
    let deep = if dimensions == 3 { reach } else { 0 };
    let mut sum = 0.0;
    for x in -reach..=reach {
        for y in -reach..=reach {
            for z in -deep..=deep {
                let square = f64::from(x * x + y * y + z * z);
                let q = square.sqrt() / h;
                if q > 0.0 && q < 2.0 {
                    sum -= kernel.slope(q) * square;
                }
            }
        }
    }
    dimensions as f64 * h.powi(dimensions as i32 + 2) / (kernel.norm(dimensions) * sum)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn integral(f: impl Fn(f64) -> f64) -> f64 {
        let steps = 200_000;
        let width = 2.0 / f64::from(steps);
        (0..steps).map(|n| f((f64::from(n) + 0.5) * width) * width).sum()
    }

    fn is_kernel<K: Kernel>(kernel: K) {
        use std::f64::consts::PI;
        let plane = integral(|q| kernel.norm(2) * kernel.value(q) * 2.0 * PI * q);
        let space = integral(|q| kernel.norm(3) * kernel.value(q) * 4.0 * PI * q * q);
        assert!((plane - 1.0).abs() < 1e-9 && (space - 1.0).abs() < 1e-9, "{} {plane} {space}", K::NAME);
        for q in [0.05, 0.4, 0.999, 1.0, 1.3, 1.99, 2.5] {
            let e = 1e-6;
            let slope = (kernel.value(q + e) - kernel.value(q - e)) / (2.0 * e);
            assert!((kernel.slope(q) * q - slope).abs() < 1e-5, "{} at {q}", K::NAME);
        }
        assert!(
            kernel.slope(0.0f64).is_finite() && kernel.value(2.0f64) == 0.0 && kernel.slope(2.0f64) == 0.0
        );
    }

    #[test]
    fn kernels_are_one_in_all_and_know_their_slopes() {
        is_kernel(CubicSpline::default());
        is_kernel(WendlandC2::default());
    }

    #[test]
    fn smoothing_lengths_that_leave_no_neighbours_are_refused() {
        for ratio in [0.5, 3.1, f64::NAN] {
            let said = CubicSpline::new(ratio).expect_err("refused").to_string();
            assert!(said.contains("smoothing length") && said.contains("0.8 to 3"), "{said}");
        }
        assert_eq!(WendlandC2::new(2.0).map(|k| k.ratio()), Ok(2.0));
    }
}
