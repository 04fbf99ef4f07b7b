//! Incompressible flow: rates, shares of the stages, memory, and Warp's example of a fluid beside it.

use std::path::Path;
use std::process::Command;

use benchmarks::{Stepped, timed};
use examples::CaseError;
use examples::peers::{FOLDER, Peer};
use examples::throughput::printed;
use flow::{Flow, FlowOptions, Fluid, SemiStaggered, StepTimes, Wall};
use mpm_core::geometry::{Cuboid, HalfSpace, Lattice};
use mpm_core::{Solver, Team, Watch};

use crate::page::{asked, table};
use crate::sample::{Sample, Subject, alternate};

/// Particle-steps on one thread, millions a second, and gain by a second thread.
const RATE: f64 = 4.0;
const TWICE: f64 = 1.7;
/// Share of the pressure in a step, at most.
const PRESSURE: f64 = 0.5;

/// Timed run of water.
struct Water {
    run: Stepped,
    times: StepTimes,
    /// Bytes of particles and of the grid.
    memory: [usize; 2],
    cells: usize,
}

impl crate::sample::Run for Water {
    fn rate(&self) -> f64 {
        self.run.updates_per_second()
    }
}

/// Scheme of a scene on a lattice.
type Scheme = fn(FlowOptions<3>) -> FlowOptions<3>;

/// Column of water of this many cells, released in a tank in space.
fn column(scheme: Scheme, cells: usize) -> Result<Flow<3>, CaseError> {
    let mut flow = Flow::new(scheme(FlowOptions::new(Lattice::new([0.0; 3], 1.0 / cells as f64)?)));
    flow.add_wall(Wall::container(Cuboid::new([0.0; 3], [2.0, 1.0, 1.5])?))?;
    flow.add_shape("water", Fluid::new(1000.0)?, &Cuboid::new([0.0; 3], [1.0; 3])?, 2, |_| [0.0; 3])?;
    flow.set_body_force(|_| [0.0, 0.0, -9.81]);
    Ok(flow)
}

/// Cube of water that falls, as in Warp's example.
fn cube(scheme: Scheme, cells: usize) -> Result<Flow<3>, CaseError> {
    let mut flow = Flow::new(scheme(FlowOptions::new(Lattice::new([0.0; 3], 10.0 / cells as f64)?)));
    flow.add_wall(Wall::solid(HalfSpace::new([0.0, -10.0, 0.0], [0.0, 1.0, 0.0])?))?;
    flow.add_shape("water", Fluid::new(1000.0)?, &Cuboid::new([-5.0; 3], [5.0; 3])?, 2, |_| [0.0; 3])?;
    flow.set_body_force(|_| [0.0, -10.0, 0.0]);
    flow.set_time_control(mpm_core::TimeControl::Fixed(1.0 / 60.0))?;
    Ok(flow)
}

fn run(mut flow: Flow<3>, threads: usize, steps: u64) -> Result<Water, CaseError> {
    flow.set_team(Team::new(threads)?);
    flow.set_watch(Watch::off());
    for _ in 0..3 {
        flow.step_at_most(f64::INFINITY)?;
    }
    flow.measure_times();
    let (made, seconds) =
        timed(threads, || (0..steps).try_for_each(|_| flow.step_at_most(f64::INFINITY).map(|_| ())));
    made?;
    let (points, bytes) = (flow.totals().particles, flow.bytes());
    let times = flow.times().unwrap_or_default();
    let run = Stepped { points, steps, seconds, bytes };
    Ok(Water { run, times, memory: flow.memory(), cells: flow.liquid_cells() })
}

/// Shares of the stages of a step.
fn shares(times: &StepTimes) -> [f64; 8] {
    let list = [
        times.pressure,
        times.density,
        times.scatter,
        times.gather,
        times.sort,
        times.surface,
        times.extrapolation,
        times.forces,
    ];
    let sum: f64 = list.iter().sum();
    list.map(|t| t / sum)
}

