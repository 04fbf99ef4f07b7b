//! Triangles and tetrahedra: volume, slopes of the linear shape functions, angles, circumspheres, overlap.

use mpm_materials::Lane;

/// Corners of a simplex in `D` dimensions: only the first `D + 1` are used.
pub type Corners<const D: usize> = [[f64; D]; 4];

/// Gradients of the linear shape functions of a simplex, and its size.
#[derive(Clone, Copy, Debug)]
pub struct Slopes<L> {
    /// Gradients grad N_a, 1/m; only the first `D` of three components are used.
    pub of: [[L; 3]; 4],
    /// Signed area, m^2, or volume, m^3.
    pub measure: L,
}

impl<L: Lane> Slopes<L> {
    /// Compute the slopes of the simplex with these corners (only the first `d` components are used), `d` = 2 or 3.
    ///
    /// With x_0 the first corner and e_k = x_k - x_0, grad N_k is dual to e_k and grad N_0 is minus their sum. This is
    /// the finite-volume mean of \[Feng2014\] (4): the sum over the edges of mean velocity, normal and length, over
    /// the area, is sum_a v_a grad N_a.
    #[inline(always)]
    pub fn of(x: &[[L; 3]; 4], d: usize) -> Self {
        let zero = L::zero();
        let mut edge = [[zero; 3]; 3];
        for k in 0..d {
            for i in 0..d {
                edge[k][i] = x[k + 1][i] - x[0][i];
            }
        }
        let mut of = [[zero; 3]; 4];
        let measure;
        if d == 2 {
            let twice = edge[0][0] * edge[1][1] - edge[0][1] * edge[1][0];
            let per = twice.recip();
            of[1] = [edge[1][1] * per, -(edge[1][0] * per), zero];
            of[2] = [-(edge[0][1] * per), edge[0][0] * per, zero];
            measure = twice * L::of(0.5);
        } else {
            let faces = [cross(&edge[1], &edge[2]), cross(&edge[2], &edge[0]), cross(&edge[0], &edge[1])];
            let six = edge[0][0] * faces[0][0] + edge[0][1] * faces[0][1] + edge[0][2] * faces[0][2];
            let per = six.recip();
            for k in 0..3 {
                for i in 0..3 {
                    of[k + 1][i] = faces[k][i] * per;
                }
            }
            measure = six * L::of(1.0 / 6.0);
        }
        for k in 1..=d {
            for i in 0..d {
                of[0][i] = of[0][i] - of[k][i];
            }
        }
        Slopes { of, measure }
    }

    /// Return the steepest slope, 1/m: one over the smallest altitude.
    #[inline(always)]
    pub fn steepest(&self, d: usize) -> L {
        let mut most = L::zero();
        for a in 0..=d {
            let g = &self.of[a];
            most = most.max(g[0] * g[0] + g[1] * g[1] + g[2] * g[2]);
        }
        most.sqrt()
    }
}

