//! Isotropic hardening sigma_h(eps_p) and its plastic strain increment.

use crate::lane::{Lane, Mask, Real};
use crate::parameter::{Check, ParameterError};
use crate::point::{Breakdown, Fault};

/// Solution of the consistency equation.
#[derive(Clone, Copy, Debug)]
pub struct Increment<L> {
    /// Plastic strain increment d >= 0; zero in the lanes that do not yield.
    pub value: L,
    /// Lanes without a solution.
    pub fault: Fault<L>,
}

/// Hardening curve sigma_h(eps_p), Pa.
pub trait Hardening<T: Real>: std::fmt::Debug + Copy + Send + Sync + 'static {
    /// Hardening stress sigma_h, Pa.
    fn stress<L: Lane<Real = T>>(&self, strain: L) -> L;

    /// Lower bound of sigma_h, Pa, cheap to compute: a trial stress below it needs no return mapping.
    fn lower_bound<L: Lane<Real = T>>(&self, strain: L) -> L;

    /// Solve `trial` - `three_g` d = `factor` sigma_h(`strain` + d) for the increment d, where the trial stress exceeds
    /// `factor` sigma_h(`strain`); `factor`, of rate and temperature, is not negative.
    fn increment<L: Lane<Real = T>>(&self, trial: L, three_g: L, factor: L, strain: L) -> Increment<L>;
}

/// Linear hardening sigma_h = Y0 + H eps_p (book, "Linear hardening"), returned in closed form.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LinearHardening<T> {
    initial: T,
    modulus: T,
}

impl<T: Real> LinearHardening<T> {
    /// Create from initial yield stress Y0 and plastic modulus H, Pa. H = 0 is perfect plasticity; from a tangent
    /// modulus E_t, H = E E_t / (E - E_t).
    ///
    /// # Errors
    /// Y0 not positive, or H negative.
    pub fn new(initial: T, modulus: T) -> Result<Self, ParameterError> {
        let check = Check("linear hardening");
        Ok(LinearHardening {
            initial: check.positive("yield stress Y0", initial)?,
            modulus: check.not_negative("plastic modulus H", modulus)?,
        })
    }

    /// Create from checked constants.
    pub(crate) fn known(initial: f64, modulus: f64) -> Self {
        LinearHardening { initial: T::of(initial), modulus: T::of(modulus) }
    }
}

impl<T: Real> Hardening<T> for LinearHardening<T> {
    #[inline(always)]
    fn stress<L: Lane<Real = T>>(&self, strain: L) -> L {
        L::splat(self.modulus).mul_add(strain, L::splat(self.initial))
    }
    #[inline(always)]
    fn lower_bound<L: Lane<Real = T>>(&self, strain: L) -> L {
        self.stress(strain)
    }
    #[inline(always)]
    fn increment<L: Lane<Real = T>>(&self, trial: L, three_g: L, factor: L, strain: L) -> Increment<L> {
        let over = trial - factor * self.stress(strain);
        let value = over.max(L::zero()) / factor.mul_add(L::splat(self.modulus), three_g);
        Increment { value, fault: Fault::none() }
    }
}

/// Concave hardening curve with a finite slope everywhere.
trait Concave<T: Real> {
    /// Stress and slope, Pa.
    fn point<L: Lane<Real = T>>(&self, strain: L) -> (L, L);

    /// Newton iteration from d = 0. The consistency function is decreasing and convex, so that the iteration approaches
    /// the root from the left without overshoot.
    #[inline(always)]
    fn newton<L: Lane<Real = T>>(&self, trial: L, three_g: L, factor: L, strain: L) -> Increment<L> {
        let zero = L::zero();
        let yields = (factor * self.point(strain).0).lt(trial);
        let mut value = zero;
        if !yields.any() {
            return Increment { value, fault: Fault::none() };
        }
        let tolerance = trial * L::splat(T::default_epsilon() * T::of(64.0));
        for _ in 0..STEPS {
            let (stress, slope) = self.point(strain + value);
            let rest = trial - three_g * value - factor * stress;
            let open = yields & rest.abs().gt(tolerance);
            if !open.any() {
                return Increment { value, fault: Fault::none() };
            }
            value = L::select(open, (value + rest / factor.mul_add(slope, three_g)).max(zero), value);
        }
        Increment { value, fault: Fault::none().require(!yields, Breakdown::NotConverged) }
    }
}

