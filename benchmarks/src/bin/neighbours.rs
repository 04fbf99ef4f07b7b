//! The cell-linked search of `pcmm` beside a tree, point in box and strip point in box, over the number of particles.

use std::path::PathBuf;
use std::time::Instant;

use benchmarks::{packing, pib, strip_pib, tree};
use clap::Parser;
use mpm_core::Team;
use mpm_core::output::picture::{Axis, Chart, Series, palette};
use pcmm::{Neighbours, Particle};

/// Seconds of a search from scratch on one thread, by the number of particles, for a square body and for one 64 times as
/// long as wide, in random order.
#[derive(Debug, Parser)]
#[command(name = "neighbours", version)]
struct Options {
    /// Most particles, 1000 to 10000000
    #[arg(long, value_name = "N", default_value_t = 1_000_000, value_parser = clap::value_parser!(u32).range(1000..=10_000_000))]
    most: u32,
    /// Searches of each kind, of which the fastest counts, 1 to 100
    #[arg(long, value_name = "N", default_value_t = 3, value_parser = clap::value_parser!(u32).range(1..=100))]
    rounds: u32,
    /// Folder for the chart
    #[arg(long, value_name = "DIR", default_value = "out/neighbours")]
    out: PathBuf,
}

/// The tolerance of contact, in spacings.
const REACH: f64 = 0.45;
const NAMES: [&str; 4] = ["cells", "tree", "PIB", "strip PIB"];

fn search(kind: usize, particles: &[Particle<2>]) -> usize {
    match kind {
        0 => {
            let mut cells = Neighbours::new(REACH, 0.0);
            cells.update(particles, &Team::one());
            (0..particles.len()).map(|i| cells.of(i).len()).sum()
        }
        1 => tree(particles, REACH).list.len(),
        2 => pib(particles, REACH).list.len(),
        _ => strip_pib(particles, REACH, 2.0).list.len(),
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let options = Options::parse();
    std::fs::create_dir_all(&options.out)?;
    let mut counts = vec![1000usize];
    while let Some(&last) = counts.last()
        && last < options.most as usize
    {
        counts.push((last * 10).min(options.most as usize));
    }
    let mut chart =
        Chart::new(860, 560)
            .x(Axis::new("particles").logarithmic())
            .y(Axis::new("time a particle").unit("ns", 1e9).logarithmic());
    println!(
        "nanoseconds a particle\n{:>10} {:>8}  {}",
        "particles",
        "aspect",
        NAMES.map(|n| format!("{n:>10}")).join("")
    );
    for aspect in [1.0, 64.0] {
        let mut times = vec![Vec::new(); NAMES.len()];
        for &count in &counts {
            let particles = packing(count, aspect, 1);
            let mut row = String::new();
            let mut found = Vec::new();
            for (kind, times) in times.iter_mut().enumerate() {
                let mut best = f64::INFINITY;
                for _ in 0..options.rounds {
                    let clock = Instant::now();
                    found.push(search(kind, &particles));
                    best = best.min(clock.elapsed().as_secs_f64());
                    // One round of what takes long is enough.
                    if best > 5.0 {
                        break;
                    }
                }
                times.push(best / count as f64);
                row += &format!("{:>10.0}", 1e9 * best / count as f64);
            }
            if found.windows(2).any(|f| f[0] != f[1]) {
                return Err(format!("the searches find different pairs: {found:?}").into());
            }
            println!("{count:>10} {aspect:>8}  {row}");
        }
        if aspect == 1.0 {
            let x: Vec<f64> = counts.iter().map(|&c| c as f64).collect();
            for (kind, times) in times.iter().enumerate() {
                chart = chart.series(Series::new(NAMES[kind], &x, times)?.colour(palette(kind)));
            }
        }
    }
    chart.draw()?.save(options.out.join("neighbours.png"))?;
    Ok(())
}
