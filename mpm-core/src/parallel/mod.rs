//! Vector instructions and threads: how a kernel is run. The only module of the project with `unsafe`.
//!
//! # Vector instructions
//! A kernel is generic text over an [`Arch`]: the pack of lanes it computes particles with and the quad it
//! adds node records with. [`Float::dispatch`] looks at the processor once and runs the kernel compiled for
//! AVX2 and FMA, or the portable one. With `--cfg impactite_avx2_only` among the compiler's flags it has the former alone, compiles
//! in about two thirds of the time, and panics on other processors: for tests. So it does where the whole program is compiled for
//! processors that have both: `-C target-cpu=native`, which is the faster way where there is AVX-512 (32 registers), and the
//! slower one where there is not (up to 18 % more instructions a kernel).
//! The invariant behind every `unsafe` here and in `lanes`:
//! **a value of a vector type exists only inside a kernel that `dispatch` entered after it saw the processor
//! has AVX2 and FMA.** It holds because the types are private to this module, their values are made only by
//! methods of [`Lane`] on a type that a kernel receives as `A: Arch`, and only `dispatch` names
//! [`Arch`] implementations.
//!
//! # Threads
//! [`Team`] runs a loop over blocks on a chosen number of threads. Each task owns what it writes (Rust checks
//! that), so results do not depend on the number of threads.

#![allow(unsafe_code)]

mod lanes;
mod team;

use mpm_materials::{Lane, Real, Wide};

pub use team::{Team, TeamError};

/// Vectors of the lanes of a group of particles: one row of storage each.
pub trait Pack<T: Float>: Lane<Real = T> {
    /// Read a row.
    fn load(row: &T::Row) -> Self;
    /// Write a row.
    fn store(self, row: &mut T::Row);
    /// Bit `i` set where lane `i` of the mask is.
    fn bits(mask: Self::Mask) -> u32;
    /// `out[i]` becomes lane `i` of `a`, `b`, `c` and `d`: from four columns of a group to one record a
    /// particle. `out` has [`Lane::WIDTH`] records.
    fn records(a: Self, b: Self, c: Self, d: Self, out: &mut [[T; 4]]);
}

/// A vector over the four numbers of a node record.
pub trait Quad<T>: Lane<Real = T> {
    /// Read a record.
    fn load(record: &[T; 4]) -> Self;
    /// Write a record.
    fn store(self, record: &mut [T; 4]);
}

/// The vector types of a kind of processor.
pub trait Arch<T: Float>: 'static {
    /// Lanes over particles.
    type Pack: Pack<T>;
    /// Lanes over the numbers of a node record.
    type Quad: Quad<T>;

    /// The sums over the lanes of four vectors.
    fn sums(of: [Self::Pack; 4]) -> Self::Quad;
}

/// Plain Rust, any processor.
#[derive(Debug)]
pub struct Portable;

/// Text compiled once for each [`Arch`]. Mark `run` and all it calls `#[inline(always)]`.
pub trait Kernel<T: Float> {
    /// What it returns.
    type Output;
    /// Run it.
    fn run<A: Arch<T>>(self) -> Self::Output;
}

/// A scalar that particles are stored in: `f32` or `f64`.
pub trait Float: Real {
    /// Lanes of a row; particles of a group.
    const GROUP: usize;
    /// The unit of particle storage: 32 bytes, one number of [`Float::GROUP`] particles.
    type Row: Copy + Default + Send + Sync + std::fmt::Debug + AsRef<[Self]> + AsMut<[Self]>;

    /// Run the kernel with the best vectors this processor has.
    fn dispatch<K: Kernel<Self>>(kernel: K) -> K::Output;
    /// Run the kernel in plain Rust: the reference that the vector kernels are tested against.
    fn portable<K: Kernel<Self>>(kernel: K) -> K::Output;
}

/// A 32-byte row of numbers.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(32))]
pub struct Row<T, const N: usize>([T; N]);

impl<T: Real, const N: usize> Default for Row<T, N> {
    fn default() -> Self {
        Row([T::default(); N])
    }
}
impl<T, const N: usize> AsRef<[T]> for Row<T, N> {
    #[inline(always)]
    fn as_ref(&self) -> &[T] {
        &self.0
    }
}
impl<T, const N: usize> AsMut<[T]> for Row<T, N> {
    #[inline(always)]
    fn as_mut(&mut self) -> &mut [T] {
        &mut self.0
    }
}

