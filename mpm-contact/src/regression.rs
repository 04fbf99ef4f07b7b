//! Normals and gaps by logistic regression.

use std::cell::RefCell;

use impactite_simd::Float;

use crate::detect::{ContactDetector, Criterion};
use crate::normal::{Memory, Nodal, NormalRule};
use crate::places::{Places, each_place};
use crate::vector::{dot, unit};

/// Plane that best separates the particles of two bodies near a node \[Nairn2020\]: its direction is the normal, and the gap is measured
/// along it between the particles' surfaces.
///
/// The plane phi . (x, 1) = 0 (x in cells from the node) minimises the convex sum_p w_p ln(1 + exp(-c_p phi . x_p)) + (k / 2) |phi|^2 sum_p
/// w_p, with c_p = -1 for the first and +1 for the second body, w_p one over the number of the body's particles and k = 1e-3, by Newton's
/// method; \[Nairn2020\] minimise squares of the difference to a sigmoid. The normals are better than gradients at edges, corners and
/// between bodies of different density. The rule visits particles one by one, and is the slowest. Surfaces are in contact within a tenth of
/// a cell (book, "Detection and normals"). [`crate::SurfaceDistance::new`] with these normals is the same detector, and its
/// [`crate::SurfaceDistance::locally`] also finds the width of a contact.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Regression;

const PENALTY: f64 = 1e-3;
const ITERATIONS: usize = 30;

/// Particle near a node: position from the node in cells, half sizes, weight; -1 or +1 for its body.
#[derive(Clone, Copy)]
struct Point {
    node: usize,
    x: [f64; 3],
    half: [f64; 3],
    weight: f64,
    class: f64,
}

thread_local! {
    /// Scratch memory for the particles near a block's nodes, kept from block to block.
    static POINTS: RefCell<Vec<Point>> = const { RefCell::new(Vec::new()) };
}

/// Call `with` with the particles of both fields near `nodes`, sorted by node, the first field's first.
fn with_points<T: Float, const D: usize, R>(
    at: &dyn Places<T, D>,
    pair: [usize; 2],
    nodes: u64,
    with: impl FnOnce(&mut [Point]) -> R,
) -> R {
    POINTS.with_borrow_mut(|points| {
        points.clear();
        let per_cell = 1.0 / at.spacing();
        for (field, class) in pair.into_iter().zip([-1.0, 1.0]) {
            let origin = at.position(0);
            at.near_points(field, nodes, &mut |nodes, near| {
                let cells = |v: [T; 3]| v.map(|c| c.to_double() * per_cell);
                for node in each_place(nodes) {
                    let place = at.position(node);
                    let mut x = cells(near.offset);
                    for d in 0..D {
                        x[d] -= (place[d] - origin[d]) * per_cell;
                    }
                    points.push(Point { node, x, half: cells(near.half), weight: 1.0, class });
                }
            });
        }
        points.sort_by_key(|p| p.node);
        with(points)
    })
}

impl<T: Float, const D: usize> NormalRule<T, D> for Regression {
    fn prepare(&self, _at: &dyn Places<T, D>, _memory: &mut Memory<'_, T>) {}

    fn normals(
        &self,
        at: &dyn Places<T, D>,
        pair: [usize; 2],
        nodes: u64,
        _memory: &Memory<'_, T>,
        normals: &mut Nodal<[T; 3]>,
    ) -> u64 {
        with_points(at, pair, nodes, |points| {
            let mut have = 0;
            for points in points.chunk_by_mut(|a, b| a.node == b.node) {
                let node = points[0].node;
                if let Some(normal) = separate::<D>(points) {
                    normals[node] = normal.map(T::of);
                    have |= 1 << node;
                }
            }
            have
        })
    }
}

impl<T: Float, const D: usize> ContactDetector<T, D> for Regression {
    type Normals = Regression;
    fn criterion(&self, _spacing: f64) -> Criterion {
        Criterion::Gap(0.0)
    }
    fn normals(&self) -> &Regression {
        self
    }
    fn touching(
        &self,
        at: &dyn Places<T, D>,
        pair: [usize; 2],
        nodes: u64,
        normals: &Nodal<[T; 3]>,
        gaps: &mut Nodal<Option<T>>,
    ) -> u64 {
        each_place(nodes).for_each(|n| gaps[n] = None);
        with_points(at, pair, nodes, |points| {
            let mut touching = 0;
            for points in points.chunk_by(|a, b| a.node == b.node) {
                let node = points[0].node;
                let n = normals[node].map(T::to_double);
                let (mut end, mut start) = (-f64::INFINITY, f64::INFINITY);
                for p in points {
                    let half = [p.half[0] * n[0], p.half[1] * n[1], p.half[2] * n[2]];
                    let (x, l) = (dot(p.x, n), dot(half, half).sqrt());
                    if p.class < 0.0 {
                        end = end.max(x + l);
                    } else {
                        start = start.min(x - l);
                    }
                }
                let gap = (start - end) * at.spacing();
                if gap.is_finite() {
                    gaps[node] = Some(T::of(gap));
                    touching |= u64::from(gap <= 0.0) << node;
                }
            }
            touching
        })
    }
}

/// Normal of the separating plane of two classes of points, towards +1; `None` if one class is missing.
fn separate<const D: usize>(points: &mut [Point]) -> Option<[f64; 3]> {
    for class in [-1.0, 1.0] {
        let of_class = |p: &&mut Point| p.class == class;
        let all: f64 = points.iter_mut().filter(of_class).map(|p| p.weight).sum();
        if all <= 0.0 {
            return None;
        }
        points.iter_mut().filter(of_class).for_each(|p| p.weight /= all);
    }
    let mut phi = [0.0; 4];
    for _ in 0..ITERATIONS {
        let mut slope = phi.map(|c| 2.0 * PENALTY * c);
        let mut matrix = [[0.0; 4]; 4];
        for (i, row) in matrix.iter_mut().enumerate() {
            row[i] = 2.0 * PENALTY;
        }
        for p in points.iter() {
            let x = [p.x[0], p.x[1], p.x[2], 1.0];
            let s: f64 = (0..4).map(|i| phi[i] * x[i]).sum();
            let miss = 1.0 / (1.0 + (p.class * s).exp());
            for i in 0..4 {
                slope[i] -= p.weight * p.class * miss * x[i];
                for j in 0..4 {
                    matrix[i][j] += p.weight * miss * (1.0 - miss) * x[i] * x[j];
                }
            }
        }
        let step = solve(matrix, slope);
        let (mut change, mut size) = (0.0_f64, 0.0_f64);
        for i in 0..4 {
            phi[i] -= step[i];
            change = change.max(step[i].abs());
            size = size.max(phi[i].abs());
        }
        if change <= 1e-12 * size {
            break;
        }
    }
    if D == 2 {
        phi[2] = 0.0;
    }
    unit([phi[0], phi[1], phi[2]])
}

/// Solve a symmetric positive definite system (Cholesky).
fn solve(mut a: [[f64; 4]; 4], mut b: [f64; 4]) -> [f64; 4] {
    for j in 0..4 {
        for k in 0..j {
            for i in j..4 {
                a[i][j] -= a[i][k] * a[j][k];
            }
        }
        let root = a[j][j].sqrt();
        for i in j..4 {
            a[i][j] /= root;
        }
    }
    for i in 0..4 {
        for k in 0..i {
            b[i] -= a[i][k] * b[k];
        }
        b[i] /= a[i][i];
    }
    for i in (0..4).rev() {
        for k in i + 1..4 {
            b[i] -= a[k][i] * b[k];
        }
        b[i] /= a[i][i];
    }
    b
}
