//! AVX2 implementation of [`Lane`]. The invariant in the parent module makes every `unsafe` here sound: each only uses
//! instructions that the running processor is known to have, on values and on memory behind references.

#![cfg(target_arch = "x86_64")]

use std::arch::x86_64::*;
use std::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Not, Sub};

use crate::lane::{Lane, Mask};

use super::functions::{exp_of_rest, ln_of_parts};
use super::{Arch, Band, Float, Kernel, Pack, Quad, Row, RowPair};

/// True if this processor has the instructions of [`Avx2`].
#[inline]
pub fn available() -> bool {
    is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma")
}

/// Processors with AVX2 and FMA.
pub struct Avx2;

/// Run a kernel on a processor with AVX2 and FMA.
#[target_feature(enable = "avx2,fma")]
pub fn with<T: Float, K: Kernel<T>>(kernel: K) -> K::Output
where
    Avx2: Arch<T>,
{
    kernel.run::<Avx2>()
}

impl Arch<f64> for Avx2 {
    type Pack = F64x4;
    type Batch = F64x4;
    type Quad = F64x4;
    type Band = F64x4;
    #[inline(always)]
    fn sums([a, b, c, d]: [F64x4; 4]) -> F64x4 {
        unsafe {
            // Pair sums of a and b in turn, and of c and d: [a01, b01, a23, b23].
            let ab = _mm256_add_pd(_mm256_unpacklo_pd(a.0, b.0), _mm256_unpackhi_pd(a.0, b.0));
            let cd = _mm256_add_pd(_mm256_unpacklo_pd(c.0, d.0), _mm256_unpackhi_pd(c.0, d.0));
            let (outer, inner) = (_mm256_blend_pd::<0b1100>(ab, cd), _mm256_permute2f128_pd::<0x21>(ab, cd));
            F64x4(_mm256_add_pd(outer, inner))
        }
    }
}
impl Arch<f32> for Avx2 {
    type Pack = F32x8;
    type Batch = F32x8;
    type Quad = F32x4;
    type Band = F32x8;
    #[inline(always)]
    fn sums([a, b, c, d]: [F32x8; 4]) -> F32x4 {
        unsafe {
            let halves = _mm256_hadd_ps(_mm256_hadd_ps(a.0, b.0), _mm256_hadd_ps(c.0, d.0));
            F32x4(_mm_add_ps(_mm256_castps256_ps128(halves), _mm256_extractf128_ps::<1>(halves)))
        }
    }
}

