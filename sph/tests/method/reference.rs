//! Sums over neighbours against plain sums, by the formulas of the book.

use impactite_scene::{Axisymmetric, Body, Embedding, FullSpace, PlaneStrain, Solver, TimeControl, Watch};
use sph::{
    Composition, CubicSpline, Form, GradientCorrection, Kernel, Layout, Method, NoCorrection, Sph,
    TotalLagrangian, Unstabilised, Updated, WendlandC2, ZeroEnergyPenalty,
};

use crate::common::{block, linear, noise};

/// Disordered particles without any symmetry.
fn disordered<const D: usize>(hoop: bool) -> Layout<D> {
    let mut layout = block([0.0; D], [6.0; D], 1.0, hoop);
    for (n, x) in layout.positions.iter_mut().enumerate() {
        let shift = noise(*x, n as f64);
        (0..D).for_each(|d| x[d] += 0.15 * shift[d]);
    }
    // Variable spacings.
    for (x, spacing) in layout.positions.iter().zip(&mut layout.spacings) {
        *spacing *= 1.0 + 0.02 * x[D - 1];
    }
    layout
}

fn invert<const D: usize>(m: [[f64; D]; D]) -> [[f64; D]; D] {
    // Gauss-Jordan elimination without pivoting: moments are positive definite.
    let (mut a, mut b) = (m, [[0.0; D]; D]);
    (0..D).for_each(|i| b[i][i] = 1.0);
    for i in 0..D {
        let per = 1.0 / a[i][i];
        for j in 0..D {
            (a[i][j], b[i][j]) = (a[i][j] * per, b[i][j] * per);
        }
        for k in (0..D).filter(|&k| k != i) {
            let factor = a[k][i];
            for j in 0..D {
                (a[k][j], b[k][j]) = (a[k][j] - factor * a[i][j], b[k][j] - factor * b[i][j]);
            }
        }
    }
    b
}

/// Return accelerations of particles without images, by every pair: a_i = A_i / m_i sum_j A_j (S_i + S_j) grad_i W, S = V / A sigma B^T;
/// minus sigma_tt / (rho r) around an axis.
fn plain<const D: usize, M: Composition<D>>(
    body: &Sph<D, M>,
    kernel: &impl Kernel,
    corrected: bool,
) -> Vec<[f64; D]> {
    let hoop = M::Embedding::HOOP;
    let points = body.points();
    let count = points.len();
    let at = |i: usize| -> [f64; D] { std::array::from_fn(|d| points[i].position[d]) };
    let h: Vec<f64> =
        (0..count).map(|i| kernel.ratio() * (1.0 + 0.02 * START.with(|s| s.borrow()[i]))).collect();
    let area = |i: usize| points[i].volume / if hoop { at(i)[0] } else { 1.0 };
    let gradient = |i: usize, j: usize| -> [f64; D] {
        let (x, y, h) = (at(i), at(j), 0.5 * (h[i] + h[j]));
        let r = (0..D).map(|d| (x[d] - y[d]).powi(2)).sum::<f64>().sqrt();
        let slope = kernel.norm(D) * kernel.slope(r / h) / h.powi(D as i32 + 2);
        std::array::from_fn(|d| if r < 2.0 * h { slope * (x[d] - y[d]) } else { 0.0 })
    };
    let correction = |i: usize| {
        let mut m = [[0.0; D]; D];
        if !corrected {
            (0..D).for_each(|d| m[d][d] = 1.0);
            return m;
        }
        for j in (0..count).filter(|&j| j != i) {
            let g = gradient(i, j);
            for a in 0..D {
                for c in 0..D {
                    m[a][c] += area(j) * (at(j)[a] - at(i)[a]) * g[c];
                }
            }
        }
        invert(m)
    };
    let places = [[0, 5, 4], [5, 1, 3], [4, 3, 2]];
    let tensor = |i: usize| {
        let (b, scale) = (correction(i), points[i].volume / area(i));
        let mut s = [[0.0; D]; D];
        for a in 0..D {
            for c in 0..D {
                s[a][c] = scale * (0..D).map(|k| points[i].stress[places[a][k]] * b[c][k]).sum::<f64>();
            }
        }
        s
    };
    let tensors: Vec<_> = (0..count).map(tensor).collect();
    (0..count)
        .map(|i| {
            let mut a = [0.0; D];
            for j in (0..count).filter(|&j| j != i) {
                let g = gradient(i, j);
                for d in 0..D {
                    for c in 0..D {
                        a[d] +=
                            area(i) / points[i].mass * area(j) * (tensors[i][d][c] + tensors[j][d][c]) * g[c];
                    }
                }
            }
            if hoop {
                a[0] -= points[i].volume * points[i].stress[2] / (points[i].mass * at(i)[0]);
            }
            a
        })
        .collect()
}

thread_local! {
    /// Last coordinate of each particle at the start, from which spacings were computed.
    static START: std::cell::RefCell<Vec<f64>> = const { std::cell::RefCell::new(Vec::new()) };
}

