//! Scene of tank, water and gate, and its run.

use std::path::Path;
use std::sync::Arc;

use coupling::ElementsInLiquid;
use examples::{CaseError, Coupling, Restart, Totals, Water, largest};
use fem::{Fem, MeshBody, Technology};
use flow::{Flow, FlowOptions, Fluid, Wall};
use mpm_core::geometry::structured::box_mesh;
use mpm_core::geometry::{Cuboid, ElementKind, ElementMesh, Filling, HalfSpace, Lattice, fill};
use mpm_core::observe::{Ledger, LedgerEntry, Observer, Pace, Progress, VtkSeries};
use mpm_core::output::Snapshot;
use mpm_core::{BlockGrid, Boundary, Deformable, FieldForce, Mpm, PlaneStrain, Side, Solver, Team};
use mpm_materials::{LinearElastic, Moduli};

use crate::setup::{GATE, GRAVITY, Gate, RUBBER, Setup, WALL, WATER};
use crate::track::{Fronts, Row, Track};

/// Number of history rows of a run.
const ROWS: f64 = 200.0;

/// Result of a run.
pub struct Outcome {
    pub setup: Setup,
    pub snapshots: Vec<Snapshot>,
    /// History of the gate.
    pub rows: Vec<Row>,
    /// Mean forces of the water on the gate since the previous row, N/m.
    pub forces: Vec<[f64; 2]>,
    /// Time, s, and position of the front, m, without a gate.
    pub fronts: Vec<[f64; 2]>,
    /// Mass at the end over that at the start.
    pub mass: f64,
    pub totals: Totals,
    pub ledger: Vec<LedgerEntry>,
}

impl Outcome {
    /// Energy lost and energy gained by the method, over the potential energy of the water.
    pub fn energy_errors(&self) -> [f64; 2] {
        let first = self.ledger.first().map_or(f64::NAN, |e| e.total);
        let errors = || self.ledger.iter().map(|e| (e.total - first) / self.setup.potential());
        [largest(errors().map(|e| -e)), largest(errors())]
    }
}

fn floor() -> Boundary<2> {
    Boundary::Wall { axis: 1, at: 0.0, side: Side::Above, velocity: 0.0 }
}

/// Mesh the gate and, above its clamp, the wall that carries it, up to its height.
fn mesh(setup: &Setup) -> Result<ElementMesh<2>, CaseError> {
    let edge = GATE[1] / f64::from(setup.layers);
    let [free, held] = [GATE[0], WALL - GATE[0]].map(|length| (length / edge).round() as usize);
    let rows = free + held;
    let whole = Cuboid::new([WATER[0], 0.0], [WATER[0] + GATE[1], rows as f64])?;
    let height = |row: f64| match row - free as f64 {
        beyond if beyond > 0.0 => GATE[0] + beyond / held as f64 * (WALL - GATE[0]),
        beyond => GATE[0] + beyond / free as f64 * GATE[0],
    };
    let mesh = box_mesh(&whole, [setup.layers as usize, rows])?.mapped(|[x, row]| [x, height(row)])?;
    let clamped = mesh.nodes_where(|x| x[1] > GATE[0] - 1e-9);
    Ok(mesh.with_node_set("clamped", clamped)?)
}

/// Build the scene of the gate.
fn gate(setup: &Setup) -> Result<Fem<2>, CaseError> {
    let moduli = Moduli::young_poisson(setup.young(), setup.poisson)?;
    let rubber = LinearElastic::new(setup.scale() * RUBBER, moduli)?;
    let mut fem = Fem::new(PlaneStrain);
    let body =
        MeshBody::new("gate", mesh(setup)?, rubber).with(ElementKind::Quad4, Technology::MeanDilatation);
    let body = fem.add(body)?;
    fem.prescribe(body, "clamped", Arc::new(|_| [Some(0.0), Some(0.0), None]))?;
    if setup.seated {
        fem.bound(floor())?;
    }
    if setup.gate != Gate::Stiff {
        fem.set_body_force(Arc::new(|_| [0.0, -GRAVITY]));
    }
    Ok(fem)
}

/// Build the scene at rest.
fn scene(setup: &Setup) -> Result<Box<dyn Solver>, CaseError> {
    Ok(if setup.gate == Gate::Flow { Box::new(flow(setup)?) } else { Box::new(particles(setup)?) })
}

