//! Forces against plain sums over faces, and as derivatives of an energy.

use fpm::{Cells, Composition, Fpm, Method, Penalty};
use impactite_scene::{FullSpace, PlaneStrain, Solver, TimeControl, Watch};

use crate::common::{noise, random, rubber};

const DT: f64 = 1e-6;
const YOUNG: f64 = 1e6;

/// Return rubber after a step of random motion of the points, by up to `amount` (m).
fn stirred<const D: usize, M: Composition<D>>(
    method: M,
    cells: &Cells<D>,
    amount: f64,
    more: Option<(usize, usize, f64)>,
) -> Fpm<D, M> {
    let velocity = |x: [f64; D]| {
        let mut v = noise(x, 1.0).map(|v| v * amount / DT);
        if let Some((cell, axis, e)) = more
            && cells.points()[cell] == x
        {
            v[axis] += e / DT;
        }
        v
    };
    let mut body = Fpm::new(method, rubber(), cells, velocity).unwrap();
    body.set_watch(Watch::off());
    body.set_time_control(TimeControl::Fixed(DT)).unwrap();
    body.step_at_most(f64::INFINITY).unwrap();
    body
}

/// Solve M x = b for a symmetric positive definite matrix.
fn solve<const D: usize>(mut m: [[f64; D]; D], mut b: [f64; D]) -> [f64; D] {
    for i in 0..D {
        for k in i + 1..D {
            let factor = m[k][i] / m[i][i];
            for j in 0..D {
                m[k][j] -= factor * m[i][j];
            }
            b[k] -= factor * b[i];
        }
    }
    for i in (0..D).rev() {
        for j in i + 1..D {
            b[i] -= m[i][j] * b[j];
        }
        b[i] /= m[i][i];
    }
    b
}

/// Return forces by the formulas of the book, face by face.
fn plain<const D: usize>(cells: &Cells<D>, u: &[[f64; D]], p: &[[[f64; D]; D]], eta: f64) -> Vec<[f64; D]> {
    let (count, x) = (cells.len(), cells.points());
    let mut near = vec![Vec::new(); count];
    let mut area = vec![Vec::new(); count];
    for face in cells.faces() {
        let [a, b] = face.cells.map(|c| c as usize);
        for (i, m) in [(a, b), (b, a)] {
            near[i].push(m);
            area[i].push(face.area);
        }
    }
    // Vectors b_m of each cell.
    let weights: Vec<Vec<[f64; D]>> = (0..count)
        .map(|i| {
            let arm = |m: usize| -> [f64; D] { std::array::from_fn(|d| x[m][d] - x[i][d]) };
            let weight = |k: usize| area[i][k] / arm(near[i][k]).iter().map(|x| x * x).sum::<f64>().sqrt();
            let mut moments = [[0.0; D]; D];
            for (k, &m) in near[i].iter().enumerate() {
                let arm = arm(m);
                (0..D).for_each(|a| (0..D).for_each(|c| moments[a][c] += weight(k) * arm[a] * arm[c]));
            }
            let of = |(k, &m): (usize, &usize)| solve(moments, arm(m)).map(|b| weight(k) * b);
            near[i].iter().enumerate().map(of).collect()
        })
        .collect();
    let gradient = |i: usize, a: usize, c: usize| -> f64 {
        near[i].iter().zip(&weights[i]).map(|(&m, b)| (u[m][a] - u[i][a]) * b[c]).sum()
    };
    // Test function with a one at point j along axis d: its value at the point and its gradient in cell i.
    let mut force = vec![[0.0; D]; count];
    let mut virtual_work = |i: usize, at: Option<[f64; D]>, t: [f64; D], q: [[f64; D]; D], sign: f64| {
        for d in 0..D {
            if let Some(arm) = at {
                force[i][d] += sign * t[d];
                for (&m, b) in near[i].iter().zip(&weights[i]) {
                    let along: f64 = (0..D).map(|c| b[c] * arm[c]).sum();
                    force[m][d] += sign * t[d] * along;
                    force[i][d] -= sign * t[d] * along;
                }
            }
            for (&m, b) in near[i].iter().zip(&weights[i]) {
                let along: f64 = (0..D).map(|c| q[d][c] * b[c]).sum();
                force[m][d] += sign * along;
                force[i][d] -= sign * along;
            }
        }
    };
    for i in 0..count {
        let work = p[i].map(|row| row.map(|p| cells.volumes()[i] * p));
        virtual_work(i, None, [0.0; D], work, -1.0);
    }
    for face in cells.faces() {
        let [a, b] = face.cells.map(|c| c as usize);
        let arms = [a, b].map(|i| -> [f64; D] { std::array::from_fn(|d| face.centroid[d] - x[i][d]) });
        let apart: f64 = (0..D).map(|d| (x[b][d] - x[a][d]) * face.normal[d]).sum();
        let t: [f64; D] = std::array::from_fn(|d| {
            let mean: f64 = (0..D).map(|c| 0.5 * (p[a][d][c] + p[b][d][c]) * face.normal[c]).sum();
            let at =
                |i: usize, arm: &[f64; D]| u[i][d] + (0..D).map(|c| gradient(i, d, c) * arm[c]).sum::<f64>();
            face.area * (mean - eta / apart * (at(a, &arms[0]) - at(b, &arms[1])))
        });
        virtual_work(a, Some(arms[0]), t, [[0.0; D]; D], 1.0);
        virtual_work(b, Some(arms[1]), t, [[0.0; D]; D], -1.0);
    }
    force
}