/// Voce hardening sigma_h = A + Q \[1 - exp(-b eps_p)\]: saturates at A + Q.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VoceHardening<T> {
    initial: T,
    saturation: T,
    rate: T,
}

impl<T: Real> VoceHardening<T> {
    /// Create from initial yield stress A and saturation Q, Pa, and b, dimensionless.
    ///
    /// # Errors
    /// A not positive, Q or b negative.
    pub fn new(initial: T, saturation: T, rate: T) -> Result<Self, ParameterError> {
        let check = Check("Voce hardening");
        Ok(VoceHardening {
            initial: check.positive("yield stress A", initial)?,
            saturation: check.not_negative("saturation Q", saturation)?,
            rate: check.not_negative("b", rate)?,
        })
    }
}

impl<T: Real> Concave<T> for VoceHardening<T> {
    #[inline(always)]
    fn point<L: Lane<Real = T>>(&self, strain: L) -> (L, L) {
        let left = L::splat(self.saturation) * (L::splat(-self.rate) * strain).exp();
        (L::splat(self.initial + self.saturation) - left, L::splat(self.rate) * left)
    }
}

impl<T: Real> Hardening<T> for VoceHardening<T> {
    #[inline(always)]
    fn stress<L: Lane<Real = T>>(&self, strain: L) -> L {
        self.point(strain).0
    }
    #[inline(always)]
    fn lower_bound<L: Lane<Real = T>>(&self, _: L) -> L {
        L::splat(self.initial)
    }
    #[inline(always)]
    fn increment<L: Lane<Real = T>>(&self, trial: L, three_g: L, factor: L, strain: L) -> Increment<L> {
        self.newton(trial, three_g, factor, strain)
    }
}

/// Saturating power hardening sigma_h = min( Y0 \[1 + beta (eps_p + eps_i)\]^n, Y_max ), used in
/// [`SteinbergGuinan`](crate::strength::SteinbergGuinan).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SaturatingPower<T> {
    initial: T,
    largest: T,
    beta: T,
    exponent: T,
    strain: T,
}

impl<T: Real> SaturatingPower<T> {
    /// Create from Y0 and Y_max, Pa, beta, n and the initial plastic strain eps_i.
    ///
    /// # Errors
    /// Y0 not positive, Y_max below Y0, beta or eps_i negative, n outside \[0, 1\].
    pub fn new(initial: T, largest: T, beta: T, exponent: T, strain: T) -> Result<Self, ParameterError> {
        let check = Check("saturating power hardening");
        check.positive("yield stress Y0", initial)?;
        check.that(largest >= initial, "largest yield stress Y_max", largest, "at least Y0")?;
        check.not_negative("beta", beta)?;
        check.that(exponent >= T::of(0.0) && exponent <= T::of(1.0), "exponent n", exponent, "in [0, 1]")?;
        check.not_negative("initial strain eps_i", strain)?;
        Ok(SaturatingPower { initial, largest, beta, exponent, strain })
    }
    pub(crate) fn known([initial, largest, beta, exponent]: [f64; 4]) -> Self {
        SaturatingPower {
            initial: T::of(initial),
            largest: T::of(largest),
            beta: T::of(beta),
            exponent: T::of(exponent),
            strain: T::of(0.0),
        }
    }
}

impl<T: Real> Concave<T> for SaturatingPower<T> {
    #[inline(always)]
    fn point<L: Lane<Real = T>>(&self, strain: L) -> (L, L) {
        let base = L::splat(self.beta).mul_add(strain + L::splat(self.strain), L::one());
        let rising = L::splat(self.initial) * base.powf(L::splat(self.exponent));
        let slope = L::splat(self.beta * self.exponent) * rising / base;
        let largest = L::splat(self.largest);
        let full = rising.ge(largest);
        (L::select(full, largest, rising), L::select(full, L::zero(), slope))
    }
}

impl<T: Real> Hardening<T> for SaturatingPower<T> {
    #[inline(always)]
    fn stress<L: Lane<Real = T>>(&self, strain: L) -> L {
        self.point(strain).0
    }
    #[inline(always)]
    fn lower_bound<L: Lane<Real = T>>(&self, _: L) -> L {
        L::splat(self.initial)
    }
    #[inline(always)]
    fn increment<L: Lane<Real = T>>(&self, trial: L, three_g: L, factor: L, strain: L) -> Increment<L> {
        self.newton(trial, three_g, factor, strain)
    }
}

