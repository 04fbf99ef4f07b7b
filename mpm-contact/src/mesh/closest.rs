//! Closest-point projection onto an edge, a triangle or a bilinear quadrilateral.

use crate::vector::{difference, dot, length, sum, times};

type Vector = [f64; 3];

/// Threshold of weights: a smaller one is zero, and the closest point is on the opposite edge.
const NO_WEIGHT: f64 = 1e-12;
/// Maximum number of Newton steps on a quadrilateral: 3 to 5 are usual.
const STEPS: usize = 30;

/// Closest point of a facet.
#[derive(Clone, Copy, Debug)]
pub(super) struct Closest {
    /// Shape weights N_a of the nodes: they sum to one, and are exactly zero off its edge or corner.
    pub weights: [f64; 4],
    /// Position, m.
    pub at: Vector,
    /// Unit outward normal of the facet there; zero for a degenerate facet.
    pub normal: Vector,
    /// Distance, m.
    pub distance: f64,
}

/// Find the closest point of a facet with these corners: two for an edge in the plane, outside on its right; three or four in space,
/// counter-clockwise from outside.
pub(super) fn closest(x: Vector, corners: &[Vector]) -> Closest {
    match *corners {
        [a, b] => edge(x, a, b),
        [a, b, c] => triangle(x, a, b, c),
        [a, b, c, d] => quadrilateral(x, [a, b, c, d]),
        _ => unreachable!("facets have two to four nodes"),
    }
}

fn unit(v: Vector) -> Vector {
    crate::vector::unit(v).unwrap_or([0.0; 3])
}

