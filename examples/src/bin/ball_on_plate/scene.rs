//! Axisymmetric scene of ball and plate of elements or particles, and its run.

use clap::ValueEnum;
use coupling::Elements;
use examples::blocks::circles::{Part, disc};
use examples::{CaseError, Restart, Totals};
use fem::{Fem, MeshBody};
use mpm_contact::{Coulomb, Pairs, SeparatingPlane, SurfaceDistance};
use mpm_core::geometry::structured::{Butterfly, Spacing, box_mesh, half_disc_mesh};
use mpm_core::geometry::{Cuboid, Disc, ElementMesh, Filling, Lattice, fill};
use mpm_core::observe::{Ledger, Observer, Pace, Progress, VtkSeries};
use mpm_core::output::Snapshot;
use mpm_core::{
    Axisymmetric, BlockGrid, Boundary, Flip, GridContact, Linear, Method, Mpm, Musl, Side, Solver, Team,
};
use mpm_materials::{LinearElastic, Moduli};
use serde::Serialize;

use crate::hertz::Impact;
use crate::track::{Row, Track};

/// What a body is made of.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Matter {
    /// Finite elements
    Elements,
    /// Material points
    Particles,
}

/// How elements meet particles.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Coupling {
    /// Particles meet the facets of the elements (ICFEMP)
    Surface,
    /// Nodes of the elements act on the grid (CFEMP)
    Grid,
}

/// Parameters of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Setup {
    pub ball: Matter,
    pub plate: Matter,
    pub coupling: Coupling,
    pub impact: Impact,
    /// Number of cells, and of elements at the contact, on the largest contact radius.
    pub cells: f64,
    /// Radius and height of the plate over the radius of the ball.
    pub plate_size: f64,
    pub friction: f64,
    pub threads: usize,
}

/// Grading of the elements of a plate away from the contact: length of the first over that of the last.
const GRADING: f64 = 0.1;
/// Time after the end of contact, over Hertz's duration.
const AFTER: f64 = 0.25;
/// Number of history entries over Hertz's duration.
const ENTRIES: f64 = 80.0;

impl Setup {
    /// Name in files.
    pub fn name(&self) -> String {
        let of =
            |matter: Matter| matter.to_possible_value().map_or_else(String::new, |v| v.get_name().into());
        let how = if self.coupling == Coupling::Grid { "_grid" } else { "" };
        format!("{}_on_{}{how}", of(self.ball), of(self.plate))
    }

    /// Name in tables.
    pub fn words(&self) -> String {
        self.name().replace('_', " ").replace(" grid", ", on the grid")
    }

    /// Size of cells, m.
    pub fn spacing(&self) -> f64 {
        self.impact.contact() / self.cells
    }

    /// End of the run, s.
    pub fn end(&self) -> f64 {
        (1.0 + AFTER) * self.impact.duration()
    }

    /// Radius and height of the plate, m, rounded to whole cells.
    fn plate_edge(&self) -> f64 {
        (self.plate_size * self.impact.radius / self.spacing()).round() * self.spacing()
    }

    fn steel(&self) -> Result<LinearElastic<f64>, CaseError> {
        let Impact { density, young, poisson, .. } = self.impact;
        Ok(LinearElastic::new(density, Moduli::young_poisson(young, poisson)?)?)
    }

    /// Mesh the ball, whose lowest point is the origin, with elements as large as cells.
    fn ball_mesh(&self) -> Result<ElementMesh<2>, CaseError> {
        let radius = self.impact.radius;
        Ok(half_disc_mesh(&Disc::new([0.0, radius], radius)?, Butterfly::of_edge(radius, self.spacing())?)?)
    }

    /// Mesh the plate below with elements as large as cells at the contact, throughout for contact on the grid.
    fn plate_mesh(&self) -> Result<ElementMesh<2>, CaseError> {
        let edge = self.plate_edge();
        let shape = Cuboid::new([0.0, -edge], [edge, 0.0])?;
        if self.coupling == Coupling::Grid {
            let count = (edge / self.spacing()).round() as usize;
            return Ok(box_mesh(&shape, [count; 2])?);
        }
        let count = graded(edge / self.spacing());
        Ok(box_mesh(&shape, [Spacing::graded(count, 1.0 / GRADING), Spacing::graded(count, GRADING)])?)
    }
}

