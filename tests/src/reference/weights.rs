//! Shape function values and gradients of particles at nodes, and update of particle domains.

use std::collections::BTreeMap;

use mpm_core::shape::node_offset;
use mpm_core::{Boundary, Domain, ShapeFunction};
use nalgebra::DMatrix;

use super::boundaries::sign;
use super::{Image, Index, Node, Reference, Rule, Weight};

impl<const D: usize, S: ShapeFunction<f64, D>> Reference<D, S> {
    /// Compute the weights of the step from the positions and domains at its start.
    pub(super) fn weights(&mut self) {
        self.images.clear();
        self.cells.clear();
        for point in &self.points {
            self.cells.push(self.cell(&point.x));
            let mut images = vec![(point.x, [1.0; D])];
            for boundary in &self.boundaries {
                if let Boundary::Symmetry { axis, at, .. } = *boundary {
                    for i in 0..images.len() {
                        let (mut x, mut sign) = images[i];
                        x[axis] = 2.0 * at - x[axis];
                        sign[axis] = -sign[axis];
                        images.push((x, sign));
                    }
                }
            }
            let images = images
                .into_iter()
                .map(|(x, sign)| {
                    let weights = if S::DOMAIN.convects() {
                        let mirrored = |c: &[f64; D]| std::array::from_fn(|d| sign[d] * c[d]);
                        let corners: Vec<_> = point.corners.iter().map(mirrored).collect();
                        corner_weights(&self.cells(&x), &corners, self.lattice.spacing())
                    } else {
                        self.stencil(&x, &point.half)
                    };
                    Image { x, sign, weights }
                })
                .collect();
            self.images.push(images);
        }
    }

    /// Return a position in cells.
    fn cells(&self, x: &[f64; D]) -> [f64; D] {
        std::array::from_fn(|d| (x[d] - self.lattice.origin()[d]) / self.lattice.spacing())
    }

    /// Tensor products of the one-dimensional weights (20).
    fn stencil(&self, x: &[f64; D], half: &[f64; D]) -> Vec<Weight<D>> {
        let h = self.lattice.spacing();
        let mut list = vec![Weight { node: [0; D], value: 1.0, gradient: [1.0; D] }];
        for d in 0..D {
            let u = (x[d] - self.lattice.origin()[d]) / h;
            let offset = |a: usize| node_offset::<S::Extent>(a);
            // Bin centre: on a node for odd stencils, between two nodes for even ones.
            let first = offset(0);
            let lowest = (u + first + 0.5).floor();
            let xi = u - (lowest - first);
            let along = self.shape.weights(xi, half[d]);
            let mut nodes = Vec::new();
            for a in 0..<S::Extent as mpm_core::dim::Stencil>::NODES {
                let mut slope = along.slope[a];
                if self.rule == Rule::Mls {
                    let inertia: f64 = self.shape.inertia(xi, half[d]);
                    slope = along.value[a] * (offset(a) - xi) / inertia;
                }
                nodes.push((lowest as i64 + a as i64, along.value[a], slope / h));
            }
            if S::BOUNDARY_MODIFIED {
                nodes = self.without_outer_nodes(d, nodes);
            }
            let mut longer = Vec::new();
            for w in &list {
                for &(node, value, slope) in &nodes {
                    let mut w = *w;
                    w.node[d] = node;
                    w.value *= value;
                    for e in 0..D {
                        w.gradient[e] *= if e == d { slope } else { value };
                    }
                    longer.push(w);
                }
            }
            list = longer;
        }
        list
    }

    /// Apply the boundary-modified basis at walls: the node behind the wall is 2 (node on it) - (node in front).
    fn without_outer_nodes(&self, d: usize, nodes: Vec<(i64, f64, f64)>) -> Vec<(i64, f64, f64)> {
        let mut list = nodes;
        for boundary in &self.boundaries {
            let (axis, at, side) = match *boundary {
                Boundary::Fixed { axis, at, side } => (axis, at, side),
                Boundary::Wall { axis, at, side, velocity: 0.0 } => (axis, at, side),
                _ => continue,
            };
            let plane = (at - self.lattice.origin()[axis]) / self.lattice.spacing();
            if axis != d || (plane - plane.round()).abs() > 1e-6 {
                continue;
            }
            let (on, inward) = (plane.round() as i64, sign(side) as i64);
            let mut without = Vec::new();
            for (node, value, slope) in list {
                if node == on - inward {
                    without.push((on, 2.0 * value, 2.0 * slope));
                    without.push((on + inward, -value, -slope));
                } else {
                    without.push((node, value, slope));
                }
            }
            list = without;
        }
        list
    }

    /// Update particle domains of convected shape functions by nodal velocities.
    pub(super) fn stretch_domains(&mut self, dt: f64, velocity: impl Fn(&Node<D>) -> [f64; D]) {
        let h = self.lattice.spacing();
        let moved: Vec<_> = (0..self.points.len()).map(|n| self.moved_corners(n, dt, &velocity)).collect();
        for ((point, images), moved) in self.points.iter_mut().zip(&self.images).zip(moved) {
            for d in 0..D {
                let rate: f64 =
                    images[0].weights.iter().map(|w| velocity(&self.nodes[&w.node])[d] * w.gradient[d]).sum();
                point.half[d] = self.shape.stretch(point.half[d], dt * rate);
            }
            for (corner, by) in point.corners.iter_mut().zip(moved) {
                (0..D).for_each(|d| corner[d] += by[d] / h);
            }
        }
    }

