//! Fragile points compared with finite elements of the same law and with peridynamics of another program, and cost of face
//! failure.

use std::f64::consts::PI;
use std::path::Path;
use std::sync::Arc;

use benchmarks::{Stepped, stepped, timed};
use examples::CaseError;
use examples::throughput::Spread;
use fem::{Fem, Hourglass, MeshBody, Technology};
use fpm::{
    Cells, Composition, Domain, Fpm, MaximumTension, Method, NoCracks, Notch, Space, Symmetric, scattered,
};
use mpm_core::geometry::Cuboid;
use mpm_core::geometry::structured::box_mesh;
use mpm_core::scene::Watch;
use mpm_core::{FullSpace, PlaneStrain, Solver};
use mpm_materials::{LinearElastic, Moduli};

use crate::page::{asked, table};
use crate::peers::of_particles;
use crate::sample::{Sample, Subject, alternate, attempt};

/// Cell size, m.
const H: f64 = 1e-3;
/// Velocity amplitude of the waves, m/s, and wavelength, m.
const SPEED: f64 = 1.0;
const WAVE: f64 = 20.0 * H;
/// Tensile strength of a face, Pa.
const STRENGTH: f64 = 1773e6;
/// Required rate in two dimensions on one thread, million updates per second, and required ratio to LAMMPS.
const RATE: f64 = 4.0;
const LAMMPS: f64 = 1.0;
/// Kalthoff's plate: size, notch positions and notch length, m, and impact velocity between the notches, m/s.
const PLATE: [f64; 2] = [0.1, 0.2];
const NOTCHES: [f64; 2] = [0.075, 0.125];
const REACH: f64 = 0.05;
const STRUCK: f64 = 16.5;
/// Number of cells whose stress opens the faces around them.
const SPOTS: usize = 50;

fn steel() -> Result<LinearElastic<f64>, CaseError> {
    Ok(LinearElastic::new(8000.0, Moduli::young_poisson(190e9, 0.3)?)?)
}

/// Velocity waves along every axis.
fn swing<const D: usize>(x: [f64; D]) -> [f64; D] {
    x.map(|x| SPEED * (2.0 * PI * x / WAVE).sin())
}

/// Build square or cubic cells that fill a box from the origin.
fn lattice<const D: usize>(counts: [usize; D]) -> Result<Cells<D>, CaseError> {
    let place = |mut n: usize| -> [f64; D] {
        std::array::from_fn(|d| {
            let at = n % counts[d];
            n /= counts[d];
            (at as f64 + 0.5) * H
        })
    };
    let points: Vec<[f64; D]> = (0..counts.iter().product()).map(place).collect();
    cells(&points, &domain(counts)?)
}

/// Build about the same number of cells from random points.
fn random<const D: usize>(counts: [usize; D]) -> Result<Cells<D>, CaseError> {
    let domain = domain(counts)?;
    cells(&scattered(&domain, 1, |_| H).map_err(other)?, &domain)
}

fn domain<const D: usize>(counts: [usize; D]) -> Result<Domain<D>, CaseError> {
    Domain::cuboid([0.0; D], counts.map(|n| n as f64 * H)).map_err(other)
}

fn cells<const D: usize>(points: &[[f64; D]], domain: &Domain<D>) -> Result<Cells<D>, CaseError> {
    Cells::voronoi(points, domain).map_err(other)
}

fn other(error: impl std::fmt::Display) -> CaseError {
    CaseError::Other(error.to_string())
}

/// Rounds, and cell updates per run.
#[derive(Clone, Copy)]
struct Effort {
    rounds: usize,
    updates: usize,
}

impl Effort {
    fn steps(self, points: usize) -> u64 {
        (self.updates / points).max(20) as u64
    }

    /// Run cells with waves and without face failure.
    fn waves<const D: usize, M: Composition<D>>(
        self,
        method: M,
        cells: &Cells<D>,
        threads: usize,
    ) -> Result<Stepped, CaseError> {
        let mut body = Fpm::new(method, steel()?, cells, swing)?;
        let run = stepped(&mut body, threads, self.steps(cells.len()))?;
        if !body.cracks().is_empty() {
            return Err(CaseError::Other("fragile: a face opened that should not".into()));
        }
        Ok(run)
    }

