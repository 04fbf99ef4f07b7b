//! Iterations and costs of conjugate gradients with the multigrid preconditioner: `iterations [threads] [largest side]`.

use impactite_simd::Team;
use impactite_solve::{Multigrid, Stop, conjugate_gradients};

#[path = "../tests/domains/mod.rs"]
mod domains;

/// Time that this thread ran on a processor, s, where the system tells it; else the time of the clock.
fn now(start: std::time::Instant) -> f64 {
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").unwrap_or_default();
    let ran = text.split(' ').next().and_then(|t| t.parse::<f64>().ok());
    ran.map_or(start.elapsed().as_secs_f64(), |t| 1e-9 * t)
}

fn measure<const D: usize>(team: &Team, name: &str, n: i32) {
    let stencil = domains::stencil::<D>(team, name, n);
    let mut multigrid = Multigrid::new(team, &stencil);
    let clock = std::time::Instant::now();
    let start = now(clock);
    multigrid.renew(team, &stencil);
    let setup = now(clock) - start;
    let per = 1e9 / stencil.unknowns() as f64;
    print!("{D}D {name:>13} {n:>5} {:>8} unknowns, setup {:6.1} ns", stencil.unknowns(), setup * per);
    for smooth in [false, true] {
        let b = domains::source(team, &stencil, n, smooth);
        let mut x = vec![0.0; b.len()];
        let start = now(clock);
        match conjugate_gradients(team, &stencil, &mut multigrid, &b, &mut x, &Stop::default()) {
            Ok(solved) => {
                let time = now(clock) - start;
                print!(", {:3} iterations {:6.1} ns", solved.iterations, time * per);
            }
            Err(error) => print!(", {error}"),
        }
    }
    println!();
}

fn main() {
    let mut arguments = std::env::args().skip(1).filter_map(|a| a.parse().ok());
    let team = Team::new(arguments.next().unwrap_or(1)).expect("threads");
    let largest = arguments.next().unwrap_or(128);
    let only = std::env::var("ONLY").unwrap_or_default();
    for name in domains::NAMES.into_iter().filter(|n| n.contains(&only)) {
        for n in [16, 32, 64, 128].into_iter().filter(|n| *n <= largest as i32) {
            measure::<3>(&team, name, n);
        }
        for n in [32, 128, 512, 1024].into_iter().filter(|n| *n <= 8 * largest as i32) {
            measure::<2>(&team, name, n);
        }
    }
}
