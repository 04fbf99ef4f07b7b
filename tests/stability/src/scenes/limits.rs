//! Time step limits.

use std::f64::consts::PI;

use nalgebra::{DMatrix, DVector};
use verification::{Kernel, Scheme};

use crate::stage::{
    ApicUsl, Cubic, FlipMusl, FlipUsl, Fmpm4Usl, Gimp, Linear, Means, Quadratic, Random, bar, energy,
    row_of_cells, steps, ul,
};
use crate::verdict::{Limit, Measured, Scene, Size};

/// T3: cut cell.
pub fn cut_cell() -> Scene {
    fn worst(scheme: Scheme, offsets: &[f64]) -> Result<Measured, String> {
        let (mut worst, mut made) = (0.0, 0);
        for xi in offsets {
            let length = 10.0;
            // Particle spacing of half a cell: the outermost particle is xi behind a node.
            let seeds = row_of_cells(10, 2, 0.25 + xi)?;
            let (dt, count) = (0.5, 10_000);
            let mut mpm = bar(scheme, dt, &seeds, &|x| 1e-6 * (PI * x / length).cos())?;
            // Energy means over five periods: kinetic and internal energy are half a step apart, and the actual period is not
            // an integer number of steps.
            let period = 5 * (2.0 * length / dt) as u64;
            let start = energy(&mpm.totals());
            let (mut sum, mut most) = (0.0, 0.0f64);
            let stop = steps(&mut mpm, count, |now, step| {
                sum += energy(&now.totals());
                if step % period == 0 {
                    most = most.max(sum / period as f64 / start);
                    sum = 0.0;
                }
            });
            made += stop.as_ref().map_or(count, |s| s.step - 1);
            if stop.is_some() {
                return Ok(Measured::new(f64::NAN, made).stopped(stop));
            }
            worst = if most > worst { most } else { worst };
        }
        Ok(Measured::new(worst, made))
    }
    fn trial(scheme: Scheme, offsets: &'static [f64]) -> impl Fn(Size) -> Result<Measured, String> {
        move |_| worst(scheme, offsets)
    }
    const ALL: [f64; 4] = [1e-1, 1e-2, 1e-4, 1e-6];
    Scene {
        id: "T3",
        name: "cut cell",
        fails: "A free bar whose outermost particle stands xi of a cell behind a node, 1e4 steps of 0.5 h/c. That node has a mass of order \
                xi but a force of order one: with USL the step limit is sqrt(2 xi).",
        metric: "largest mean energy of five periods over that of the start",
        limit: Limit::AtMost(1.05),
        rows: Vec::new(),
    }
    .fails("linear FLIP-USL, xi 1e-1", "list T3, finding 5 [C]", trial(ul(Linear, FlipUsl), &ALL[..1]))
    .fails("linear FLIP-USL, xi 1e-2", "list T3, finding 5 [C]", trial(ul(Linear, FlipUsl), &ALL[1..2]))
    .fails("linear FLIP-USL, xi 1e-6", "list T3, finding 5 [C]", trial(ul(Linear, FlipUsl), &ALL[3..]))
    .holds("linear FLIP-USL, xi 0.25", "finding 5: limit 0.61 [C]", trial(ul(Linear, FlipUsl), &[0.25]))
    .holds("linear FLIP-MUSL, xi 1e-1..1e-6", "list T3 [C]", trial(ul(Linear, FlipMusl), &ALL))
    .holds("uGIMP FLIP-USL, xi 1e-1..1e-6", "list T3 [C]", trial(ul(Gimp, FlipUsl), &ALL))
    .holds("quadratic FLIP-USL, xi 1e-1..1e-6", "list T3 [C]", trial(ul(Quadratic, FlipUsl), &ALL))
    .holds("quadratic APIC, xi 1e-1..1e-6", "list T3 [C]", trial(ul(Quadratic, ApicUsl), &ALL))
    .holds("cubic FMPM(4), xi 1e-1..1e-6", "list T3 [C]", trial(ul(Cubic, Fmpm4Usl), &ALL))
}