macro_rules! vector {
    ($name:ident, $mask:ident, $raw:ty, $t:ty, $n:literal, $add:ident, $sub:ident, $mul:ident, $div:ident,
     $fma:ident, $set:ident, $sqrt:ident, $min:ident, $max:ident, $cmp:ident $lt:ident $le:ident,
     $blend:ident, $and:ident, $or:ident, $xor:ident, $andnot:ident, $movemask:ident,
     $loadu:ident, $storeu:ident, $ln:expr, $exp:expr) => {
        #[derive(Clone, Copy, Debug)]
        #[repr(transparent)]
        pub struct $name(pub(super) $raw);
        #[derive(Clone, Copy, Debug)]
        #[repr(transparent)]
        pub struct $mask($raw);

        impl Add for $name {
            type Output = Self;
            #[inline(always)]
            fn add(self, o: Self) -> Self {
                unsafe { $name($add(self.0, o.0)) }
            }
        }
        impl Sub for $name {
            type Output = Self;
            #[inline(always)]
            fn sub(self, o: Self) -> Self {
                unsafe { $name($sub(self.0, o.0)) }
            }
        }
        impl Mul for $name {
            type Output = Self;
            #[inline(always)]
            fn mul(self, o: Self) -> Self {
                unsafe { $name($mul(self.0, o.0)) }
            }
        }
        impl Div for $name {
            type Output = Self;
            #[inline(always)]
            fn div(self, o: Self) -> Self {
                unsafe { $name($div(self.0, o.0)) }
            }
        }
        impl Neg for $name {
            type Output = Self;
            #[inline(always)]
            fn neg(self) -> Self {
                unsafe { $name($xor(self.0, $set(-0.0))) }
            }
        }
        impl BitAnd for $mask {
            type Output = Self;
            #[inline(always)]
            fn bitand(self, o: Self) -> Self {
                unsafe { $mask($and(self.0, o.0)) }
            }
        }
        impl BitOr for $mask {
            type Output = Self;
            #[inline(always)]
            fn bitor(self, o: Self) -> Self {
                unsafe { $mask($or(self.0, o.0)) }
            }
        }
        impl Not for $mask {
            type Output = Self;
            #[inline(always)]
            fn not(self) -> Self {
                let all = <Self as Mask>::splat(true);
                unsafe { $mask($xor(self.0, all.0)) }
            }
        }
        impl $mask {
            #[inline(always)]
            fn bits(self) -> u32 {
                unsafe { $movemask(self.0) as u32 }
            }
        }
        impl Mask for $mask {
            #[inline(always)]
            fn splat(truth: bool) -> Self {
                unsafe { $mask(if truth { $set(<$t>::from_bits(!0)) } else { $set(0.0) }) }
            }
            #[inline(always)]
            fn any(self) -> bool {
                self.bits() != 0
            }
            #[inline(always)]
            fn lane(self, i: usize) -> bool {
                self.bits() >> i & 1 == 1
            }
        }
        impl $name {
            #[inline(always)]
            fn to_array(self) -> [$t; $n] {
                let mut a = [0.0; $n];
                unsafe { $storeu(a.as_mut_ptr(), self.0) };
                a
            }
            #[inline(always)]
            fn from_array(a: &[$t; $n]) -> Self {
                unsafe { $name($loadu(a.as_ptr())) }
            }
        }
        impl Lane for $name {
            type Real = $t;
            type Mask = $mask;
            const WIDTH: usize = $n;
            #[inline(always)]
            fn splat(x: $t) -> Self {
                unsafe { $name($set(x)) }
            }
            #[inline(always)]
            fn lane(self, i: usize) -> $t {
                self.to_array()[i]
            }
            #[inline(always)]
            fn with_lane(self, i: usize, x: $t) -> Self {
                let mut a = self.to_array();
                a[i] = x;
                Self::from_array(&a)
            }
            #[inline(always)]
            fn mul_add(self, b: Self, c: Self) -> Self {
                unsafe { $name($fma(self.0, b.0, c.0)) }
            }
            #[inline(always)]
            fn sqrt(self) -> Self {
                unsafe { $name($sqrt(self.0)) }
            }
            #[inline(always)]
            fn ln(self) -> Self {
                $ln(self)
            }
            #[inline(always)]
            fn exp(self) -> Self {
                $exp(self)
            }
            #[inline(always)]
            fn abs(self) -> Self {
                unsafe { $name($andnot($set(-0.0), self.0)) }
            }
            #[inline(always)]
            fn min(self, o: Self) -> Self {
                // The instruction returns its second operand if one is NaN: `self`, as elsewhere.
                unsafe { $name($min(o.0, self.0)) }
            }
            #[inline(always)]
            fn max(self, o: Self) -> Self {
                unsafe { $name($max(o.0, self.0)) }
            }
            #[inline(always)]
            fn lt(self, o: Self) -> $mask {
                unsafe { $mask($cmp::<$lt>(self.0, o.0)) }
            }
            #[inline(always)]
            fn le(self, o: Self) -> $mask {
                unsafe { $mask($cmp::<$le>(self.0, o.0)) }
            }
            #[inline(always)]
            fn select(mask: $mask, yes: Self, no: Self) -> Self {
                unsafe { $name($blend(no.0, yes.0, mask.0)) }
            }
        }
    };
}

