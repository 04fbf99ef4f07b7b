//! Scenes and runs.

use std::path::Path;
use std::sync::Arc;

use examples::{CaseError, Restart, Totals, Water, largest};
use fem::{Fem, MeshBody, Technology};
use flow::{Flow, FlowOptions, Fluid, RigidBody, Wall};
use mpm_core::geometry::structured::wedge_mesh;
use mpm_core::geometry::{Cuboid, ElementKind, Filling, Lattice, Polygon, fill};
use mpm_core::observe::{Ledger, LedgerEntry, Observer, Pace, Progress, VtkSeries};
use mpm_core::output::Snapshot;
use mpm_core::{BlockGrid, Boundary, Mpm, PlaneStrain, Side, Solver, Team};
use mpm_materials::{LinearElastic, Moduli};

use crate::setup::{DENSITY, HALF, Method, POOL, Setup};
use crate::track::{Row, Track};

/// Number of rows of a history.
const ROWS: f64 = 100.0;
/// Poisson's ratio of the wedge.
const POISSON: f64 = 0.3;

/// Results of a run.
pub struct Outcome {
    pub setup: Setup,
    pub snapshot: Snapshot,
    pub rows: Vec<Row>,
    /// Positions along the wedge over V t, and mean pressures over the stagnation pressure.
    pub pressures: Vec<[f64; 2]>,
    pub totals: Totals,
    pub ledger: Vec<LedgerEntry>,
}

impl Outcome {
    /// Return the force over rho V^3 t, both halves, between two rows.
    fn factor_between(&self, from: usize, to: usize) -> f64 {
        let (a, b) = (self.rows[from], self.rows[to]);
        self.setup.factor(b.impulse - a.impulse, [a.time, b.time])
    }
    /// Return the force over rho V^3 t, both halves, at the rows, as means over an even
    /// number of intervals, since pressures of single steps of incompressible flow alternate.
    pub fn factors(&self) -> Vec<[f64; 2]> {
        const OVER: usize = 6;
        let middle = |n: usize| 0.5 * (self.rows[n - OVER].time + self.rows[n].time);
        (OVER..self.rows.len()).map(|n| [middle(n), self.factor_between(n - OVER, n)]).collect()
    }
    /// Return the force over rho V^3 t, both halves, in the last half of the run.
    pub fn factor(&self) -> f64 {
        self.factor_between(self.rows.len() / 2, self.rows.len() - 1)
    }
    /// Return the largest number of particles in the wedge at one time.
    pub fn inside(&self) -> usize {
        self.rows.iter().map(|r| r.inside).max().unwrap_or(0)
    }
    /// Return the largest penetration of a particle, over its size: centres of particles in contact are half of that away.
    pub fn depth(&self) -> f64 {
        self.deepest() / self.setup.particle() + 0.5
    }
    /// Return the depth of the deepest centre of a particle in the wedge, m.
    pub fn deepest(&self) -> f64 {
        self.rows.iter().map(|r| r.depth).fold(f64::NEG_INFINITY, f64::max)
    }
    /// Return energy removed and added by the method, over the work of the wedge.
    pub fn energy_errors(&self) -> [f64; 2] {
        let (Some(first), Some(last)) = (self.ledger.first(), self.ledger.last()) else {
            return [f64::NAN; 2];
        };
        let errors = || self.ledger.iter().map(|e| (e.total - first.total) / last.work);
        [largest(errors().map(|e| -e)), largest(errors())]
    }
}

fn symmetry() -> Boundary<2> {
    Boundary::Symmetry { axis: 0, at: 0.0, side: Side::Above }
}

/// Build the right half of the wedge, its keel on the water. All its nodes have a constant velocity, or those of its deck only.
fn wedge(setup: &Setup) -> Result<Fem<2>, CaseError> {
    let height = setup.height();
    let mesh = wedge_mesh([[0.0, 0.0], [HALF, height], [0.0, height]], setup.count(), ElementKind::Quad4)?;
    let held = mesh.nodes_where(|x| setup.young.is_none() || x[1] > height * (1.0 - 1e-9));
    let mesh = mesh.with_node_set("held", held)?;
    // Waves in a rigid wedge, which have no physical meaning, must not limit the time step.
    let young = setup.young.unwrap_or(DENSITY * (0.2 * setup.water().sound).powi(2));
    let law = LinearElastic::new(DENSITY, Moduli::young_poisson(young, POISSON)?)?;
    let (speed, mut fem) = (setup.speed, Fem::new(PlaneStrain));
    let body = MeshBody::new("wedge", mesh, law).with(ElementKind::Quad4, Technology::MeanDilatation);
    let body = fem.add(body.moving(move |_| [0.0, -speed]))?;
    fem.bound(symmetry())?;
    // The velocity of a rigid wedge is zero across, too; the deck of an elastic one is free across.
    let across = setup.young.is_none().then_some(0.0);
    fem.prescribe(body, "held", Arc::new(move |_| [across, Some(-speed), None]))?;
    Ok(fem)
}

