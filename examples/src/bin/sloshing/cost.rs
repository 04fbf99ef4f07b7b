//! Error and cost of a standing wave by three methods.

use std::f64::consts::PI;

use examples::cost::{Cost, Kind, Tank};
use examples::{CaseError, FlowRuns, Totals};
use mpm_core::geometry::{Cuboid, Filling, Lattice, Seeds, fill};
use mpm_core::observe::{HistoryCsv, Ledger, Observer, Pace, Progress, RunView};

use crate::setup::{DENSITY, GRAVITY, Setup};
use crate::theory::Mode;

/// Number of periods over which errors are evaluated.
const PERIODS: f64 = 2.0;
/// Number of history rows of a run.
const ROWS: f64 = 200.0;
/// Sound speed of compressible liquids over sqrt(g H).
const SOUND: f64 = 10.0;

/// Particles of the wave: columns are stretched to its elevation.
fn seeds(setup: &Setup, spacing: f64, per_axis: usize) -> Result<Seeds<2>, CaseError> {
    let Setup { length, depth, amplitude, .. } = *setup;
    let lattice = Lattice::new([0.0; 2], spacing)?;
    let mut seeds = fill(&Cuboid::new([0.0; 2], [length, depth])?, &lattice, per_axis, &Filling::new())?;
    let k = Mode::new(1, setup).wave_number;
    for (x, volume) in seeds.positions.iter_mut().zip(&mut seeds.volumes) {
        let stretch = 1.0 + amplitude / depth * (k * x[0]).cos();
        (x[1], *volume) = (x[1] * stretch, *volume * stretch);
    }
    Ok(seeds)
}

/// Pressure of an incompressible liquid at the release, Pa: hydrostatics of the mean surface, and a harmonic function that is that of the
/// elevation at the surface and has no gradient across walls and floor.
fn released(setup: &Setup, [x, y]: [f64; 2]) -> f64 {
    let (Setup { depth, amplitude, .. }, k) = (*setup, Mode::new(1, setup).wave_number);
    let wave = amplitude * (k * x).cos() * (k * y).cosh() / (k * depth).cosh();
    (DENSITY * GRAVITY * (depth - y + wave)).max(0.0)
}

/// Amplitude of the mode, m: projection of the mass.
fn amplitude(setup: &Setup, now: &RunView<'_>) -> f64 {
    let [mut sum, mut mass] = [0.0; 2];
    if let Some(body) = now.bodies().first() {
        body.for_each(&mut |p| {
            sum += p.mass * (PI / setup.length * p.position[0]).cos();
            mass += p.mass;
        });
    }
    2.0 * setup.depth * sum / mass
}

/// Run two periods: root-mean-square deviation of the amplitude from linear theory, over its initial value.
fn run(setup: &Setup, kind: Kind, runs: &FlowRuns) -> Result<Cost, CaseError> {
    let mode = Mode::new(1, setup);
    let end = PERIODS * mode.period();
    let tank = Tank {
        size: [setup.length, 3.0 * setup.depth],
        spacing: setup.spacing(),
        gravity: GRAVITY,
        sound: SOUND * (GRAVITY * setup.depth).sqrt(),
        seeds: &|spacing, per_axis| seeds(setup, spacing, per_axis),
        pressure: &|x| released(setup, x),
    };
    let mut solver = tank.solver(kind)?;
    let name = format!("cost_{}_{}", kind.name(), setup.cells);
    let columns = [("time", "s"), ("amplitude of the mode", "m"), ("linear theory", "m")];
    let exact = |t: f64| setup.amplitude * (mode.frequency() * t).cos();
    let path = runs.folder.join(format!("{name}.csv"));
    let measure = |now: &RunView<'_>| Ok(vec![now.time(), amplitude(setup, now), exact(now.time())]);
    let mut history = HistoryCsv::create(path, columns, Pace::interval(end / ROWS)?, measure)?;
    let (mut ledger, mut bar) = (Ledger::new(Pace::interval(end / ROWS)?), Progress::new(&name));
    let mut simulation = runs.restart.scene(&name)?;
    let observers: Vec<&mut dyn Observer> = vec![&mut history, &mut ledger, &mut bar];
    simulation.until(&mut *solver, observers, end)?;
    let squares = history.rows().iter().map(|row| (row[1] - row[2]).powi(2)).sum::<f64>();
    let error = (squares / history.rows().len() as f64).sqrt() / setup.amplitude;
    Ok(Cost { kind, cells: setup.cells, error, totals: Totals::of(&*solver, &simulation.summary(), &ledger) })
}

/// Run all methods at these numbers of cells over the length.
pub fn compare(setup: &Setup, cells: &[u32], runs: &FlowRuns) -> Result<Vec<Cost>, CaseError> {
    let mut costs = Vec::new();
    for kind in Kind::ALL {
        for &cells in cells {
            costs.push(run(&Setup { cells, ..*setup }, kind, runs)?);
        }
    }
    Ok(costs)
}