pub(super) fn cross(a: Vector, b: Vector) -> Vector {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn at(x: Vector, mut weights: [f64; 4], corners: &[Vector], normal: Vector) -> Closest {
    if weights.iter().any(|w| *w != 0.0 && *w < NO_WEIGHT) {
        weights = weights.map(|w| if w < NO_WEIGHT { 0.0 } else { w });
        let total: f64 = weights.iter().sum();
        weights = weights.map(|w| w / total);
    }
    let mut at = [0.0; 3];
    for (corner, w) in corners.iter().zip(weights) {
        at = sum(at, times(*corner, w));
    }
    Closest { weights, at, normal, distance: length(difference(x, at)) }
}

fn edge(x: Vector, a: Vector, b: Vector) -> Closest {
    let along = difference(b, a);
    let square = dot(along, along);
    let s = if square > 0.0 { (dot(difference(x, a), along) / square).clamp(0.0, 1.0) } else { 0.0 };
    at(x, [1.0 - s, s, 0.0, 0.0], &[a, b], unit([along[1], -along[0], 0.0]))
}

/// Closest point of a triangle, by the regions of corners, edges and face \[Ericson2005\].
fn triangle(x: Vector, a: Vector, b: Vector, c: Vector) -> Closest {
    let normal = unit(cross(difference(b, a), difference(c, a)));
    at(x, weights_of_triangle(x, a, b, c), &[a, b, c], normal)
}

fn weights_of_triangle(x: Vector, a: Vector, b: Vector, c: Vector) -> [f64; 4] {
    let (ab, ac) = (difference(b, a), difference(c, a));
    let of = |from: Vector| {
        let p = difference(x, from);
        (dot(ab, p), dot(ac, p))
    };
    let ((a1, a2), (b1, b2), (c1, c2)) = (of(a), of(b), of(c));
    if a1 <= 0.0 && a2 <= 0.0 {
        return [1.0, 0.0, 0.0, 0.0];
    }
    if b1 >= 0.0 && b2 <= b1 {
        return [0.0, 1.0, 0.0, 0.0];
    }
    if c2 >= 0.0 && c1 <= c2 {
        return [0.0, 0.0, 1.0, 0.0];
    }
    let third = a1 * b2 - b1 * a2;
    if third <= 0.0 && a1 >= 0.0 && b1 <= 0.0 {
        let s = a1 / (a1 - b1);
        return [1.0 - s, s, 0.0, 0.0];
    }
    let second = c1 * a2 - a1 * c2;
    if second <= 0.0 && a2 >= 0.0 && c2 <= 0.0 {
        let s = a2 / (a2 - c2);
        return [1.0 - s, 0.0, s, 0.0];
    }
    let first = b1 * c2 - c1 * b2;
    if first <= 0.0 && b2 - b1 >= 0.0 && c1 - c2 >= 0.0 {
        let s = (b2 - b1) / ((b2 - b1) + (c1 - c2));
        return [0.0, 1.0 - s, s, 0.0];
    }
    let total = first + second + third;
    let (v, w) = (second / total, third / total);
    [1.0 - v - w, v, w, 0.0]
}

/// Closest point of the bilinear surface x(s, t) = a + b s + c t + d s t, 0 <= s, t <= 1, of the nodes' shape functions. Its edges are
/// straight, so that neighbours fit, and it is smooth within: no diagonal is chosen. Newton's method with bounds, from the closest point of
/// the two triangles, which is the solution on a parallelogram.
fn quadrilateral(x: Vector, corners: [Vector; 4]) -> Closest {
    let [p, q, r, o] = corners;
    let (b, c) = (difference(q, p), difference(o, p));
    let d = difference(difference(r, q), c);
    let place = |s: f64, t: f64| sum(sum(p, times(b, s)), sum(times(c, t), times(d, s * t)));
    let square = |s: f64, t: f64| {
        let e = difference(place(s, t), x);
        dot(e, e)
    };
    let one = weights_of_triangle(x, p, q, r);
    let two = weights_of_triangle(x, p, r, o);
    let starts = [[one[1] + one[2], one[2]], [two[1], two[1] + two[2]]];
    let squares = starts.map(|[s, t]| square(s, t));
    let near = usize::from(squares[1] < squares[0]);
    let ([mut s, mut t], mut least) = (starts[near], squares[near]);
    for _ in 0..STEPS {
        let (along, across) = (sum(b, times(d, t)), sum(c, times(d, s)));
        let e = difference(place(s, t), x);
        let slope = [dot(e, along), dot(e, across)];
        // Fix a coordinate at a bound against which the slope pushes.
        let free =
            [(s, slope[0]), (t, slope[1])].map(|(u, g)| !((u <= 0.0 && g >= 0.0) || (u >= 1.0 && g <= 0.0)));
        let (ss, tt) = (dot(along, along), dot(across, across));
        let mut st = dot(along, across) + dot(e, d);
        if ss * tt - st * st <= 1e-6 * ss * tt {
            st = dot(along, across);
        }
        let step = match free {
            [true, true] => {
                let determinant = ss * tt - st * st;
                if determinant <= 1e-12 * ss * tt {
                    break;
                }
                [(st * slope[1] - tt * slope[0]) / determinant, (st * slope[0] - ss * slope[1]) / determinant]
            }
            [true, false] if ss > 0.0 => [-slope[0] / ss, 0.0],
            [false, true] if tt > 0.0 => [0.0, -slope[1] / tt],
            _ => break,
        };
        let mut length = 1.0;
        let moved = loop {
            let to = [s + length * step[0], t + length * step[1]].map(|u: f64| u.clamp(0.0, 1.0));
            let there = square(to[0], to[1]);
            if there < least {
                let change = (to[0] - s).abs().max((to[1] - t).abs());
                ([s, t], least) = (to, there);
                break change;
            }
            length *= 0.5;
            if length < 1e-3 {
                break 0.0;
            }
        };
        if moved <= 1e-15 {
            break;
        }
    }
    let weights = [(1.0 - s) * (1.0 - t), s * (1.0 - t), s * t, (1.0 - s) * t];
    let normal = unit(cross(sum(b, times(d, t)), sum(c, times(d, s))));
    at(x, weights, &corners, normal)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Comparison with all points of a fine raster of the facet.
    #[test]
    fn no_point_of_a_facet_is_closer() {
        let mut seed = 7_u64;
        let mut random = || {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (seed >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
        };
        for _ in 0..200 {
            let base = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
            let corners = base.map(|[x, y]| [x + 0.4 * random(), y + 0.4 * random(), 0.4 * random()]);
            let x = [3.0 * random() + 0.5, 3.0 * random() + 0.5, 2.0 * random()];
            let found = closest(x, &corners);
            let three = closest(x, &corners[..3]);
            let (mut least, mut of_triangle) = (f64::INFINITY, f64::INFINITY);
            for i in 0..=60 {
                for j in 0..=60 {
                    let (s, t) = (f64::from(i) / 60.0, f64::from(j) / 60.0);
                    let place = |w: [f64; 4]| at(x, w, &corners, [0.0; 3]).distance;
                    least = least.min(place([(1.0 - s) * (1.0 - t), s * (1.0 - t), s * t, (1.0 - s) * t]));
                    if s + t <= 1.0 {
                        of_triangle = of_triangle.min(place([1.0 - s - t, s, t, 0.0]));
                    }
                }
            }
            assert!(found.distance <= least + 1e-12 && found.distance >= least - 0.05, "{corners:?} {x:?}");
            assert!(three.distance <= of_triangle + 1e-12, "{corners:?} {x:?}");
            for c in [found, three] {
                assert!((c.weights.iter().sum::<f64>() - 1.0).abs() < 1e-14);
                if c.weights[..3].iter().all(|w| *w > 0.0) && c.weights[3] > 0.0 {
                    let along = dot(difference(x, c.at), c.normal).abs();
                    assert!((along - c.distance).abs() < 1e-10, "{along} {}", c.distance);
                }
            }
        }
    }

    #[test]
    fn normals_point_out_of_the_element() {
        // The element is on the left of the edge.
        let edge = closest([0.5, -1.0, 0.0], &[[0.0; 3], [1.0, 0.0, 0.0]]);
        assert_eq!((edge.normal, edge.distance), ([0.0, -1.0, 0.0], 1.0));
        let triangle = closest([0.2, 0.2, 1.0], &[[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]);
        assert_eq!(triangle.normal, [0.0, 0.0, 1.0]);
    }
}
