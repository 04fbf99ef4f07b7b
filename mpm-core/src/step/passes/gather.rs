//! Gather from the nodes of a stencil to the lanes of a group, by sum factorisation: along x, then y, then z.

use mpm_materials::Lane;

use crate::dim::{Array, Stencil};
use crate::shape::domain::{MOST_NUMBERS, Table, table};
use crate::shape::{Basis, ShapeFunction};
use impactite_simd::{Arch, Float, Quad, apart};

/// Component of a nodal vector interpolated to the particles.
#[derive(Clone, Copy)]
pub struct Gathered<P> {
    /// Value, sum_i N_i v_i.
    pub value: P,
    /// Gradient, sum_i v_i dN_i/dxi_d.
    pub slope: [P; 3],
    /// Slope of the affine fit, sum_i N_i v_i (i - xi)_d / sum_i N_i (i - xi)_d^2 (APIC).
    pub fit: [P; 3],
}

/// Sums along one axis: values, slopes and fits.
#[derive(Clone, Copy)]
struct Line<P> {
    value: P,
    slope: P,
    fit: P,
}

/// Optional outputs of a gather, in addition to the values. They are constants at every call, so that the rest is not
/// computed.
#[derive(Clone, Copy)]
pub struct Wanted {
    /// Slopes (gradient).
    pub slope: bool,
    /// Affine fits (APIC).
    pub fit: bool,
}

/// Shape functions at the particles of a group, for a gather: functions along each axis, or weights on all nodes if those
/// are not tensor products.
pub(in crate::step) struct Sampler<P: Lane, E: Stencil> {
    basis: [Basis<P, E>; 3],
    table: Table<P, E>,
}

impl<P: Lane, E: Stencil> Sampler<P, E> {
    /// Return an empty sampler, to be set before a gather.
    #[inline(always)]
    pub(in crate::step) fn zero() -> Self {
        Sampler { basis: [Basis::zero(); 3], table: Table::zero() }
    }

    /// Evaluate the shape functions at particles at `xi` with these domains; `fit` includes the terms of affine fits.
    #[inline(always)]
    pub(in crate::step) fn of<T, S, const D: usize>(
        shape: &S,
        xi: &[P; 3],
        domain: &[P; MOST_NUMBERS],
        fit: bool,
    ) -> Self
    where
        T: Float,
        P: Lane<Real = T>,
        S: ShapeFunction<T, D, Extent = E>,
    {
        let mut sampler = Self::zero();
        if S::DOMAIN.convects() {
            sampler.table = table::<T, P, S, D>(xi, domain);
            return sampler;
        }
        for d in 0..D {
            sampler.basis[d] = shape.basis(xi[d], domain[d], fit);
        }
        sampler
    }

    /// Interpolate component `c` of a nodal vector, from records in the format of [`gather`].
    #[inline(always)]
    pub(in crate::step) fn gather<T, S, const D: usize>(
        &self,
        nodes: &E::Nodes<[T; 4]>,
        c: usize,
        wanted: Wanted,
    ) -> Gathered<P>
    where
        T: Float,
        P: Lane<Real = T>,
        S: ShapeFunction<T, D, Extent = E>,
    {
        if !S::DOMAIN.convects() {
            return gather::<T, D, P, S>(nodes, &self.basis, c, wanted);
        }
        let zero = P::zero();
        let mut sum = Gathered { value: zero, slope: [zero; 3], fit: [zero; 3] };
        for node in 0..E::NODES * E::NODES * E::LAYERS {
            let number = P::splat(nodes[node][c + 1]);
            sum.value = self.table.value[node].mul_add(number, sum.value);
            for d in 0..if wanted.slope { D } else { 0 } {
                sum.slope[d] = self.table.slope[d][node].mul_add(number, sum.slope[d]);
            }
        }
        sum
    }
}

/// Sum `numbers` along an axis. In polynomial form the first two basis functions are 1 and xi, with slopes and fits 0 and
/// 1.
#[inline(always)]
fn line<P: Lane, E: Stencil>(
    numbers: &E::Axis<P>,
    basis: &Basis<P, E>,
    polynomial: bool,
    slope: bool,
    fit: bool,
) -> Line<P> {
    let (mut sum, first);
    if polynomial {
        let second = numbers[1];
        sum = Line { value: basis.value[1].mul_add(second, numbers[0]), slope: second, fit: second };
        first = 2;
    } else {
        let zeroth = numbers[0];
        sum = Line {
            value: basis.value[0] * zeroth,
            slope: basis.slope[0] * zeroth,
            fit: basis.fit[0] * zeroth,
        };
        first = 1;
    }
    for i in first..E::NODES {
        sum.value = basis.value[i].mul_add(numbers[i], sum.value);
        if slope {
            sum.slope = basis.slope[i].mul_add(numbers[i], sum.slope);
        }
        if fit {
            sum.fit = basis.fit[i].mul_add(numbers[i], sum.fit);
        }
    }
    sum
}