    /// Run the same number of quadrilaterals.
    fn elements(
        self,
        counts: [usize; 2],
        technology: Technology,
        threads: usize,
    ) -> Result<Stepped, CaseError> {
        let shape = Cuboid::new([0.0; 2], counts.map(|n| n as f64 * H))?;
        let mesh = box_mesh(&shape, counts)?;
        let kind = mesh.blocks[0].kind;
        let mut fem = Fem::new(PlaneStrain);
        fem.add(MeshBody::new("block", mesh, steel()?).with(kind, technology).moving(swing))?;
        stepped(&mut fem, threads, self.steps(counts.iter().product()))
    }
}

type Run<'a> = Box<dyn Fn(usize) -> Result<Stepped, CaseError> + 'a>;

/// Measure rates and memory of a two-dimensional body with `plane` cells per edge, and of a three-dimensional one of about as many
/// cells; return them with the minimum rate in two dimensions.
fn rates(plane: usize, effort: Effort) -> Result<(Vec<[String; 6]>, f64), CaseError> {
    let counts = [plane; 2];
    let cubes = [((plane * plane) as f64).cbrt().round() as usize; 3];
    let (squares, random_plane) = (lattice(counts)?, random(counts)?);
    let (cubes, random_space) = (lattice(cubes)?, random(cubes)?);
    let tension = MaximumTension::new(STRENGTH)?;
    let (printed, symmetric) = (Method::printed(PlaneStrain), Method::symmetric(PlaneStrain));
    let solid = Method::symmetric(FullSpace);
    let one_point = Technology::OnePoint(Hourglass::Stiffness(0.05));
    let mut subjects: Vec<(&str, Run<'_>)> = Vec::new();
    for (cells, names) in [
        (
            &squares,
            [
                "squares, printed",
                "squares, symmetric",
                "squares, printed, may crack",
                "squares, symmetric, may crack",
            ],
        ),
        (
            &random_plane,
            [
                "random, printed",
                "random, symmetric",
                "random, printed, may crack",
                "random, symmetric, may crack",
            ],
        ),
    ] {
        subjects.push((names[0], Box::new(move |threads| effort.waves(printed, cells, threads))));
        subjects.push((names[1], Box::new(move |threads| effort.waves(symmetric, cells, threads))));
        let (printed, symmetric) = (printed.with_cracks(tension), symmetric.with_cracks(tension));
        subjects.push((names[2], Box::new(move |threads| effort.waves(printed, cells, threads))));
        subjects.push((names[3], Box::new(move |threads| effort.waves(symmetric, cells, threads))));
    }
    let in_plane = subjects.len();
    subjects.push(("cubes, symmetric", Box::new(|threads| effort.waves(solid, &cubes, threads))));
    subjects.push((
        "random in space, symmetric",
        Box::new(|threads| effort.waves(solid, &random_space, threads)),
    ));
    subjects.push((
        "quadrilaterals, one point",
        Box::new(move |threads| effort.elements(counts, one_point, threads)),
    ));
    subjects.push((
        "quadrilaterals, mean dilatation",
        Box::new(move |threads| effort.elements(counts, Technology::MeanDilatation, threads)),
    ));
    let mut all = Vec::new();
    for (name, run) in &subjects {
        all.extend([1, 2].map(|threads| Subject::new(*name, move || run(threads))));
    }
    let samples = alternate(&all, effort.rounds)?;
    let mut least = f64::INFINITY;
    let row = |(n, pair): (usize, &[Sample<Stepped>])| {
        let (one, run) = (pair[0].rates(), pair[0].first());
        if n < in_plane {
            least = least.min(one.median);
        }
        [
            pair[0].name.clone(),
            run.points.to_string(),
            one.text(1),
            if n < in_plane { asked(RATE, one.median >= RATE) } else { "-".into() },
            pair[1].rates().text(1),
            format!("{:.0}", run.bytes_per_point()),
        ]
    };
    let rows = samples.chunks_exact(2).enumerate().map(row).collect();
    Ok((rows, least))
}

/// Run Kalthoff's full plate at a spacing (mm), with face failure, for this number of steps from the start.
fn plate(spacing: f64, at_random: bool, steps: u64) -> Result<Stepped, CaseError> {
    let h = 1e-3 * spacing;
    let domain = Domain::cuboid([0.0; 2], PLATE).map_err(other)?;
    let points = if at_random {
        scattered(&domain, 1, |_| h).map_err(other)?
    } else {
        let [columns, rows] = PLATE.map(|length| (length / h).round() as usize);
        let place = |n: usize| [n % columns, n / columns].map(|at| (at as f64 + 0.5) * h);
        (0..columns * rows).map(place).collect()
    };
    let mut cells = cells(&points, &domain)?;
    for y in NOTCHES {
        cells = cells.with_notch(&Notch::segment([0.0, y], [REACH, y]).map_err(other)?).map_err(other)?;
    }
    let method = Method::symmetric(PlaneStrain).with_cracks(MaximumTension::new(STRENGTH)?);
    let mut plate = Fpm::new(method, steel()?, &cells, |_| [0.0; 2])?;
    let struck = |y: f64| NOTCHES[0] < y && y < NOTCHES[1];
    plate.drive_faces(
        |face| face.normal[0] < -0.5 && struck(face.centroid[1]),
        Arc::new(|_| [Some(STRUCK), None]),
    )?;
    stepped(&mut plate, 1, steps)
}

/// Compare with peridynamics at spacings in mm; return the reason if the other program is missing.
fn peers(
    effort: Effort,
    spacings: &[f64],
    python: &Path,
) -> Result<(Vec<[String; 6]>, Option<String>), CaseError> {
    let mut rows = Vec::new();
    for &spacing in spacings {
        let steps = effort.steps((PLATE[0] * PLATE[1] * 1e6 / spacing / spacing) as usize);
        let samples = attempt(
            &[
                Subject::new("squares, symmetric", || plate(spacing, false, steps)),
                Subject::new("random, symmetric", || plate(spacing, true, steps)),
                Subject::new("LAMMPS PERI", || of_particles(python, "peri", spacing, steps)),
            ],
            effort.rounds,
        );
        let Some((theirs, ours)) = samples.split_last() else { continue };
        if let Some(failure) = ours.iter().find_map(|sample| sample.failure.clone()) {
            return Err(CaseError::Other(failure));
        }
        if let Some(failure) = &theirs.failure {
            eprintln!("{} is left out: {failure}", theirs.name);
            return Ok((rows, Some(theirs.name.clone())));
        }
        rows.extend(ours.iter().map(|ours| {
            let ratio = ours.over(theirs);
            [
                ours.name.clone(),
                format!("{} ({})", ours.first().points, theirs.first().points),
                ours.rates().text(2),
                format!("{}: {}", theirs.name, theirs.rates().text(2)),
                ratio.text(1),
                asked(format!("{LAMMPS} times"), ratio.median >= LAMMPS),
            ]
        }));
    }
    Ok((rows, None))
}

/// Measure the step time in a body with `along` squares per edge in which some cells are stressed beyond the strength, us, and the number
/// of opened faces; without a criterion none opens.
fn opening<C: fpm::Criterion>(along: usize, criterion: C, rounds: usize) -> Result<(Spread, usize), CaseError>
where
    fpm::Method<PlaneStrain, Symmetric, C>: Composition<2>,
    PlaneStrain: Space<2>,
{
    let method = Method::symmetric(PlaneStrain).with_cracks(criterion);
    let mut body = Fpm::new(method, steel()?, &lattice([along; 2])?, |_| [0.0; 2])?;
    body.set_watch(Watch::off());
    // Equal cells in bodies of any size: ten cells apart, in a corner.
    let spots: Vec<[f64; 2]> =
        (0..SPOTS).map(|n| [n % 10, n / 10].map(|at| (10.0 * at as f64 + 5.5) * H)).collect();
    let near = |x: [f64; 2]| spots.iter().any(|s| (0..2).all(|d| (x[d] - s[d]).abs() < 0.5 * H));
    body.set_states::<LinearElastic<f64>>(|x, mut state| {
        if near(x) {
            // Faces use the mean stress of both cells, and part of the stress is released within the step.
            state.stress.0[0] = 6.0 * STRENGTH;
        }
        state
    })?;
    let (mut times, mut opened) = (Vec::new(), 0);
    for _ in 0..rounds {
        let mut trial = body.clone();
        let (made, seconds) = timed(1, || trial.step_at_most(f64::INFINITY));
        made?;
        opened = trial.cracks().len();
        times.push(1e6 * seconds);
    }
    Ok((Spread::of(times.into_iter()), opened))
}

/// Measure the cost of opened faces in bodies with these numbers of squares per edge.
fn openings(sizes: &[usize], rounds: usize) -> Result<Vec<[String; 5]>, CaseError> {
    let mut rows = Vec::new();
    for &along in sizes {
        let (with, count) = opening(along, MaximumTension::new(STRENGTH)?, rounds)?;
        let (without, none) = opening(along, NoCracks, rounds)?;
        if count == 0 || none > 0 {
            return Err(CaseError::Other(format!("fragile: {count} and {none} faces opened")));
        }
        rows.push([
            (along * along).to_string(),
            count.to_string(),
            with.text(0),
            without.text(0),
            format!("{:.1}", (with.median - without.median) / count as f64),
        ]);
    }
    Ok(rows)
}

/// Measure rates and memory, compared with elements and another program, and the cost of opened faces.
pub fn cost(quick: bool, python: &Path) -> Result<Option<String>, CaseError> {
    let (effort, sizes, spacings): (_, &[usize], &[f64]) = if quick {
        (Effort { rounds: 3, updates: 1_000_000 }, &[100], &[1.0])
    } else {
        (Effort { rounds: 5, updates: 4_000_000 }, &[100, 300], &[1.0, 0.5])
    };
    let (mut rows, mut least) = (Vec::new(), f64::INFINITY);
    for &along in sizes {
        let (of_size, slowest) = rates(along, effort)?;
        rows.extend(of_size);
        least = least.min(slowest);
    }
    let (beside, absent) = peers(Effort { rounds: 3, ..effort }, spacings, python)?;
    let absent = absent.map_or(String::new(), |name| format!(" Absent on this machine: {name}."));
    let opening = openings(&[100, 200], if quick { 40 } else { 200 })?;
    let verdict = if least >= RATE { "met" } else { "missed" };
    Ok(Some(format!(
        "## Fragile points\n\nA square or cube of steel, linear elastic, with waves along all axes, of squares, cubes and Voronoi cells of points at random, with both fluxes; with faces \
         that may open (every one is judged, none does); and finite elements of the same law value. Million updates of cells or elements a second; on one thread by its processor \
         time, on two by the clock. Bytes are those of a cell or element with all scratch. The slowest in the plane on one thread make {least:.1} M/s; {RATE} are asked: \
         {verdict}.\n\n{}\n\
         Another program, one thread, processor time, medians of three rounds in alternation: all of Kalthoff's plate, struck between its notches, from the start, by bond-based \
         peridynamics of LAMMPS (some 28 bonds a particle) at the same spacing; its particles in brackets. Steps are not of the same length.{absent}\n\n{}\n\
         What opening a face takes: the first step of a body in which {SPOTS} cells are so stressed that faces beside them open in it, less that of one in which none can, over the faces; \
         microseconds of processor time. New gradients, batches, frequencies and books are all of it; nothing of it is to grow with the body.\n\n{}",
        table(["cells or elements", "number", "one thread", "asked", "two threads", "bytes"], &rows),
        table(["cells", "number", "ours", "theirs", "ours / theirs", "asked"], &beside),
        table(["squares", "faces that open", "step with openings", "without", "an opening"], &opening),
    )))
}
