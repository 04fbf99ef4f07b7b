//! Scene and run.
//!
//! The slab is normal to z, -thickness < z < 0; the rod moves along -z. The model is a quarter, x > 0 and y > 0; the edges are free. Bars
//! are elements embedded in the particles of the slab, or particles of steel in one velocity field with them: both are bonded perfectly.

use std::path::Path;
use std::sync::Arc;

use coupling::Elements;
use examples::{CaseError, Restart, Totals};
use fem::{Fem, MeshBody};
use mpm_contact::Coulomb;
use mpm_core::geometry::{
    Cuboid, ElementBlock, ElementKind, ElementMesh, Filling, Lattice, Seeds, Shape, fill,
};
use mpm_core::observe::{HistoryCsv, Ledger, LedgerEntry, Observer, Pace, Progress, RunView, VtkSeries};
use mpm_core::output::Snapshot;
use mpm_core::{
    BlockGrid, Body, Boundary, Deformable, FullSpace, Method, Mpm, Side, Solver, Team, TimeControl, Traction,
};
use mpm_materials::{J2, LinearElastic, LogarithmicBulk, Moduli, Solid, library};

use crate::setup::{Bars, DENSITY, Load, MASS, POISSON, ROD, Setup, YIELD, YOUNG};

/// Interval between two rows of a history, s.
const HISTORY: f64 = 5.0e-6;
/// Edge of the rod's elements, m.
const EDGE: f64 = 5.0e-3;
/// Simulated time of a slab under blast, s.
const BLAST: f64 = 1.0e-3;

/// Row of a history.
#[derive(Clone, Copy, Debug, Default)]
pub struct Row {
    pub time: f64,
    /// Speed of the rod into the slab, m/s.
    pub speed: f64,
    /// Depth of the rod's tip below the front of the slab, m.
    pub depth: f64,
    /// Deflection of the middle of the back relative to its edge, m.
    pub deflection: f64,
    /// Internal energy of bars and of the slab, J.
    pub internal: [f64; 2],
    /// Fraction of the slab that is fully damaged.
    pub damaged: f64,
}

/// Results of a run.
#[derive(Clone, Debug)]
pub struct Outcome {
    pub setup: Setup,
    pub rows: Vec<Row>,
    pub snapshot: Snapshot,
    /// True if the rod perforated the slab.
    pub through: bool,
    /// Number of nodes of bars, or of particles of steel.
    pub points: usize,
    /// Mass of the bars, kg.
    pub mass: f64,
    /// Largest energy gain over the largest energy of the run.
    pub gained: f64,
    pub totals: Totals,
}

impl Outcome {
    /// Return the last row.
    pub fn last(&self) -> Row {
        self.rows.last().copied().unwrap_or_default()
    }
    /// Return the residual speed, m/s; 0 if the rod stuck.
    pub fn residual(&self) -> f64 {
        if self.through { self.last().speed } else { 0.0 }
    }
    /// Return the largest deflection, m.
    pub fn deflection(&self) -> f64 {
        self.rows.iter().map(|r| r.deflection).fold(0.0, f64::max)
    }
}

/// Elastic, perfectly plastic steel with this density and Young's modulus.
fn steel(density: f64, young: f64) -> Result<Solid<J2<f64>, LogarithmicBulk<f64>>, CaseError> {
    let moduli = [young / (2.0 * (1.0 + POISSON)), young / (3.0 * (1.0 - 2.0 * POISSON))];
    Ok(Solid::new(J2::linear(moduli[0], YIELD, 0.0)?, LogarithmicBulk::new(density, moduli[1])?))
}

/// Mesh the bars by line elements of about a cell.
fn lines(setup: &Setup) -> ElementMesh<3> {
    let parts = (setup.slab[0] / setup.cell()).round().max(1.0) as usize;
    let (mut nodes, mut links) = (Vec::new(), Vec::new());
    for (axis, [across, height]) in setup.bars() {
        for n in 0..=parts {
            let along = setup.slab[0] * n as f64 / parts as f64;
            if n > 0 {
                let last = nodes.len() as u32;
                links.extend([last - 1, last]);
            }
            nodes.push(if axis == 0 { [along, across, height] } else { [across, along, height] });
        }
    }
    let block = ElementBlock { name: "bars".into(), kind: ElementKind::Bar2, nodes: links };
    ElementMesh { nodes, blocks: vec![block], ..ElementMesh::default() }
}

/// Split the seeds into those inside and outside the bars.
fn parted(setup: &Setup, seeds: &Seeds<3>) -> Result<[Seeds<3>; 2], CaseError> {
    let boxes = setup.boxes()?;
    let part = |inside: bool| {
        let chosen =
            (0..seeds.len()).filter(|&n| boxes.iter().any(|b| b.contains(seeds.positions[n])) == inside);
        let (positions, volumes) = chosen.map(|n| (seeds.positions[n], seeds.volumes[n])).unzip();
        Seeds::placed(positions, volumes, seeds.half_size)
    };
    Ok([part(true), part(false)])
}