/// Shape function value and gradient at distance `d` (particle minus node, in cells), for particle domains of half
/// size `l`. Implemented from the formulas (book, "GIMP"; B-splines piecewise), independent of the library.
pub(crate) fn weight(kernel: Kernel, d: f64, l: f64) -> (f64, f64) {
    let (a, sign) = (d.abs(), if d < 0.0 { -1.0 } else { 1.0 });
    let (value, slope) = match kernel {
        Kernel::Linear if a < 1.0 => (1.0 - a, -1.0),
        Kernel::Gimp | Kernel::CpGimp => {
            if a <= l {
                (1.0 - (a * a + l * l) / (2.0 * l), -a / l)
            } else if a <= 1.0 - l {
                (1.0 - a, -1.0)
            } else if a <= 1.0 + l {
                let r = 1.0 + l - a;
                (r * r / (4.0 * l), -r / (2.0 * l))
            } else {
                (0.0, 0.0)
            }
        }
        Kernel::Cpdi | Kernel::Cpdi2 => {
            let hat = |d: f64| (1.0 - d.abs()).max(0.0);
            (0.5 * (hat(a - l) + hat(a + l)), (hat(a + l) - hat(a - l)) / (2.0 * l))
        }
        Kernel::Quadratic if a <= 0.5 => (0.75 - a * a, -2.0 * a),
        Kernel::Quadratic if a <= 1.5 => (0.5 * (1.5 - a).powi(2), -(1.5 - a)),
        Kernel::Cubic if a <= 1.0 => (2.0 / 3.0 - a * a + 0.5 * a.powi(3), -2.0 * a + 1.5 * a * a),
        Kernel::Cubic if a <= 2.0 => ((2.0 - a).powi(3) / 6.0, -0.5 * (2.0 - a).powi(2)),
        _ => (0.0, 0.0),
    };
    (value, sign * slope)
}

/// Stable time step limit of FLIP with MUSL for a free bar at frozen positions `x` (density, modulus and cell size 1, equal
/// particle sizes): 2 / sqrt(lambda_max(A K)) with A = M^-1 Mc M^-1 (book, "Properties of stress updates and transfers",
/// finding 1).
fn symplectic_limit(kernel: Kernel, x: &[f64], volume: f64) -> f64 {
    let low = x.iter().fold(f64::MAX, |a, &b| a.min(b)).floor() as i64 - 2;
    let high = x.iter().fold(f64::MIN, |a, &b| a.max(b)).ceil() as i64 + 2;
    let n = (high - low + 1) as usize;
    let mut lumped = DVector::<f64>::zeros(n);
    let (mut consistent, mut stiffness) = (DMatrix::<f64>::zeros(n, n), DMatrix::<f64>::zeros(n, n));
    for &x in x {
        let w: Vec<_> = (0..n).map(|i| weight(kernel, x - (low + i as i64) as f64, 0.5 * volume)).collect();
        for i in 0..n {
            lumped[i] += volume * w[i].0;
            for j in 0..n {
                consistent[(i, j)] += volume * w[i].0 * w[j].0;
                stiffness[(i, j)] += volume * w[i].1 * w[j].1;
            }
        }
    }
    let inverse = DMatrix::from_diagonal(&lumped.map(|m| if m > 1e-14 { 1.0 / m } else { 0.0 }));
    let matrix = &inverse * consistent * &inverse * stiffness;
    let largest = matrix.complex_eigenvalues().iter().fold(0.0f64, |most, e| most.max(e.re));
    2.0 / largest.sqrt()
}

