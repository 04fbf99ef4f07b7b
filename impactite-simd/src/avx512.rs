//! AVX-512 implementation of [`Lane`]: two groups of particles in double precision, so that laws, gathers and weights
//! need half as many instructions. See the invariant in the parent module and its use in [`super::avx2`].

#![cfg(target_arch = "x86_64")]

use std::arch::x86_64::*;
use std::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Not, Sub};

use crate::lane::{Lane, Mask};

use super::avx2::F64x4;
use super::functions::{exp_of_rest, ln_of_parts};
use super::{Arch, Band, Kernel, Pack, Row, RowPair};

/// True if this processor has the instructions of [`Avx512`].
#[inline]
pub fn available() -> bool {
    super::avx2::available()
        && is_x86_feature_detected!("avx512f")
        && is_x86_feature_detected!("avx512dq")
        && is_x86_feature_detected!("avx512vl")
}

/// Processors with AVX-512 (F, DQ and VL), AVX2 and FMA.
pub struct Avx512;

/// Run a kernel on a processor with AVX-512, AVX2 and FMA.
#[target_feature(enable = "avx512f,avx512dq,avx512vl,avx2,fma")]
pub fn with<K: Kernel<f64>>(kernel: K) -> K::Output {
    kernel.run::<Avx512>()
}

/// Memory representation of eight numbers.
#[derive(Clone, Copy, Debug, Default)]
#[repr(C, align(64))]
pub struct Numbers([f64; 8]);

impl AsRef<[f64]> for Numbers {
    #[inline(always)]
    fn as_ref(&self) -> &[f64] {
        &self.0
    }
}

impl Arch<f64> for Avx512 {
    type Pack = F64x4;
    type Batch = F64x8;
    type Quad = F64x4;
    type Band = F64x8;
    #[inline(always)]
    fn sums([a, b, c, d]: [F64x8; 4]) -> F64x4 {
        unsafe {
            // Pair sums of a and b in turn, and of c and d, by quarters; sums of halves of both; then sums of quarters.
            let ab = _mm512_add_pd(_mm512_unpacklo_pd(a.0, b.0), _mm512_unpackhi_pd(a.0, b.0));
            let cd = _mm512_add_pd(_mm512_unpacklo_pd(c.0, d.0), _mm512_unpackhi_pd(c.0, d.0));
            let z = _mm512_add_pd(_mm512_shuffle_f64x2::<0x44>(ab, cd), _mm512_shuffle_f64x2::<0xee>(ab, cd));
            let (lo, hi) = (_mm512_castpd512_pd256(z), _mm512_extractf64x4_pd::<1>(z));
            F64x4(_mm256_add_pd(
                _mm256_permute2f128_pd::<0x20>(lo, hi),
                _mm256_permute2f128_pd::<0x31>(lo, hi),
            ))
        }
    }
}

/// Vector over eight particles.
#[derive(Clone, Copy, Debug)]
#[repr(transparent)]
pub struct F64x8(__m512d);
/// Mask of eight lanes.
#[derive(Clone, Copy, Debug)]
#[repr(transparent)]
pub struct M64x8(__mmask8);