#[inline(always)]
fn cross<L: Lane>(a: &[L; 3], b: &[L; 3]) -> [L; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// Return the slopes of one simplex.
pub fn slopes<const D: usize>(x: &Corners<D>) -> Slopes<f64> {
    let mut wide = [[0.0; 3]; 4];
    for a in 0..=D {
        wide[a][..D].copy_from_slice(&x[a]);
    }
    Slopes::of(&wide, D)
}

/// Signed area or volume.
pub fn measure<const D: usize>(x: &Corners<D>) -> f64 {
    let edge = |k: usize, i: usize| x[k][i] - x[0][i];
    if D == 2 {
        return 0.5 * (edge(1, 0) * edge(2, 1) - edge(1, 1) * edge(2, 0));
    }
    let e = |k: usize| [edge(k, 0), edge(k, 1), edge(k, 2)];
    let face = cross(&e(2), &e(3));
    (edge(1, 0) * face[0] + edge(1, 1) * face[1] + edge(1, 2) * face[2]) / 6.0
}

/// Volume of the simplex swept around the axis x = 0, per radian, if `hoop`, else its measure.
pub fn volume<const D: usize>(x: &Corners<D>, hoop: bool) -> f64 {
    let measure = measure(x);
    if hoop { measure * mean_radius(x) } else { measure }
}

/// Area of a facet, m^2: of the triangle of three corners; length of the edge of two, or, if `hoop`, the area that it sweeps per radian.
pub fn area<const D: usize>(x: &[[f64; D]; D], hoop: bool) -> f64 {
    let edge = |k: usize| {
        let mut edge = [0.0; 3];
        (0..D).for_each(|d| edge[d] = x[k][d] - x[0][d]);
        edge
    };
    let length = |v: [f64; 3]| v.iter().map(|c| c * c).sum::<f64>().sqrt();
    match D {
        3 => 0.5 * length(cross(&edge(1), &edge(2))),
        _ if hoop => 0.5 * (x[0][0] + x[1][0]) * length(edge(1)),
        _ => length(edge(1)),
    }
}

/// Mean of the first coordinate over the corners.
pub fn mean_radius<const D: usize>(x: &Corners<D>) -> f64 {
    x[..=D].iter().map(|c| c[0]).sum::<f64>() / (D + 1) as f64
}

/// Pairs of the corners of a triangle, then those with the fourth corner.
const PAIRS: [[usize; 2]; 6] = [[1, 0], [2, 0], [2, 1], [3, 0], [3, 1], [3, 2]];

/// Return the number of pairs of facets.
const fn pairs(d: usize) -> usize {
    if d == 2 { 3 } else { 6 }
}

/// Signed size of a simplex and its angles between facets, for comparisons without roots and divisions.
#[derive(Clone, Copy, Debug)]
pub struct Angles<const D: usize> {
    /// Signed area, m^2, or volume, m^3.
    pub measure: f64,
    /// For each pair of facets with inner normals n_a, n_b of any common scale: -(n_a . n_b) |n_a . n_b| and n_a^2 n_b^2, whose ratio is the
    /// cosine of the angle times its absolute value.
    cosines: [[f64; 2]; 6],
}

impl<const D: usize> Angles<D> {
    /// Compute the angles of the simplex with these corners.
    #[inline]
    pub fn of(x: &Corners<D>) -> Self {
        let edge = |k: usize, i: usize| x[k][i] - x[0][i];
        let mut normals = [[0.0; 3]; 4];
        let measure;
        if D == 2 {
            normals[1] = [edge(2, 1), -edge(2, 0), 0.0];
            normals[2] = [-edge(1, 1), edge(1, 0), 0.0];
            measure = 0.5 * (edge(1, 0) * edge(2, 1) - edge(1, 1) * edge(2, 0));
        } else {
            let e = |k: usize| [edge(k, 0), edge(k, 1), edge(k, 2)];
            normals[1] = cross(&e(2), &e(3));
            normals[2] = cross(&e(3), &e(1));
            normals[3] = cross(&e(1), &e(2));
            measure = dot(&e(1), &normals[1]) / 6.0;
        }
        for i in 0..D {
            normals[0][i] = -(1..=D).map(|k| normals[k][i]).sum::<f64>();
        }
        let squares = normals.map(|n| dot(&n, &n));
        let mut cosines = [[0.0; 2]; 6];
        for (cosine, &[a, b]) in cosines.iter_mut().zip(&PAIRS[..pairs(D)]) {
            let product = -dot(&normals[a], &normals[b]);
            *cosine = [product * product.abs(), squares[a] * squares[b]];
        }
        Angles { measure, cosines }
    }
    /// Cosine of the smallest angle of a simplex that has angles.
    pub fn largest_cosine(&self) -> f64 {
        let signed = self.cosines[..pairs(D)].iter().map(|[c, s]| c / s).fold(-1.0, f64::max);
        signed.abs().sqrt().copysign(signed)
    }
    /// True if no angle has a cosine above `cosine`; false for a simplex without angles.
    #[inline]
    pub fn none_above(&self, cosine: f64) -> bool {
        let signed = cosine * cosine.abs();
        self.measure != 0.0 && self.cosines[..pairs(D)].iter().all(|[c, s]| *c <= signed * s)
    }
    /// True if no angle has a cosine below `cosine`.
    #[inline]
    pub fn none_below(&self, cosine: f64) -> bool {
        let signed = cosine * cosine.abs();
        self.cosines[..pairs(D)].iter().all(|[c, s]| *c >= signed * s)
    }
}

#[inline(always)]
fn dot(a: &[f64; 3], b: &[f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Squared distance.
pub fn distance_squared<const D: usize>(a: &[f64; D], b: &[f64; D]) -> f64 {
    (0..D).map(|i| (a[i] - b[i]).powi(2)).sum()
}

/// Centre and squared radius of the circumsphere: the centre is at sum_k |e_k|^2/2 grad N_k from the first corner.
pub fn circumsphere<const D: usize>(x: &Corners<D>) -> ([f64; D], f64) {
    let Slopes { of, .. } = slopes(x);
    let mut from_first = [0.0; D];
    for k in 1..=D {
        let half = 0.5 * distance_squared(&x[k], &x[0]);
        for i in 0..D {
            from_first[i] += half * of[k][i];
        }
    }
    let squared = from_first.iter().map(|c| c * c).sum();
    let mut centre = x[0];
    for i in 0..D {
        centre[i] += from_first[i];
    }
    (centre, squared)
}

/// Shared area or volume (per radian if `hoop`) of two positively oriented simplices.
pub fn overlap<const D: usize>(a: &Corners<D>, b: &Corners<D>, hoop: bool) -> f64 {
    for i in 0..D {
        let range = |x: &Corners<D>| {
            let of = |f: fn(f64, f64) -> f64| x[1..=D].iter().fold(x[0][i], |m, c| f(m, c[i]));
            (of(f64::min), of(f64::max))
        };
        let ((low_a, high_a), (low_b, high_b)) = (range(a), range(b));
        if high_a <= low_b || high_b <= low_a {
            return 0.0;
        }
    }
    let Slopes { of, .. } = slopes(b);
    let mut pieces = vec![*a];
    let mut next = Vec::new();
    for facet in 0..=D {
        // N_facet >= 0 is the inner side; N_facet is zero at every other corner.
        let foot = &b[(facet + 1) % (D + 1)];
        for piece in &pieces {
            clip(piece, &of[facet], foot, &mut next);
        }
        std::mem::swap(&mut pieces, &mut next);
        next.clear();
    }
    pieces.iter().map(|p| volume(p, hoop).abs()).sum()
}

/// Append the part of `x` with slope . (y - foot) >= 0, as simplices.
fn clip<const D: usize>(x: &Corners<D>, slope: &[f64; 3], foot: &[f64; D], out: &mut Vec<Corners<D>>) {
    let height = |c: &[f64; D]| (0..D).map(|i| slope[i] * (c[i] - foot[i])).sum::<f64>();
    let mut kept = [0; 4];
    let mut cut = [0; 4];
    let (mut k, mut c) = (0, 0);
    for a in 0..=D {
        if height(&x[a]) >= 0.0 {
            kept[k] = a;
            k += 1;
        } else {
            cut[c] = a;
            c += 1;
        }
    }
    let crossing = |a: usize, b: usize| {
        let (inside, outside) = (height(&x[a]), height(&x[b]));
        let part = inside / (inside - outside);
        let mut p = x[a];
        for i in 0..D {
            p[i] += part * (x[b][i] - x[a][i]);
        }
        p
    };
    match (k, c) {
        (0, _) => {}
        (_, 0) => out.push(*x),
        (1, _) => {
            let mut piece = *x;
            piece[0] = x[kept[0]];
            for n in 0..c {
                piece[n + 1] = crossing(kept[0], cut[n]);
            }
            out.push(piece);
        }
        (_, 1) => {
            let mut low = [[0.0; D]; 4];
            let mut high = [[0.0; D]; 4];
            for n in 0..k {
                low[n] = x[kept[n]];
                high[n] = crossing(kept[n], cut[0]);
            }
            prism(&low, &high, out);
        }
        _ => {
            let [a, b] = [kept[0], kept[1]];
            let low = [x[a], crossing(a, cut[0]), crossing(a, cut[1]), x[a]];
            let high = [x[b], crossing(b, cut[0]), crossing(b, cut[1]), x[b]];
            prism(&low, &high, out);
        }
    }
}

/// Append a prism between two facets of `D` corners each, as `D` simplices.
fn prism<const D: usize>(low: &Corners<D>, high: &Corners<D>, out: &mut Vec<Corners<D>>) {
    for k in 0..D {
        let mut piece = [[0.0; D]; 4];
        piece[..=k].copy_from_slice(&low[..=k]);
        piece[k + 1..=D].copy_from_slice(&high[k..D]);
        out.push(piece);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const UNIT: Corners<2> = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [0.0, 0.0]];
    const TET: Corners<3> = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

    /// Cosines of the smallest and of the largest angle between facets: in two dimensions the inner angles, in three
    /// the dihedral ones. NaN for a flat simplex.
    fn angles<const D: usize>(x: &Corners<D>) -> (f64, f64) {
        let Slopes { of, .. } = slopes(x);
        let squares = of.map(|slope| dot(&slope, &slope));
        let mut cosines = [0.0; 6];
        for (cosine, &[a, b]) in cosines.iter_mut().zip(&PAIRS[..pairs(D)]) {
            *cosine = -dot(&of[a], &of[b]) / (squares[a] * squares[b]).sqrt();
        }
        let cosines = &cosines[..pairs(D)];
        if cosines.iter().any(|cosine| cosine.is_nan()) {
            return (f64::NAN, f64::NAN);
        }
        cosines
            .iter()
            .fold((-1.0, 1.0), |(small, large), &cosine| (f64::max(small, cosine), f64::min(large, cosine)))
    }

    #[test]
    fn measures_and_angles() {
        assert_eq!(measure(&UNIT), 0.5);
        assert!((measure(&TET) - 1.0 / 6.0).abs() < 1e-16);
        let (small, large) = angles(&UNIT);
        assert!((small - 0.5f64.sqrt()).abs() < 1e-15 && large.abs() < 1e-15);
        let (small, large) = angles(&TET);
        // Between the oblique facet and a coordinate plane: acos(1/sqrt 3).
        assert!((small - 1.0 / 3f64.sqrt()).abs() < 1e-15 && large.abs() < 1e-15);
        // Centroid (1/3, 1/3): the volume of revolution per radian is area times 1/3.
        assert!((volume(&UNIT, true) - 0.5 / 3.0).abs() < 1e-16);
    }

    #[test]
    fn comparisons_without_roots_agree_with_the_angles() {
        fn check<const D: usize>(seed: u64) {
            let mut random = seed;
            let mut next = || {
                random =
                    random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                (random >> 11) as f64 / (1u64 << 53) as f64 - 0.5
            };
            for _ in 0..2000 {
                let mut x = [[0.0; D]; 4];
                x[..=D].iter_mut().flatten().for_each(|c| *c = next());
                let (form, (small, large)) = (Angles::of(&x), angles(&x));
                assert!((form.measure - measure(&x)).abs() < 1e-15);
                assert!((form.largest_cosine() - small).abs() < 1e-12);
                for limit in [-0.9, -0.2, 0.0, 0.4, 0.95].map(|c: f64| c + 1e-3 * next()) {
                    assert_eq!(form.none_above(limit), small <= limit);
                    assert_eq!(form.none_below(limit), large >= limit);
                }
            }
        }
        check::<2>(1);
        check::<3>(2);
        // A flat simplex has no angles.
        assert!(!Angles::of(&[[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [0.0, 0.0]]).none_above(1.0));
    }

    #[test]
    fn the_mean_over_edges_is_the_sum_over_corners() {
        // Original form of [Feng2014] (4): velocity means on the edges times outward normals times lengths.
        let x = [[0.1, 0.2], [1.3, 0.4], [0.5, 1.1], [0.0, 0.0]];
        let v = [[0.3, -0.2], [0.7, 0.5], [-0.4, 0.9]];
        let area = measure(&x);
        let Slopes { of, .. } = slopes(&x);
        for i in 0..2 {
            for j in 0..2 {
                let mut printed = 0.0;
                for k in 0..3 {
                    let (a, b) = (k, (k + 1) % 3);
                    let along = [x[b][0] - x[a][0], x[b][1] - x[a][1]];
                    let normal_times_length = [along[1], -along[0]];
                    printed += 0.5 * (v[a][i] + v[b][i]) * normal_times_length[j] / area;
                }
                let sum: f64 = (0..3).map(|a| v[a][i] * of[a][j]).sum();
                assert!((printed - sum).abs() < 1e-14);
            }
        }
    }

    #[test]
    fn overlaps() {
        let half = |x: f64| [[x, 0.0], [x + 1.0, 0.0], [x, 1.0], [0.0; 2]];
        assert!((overlap(&UNIT, &half(0.0), false) - 0.5).abs() < 1e-15);
        assert!((overlap(&UNIT, &half(0.5), false) - 0.125).abs() < 1e-15);
        assert_eq!(overlap(&UNIT, &half(1.0), false), 0.0);
        // Triangles on different diagonals of a square share half of each.
        let other = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0; 2]];
        assert!((overlap(&UNIT, &other, false) - 0.25).abs() < 1e-15);
        assert!((overlap(&TET, &TET, false) - 1.0 / 6.0).abs() < 1e-15);
        let mut moved = TET;
        for c in &mut moved {
            c[0] += 0.5;
        }
        // The overlap is a corner tetrahedron of half the size.
        assert!((overlap(&TET, &moved, false) - 1.0 / 48.0).abs() < 1e-15);
        // Point-mirrored about the middle of an edge-to-edge line: two and two corners are cut.
        let mirrored = [[0.5, 0.5, 0.5], [-0.5, 0.5, 0.5], [0.5, 0.5, -0.5], [0.5, -0.5, 0.5]];
        assert!(measure(&mirrored) > 0.0);
        let (one, two) = (overlap(&TET, &mirrored, false), overlap(&mirrored, &TET, false));
        assert!(one > 0.0 && (one - two).abs() < 1e-15);
    }

    #[test]
    fn circumspheres() {
        let (centre, squared) = circumsphere(&UNIT);
        assert_eq!((centre, squared), ([0.5, 0.5], 0.5));
        let (centre, squared) = circumsphere(&TET);
        assert_eq!((centre, squared), ([0.5; 3], 0.75));
    }
}