    /// Displacements of the domain corners relative to the particle in a step, m: by the strain increment, or by
    /// nodal velocities interpolated at the corners.
    fn moved_corners(&self, n: usize, dt: f64, velocity: &impl Fn(&Node<D>) -> [f64; D]) -> Vec<[f64; D]> {
        let (point, weights) = (&self.points[n], &self.images[n][0].weights);
        let h = self.lattice.spacing();
        let mean = |d: usize| weights.iter().map(|w| w.value * self.nodes[&w.node].velocity[d]).sum::<f64>();
        let rate = |d: usize, e: usize| {
            weights.iter().map(|w| velocity(&self.nodes[&w.node])[d] * w.gradient[e]).sum::<f64>()
        };
        let scale = drawn_in(&point.corners);
        let moves = |corner: &[f64; D]| match S::DOMAIN {
            Domain::Corners => {
                let mut place = self.cells(&self.images[n][0].x);
                (0..D).for_each(|d| place[d] += scale * corner[d]);
                let mut by = [0.0; D];
                for (node, hat) in hats(&place) {
                    let v = self.nodes.get(&node).map_or([0.0; D], |n| n.velocity);
                    (0..D).for_each(|d| by[d] += hat * v[d]);
                }
                std::array::from_fn(|d| dt * (by[d] - mean(d)) / scale)
            }
            _ => std::array::from_fn(|d| dt * h * (0..D).map(|e| rate(d, e) * corner[e]).sum::<f64>()),
        };
        point.corners.iter().map(moves).collect()
    }
}

/// Sign of a corner along an axis: -1 or 1.
pub(super) fn side(corner: usize, axis: usize) -> f64 {
    if corner >> axis & 1 == 0 { -1.0 } else { 1.0 }
}

/// Scale factor of the corners that limits their distance to one cell along each axis.
fn drawn_in<const D: usize>(corners: &[[f64; D]]) -> f64 {
    1.0 / corners.iter().flatten().fold(1.0, |far: f64, x| far.max(x.abs()))
}

/// Nodes of the cell that contains a position, in cells, with their linear shape functions.
fn hats<const D: usize>(place: &[f64; D]) -> Vec<(Index<D>, f64)> {
    let lowest = place.map(|x| x.floor() as i64);
    let node = |c: usize| {
        let node: Index<D> = std::array::from_fn(|d| lowest[d] + (c >> d & 1) as i64);
        (node, (0..D).map(|d| 1.0 - (place[d] - node[d] as f64).abs()).product())
    };
    (0..1 << D).map(node).collect()
}

/// Weights of a domain with these corners (CPDI): mean of the linear shape functions interpolated from the corners, and mean of its
/// gradient, by Gauss quadrature with the inverse Jacobian.
fn corner_weights<const D: usize>(x: &[f64; D], corners: &[[f64; D]], h: f64) -> Vec<Weight<D>> {
    let scale = drawn_in(corners);
    let (mut volume, mut values, mut gradients) = (0.0, vec![0.0; 1 << D], vec![[0.0; D]; 1 << D]);
    for point in 0..1 << D {
        let factor = |c: usize, d: usize| 0.5 * (1.0 + side(c, d) * side(point, d) / 3f64.sqrt());
        let slope = |c: usize, k: usize| {
            0.5 * side(c, k) * (0..D).filter(|d| *d != k).map(|d| factor(c, d)).product::<f64>()
        };
        let jacobian = DMatrix::from_fn(D, D, |k, d| {
            (0..1 << D).map(|c| scale * corners[c][d] * slope(c, k)).sum::<f64>()
        });
        let measure = jacobian.determinant();
        let inverse = jacobian.try_inverse().expect("a domain that is not flat");
        volume += measure;
        for c in 0..1 << D {
            values[c] += measure * (0..D).map(|d| factor(c, d)).product::<f64>();
            for d in 0..D {
                gradients[c][d] += measure * (0..D).map(|k| inverse[(d, k)] * slope(c, k)).sum::<f64>();
            }
        }
    }
    let (mean, least) = (1.0 / values.len() as f64, values.iter().fold(0.0, |a: f64, v| a.min(v / volume)));
    let keep = if least < 0.0 { mean / (mean - least) } else { 1.0 };
    let values = values.iter().map(|v| mean + keep * (v / volume - mean));
    let mut sums: BTreeMap<Index<D>, Weight<D>> = BTreeMap::new();
    for (c, value) in values.enumerate() {
        let place = std::array::from_fn(|d| x[d] + scale * corners[c][d]);
        for (node, hat) in hats(&place) {
            let w = sums.entry(node).or_insert(Weight { node, value: 0.0, gradient: [0.0; D] });
            w.value += hat * value;
            (0..D).for_each(|d| w.gradient[d] += hat * gradients[c][d] / volume / h);
        }
    }
    sums.into_values().collect()
}
