//! Element shapes: modes, gradients and volumes, on lanes.
//!
//! Nodal vectors are transformed to **modes**: the mean, the linear modes and the hourglass modes. For quadrilaterals and bricks this is
//! the fast Hadamard transform, so that a position is x = sum_m x_m phi_m(xi) with phi = 1, xi, eta, zeta, eta zeta, zeta xi, xi eta, xi
//! eta zeta; for simplices the modes are the mean and the edges from the first node. Modal forces are transformed back by the transpose.
//! Modes of bricks are multiplied by eight, which saves multiplications: [`Shape::UNIT`], [`Shape::SCALE`].

use mpm_materials::Lane;

/// Vector of each mode, or of each node.
pub(crate) type Modes<P> = [[P; 3]; 8];

/// Mean gradient over a part of an element times the volume of this part, divided by [`Shape::SCALE`].
#[derive(Clone, Copy)]
pub(crate) struct Gradient<P> {
    /// Volume times the gradient of each mode, m^2 (around an axis per radian, m^3 over m).
    pub area: Modes<P>,
    /// Volume times the contribution of each mode to u_r / r.
    pub hoop: [P; 8],
    /// Volume, m^3 (per metre of depth, or per radian); zero or negative where the element is inside out.
    pub volume: P,
}

/// Shape of a solid element.
pub(crate) trait Shape: Copy + Send + Sync + 'static {
    /// Number of dimensions.
    const DIM: usize;
    /// Number of nodes, and of modes.
    const NODES: usize;
    /// Index of the first hourglass mode.
    const FIRST: usize = Self::DIM + 1;
    /// Number of points of full integration.
    const POINTS: usize;
    /// Factor of the modes.
    const UNIT: f64 = 1.0;
    /// Factor that converts [`Gradient`]s to physical units.
    const SCALE: f64 = 1.0;
    /// Transform nodal vectors to modes.
    fn modes<P: Lane>(nodal: &Modes<P>) -> Modes<P>;
    /// Transform modal forces to nodal forces.
    fn nodal<P: Lane>(forces: &Modes<P>) -> Modes<P>;
    /// Mean gradient over the element with these modes of the positions; with `hoop` around the axis x = 0, weighted by the radius.
    fn mean<P: Lane>(x: &Modes<P>, hoop: bool) -> Gradient<P>;
    /// Gradient at a point of full integration, times the volume of the point.
    fn at<P: Lane>(x: &Modes<P>, point: usize, hoop: bool) -> Gradient<P>;
    /// Sums over nodes of products of nodal gradients, as sums over modes: vectors, hoop parts and factor of the sums.
    fn independent<P: Lane>(of: &Gradient<P>) -> (Modes<P>, [P; 8], f64);
}

/// 1/sqrt(3).
const GAUSS: f64 = 0.577_350_269_189_625_8;

// No closures with arithmetic and no array `map` below: code that the compiler does not inline is not vectorised.

/// a b - c d.
#[inline(always)]
pub(crate) fn minor<P: Lane>(a: P, b: P, c: P, d: P) -> P {
    (-c).mul_add(d, a * b)
}

#[inline(always)]
pub(crate) fn cross<P: Lane>(a: &[P; 3], b: &[P; 3]) -> [P; 3] {
    [minor(a[1], b[2], a[2], b[1]), minor(a[2], b[0], a[0], b[2]), minor(a[0], b[1], a[1], b[0])]
}

#[inline(always)]
fn times<P: Lane>(mut a: [P; 3], by: P) -> [P; 3] {
    for i in 0..3 {
        a[i] = a[i] * by;
    }
    a
}

#[inline(always)]
pub(crate) fn dot<P: Lane>(a: &[P; 3], b: &[P; 3]) -> P {
    a[0].mul_add(b[0], a[1].mul_add(b[1], a[2] * b[2]))
}

/// a x b + c x d.
#[inline(always)]
fn crosses<P: Lane>([a, b]: [&[P; 3]; 2], [c, d]: [&[P; 3]; 2]) -> [P; 3] {
    let mut sum = cross(a, b);
    for i in 0..3 {
        let (j, k) = ((i + 1) % 3, (i + 2) % 3);
        sum[i] = (-c[k]).mul_add(d[j], c[j].mul_add(d[k], sum[i]));
    }
    sum
}

/// Volume of a brick, homogeneous of degree three in its modes, from its derivatives.
#[inline(always)]
fn volume_of<P: Lane>(x: &Modes<P>, area: &Modes<P>) -> P {
    let mut sum = dot(&x[1], &area[1]);
    for m in 2..7 {
        for d in 0..3 {
            sum = x[m][d].mul_add(area[m][d], sum);
        }
    }
    sum * P::of(1.0 / 3.0)
}