vector!(
    F64x4, M64x4, __m256d, f64, 4, _mm256_add_pd, _mm256_sub_pd, _mm256_mul_pd, _mm256_div_pd,
    _mm256_fmadd_pd, _mm256_set1_pd, _mm256_sqrt_pd, _mm256_min_pd, _mm256_max_pd,
    _mm256_cmp_pd _CMP_LT_OQ _CMP_LE_OQ, _mm256_blendv_pd, _mm256_and_pd, _mm256_or_pd, _mm256_xor_pd,
    _mm256_andnot_pd, _mm256_movemask_pd, _mm256_loadu_pd, _mm256_storeu_pd, ln_f64x4, exp_f64x4
);
vector!(
    F32x8, M32x8, __m256, f32, 8, _mm256_add_ps, _mm256_sub_ps, _mm256_mul_ps, _mm256_div_ps,
    _mm256_fmadd_ps, _mm256_set1_ps, _mm256_sqrt_ps, _mm256_min_ps, _mm256_max_ps,
    _mm256_cmp_ps _CMP_LT_OQ _CMP_LE_OQ, _mm256_blendv_ps, _mm256_and_ps, _mm256_or_ps, _mm256_xor_ps,
    _mm256_andnot_ps, _mm256_movemask_ps, _mm256_loadu_ps, _mm256_storeu_ps, ln_f32x8, exp_f32x8
);
vector!(
    F32x4, M32x4, __m128, f32, 4, _mm_add_ps, _mm_sub_ps, _mm_mul_ps, _mm_div_ps,
    _mm_fmadd_ps, _mm_set1_ps, _mm_sqrt_ps, _mm_min_ps, _mm_max_ps,
    _mm_cmp_ps _CMP_LT_OQ _CMP_LE_OQ, _mm_blendv_ps, _mm_and_ps, _mm_or_ps, _mm_xor_ps,
    _mm_andnot_ps, _mm_movemask_ps, _mm_loadu_ps, _mm_storeu_ps, each_ln, each_exp
);

macro_rules! pack {
    ($name:ident, $t:ty, $n:literal, $load:ident, $store:ident) => {
        type Numbers = Row<$t, $n>;
        #[inline(always)]
        fn from_rows([row, _]: [&Row<$t, $n>; 2], _: usize) -> Self {
            Pack::load(row)
        }
        #[inline(always)]
        fn to_row(self, _: usize, row: &mut Row<$t, $n>, _: usize) {
            Pack::store(self, row);
        }
        #[inline(always)]
        fn from_pair(pair: &RowPair<Row<$t, $n>>, half: usize, _: usize) -> Self {
            Pack::load(&pair.0[half])
        }
        #[inline(always)]
        fn to_pair(self, pair: &mut RowPair<Row<$t, $n>>, half: usize, _: usize) {
            Pack::store(self, &mut pair.0[half]);
        }
        #[inline(always)]
        fn load(row: &Row<$t, $n>) -> Self {
            // SAFETY (beyond the module's invariant): a row is 32 bytes at a multiple of 32.
            unsafe { $name($load(row.0.as_ptr())) }
        }
        #[inline(always)]
        fn store(self, row: &mut Row<$t, $n>) {
            // SAFETY: as above.
            unsafe { $store(row.0.as_mut_ptr(), self.0) }
        }
        #[inline(always)]
        fn bits(mask: Self::Mask) -> u32 {
            mask.bits()
        }
    };
}
impl Pack<f64> for F64x4 {
    pack!(F64x4, f64, 4, _mm256_load_pd, _mm256_store_pd);
    #[inline(always)]
    fn records(a: Self, b: Self, c: Self, d: Self, out: &mut [[f64; 4]]) {
        let out = &mut out[..4];
        unsafe {
            let (ab0, ab1) = (_mm256_unpacklo_pd(a.0, b.0), _mm256_unpackhi_pd(a.0, b.0));
            let (cd0, cd1) = (_mm256_unpacklo_pd(c.0, d.0), _mm256_unpackhi_pd(c.0, d.0));
            F64x4(_mm256_permute2f128_pd::<0x20>(ab0, cd0)).store_record(&mut out[0]);
            F64x4(_mm256_permute2f128_pd::<0x20>(ab1, cd1)).store_record(&mut out[1]);
            F64x4(_mm256_permute2f128_pd::<0x31>(ab0, cd0)).store_record(&mut out[2]);
            F64x4(_mm256_permute2f128_pd::<0x31>(ab1, cd1)).store_record(&mut out[3]);
        }
    }
}
impl F64x4 {
    #[inline(always)]
    fn store_record(self, record: &mut [f64; 4]) {
        unsafe { _mm256_storeu_pd(record.as_mut_ptr(), self.0) }
    }
}
impl Pack<f32> for F32x8 {
    pack!(F32x8, f32, 8, _mm256_load_ps, _mm256_store_ps);
    #[inline(always)]
    fn records(a: Self, b: Self, c: Self, d: Self, out: &mut [[f32; 4]]) {
        let out = &mut out[..8];
        unsafe {
            let (ab0, ab1) = (_mm256_unpacklo_ps(a.0, b.0), _mm256_unpackhi_ps(a.0, b.0));
            let (cd0, cd1) = (_mm256_unpacklo_ps(c.0, d.0), _mm256_unpackhi_ps(c.0, d.0));
            let quads = [
                _mm256_shuffle_ps::<0x44>(ab0, cd0),
                _mm256_shuffle_ps::<0xee>(ab0, cd0),
                _mm256_shuffle_ps::<0x44>(ab1, cd1),
                _mm256_shuffle_ps::<0xee>(ab1, cd1),
            ];
            for i in 0..4 {
                _mm_storeu_ps(out[i].as_mut_ptr(), _mm256_castps256_ps128(quads[i]));
                _mm_storeu_ps(out[i + 4].as_mut_ptr(), _mm256_extractf128_ps::<1>(quads[i]));
            }
        }
    }
}
impl Quad<f64> for F64x4 {
    #[inline(always)]
    fn load(record: &[f64; 4]) -> Self {
        Self::from_array(record)
    }
    #[inline(always)]
    fn store(self, record: &mut [f64; 4]) {
        self.store_record(record);
    }
}
impl Quad<f32> for F32x4 {
    #[inline(always)]
    fn load(record: &[f32; 4]) -> Self {
        Self::from_array(record)
    }
    #[inline(always)]
    fn store(self, record: &mut [f32; 4]) {
        unsafe { _mm_storeu_ps(record.as_mut_ptr(), self.0) }
    }
}