/// Interpolate component `c` of a nodal vector (records `[scalar, x, y, z]`, as coefficients if the shape function has a
/// polynomial form).
#[inline(always)]
pub fn gather<T: Float, const D: usize, P: Lane<Real = T>, S: ShapeFunction<T, D>>(
    nodes: &<S::Extent as Stencil>::Nodes<[T; 4]>,
    at: &[Basis<P, S::Extent>; 3],
    c: usize,
    wanted: Wanted,
) -> Gathered<P> {
    let n = <S::Extent as Stencil>::NODES;
    let Wanted { slope, fit } = wanted;
    let empty = <S::Extent as Stencil>::Axis::<P>::filled(P::zero());
    let (mut planes, mut planes_dx, mut planes_dy) = (empty, empty, empty);
    let (mut planes_fx, mut planes_fy) = (empty, empty);
    let mut last = Gathered { value: P::zero(), slope: [P::zero(); 3], fit: [P::zero(); 3] };
    for k in 0..<S::Extent as Stencil>::LAYERS {
        let (mut rows, mut rows_dx, mut rows_fx) = (empty, empty, empty);
        for j in 0..n {
            let mut numbers = empty;
            for i in 0..n {
                numbers[i] = P::splat(nodes[(k * n + j) * n + i][c + 1]);
            }
            let row = line(&numbers, &at[0], S::POLYNOMIAL, slope, fit);
            rows[j] = row.value;
            rows_dx[j] = row.slope;
            rows_fx[j] = row.fit;
        }
        let plane = line(&rows, &at[1], S::POLYNOMIAL, slope, fit);
        let (mut dx, mut fx) = (P::zero(), P::zero());
        if slope {
            dx = line(&rows_dx, &at[1], S::POLYNOMIAL, false, false).value;
        }
        if fit {
            fx = line(&rows_fx, &at[1], S::POLYNOMIAL, false, false).value;
        }
        planes[k] = plane.value;
        planes_dx[k] = dx;
        planes_dy[k] = plane.slope;
        planes_fx[k] = fx;
        planes_fy[k] = plane.fit;
        last = Gathered {
            value: plane.value,
            slope: [dx, plane.slope, P::zero()],
            fit: [fx, plane.fit, P::zero()],
        };
    }
    if D == 2 {
        return last;
    }
    let all = line(&planes, &at[2], S::POLYNOMIAL, slope, fit);
    let mut sum = Gathered { value: all.value, slope: [all.slope; 3], fit: [all.fit; 3] };
    if slope {
        sum.slope[0] = line(&planes_dx, &at[2], S::POLYNOMIAL, false, false).value;
        sum.slope[1] = line(&planes_dy, &at[2], S::POLYNOMIAL, false, false).value;
    }
    if fit {
        sum.fit[0] = line(&planes_fx, &at[2], S::POLYNOMIAL, false, false).value;
        sum.fit[1] = line(&planes_fy, &at[2], S::POLYNOMIAL, false, false).value;
    }
    sum
}

/// Convert nodal records to polynomial coefficients, axis by axis.
#[inline(always)]
pub fn to_coefficients<T: Float, const D: usize, Q: Quad<T>, S: ShapeFunction<T, D>>(
    nodes: &mut <S::Extent as Stencil>::Nodes<Q>,
) {
    let n = <S::Extent as Stencil>::NODES;
    let layers = <S::Extent as Stencil>::LAYERS;
    if n == 2 {
        // Unrolled by hand: loops that the compiler does not unroll keep their numbers in memory.
        along::<T, D, Q, S>(nodes, 0, 1);
        along::<T, D, Q, S>(nodes, 2, 1);
        if D == 3 {
            along::<T, D, Q, S>(nodes, 4, 1);
            along::<T, D, Q, S>(nodes, 6, 1);
        }
        along::<T, D, Q, S>(nodes, 0, 2);
        along::<T, D, Q, S>(nodes, 1, 2);
        if D == 3 {
            along::<T, D, Q, S>(nodes, 4, 2);
            along::<T, D, Q, S>(nodes, 5, 2);
            along::<T, D, Q, S>(nodes, 0, 4);
            along::<T, D, Q, S>(nodes, 1, 4);
            along::<T, D, Q, S>(nodes, 2, 4);
            along::<T, D, Q, S>(nodes, 3, 4);
        }
        return;
    }
    for a in 0..n {
        for k in 0..layers {
            along::<T, D, Q, S>(nodes, (k * n + a) * n, 1);
        }
    }
    for a in 0..n {
        for k in 0..layers {
            along::<T, D, Q, S>(nodes, k * n * n + a, n);
        }
    }
    if D == 3 {
        for a in 0..n * n {
            along::<T, D, Q, S>(nodes, a, n * n);
        }
    }
}

#[inline(always)]
fn along<T: Float, const D: usize, Q: Quad<T>, S: ShapeFunction<T, D>>(
    nodes: &mut <S::Extent as Stencil>::Nodes<Q>,
    first: usize,
    stride: usize,
) {
    let mut numbers = <S::Extent as Stencil>::Axis::<Q>::filled(Q::zero());
    for i in 0..<S::Extent as Stencil>::NODES {
        numbers[i] = nodes[first + i * stride];
    }
    let coefficients = S::coefficients(numbers);
    for i in 0..<S::Extent as Stencil>::NODES {
        nodes[first + i * stride] = coefficients[i];
    }
}

/// Call [`Sampler::of`].
#[inline(always)]
pub(in crate::step) fn sampler_of<T: Float, const D: usize, A: Arch<T>, S: ShapeFunction<T, D>>(
    shape: &S,
    xi: &[A::Batch; 3],
    domain: &[A::Batch; MOST_NUMBERS],
    fit: bool,
) -> Sampler<A::Batch, S::Extent> {
    if A::APART { apart(|| Sampler::of(shape, xi, domain, fit)) } else { Sampler::of(shape, xi, domain, fit) }
}

/// Call [`Sampler::gather`].
#[inline(always)]
pub(in crate::step) fn gather_on<T: Float, const D: usize, A: Arch<T>, S: ShapeFunction<T, D>>(
    sampler: &Sampler<A::Batch, S::Extent>,
    nodes: &<S::Extent as Stencil>::Nodes<[T; 4]>,
    c: usize,
    wanted: Wanted,
) -> Gathered<A::Batch> {
    if A::APART {
        return apart(|| sampler.gather::<T, S, D>(nodes, c, wanted));
    }
    sampler.gather::<T, S, D>(nodes, c, wanted)
}
