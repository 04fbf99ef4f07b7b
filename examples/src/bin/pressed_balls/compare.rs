//! Cost of contact: the same pack with and without it, in alternation.

use std::time::Instant;

use examples::{CaseError, Check, Totals, case};
use mpm_core::{Mpm, OneField};

use crate::scene::{self, Setup};

/// Wave transits before timing starts: by then all balls move, and contacts open and close.
const WARM_UP: f64 = 3.0;
/// Number of steps per turn.
const TURN: usize = 4;
/// Cost of contact in the paper, ratios of time and memory.
const PAPER: [f64; 2] = [1.556, 1.057];
/// Allowed cost, ratios of time and memory.
const MOST: [f64; 2] = [1.20, 1.03];

/// Time both packs for `rounds` rounds; return the checks, and totals of the runs with contact.
pub fn compare(setup: &Setup, rounds: u32) -> Result<(Vec<Check>, Totals), CaseError> {
    let mut with = scene::pack(setup, scene::contact(setup)?)?;
    let mut without = scene::pack(setup, OneField)?;
    with.run_until(WARM_UP * setup.transit())?;
    without.run_until(WARM_UP * setup.transit())?;
    let (mut on, mut off, mut ratios) = (Vec::new(), Vec::new(), Vec::new());
    for _ in 0..rounds {
        // The order on, off, off, on cancels a drift of the machine in the ratio.
        let a = turn(&mut with, TURN)?;
        let b = turn(&mut without, TURN)? + turn(&mut without, TURN)?;
        let c = turn(&mut with, TURN)?;
        on.push((a + c) / (2 * TURN) as f64);
        off.push(b / (2 * TURN) as f64);
        ratios.push((a + c) / b);
    }
    let [time, low, high] = spread(ratios);
    let memory = with.bytes() as f64 / without.bytes() as f64;
    let ([on, ..], [off, ..]) = (spread(on), spread(off));
    let rows = [
        ["contact", "s a step", "bytes", "bytes a particle"].map(String::from),
        row("on", on, &with),
        row("off", off, &without),
    ];
    println!("\n{}", case::columns(&rows));
    println!("ratio of times: median {time:.3}, from {low:.3} to {high:.3} in {rounds} rounds");
    let checks = vec![
        Check::at_most("time a step with contact over without", time, "-", MOST[0], "target, this project"),
        Check::at_most("memory with contact over without", memory, "-", MOST[1], "target, this project"),
        Check::at_most("time ratio of the paper", time, "-", PAPER[0], "[Ma2010] [S]"),
        Check::at_most("memory ratio of the paper", memory, "-", PAPER[1], "[Ma2010] [S]"),
    ];
    let totals = Totals {
        particles: with.particles(),
        steps: with.steps(),
        simulated_seconds: with.time(),
        wall_seconds: on * with.steps() as f64,
        updates: with.particles() as f64 * with.steps() as f64,
        bytes: with.bytes(),
        ..Totals::default()
    };
    Ok((checks, totals))
}

fn row(name: &str, seconds: f64, mpm: &Mpm<3>) -> [String; 4] {
    let each = mpm.bytes() as f64 / mpm.particles() as f64;
    [name.into(), format!("{seconds:.5}"), mpm.bytes().to_string(), format!("{each:.0}")]
}

/// Measure the wall-clock time of some steps, s.
fn turn(mpm: &mut Mpm<3>, steps: usize) -> Result<f64, CaseError> {
    let start = Instant::now();
    for _ in 0..steps {
        mpm.step()?;
    }
    Ok(start.elapsed().as_secs_f64())
}

/// Return median, minimum and maximum.
fn spread(mut values: Vec<f64>) -> [f64; 3] {
    values.sort_by(f64::total_cmp);
    let n = values.len();
    if n == 0 {
        return [f64::NAN; 3];
    }
    [0.5 * (values[(n - 1) / 2] + values[n / 2]), values[0], values[n - 1]]
}