macro_rules! operation {
    ($operation:ident, $name:ident, $instruction:ident) => {
        impl $operation for F64x8 {
            type Output = Self;
            #[inline(always)]
            fn $name(self, o: Self) -> Self {
                unsafe { F64x8($instruction(self.0, o.0)) }
            }
        }
    };
}
operation!(Add, add, _mm512_add_pd);
operation!(Sub, sub, _mm512_sub_pd);
operation!(Mul, mul, _mm512_mul_pd);
operation!(Div, div, _mm512_div_pd);
impl Neg for F64x8 {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        unsafe { F64x8(_mm512_xor_pd(self.0, _mm512_set1_pd(-0.0))) }
    }
}
impl BitAnd for M64x8 {
    type Output = Self;
    #[inline(always)]
    fn bitand(self, o: Self) -> Self {
        M64x8(self.0 & o.0)
    }
}
impl BitOr for M64x8 {
    type Output = Self;
    #[inline(always)]
    fn bitor(self, o: Self) -> Self {
        M64x8(self.0 | o.0)
    }
}
impl Not for M64x8 {
    type Output = Self;
    #[inline(always)]
    fn not(self) -> Self {
        M64x8(!self.0)
    }
}
impl Mask for M64x8 {
    #[inline(always)]
    fn splat(truth: bool) -> Self {
        M64x8(if truth { !0 } else { 0 })
    }
    #[inline(always)]
    fn any(self) -> bool {
        self.0 != 0
    }
    #[inline(always)]
    fn lane(self, i: usize) -> bool {
        self.0 >> i & 1 == 1
    }
}
impl F64x8 {
    #[inline(always)]
    fn join([low, high]: [F64x4; 2]) -> Self {
        unsafe { F64x8(_mm512_insertf64x4::<1>(_mm512_castpd256_pd512(low.0), high.0)) }
    }
    #[inline(always)]
    fn part(self) -> [F64x4; 2] {
        unsafe { [F64x4(_mm512_castpd512_pd256(self.0)), F64x4(_mm512_extractf64x4_pd::<1>(self.0))] }
    }
    #[inline(always)]
    fn to_array(self) -> [f64; 8] {
        let mut a = [0.0; 8];
        unsafe { _mm512_storeu_pd(a.as_mut_ptr(), self.0) };
        a
    }
    #[inline(always)]
    fn from_array(a: &[f64; 8]) -> Self {
        unsafe { F64x8(_mm512_loadu_pd(a.as_ptr())) }
    }
}
impl Lane for F64x8 {
    type Real = f64;
    type Mask = M64x8;
    const WIDTH: usize = 8;
    #[inline(always)]
    fn splat(x: f64) -> Self {
        unsafe { F64x8(_mm512_set1_pd(x)) }
    }
    #[inline(always)]
    fn lane(self, i: usize) -> f64 {
        self.to_array()[i]
    }
    #[inline(always)]
    fn with_lane(self, i: usize, x: f64) -> Self {
        let mut a = self.to_array();
        a[i] = x;
        Self::from_array(&a)
    }
    #[inline(always)]
    fn mul_add(self, b: Self, c: Self) -> Self {
        unsafe { F64x8(_mm512_fmadd_pd(self.0, b.0, c.0)) }
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        unsafe { F64x8(_mm512_sqrt_pd(self.0)) }
    }
    #[inline(always)]
    fn ln(self) -> Self {
        ln(self)
    }
    #[inline(always)]
    fn exp(self) -> Self {
        exp(self)
    }
    #[inline(always)]
    fn abs(self) -> Self {
        unsafe { F64x8(_mm512_abs_pd(self.0)) }
    }
    #[inline(always)]
    fn min(self, o: Self) -> Self {
        // `self` if one is NaN, as with AVX2.
        unsafe { F64x8(_mm512_min_pd(o.0, self.0)) }
    }
    #[inline(always)]
    fn max(self, o: Self) -> Self {
        unsafe { F64x8(_mm512_max_pd(o.0, self.0)) }
    }
    #[inline(always)]
    fn lt(self, o: Self) -> M64x8 {
        unsafe { M64x8(_mm512_cmp_pd_mask::<_CMP_LT_OQ>(self.0, o.0)) }
    }
    #[inline(always)]
    fn le(self, o: Self) -> M64x8 {
        unsafe { M64x8(_mm512_cmp_pd_mask::<_CMP_LE_OQ>(self.0, o.0)) }
    }
    #[inline(always)]
    fn select(mask: M64x8, yes: Self, no: Self) -> Self {
        unsafe { F64x8(_mm512_mask_blend_pd(mask.0, no.0, yes.0)) }
    }
}
impl Pack<f64> for F64x8 {
    type Numbers = Numbers;
    #[inline(always)]
    fn from_rows([low, high]: [&Row<f64, 4>; 2], _: usize) -> Self {
        F64x8::join([Pack::load(low), Pack::load(high)])
    }
    #[inline(always)]
    fn to_row(self, group: usize, row: &mut Row<f64, 4>, _: usize) {
        Pack::store(self.part()[group], row);
    }
    #[inline(always)]
    fn from_pair(pair: &RowPair<Row<f64, 4>>, _: usize, _: usize) -> Self {
        // SAFETY (beyond the module's invariant): a pair of rows is 64 bytes at a multiple of 64.
        unsafe { F64x8(_mm512_load_pd(std::ptr::from_ref(pair).cast())) }
    }
    #[inline(always)]
    fn to_pair(self, pair: &mut RowPair<Row<f64, 4>>, _: usize, _: usize) {
        // SAFETY: as above.
        unsafe { _mm512_store_pd(std::ptr::from_mut(pair).cast(), self.0) }
    }
    #[inline(always)]
    fn load(numbers: &Numbers) -> Self {
        // SAFETY (beyond the module's invariant): 64 bytes at a multiple of 64.
        unsafe { F64x8(_mm512_load_pd(numbers.0.as_ptr())) }
    }
    #[inline(always)]
    fn store(self, numbers: &mut Numbers) {
        // SAFETY: as above.
        unsafe { _mm512_store_pd(numbers.0.as_mut_ptr(), self.0) }
    }
    #[inline(always)]
    fn bits(mask: Self::Mask) -> u32 {
        mask.0.into()
    }
    #[inline(always)]
    fn records(a: Self, b: Self, c: Self, d: Self, out: &mut [[f64; 4]]) {
        let out = out[..8].as_flattened_mut();
        // SAFETY (beyond the module's invariant): there are 32 numbers.
        unsafe {
            let (ab0, ab1) = (_mm512_unpacklo_pd(a.0, b.0), _mm512_unpackhi_pd(a.0, b.0));
            let (cd0, cd1) = (_mm512_unpacklo_pd(c.0, d.0), _mm512_unpackhi_pd(c.0, d.0));
            // Quarters contain two numbers of a record: first lanes 0 to 3, then lanes 4 to 7.
            let (s0, s1) = (_mm512_shuffle_f64x2::<0x44>(ab0, cd0), _mm512_shuffle_f64x2::<0x44>(ab1, cd1));
            let (t0, t1) = (_mm512_shuffle_f64x2::<0xee>(ab0, cd0), _mm512_shuffle_f64x2::<0xee>(ab1, cd1));
            let to = out.as_mut_ptr();
            _mm512_storeu_pd(to, _mm512_shuffle_f64x2::<0x88>(s0, s1));
            _mm512_storeu_pd(to.add(8), _mm512_shuffle_f64x2::<0xdd>(s0, s1));
            _mm512_storeu_pd(to.add(16), _mm512_shuffle_f64x2::<0x88>(t0, t1));
            _mm512_storeu_pd(to.add(24), _mm512_shuffle_f64x2::<0xdd>(t0, t1));
        }
    }
}