macro_rules! float {
    ($t:ty, $n:literal) => {
        impl Float for $t {
            const GROUP: usize = $n;
            type Row = Row<$t, $n>;
            #[inline]
            fn dispatch<K: Kernel<$t>>(kernel: K) -> K::Output {
                #[cfg(target_arch = "x86_64")]
                #[target_feature(enable = "avx2,fma")]
                fn with_avx2<K: Kernel<$t>>(kernel: K) -> K::Output {
                    kernel.run::<lanes::Avx2>()
                }
                #[cfg(target_arch = "x86_64")]
                if lanes::available() {
                    // SAFETY: the processor has AVX2 and FMA.
                    return unsafe { with_avx2(kernel) };
                }
                #[cfg(any(impactite_avx2_only, all(target_feature = "avx2", target_feature = "fma")))]
                panic!("compiled for AVX2 and FMA alone, which this processor lacks");
                #[cfg(not(any(impactite_avx2_only, all(target_feature = "avx2", target_feature = "fma"))))]
                kernel.run::<Portable>()
            }
            #[inline]
            fn portable<K: Kernel<$t>>(kernel: K) -> K::Output {
                kernel.run::<Portable>()
            }
        }
        impl Pack<$t> for Wide<$t, $n> {
            #[inline(always)]
            fn load(row: &Row<$t, $n>) -> Self {
                Wide(row.0)
            }
            #[inline(always)]
            fn store(self, row: &mut Row<$t, $n>) {
                row.0 = self.0;
            }
            #[inline(always)]
            fn bits(mask: Self::Mask) -> u32 {
                let mut r = 0;
                for i in 0..$n {
                    r |= u32::from(mask.0[i]) << i;
                }
                r
            }
            #[inline(always)]
            fn records(a: Self, b: Self, c: Self, d: Self, out: &mut [[$t; 4]]) {
                for i in 0..$n {
                    out[i] = [a.0[i], b.0[i], c.0[i], d.0[i]];
                }
            }
        }
        impl Quad<$t> for Wide<$t, 4> {
            #[inline(always)]
            fn load(record: &[$t; 4]) -> Self {
                Wide(*record)
            }
            #[inline(always)]
            fn store(self, record: &mut [$t; 4]) {
                *record = self.0;
            }
        }
        impl Arch<$t> for Portable {
            type Pack = Wide<$t, $n>;
            type Quad = Wide<$t, 4>;
            #[inline(always)]
            fn sums(of: [Self::Pack; 4]) -> Self::Quad {
                let mut sums = [0.0; 4];
                for i in 0..4 {
                    for x in of[i].0 {
                        sums[i] += x;
                    }
                }
                Wide(sums)
            }
        }
    };
}
float!(f64, 4);
float!(f32, 8);

/// The same reference, of which the compiler does not know that it is: what was written there is read from there. Single
/// lanes of vectors are best had so, where the compiler would shuffle each out of a register.
#[inline(always)]
pub fn through_memory<X>(of: &X) -> &X {
    #[cfg(target_arch = "x86_64")]
    {
        let mut place: *const X = of;
        // SAFETY: no instruction, so that the pointer is what it was.
        unsafe {
            std::arch::asm!("/* {0} */", inout(reg) place, options(pure, readonly, nostack, preserves_flags));
            &*place
        }
    }
    #[cfg(not(target_arch = "x86_64"))]
    of
}

/// Ask for `count` items of a slice from the place `first` on, which will be read at once. Never faults, also where there is
/// no such place, and changes no result.
#[inline(always)]
pub fn prefetch_from<X>(of: &[X], first: usize, count: usize) {
    ask_at::<X, true>(of.as_ptr().wrapping_add(first), count);
}

/// The same for what will be read after some other work, for the second cache: the first has no room for it.
#[inline(always)]
pub fn prefetch_early_from<X>(of: &[X], first: usize, count: usize) {
    ask_at::<X, false>(of.as_ptr().wrapping_add(first), count);
}

/// Where some memory lies, to be asked for while another thread may be at work in it: nothing is read.
#[derive(Clone, Copy, Debug, Default)]
pub struct Whereabouts {
    /// Address of the first byte.
    first: usize,
    bytes: usize,
}

impl Whereabouts {
    /// Of what a slice holds.
    pub fn of<X>(slice: &[X]) -> Self {
        Whereabouts { first: slice.as_ptr().addr(), bytes: size_of_val(slice) }
    }
    /// Ask for all of it, for the second cache.
    #[inline(always)]
    pub fn prefetch_early(self) {
        ask_at::<u8, false>(std::ptr::without_provenance(self.first), self.bytes);
    }
    /// The same of so many cache lines from line `first` on, whether or not they are within.
    #[inline(always)]
    pub fn prefetch_lines_early(self, first: usize, lines: usize) {
        let address = self.first + first * LINE;
        ask_at::<u8, false>(std::ptr::without_provenance(address), lines * LINE - 1);
    }
}

/// Bytes of a cache line.
pub const LINE: usize = 64;

#[inline(always)]
fn ask_at<X, const NEAR: bool>(first: *const X, count: usize) {
    #[cfg(target_arch = "x86_64")]
    {
        use std::arch::x86_64::{_MM_HINT_T0, _MM_HINT_T1, _mm_prefetch};
        let first = first.cast::<i8>();
        // Up to the line of the last byte, wherever in its line the first one lies.
        let lines = count * size_of::<X>() / LINE + 1;
        for line in 0..lines {
            // SAFETY: a prefetch reads nothing the program can see, at any address.
            unsafe {
                if NEAR {
                    _mm_prefetch::<_MM_HINT_T0>(first.wrapping_add(LINE * line));
                } else {
                    _mm_prefetch::<_MM_HINT_T1>(first.wrapping_add(LINE * line));
                }
            }
        }
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = (first, count);
}