impl Band<f64, F64x4, F64x4> for F64x4 {
    #[inline(always)]
    fn load(records: &[[f64; 4]]) -> Self {
        Self::from_array(&records[0])
    }
    #[inline(always)]
    fn weights(of: &Row<f64, 4>, first: usize) -> Self {
        Self::splat(of.0[first])
    }
    #[inline(always)]
    fn widen(record: F64x4) -> Self {
        record
    }
    #[inline(always)]
    fn fold(self) -> F64x4 {
        self
    }
}
impl Band<f32, F32x8, F32x4> for F32x8 {
    #[inline(always)]
    fn load(records: &[[f32; 4]]) -> Self {
        let numbers = records[..2].as_flattened();
        // SAFETY (beyond the module's invariant): there are 8 numbers.
        unsafe { F32x8(_mm256_loadu_ps(numbers.as_ptr())) }
    }
    #[inline(always)]
    fn weights(of: &Row<f32, 8>, first: usize) -> Self {
        let (one, two) = (first as i32, first as i32 + 1);
        unsafe {
            let lanes = _mm256_setr_epi32(one, one, one, one, two, two, two, two);
            F32x8(_mm256_permutevar8x32_ps(<F32x8 as Pack<f32>>::load(of).0, lanes))
        }
    }
    #[inline(always)]
    fn widen(record: F32x4) -> Self {
        unsafe { F32x8(_mm256_zextps128_ps256(record.0)) }
    }
    #[inline(always)]
    fn fold(self) -> F32x4 {
        unsafe { F32x4(_mm_add_ps(_mm256_castps256_ps128(self.0), _mm256_extractf128_ps::<1>(self.0))) }
    }
}

// Node records need no transcendental functions; these complete the trait.
fn each_ln(x: F32x4) -> F32x4 {
    let mut a = x.to_array();
    for v in &mut a {
        *v = v.ln();
    }
    F32x4::from_array(&a)
}
fn each_exp(x: F32x4) -> F32x4 {
    let mut a = x.to_array();
    for v in &mut a {
        *v = v.exp();
    }
    F32x4::from_array(&a)
}