fn follows<const D: usize, M: Composition<D>>(method: M, h: f64, eta: f64) {
    let cells = random([0.0; D], [1.0; D], h, 4);
    let body = stirred(method, &cells, 0.02 * h, None);
    let pick = |place: usize| body.numbers()[place] as usize;
    let (mut u, mut p) = (vec![[0.0; D]; cells.len()], vec![[[0.0; D]; D]; cells.len()]);
    for i in 0..cells.len() {
        (u[pick(i)], p[pick(i)]) = (body.displacements()[i], body.nominal_stresses()[i]);
    }
    let wanted = plain(&cells, &u, &p, eta * YOUNG);
    let largest = wanted.iter().flatten().fold(0.0f64, |m, f| m.max(f.abs()));
    for i in 0..cells.len() {
        for d in 0..D {
            let off = body.masses()[i] * body.accelerations()[i][d] - wanted[pick(i)][d];
            // Young's modulus of the penalty is measured by straining a point, to 1e-8.
            assert!(off.abs() < 3e-8 * largest, "{}: {off:e} of {largest:e}", body.describe());
        }
    }
}

#[test]
fn forces_are_the_plain_sums() {
    follows(Method::printed(PlaneStrain), 0.1, 5.0);
    follows(Method::symmetric(PlaneStrain).with_penalty(Penalty::new(2.0).unwrap()), 0.1, 2.0);
    follows(Method::symmetric(FullSpace), 0.25, 5.0);
    follows(Method::printed(FullSpace), 0.25, 5.0);
}

/// With the symmetric flux, force is minus the derivative of the energy.
fn derives<const D: usize, M: Composition<D>>(method: M, h: f64) {
    let cells = random([0.0; D], [1.0; D], h, 4);
    let energy = |more| {
        let body = stirred(method, &cells, 0.02 * h, more);
        body.internal_energy() + body.penalty_energy()
    };
    let there = stirred(method, &cells, 0.02 * h, None);
    let largest = (0..cells.len())
        .map(|i| there.accelerations()[i].iter().fold(0.0f64, |m, a| m.max(a.abs())) * there.masses()[i])
        .fold(0.0, f64::max);
    for (cell, axis) in [(0, 0), (5, 1), (cells.len() / 2, D - 1)] {
        let e = 1e-5 * h;
        let slope = (energy(Some((cell, axis, e))) - energy(Some((cell, axis, -e)))) / (2.0 * e);
        let place = there.numbers().iter().position(|&n| n as usize == cell).unwrap();
        let force = there.masses()[place] * there.accelerations()[place][axis];
        assert!((force + slope).abs() < 1e-6 * largest, "{force} {slope} of {largest}");
    }
}

#[test]
fn symmetric_forces_are_derivatives_of_an_energy() {
    derives(Method::symmetric(PlaneStrain), 0.15);
    derives(Method::symmetric(FullSpace), 0.3);
}

/// Momentum is conserved to rounding with both fluxes, angular momentum with the symmetric one.
#[test]
fn momentum_is_kept() {
    let cells = random([0.0; 2], [1.0; 2], 0.1, 4);
    fn turned<M: Composition<2>>(method: M, cells: &Cells<2>) -> [f64; 2] {
        let body = stirred(method, cells, 0.01, None);
        let (mut force, mut moment, mut scale) = ([0.0; 2], 0.0, 0.0);
        for i in 0..cells.len() {
            let (x, f) = (body.position(i), body.accelerations()[i].map(|a| a * body.masses()[i]));
            (0..2).for_each(|d| force[d] += f[d]);
            moment += x[0] * f[1] - x[1] * f[0];
            scale += f[0].abs() + f[1].abs();
        }
        [(force[0].abs() + force[1].abs()) / scale, moment.abs() / scale]
    }
    let [force, moment] = turned(Method::symmetric(PlaneStrain), &cells);
    assert!(force < 1e-13 && moment < 1e-12, "{force:e} {moment:e}");
    let [force, moment] = turned(Method::printed(PlaneStrain), &cells);
    assert!(force < 1e-13 && moment < 1e-3, "{force:e} {moment:e}");
}
