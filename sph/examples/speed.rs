//! Trials.
use impactite_geometry::{Cuboid, Filling, Lattice, fill};
use impactite_scene::*;
use mpm_materials::*;
use sph::*;
fn main() {
    let n: usize = std::env::args().nth(1).unwrap().parse().unwrap();
    let which: usize = std::env::args().nth(2).unwrap().parse().unwrap();
    let ratio: f64 = std::env::args().nth(3).unwrap().parse().unwrap();
    let h = 1e-3;
    let top = n as f64 * h;
    let l = Layout::of_seeds(
        &fill(
            &Cuboid::new([0.0; 3], [top; 3]).unwrap(),
            &Lattice::new([0.0; 3], h).unwrap(),
            1,
            &Filling::new(),
        )
        .unwrap(),
    );
    macro_rules! go {
        ($m:expr) => {{
            let mut b = Sph::new($m, library::steel_4340(), &l, |_| [0.0, 0.0, -200.0]).unwrap();
            b.bound(Boundary::Wall { axis: 2, at: 0.0, side: Side::Above, velocity: 0.0 }).unwrap();
            b.set_watch(Watch::off());
            for _ in 0..3 {
                b.step_at_most(f64::INFINITY).unwrap();
            }
            let steps = 40;
            let cpu = || {
                std::fs::read_to_string("/proc/thread-self/schedstat")
                    .unwrap()
                    .split(' ')
                    .next()
                    .unwrap()
                    .parse::<f64>()
                    .unwrap()
                    * 1e-9
            };
            let t0 = cpu();
            b.measure_steps();
            for _ in 0..steps {
                b.step_at_most(f64::INFINITY).unwrap();
            }
            let t = cpu() - t0;
            let q = b.step_times();
            let all = q.total();
            print!(
                "search {:.0}% kernels {:.0}% sums {:.0}% law {:.0}% motion {:.0}% ",
                q.search / all * 100.0,
                q.kernels / all * 100.0,
                q.sums / all * 100.0,
                q.law / all * 100.0,
                q.motion / all * 100.0
            );
            let p = b.positions().len();
            println!(
                "{}: {} particles, {:.1} neighbours, {:.2} M/s, {:.0} ns, {} bytes a particle, searches {}",
                b.describe(),
                p,
                b.pairs() as f64 / p as f64,
                steps as f64 * p as f64 / t / 1e6,
                t / steps as f64 / p as f64 * 1e9,
                b.bytes() / p,
                b.searches()
            );
        }};
    }
    match which {
        0 => go!(Method::new(
            FullSpace,
            WendlandC2::new(ratio).unwrap(),
            TotalLagrangian::default(),
            GradientCorrection,
            ZeroEnergyPenalty::default()
        )),
        1 => go!(Method::new(
            FullSpace,
            WendlandC2::new(ratio).unwrap(),
            Updated,
            GradientCorrection,
            ArtificialStress::default()
        )),
        _ => {
            go!(Method::new(FullSpace, CubicSpline::new(ratio).unwrap(), Updated, NoCorrection, Unstabilised))
        }
    }
}
