//! References of a floating box.
//!
//! **Depth.** A box of density r floats with r / rho of its height below the surface \[C\].
//!
//! **Heave.** Linear potential flow in the tank with the box at rest in it, no swell outside: velocity grad phi, phi = chi cos(w t) up to
//! a factor; no flux through walls, floor and sides of the box. With the heave Z of the box, half breadth b (half of the tank, by symmetry),
//! mass M of its half and lambda = w^2:
//! ```text
//! d chi / dy = (lambda / g) chi  at the surface,     d chi / dy = Z  at the lower face
//! rho g b Z = lambda (M Z + rho integral of chi over the lower face)
//! ```
//! The lowest root that is not zero is that of the heave; added mass and the waves in the tank are in it. Bilinear elements, inverse
//! iteration. The corner of the box, of 270 degrees, makes errors of the order 4/3, by which two grids are extrapolated.
//!
//! **Roll.** A square box of half the density of the liquid has the least potential energy when it floats on a corner, turned by 45 degrees:
//! its centroid is then lowest relative to that of the water it displaces \[C\]. Upright it is stable below a density of 0.2113 of that of
//! the liquid, where b^2 / (3 T) > H - T with the half breadth b, the draught T and the height H = 2 b.

use crate::setup::{EDGE, GRAVITY, Setup, TANK, WATER};

/// Turn of a square box of half the density of the liquid, degrees.
pub const ROLLED: f64 = 45.0;
/// Order of the error at a corner of 270 degrees.
const CORNER: f64 = 4.0 / 3.0;
/// Largest relative change of lambda in the last iteration.
const CONVERGED: f64 = 1e-9;

/// Period of heave by two grids, s, `cells` and half as many over half of the tank.
pub fn heave_period(setup: &Setup, cells: usize) -> f64 {
    let [coarse, fine] = [cells / 2, cells].map(|cells| Heave::new(setup, cells).period());
    let weight = 2f64.powf(CORNER);
    (weight * fine - coarse) / (weight - 1.0)
}

/// Bilinear elements in half of the tank.
struct Heave {
    /// Nodes along x, columns of elements below the box, rows of elements below it, and all rows.
    across: usize,
    covered: usize,
    below: usize,
    rows: usize,
    /// Width of an element, heights of those below and beside the box, m.
    width: f64,
    heights: [f64; 2],
    /// Half breadth of the box and mass of its half over rho, m, m^2.
    breadth: f64,
    mass: f64,
}

impl Heave {
    fn new(setup: &Setup, cells: usize) -> Self {
        let (half, breadth) = (0.5 * TANK[0], 0.5 * EDGE);
        let width = half / cells as f64;
        let [under, draught] = [setup.level() - setup.draught(), setup.draught()];
        let [below, beside] = [under, draught].map(|size| (size / width).round().max(1.0) as usize);
        Heave {
            across: cells + 1,
            covered: (breadth / width).round() as usize,
            below,
            rows: below + beside,
            width,
            heights: [under / below as f64, draught / beside as f64],
            breadth,
            mass: setup.density / WATER * EDGE * breadth,
        }
    }

    fn nodes(&self) -> usize {
        self.across * (self.rows + 1)
    }
    fn node(&self, i: usize, j: usize) -> usize {
        i + self.across * j
    }

    /// Stiffness times a potential.
    fn stiffness(&self, x: &[f64], out: &mut [f64]) {
        out.fill(0.0);
        for j in 0..self.rows {
            let aspect = self.heights[usize::from(j >= self.below)] / self.width;
            let first = if j >= self.below { self.covered } else { 0 };
            let [a, b] = [aspect / 6.0, 1.0 / (6.0 * aspect)];
            for i in first..self.across - 1 {
                let n = [self.node(i, j), self.node(i + 1, j), self.node(i, j + 1), self.node(i + 1, j + 1)];
                let [p, q, r, s] = n.map(|n| x[n]);
                // Differences along x below and above, along y left and right.
                let (low, high, left, right) = (q - p, s - r, r - p, s - q);
                let along = [a * (2.0 * low + high), a * (low + 2.0 * high)];
                let up = [b * (2.0 * left + right), b * (left + 2.0 * right)];
                out[n[0]] -= along[0] + up[0];
                out[n[1]] += along[0] - up[1];
                out[n[2]] += up[0] - along[1];
                out[n[3]] += along[1] + up[1];
            }
        }
    }

    /// Add the integral of a potential against the shape functions of a row of nodes.
    fn add_row(
        &self,
        j: usize,
        columns: std::ops::Range<usize>,
        factor: f64,
        x: &dyn Fn(usize) -> f64,
        out: &mut [f64],
    ) {
        for i in columns {
            let [a, b] = [self.node(i, j), self.node(i + 1, j)];
            let third = factor * self.width / 6.0;
            out[a] += third * (2.0 * x(a) + x(b));
            out[b] += third * (x(a) + 2.0 * x(b));
        }
    }

    /// Integral of a potential over the lower face of the box.
    fn over_face(&self, x: &[f64]) -> f64 {
        let part = |i: usize| x[self.node(i, self.below)] + x[self.node(i + 1, self.below)];
        0.5 * self.width * (0..self.covered).map(part).sum::<f64>()
    }

    /// Solve the problem with fluxes `right`, whose sum is zero, by conjugate gradients, from the potential `x`.
    fn solve(&self, right: &[f64], x: &mut [f64]) {
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let mut product = vec![0.0; x.len()];
        self.stiffness(x, &mut product);
        let mut residual: Vec<f64> = right.iter().zip(&product).map(|(b, a)| b - a).collect();
        let (mut direction, mut square) = (residual.clone(), dot(&residual, &residual));
        let allowed = 1e-22 * dot(right, right);
        for _ in 0..20 * self.across {
            if square <= allowed {
                break;
            }
            self.stiffness(&direction, &mut product);
            let step = square / dot(&direction, &product);
            for n in 0..x.len() {
                x[n] += step * direction[n];
                residual[n] -= step * product[n];
            }
            let before = std::mem::replace(&mut square, dot(&residual, &residual));
            for (d, r) in direction.iter_mut().zip(&residual) {
                *d = r + square / before * *d;
            }
        }
    }

    /// Period of the lowest mode, s.
    fn period(&self) -> f64 {
        let surface = self.covered..self.across - 1;
        let open = self.width * surface.len() as f64;
        let (mut chi, mut heave, mut lambda) = (vec![0.0; self.nodes()], 1.0, 0.0);
        loop {
            // Fluxes at the surface over lambda, of the potential without the mode of the frequency zero, which is a constant.
            let mut right = vec![0.0; chi.len()];
            self.add_row(self.rows, surface.clone(), 1.0 / GRAVITY, &|n| chi[n], &mut right);
            let sum = right.iter().sum::<f64>() + (self.mass * heave + self.over_face(&chi)) / GRAVITY;
            let shift = sum * GRAVITY / (open + self.breadth);
            chi.iter_mut().for_each(|x| *x -= shift);
            self.add_row(self.rows, surface.clone(), -shift / GRAVITY, &|_| 1.0, &mut right);
            let next = (self.mass * heave + self.over_face(&chi)) / (GRAVITY * self.breadth);
            self.add_row(self.below, 0..self.covered, next, &|_| 1.0, &mut right);
            self.solve(&right, &mut chi);
            let found = heave / next;
            chi.iter_mut().for_each(|x| *x *= found);
            heave = 1.0;
            let change = (found - lambda) / found;
            lambda = found;
            if change.abs() < CONVERGED || !change.is_finite() {
                return 2.0 * std::f64::consts::PI / lambda.sqrt();
            }
        }
    }
}