/// Run the impact or blast.
pub fn hit(
    setup: &Setup,
    files: Option<&Path>,
    folder: &Path,
    restart: &Restart,
) -> Result<Outcome, CaseError> {
    let h = setup.cell();
    let [half, thickness] = setup.slab;
    let lattice = Lattice::new([0.0, 0.0, -thickness], h)?;
    let whole = fill(&Cuboid::new([0.0, 0.0, -thickness], [half, half, 0.0])?, &lattice, 2, &Filling::new())?;
    let resolved = setup.section > 0.0 && setup.bars == Bars::Particles;
    let [bars, slab] = if resolved { parted(setup, &whole)? } else { [whole.clone(), whole] };
    let mut mpm = Mpm::new(Method::impact(FullSpace), BlockGrid::new(lattice));
    let concrete = library::concrete_48().with_bulk_viscosity(0.06, 1.5)?;
    let mut body = Deformable::new("slab", concrete, &slab);
    if setup.load == Load::Blast {
        let [pressure, time, reach] = setup.blast;
        // One layer of particles.
        let front = Cuboid::new([0.0, 0.0, -0.5 * h], [reach, reach, 0.0])?;
        body = body.with_traction(Traction {
            region: Arc::new(front),
            axis: 2,
            history: Arc::new(move |t| [0.0, 0.0, -pressure * (1.0 - t / time).max(0.0)]),
            revolved: false,
        });
    }
    mpm.add_body(body)?;
    let planes = || [0, 1].map(|axis| Boundary::Symmetry { axis, at: 0.0, side: Side::Above });
    let (mut points, mut mass) = (0, 0.0);
    if resolved {
        points = bars.len();
        mass = bars.measure() * DENSITY[1];
        mpm.add("bars", steel(DENSITY[1], YOUNG[1])?, &bars, |_| [0.0; 3])?;
    } else if setup.section > 0.0 {
        // The concrete is not removed at the bars: their law has the difference of the constants of steel and concrete.
        let mesh = lines(setup);
        points = mesh.nodes.len();
        let mut fem = Fem::new(FullSpace);
        let law = steel(DENSITY[1] - DENSITY[0], YOUNG[1] - YOUNG[0])?;
        fem.add(MeshBody::new("bars", mesh, law).section(setup.section))?;
        mass = fem.totals().mass;
        mpm.add_client(Elements::within(fem, "slab")?)?;
    }
    if setup.load == Load::Rod {
        let law = LinearElastic::new(MASS / ROD.volume()?, Moduli::young_poisson(206e9, 0.3)?)?;
        let quarter = |[across, side, _]: [f64; 3]| across < 0.0 && side > 0.0;
        let (mesh, _) = ROD.bricks([0.0, 0.0, 0.25 * h], 0.0, EDGE, quarter)?;
        let mut fem = Fem::new(FullSpace);
        let speed = setup.speed;
        fem.add(MeshBody::new("rod", mesh, law).moving(move |_| [0.0, 0.0, -speed]))?;
        for plane in planes() {
            fem.bound(plane)?;
        }
        mpm.add_client(Elements::by_surface(fem, Coulomb::new(0.0)?)?)?;
    }
    for plane in planes() {
        mpm.bound(plane)?;
    }
    mpm.set_time_control(TimeControl::Courant { factor: setup.factor, growth: 1.1 })?;
    mpm.set_team(Team::new(setup.threads)?);
    run(setup, mpm, (points, mass), files, folder, restart)
}