#[inline(always)]
fn none<P: Lane>() -> Modes<P> {
    [[P::zero(); 3]; 8]
}

/// a + b c.
#[inline(always)]
fn plus<P: Lane>(mut a: [P; 3], b: &[P; 3], c: P) -> [P; 3] {
    for i in 0..3 {
        a[i] = b[i].mul_add(c, a[i]);
    }
    a
}

/// A triangle or tetrahedron.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Simplex<const D: usize>;

impl<const D: usize> Shape for Simplex<D> {
    const DIM: usize = D;
    const NODES: usize = D + 1;
    const POINTS: usize = 1;

    #[inline(always)]
    fn modes<P: Lane>(nodal: &Modes<P>) -> Modes<P> {
        let mut modes = none();
        for i in 0..D {
            let mut sum = nodal[0][i];
            for k in 1..=D {
                modes[k][i] = nodal[k][i] - nodal[0][i];
                sum = sum + nodal[k][i];
            }
            modes[0][i] = sum * P::of(1.0 / (D + 1) as f64);
        }
        modes
    }
    #[inline(always)]
    fn nodal<P: Lane>(forces: &Modes<P>) -> Modes<P> {
        let mut nodal = none();
        for i in 0..D {
            let share = forces[0][i] * P::of(1.0 / (D + 1) as f64);
            nodal[0][i] = share;
            for k in 1..=D {
                nodal[k][i] = share + forces[k][i];
                nodal[0][i] = nodal[0][i] - forces[k][i];
            }
        }
        nodal
    }
    #[inline(always)]
    fn mean<P: Lane>(x: &Modes<P>, hoop: bool) -> Gradient<P> {
        let mut of = Gradient { area: none(), hoop: [P::zero(); 8], volume: P::zero() };
        if D == 2 {
            let half = P::of(0.5);
            let weight = if hoop { x[0][0] * half } else { half };
            of.area[1] = [x[2][1] * weight, -(x[2][0] * weight), P::zero()];
            of.area[2] = [-(x[1][1] * weight), x[1][0] * weight, P::zero()];
            let twice = x[1][0] * x[2][1] - x[1][1] * x[2][0];
            of.volume = twice * weight;
            if hoop {
                of.hoop[0] = twice * half;
            }
        } else {
            let sixth = P::of(1.0 / 6.0);
            for k in 0..3 {
                of.area[k + 1] = times(cross(&x[(k + 1) % 3 + 1], &x[(k + 2) % 3 + 1]), sixth);
            }
            of.volume = dot(&x[1], &of.area[1]);
        }
        of
    }
    #[inline(always)]
    fn at<P: Lane>(x: &Modes<P>, _: usize, hoop: bool) -> Gradient<P> {
        Self::mean(x, hoop)
    }
    #[inline(always)]
    fn independent<P: Lane>(of: &Gradient<P>) -> (Modes<P>, [P; 8], f64) {
        let (mut vectors, mut hoop) = (of.area, [P::zero(); 8]);
        for k in 1..=D {
            for i in 0..D {
                vectors[0][i] = vectors[0][i] - of.area[k][i];
            }
        }
        for k in 0..=D {
            hoop[k] = of.hoop[0] * P::of(1.0 / (D + 1) as f64);
        }
        (vectors, hoop, 1.0)
    }
}

/// A quadrilateral.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Quad;

impl Shape for Quad {
    const DIM: usize = 2;
    const NODES: usize = 4;
    const POINTS: usize = 4;