/// Build the scene at the time of first contact of the keel.
fn scene(setup: &Setup) -> Result<Mpm<2>, CaseError> {
    let lattice = Lattice::new([0.0; 2], setup.spacing())?;
    let mut mpm = setup.coupling.plane_scene(Water::method(setup.transfer), BlockGrid::new(lattice), 0.0)?;
    let [width, depth] = POOL.map(|size| size * HALF);
    let seeds = fill(&Cuboid::new([0.0, -depth], [width, 0.0])?, &lattice, 2, &Filling::new())?;
    mpm.add("water", setup.water().law()?, &seeds, |_| [0.0; 2])?;
    mpm.add_client(setup.coupling.elements(wedge(setup)?, 0.0)?)?;
    mpm.bound(symmetry())?;
    mpm.bound(Boundary::Symmetry { axis: 0, at: width, side: Side::Below })?;
    mpm.bound(Boundary::Symmetry { axis: 1, at: -depth, side: Side::Above })?;
    mpm.set_team(Team::new(setup.threads)?);
    Ok(mpm)
}

/// Build the scene of incompressible water, the whole wedge held at its velocity.
fn incompressible(setup: &Setup) -> Result<Flow<2>, CaseError> {
    let mut flow = Flow::new(FlowOptions::new(Lattice::new([0.0; 2], setup.spacing())?));
    let [width, depth] = POOL.map(|size| size * HALF);
    flow.add_wall(Wall::container(Cuboid::new([-width, -depth], [width, width])?))?;
    let pool = Cuboid::new([-width, -depth], [width, 0.0])?;
    flow.add_shape("water", Fluid::new(Water::DENSITY)?, &pool, 2, |_| [0.0; 2])?;
    let wedge = RigidBody::new(Polygon::new(setup.corners(0.0))?, DENSITY)?;
    let wedge = wedge.with_velocity([0.0, -setup.speed]).holding([true; 2]).without_turning();
    flow.add_rigid("wedge", wedge)?;
    flow.set_team(Team::new(setup.threads)?);
    Ok(flow)
}

/// Run the water entry.
pub fn enter(setup: &Setup, files: Option<&Path>, restart: &Restart) -> Result<Outcome, CaseError> {
    match setup.method {
        Method::Mpm => run(setup, &mut scene(setup)?, files, restart),
        Method::Flow => run(setup, &mut incompressible(setup)?, files, restart),
    }
}

fn run(
    setup: &Setup,
    solver: &mut (dyn Solver + 'static),
    files: Option<&Path>,
    restart: &Restart,
) -> Result<Outcome, CaseError> {
    let row = setup.end() / ROWS;
    // Steps of incompressible flow are about as long as the rows; pressures of single steps alternate.
    let pace = || if setup.method == Method::Flow { Ok(Pace::every_step()) } else { Pace::interval(row) };
    let mut ledger = Ledger::new(pace()?);
    let mut track = Track::new(pace()?, setup);
    let mut bar = Progress::new(setup.name());
    let mut frames = match files {
        Some(folder) => {
            ledger = ledger.with_csv(folder.join(format!("ledger_{}.csv", setup.name())))?;
            let pace = Pace::interval(setup.end() / 40.0)?;
            Some(VtkSeries::create(folder.join("paraview"), setup.name(), pace)?)
        }
        None => None,
    };
    let mut simulation = restart.scene(setup.name())?;
    let mut observers: Vec<&mut dyn Observer> = vec![&mut track, &mut ledger, &mut bar];
    observers.extend(frames.as_mut().map(|f| f as &mut dyn Observer));
    simulation.until(solver, observers, setup.end())?;
    let snapshot = simulation.keep(|| solver.snapshot())?.clone();
    Ok(Outcome {
        setup: *setup,
        snapshot,
        pressures: track.pressures(),
        rows: track.rows,
        totals: Totals::of(solver, &simulation.summary(), &ledger),
        ledger: ledger.entries().to_vec(),
    })
}
