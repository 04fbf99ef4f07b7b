//! Taylor bar by the fragile points method without cracks; its cells are the elements of the other methods.

use std::sync::Arc;

use examples::{CaseError, Simulation, Totals};
use fpm::{Cells, Fpm, Method, Penalty, Space as Fragile};
use mpm_core::geometry::structured::box_mesh;
use mpm_core::geometry::{Cuboid, ElementMesh};
use mpm_core::observe::{HistoryCsv, Ledger, Observer, Pace, Progress, RunView};
use mpm_core::{Boundary, FullSpace, PlaneStrain, RunError, Side, Solver, Team};

use crate::beside::{Bar, Outcome, copper};
use crate::elements::quarter;
use crate::scene::{END, Files, HISTORY, LENGTH, RADIUS, Space, sizes_of};

/// Name of the method in tables.
pub const NAME: &str = "fpm";

/// Corner of a cell: sorted index of the cell, and position of the corner in the reference configuration, m.
type Corner<const D: usize> = (usize, [f64; D]);

/// Run the impact of the bar; fragile points are not available in axisymmetric scenes.
pub fn impact(bar: Bar, eta: f64, files: Option<Files>) -> Result<Outcome, CaseError> {
    let along = (f64::from(bar.cells) * LENGTH / RADIUS).round() as usize;
    match bar.space {
        Space::Quarter => run(bar, eta, FullSpace, &quarter(bar.cells, along)?, files),
        Space::PlaneStrain | Space::Axisymmetric => {
            let section = Cuboid::new([0.0; 2], [RADIUS, LENGTH])?;
            run(bar, eta, PlaneStrain, &box_mesh(&section, [bar.cells as usize, along])?, files)
        }
    }
}

/// Run the bar along the last axis, with planes of symmetry normal to the others.
fn run<const D: usize, E: Fragile<D> + std::fmt::Debug>(
    bar: Bar,
    eta: f64,
    embedding: E,
    mesh: &ElementMesh<D>,
    files: Option<Files>,
) -> Result<Outcome, CaseError> {
    let axis = D - 1;
    let cells = Cells::of_mesh(mesh).map_err(|error| CaseError::Other(error.to_string()))?;
    let method = Method::symmetric(embedding).with_penalty(Penalty::new(eta)?);
    let mut velocity = [0.0; D];
    velocity[axis] = -bar.speed;
    let mut body = Fpm::new(method, copper()?, &cells, |_| velocity)?.named("bar");
    for plane in 0..axis {
        body.bound(Boundary::Symmetry { axis: plane, at: 0.0, side: Side::Above })?;
    }
    body.bound(Boundary::Wall { axis, at: 0.0, side: Side::Above, velocity: 0.0 })?;
    body.set_team(Team::new(bar.threads)?);
    let corners = |at: f64| -> Vec<Corner<D>> {
        let numbered = body.numbers().iter().enumerate();
        let all = numbered.flat_map(|(i, &n)| cells.corners(n as usize).iter().map(move |&x| (i, x)));
        all.filter(|(_, x)| (x[axis] - at).abs() < 1e-6 * LENGTH).collect()
    };
    let ends = Arc::new([corners(0.0), corners(LENGTH)]);
    let label = format!("{NAME}_{}", bar.space.name());
    let mut ledger = Ledger::new(Pace::interval(HISTORY)?);
    let mut progress = Progress::new(format!("{NAME:<28}"));
    let mut observers: Vec<&mut dyn Observer> = vec![&mut ledger, &mut progress];
    let mut history = None;
    if let Some(files) = files {
        let columns = [
            ("time", "s"),
            ("length", "m"),
            ("face radius", "m"),
            ("kinetic energy", "J"),
            ("internal energy", "J"),
            ("energy of the penalty", "J"),
            ("work of the wall", "J"),
        ];
        let path = files.folder.join(format!("history_{label}.csv"));
        let ends = Arc::clone(&ends);
        let measure = move |now: &RunView<'_>| {
            let body = now.solver_as::<Fpm<D, Of<E>>>()?;
            let [length, radius] = sizes(body, &ends);
            let (totals, work) = (now.totals(), now.exchange().work);
            Ok(vec![now.time(), length, radius, totals.kinetic, totals.internal, body.penalty_energy(), work])
        };
        history = Some(HistoryCsv::create(path, columns, Pace::interval(HISTORY)?, measure)?);
    }
    observers.extend(history.iter_mut().map(|h| h as &mut dyn Observer));
    let mut series = files.map(|f| f.series(&label)).transpose()?.flatten();
    observers.extend(series.iter_mut().map(|s| s as &mut dyn Observer));
    let mut simulation = files.map_or_else(|| Ok(Simulation::alone()), |f| f.restart.scene(label))?;
    // A folding face stops the run, which is a result.
    let broke = match simulation.until(&mut body, observers, END) {
        Ok(()) => None,
        Err(RunError::Step(error)) => Some((body.time(), error.to_string())),
        Err(error) => return Err(error.into()),
    };
    let totals = Totals::of(&body, &simulation.summary(), &ledger);
    Ok(Outcome {
        method: NAME,
        bar,
        sizes: sizes(&body, &ends),
        hourglass: None,
        broke,
        snapshot: body.snapshot()?,
        totals,
    })
}

/// Method of an embedding.
type Of<E> = Method<E, fpm::Symmetric, fpm::NoCracks>;

/// Return length and radius of the face, m, from the corners of cells at both ends.
fn sizes<const D: usize, E: Fragile<D> + std::fmt::Debug>(
    body: &Fpm<D, Of<E>>,
    [foot, top]: &[Vec<Corner<D>>; 2],
) -> [f64; 2] {
    sizes_of::<Corner<D>, D>([foot, top], |&(i, x)| {
        let moved = body.displacement_at(i, x);
        std::array::from_fn(|d| x[d] + moved[d])
    })
}
