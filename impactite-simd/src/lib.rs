//! Scalars, SIMD vectors and threads: execution of kernels. The only crate of the project with `unsafe`.
//!
//! Laws, weights and transfers are written once, generic over a [`Lane`]: one number, or a pack of numbers processed by
//! one instruction.
//!
//! # Vector instructions
//! A kernel is generic code over an [`Arch`]: lanes for particles, a quad for one node record, and a band for one or
//! two node records. [`Float::dispatch`] checks the processor and runs the kernel compiled for AVX-512, which processes
//! two groups of particles in double precision per pass, the one for AVX2 and FMA, or the portable one. They differ by
//! rounding.
//!
//! Each instruction set is one more compilation: [`Kernel::VECTORS`] selects those of a kernel. Debug builds and the
//! feature `one-width` leave AVX-512 out. A program compiled for one kind of processor (`-C target-cpu=native`)
//! contains only the best version for it.
//!
//! Invariant of every `unsafe` here, in `avx2` and in `avx512`: **a value of a vector type exists only inside a kernel
//! that was entered after a check that the processor has its instructions.** It is true because the types are private
//! to this module, their values are created only by methods of [`Lane`] on a type that a kernel receives as `A: Arch`,
//! and only functions of this module that checked the processor name [`Arch`] implementations.
//!
//! # Threads
//! [`Team`] runs parallel loops over blocks on a chosen number of threads. Each task owns the data that it writes, as
//! the types of the methods ensure, so that results do not depend on the number of threads. Its `unsafe` splits slices
//! among tasks, each element for one task alone, and lends the task of a loop to other threads, which leave the loop
//! before the call returns (`crew`).

#![allow(unsafe_code)]

mod aligned;
mod avx2;
mod avx512;
mod crew;
mod dual;
mod functions;
pub mod lane;
pub mod memory;
mod team;
#[cfg(test)]
mod tests;

pub use aligned::AlignedRecords;
pub use dual::Dual;
pub use lane::{Lane, Mask, Real, Wide, WideMask};
pub use team::{Team, TeamError};

/// Return the lane indices: 0, 1, 2 ...
#[inline(always)]
pub fn lane_numbers<T: Float, P: Lane<Real = T>>() -> P {
    let mut numbers = P::zero();
    for lane in 0..P::WIDTH {
        numbers = numbers.with_lane(lane, T::of(lane as f64));
    }
    numbers
}

/// Vector over particles: those of one group (one row of storage), of two groups, or one particle.
pub trait Pack<T: Float>: Lane<Real = T> {
    /// Number of groups per vector, 1 or 2.
    const GROUPS: usize = if Self::WIDTH > T::GROUP { 2 } else { 1 };
    /// Memory representation of the vector.
    type Numbers: Copy + Default + Send + AsRef<[T]>;

    /// Load from memory.
    fn load(numbers: &Self::Numbers) -> Self;
    /// Store to memory.
    fn store(self, numbers: &mut Self::Numbers);
    /// Load rows of storage: both groups, the first group, or particle `lane` of the first group.
    fn from_rows(rows: [&T::Row; 2], lane: usize) -> Self;
    /// Store to the row of `group`, or of particle `lane` in it.
    fn to_row(self, group: usize, row: &mut T::Row, lane: usize);
    /// Load adjacent rows: both groups, the group `half`, or particle `lane` in it.
    fn from_pair(pair: &RowPair<T::Row>, half: usize, lane: usize) -> Self;
    /// Store to adjacent rows.
    fn to_pair(self, pair: &mut RowPair<T::Row>, half: usize, lane: usize);
    /// Convert a mask to bits: bit `i` is set if lane `i` is.
    fn bits(mask: Self::Mask) -> u32;
    /// Transpose four columns of a group to one record per particle: `out[i]` becomes lane `i` of `a`, `b`, `c` and
    /// `d`. `out` has [`Lane::WIDTH`] records.
    fn records(a: Self, b: Self, c: Self, d: Self, out: &mut [[T; 4]]);
}

/// Adjacent rows of two groups in one cache line, loaded at once by a vector over both groups.
#[derive(Clone, Copy, Debug, Default)]
#[repr(C, align(64))]
pub struct RowPair<R>(pub [R; 2]);

/// Vector over the four numbers of a node record.
pub trait Quad<T>: Lane<Real = T> {
    /// Load a record.
    fn load(record: &[T; 4]) -> Self;
    /// Store a record.
    fn store(self, record: &mut [T; 4]);
}

/// Vector over one node record, or over two, each of its own particle.
pub trait Band<T, B: Pack<T>, Q>: Lane<Real = T>
where
    T: Float,
{
    /// Number of records per vector, 1 or 2.
    const RECORDS: usize = Self::WIDTH / 4;

    /// Load [`Band::RECORDS`] records.
    fn load(records: &[[T; 4]]) -> Self;
    /// Broadcast particle weights over the numbers of their records: the weight of lane `first`, then that of the next
    /// lane.
    fn weights(of: &B::Numbers, first: usize) -> Self;
    /// Extend a record by zeros.
    fn widen(record: Q) -> Self;
    /// Sum the records.
    fn fold(self) -> Q;
}

