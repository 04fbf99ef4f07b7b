//! Scene of charge and case in plane strain, and its run.
//!
//! Both bodies move in one velocity field: the gas pushes along the normal of the case and does not slip along it. A
//! quarter between planes of symmetry is computed, the whole if the case breaks.

use std::path::Path;

use examples::{CaseError, Cased, Fragments, Restart, Totals, mott_strains};
use mpm_core::geometry::{Compose, Cuboid, Disc, Filling, Lattice, Ring, fill};
use mpm_core::observe::{HistoryCsv, Ledger, Observer, Pace, Progress, RunView, VtkSeries};
use mpm_core::output::{ParticleSize, Snapshot};
use mpm_core::{
    Blend, BlockGrid, Boundary, CpGimp, Deformable, Method, Mpm, Musl, PlaneStrain, Side, Solver, Team,
    TimeControl,
};
use mpm_materials::{Constitutive, Detonation, Explosive, JohnsonCookDamage, library};

use crate::setup::{CHARGE, DENSITY, Lit, Setup};

/// Width of the burn front, cells.
const BURN_WIDTH: f64 = 4.0;
/// Number of history rows.
const ROWS: f64 = 200.0;
/// Times of pictures, over the end time.
pub const LOOKS: [f64; 4] = [0.25, 0.5, 0.75, 1.0];
/// Growth of failure strains with the triaxiality s*, b exp(-c s*): b, and c of copper \[M\].
const PRESSED: [f64; 2] = [0.3, 3.0];
/// Largest distance of particles of one piece, over that of neighbours along the case at the mean stretch.
const REACH: f64 = 1.6;

/// Row of a history.
#[derive(Clone, Copy, Debug, Default)]
pub struct Row {
    pub time: f64,
    /// Mean radial speed of the case, m/s.
    pub speed: f64,
    /// Root mean square radius of the case, m.
    pub radius: f64,
    /// Volume of the products over that of the charge, from the position of the case, which keeps its section.
    pub volume: f64,
    /// Kinetic energy of gas and case, J/m.
    pub kinetic: [f64; 2],
    /// Internal energy of gas and case, J/m.
    pub internal: f64,
}

/// Result of a run.
#[derive(Clone, Debug)]
pub struct Outcome {
    pub setup: Setup,
    pub rows: Vec<Row>,
    pub snapshots: Vec<Snapshot>,
    /// Finite differences: rows of time, s, speed, m/s, growth of the outer radius; and the speed at the end with half the zones.
    pub alone: (Vec<[f64; 3]>, f64),
    /// Mass of gas and case as seeded, over that of the shapes.
    pub masses: [f64; 2],
    /// Chemical energy of the seeds, J/m.
    pub chemical: f64,
    pub totals: Totals,
}

impl Outcome {
    /// Return the last row.
    pub fn last(&self) -> Row {
        self.rows.last().copied().unwrap_or_default()
    }
}

/// Upper limit of the end time, s.
const LONGEST: f64 = 60.0e-6;

/// Run finite differences until the products reach the expansion of the run, at about `guess`, s.
fn alone(setup: &Setup, zones: usize, guess: f64) -> Vec<[f64; 3]> {
    let cased = Cased { charge: CHARGE, case: setup.case, from_axis: setup.lit == Lit::Axis, zones };
    let mut end = guess;
    loop {
        let rows = cased.speeds(end);
        let far = rows.iter().position(|r| setup.volume(r[2]) >= setup.expansion);
        match far {
            Some(last) => return rows[..=last].to_vec(),
            None if end >= LONGEST => return rows,
            None => end *= 1.5,
        }
    }
}