/// Natural logarithm of positive, finite, normal numbers, x = 2^e m.
#[inline(always)]
fn ln_f64x4(x: F64x4) -> F64x4 {
    const SQRT_HALF: i64 = 0x3fe6_a09e_667f_3bcd;
    unsafe {
        let bits = _mm256_castpd_si256(x.0);
        let shifted = _mm256_sub_epi64(bits, _mm256_set1_epi64x(SQRT_HALF));
        let exponent = _mm256_and_si256(shifted, _mm256_set1_epi64x(!0 << 52));
        let m = F64x4(_mm256_castsi256_pd(_mm256_sub_epi64(bits, exponent)));
        // The exponents are in the high halves of the four 64-bit lanes: gather those as 32-bit integers.
        let high = _mm256_srai_epi32::<20>(exponent);
        let packed = _mm256_permutevar8x32_epi32(high, _mm256_setr_epi32(1, 3, 5, 7, 1, 3, 5, 7));
        let e = F64x4(_mm256_cvtepi32_pd(_mm256_castsi256_si128(packed)));
        ln_of_parts(m, e)
    }
}

/// Exponential, x = k ln 2 + r, 2^k by the exponent bits. Arguments are limited to [-708, 709].
#[inline(always)]
fn exp_f64x4(x: F64x4) -> F64x4 {
    let x = x.clamp(F64x4::of(-708.0), F64x4::of(709.0));
    unsafe {
        let k = F64x4(_mm256_round_pd::<0x08>((x * F64x4::of(std::f64::consts::LOG2_E)).0));
        let p = exp_of_rest(x, k);
        let k = _mm256_cvtepi32_epi64(_mm256_cvtpd_epi32(k.0));
        let scale = _mm256_slli_epi64::<52>(_mm256_add_epi64(k, _mm256_set1_epi64x(1023)));
        p * F64x4(_mm256_castsi256_pd(scale))
    }
}

/// Natural logarithm as [`ln_f64x4`], in single precision.
#[inline(always)]
fn ln_f32x8(x: F32x8) -> F32x8 {
    const SQRT_HALF: i32 = 0x3f35_04f3;
    unsafe {
        let bits = _mm256_castps_si256(x.0);
        let shifted = _mm256_sub_epi32(bits, _mm256_set1_epi32(SQRT_HALF));
        let exponent = _mm256_and_si256(shifted, _mm256_set1_epi32(!0 << 23));
        let m = F32x8(_mm256_castsi256_ps(_mm256_sub_epi32(bits, exponent)));
        let e = F32x8(_mm256_cvtepi32_ps(_mm256_srai_epi32::<23>(exponent)));
        let s = (m - F32x8::one()) / (m + F32x8::one());
        let z = s * s;
        let mut p = F32x8::of(2.0 / 11.0);
        p = p.mul_add(z, F32x8::of(2.0 / 9.0));
        p = p.mul_add(z, F32x8::of(2.0 / 7.0));
        p = p.mul_add(z, F32x8::of(2.0 / 5.0));
        p = p.mul_add(z, F32x8::of(2.0 / 3.0));
        let ln_m = (p * z).mul_add(s, s + s);
        e.mul_add(F32x8::of(std::f64::consts::LN_2), ln_m)
    }
}

/// Exponential as [`exp_f64x4`], in single precision; arguments limited to [-87, 88].
#[inline(always)]
fn exp_f32x8(x: F32x8) -> F32x8 {
    let x = x.clamp(F32x8::of(-87.0), F32x8::of(88.0));
    unsafe {
        let k = F32x8(_mm256_round_ps::<0x08>((x * F32x8::of(std::f64::consts::LOG2_E)).0));
        let r = (-k).mul_add(F32x8::of(0.693_359_375), x);
        let r = (-k).mul_add(F32x8::of(-2.121_944_4e-4), r);
        let mut p = F32x8::of(1.0 / 5_040.0);
        p = p.mul_add(r, F32x8::of(1.0 / 720.0));
        p = p.mul_add(r, F32x8::of(1.0 / 120.0));
        p = p.mul_add(r, F32x8::of(1.0 / 24.0));
        p = p.mul_add(r, F32x8::of(1.0 / 6.0));
        p = p.mul_add(r, F32x8::of(0.5));
        p = p.mul_add(r, F32x8::one());
        p = p.mul_add(r, F32x8::one());
        let k = _mm256_cvtps_epi32(k.0);
        let scale = _mm256_slli_epi32::<23>(_mm256_add_epi32(k, _mm256_set1_epi32(127)));
        p * F32x8(_mm256_castsi256_ps(scale))
    }
}
