//! Taylor bar by finite elements.

use clap::ValueEnum;
use examples::{CaseError, Simulation, Totals};
use fem::{Fem, MeshBody, Technology};
use mpm_core::geometry::structured::{Butterfly, box_mesh, cylinder_mesh};
use mpm_core::geometry::{Cuboid, Cylinder, ElementKind, ElementMesh};
use mpm_core::observe::{HistoryCsv, Ledger, Observer, Pace, Progress, RunView};
use mpm_core::{Axisymmetric, Boundary, Embedding, FullSpace, PlaneStrain, Side, Solver, Team};

use crate::beside::{Bar, Outcome, copper};
use crate::scene::{END, Files, HISTORY, LENGTH, RADIUS, Space, sizes_of};

/// How elements are integrated.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Integration {
    /// Squares and bricks with one point, springs against hourglass modes
    OnePoint,
    /// Squares and bricks with two points an axis and the mean dilatation
    MeanDilatation,
    /// Squares cut to triangles and bricks cut to tetrahedra, with volumes averaged over nodes
    Simplices,
}

impl Integration {
    /// Return the name in tables.
    fn name(self) -> &'static str {
        match self {
            Integration::OnePoint => "fem of one point",
            Integration::MeanDilatation => "fem",
            Integration::Simplices => "fem of simplices",
        }
    }
}

/// Run the impact of the bar on the wall.
pub fn impact(bar: Bar, integration: Integration, files: Option<Files>) -> Result<Outcome, CaseError> {
    let simplices = integration == Integration::Simplices;
    let counts = [bar.cells as usize, (f64::from(bar.cells) * LENGTH / RADIUS).round() as usize];
    let section = || -> Result<_, CaseError> {
        let mesh = box_mesh(&Cuboid::new([0.0; 2], [RADIUS, LENGTH])?, counts)?;
        Ok(if simplices { mesh.split_to_triangles()? } else { mesh })
    };
    match bar.space {
        Space::PlaneStrain => run(bar, PlaneStrain, section()?, integration, files),
        Space::Axisymmetric => run(bar, Axisymmetric, section()?, integration, files),
        Space::Quarter => {
            let mesh = quarter(bar.cells, counts[1])?;
            let mesh = if simplices { mesh.split_to_tetrahedra()? } else { mesh };
            run(bar, FullSpace, mesh, integration, files)
        }
    }
}

/// Mesh a quarter of the bar in three dimensions by bricks.
pub fn quarter(across: u32, along: usize) -> Result<ElementMesh<3>, CaseError> {
    let whole = Cylinder::new([0.0; 3], [0.0, 0.0, 1.0], LENGTH, RADIUS)?;
    let mesh = cylinder_mesh(&whole, Butterfly::of_edge(RADIUS, RADIUS / f64::from(across))?, along)?;
    let inside = |nodes: &[u32]| {
        let sum = |d: usize| nodes.iter().map(|&n| mesh.nodes[n as usize][d]).sum::<f64>();
        sum(0) > 0.0 && sum(1) > 0.0
    };
    let kept: Vec<Vec<bool>> = mesh.blocks.iter().map(|b| b.elements().map(inside).collect()).collect();
    Ok(mesh.part(&|block, element| kept[block][element])?)
}

/// Run the bar along the last axis, with planes of symmetry normal to the others.
fn run<const D: usize, E: Embedding<D>>(
    bar: Bar,
    embedding: E,
    mesh: ElementMesh<D>,
    integration: Integration,
    files: Option<Files>,
) -> Result<Outcome, CaseError> {
    let axis = D - 1;
    let ends = [0.0, LENGTH].map(|at| mesh.nodes_where(|x| (x[axis] - at).abs() < 1e-6 * LENGTH));
    let mut velocity = [0.0; D];
    velocity[axis] = -bar.speed;
    let mut body = MeshBody::new("bar", mesh, copper()?).moving(move |_| velocity);
    if integration == Integration::MeanDilatation {
        for kind in [ElementKind::Quad4, ElementKind::Hexa8] {
            body = body.with(kind, Technology::MeanDilatation);
        }
    }
    let mut fem = Fem::new(embedding);
    fem.add(body)?;
    for plane in 0..axis {
        fem.bound(Boundary::Symmetry { axis: plane, at: 0.0, side: Side::Above })?;
    }
    fem.bound(Boundary::Wall { axis, at: 0.0, side: Side::Above, velocity: 0.0 })?;
    fem.set_team(Team::new(bar.threads)?);
    let (method, label) =
        (integration.name(), format!("{}_{}", integration.name().replace(' ', "_"), bar.space.name()));
    let mut ledger = Ledger::new(Pace::interval(HISTORY)?);
    let mut progress = Progress::new(format!("{method:<28}"));
    let mut observers: Vec<&mut dyn Observer> = vec![&mut ledger, &mut progress];
    let mut history = files.map(|f| history::<D>(f, &label, ends.clone())).transpose()?;
    observers.extend(history.iter_mut().map(|h| h as &mut dyn Observer));
    let mut series = files.map(|f| f.series(&label)).transpose()?.flatten();
    observers.extend(series.iter_mut().map(|s| s as &mut dyn Observer));
    let mut simulation = files.map_or_else(|| Ok(Simulation::alone()), |f| f.restart.scene(label))?;
    simulation.until(&mut fem, observers, END)?;
    let totals = Totals::of(&fem, &simulation.summary(), &ledger);
    Ok(Outcome {
        method,
        bar,
        sizes: sizes(&fem, &ends),
        broke: None,
        hourglass: Some(fem.body(0).hourglass_energy() / fem.body(0).internal_energy()),
        snapshot: fem.snapshot()?,
        totals,
    })
}

/// Return length and radius of the face, m, from the nodes of both ends.
fn sizes<const D: usize>(fem: &Fem<D>, [foot, top]: &[Vec<u32>; 2]) -> [f64; 2] {
    sizes_of([foot, top], |&n| fem.body(0).nodes()[n as usize].position)
}

/// Create the history of a bar with these ends.
fn history<const D: usize>(
    files: Files,
    label: &str,
    ends: [Vec<u32>; 2],
) -> Result<impl Observer + use<D>, CaseError> {
    let columns = [
        ("time", "s"),
        ("length", "m"),
        ("face radius", "m"),
        ("kinetic energy", "J"),
        ("internal energy", "J"),
        ("energy of hourglass forces", "J"),
        ("work of the wall", "J"),
    ];
    let path = files.folder.join(format!("history_{label}.csv"));
    Ok(HistoryCsv::create(path, columns, Pace::interval(HISTORY)?, move |now: &RunView<'_>| {
        let fem = now.solver_as::<Fem<D>>()?;
        let [length, radius] = sizes(fem, &ends);
        Ok(vec![
            now.time(),
            length,
            radius,
            now.totals().kinetic,
            now.totals().internal,
            fem.body(0).hourglass_energy(),
            now.exchange().work,
        ])
    })?)
}