/// Run the detonation and the flight of the case.
pub fn burst(
    setup: &Setup,
    files: Option<&Path>,
    folder: &Path,
    restart: &Restart,
) -> Result<Outcome, CaseError> {
    let h = setup.spacing();
    let coarse = alone(setup, setup.zones() / 2, 10.0e-6);
    let [time, half, _] = coarse.last().copied().unwrap_or([LONGEST, f64::NAN, f64::NAN]);
    let rows = alone(setup, setup.zones(), 1.01 * time);
    let end = rows.last().map_or(LONGEST, |r| r[0]);
    let lattice = Lattice::new([0.0; 2], h)?;
    let [linear, quadratic] = setup.viscosity;
    let charge =
        Explosive::<f64>::tnt().with_burn_width(BURN_WIDTH)?.with_bulk_viscosity(linear, quadratic)?;
    let wave =
        Detonation::new(charge.detonation_speed())?.from_line([0.0, 0.0, -h], [0.0, 0.0, 2.0 * h], 0.0)?;
    let lit = |[x, y]: [f64; 2]| {
        let time = match setup.lit {
            Lit::Axis => wave.arrival([x, y, 0.0]),
            // Burnt long before the start.
            Lit::All => Some(-1.0),
        };
        time.and_then(|t| charge.lit_after(t).ok()).unwrap_or_else(|| charge.virgin())
    };
    let outer = setup.outer();
    let whole = setup.breaks.is_some();
    let from = if whole { -outer } else { 0.0 };
    let part = Cuboid::new([from; 2], [outer; 2])?;
    let cut = Filling::new().partial(4, 0.02);
    let gas = fill(&Disc::new([0.0; 2], CHARGE)?.and(part), &lattice, 2, &cut)?;
    let metal = fill(&Ring::new([0.0; 2], CHARGE, outer)?.and(part), &lattice, 2, &cut)?;
    let memory = Blend::new(setup.memory * h / charge.detonation_speed())?;
    let mut mpm = Mpm::new(Method::new(CpGimp, memory, Musl, PlaneStrain), BlockGrid::new(lattice));
    mpm.add_body(Deformable::new("TNT", charge, &gas).in_state(lit))?;
    let case = library::copper_casing();
    match setup.breaks {
        None => mpm.add("case", case.with_bulk_viscosity(linear, quadratic)?, &metal, |_| [0.0; 2])?,
        Some(breaks) => {
            let strains = mott_strains(breaks.strain, breaks.scatter, breaks.seed, setup.sections());
            let most = strains.iter().fold(0.0_f64, |a, &b| a.max(b));
            // Failure strains in tension; at the negative triaxiality under the pressure of the gas they are several times as large.
            let failure = [most, PRESSED[0] * most, -PRESSED[1], 0.0, 0.0];
            let failure = JohnsonCookDamage::new(failure, 1.0)?;
            let law = case.with_failure(failure).with_bulk_viscosity(linear, quadratic)?;
            let weakened = move |x: [f64; 2]| {
                let turn = x[1].atan2(x[0]) / std::f64::consts::TAU;
                let section = ((turn - turn.floor()) * strains.len() as f64) as usize;
                let mut state = law.virgin();
                state.failure.failure_damage = 1.0 - strains[section.min(strains.len() - 1)] / most;
                state
            };
            mpm.add_body(Deformable::new("case", law.compiled(), &metal).in_state(weakened))?;
        }
    }
    if !whole {
        for axis in 0..2 {
            mpm.bound(Boundary::Symmetry { axis, at: 0.0, side: Side::Above })?;
        }
    }
    mpm.set_time_control(TimeControl::Courant { factor: setup.factor, growth: 1.1 })?;
    mpm.set_team(Team::new(setup.threads)?);

    let columns = [
        ("time", "s"),
        ("speed of the case", "m/s"),
        ("radius of the case", "m"),
        ("volume ratio of the products", "-"),
        ("kinetic energy of the gas", "J/m"),
        ("kinetic energy of the case", "J/m"),
        ("internal energy", "J/m"),
    ];
    let start = Solver::bodies(&mpm).get(1).map_or(f64::NAN, |body| mean_of(*body)[1]);
    let path = folder.join(format!("case_{}.csv", setup.name()));
    let mut history =
        HistoryCsv::create(path, columns, Pace::interval(end / ROWS)?, move |now: &RunView<'_>| {
            let [speed, square] = now.bodies().get(1).map_or([f64::NAN; 2], |body| mean_of(*body));
            let kinetic = |n: usize| now.bodies().get(n).map_or(f64::NAN, |body| body.totals().kinetic);
            let volume = (square - start) / (CHARGE * CHARGE) + 1.0;
            Ok(vec![now.time(), speed, square.sqrt(), volume, kinetic(0), kinetic(1), now.totals().internal])
        })?;
    let mut ledger = Ledger::new(Pace::interval(end / ROWS)?);
    let mut frames = None;
    if let Some(folder) = files {
        frames = Some(VtkSeries::create(folder.join("paraview"), setup.name(), Pace::interval(end / 20.0)?)?);
    }
    let mut bar = Progress::new(setup.name());
    let mut simulation = restart.scene(setup.name())?;
    for look in LOOKS {
        let mut observers: Vec<&mut dyn Observer> = vec![&mut history, &mut ledger, &mut bar];
        observers.extend(frames.as_mut().map(|f| f as &mut dyn Observer));
        simulation.until(&mut mpm, observers, look * end)?;
        simulation.keep(|| taken(&mpm))?;
    }
    let row = |r: &Vec<f64>| Row {
        time: r[0],
        speed: r[1],
        radius: r[2],
        volume: r[3],
        kinetic: [r[4], r[5]],
        internal: r[6],
    };
    let quarters = if whole { 4.0 } else { 1.0 } * std::f64::consts::FRAC_PI_4;
    let shapes = [CHARGE * CHARGE, outer * outer - CHARGE * CHARGE].map(|square| quarters * square);
    let masses = [0, 1].map(|b| mpm.bodies()[b].totals().mass / (DENSITY[b] * shapes[b]));
    Ok(Outcome {
        setup: *setup,
        rows: history.rows().iter().map(row).collect(),
        alone: (rows, half),
        masses,
        chemical: CHEMICAL * gas.measure(),
        totals: Totals::of(&mpm, &simulation.summary(), &ledger),
        snapshots: simulation.into_snapshots(),
    })
}