fn row(name: &str, pair: &[Sample<Water>], judged: bool) -> Vec<String> {
    let (one, twice, first) = (pair[0].rates(), pair[1].over(&pair[0]), pair[0].first());
    let parts = shares(&first.times);
    let judge = |met: bool, text: String| if judged { asked(text, met) } else { text };
    let pressure = parts[0] + parts[1];
    let mut cells = vec![
        name.into(),
        first.run.points.to_string(),
        judge(one.median >= RATE, one.text(2)),
        judge(twice.median >= TWICE, twice.text(2)),
        judge(pressure <= PRESSURE, format!("{:.0} %", 100.0 * pressure)),
    ];
    cells.extend(parts[2..].iter().map(|part| format!("{:.0} %", 100.0 * part)));
    cells.push(format!("{:.0}", first.memory[0] as f64 / first.run.points as f64));
    cells.push(format!("{:.0}", first.memory[1] as f64 / first.cells as f64));
    cells
}

/// Measure rates, stages and memory of a column of 1 M particles, and compare with Warp.
pub fn cost(quick: bool, python: &Path) -> Result<Option<String>, CaseError> {
    let (cells, steps, rounds) = if quick { (24, 5, 1) } else { (50, 10, 3) };
    let schemes: [(&str, Scheme); 2] =
        [("staggered", |o| o), ("semi-staggered", |o| o.semi_staggered(SemiStaggered::default()))];
    let mut subjects = Vec::new();
    for (name, scheme) in schemes {
        for threads in [1, 2] {
            subjects.push(Subject::new(name, move || run(column(scheme, cells)?, threads, steps)));
        }
    }
    let samples = alternate(&subjects, rounds)?;
    let rows: Vec<_> = schemes
        .iter()
        .zip(samples.chunks_exact(2))
        .map(|((name, _), pair)| row(name, pair, *name == "staggered"))
        .collect();
    let mut text = format!(
        "## Water\n\nA column of water in space, released in a tank, 8 particles a cell, {steps} steps: 10^6 particle-steps a second on one thread, and the gain by a second one; \
         shares of a step, of which pressure and density correction are the solves; bytes a particle, which is there twice to be sorted, and a liquid cell, the \
         cells around the liquid included. Asked: {RATE} on one thread, {TWICE} with a second, at most half for the solves.\n\n"
    );
    let head = [
        "scheme",
        "particles",
        "one thread",
        "two threads / one",
        "pressure and density",
        "to faces or nodes",
        "to particles",
        "sort",
        "surface",
        "extrapolation",
        "forces",
        "B / particle",
        "B / liquid cell",
    ];
    text += &table(head, &rows);
    text += &beside_warp(quick, python)?;
    Ok(Some(text))
}

/// Table of a falling cube by Warp's example of an APIC fluid, on one thread.
fn beside_warp(quick: bool, python: &Path) -> Result<String, CaseError> {
    if Peer::Warp.version(python).is_none() {
        return Ok(format!("\nWarp is not here to compare with: {}.\n", Peer::Warp.remedy()));
    }
    let (cells, steps) = if quick { (10, 5) } else { (20, 20) };
    let mut command = Command::new(python);
    command.arg(format!("{FOLDER}/warp_fluid.py"));
    command.args(["--cells", &cells.to_string(), "--steps", &steps.to_string()]);
    let found = printed(&mut command)?;
    let number = |key: &str| {
        found[key].as_f64().ok_or_else(|| CaseError::Other(format!("Warp: no number `{key}` in {found}")))
    };
    let theirs = 1e-6 * number("particles")? * number("steps")? / number("seconds")?;
    let schemes: [(&str, Scheme); 2] =
        [("staggered", |o| o), ("semi-staggered", |o| o.semi_staggered(SemiStaggered::default()))];
    let mut rows = Vec::new();
    for (name, scheme) in schemes {
        let ours = 1e-6 * run(cube(scheme, cells)?, 1, steps)?.run.updates_per_second();
        rows.push([
            name.into(),
            format!("{ours:.2}"),
            format!("{theirs:.3}"),
            format!("{:.0}", ours / theirs),
        ]);
    }
    let text = format!(
        "\nA cube of {cells} cells along its edge that falls, {steps} steps of 1/60 s, one thread, beside the example `apic_fluid` of Warp (velocities at nodes, \
         pressure in cells, single precision, matrices assembled, no ghost values at the surface): 10^6 particle-steps a second.\n\n"
    );
    Ok(text + &table(["scheme", "ours", "Warp", "ours / Warp"], &rows))
}
