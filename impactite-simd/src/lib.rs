//! Numbers, vectors of them, and threads: how a kernel is run. The only crate of the project with `unsafe`.
//!
//! A law, a weight, a transfer is written once, generic over a [`Lane`]: one number, or a pack of numbers that one instruction
//! works on.
//!
//! # Vector instructions
//! A kernel is generic text over an [`Arch`]: the lanes it computes particles with, and the quad and the band that it adds node records
//! with, of one particle and of one or two.
//! [`Float::dispatch`] looks at the processor and runs the kernel compiled for AVX-512, where two groups of particles in double
//! precision go through a pass together, the one for AVX2 and FMA, or the portable one. They differ by rounding.
//!
//! Every kind is one more compilation: [`Kernel::VECTORS`] says which a kernel is worth. Debug builds and the
//! feature `one-width` leave AVX-512 out. Where the whole program is compiled for processors of one kind (`-C target-cpu=native`),
//! there is only the best one that those have.
//!
//! The invariant behind every `unsafe` here, in `avx2` and in `avx512`:
//! **a value of a vector type exists only inside a kernel that was entered after the processor was seen to have its
//! instructions.** It holds because the types are private to this module, their values are made only by
//! methods of [`Lane`] on a type that a kernel receives as `A: Arch`, and only functions of this module that looked at the
//! processor name [`Arch`] implementations.
//!
//! # Threads
//! [`Team`] runs a loop over blocks on a chosen number of threads. Each task owns what it writes, which the types of its methods
//! ensure, so that results do not depend on the number of threads. Its `unsafe` splits slices for tasks: each place goes to one
//! task alone; and it lends the task of a loop to other threads, which leave the loop before the call returns (`crew`).

#![allow(unsafe_code)]

mod aligned;
mod avx2;
mod avx512;
mod crew;
mod functions;
pub mod lane;
pub mod memory;
mod team;
#[cfg(test)]
mod tests;

pub use aligned::AlignedRecords;
pub use lane::{Lane, Mask, Real, Wide, WideMask};
pub use team::{Team, TeamError};

/// The numbers of its lanes: 0, 1, 2 ...
#[inline(always)]
pub fn lane_numbers<T: Float, P: Lane<Real = T>>() -> P {
    let mut numbers = P::zero();
    for lane in 0..P::WIDTH {
        numbers = numbers.with_lane(lane, T::of(lane as f64));
    }
    numbers
}

/// Vectors of lanes over particles: over those of one group, a row of storage each; over those of two groups; or one particle
/// alone.
pub trait Pack<T: Float>: Lane<Real = T> {
    /// Groups whose lanes it takes together, 1 or 2.
    const GROUPS: usize = if Self::WIDTH > T::GROUP { 2 } else { 1 };
    /// Its numbers in memory.
    type Numbers: Copy + Default + Send + AsRef<[T]>;

    /// Read numbers.
    fn load(numbers: &Self::Numbers) -> Self;
    /// Write them.
    fn store(self, numbers: &mut Self::Numbers);
    /// Read rows of storage: of its two groups, or of the first one, of which one particle has `lane`.
    fn from_rows(rows: [&T::Row; 2], lane: usize) -> Self;
    /// Write the row of one of them, likewise.
    fn to_row(self, group: usize, row: &mut T::Row, lane: usize);
    /// Read numbers that lie side by side: those of both groups, or of the `half` that is asked for.
    fn from_pair(pair: &RowPair<T::Row>, half: usize, lane: usize) -> Self;
    /// Write them.
    fn to_pair(self, pair: &mut RowPair<T::Row>, half: usize, lane: usize);
    /// Bit `i` set where lane `i` of the mask is.
    fn bits(mask: Self::Mask) -> u32;
    /// `out[i]` becomes lane `i` of `a`, `b`, `c` and `d`: from four columns of a group to one record a
    /// particle. `out` has [`Lane::WIDTH`] records.
    fn records(a: Self, b: Self, c: Self, d: Self, out: &mut [[T; 4]]);
}

/// Rows of two groups side by side, in one cache line: what a vector over both takes at once.
#[derive(Clone, Copy, Debug, Default)]
#[repr(C, align(64))]
pub struct RowPair<R>(pub [R; 2]);

/// A vector over the four numbers of a node record.
pub trait Quad<T>: Lane<Real = T> {
    /// Read a record.
    fn load(record: &[T; 4]) -> Self;
    /// Write a record.
    fn store(self, record: &mut [T; 4]);
}

/// A vector over the numbers of node records: of one particle's, or of those of two particles.
pub trait Band<T, B: Pack<T>, Q>: Lane<Real = T>
where
    T: Float,
{
    /// Records it takes together, 1 or 2.
    const RECORDS: usize = Self::WIDTH / 4;

    /// Read so many records.
    fn load(records: &[[T; 4]]) -> Self;
    /// For all numbers of a record what its particle weighs: that of lane `first`, and the next one's.
    fn weights(of: &B::Numbers, first: usize) -> Self;
    /// A record, and zeros.
    fn widen(record: Q) -> Self;
    /// The sum of the records.
    fn fold(self) -> Q;
}