    #[inline(always)]
    fn modes<P: Lane>(nodal: &Modes<P>) -> Modes<P> {
        let (mut modes, quarter) = (none(), P::of(0.25));
        for i in 0..2 {
            let [a, b, c, d] = [nodal[0][i], nodal[1][i], nodal[2][i], nodal[3][i]];
            let (low, high, right, left) = (b + a, c + d, b - a, c - d);
            modes[0][i] = (high + low) * quarter;
            modes[1][i] = (left + right) * quarter;
            modes[2][i] = (high - low) * quarter;
            modes[3][i] = (left - right) * quarter;
        }
        modes
    }
    #[inline(always)]
    fn nodal<P: Lane>(forces: &Modes<P>) -> Modes<P> {
        let (mut nodal, quarter) = (none(), P::of(0.25));
        for i in 0..2 {
            let [a, b] = [forces[0][i] * quarter, forces[1][i] * quarter];
            let [c, d] = [forces[2][i] * quarter, forces[3][i] * quarter];
            let (low, high, right, left) = (a - c, a + c, b - d, b + d);
            nodal[0][i] = low - right;
            nodal[1][i] = low + right;
            nodal[2][i] = high + left;
            nodal[3][i] = high - left;
        }
        nodal
    }
    /// Exact integrals of products of the bilinear positions.
    #[inline(always)]
    fn mean<P: Lane>(x: &Modes<P>, hoop: bool) -> Gradient<P> {
        let mut of = Gradient { area: none(), hoop: [P::zero(); 8], volume: P::zero() };
        let four = P::of(4.0);
        let [o, a, b, h] = [x[0], x[1], x[2], x[3]];
        let flat = a[0] * b[1] - a[1] * b[0];
        if !hoop {
            of.area[1] = [b[1] * four, -(b[0] * four), P::zero()];
            of.area[2] = [-(a[1] * four), a[0] * four, P::zero()];
            of.volume = flat * four;
            return of;
        }
        let third = P::of(4.0 / 3.0);
        let r = o[0] * four;
        of.area[1] = [r * b[1] + a[0] * h[1] * third, -(r * b[0] + a[0] * h[0] * third), P::zero()];
        of.area[2] = [-(r * a[1] + b[0] * h[1] * third), r * a[0] + b[0] * h[0] * third, P::zero()];
        let across = b[0] * b[1] - a[0] * a[1];
        of.area[3] = [across * third, (a[0] * a[0] - b[0] * b[0]) * third, P::zero()];
        // Jacobian determinant: flat + along xi + up eta.
        let along = (a[0] * h[1] - h[0] * a[1]) * third;
        let up = (h[0] * b[1] - b[0] * h[1]) * third;
        of.hoop[0] = flat * four;
        of.hoop[1] = along;
        of.hoop[2] = up;
        of.volume = r * flat + a[0] * along + b[0] * up;
        of
    }
    #[inline(always)]
    fn at<P: Lane>(x: &Modes<P>, point: usize, hoop: bool) -> Gradient<P> {
        let (xi, eta) = (sign(point, 0), sign(point, 1));
        let phi = [1.0, xi, eta, xi * eta];
        let slope = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [eta, xi]];
        let mut to = [[P::zero(); 2]; 2];
        let mut radius = x[0][0];
        for i in 0..2 {
            to[0][i] = x[3][i].mul_add(P::of(eta), x[1][i]);
            to[1][i] = x[3][i].mul_add(P::of(xi), x[2][i]);
        }
        for m in 1..4 {
            radius = x[m][0].mul_add(P::of(phi[m]), radius);
        }
        let determinant = to[0][0] * to[1][1] - to[0][1] * to[1][0];
        let weight = if hoop { radius } else { P::one() };
        let across = [[to[1][1] * weight, -(to[1][0] * weight)], [-(to[0][1] * weight), to[0][0] * weight]];
        let mut of = Gradient { area: none(), hoop: [P::zero(); 8], volume: determinant * weight };
        for m in 0..4 {
            for i in 0..2 {
                of.area[m][i] = across[0][i].mul_add(P::of(slope[m][0]), across[1][i] * P::of(slope[m][1]));
            }
            if hoop {
                of.hoop[m] = determinant * P::of(phi[m]);
            }
        }
        of
    }
    #[inline(always)]
    fn independent<P: Lane>(of: &Gradient<P>) -> (Modes<P>, [P; 8], f64) {
        (of.area, of.hoop, 0.25)
    }
}

/// Coordinate of a point of full integration along an axis.
#[inline(always)]
pub(crate) fn sign(point: usize, axis: usize) -> f64 {
    if point >> axis & 1 == 1 { GAUSS } else { -GAUSS }
}

/// Shape function of a corner of a quadrilateral or brick at xi.
pub(crate) fn weight(dim: usize, corner: usize, xi: [f64; 3]) -> f64 {
    let signs = [
        if matches!(corner % 4, 1 | 2) { 1.0 } else { -1.0 },
        if corner % 4 >= 2 { 1.0 } else { -1.0 },
        if corner >= 4 { 1.0 } else { -1.0 },
    ];
    (0..dim).map(|d| 0.5 * (1.0 + signs[d] * xi[d])).product()
}

/// A brick.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Hexa;

/// Nodes of the edges along xi.
const EDGES: [[usize; 2]; 4] = [[0, 1], [3, 2], [4, 5], [7, 6]];

impl Shape for Hexa {
    const DIM: usize = 3;
    const NODES: usize = 8;
    const POINTS: usize = 8;
    const UNIT: f64 = 8.0;
    const SCALE: f64 = 1.0 / 64.0;

