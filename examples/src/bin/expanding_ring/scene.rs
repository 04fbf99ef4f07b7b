//! Axisymmetric ring of square section, by material points or by finite elements.

use std::path::Path;

use examples::{CaseError, Restart, Totals};
use fem::{Fem, MeshBody};
use mpm_core::geometry::structured::box_mesh;
use mpm_core::geometry::{Cuboid, Filling, Lattice, fill};
use mpm_core::observe::{HistoryCsv, Ledger, Observer, Pace, Progress, RunView, VtkSeries};
use mpm_core::{Axisymmetric, BlockGrid, Body, Method, Mpm, Solver, Team};

use crate::setup::{Means, Setup, law};
use crate::theory::{self, Rest};

/// Number of history rows until the ring rests.
const ROWS: f64 = 400.0;
/// End of a run over the theoretical time to rest.
const END: f64 = 1.1;

/// Row of a history.
#[derive(Clone, Copy, Debug, Default)]
pub struct Row {
    pub time: f64,
    /// Radius, m: r0 exp(<ln r / r0>), mean by mass.
    pub radius: f64,
    /// Mean radial velocity, m/s.
    pub speed: f64,
}

/// Result of a run.
#[derive(Clone, Debug)]
pub struct Outcome {
    pub setup: Setup,
    pub rows: Vec<Row>,
    /// Radius and time at rest.
    pub rest: Rest,
    /// Hoop stress at nine tenths of the time, mean by mass over the yield stress.
    pub hoop: f64,
    pub totals: Totals,
}

/// Run the ring, with ParaView frames in a folder.
pub fn expand(
    setup: &Setup,
    files: Option<&Path>,
    folder: &Path,
    restart: &Restart,
) -> Result<Outcome, CaseError> {
    let (r0, t, v) = (setup.radius, setup.thickness, setup.metal.speed);
    let section = Cuboid::new([r0 - 0.5 * t, 0.0], [r0 + 0.5 * t, 0.5 * t])?;
    // Initial velocity of a ring under hoop tension: it thins both ways by half of its elongation. The mean square of the speed is v^2.
    let slope = 0.5 / r0;
    let motion = move |[r, z]: [f64; 2]| [v * (1.0 - slope * (r - r0)), -v * slope * z];
    let scaled = move |x: [f64; 2]| {
        let scale = 1.0 / (1.0 + 2.0 * slope * slope * t * t / 12.0).sqrt();
        motion(x).map(|v| scale * v)
    };
    let team = Team::new(setup.threads)?;
    let middle = mpm_core::Boundary::Symmetry { axis: 1, at: 0.0, side: mpm_core::Side::Above };
    match setup.means {
        Means::Mpm => {
            let h = setup.spacing();
            let lattice = Lattice::new([r0 - 0.5 * t, 0.0], h)?;
            let seeds = fill(&section, &lattice, 2, &Filling::new().axisymmetric())?;
            let mut mpm = Mpm::new(Method::impact(Axisymmetric), BlockGrid::new(lattice));
            mpm.add("ring", law(&setup.metal)?, &seeds, scaled)?;
            mpm.bound(middle)?;
            mpm.set_team(team);
            run(setup, &mut mpm, files, folder, restart)
        }
        Means::Fem => {
            let across = setup.cells as usize;
            let mesh = box_mesh(&section, [across, (across / 2).max(1)])?;
            let mut fem = Fem::new(Axisymmetric);
            fem.add(MeshBody::new("ring", mesh, law(&setup.metal)?).moving(scaled))?;
            fem.bound(middle)?;
            fem.set_team(team);
            run(setup, &mut fem, files, folder, restart)
        }
    }
}

/// Return the means by mass of logarithm of the radius, radial speed and hoop stress.
fn means(body: &dyn Body) -> [f64; 3] {
    let (mut mass, mut sums) = (0.0, [0.0; 3]);
    body.for_each(&mut |p| {
        mass += p.mass;
        for (sum, x) in sums.iter_mut().zip([p.position[0].ln(), p.velocity[0], p.stress[2]]) {
            *sum += p.mass * x;
        }
    });
    sums.map(|x| x / mass)
}

fn run(
    setup: &Setup,
    solver: &mut (dyn Solver + 'static),
    files: Option<&Path>,
    folder: &Path,
    restart: &Restart,
) -> Result<Outcome, CaseError> {
    let expected = theory::elastic(&setup.metal, setup.radius).time;
    let start = solver.bodies().first().map_or([0.0; 3], |body| means(*body))[0];
    let radius = setup.radius;
    let columns =
        [("time", "s"), ("radius", "m"), ("speed", "m/s"), ("hoop stress", "Pa"), ("kinetic energy", "J")];
    let path = folder.join(format!("ring_{}.csv", setup.name()));
    let pace = Pace::interval(expected / ROWS)?;
    let mut history = HistoryCsv::create(path, columns, pace, move |now: &RunView<'_>| {
        let body = now.bodies().first().map_or([f64::NAN; 3], |body| means(*body));
        Ok(vec![now.time(), radius * (body[0] - start).exp(), body[1], body[2], now.totals().kinetic])
    })?;
    let mut ledger = Ledger::new(Pace::interval(expected / 50.0)?);
    let mut bar = Progress::new(setup.name());
    let mut frames = None;
    if let Some(folder) = files {
        let pace = Pace::interval(expected / 20.0)?;
        frames = Some(VtkSeries::create(folder.join("paraview"), setup.name(), pace)?);
    }
    let mut observers: Vec<&mut dyn Observer> = vec![&mut history, &mut ledger, &mut bar];
    observers.extend(frames.as_mut().map(|f| f as &mut dyn Observer));
    let mut simulation = restart.scene(setup.name())?;
    simulation.until(solver, observers, END * expected)?;
    let all = history.rows();
    let rows: Vec<Row> = all.iter().map(|r| Row { time: r[0], radius: r[1], speed: r[2] }).collect();
    let hoop = all.iter().find(|r| r[0] >= 0.9 * expected).map_or(f64::NAN, |r| r[3]) / setup.metal.yields;
    let totals = Totals::of(solver, &simulation.summary(), &ledger);
    Ok(Outcome { setup: *setup, rest: rest(&rows), rows, hoop, totals })
}

/// Return radius and time at which the mean speed first falls through zero.
fn rest(rows: &[Row]) -> Rest {
    for pair in rows.windows(2) {
        let [a, b] = [pair[0], pair[1]];
        if b.speed <= 0.0 {
            let part = a.speed / (a.speed - b.speed);
            let time = part * (b.time - a.time);
            return Rest { radius: a.radius + 0.5 * a.speed * time, time: a.time + time };
        }
    }
    Rest { radius: f64::NAN, time: f64::NAN }
}
