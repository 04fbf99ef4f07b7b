//! Exact solutions: eigenvectors of the discrete operator, and manufactured solutions with an order of convergence.

use std::f64::consts::PI;
use std::sync::Arc;

use impactite_simd::Team;
use impactite_solve::{CellBlocks, Multigrid, Operator, Stencil, Stop, conjugate_gradients};

use crate::domains;

fn solve<const D: usize>(stencil: &Stencil<D>, b: &[f64], relative: f64) -> Vec<f64> {
    let team = Team::ambient();
    let mut x = vec![0.0; b.len()];
    let mut multigrid = Multigrid::new(&team, stencil);
    let stop = Stop { relative, ..Stop::default() };
    conjugate_gradients(&team, stencil, &mut multigrid, b, &mut x, &stop).expect("a solution");
    x
}

/// Relative error of the solution for an eigenvector with `waves` half waves along each axis; sine in an open box, cosine in a closed tank.
fn eigenvector<const D: usize>(name: &str, n: i32, waves: [i32; D]) -> f64 {
    let stencil = domains::stencil::<D>(&Team::ambient(), name, n);
    let angle = |k: i32| PI * f64::from(k) / f64::from(n);
    let eigenvalue: f64 = waves.iter().map(|k| 2.0 - 2.0 * angle(*k).cos()).sum();
    let value = |slot: usize| {
        let cell = stencil.cells().place(slot);
        let wave = |a: usize| {
            let phase = angle(waves[a]) * (f64::from(cell[a]) + 0.5);
            if name == "open box" { phase.sin() } else { phase.cos() }
        };
        (0..D).map(wave).product::<f64>()
    };
    let exact: Vec<f64> = (0..stencil.len()).map(value).collect();
    let b: Vec<f64> = exact.iter().map(|x| eigenvalue * x).collect();
    let x = solve(&stencil, &b, 1e-11);
    let square = |x: &mut dyn Iterator<Item = f64>| x.map(|x| x * x).sum::<f64>().sqrt();
    square(&mut x.iter().zip(&exact).map(|(x, y)| x - y)) / square(&mut exact.iter().copied())
}

#[test]
fn eigenvectors_of_boxes_are_solutions() {
    // The residual, 1e-11 |b|, has the smallest eigenvalue D (pi / n)^2 at worst, and b that of the wave.
    for (waves, factor) in [([1, 1], 1.0), ([2, 5], 14.5), ([31, 17], 625.0)] {
        let open = eigenvector::<2>("open box", 64, waves);
        assert!(open < 2e-11 * factor, "{waves:?}: {open:e}");
    }
    for (waves, factor) in [([1, 0, 0], 1.0), ([2, 3, 1], 14.0), ([0, 13, 7], 218.0)] {
        let closed = eigenvector::<3>("closed tank", 32, waves);
        assert!(closed < 2e-11 * factor, "{waves:?}: {closed:e}");
    }
}

/// Level set of an ellipsoid.
fn level<const D: usize>(p: [f64; D]) -> f64 {
    (0..D).map(|a| ((p[a] - 0.51) / [0.41, 0.33, 0.37][a]).powi(2)).sum::<f64>() - 1.0
}

/// Distance from p along `axis` to the ellipsoid, in the direction of `sign`.
fn crossing<const D: usize>(p: [f64; D], axis: usize, sign: f64) -> f64 {
    let others: f64 =
        (0..D).filter(|a| *a != axis).map(|a| ((p[a] - 0.51) / [0.41, 0.33, 0.37][a]).powi(2)).sum();
    sign * (0.51 - p[axis]) + [0.41, 0.33, 0.37][axis] * (1.0 - others).max(0.0).sqrt()
}

/// Largest error of -div grad u = f in an ellipsoid with prescribed values on its surface (ghost fluid), on n^D cells.
fn manufactured<const D: usize>(n: i32) -> f64 {
    let h = 1.0 / f64::from(n);
    let u = |p: [f64; D]| {
        (2.0 * p[0]).sin() * (3.0 * p[1]).exp() * if D == 3 { (1.5 * p[D - 1]).cos() } else { 1.0 }
    };
    let f = |p: [f64; D]| (4.0 - 9.0 + if D == 3 { 2.25 } else { 0.0 }) * u(p);
    let list = (0..n.pow(D as u32)).map(|i| -> [i32; D] { std::array::from_fn(|a| i / n.pow(a as u32) % n) });
    let place = |c: [i32; D]| c.map(|x| (f64::from(x) + 0.5) * h);
    let list: Vec<[i32; D]> = list.filter(|c| level(place(*c)) < 0.0).collect();
    let cells = Arc::new(CellBlocks::of_cells(list.iter().copied()));
    let mut weights: [Vec<f64>; D] = std::array::from_fn(|_| vec![0.0; cells.cells()]);
    let (mut diagonal, mut b) = (vec![0.0; cells.cells()], vec![0.0; cells.cells()]);
    for cell in &list {
        let (slot, p) = (cells.find(*cell).expect("a cell"), place(*cell));
        b[slot] += h * h * f(p);
        for axis in 0..D {
            for sign in [-1, 1] {
                let mut beside = *cell;
                beside[axis] += sign;
                if level(place(beside)) < 0.0 {
                    diagonal[slot] += 1.0;
                    weights[axis][slot] = if sign > 0 { 1.0 } else { weights[axis][slot] };
                } else {
                    let distance = crossing(p, axis, f64::from(sign)).clamp(1e-6 * h, h);
                    let mut surface = p;
                    surface[axis] += f64::from(sign) * distance;
                    diagonal[slot] += h / distance;
                    b[slot] += h / distance * u(surface);
                }
            }
        }
    }
    let stencil = Stencil::new(&Team::ambient(), cells.clone(), weights, diagonal).expect("a stencil");
    let x = solve(&stencil, &b, 1e-11);
    list.iter().fold(0.0, |m: f64, c| m.max((x[cells.find(*c).expect("a cell")] - u(place(*c))).abs()))
}

#[test]
fn ghost_fluid_boundaries_converge_with_second_order() {
    // [Gibou2002]: second order in the largest norm.
    let [coarse, fine] = [32, 256].map(manufactured::<2>);
    let order = (coarse / fine).log2() / 3.0;
    println!("2D {coarse:e} {fine:e} {order}");
    assert!((1.85..2.15).contains(&order), "{coarse:e} {fine:e}: order {order}");
    let [coarse, fine] = [32, 128].map(manufactured::<3>);
    let order = (coarse / fine).log2() / 2.0;
    println!("3D {coarse:e} {fine:e} {order}");
    assert!((1.85..2.15).contains(&order), "{coarse:e} {fine:e}: order {order}");
}