fn follows<const D: usize, M: Composition<D>>(method: M, hoop: bool, corrected: bool) {
    let mut layout = disordered::<D>(hoop);
    if hoop {
        // Distance from the axis above the kernel support: no images.
        for (x, volume) in layout.positions.iter_mut().zip(&mut layout.volumes) {
            let r = x[0];
            x[0] += 20.0;
            *volume *= x[0] / r;
        }
    }
    START.with(|s| *s.borrow_mut() = layout.positions.iter().map(|x| x[D - 1]).collect());
    let mut body = Sph::new(method, linear(0.3), &layout, |x| noise(x, 3.0).map(|v| 50.0 * v)).unwrap();
    body.set_watch(Watch::off());
    body.set_time_control(TimeControl::Fixed(1e-6)).unwrap();
    let steps = if M::Form::TOTAL { 1 } else { 12 };
    (0..steps).for_each(|_| {
        body.step_at_most(f64::INFINITY).unwrap();
    });
    let wanted = plain(&body, method.kernel(), corrected);
    let largest = wanted.iter().flatten().fold(0.0f64, |m, a| m.max(a.abs()));
    let mut off = 0.0f64;
    for (i, &n) in body.numbers().iter().enumerate() {
        let found = body.acceleration(i);
        (0..D).for_each(|d| off = off.max((found[d] - wanted[n as usize][d]).abs() / largest));
    }
    // In the total Lagrangian form the plain sum uses the present kernel: equal except for the strain of a step.
    let allowed = if M::Form::TOTAL { 1e-2 } else { 1e-12 };
    assert!(off < allowed, "{}: {off:e}", body.describe());
}

#[test]
fn accelerations_are_the_plain_sums() {
    let (spline, wendland) = (CubicSpline::default(), WendlandC2::new(1.5).unwrap());
    follows::<2, _>(Method::new(PlaneStrain, spline, Updated, NoCorrection, Unstabilised), false, false);
    follows::<2, _>(
        Method::new(PlaneStrain, wendland, Updated, GradientCorrection, Unstabilised),
        false,
        true,
    );
    follows::<3, _>(Method::new(FullSpace, wendland, Updated, GradientCorrection, Unstabilised), false, true);
    follows::<2, _>(Method::new(Axisymmetric, spline, Updated, NoCorrection, Unstabilised), true, false);
    follows::<2, _>(
        Method::new(Axisymmetric, wendland, Updated, GradientCorrection, Unstabilised),
        true,
        true,
    );
    let total = TotalLagrangian::default();
    follows::<2, _>(Method::new(PlaneStrain, spline, total, GradientCorrection, Unstabilised), false, true);
    follows::<3, _>(Method::new(FullSpace, wendland, total, GradientCorrection, Unstabilised), false, true);
}

/// Force is minus the derivative of the energy, the sum of strain energy and penalty energy.
#[test]
fn the_penalty_is_the_derivative_of_its_energy() {
    fn check<const D: usize, M: Composition<D>>(method: M) {
        let layout = block([0.0; D], [4.0; D], 1.0, M::Embedding::HOOP);
        // The stiffness of the penalty is that of the law: both energies contribute.
        let body = |e: f64, of: usize, axis: usize| {
            let velocity = |x: [f64; D]| {
                let mut v = noise(x, 1.0).map(|v| 20.0 * v);
                let n = layout.positions.iter().position(|y| *y == x).unwrap();
                if n == of {
                    v[axis] += e;
                }
                v
            };
            let mut body = Sph::new(method, linear(0.3), &layout, velocity).unwrap();
            body.set_watch(Watch::off());
            body.set_time_control(TimeControl::Fixed(1e-6)).unwrap();
            body.step_at_most(f64::INFINITY).unwrap();
            body
        };
        let energy = |body: &Sph<D, M>| body.penalty_energy() + body.internal_energy();
        for (of, axis) in [(0, 0), (5, 1), (10, D - 1)] {
            let e = 1e-2;
            let slope = (energy(&body(e, of, axis)) - energy(&body(-e, of, axis))) / (2.0 * e * 1e-6);
            let there = body(0.0, of, axis);
            let place = there.numbers().iter().position(|&n| n as usize == of).unwrap();
            let force = there.mass(place) * there.acceleration(place)[axis];
            assert!((force + slope).abs() < 2e-3 * slope.abs().max(1e3), "{force} {slope}");
        }
    }
    let method = |alpha: f64| {
        let penalty = ZeroEnergyPenalty::new(alpha).unwrap();
        Method::new(
            PlaneStrain,
            WendlandC2::default(),
            TotalLagrangian::default(),
            GradientCorrection,
            penalty,
        )
    };
    check::<2, _>(method(0.0));
    check::<2, _>(method(5.0));
    let penalty = ZeroEnergyPenalty::new(5.0).unwrap();
    let total = TotalLagrangian::default();
    check::<3, _>(Method::new(FullSpace, CubicSpline::default(), total, GradientCorrection, penalty));
}