/// Ludwik hardening sigma_h = A + B eps_p^n, also used in Johnson-Cook (book, "Johnson-Cook").
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PowerHardening<T> {
    initial: T,
    coefficient: T,
    exponent: T,
    /// Slope of the chord: B if eps^n >= eps on \[0, 1\], else zero.
    chord: T,
}

/// Largest increment over strain for the binomial series.
const SMALL: f64 = 1.0 / 64.0;
/// Limit of Newton steps: convergence is quadratic from below, so that more steps mean an invalid number.
const STEPS: usize = 60;

impl<T: Real> PowerHardening<T> {
    /// Create from initial yield stress A and hardening coefficient B, Pa, and exponent n.
    ///
    /// # Errors
    /// A not positive, B negative, or n not positive.
    pub fn new(initial: T, coefficient: T, exponent: T) -> Result<Self, ParameterError> {
        let check = Check("power hardening");
        let initial = check.positive("yield stress A", initial)?;
        let coefficient = check.not_negative("hardening coefficient B", coefficient)?;
        let exponent = check.positive("hardening exponent n", exponent)?;
        Ok(Self::known(initial, coefficient, exponent))
    }

    pub(crate) fn known(initial: T, coefficient: T, exponent: T) -> Self {
        let chord = if exponent <= T::of(1.0) { coefficient } else { T::of(0.0) };
        PowerHardening { initial, coefficient, exponent, chord }
    }

    /// True if the curve is a straight line; uniform over all points, so worth a branch.
    #[inline(always)]
    fn is_straight(&self) -> bool {
        self.exponent == T::of(1.0) || self.coefficient == T::of(0.0)
    }

    /// Smallest strain of the curve: the logarithm needs a positive argument, and the slope a finite value. B eps^n is
    /// negligible there unless n is very small, and then the curve starts flat.
    #[inline(always)]
    fn start<L: Lane<Real = T>>(&self) -> L {
        if size_of::<T>() < size_of::<f64>() { L::of(1e-26) } else { L::of(1e-280) }
    }

    /// Compute strain^n.
    #[inline(always)]
    fn power<L: Lane<Real = T>>(&self, strain: L) -> L {
        strain.max(self.start()).powf(L::splat(self.exponent))
    }

    /// Remainder of the tangent, (1 + x)^n - 1 - n x for |x| <= [`SMALL`], to 1e-12.
    #[inline(always)]
    fn beyond_tangent<L: Lane<Real = T>>(&self, x: L) -> L {
        let one = L::one();
        let n = self.exponent;
        let mut sum = one;
        for k in [5.0, 4.0, 3.0] {
            // Multiply x by the constant first: independent of the sum.
            let term = x * L::splat((n - T::of(k - 1.0)) * T::of(1.0 / k));
            sum = term.mul_add(sum, one);
        }
        x * x * L::splat(n * (n - T::of(1.0)) * T::of(0.5)) * sum
    }

    /// Newton step for the increment, with `hardened` the height of the curve above A at a strain and `over` the
    /// residual of the trial stress.
    #[inline(always)]
    fn tangent_step<L: Lane<Real = T>>(&self, hardened: L, per_strain: L, three_g: L, over: L) -> Tangent<L> {
        let slope = L::splat(self.exponent) * hardened * per_strain;
        let compliance = (slope + three_g).recip();
        let value = over * compliance;
        Tangent { hardened, slope, compliance, value, relative: value * per_strain }
    }

    /// Refine a small step by one more Newton step, with the power by series and the slope at the end of the first. The
    /// linear terms of the residual cancel.
    #[inline(always)]
    fn polished<L: Lane<Real = T>>(&self, step: &Tangent<L>) -> L {
        let (one, n) = (L::one(), L::splat(self.exponent));
        let rest = -(step.hardened * self.beyond_tangent(step.relative));
        let bend = step.slope * (one - n) * step.relative * step.compliance;
        rest.mul_add(step.compliance * (one + bend), step.value)
    }

