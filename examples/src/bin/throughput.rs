//! Quick look.
use mpm_core::geometry::{Lattice, Seeds};
use mpm_core::*;
use mpm_materials::*;

fn main() {
    let args: Vec<String> = std::env::args().collect();
    let want: f64 = args[1].parse().unwrap();
    let threads: usize = args[2].parse().unwrap();
    let steps: usize = args[3].parse().unwrap();
    let nb = (want / 8.0).cbrt().round() as i64;
    let u = 0.1;
    let mut positions = vec![];
    for k in 16..16 + 2 * nb {
        for j in 16..16 + 2 * nb {
            for i in 16..16 + 2 * nb {
                positions.push([i, j, k].map(|a| (a as f64 + 0.5) * 0.5));
            }
        }
    }
    let n = positions.len();
    let seeds = Seeds {
        volumes: vec![0.125; n],
        positions,
        half_size: [0.25; 3],
        raw_measure: 0.0,
        exact_measure: None,
        sampled_measure: None,
        correction: 1.0,
    };
    let vel = move |x: [f64; 3]| -> [f64; 3] {
        std::array::from_fn(|d| u * (0.4 + 0.6 * (x[(d + 1) % 3] * 6.0 / nb as f64).sin()))
    };
    let lattice = Lattice::new([0.0; 3], 1.0).unwrap();
    let moduli = Moduli::bulk_shear(1.0 + 1.6 / 3.0, 0.8).unwrap();
    if args[4] == "K1" {
        let mut mpm =
            Mpm::<f64, 3, _, _>::new(Method::new(Linear, Flip, Musl, FullSpace), BlockGrid::new(lattice));
        mpm.add("cube", LinearElastic::new(1.0, moduli).unwrap(), &seeds, vel).unwrap();
        run(mpm, threads, steps);
    } else {
        let mut mpm = Mpm::<f64, 3, _, _>::new(
            Method::new(QuadraticBSpline, Mls, Usl, FullSpace),
            BlockGrid::new(lattice),
        );
        mpm.add("cube", NeoHookean::new(1.0, moduli).unwrap(), &seeds, vel).unwrap();
        run(mpm, threads, steps);
    }
}
fn run<M: Composition<f64, 3>, G: GridStorage<f64, 3>>(
    mut mpm: Mpm<f64, 3, M, G>,
    threads: usize,
    steps: usize,
) {
    mpm.set_team(Team::new(threads).unwrap());
    mpm.set_time_control(TimeControl::Fixed(0.19)).unwrap();
    let before = mpm.totals();
    mpm.step().unwrap();
    let t = std::time::Instant::now();
    for _ in 0..steps {
        if let Err(e) = mpm.step() {
            println!("{e}");
            return;
        }
    }
    let s = t.elapsed().as_secs_f64();
    let n = mpm.particles();
    let after = mpm.totals();
    println!(
        "{n} particles {:.2} M/s, bytes/particle {:.0}, columns {}",
        n as f64 * steps as f64 / s / 1e6,
        mpm.bytes() as f64 / n as f64,
        8 * mpm.bodies()[0].columns()
    );
    println!("{before:?}\n{after:?}");
}