/// Build the scene of incompressible flow.
fn flow(setup: &Setup) -> Result<Flow<2>, CaseError> {
    let lattice = Lattice::new([0.0; 2], setup.spacing())?;
    let mut flow = Flow::new(FlowOptions::new(lattice));
    for outward in [[1.0, 0.0], [0.0, 1.0]] {
        flow.add_wall(Wall::solid(HalfSpace::new([0.0; 2], outward)?))?;
    }
    flow.add_deformable(ElementsInLiquid::new(gate(setup)?))?;
    let water = Cuboid::new([0.0; 2], setup.size())?;
    flow.add_shape("water", Fluid::new(Water::DENSITY)?, &water, 2, |_| [0.0; 2])?;
    flow.set_body_force(|_| [0.0, -GRAVITY]);
    Solver::set_team(&mut flow, Team::new(setup.threads)?);
    Ok(flow)
}

/// Build the scene of material points.
fn particles(setup: &Setup) -> Result<Mpm<2>, CaseError> {
    let lattice = Lattice::new([0.0; 2], setup.spacing())?;
    let water = setup.water();
    let gate = match setup.gate {
        Gate::None => None,
        _ => Some(setup.coupling.elements(gate(setup)?, 0.0)?),
    };
    let method = Water::method(setup.transfer);
    let mut mpm = setup.coupling.plane_scene(method, BlockGrid::new(lattice), 0.0)?;
    let seeds = fill(&Cuboid::new([0.0; 2], setup.size())?, &lattice, 2, &Filling::new())?;
    let law = water.law()?;
    let weight = FieldForce { acceleration: Arc::new(|_: &[f64; 2], _| [0.0, -GRAVITY]) };
    let pressure = |[_, height]: [f64; 2]| water.under(&law, setup.pressure(height));
    mpm.add_body(Deformable::new("water", law, &seeds).with_field_force(weight).in_state(pressure))?;
    if let Some(gate) = gate {
        mpm.add_client(gate)?;
    }
    mpm.bound(Boundary::Symmetry { axis: 0, at: 0.0, side: Side::Above })?;
    mpm.bound(match setup.coupling {
        Coupling::Surface => Boundary::Symmetry { axis: 1, at: 0.0, side: Side::Above },
        Coupling::Grid => floor(),
    })?;
    mpm.set_team(Team::new(setup.threads)?);
    Ok(mpm)
}

/// Run a scene, with snapshots at these times, s, and at the end.
pub fn run(
    setup: &Setup,
    times: &[f64],
    files: Option<&Path>,
    restart: &Restart,
) -> Result<Outcome, CaseError> {
    let mut solver = scene(setup)?;
    let start = solver.totals().mass;
    let row = setup.end / ROWS;
    let mut ledger = Ledger::new(Pace::interval(row)?);
    let mut track = Track::new(Pace::interval(row)?, setup);
    let mut fronts = Fronts::new(Pace::interval(row)?, setup);
    let mut bar = Progress::new(setup.name());
    let mut frames = match files {
        Some(folder) => {
            ledger = ledger.with_csv(folder.join(format!("ledger_{}.csv", setup.name())))?;
            Some(VtkSeries::create(folder.join("paraview"), setup.name(), Pace::interval(setup.end / 40.0)?)?)
        }
        None => None,
    };
    let mut simulation = restart.scene(setup.name())?;
    let ends = times.iter().copied().chain((times.last() != Some(&setup.end)).then_some(setup.end));
    for end in ends {
        let mut observers: Vec<&mut dyn Observer> = vec![&mut track, &mut fronts, &mut ledger, &mut bar];
        observers.extend(frames.as_mut().map(|f| f as &mut dyn Observer));
        simulation.until(&mut *solver, observers, end)?;
        simulation.keep(|| solver.snapshot())?;
    }
    let forces = (0..track.rows.len()).map(|n| track.force(n)).collect();
    Ok(Outcome {
        setup: *setup,
        rows: track.rows,
        forces,
        fronts: fronts.rows,
        mass: solver.totals().mass / start,
        totals: Totals::of(&*solver, &simulation.summary(), &ledger),
        ledger: ledger.entries().to_vec(),
        snapshots: simulation.into_snapshots(),
    })
}
