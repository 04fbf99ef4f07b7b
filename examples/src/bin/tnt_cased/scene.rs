//! Scene and run.
//!
//! Planes of symmetry at x = 0, y = 0 and z = 0. Both bodies share one velocity field, as in the deck: the gas pushes along the normal of
//! the case, without tangential slip.

use std::path::Path;

use examples::{CaseError, Restart, Totals};
use mpm_core::geometry::{Compose, Cuboid, Cylinder, Filling, Lattice, Seeds, Tube, fill};
use mpm_core::observe::{Ledger, LedgerEntry, ObserveError, Observer, Pace, Progress, RunView, VtkSeries};
use mpm_core::output::Snapshot;
use mpm_core::{
    Archive, Blend, BlockGrid, Boundary, CheckpointError, CpGimp, Deformable, FullSpace, Method, Mpm, Musl,
    Side, Solver, Team, TimeControl,
};
use mpm_materials::{Constitutive, Detonation, Explosive, library};

use crate::setup::{CASE, CHARGE, DENSITY, Form, Setup};

/// Width of the burn, cells.
const BURN_WIDTH: f64 = 4.0;
/// Number of rows of a history.
const ROWS: f64 = 120.0;
/// Number of sectors of a quarter.
const SECTORS: usize = 9;
/// Times of the snapshots over the end time.
const LOOKS: [f64; 4] = [0.1, 0.35, 0.7, 1.0];

/// State of the case at one time.
#[derive(Clone, Copy, Debug, Default)]
pub struct Row {
    /// Time, s.
    pub time: f64,
    /// Mean radial speed of the case, from axis or centre, m/s.
    pub speed: f64,
    /// Mean radial speeds of the fastest and slowest sector of ten degrees about z, m/s.
    pub range: [f64; 2],
    /// Mean distance of the case from axis or centre, m.
    pub radius: f64,
    /// Kinetic energy of the gas and of the case in the model, J.
    pub kinetic: [f64; 2],
}

/// Observer of the case.
struct Track {
    pace: Pace,
    form: Form,
    rows: Vec<Row>,
}