/// Return the number of elements, the last 1 / [`GRADING`] times as long as the first, with a total of `length` times the first.
fn graded(length: f64) -> usize {
    let sum = |count: f64| match GRADING.powf(-1.0 / (count - 1.0)) {
        q if q > 1.0 => (q.powf(count) - 1.0) / (q - 1.0),
        _ => count,
    };
    (2..).find(|&count| sum(f64::from(count)) >= length).unwrap_or(2) as usize
}

/// Result of a run.
#[derive(Clone, Debug)]
pub struct Outcome {
    pub setup: Setup,
    pub rows: Vec<Row>,
    /// Snapshot at the time of Hertz's largest approach.
    pub snapshot: Snapshot,
    pub totals: Totals,
}

/// Build the scene; the second result is the number of the ball.
fn scene(setup: &Setup) -> Result<(Mpm<2>, usize), CaseError> {
    let lattice = Lattice::new([0.0; 2], setup.spacing())?;
    let method = Method::new(Linear, Flip, Musl, Axisymmetric);
    let law = Coulomb::new(setup.friction)?;
    let both = (setup.ball, setup.plate);
    let on_grid = both == (Matter::Particles, Matter::Particles) || setup.coupling == Coupling::Grid;
    let mut mpm = if on_grid {
        let detector = SurfaceDistance::new(SeparatingPlane, 0.0)?.locally();
        Mpm::with_contact(method, BlockGrid::new(lattice), GridContact::new(detector, Pairs::new(law)))
    } else {
        Mpm::new(method, BlockGrid::new(lattice))
    };
    let Impact { radius, speed, .. } = setup.impact;
    let edge = setup.plate_edge();
    let planes = [
        Boundary::Symmetry { axis: 0, at: 0.0, side: Side::Above },
        Boundary::Symmetry { axis: 1, at: -edge, side: Side::Above },
    ];
    let falling = move |_: [f64; 2]| [0.0, -speed];
    let mut elements = Fem::new(Axisymmetric);
    if setup.ball == Matter::Particles {
        let seeds = disc([0.0, radius], radius, 0.5 * setup.spacing(), Part::Ball);
        mpm.add("ball", setup.steel()?, &seeds, falling)?;
    } else {
        elements.add(MeshBody::new("ball", setup.ball_mesh()?, setup.steel()?).moving(falling))?;
    }
    if setup.plate == Matter::Particles {
        let shape = Cuboid::new([0.0, -edge], [edge, 0.0])?;
        let seeds = fill(&shape, &lattice, 2, &Filling::new().axisymmetric())?;
        mpm.add("plate", setup.steel()?, &seeds, |_| [0.0; 2])?;
    } else {
        elements.add(MeshBody::new("plate", setup.plate_mesh()?, setup.steel()?))?;
    }
    for plane in planes {
        elements.bound(plane.clone())?;
        mpm.bound(plane)?;
    }
    if both != (Matter::Particles, Matter::Particles) {
        mpm.add_client(match setup.coupling {
            Coupling::Grid => Elements::on_the_grid(elements)?,
            Coupling::Surface => Elements::by_surface(elements, law)?,
        })?;
    }
    mpm.set_team(Team::new(setup.threads)?);
    // Elements come after particles.
    Ok((mpm, usize::from(setup.ball == Matter::Elements)))
}

/// Run the impact.
pub fn strike(
    setup: &Setup,
    folder: &std::path::Path,
    frames: u32,
    restart: &Restart,
) -> Result<Outcome, CaseError> {
    let (mut mpm, ball) = scene(setup)?;
    let name = setup.name();
    let mut ledger = Ledger::new(Pace::interval(setup.end() / 200.0)?);
    let mut progress = Progress::new(name.clone());
    let mut track = Track::new(ball, setup.impact.duration() / ENTRIES)?;
    let mut series = None;
    if frames > 0 {
        let pace = Pace::interval(setup.end() / f64::from(frames))?;
        series = Some(VtkSeries::create(folder.join("paraview"), &name, pace)?);
    }
    let mut simulation = restart.scene(name)?;
    // The picture is taken at the time of the largest approach.
    for end in [0.5 * setup.impact.duration(), setup.end()] {
        let mut observers: Vec<&mut dyn Observer> = vec![&mut ledger, &mut progress, &mut track];
        observers.extend(series.iter_mut().map(|s| s as &mut dyn Observer));
        simulation.until(&mut mpm, observers, end)?;
        simulation.keep(|| mpm.snapshot())?;
    }
    let totals = Totals::of(&mpm, &simulation.summary(), &ledger);
    let snapshot = simulation.into_snapshots().swap_remove(0);
    Ok(Outcome { setup: *setup, rows: track.rows(setup.impact.mass()), snapshot, totals })
}
