//! Trials.
use impactite_geometry::{Cuboid, Filling, Lattice, fill};
use impactite_scene::*;
use mpm_materials::*;
use sph::*;
fn main() {
    let args: Vec<String> = std::env::args().collect();
    let speed: f64 = args[1].parse().unwrap();
    let cells: usize = args[2].parse().unwrap();
    let which: usize = args[3].parse().unwrap();
    let h = 7.595e-3 / 2.0 / cells as f64;
    let height = (37.97e-3 / h).round() * h;
    let seeds = fill(
        &Cuboid::new([0.0, 0.0], [7.595e-3 / 2.0, height]).unwrap(),
        &Lattice::new([0.0; 2], h).unwrap(),
        1,
        &Filling::new().axisymmetric(),
    )
    .unwrap();
    let mut l = Layout::of_seeds(&seeds);
    if std::env::var("NODES").is_ok() {
        let rows = (height / h).round() as usize;
        l.positions.clear();
        l.volumes.clear();
        l.spacings.clear();
        l.surface = 0.0;
        for j in 0..=rows {
            for i in 0..cells {
                let r = (i as f64 + 0.5) * h;
                l.positions.push([r, j as f64 * h]);
                l.volumes.push(r * h * h * if j == 0 || j == rows { 0.5 } else { 1.0 });
                l.spacings.push(h);
            }
        }
    }
    let plain = library::steel_4340::<f64>();
    let visc = plain.with_bulk_viscosity(0.5, 4.0).unwrap();
    macro_rules! run { ($m:expr, $law:expr, $mirror:expr, $name:expr) => {{
        let mut b = Sph::new($m, $law, &l, |_| [0.0, -speed]).unwrap();
        if $mirror { b.mirror_wall(1, 0.0, Side::Above).unwrap(); } else { b.bound(Boundary::Wall { axis: 1, at: 0.0, side: Side::Above, velocity: 0.0 }).unwrap(); }
        b.set_watch(Watch::off());let e0 = b.totals().kinetic;
        let t0 = std::time::Instant::now();
        let end = 60e-6;
        if let Err(e) = b.run_until(end) { println!("{}: {e}", $name); }
        let wall = t0.elapsed().as_secs_f64();
        let (mut top, mut low, mut face) = (0.0f64, 1.0f64, 0.0f64);
        for x in b.positions() { top = top.max(x[1]); low = low.min(x[1]); } for x in b.positions() { if x[1] < low + 3.0 * h { face = face.max(x[0]); } }
        let pos = |i: usize, j: usize| -> [f64; 2] { let nodes = std::env::var("NODES").is_ok(); let want = [(i as f64 + 0.5) * h, if nodes { j as f64 * h } else { (j as f64 + 0.5) * h }]; let k = l.positions.iter().position(|x| (x[0] - want[0]).abs() < 1e-9 && (x[1] - want[1]).abs() < 1e-9).unwrap(); let m = b.numbers().iter().position(|n| *n as usize == k).unwrap(); b.positions()[m] };
        let nodes = std::env::var("NODES").is_ok(); let n = cells - 1; let rows = (height / h).round() as usize - if nodes { 0 } else { 1 };
        let ex = |p: [f64; 2], q: [f64; 2]| [1.5 * p[0] - 0.5 * q[0], 1.5 * p[1] - 0.5 * q[1]];
        let foot = |i: usize| if nodes { pos(i, 0) } else { ex(pos(i, 0), pos(i, 1)) }; let head = |i: usize| if nodes { pos(i, rows) } else { ex(pos(i, rows), pos(i, rows - 1)) };
        let corner = ex(foot(n), foot(n - 1));
        let lowest = (0..=n).map(|i| foot(i)[1]).fold(1.0, f64::min); let mean = (0..=n).map(|i| head(i)[1]).sum::<f64>() / cells as f64;
        println!("continued: length {:.3} face {:.3}", (mean - lowest) * 1e3, 2e3 * corner[0]);
        let t = b.totals();
        println!("{} | {}: {} steps, length {:.3}, L {:.3} mm, bottom {:.3}, face {:.3} mm, energy {:.4} of 1 (impacts {:.4}), {:.2} s, {:.2} M/s, searches {}, renewals {} warnings {}", $name, b.describe(), b.steps(), (top-low+h)*1e3, (top + h / 2.0) * 1e3, low*1e3, 2.0 * (face + h / 2.0) * 1e3, (t.kinetic + t.internal) / e0, b.exchange().impacts / e0, wall, b.steps() as f64 * b.positions().len() as f64 / wall / 1e6, b.searches(), b.renewals(), b.warnings().len());
    }} }
    match which {
        0 => run!(Method::total_lagrangian(Axisymmetric), plain, false, "total"),
        1 => run!(Method::updated(Axisymmetric), visc, false, "updated visc"),
        2 => run!(Method::printed(Axisymmetric), visc, true, "printed visc mirror"),
        3 => run!(Method::printed(Axisymmetric), visc, false, "printed visc wall"),
        4 => run!(Method::printed(Axisymmetric), plain, true, "printed plain mirror"),
        5 => run!(Method::updated(Axisymmetric), plain, false, "updated plain"),
        20 => run!(
            Method::new(
                Axisymmetric,
                CubicSpline::default(),
                Updated,
                NoCorrection,
                ArtificialStress::new(args[4].parse().unwrap()).unwrap()
            ),
            visc,
            true,
            "printed eps"
        ),
        21 => run!(
            Method::new(
                Axisymmetric,
                WendlandC2::default(),
                Updated,
                GradientCorrection,
                ArtificialStress::new(args[4].parse().unwrap()).unwrap()
            ),
            visc,
            false,
            "updated eps"
        ),
        30 => run!(
            Method::new(
                Axisymmetric,
                WendlandC2::new(args[5].parse().unwrap()).unwrap(),
                TotalLagrangian::default(),
                GradientCorrection,
                ZeroEnergyPenalty::new(args[4].parse().unwrap()).unwrap()
            ),
            plain,
            false,
            "total ratio"
        ),
        31 => run!(
            Method::new(
                Axisymmetric,
                CubicSpline::new(args[5].parse().unwrap()).unwrap(),
                TotalLagrangian::default(),
                GradientCorrection,
                ZeroEnergyPenalty::new(args[4].parse().unwrap()).unwrap()
            ),
            plain,
            false,
            "total cubic ratio"
        ),
        32 => run!(
            Method::new(
                Axisymmetric,
                WendlandC2::new(args[5].parse().unwrap()).unwrap(),
                Updated,
                GradientCorrection,
                Unstabilised
            ),
            visc,
            false,
            "updated ratio"
        ),
        9 => run!(
            Method::new(
                Axisymmetric,
                WendlandC2::default(),
                Updated,
                GradientCorrection,
                PairViscosity::default()
            ),
            plain,
            false,
            "updated pair only"
        ),
        10 => run!(
            Method::new(
                Axisymmetric,
                CubicSpline::default(),
                Updated,
                NoCorrection,
                PairViscosity::default()
            ),
            plain,
            false,
            "uncorrected pair only"
        ),
        11 => run!(
            Method::new(Axisymmetric, CubicSpline::default(), Updated, NoCorrection, Unstabilised),
            visc,
            false,
            "uncorrected, law visc"
        ),
        12 => run!(
            Method::new(Axisymmetric, CubicSpline::default(), Updated, NoCorrection, Unstabilised),
            visc,
            true,
            "uncorrected, law visc, mirror"
        ),
        13 => run!(
            Method::new(Axisymmetric, WendlandC2::default(), Updated, GradientCorrection, Unstabilised),
            visc,
            false,
            "corrected, law visc"
        ),
        6 => run!(
            Method::new(
                Axisymmetric,
                WendlandC2::default(),
                TotalLagrangian::renewed(1.3).unwrap(),
                GradientCorrection,
                ZeroEnergyPenalty::default()
            ),
            plain,
            false,
            "total renewed"
        ),
        7 => run!(
            Method::new(
                Axisymmetric,
                WendlandC2::default(),
                Updated,
                GradientCorrection,
                (ArtificialStress::default(), PairViscosity::default())
            ),
            visc,
            false,
            "updated visc pair"
        ),
        _ => run!(
            Method::new(
                Axisymmetric,
                WendlandC2::default(),
                TotalLagrangian::default(),
                GradientCorrection,
                ZeroEnergyPenalty::new(args[4].parse().unwrap()).unwrap()
            ),
            plain,
            false,
            "total alpha"
        ),
    }
}