/// Chemical energy of TNT, J/m^3.
const CHEMICAL: f64 = 6.993e9;

/// Return the mean radial speed and the mean square of the radius, by mass.
fn mean_of(body: &dyn mpm_core::Body) -> [f64; 2] {
    let (mut mass, mut sums) = (0.0, [0.0; 2]);
    body.for_each(&mut |p| {
        let [x, v] = [p.position, p.velocity];
        let radius = x[0].hypot(x[1]);
        mass += p.mass;
        sums[0] += p.mass * (x[0] * v[0] + x[1] * v[1]) / radius;
        sums[1] += p.mass * radius * radius;
    });
    sums.map(|s| s / mass)
}

/// Take a snapshot of positions, masses, speeds, numbers of bodies and failure.
fn taken(mpm: &Mpm<2>) -> Result<Snapshot, CaseError> {
    let (mut places, mut sizes) = (Vec::new(), Vec::new());
    let mut columns = [const { Vec::new() }; 4];
    for (n, body) in mpm.bodies().iter().enumerate() {
        body.for_each(&mut |p| {
            places.push(p.position);
            sizes.push(p.drawn_width(2, false));
            let speed = p.velocity[0].hypot(p.velocity[1]);
            let numbers = [p.mass, speed, n as f64, f64::from(u8::from(p.failed))];
            columns.iter_mut().zip(numbers).for_each(|(column, x)| column.push(x));
        });
    }
    let mut snapshot = Snapshot::new(2, mpm.time(), 0, places, ParticleSize::Each(sizes))?;
    for (name, column) in ["mass", "speed", "part", "failed"].into_iter().zip(columns) {
        snapshot = snapshot.with_scalar(name, column)?;
    }
    Ok(snapshot)
}

/// Group the case into pieces; particles of the gas connect to no other.
pub fn pieces(outcome: &Outcome, look: usize) -> Result<Fragments, CaseError> {
    let snapshot = &outcome.snapshots[look];
    let (bodies, failed) = (snapshot.scalar("part")?, snapshot.scalar("failed")?);
    let holds: Vec<bool> = bodies.iter().zip(failed).map(|(&b, &f)| b > 0.5 && f < 0.5).collect();
    let masses = snapshot.scalar("mass")?;
    let all: Vec<(f64, f64)> = snapshot
        .positions()
        .iter()
        .zip(masses)
        .zip(bodies)
        .filter(|&(_, &body)| body > 0.5)
        .map(|((x, &m), _)| (m, m * x[0].hypot(x[1])))
        .collect();
    let radius = all.iter().map(|p| p.1).sum::<f64>() / all.iter().map(|p| p.0).sum::<f64>();
    let reach = REACH * 0.5 * outcome.setup.spacing() * radius / (CHARGE + 0.5 * outcome.setup.case);
    Ok(Fragments::new(snapshot.positions(), masses, &holds, reach))
}