/// T4: predicted time step limit.
pub fn predicted() -> Scene {
    fn trial(kernel: Kernel, share: f64) -> impl Fn(Size) -> Result<Measured, String> {
        move |_| {
            let seeds = row_of_cells(8, 2, 0.1)?;
            let mut x: Vec<f64> = seeds.positions.iter().map(|x| x[0]).collect();
            x.sort_by(f64::total_cmp);
            x.dedup();
            let dt = share * symplectic_limit(kernel, &x, 0.5);
            // Equal noise for both particle layers.
            let mut random = Random::new(7);
            let kicks: Vec<f64> = x.iter().map(|_| 1e-8 * random.number()).collect();
            let velocity = |at: f64| x.iter().position(|&x| x == at).map_or(f64::NAN, |k| kicks[k]);
            let mut mpm = bar(ul(kernel, FlipMusl), dt, &seeds, &velocity)?;
            let start = energy(&mpm.totals());
            let mut most = 0.0f64;
            let stop = steps(&mut mpm, 2000, |now, _| most = most.max(energy(&now.totals())));
            let made = stop.as_ref().map_or(2000, |s| s.step - 1);
            Ok(Measured::new((most / start).sqrt(), made).stopped(stop))
        }
    }
    let mut scene = Scene {
        id: "T4",
        name: "predicted limit of the step",
        fails: "Noise of 1e-8 c in a free bar of 8 cells, steps of 0.99 and 1.01 of the limit 2 / sqrt(lambda_max(A K)) of FLIP with MUSL, \
                computed beside the library. A limit that is off shows on one side or the other.",
        metric: "largest amplitude over that of the start (root of the energy), 2000 steps",
        limit: Limit::AtMost(10.0),
        rows: Vec::new(),
    };
    for kernel in [Linear, Gimp, Quadratic, Cubic] {
        scene = scene
            .holds(
                format!("{} FLIP-MUSL, 0.99", kernel.name()),
                "list T4, finding 1 [C]",
                trial(kernel, 0.99),
            )
            .fails(
                format!("{} FLIP-MUSL, 1.01", kernel.name()),
                "list T4, finding 1 [C]",
                trial(kernel, 1.01),
            )
            // Limit of growth by a thousand instead of just above ten.
            .but(|row| row.limit(Limit::AtMost(1e3)));
    }
    scene
}

/// F1: time step factors from a hundredth to beyond the limit.
pub fn factors() -> Scene {
    fn trial(scheme: Scheme, courant: f64) -> impl Fn(Size) -> Result<Measured, String> {
        move |_| {
            let length = 20.0;
            let seeds = row_of_cells(20, 2, 0.1)?;
            let period = (2.0 * length / courant).round() as u64;
            let mut mpm = bar(scheme, courant, &seeds, &|x| 1e-4 * (PI * (x - 0.1) / length).cos())?;
            let mut means = Means::new(5 * period, 5);
            let stop = steps(&mut mpm, 5 * period, |now, step| means.add(step, energy(&now.totals())));
            let made = stop.as_ref().map_or(5 * period, |s| s.step - 1);
            Ok(Measured::new(means.change().abs(), made).stopped(stop))
        }
    }
    let scene = Scene {
        id: "F1",
        name: "extreme steps",
        fails: "A free bar of 20 cells swings five times with steps from 0.01 h/c to beyond the limit. What is filtered once a step \
                is lost in proportion to the number of steps (book, The step, finding 3); what is too long blows up.",
        metric: "change of energy, mean of the last period against the first",
        limit: Limit::AtMost(0.05),
        rows: Vec::new(),
    };
    scene
        .holds("quadratic FLIP-MUSL, 0.01", "finding 1 [C]", trial(ul(Quadratic, FlipMusl), 0.01))
        .holds("quadratic FLIP-MUSL, 0.5", "finding 1 [C]", trial(ul(Quadratic, FlipMusl), 0.5))
        .holds("quadratic FLIP-MUSL, 1.9", "time step [C]", trial(ul(Quadratic, FlipMusl), 1.9))
        .fails("quadratic FLIP-MUSL, 2.6", "time step [C]", trial(ul(Quadratic, FlipMusl), 2.6))
        .holds("quadratic FLIP-USL, 0.01", "finding 2 [C]", trial(ul(Quadratic, FlipUsl), 0.01))
        .fails("quadratic FLIP-USL, 1.4", "time step [C]", trial(ul(Quadratic, FlipUsl), 1.4))
        .fails("quadratic APIC, 0.01", "finding 3 [C]", trial(ul(Quadratic, ApicUsl), 0.01))
        .holds("quadratic APIC, 0.5", "finding 3 [C]", trial(ul(Quadratic, ApicUsl), 0.5))
        .fails("cubic APIC, 0.01", "finding 3 [C]", trial(ul(Cubic, ApicUsl), 0.01))
        .holds("cubic FMPM(4), 0.01", "finding 3 [C]", trial(ul(Cubic, Fmpm4Usl), 0.01))
        .holds("linear FLIP-MUSL, 1.3", "time step [C]", trial(ul(Linear, FlipMusl), 1.3))
}
