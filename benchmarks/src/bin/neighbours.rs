//! Comparison of the neighbour searches of `impactite-geometry` over the number of points and over the ratio of
//! radii.

use std::path::PathBuf;

use benchmarks::search::{NAMES, searched};
use benchmarks::{Cloud, graded, mixed, packing};
use clap::Parser;
use mpm_core::Team;
use mpm_core::geometry::search::Reach;
use mpm_core::output::picture::{Axis, Chart, Series, palette};

/// Nanoseconds of a search from scratch, sorting included: by the number of points, for a square body and for one 64 times as long as
/// wide, in random order; and by how radii differ. All searches must find the same lists.
#[derive(Debug, Parser)]
#[command(name = "neighbours", version)]
struct Options {
    /// Most points of a packing, 1000 to 10000000
    #[arg(long, value_name = "N", default_value_t = 1_000_000, value_parser = clap::value_parser!(u32).range(1000..=10_000_000))]
    most: u32,
    /// Points of the sets whose radii differ, 1000 to 10000000
    #[arg(long, value_name = "N", default_value_t = 100_000, value_parser = clap::value_parser!(u32).range(1000..=10_000_000))]
    count: u32,
    /// Searches of each kind, of which the fastest counts, 1 to 100
    #[arg(long, value_name = "N", default_value_t = 3, value_parser = clap::value_parser!(u32).range(1..=100))]
    rounds: u32,
    /// Threads, 1 to 1024
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=1024))]
    threads: u32,
    /// The cells alone
    #[arg(long)]
    cells: bool,
    /// Folder for the chart
    #[arg(long, value_name = "DIR", default_value = "out/neighbours")]
    out: PathBuf,
}

impl Options {
    /// Number of search kinds, and number of rounds.
    fn often(&self) -> (usize, u32) {
        (if self.cells { 1 } else { NAMES.len() }, self.rounds)
    }
}

type Failure = Box<dyn std::error::Error>;

/// Contact tolerance in the packings, in spacings.
const REACH: f64 = 0.45;

fn columns(times: &[f64], scale: f64) -> String {
    times.iter().map(|t| format!("{:>11.0}", 1e9 * t * scale)).collect()
}

fn over_numbers(options: &Options, team: &Team) -> Result<(), Failure> {
    let mut counts = vec![1000usize];
    while let Some(&last) = counts.last()
        && last < options.most as usize
    {
        counts.push((last * 10).min(options.most as usize));
    }
    let mut chart = Chart::new(860, 560)
        .x(Axis::new("points").logarithmic())
        .y(Axis::new("time a point").unit("ns", 1e9).logarithmic());
    println!(
        "nanoseconds a point, packings in two dimensions\n{:>10} {:>8} {}",
        "points",
        "aspect",
        NAMES.map(|n| format!("{n:>11}")).join("")
    );
    for aspect in [1.0, 64.0] {
        let mut times = vec![Vec::new(); NAMES.len()];
        for &count in &counts {
            let cloud = packing::<2>(count, aspect, 1);
            let best = searched(&cloud, Reach::sum(REACH), options.often(), team)?.seconds;
            println!("{count:>10} {aspect:>8} {}", columns(&best, 1.0 / count as f64));
            times.iter_mut().zip(&best).for_each(|(times, t)| times.push(t / count as f64));
        }
        if aspect == 1.0 {
            let x: Vec<f64> = counts.iter().map(|&c| c as f64).collect();
            for (kind, times) in times.iter().enumerate().filter(|(_, times)| !times.is_empty()) {
                chart = chart.series(Series::new(NAMES[kind], &x, times)?.colour(palette(kind)));
            }
        }
    }
    chart.draw()?.save(options.out.join("neighbours.png"))?;
    Ok(())
}

fn over_radii<const D: usize>(options: &Options, team: &Team) -> Result<(), Failure> {
    let count = options.count as usize;
    let row = |name: &str, cloud: Cloud<D>, reach: Reach| -> Result<(), Failure> {
        let found = searched(&cloud, reach, options.often(), team)?;
        let pairs = 0.5 * found.neighbours * count as f64;
        let columns = |scale: f64| columns(&found.seconds, scale);
        println!("{D:>3} {name:<16} {:>10.1} {}", found.neighbours, columns(1.0 / count as f64));
        println!("{:>3} {:<16} {:>10} {}", "", "", "a pair", columns(1.0 / pairs));
        Ok(())
    };
    row("packing", packing(count, 1.0, 1), Reach::sum(REACH))?;
    for ratio in [1.0, 10.0, 100.0] {
        row(&format!("graded {ratio}"), graded(count, ratio, 2), Reach::sum(0.0))?;
    }
    for ratio in [10.0, 100.0] {
        row(&format!("mixed {ratio}"), mixed(count, ratio, 3), Reach::sum(0.0))?;
    }
    Ok(())
}

fn main() -> Result<(), Failure> {
    let options = Options::parse();
    std::fs::create_dir_all(&options.out)?;
    let team = Team::new(options.threads as usize)?;
    over_numbers(&options, &team)?;
    println!(
        "\nnanoseconds a point and a pair, {} points\n{:>3} {:<16} {:>10} {}",
        options.count,
        "D",
        "radii",
        "neighbours",
        NAMES.map(|n| format!("{n:>11}")).join("")
    );
    over_radii::<2>(&options, &team)?;
    over_radii::<3>(&options, &team)
}