/// Vector types of an instruction set.
pub trait Arch<T: Float>: 'static {
    /// Vector over the particles of a group, or over one of them.
    type Pack: Pack<T>;
    /// Vector over the particles of one pass: one particle, one group or two groups.
    type Batch: Pack<T>;
    /// Vector over the numbers of a node record.
    type Quad: Quad<T>;
    /// Vector over the node records of one or two particles.
    type Band: Band<T, Self::Batch, Self::Quad>;

    /// True if larger parts of kernels are shared calls ([`apart`]), for compile time at the expense of speed.
    const APART: bool = false;

    /// Sum each of four vectors over its lanes.
    fn sums(of: [Self::Batch; 4]) -> Self::Quad;
}

/// Run a part of a kernel as a call. Kernels share its compiled code if the calling function is generic over fewer
/// types than theirs.
#[inline(never)]
pub fn apart<R>(work: impl FnOnce() -> R) -> R {
    work()
}

/// Plain Rust, one particle at a time: for x86-64 processors without AVX2. A third of the code of [`Portable`].
#[derive(Debug)]
pub struct OneByOne;

/// Plain Rust with vectors of one group, vectorised by the compiler: for processors other than x86-64.
#[derive(Debug)]
pub struct Portable;

/// Vector versions of a kernel, in addition to plain Rust.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Vectors {
    /// None, for rarely used kernels.
    Plain,
    /// AVX2 and FMA.
    Avx2,
    /// AVX2 and FMA, and AVX-512 with two groups per [`Arch::Batch`].
    Avx512,
}

/// Kernel: code compiled once for each [`Arch`]. Mark `run` and all it calls `#[inline(always)]`.
pub trait Kernel<T: Float> {
    /// Vector versions to compile.
    const VECTORS: Vectors = Vectors::Avx2;
    /// Return type.
    type Output;
    /// Run the kernel.
    fn run<A: Arch<T>>(self) -> Self::Output;
}

/// Scalar type of particle storage: `f32` or `f64`.
pub trait Float: Real {
    /// Number of lanes of a row, and of particles of a group.
    const GROUP: usize;
    /// Unit of particle storage: 32 bytes, one number of [`Float::GROUP`] particles.
    type Row: Copy + Default + Send + Sync + std::fmt::Debug + AsRef<[Self]> + AsMut<[Self]> + 'static;

    /// Run the kernel with the best instruction set of this processor.
    fn dispatch<K: Kernel<Self>>(kernel: K) -> K::Output;
    /// Run the kernel with every instruction set of this processor, plain Rust first, the reference of tests.
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

/// True if the whole program is compiled for AVX-512; `ONLY_AVX2` is true if it is for AVX2.
#[cfg(target_arch = "x86_64")]
const ONLY_AVX512: bool = cfg!(all(target_feature = "avx512dq", target_feature = "avx512vl"));
#[cfg(target_arch = "x86_64")]
const ONLY_AVX2: bool = cfg!(all(target_feature = "avx2", target_feature = "fma"));
/// True if kernels that request AVX-512 are compiled for it.
#[cfg(target_arch = "x86_64")]
const TWO_WIDTHS: bool = !cfg!(debug_assertions) && !cfg!(feature = "one-width");

/// Run the scalar version, for processors without AVX2 and rarely used kernels: `cold` reduces its compile time.
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
        // Assumption of the branches below.
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

/// Hide the origin of a reference from the compiler, so that values written to memory are read from memory. Faster for
/// single lanes of vectors, which the compiler would shuffle out of a register.
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

/// Prefetch `count` items of a slice from index `first` on into the first-level cache, for reads at once. Never faults,
/// not even outside the slice, and changes no result.
#[inline(always)]
pub fn prefetch_from<X>(of: &[X], first: usize, count: usize) {
    ask_at::<X, true>(of.as_ptr().wrapping_add(first), count);
}

/// Prefetch like [`prefetch_from`], in units of four cache lines, perhaps beyond the last item: fewer instructions for
/// a count that is unknown at compile time.
#[inline(always)]
pub fn prefetch_fours_from<X>(of: &[X], first: usize, count: usize) {
    let step = 4 * LINE / size_of::<X>();
    for four in 0..count.div_ceil(step) {
        ask_at::<X, true>(of.as_ptr().wrapping_add(first + four * step), step - 1);
    }
}

/// Prefetch like [`prefetch_from`], but into the second-level cache, for later reads: the first level has no room.
#[inline(always)]
pub fn prefetch_early_from<X>(of: &[X], first: usize, count: usize) {
    ask_at::<X, false>(of.as_ptr().wrapping_add(first), count);
}

/// Address range of some memory, for prefetching while another thread may write it: nothing is read.
#[derive(Clone, Copy, Debug, Default)]
pub struct Whereabouts {
    /// Address of the first byte.
    first: usize,
    bytes: usize,
}

impl Whereabouts {
    /// Create the address range of a slice.
    pub fn of<X>(slice: &[X]) -> Self {
        Whereabouts { first: slice.as_ptr().addr(), bytes: size_of_val(slice) }
    }
    /// Prefetch the range into the second-level cache.
    #[inline(always)]
    pub fn prefetch_early(self) {
        ask_at::<u8, false>(std::ptr::without_provenance(self.first), self.bytes);
    }
    /// Prefetch `lines` cache lines from line `first` on into the second-level cache, inside the range or not.
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
        // Include the line of the last byte, for any offset of the first byte in its line.
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