impl Observer for Track {
    fn pace(&mut self) -> &mut Pace {
        &mut self.pace
    }
    fn observe(&mut self, now: &RunView<'_>) -> Result<(), ObserveError> {
        let mut row = Row { time: now.time(), range: [0.0, f64::INFINITY], ..Row::default() };
        let mut mass = 0.0;
        let mut sectors = [[0.0; 2]; SECTORS];
        for (index, body) in now.bodies().iter().enumerate() {
            body.for_each(&mut |p| {
                let (x, v) = (p.position, p.velocity);
                row.kinetic[index] += 0.5 * p.mass * (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
                if index == 0 {
                    return;
                }
                let axes = if self.form == Form::Cylinder { 2 } else { 3 };
                let radius = x[..axes].iter().map(|x| x * x).sum::<f64>().sqrt();
                let speed = (0..axes).map(|d| x[d] * v[d]).sum::<f64>() / radius;
                mass += p.mass;
                row.speed += p.mass * speed;
                row.radius += p.mass * radius;
                let angle = x[1].atan2(x[0]) / std::f64::consts::FRAC_PI_2;
                let sector = &mut sectors[((angle * SECTORS as f64) as usize).min(SECTORS - 1)];
                *sector = [sector[0] + p.mass, sector[1] + p.mass * speed];
            });
        }
        for [m, p] in sectors {
            row.range = [row.range[0].max(p / m), row.range[1].min(p / m)];
        }
        row.speed /= mass;
        row.radius /= mass;
        self.rows.push(row);
        Ok(())
    }
    fn archive(&mut self, file: &mut Archive) -> Result<(), CheckpointError> {
        file.list(&mut self.rows, &Row::default(), |file, row| {
            let Row { time, speed, range, radius, kinetic } = row;
            file.reals([time, speed, radius].into_iter().chain(range).chain(kinetic))
        })
    }
}

/// Results of a run.
pub struct Outcome {
    pub setup: Setup,
    pub rows: Vec<Row>,
    pub snapshots: Vec<Snapshot>,
    /// Mass of gas and case as seeded, over that of the shapes.
    pub masses: [f64; 2],
    /// Chemical energy of the seeds, J.
    pub chemical: f64,
    pub books: LedgerEntry,
    pub totals: Totals,
}

impl Outcome {
    /// Return the last row.
    pub fn last(&self) -> Row {
        self.rows.last().copied().unwrap_or_default()
    }
}

/// Seed charge and case on the lattice, assigned by their centres; seeds of a round charge that the surface cuts have the volume inside it.
fn seeds(setup: &Setup, lattice: &Lattice<3>) -> Result<[Seeds<3>; 2], CaseError> {
    let h = setup.spacing();
    let outer = CHARGE + CASE;
    let cut = Filling::new().partial(4, 0.02);
    Ok(match setup.form {
        Form::Cylinder => {
            let quarter = Cuboid::new([0.0; 3], [outer, outer, h])?;
            let (from, along) = ([0.0, 0.0, -h], [0.0, 0.0, 1.0]);
            let charge = Cylinder::new(from, along, 3.0 * h, CHARGE)?.and(quarter);
            let case = Tube::new(from, along, 3.0 * h, CHARGE, outer)?.and(quarter);
            [fill(&charge, lattice, 2, &cut)?, fill(&case, lattice, 2, &cut)?]
        }
        Form::Cube => {
            let charge = Cuboid::new([0.0; 3], [CHARGE; 3])?;
            let whole = Cuboid::new([0.0; 3], [outer; 3])?;
            let shell = whole.minus(charge);
            [fill(&charge, lattice, 2, &Filling::new())?, fill(&shell, lattice, 2, &Filling::new())?]
        }
    })
}

/// Run the detonation and the expansion of the case.
pub fn burst(setup: &Setup, files: Option<&Path>, restart: &Restart) -> Result<Outcome, CaseError> {
    let h = setup.spacing();
    let lattice = Lattice::new([0.0; 3], h)?;
    let [linear, quadratic] = setup.viscosity;
    let charge =
        Explosive::<f64>::tnt().with_burn_width(BURN_WIDTH)?.with_bulk_viscosity(linear, quadratic)?;
    let case = library::copper_casing().with_bulk_viscosity(linear, quadratic)?;
    let wave = Detonation::new(charge.detonation_speed())?;
    let wave = match setup.form {
        Form::Cylinder => wave.from_line([0.0, 0.0, -h], [0.0, 0.0, 2.0 * h], 0.0)?,
        Form::Cube => wave.from_point([0.0; 3], 0.0)?,
    };
    let lit = |x: [f64; 3]| {
        wave.arrival(x).and_then(|t| charge.lit_after(t).ok()).unwrap_or_else(|| charge.virgin())
    };
    let [gas, metal] = seeds(setup, &lattice)?;
    let memory = Blend::new(setup.memory * h / charge.detonation_speed())?;
    let method = Method::new(CpGimp, memory, Musl, FullSpace);
    let mut mpm = Mpm::new(method, BlockGrid::new(lattice));
    mpm.add_body(Deformable::new("TNT", charge, &gas).in_state(lit))?;
    mpm.add("case", case, &metal, |_| [0.0; 3])?;
    for axis in 0..3 {
        mpm.bound(Boundary::Symmetry { axis, at: 0.0, side: Side::Above })?;
    }
    if setup.form == Form::Cylinder {
        mpm.bound(Boundary::Symmetry { axis: 2, at: h, side: Side::Below })?;
    }
    mpm.set_time_control(TimeControl::Courant { factor: setup.factor, growth: 1.1 })?;
    mpm.set_team(Team::new(setup.threads)?);

    let mut track = Track { pace: Pace::interval(setup.end / ROWS)?, form: setup.form, rows: Vec::new() };
    let mut ledger = Ledger::new(Pace::interval(setup.end / ROWS)?);
    let mut frames = None;
    if let Some(folder) = files {
        ledger = ledger.with_csv(folder.join(format!("ledger_{}.csv", setup.name())))?;
        let pace = Pace::interval(setup.end / 6.0)?;
        frames = Some(VtkSeries::create(folder.join("paraview"), setup.name(), pace)?);
    }
    let mut bar = Progress::new(setup.name());
    let mut simulation = restart.scene(setup.name())?;
    for part in LOOKS {
        let mut observers: Vec<&mut dyn Observer> = vec![&mut track, &mut ledger, &mut bar];
        observers.extend(frames.as_mut().map(|f| f as &mut dyn Observer));
        simulation.until(&mut mpm, observers, part * setup.end)?;
        simulation.keep(|| mpm.snapshot())?;
    }
    let outer = CHARGE + CASE;
    let quarter = std::f64::consts::FRAC_PI_4 * h;
    let shapes = match setup.form {
        Form::Cylinder => [quarter * CHARGE * CHARGE, quarter * (outer * outer - CHARGE * CHARGE)],
        Form::Cube => [CHARGE.powi(3), outer.powi(3) - CHARGE.powi(3)],
    };
    let masses = [0, 1].map(|b| mpm.bodies()[b].totals().mass / (DENSITY[b] * shapes[b]));
    Ok(Outcome {
        setup: *setup,
        rows: track.rows,
        masses,
        chemical: crate::setup::CHEMICAL * gas.measure(),
        books: ledger.entries().last().copied().unwrap_or_default(),
        totals: Totals::of(&mpm, &simulation.summary(), &ledger),
        snapshots: simulation.into_snapshots(),
    })
}