impl Band<f64, F64x8, F64x4> for F64x8 {
    #[inline(always)]
    fn load(records: &[[f64; 4]]) -> Self {
        let numbers = records[..2].as_flattened();
        // SAFETY (beyond the module's invariant): there are 8 numbers.
        unsafe { F64x8(_mm512_loadu_pd(numbers.as_ptr())) }
    }
    #[inline(always)]
    fn weights(of: &Numbers, first: usize) -> Self {
        let (one, two) = (first as i64, first as i64 + 1);
        unsafe {
            let lanes = _mm512_setr_epi64(one, one, one, one, two, two, two, two);
            F64x8(_mm512_permutexvar_pd(lanes, <F64x8 as Pack<f64>>::load(of).0))
        }
    }
    #[inline(always)]
    fn widen(record: F64x4) -> Self {
        unsafe { F64x8(_mm512_zextpd256_pd512(record.0)) }
    }
    #[inline(always)]
    fn fold(self) -> F64x4 {
        let [low, high] = self.part();
        low + high
    }
}

/// Natural logarithm of positive, finite, normal numbers, x = 2^e m.
#[inline(always)]
fn ln(x: F64x8) -> F64x8 {
    const SQRT_HALF: i64 = 0x3fe6_a09e_667f_3bcd;
    unsafe {
        let bits = _mm512_castpd_si512(x.0);
        let shifted = _mm512_sub_epi64(bits, _mm512_set1_epi64(SQRT_HALF));
        let exponent = _mm512_and_si512(shifted, _mm512_set1_epi64(!0 << 52));
        let m = F64x8(_mm512_castsi512_pd(_mm512_sub_epi64(bits, exponent)));
        let e = F64x8(_mm512_cvtepi64_pd(_mm512_srai_epi64::<52>(exponent)));
        ln_of_parts(m, e)
    }
}

/// Exponential, x = k ln 2 + r. Arguments are limited to [-708, 709].
#[inline(always)]
fn exp(x: F64x8) -> F64x8 {
    let x = x.clamp(F64x8::of(-708.0), F64x8::of(709.0));
    unsafe {
        let k = F64x8(_mm512_roundscale_pd::<0x08>((x * F64x8::of(std::f64::consts::LOG2_E)).0));
        F64x8(_mm512_scalef_pd(exp_of_rest(x, k).0, k.0))
    }
}
