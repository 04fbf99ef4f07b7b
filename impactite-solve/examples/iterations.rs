//! Iterations and costs of conjugate gradients with the multigrid preconditioner, as a table:
//! `iterations [threads] [largest side in space] [part of a name]`.
//!
//! Times are those of the calling thread on its processor where the system has them, else of the clock, and per unknown.

use std::sync::Arc;
use std::time::Instant;

use impactite_simd::Team;
use impactite_solve::{Multigrid, Stencil, Stop, conjugate_gradients};

#[allow(dead_code, reason = "the tests use the rest")]
#[path = "../tests/solve/domains.rs"]
mod domains;

/// Time of this thread, s.
fn now(start: Instant) -> f64 {
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").unwrap_or_default();
    let ran = text.split(' ').next().and_then(|t| t.parse::<f64>().ok());
    ran.map_or(start.elapsed().as_secs_f64(), |t| 1e-9 * t)
}

/// Mean time of `work`, s, repeated for a fifth of a second.
fn time(mut work: impl FnMut()) -> f64 {
    let clock = Instant::now();
    let (start, mut count) = (now(clock), 0);
    loop {
        work();
        count += 1;
        let total = now(clock) - start;
        if total > 0.2 {
            return total / f64::from(count);
        }
    }
}

fn measure<const D: usize>(team: &Team, name: &str, n: i32) {
    let stencil = domains::stencil::<D>(team, name, n);
    let (cells, unknowns) = (stencil.cells().clone(), stencil.unknowns());
    let mut multigrid = Multigrid::new(team, &stencil);
    let per = 1e9 / unknowns as f64;
    let setup = per * time(|| multigrid.renew(team, &stencil));
    let mut counts = Vec::new();
    let mut solve = 0.0;
    for smooth in [false, true] {
        let b = domains::source(team, &stencil, n, smooth);
        let mut x = vec![0.0; b.len()];
        let mut found = Ok(0);
        solve = per
            * time(|| {
                x.fill(0.0);
                let solved =
                    conjugate_gradients(team, &stencil, &mut multigrid, &b, &mut x, &Stop::default());
                found = solved.map(|s| s.iterations);
            });
        counts.push(found.map_or_else(|e| e.to_string(), |n| n.to_string()));
    }
    let (mut parts, mut check) = (Some(stencil.into_parts()), 0.0);
    check += per
        * time(|| {
            if let Some((weights, diagonal)) = parts.take() {
                let stencil = Stencil::new(team, Arc::clone(&cells), weights, diagonal).expect("a stencil");
                parts = Some(stencil.into_parts());
            }
        });
    println!(
        "| {name} | {D} | {n} | {unknowns} | {} | {check:.0} | {setup:.0} | {solve:.0} |",
        counts.join(", ")
    );
}

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let number = |i: usize, default| arguments.get(i).and_then(|a| a.parse().ok()).unwrap_or(default);
    let team = Team::new(number(0, 1)).expect("threads");
    let (largest, part) = (number(1, 128) as i32, arguments.get(2).cloned().unwrap_or_default());
    println!(
        "| domain | D | side | unknowns | iterations (noise, smooth) | check, ns | set-up, ns | solve, ns |"
    );
    println!("|---|---|---|---|---|---|---|---|");
    for name in domains::NAMES.into_iter().filter(|n| n.contains(&part)) {
        for n in [16, 32, 64, 128].into_iter().filter(|n| *n <= largest) {
            measure::<3>(&team, name, n);
        }
        for n in [32, 128, 512, 1024].into_iter().filter(|n| *n <= 8 * largest) {
            measure::<2>(&team, name, n);
        }
    }
}