fn run(
    setup: &Setup,
    mut mpm: Mpm<3>,
    (points, mass): (usize, f64),
    files: Option<&Path>,
    folder: &Path,
    restart: &Restart,
) -> Result<Outcome, CaseError> {
    let columns = [
        ("time", "s"),
        ("speed of the rod", "m/s"),
        ("depth of its tip", "m"),
        ("deflection of the back", "m"),
        ("internal energy of the bars", "J"),
        ("internal energy of the slab", "J"),
        ("damaged part of the slab", "-"),
    ];
    let path = folder.join(format!("{}.csv", setup.name()));
    let ([half, thickness], h) = (setup.slab, setup.cell());
    let (mut middle, mut edge) = (Vec::new(), Vec::new());
    for body in mpm.bodies().iter().filter(|b| b.name() == "slab") {
        body.for_each(&mut |p| {
            let [x, y, z] = p.position;
            if z < -thickness + h && x.max(y) < 2.0 * h {
                middle.push(p.number);
            } else if z < -thickness + h && x.max(y) > half - h {
                edge.push(p.number);
            }
        });
    }
    middle.sort_unstable();
    edge.sort_unstable();
    let lists = [middle, edge];
    // State at rest, which a resumed run does not see again.
    let start = look(&Solver::bodies(&mpm), &lists);
    let pace = Pace::interval(HISTORY)?;
    let mut history = HistoryCsv::create(path, columns, pace, move |now: &RunView<'_>| {
        let Looked { rod: [z, speed], sunk, internal, damaged } = look(&now.bodies(), &lists);
        let [depth, deflection] = [start.rod[0] - z, sunk - start.sunk];
        Ok(vec![now.time(), speed, depth, deflection, internal[0], internal[1], damaged])
    })?;
    let mut ledger = Ledger::new(Pace::interval(HISTORY)?);
    let mut bar = Progress::new(setup.name());
    let mut frames = None;
    if let Some(folder) = files {
        frames = Some(VtkSeries::create(folder.join("paraview"), setup.name(), Pace::interval(100.0e-6)?)?);
    }
    let mut simulation = restart.scene(setup.name())?;
    let out = thickness + ROD.nose() + 0.5 * ROD.length;
    // A rod still in the slab after five times the undecelerated transit time counts as stuck.
    let ends: Vec<f64> = match setup.load {
        Load::Rod => (0..80).map(|n| out / setup.speed * (1.0 + 0.05 * f64::from(n))).collect(),
        Load::Blast => vec![BLAST],
    };
    let mut through = false;
    for end in ends {
        let mut observers: Vec<&mut dyn Observer> = vec![&mut history, &mut ledger, &mut bar];
        observers.extend(frames.as_mut().map(|f| f as &mut dyn Observer));
        simulation.until(&mut mpm, observers, end)?;
        let Some(last) = history.rows().last() else { continue };
        through = setup.load == Load::Rod && last[2] > out;
        if through || (setup.load == Load::Rod && last[1] <= 0.0) {
            break;
        }
    }
    let snapshot = simulation.keep(|| mpm.snapshot())?.clone();
    let row = |r: &Vec<f64>| Row {
        time: r[0],
        speed: r[1],
        depth: r[2],
        deflection: r[3],
        internal: [r[4], r[5]],
        damaged: r[6],
    };
    let rows = history.rows().iter().map(row).collect();
    let totals = Totals::of(&mpm, &simulation.summary(), &ledger);
    let gained = gained(ledger.entries());
    Ok(Outcome { setup: *setup, rows, snapshot, through, points, mass, gained, totals })
}

/// Return the largest energy gain over the largest energy so far. The error in the ledger is relative to the largest energy at that time,
/// which is close to zero when a load begins.
fn gained(entries: &[LedgerEntry]) -> f64 {
    let (mut scale, mut most): (f64, f64) = (0.0, 0.0);
    for entry in entries {
        scale = scale.max(entry.kinetic + entry.internal);
        most = most.max(entry.energy_error * scale);
    }
    most / scale
}

/// Quantities of the bodies at one time.
struct Looked {
    /// Height of the centre of the rod, m, and its speed downwards, m/s.
    rod: [f64; 2],
    /// Depth of the middle of the back below its edge, m.
    sunk: f64,
    /// Internal energy of bars and slab, J.
    internal: [f64; 2],
    /// Fraction of the slab that is fully damaged.
    damaged: f64,
}

/// Evaluate rod, bars and slab. The two sorted lists of particles are the middle and the edge of the back of the slab.
fn look(bodies: &[&dyn Body], lists: &[Vec<usize>; 2]) -> Looked {
    let (mut rod, mut sums, mut whole, mut internal) = ([0.0; 3], [[0.0; 2]; 2], [0.0; 2], [0.0; 2]);
    for body in bodies {
        match body.name() {
            "rod" => body.for_each(&mut |p| {
                let row = [1.0, p.position[2], -p.velocity[2]];
                rod.iter_mut().zip(row).for_each(|(sum, x)| *sum += p.mass * x);
            }),
            "bars" => internal[0] += body.totals().internal,
            _ => {
                internal[1] += body.totals().internal;
                let place = body.state_names().iter().position(|n| n == "damage");
                body.for_each(&mut |p| {
                    whole[0] += p.mass;
                    whole[1] += if place.is_some_and(|d| p.state[d] >= 1.0) { p.mass } else { 0.0 };
                    for (list, sum) in lists.iter().zip(&mut sums) {
                        if list.binary_search(&p.number).is_ok() {
                            *sum = [sum[0] + p.mass, sum[1] + p.mass * p.position[2]];
                        }
                    }
                });
            }
        }
    }
    let [middle, edge] = sums.map(|[mass, z]| z / mass);
    Looked {
        rod: if rod[0] > 0.0 { [rod[1] / rod[0], rod[2] / rod[0]] } else { [0.0; 2] },
        sunk: edge - middle,
        internal,
        damaged: whole[1] / whole[0],
    }
}
