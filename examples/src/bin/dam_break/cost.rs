//! Error and cost of shallow flow by three methods.

use examples::cost::{Cost, Kind, Tank};
use examples::{CaseError, FlowRuns, Heap, Totals};
use mpm_core::geometry::{Cuboid, Filling, Lattice, fill};
use mpm_core::observe::{Ledger, Observer, Pace, Progress};
use mpm_core::output::History;

use crate::setup::{GRAVITY, Setup};
use crate::theory::{Release, depth};

/// Sound speed of compressible water over that of the fastest flow, 2 sqrt(g H).
const SOUND: f64 = 10.0;
/// Width of the columns in which depths are measured, over H.
const COLUMN: f64 = 0.25;
/// Depth over H from which errors are evaluated; the front is thinner than cells.
const LEAST: f64 = 0.1;

/// Run a method: mean error of depths over H at the end, in columns that are to be deeper than [`LEAST`].
fn run(setup: &Setup, kind: Kind, runs: &FlowRuns) -> Result<Cost, CaseError> {
    let (end, [_, right]) = (setup.end * setup.second(), setup.tank());
    let column = Release { width: setup.aspect };
    let tank = Tank {
        size: [right, setup.ceiling()],
        spacing: setup.spacing(),
        gravity: GRAVITY,
        sound: SOUND * 2.0 * (GRAVITY * setup.height).sqrt(),
        seeds: &|spacing, per_axis| {
            let shape = Cuboid::new([0.0; 2], [setup.width(), setup.height])?;
            Ok(fill(&shape, &Lattice::new([0.0; 2], spacing)?, per_axis, &Filling::new())?)
        },
        pressure: &|x| setup.pressure() * column.pressure(x.map(|x| x / setup.height)).max(0.0),
    };
    let mut solver = tank.solver(kind)?;
    let name = format!("cost_{}_{}", kind.name(), setup.cells);
    let (mut ledger, mut bar) = (Ledger::new(Pace::interval(0.01 * end)?), Progress::new(&name));
    let mut simulation = runs.restart.scene(&name)?;
    let observers: Vec<&mut dyn Observer> = vec![&mut ledger, &mut bar];
    simulation.until(&mut *solver, observers, end)?;
    let snapshot = simulation.keep(|| solver.snapshot())?;
    let width = COLUMN * setup.height;
    let heap = Heap::new(snapshot, [0.0, right], width);
    let path = runs.folder.join(format!("{name}.csv"));
    let mut file = History::create(path, [("x / (c t)", "-"), ("depth over H", "-"), ("Ritter", "-")])?;
    let (mut sum, mut count) = (0.0, 0u32);
    for (n, height) in heap.heights.iter().enumerate() {
        let place = (heap.middle(n) / setup.height - setup.aspect) / setup.end;
        let (found, exact) = (height / setup.height, depth(place));
        file.push(&[place, found, exact])?;
        if exact > LEAST {
            (sum, count) = (sum + (found - exact).abs(), count + 1);
        }
    }
    let error = sum / f64::from(count);
    Ok(Cost { kind, cells: setup.cells, error, totals: Totals::of(&*solver, &simulation.summary(), &ledger) })
}

/// Run all methods at these numbers of cells over the depth of the reservoir.
pub fn compare(setup: &Setup, cells: &[u32], runs: &FlowRuns) -> Result<Vec<Cost>, CaseError> {
    let mut costs = Vec::new();
    for kind in Kind::ALL {
        for &cells in cells {
            costs.push(run(&Setup { cells, ..*setup }, kind, runs)?);
        }
    }
    Ok(costs)
}