    #[inline(always)]
    fn modes<P: Lane>(nodal: &Modes<P>) -> Modes<P> {
        let mut modes = none();
        for i in 0..3 {
            // Sums and differences along xi, then eta, then zeta.
            let (mut sum, mut dif) = ([P::zero(); 4], [P::zero(); 4]);
            for (k, [left, right]) in EDGES.into_iter().enumerate() {
                sum[k] = nodal[right][i] + nodal[left][i];
                dif[k] = nodal[right][i] - nodal[left][i];
            }
            let (ss, sd) = ([sum[1] + sum[0], sum[3] + sum[2]], [sum[1] - sum[0], sum[3] - sum[2]]);
            let (ds, dd) = ([dif[1] + dif[0], dif[3] + dif[2]], [dif[1] - dif[0], dif[3] - dif[2]]);
            modes[0][i] = ss[1] + ss[0];
            modes[1][i] = ds[1] + ds[0];
            modes[2][i] = sd[1] + sd[0];
            modes[3][i] = ss[1] - ss[0];
            modes[4][i] = sd[1] - sd[0];
            modes[5][i] = ds[1] - ds[0];
            modes[6][i] = dd[1] + dd[0];
            modes[7][i] = dd[1] - dd[0];
        }
        modes
    }
    #[inline(always)]
    fn nodal<P: Lane>(forces: &Modes<P>) -> Modes<P> {
        let mut nodal = none();
        for i in 0..3 {
            let f = [
                forces[0][i],
                forces[1][i],
                forces[2][i],
                forces[3][i],
                forces[4][i],
                forces[5][i],
                forces[6][i],
                forces[7][i],
            ];
            let (ss, sd) = ([f[0] - f[3], f[0] + f[3]], [f[2] - f[4], f[2] + f[4]]);
            let (ds, dd) = ([f[1] - f[5], f[1] + f[5]], [f[6] - f[7], f[6] + f[7]]);
            let sum = [ss[0] - sd[0], ss[0] + sd[0], ss[1] - sd[1], ss[1] + sd[1]];
            let dif = [ds[0] - dd[0], ds[0] + dd[0], ds[1] - dd[1], ds[1] + dd[1]];
            for (k, [left, right]) in EDGES.into_iter().enumerate() {
                nodal[left][i] = sum[k] - dif[k];
                nodal[right][i] = sum[k] + dif[k];
            }
        }
        nodal
    }
    /// Mean gradient of \[FlanaganBelytschko1981\]: derivatives of the volume V = 8 \[a.b x c - (a.e x f + b.f x d + c.d x e) / 3\] with
    /// the modes a, b, c of xi, eta, zeta and d, e, f of their products.
    #[inline(always)]
    fn mean<P: Lane>(x: &Modes<P>, _: bool) -> Gradient<P> {
        // Divide d, e, f by sqrt(3): their products then have the factor of those of a, b, c.
        let root = P::of(GAUSS);
        let [a, b, c] = [&x[1], &x[2], &x[3]];
        let (d, e, f) = (times(x[4], root), times(x[5], root), times(x[6], root));
        let back = -root;
        let mut area = none();
        area[1] = crosses([b, c], [&f, &e]);
        area[2] = crosses([c, a], [&d, &f]);
        area[3] = crosses([a, b], [&e, &d]);
        area[4] = times(crosses([b, &f], [&e, c]), back);
        area[5] = times(crosses([&f, a], [c, &d]), back);
        area[6] = times(crosses([a, &e], [&d, b]), back);
        let volume = volume_of(x, &area);
        Gradient { area, hoop: [P::zero(); 8], volume }
    }
    #[inline(always)]
    fn at<P: Lane>(x: &Modes<P>, point: usize, _: bool) -> Gradient<P> {
        let xi = [sign(point, 0), sign(point, 1), sign(point, 2)];
        let slope = [
            [0.0; 3],
            [1.0, 0.0, 0.0],
            [0.0, 1.0, 0.0],
            [0.0, 0.0, 1.0],
            [0.0, xi[2], xi[1]],
            [xi[2], 0.0, xi[0]],
            [xi[1], xi[0], 0.0],
            [xi[1] * xi[2], xi[2] * xi[0], xi[0] * xi[1]],
        ];
        let mut to = [[P::zero(); 3]; 3];
        for j in 0..3 {
            for m in 1..8 {
                if slope[m][j] != 0.0 {
                    to[j] = plus(to[j], &x[m], P::of(slope[m][j]));
                }
            }
        }
        // Each point has an eighth of the weight.
        let eighth = P::of(0.125);
        let across = [
            times(cross(&to[1], &to[2]), eighth),
            times(cross(&to[2], &to[0]), eighth),
            times(cross(&to[0], &to[1]), eighth),
        ];
        let mut area = none();
        for m in 1..8 {
            for j in 0..3 {
                if slope[m][j] != 0.0 {
                    area[m] = plus(area[m], &across[j], P::of(slope[m][j]));
                }
            }
        }
        Gradient { area, hoop: [P::zero(); 8], volume: dot(&to[0], &across[0]) }
    }
    #[inline(always)]
    fn independent<P: Lane>(of: &Gradient<P>) -> (Modes<P>, [P; 8], f64) {
        (of.area, of.hoop, 8.0)
    }
}