/// The vector types of a kind of processor.
pub trait Arch<T: Float>: 'static {
    /// Lanes over the particles of a group, or one of them.
    type Pack: Pack<T>;
    /// Lanes over the particles that go through a pass together: one, those of a group or of two.
    type Batch: Pack<T>;
    /// Lanes over the numbers of a node record.
    type Quad: Quad<T>;
    /// Lanes over the numbers of the records of one particle or of two.
    type Band: Band<T, Self::Batch, Self::Quad>;

    /// Are larger pieces of kernels calls ([`apart`]), so that all kernels share them? Where compile time counts for more than speed.
    const APART: bool = false;

    /// The sums over the lanes of four vectors.
    fn sums(of: [Self::Batch; 4]) -> Self::Quad;
}

/// A piece of a kernel as a call: one for all kernels that do the same work, if this is called in a function of fewer types than
/// theirs.
#[inline(never)]
pub fn apart<R>(work: impl FnOnce() -> R) -> R {
    work()
}

/// Plain Rust, one particle after the other: for x86-64 processors without AVX2. A third of the text that vectors of plain
/// Rust are.
#[derive(Debug)]
pub struct OneByOne;

/// Plain Rust, in vectors of a group, of which compilers make what the processor has: for processors other than x86-64.
#[derive(Debug)]
pub struct Portable;

/// Which copies of a kernel are worth their compile time, beside the one in plain Rust.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Vectors {
    /// None: what is done rarely.
    Plain,
    /// One, for AVX2 and FMA.
    Avx2,
    /// Also one for AVX-512, which takes two groups of an [`Arch::Batch`] at once.
    Avx512,
}

/// Text compiled once for each [`Arch`]. Mark `run` and all it calls `#[inline(always)]`.
pub trait Kernel<T: Float> {
    /// Which copies it is worth.
    const VECTORS: Vectors = Vectors::Avx2;
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
    type Row: Copy + Default + Send + Sync + std::fmt::Debug + AsRef<[Self]> + AsMut<[Self]> + 'static;

