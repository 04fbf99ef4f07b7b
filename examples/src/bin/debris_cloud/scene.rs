//! Scene of sphere and plate, and its run.
//!
//! The sphere flies along x into the plate, 0 < x < thickness, and touches it at t = 0. A quarter is computed: y = 0 and
//! z = 0 are planes of symmetry. As in the deck, both move in one velocity field: lead sticks to lead in contact.

use std::path::Path;

use coupling::{Conversion, ConversionBook, Elements};
use examples::{CaseError, Restart, Totals};
use fem::{Criterion, Fem, MeshBody};
use mpm_core::geometry::structured::box_mesh;
use mpm_core::geometry::{Ball, Compose, Cuboid, Filling, Lattice, Seeds, fill};
use mpm_core::observe::{Ledger, Observer, Pace, Progress, VtkSeries};
use mpm_core::output::Snapshot;
use mpm_core::{
    BlockGrid, Boundary, Deformable, FullSpace, Mpm, Side, Solver, SplitBook, Splitting, Team, TimeControl,
};
use mpm_materials::{Constitutive, Stretching};

use crate::parts::{Parts, parts};
use crate::setup::{END, HALF_WIDTH, Plate, RADIUS, SHOCK, SPEED, Setup, THICKNESS, lead};
use crate::track::{Row, Track};

/// Times of pictures, s.
pub const LOOKS: [f64; 4] = [2.0e-6, 10.0e-6, 20.0e-6, END];
/// Time between two rows of a history, s: while the shock is in the plate, and later.
const EARLY: f64 = 0.02e-6;
const HISTORY: f64 = 0.5e-6;

/// Result of a run.
pub struct Outcome {
    pub setup: Setup,
    pub rows: Vec<Row>,
    pub snapshots: Vec<Snapshot>,
    /// Seeds of both bodies.
    pub seeds: usize,
    pub cuts: SplitBook,
    /// Mass at the end over that at the start, and over that of the shapes.
    pub mass: [f64; 2],
    /// Pieces of the material behind the plate at the end.
    pub parts: Parts,
    pub totals: Totals,
    /// Energy at the start, J.
    pub energy: f64,
    /// Conversion book of a plate of elements.
    pub converted: Option<ConversionBook>,
}

impl Outcome {
    /// Return the last row.
    pub fn last(&self) -> Row {
        self.rows.last().copied().unwrap_or_default()
    }
}

/// Run the impact, with ParaView frames in a folder.
pub fn shoot(setup: &Setup, files: Option<&Path>, restart: &Restart) -> Result<Outcome, CaseError> {
    let lattice = Lattice::new([0.0; 3], setup.spacing())?;
    let mut mpm = Mpm::new(setup.method(FullSpace)?, BlockGrid::new(lattice));
    let quarter = Cuboid::new([-2.0 * RADIUS, 0.0, 0.0], [0.0, HALF_WIDTH, HALF_WIDTH])?;
    let ball = Ball::new([-RADIUS, 0.0, 0.0], RADIUS)?.and(quarter);
    let plate = Cuboid::new([0.0; 3], [THICKNESS, setup.half_width, setup.half_width])?;
    let ball = fill(&ball, &lattice, 2, &Filling::new())?;
    let shape = plate;
    let plate = fill(&shape, &lattice, 2, &Filling::new())?;
    let seeds = ball.len() + plate.len();
    let mut add = |name, seeds: &Seeds<3>, speed: f64| -> Result<(), CaseError> {
        let velocity = |_| [speed, 0.0, 0.0];
        match setup.cutting {
            Some(cutting) => {
                let splitting = Splitting::at(cutting.stretch)?.at_most(cutting.generations)?;
                let law = Stretching::new(lead(setup.viscosity)?).compiled();
                mpm.add_body(Deformable::new(name, law, seeds).moving(velocity).with_splitting(splitting))?;
            }
            None => mpm.add(name, lead(setup.viscosity)?.compiled(), seeds, velocity)?,
        }
        Ok(())
    };
    add("sphere", &ball, SPEED)?;
    let mut log = None;
    match setup.method {
        Plate::Mpm => add("plate", &plate, 0.0)?,
        Plate::Afemp => {
            let along = |length: f64| (length / setup.spacing()).round() as usize;
            let side = along(setup.half_width);
            let mesh = box_mesh(&shape, [along(THICKNESS), side, side])?;
            let mut fem = Fem::new(FullSpace);
            fem.add(MeshBody::new("plate", mesh, lead(setup.viscosity)?.compiled()))?;
            let conversion = Conversion::adaptive().or("failure", Criterion::Failed);
            let (elements, conversions) = Elements::converting(fem, "debris", conversion)?;
            mpm.add_client(elements)?;
            log = Some(conversions);
        }
    }
    for axis in [1, 2] {
        mpm.bound(Boundary::Symmetry { axis, at: 0.0, side: Side::Above })?;
    }
    mpm.set_time_control(TimeControl::Courant { factor: setup.factor, growth: 1.1 })?;
    mpm.set_team(Team::new(setup.threads)?);

    let start = mpm.totals();
    let gauge = if setup.method == Plate::Mpm { &plate.positions[..] } else { &[] };
    let mut track = Track::new(Pace::interval(EARLY)?, setup, gauge);
    let mut ledger = Ledger::new(Pace::interval(HISTORY)?);
    let mut frames = None;
    if let Some(folder) = files {
        ledger = ledger.with_csv(folder.join(format!("ledger_{}.csv", setup.name())))?;
        let pace = Pace::interval(END / 6.0)?;
        frames = Some(VtkSeries::create(folder.join("paraview"), setup.name(), pace)?);
    }
    let mut bar = Progress::new(setup.name());
    let mut simulation = restart.scene(setup.name())?;
    for end in LOOKS {
        let mut observers: Vec<&mut dyn Observer> = vec![&mut track, &mut ledger, &mut bar];
        observers.extend(frames.as_mut().map(|f| f as &mut dyn Observer));
        simulation.until(&mut mpm, observers, end)?;
        simulation.keep(|| mpm.snapshot())?;
        track.pace = Pace::interval(HISTORY)?;
    }
    let mut cuts = SplitBook::default();
    for body in mpm.bodies() {
        let Some(division) = body.division() else { continue };
        cuts.cuts += division.splits().cuts;
        cuts.kinetic += division.splits().kinetic;
    }
    let quarter_ball = std::f64::consts::PI / 3.0 * RADIUS.powi(3);
    let shapes = SHOCK[0] * (quarter_ball + THICKNESS * setup.half_width.powi(2));
    let end = mpm.totals().mass;
    let totals = Totals::of(&mpm, &simulation.summary(), &ledger);
    let snapshots = simulation.into_snapshots();
    Ok(Outcome {
        setup: *setup,
        rows: track.rows,
        parts: snapshots.last().map_or(Parts::default(), |s| parts(s, setup.spacing())),
        seeds,
        cuts,
        mass: [end / start.mass, end / shapes],
        snapshots,
        totals,
        energy: start.kinetic,
        converted: log.map(|log| log.book()),
    })
}
