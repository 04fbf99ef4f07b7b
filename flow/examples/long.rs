//! Tank of 24 cells of water that sways for long: mean and extreme volumes, and particles that are at the place of another.
#![allow(missing_docs, reason = "modules of the tests")]
#![allow(dead_code, reason = "the tests use the rest")]

#[path = "../tests/flow/common.rs"]
mod common;
#[path = "../tests/flow/gates.rs"]
mod gates;

use impactite_scene::{Solver, Watch};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let mut number = |default: f64| arguments.next().map_or(Ok(default), |s| s.parse());
    let (steps, acceleration) = (number(100_000.0)? as usize, number(0.1)?);
    let mut flow = common::tank(gates::staggered, 1.0, 0.5, 24, |_| 0.0);
    flow.set_watch(Watch::default().only_warn());
    let omega = 0.8 * 5.31655;
    flow.set_body_force(move |t| [-acceleration * (omega * t).sin(), -common::GRAVITY]);
    for _ in 0..10 {
        let (mut sum, mut least, mut most) = (0.0, f64::INFINITY, f64::NEG_INFINITY);
        for _ in 0..steps / 10 {
            flow.step_at_most(f64::INFINITY)?;
            let volume = flow.liquid_volume() / 0.5 - 1.0;
            (sum, least, most) = (sum + volume, volume.min(least), volume.max(most));
        }
        let mean = sum / (steps / 10) as f64;
        println!(
            "t {:.0} s: volume less 1, mean {mean:+.4}, least {least:+.4}, largest {most:+.4}",
            flow.time()
        );
    }
    let mut places: Vec<_> = flow.points().iter().map(|p| p.position.map(|x| (x * 1e9) as i64)).collect();
    let count = places.len();
    places.sort_unstable();
    places.dedup();
    for warning in flow.warnings() {
        println!("{warning}");
    }
    println!("{} of {count} particles at the place of another", count - places.len());
    Ok(())
}