    /// Run the kernel with the best vectors this processor has.
    fn dispatch<K: Kernel<Self>>(kernel: K) -> K::Output;
    /// Run it with every kind of vectors that this processor has, plain Rust first: the reference that others are tested
    /// against.
    fn each<K: Kernel<Self>>(kernel: impl Fn() -> K) -> Vec<K::Output>;
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
    ($t:ty, $n:literal, $dispatch:path, $($vectors:ident),+) => {
        impl Float for $t {
            const GROUP: usize = $n;
            type Row = Row<$t, $n>;
            #[inline]
            fn dispatch<K: Kernel<$t>>(kernel: K) -> K::Output {
                $dispatch(kernel)
            }
            fn each<K: Kernel<$t>>(kernel: impl Fn() -> K) -> Vec<K::Output> {
                let mut found = vec![kernel().run::<OneByOne>(), kernel().run::<Portable>()];
                #[cfg(target_arch = "x86_64")]
                {
                    // SAFETY: they run where the processor has what they ask for.
                    unsafe {
                        $(if $vectors::available() {
                            found.push($vectors::with(kernel()));
                        })+
                    }
                }
                found
            }
        }
        impl Pack<$t> for Wide<$t, $n> {
            type Numbers = Row<$t, $n>;
            #[inline(always)]
            fn load(row: &Row<$t, $n>) -> Self {
                Wide(row.0)
            }
            #[inline(always)]
            fn store(self, row: &mut Row<$t, $n>) {
                row.0 = self.0;
            }
            #[inline(always)]
            fn from_rows([row, _]: [&Row<$t, $n>; 2], _: usize) -> Self {
                Wide(row.0)
            }
            #[inline(always)]
            fn to_row(self, _: usize, row: &mut Row<$t, $n>, _: usize) {
                row.0 = self.0;
            }
            #[inline(always)]
            fn from_pair(pair: &RowPair<Row<$t, $n>>, half: usize, _: usize) -> Self {
                Wide(pair.0[half].0)
            }
            #[inline(always)]
            fn to_pair(self, pair: &mut RowPair<Row<$t, $n>>, half: usize, _: usize) {
                pair.0[half].0 = self.0;
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
        impl Pack<$t> for $t {
            type Numbers = [$t; 1];
            #[inline(always)]
            fn load(numbers: &[$t; 1]) -> Self {
                numbers[0]
            }
            #[inline(always)]
            fn store(self, numbers: &mut [$t; 1]) {
                numbers[0] = self;
            }
            #[inline(always)]
            fn from_rows([row, _]: [&Row<$t, $n>; 2], lane: usize) -> Self {
                row.0[lane]
            }
            #[inline(always)]
            fn to_row(self, _: usize, row: &mut Row<$t, $n>, lane: usize) {
                row.0[lane] = self;
            }
            #[inline(always)]
            fn from_pair(pair: &RowPair<Row<$t, $n>>, half: usize, lane: usize) -> Self {
                pair.0[half].0[lane]
            }
            #[inline(always)]
            fn to_pair(self, pair: &mut RowPair<Row<$t, $n>>, half: usize, lane: usize) {
                pair.0[half].0[lane] = self;
            }
            #[inline(always)]
            fn bits(mask: bool) -> u32 {
                mask.into()
            }
            #[inline(always)]
            fn records(a: Self, b: Self, c: Self, d: Self, out: &mut [[$t; 4]]) {
                out[0] = [a, b, c, d];
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
        float!(band $t, Wide<$t, $n>);
        float!(band $t, $t);
        float!(plain $t, Portable, Wide<$t, $n>, false);
        float!(plain $t, OneByOne, $t, true);
    };
    (band $t:ty, $pack:ty) => {
        impl Band<$t, $pack, Self> for Wide<$t, 4> {
            #[inline(always)]
            fn load(records: &[[$t; 4]]) -> Self {
                Wide(records[0])
            }
            #[inline(always)]
            fn weights(of: &<$pack as Pack<$t>>::Numbers, first: usize) -> Self {
                Wide([of.as_ref()[first]; 4])
            }
            #[inline(always)]
            fn widen(record: Self) -> Self {
                record
            }
            #[inline(always)]
            fn fold(self) -> Self {
                self
            }
        }
    };
    (plain $t:ty, $arch:ty, $pack:ty, $apart:literal) => {
        impl Arch<$t> for $arch {
            const APART: bool = $apart;
            type Pack = $pack;
            type Batch = $pack;
            type Quad = Wide<$t, 4>;
            type Band = Wide<$t, 4>;
            #[inline(always)]
            fn sums(of: [Self::Batch; 4]) -> Self::Quad {
                let mut sums = [0.0; 4];
                for i in 0..4 {
                    for lane in 0..<$pack as Lane>::WIDTH {
                        sums[i] += of[i].lane(lane);
                    }
                }
                Wide(sums)
            }
        }
    };
}
float!(f64, 4, dispatch_double, avx2, avx512);
float!(f32, 8, dispatch_single, avx2);

/// Was the program compiled for AVX-512, or for AVX2, alone?
#[cfg(target_arch = "x86_64")]
const ONLY_AVX512: bool = cfg!(all(target_feature = "avx512dq", target_feature = "avx512vl"));
#[cfg(target_arch = "x86_64")]
const ONLY_AVX2: bool = cfg!(all(target_feature = "avx2", target_feature = "fma"));
/// Are kernels compiled for AVX-512 where that is worth it?
#[cfg(target_arch = "x86_64")]
const TWO_WIDTHS: bool = !cfg!(debug_assertions) && !cfg!(feature = "one-width");

/// The copy for processors without AVX2, and of what is done rarely: told to the compiler as such, which then hurries.
#[cfg(target_arch = "x86_64")]
#[cold]
#[inline(never)]
fn one_by_one<T: Float, K: Kernel<T>>(kernel: K) -> K::Output
where
    OneByOne: Arch<T>,
{
    kernel.run::<OneByOne>()
}

#[cfg(target_arch = "x86_64")]
#[inline]
fn dispatch_double<K: Kernel<f64>>(kernel: K) -> K::Output {
    const {
        // What the branches below leave to compile.
        assert!(!ONLY_AVX512 || ONLY_AVX2, "AVX-512 comes with AVX2");
    }
    if const { !cfg!(debug_assertions) && (ONLY_AVX512 || (TWO_WIDTHS && matches!(K::VECTORS, Vectors::Avx512))) }
        && avx512::available()
    {
        // SAFETY: the processor has what that asks for.
        return unsafe { avx512::with(kernel) };
    }
    if const { ONLY_AVX2 || !matches!(K::VECTORS, Vectors::Plain) } && avx2::available() {
        // SAFETY: likewise.
        return unsafe { avx2::with(kernel) };
    }
    one_by_one(kernel)
}

#[cfg(target_arch = "x86_64")]
#[inline]
fn dispatch_single<K: Kernel<f32>>(kernel: K) -> K::Output {
    if const { ONLY_AVX2 || !matches!(K::VECTORS, Vectors::Plain) } && avx2::available() {
        // SAFETY: the processor has what that asks for.
        return unsafe { avx2::with(kernel) };
    }
    one_by_one(kernel)
}

#[cfg(not(target_arch = "x86_64"))]
#[inline]
fn dispatch_double<K: Kernel<f64>>(kernel: K) -> K::Output {
    kernel.run::<Portable>()
}

#[cfg(not(target_arch = "x86_64"))]
#[inline]
fn dispatch_single<K: Kernel<f32>>(kernel: K) -> K::Output {
    kernel.run::<Portable>()
}

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

/// The same by four cache lines at once, some behind the last one asked for, maybe: in fewer instructions, where the count is not known
/// when compiling.
#[inline(always)]
pub fn prefetch_fours_from<X>(of: &[X], first: usize, count: usize) {
    let step = 4 * LINE / size_of::<X>();
    for four in 0..count.div_ceil(step) {
        ask_at::<X, true>(of.as_ptr().wrapping_add(first + four * step), step - 1);
    }
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
        if lines > 0 {
            ask_at::<u8, false>(std::ptr::without_provenance(address), lines * LINE - 1);
        }
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
