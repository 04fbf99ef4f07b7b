//! Scene and run.

use std::path::Path;

use examples::{CaseError, Restart, Totals};
use mpm_core::geometry::{Filling, Lattice, Polygon, fill};
use mpm_core::observe::{Ledger, Observer, Pace, Progress, VtkSeries};
use mpm_core::output::Snapshot;
use mpm_core::{
    Apic, BlockGrid, Boundary, Method, Mpm, PlaneStrain, QuadraticBSpline, Side, Solver, Team, Usl,
};

use crate::setup::{BASE, CREST, FAR, GRAVITY, HEIGHT, SHOULDER, Setup, TOE};

/// Displacement from which a slope counts as failed, m: gravity alone moves the crest by an eighth of a metre.
pub const FAILED: f64 = 1.0;

/// Results of a run.
pub struct Outcome {
    pub setup: Setup,
    /// Initial positions of the particles, by number, m.
    pub start: Vec<[f64; 2]>,
    /// Snapshots with a field `moved`, m.
    pub snapshots: Vec<Snapshot>,
    /// Time, s, largest displacement, m, and front of the displaced matter, m.
    pub history: Vec<[f64; 3]>,
    /// Area at the end over its initial value.
    pub area: f64,
    pub totals: Totals,
}

impl Outcome {
    /// True if the slope failed.
    pub fn failed(&self) -> bool {
        self.history.iter().any(|h| h[1] > FAILED)
    }
    /// Return the run-out of the slide beyond the toe, m.
    pub fn run_out(&self) -> f64 {
        self.history.last().map_or(f64::NAN, |h| h[2]) - TOE
    }
    /// Return the largest displacement at the end, m.
    pub fn moved(&self) -> f64 {
        self.history.last().map_or(f64::NAN, |h| h[1])
    }
    /// Return the speed of the fastest particle at the last snapshot, m/s.
    pub fn speed(&self) -> f64 {
        let all = self.snapshots.last().and_then(|s| s.vector("velocity").ok());
        all.map_or(f64::NAN, |v| v.iter().map(|v| v[0].hypot(v[1])).fold(0.0, f64::max))
    }
}

/// Apply gravity; snapshots when the largest displacement first exceeds the given values, m, and at the end. With `until_failed` the run
/// ends at failure.
pub fn slide(
    setup: &Setup,
    looks: &[f64],
    until_failed: bool,
    files: Option<&Path>,
    restart: &Restart,
) -> Result<Outcome, CaseError> {
    let h = setup.spacing;
    let lattice = Lattice::new([0.0, BASE], h)?;
    let method = Method::new(QuadraticBSpline, Apic, Usl, PlaneStrain);
    let mut mpm = Mpm::new(method, BlockGrid::new(lattice));
    let slope = Polygon::new(vec![
        [CREST, BASE],
        [FAR, BASE],
        [FAR, 0.0],
        [TOE, 0.0],
        [SHOULDER, HEIGHT],
        [CREST, HEIGHT],
    ])?;
    let seeds = fill(&slope, &lattice, 2, &Filling::new())?;
    mpm.add("slope", setup.soil()?, &seeds, |_| [0.0; 2])?;
    mpm.bound(Boundary::Wall { axis: 0, at: CREST, side: Side::Above, velocity: 0.0 })?;
    mpm.bound(Boundary::Wall { axis: 0, at: FAR, side: Side::Below, velocity: 0.0 })?;
    mpm.bound(Boundary::Fixed { axis: 1, at: BASE, side: Side::Above })?;
    let ramp = setup.ramp;
    mpm.set_body_force(move |t| [0.0, -GRAVITY * if t < ramp { t / ramp } else { 1.0 }]);
    mpm.set_team(Team::new(setup.threads)?);

    let mut ledger = Ledger::new(Pace::interval(setup.end / 200.0)?);
    let mut bar = Progress::new(setup.name());
    let mut frames = match files {
        Some(folder) => {
            ledger = ledger.with_csv(folder.join(format!("ledger_{}.csv", setup.name())))?;
            Some(VtkSeries::create(folder.join("paraview"), setup.name(), Pace::interval(0.25)?)?)
        }
        None => None,
    };
    let mut simulation = restart.scene(format!("{}_{}", setup.name(), setup.reduction))?;
    let mut history = Vec::new();
    let steps = 150;
    for n in 1..=steps {
        let now = setup.end * f64::from(n) / f64::from(steps);
        let mut observers: Vec<&mut dyn Observer> = vec![&mut ledger, &mut bar];
        observers.extend(frames.as_mut().map(|f| f as &mut dyn Observer));
        simulation.until(&mut mpm, observers, now)?;
        let [most, front] = simulation.note(|| {
            let (mut most, mut front) = (0.0_f64, TOE);
            mpm.bodies()[0].for_each(&mut |p| {
                let moved = way(p.position, seeds.positions[p.number]);
                most = most.max(moved);
                if moved > FAILED {
                    front = front.max(p.position[0]);
                }
            });
            Ok([most, front])
        })?;
        history.push([now, most, front]);
        let over = n == steps || (until_failed && most > FAILED);
        if over || looks.get(simulation.snapshots().len()).is_some_and(|look| most > *look) {
            simulation.keep(|| with_ways(&mpm.snapshot()?, &seeds.positions))?;
        }
        if over {
            break;
        }
    }
    let mut volume = 0.0;
    mpm.bodies()[0].for_each(&mut |p| volume += p.volume);
    let totals = Totals::of(&mpm, &simulation.summary(), &ledger);
    let area = volume / seeds.measure();
    let snapshots = simulation.into_snapshots();
    Ok(Outcome { setup: *setup, start: seeds.positions, snapshots, history, area, totals })
}

fn way(now: [f64; 3], start: [f64; 2]) -> f64 {
    (now[0] - start[0]).hypot(now[1] - start[1])
}

/// Return a copy of the snapshot with a field `moved`, m.
fn with_ways(snapshot: &Snapshot, start: &[[f64; 2]]) -> Result<Snapshot, CaseError> {
    let numbers = snapshot.scalar("particle")?;
    let ways = snapshot.positions().iter().zip(numbers).map(|(x, n)| way(*x, start[*n as usize])).collect();
    Ok(snapshot.clone().with_scalar("moved", ways)?)
}

/// Return the slip surface in the undeformed ground, positions and heights, m: below the deepest point of each column that moved by more
/// than half of the maximum, at the first snapshot.
pub fn slip(outcome: &Outcome) -> Result<Vec<[f64; 2]>, CaseError> {
    let Some(first) = outcome.snapshots.first() else { return Ok(Vec::new()) };
    let (ways, numbers) = (first.scalar("moved")?, first.scalar("particle")?);
    let most = ways.iter().copied().fold(0.0, f64::max);
    let h = outcome.setup.spacing;
    let mut deepest = vec![f64::INFINITY; ((FAR - CREST) / h) as usize + 1];
    for (moved, number) in ways.iter().zip(numbers) {
        let [x, z] = outcome.start[*number as usize];
        if *moved > 0.5 * most {
            let column = &mut deepest[((x - CREST) / h) as usize];
            *column = column.min(z - 0.25 * h);
        }
    }
    let place = |(n, z): (usize, f64)| z.is_finite().then_some([CREST + (n as f64 + 0.5) * h, z]);
    Ok(deepest.into_iter().enumerate().filter_map(place).collect())
}
