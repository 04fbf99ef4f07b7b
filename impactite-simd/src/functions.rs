//! Logarithm and exponential in double precision, to about one unit in the last place, without their bit operations.

#![cfg(target_arch = "x86_64")]

use crate::lane::Lane;

/// ln 2 in two parts: the first has so few digits that its product with an exponent is exact.
const LN2_HIGH: f64 = 0.693_147_180_369_123_8;
const LN2_LOW: f64 = 1.908_214_929_270_587_7e-10;

/// Compute `high` x + `low`.
#[inline(always)]
fn pair<P: Lane>(high: f64, low: f64, x: P) -> P {
    P::of(high).mul_add(x, P::of(low))
}

/// Coefficients of (ln m / s - 2) / s^2 in powers of s^2, s = (m - 1) / (m + 1), for m in [sqrt 1/2, sqrt 2]:
/// interpolation of the series 2/3 + 2/5 s^2 + .. at the Chebyshev points of that interval, with an error of 5e-18 of
/// the logarithm; the series itself would need ten terms.
const LN: [f64; 7] = [
    0.666_666_666_666_667,
    0.399_999_999_998_994_44,
    0.285_714_286_260_032_7,
    0.222_222_111_302_598_78,
    0.181_828_894_556_749_47,
    0.153_317_106_182_107_73,
    0.146_165_854_248_886_23,
];

/// Compute ln(2^e m) for m in [sqrt 1/2, sqrt 2].
#[inline(always)]
pub fn ln_of_parts<P: Lane>(m: P, e: P) -> P {
    let s = (m - P::one()) / (m + P::one());
    let z = s * s;
    // Estrin's scheme (pairs, pairs of pairs and so on): a short dependency chain, which limits the step of a material
    // law.
    let (z2, z4) = (z * z, z * z * (z * z));
    let (first, second) = (pair(LN[1], LN[0], z), pair(LN[3], LN[2], z));
    let last = P::of(LN[6]).mul_add(z2, pair(LN[5], LN[4], z));
    let p = last.mul_add(z4, second.mul_add(z2, first));
    let ln_m = (p * z).mul_add(s, s + s);
    e.mul_add(P::of(LN2_HIGH), e.mul_add(P::of(LN2_LOW), ln_m))
}

/// Compute exp(x - k ln 2) by its series, for an integer k with |x - k ln 2| <= ln(2)/2.
#[inline(always)]
pub fn exp_of_rest<P: Lane>(x: P, k: P) -> P {
    let r = (-k).mul_add(P::of(LN2_HIGH), x);
    let r = (-k).mul_add(P::of(LN2_LOW), r);
    // 1 + (r + r^2 q), q by Estrin's scheme as in the logarithm.
    let (r2, r4) = (r * r, r * r * (r * r));
    let a = pair(1.0 / 6.0, 0.5, r);
    let b = pair(1.0 / 120.0, 1.0 / 24.0, r);
    let c = pair(1.0 / 5_040.0, 1.0 / 720.0, r);
    let d = pair(1.0 / 362_880.0, 1.0 / 40_320.0, r);
    let e = pair(1.0 / 39_916_800.0, 1.0 / 3_628_800.0, r);
    let f = pair(1.0 / 6_227_020_800.0, 1.0 / 479_001_600.0, r);
    let (first, second, last) = (b.mul_add(r2, a), d.mul_add(r2, c), f.mul_add(r2, e));
    let q = last.mul_add(r4, second).mul_add(r4, first);
    q.mul_add(r2, r) + P::one()
}
