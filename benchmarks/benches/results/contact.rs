//! Cost of contact, and memory savings of the block grid.

use std::path::Path;

use examples::CaseError;
use examples::throughput::{Job, Kernel, Spread, Way, timed};
use mpm_core::OneField;

use crate::kernels::by_hand;
use crate::page::table;
use crate::sample::{Sample, Subject, alternate};
use crate::scenes::{Penetration, balls, contact};

/// Number of particles of the oblique penetration of \[Ma2010\].
const PAPER: usize = 200_864;

fn job(particles: usize, threads: usize) -> Job {
    Job { kernel: Kernel::LinearMuslElastic, particles, threads, steps: 100, way: Way::default() }
}

fn row(name: &str, threads: usize, off: &Sample, on: &Sample, asked: &str) -> [String; 7] {
    let bytes = |s: &Sample| s.first().total_bytes_per_particle;
    let memory = if bytes(off) > 0.0 { format!("{:.3}", bytes(on) / bytes(off)) } else { "-".into() };
    let per = if bytes(on) > 0.0 { format!("{:.0}", bytes(on)) } else { "-".into() };
    [
        name.into(),
        on.first().particles.to_string(),
        threads.to_string(),
        off.over(on).text(2),
        memory,
        per,
        asked.into(),
    ]
}

/// Measure time and memory ratios with and without contact.
pub fn cost(quick: bool, yardstick: Option<&Path>) -> Result<Option<String>, CaseError> {
    let rounds = if quick { 3 } else { 5 };
    let mut rows = Vec::new();
    for threads in [1, 2] {
        let two = job(200_000, threads);
        let samples = alternate(
            &[
                Subject::new("one body", || timed(&two, balls(two.particles, false, OneField)?)),
                Subject::new("one field", || timed(&two, balls(two.particles, true, OneField)?)),
                Subject::new("contact", || timed(&two, balls(two.particles, true, contact(0.3)?)?)),
            ],
            rounds,
        )?;
        rows.push(row("two balls (K4), over one body", threads, &samples[0], &samples[2], "1.05"));
        rows.push(row("two balls (K4), over one field", threads, &samples[1], &samples[2], "1.05"));
        if let Some(program) = yardstick {
            let samples = alternate(
                &[
                    Subject::new("K1", || by_hand(program, "K1", "S3", &two)),
                    Subject::new("K4", || by_hand(program, "K4", "S3", &two)),
                ],
                rounds,
            )?;
            rows.push(row("two balls, K4 over K1 by hand", threads, &samples[0], &samples[1], "-"));
        }
        let scene = Penetration::new(if quick { 50_000 } else { PAPER })?;
        let three = job(PAPER, threads);
        let samples = alternate(
            &[
                Subject::new("off", || timed(&three, scene.solver(scene.blocks()?, OneField)?)),
                Subject::new("on", || timed(&three, scene.solver(scene.blocks()?, contact(0.0)?)?)),
            ],
            rounds,
        )?;
        let asked = "1.05; MPM3Dpp 1.061, 270 bytes";
        rows.push(row("oblique penetration", threads, &samples[0], &samples[1], asked));
    }
    Ok(Some(format!(
        "## Cost of contact\n\n100 steps in contact, linear shape functions, FLIP, MUSL, f64. Time and memory with contact over those \
         without, bytes a particle with contact, all scratch included. Without contact both bodies share one field of \
         velocities, or are one body.\n\n{}",
        table(["scene", "particles", "threads", "time on / off", "memory", "bytes", "asked"], &rows)
    )))
}

/// Compare a block grid with a dense grid.
pub fn sparse(quick: bool) -> Result<Option<String>, CaseError> {
    let scene = Penetration::new(if quick { 50_000 } else { PAPER })?;
    let (dense, cells) = scene.dense()?;
    let job = job(PAPER, 1);
    let samples = alternate(
        &[
            Subject::new("dense", || timed(&job, scene.solver(dense.clone(), OneField)?)),
            Subject::new("blocks", || timed(&job, scene.solver(scene.blocks()?, OneField)?)),
        ],
        if quick { 3 } else { 5 },
    )?;
    let [d, b] = [samples[0].first(), samples[1].first()];
    let of_grid = |s: &Sample| s.spread(|m| m.grid_seconds / m.steps as f64 * 1e3);
    let grids = Spread::of(
        samples[1].runs.iter().zip(&samples[0].runs).map(|(b, d)| b.grid_seconds / d.grid_seconds),
    );
    let rows: Vec<[String; 6]> = samples
        .iter()
        .map(|s| {
            let m = s.first();
            [
                s.name.clone(),
                s.rates().text(1),
                format!("{:.1}", m.grid_bytes as f64 / f64::from(1 << 20)),
                format!("{:.1}", m.total_bytes_per_particle * m.particles as f64 / f64::from(1 << 20)),
                s.spread(|m| 1e3 * m.seconds / m.steps as f64).text(1),
                of_grid(s).text(2),
            ]
        })
        .collect();
    Ok(Some(format!(
        "## Blocks of nodes against a dense grid\n\nThe oblique penetration with a box for the whole flight of the rod: \
         {} of {cells} cells ({:.1} %) hold particles at the end of 100 steps ([Ma2010] reports 13.13 %). The grid of \
         blocks takes {:.1} % of the memory of the dense one and {:.1} % of its time (25 % of both are asked): of a step but \
         for passes over particles. Of a whole step's time it is {:.1} %.\n\n{}",
        b.cells,
        100.0 * b.cells as f64 / cells as f64,
        100.0 * b.grid_bytes as f64 / d.grid_bytes as f64,
        100.0 * grids.median,
        100.0 * samples[0].over(&samples[1]).median,
        table(["grid", "rate", "nodes, MiB", "all memory, MiB", "ms a step", "of which the grid"], &rows)
    )))
}