    /// Monotone Newton iteration for increments that are not small compared with the strain, and for the first one,
    /// where the slope of the curve is infinite.
    #[inline(always)]
    fn iterate<L: Lane<Real = T>>(&self, start: Start<L>) -> Increment<L> {
        let Start { trial, three_g, factor, strain, over, yields } = start;
        let (tiny, zero, one, n) = (self.start::<L>(), L::zero(), L::one(), L::splat(self.exponent));
        let tolerance = trial * L::splat(T::default_epsilon() * T::of(64.0));
        let b = factor * L::splat(self.coefficient);
        let a = factor * L::splat(self.initial);
        // For n <= 1 the consistency function is convex and decreasing, and (eps + d)^n <= eps^n + d^n: this start is
        // left of the root, where its tangents cannot overshoot. For n > 1 one overshoot comes first.
        let half = over.max(zero) * L::of(0.5);
        let share = (half / b.max(tiny)).clamp(tiny, one);
        let mut value = (half / three_g).min(share.powf(n.recip())).max(tiny);
        for _ in 0..STEPS {
            let total = (strain + value).max(tiny);
            let power = total.powf(n);
            let rest = trial - three_g * value - a - b * power;
            let open = yields & rest.abs().gt(tolerance);
            if !open.any() {
                return Increment { value, fault: Fault::none() };
            }
            let next = value + rest / (b * n * power / total + three_g);
            value = L::select(open, next, value);
        }
        Increment { value, fault: Fault::none().require(!yields, Breakdown::NotConverged) }
    }
}

/// Newton step along the tangent of the curve, with its intermediate values.
struct Tangent<L: Lane> {
    hardened: L,
    slope: L,
    compliance: L,
    value: L,
    /// Step over the strain.
    relative: L,
}

impl<L: Lane> Tangent<L> {
    /// True if the step is small enough, compared with the strain, for the binomial series.
    #[inline(always)]
    fn is_small(&self) -> L::Mask {
        self.relative.abs().le(L::of(SMALL))
    }
}

struct Start<L: Lane> {
    trial: L,
    three_g: L,
    factor: L,
    strain: L,
    over: L,
    yields: L::Mask,
}

impl<T: Real> Hardening<T> for PowerHardening<T> {
    #[inline(always)]
    fn stress<L: Lane<Real = T>>(&self, strain: L) -> L {
        let (a, b) = (L::splat(self.initial), L::splat(self.coefficient));
        if self.is_straight() { b.mul_add(strain, a) } else { b.mul_add(self.power(strain), a) }
    }
    #[inline(always)]
    fn lower_bound<L: Lane<Real = T>>(&self, strain: L) -> L {
        L::splat(self.chord).mul_add(strain.min(L::one()), L::splat(self.initial))
    }
    #[inline(always)]
    fn increment<L: Lane<Real = T>>(&self, trial: L, three_g: L, factor: L, strain: L) -> Increment<L> {
        let zero = L::zero();
        let (a, b) = (L::splat(self.initial), L::splat(self.coefficient));
        if self.is_straight() {
            let over = trial - factor * b.mul_add(strain, a);
            let slope = if self.coefficient == T::of(0.0) { zero } else { factor * b };
            return Increment { value: over.max(zero) / (slope + three_g), fault: Fault::none() };
        }
        let power = self.power(strain);
        let over = trial - factor * b.mul_add(power, a);
        let yields = over.gt(zero);
        if !yields.any() {
            return Increment { value: zero, fault: Fault::none() };
        }
        let per_strain = strain.max(self.start()).recip();
        let step = self.tangent_step(factor * b * power, per_strain, three_g, L::select(yields, over, zero));
        // Each lane keeps its first accurate result, so that it does not depend on other lanes.
        let (value, mut done) = (self.polished(&step), step.is_small());
        if done.all() {
            return Increment { value: L::select(yields, value, zero), fault: Fault::none() };
        }
        // Second step from the end of the first: sufficient unless plastic flow has just begun.
        let strain_there = (strain + step.value).max(self.start());
        let power = self.power(strain_there);
        let over_there = trial - three_g * step.value - factor * b.mul_add(power, a);
        let over_there = L::select(yields, over_there, zero);
        let again = self.tangent_step(factor * b * power, strain_there.recip(), three_g, over_there);
        let value = L::select(done, value, step.value + self.polished(&again));
        done = done | again.is_small();
        if done.all() {
            return Increment { value: L::select(yields, value, zero), fault: Fault::none() };
        }
        let found = self.iterate(Start { trial, three_g, factor, strain, over, yields: yields & !done });
        let value = L::select(done, value, found.value);
        Increment { value: L::select(yields, value, zero), fault: found.fault }
    }
}
