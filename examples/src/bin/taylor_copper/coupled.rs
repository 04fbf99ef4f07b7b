//! Taylor bar by elements that convert to particles: at the foot from the start (MPFEM), or where they are deformed too far (AFEMP).

use coupling::{Conversion, ConversionBook, ConversionLog, Elements};
use examples::{CaseError, Check, Simulation, Totals};
use fem::{Fem, MeshBody};
use mpm_core::geometry::structured::box_mesh;
use mpm_core::geometry::{Cuboid, Lattice};
use mpm_core::observe::{Ledger, ObserveError, Observer, Pace, Progress, RunView};
use mpm_core::output::Snapshot;
use mpm_core::{
    Archive, Axisymmetric, BlockGrid, Boundary, CheckpointError, Embedding, IntoKernels, Kernels, Method,
    Mpm, PlaneStrain, Side, Solver, Team,
};

use crate::beside::{self, Bar, copper};
use crate::scene::{END, Files, LENGTH, RADIUS, Space};
use crate::{SPEED, mpm};

/// Default impact speeds, m/s.
pub const SPEEDS: [f64; 4] = [SPEED, 190.0, 400.0, 1000.0];
/// Height above the wall within which elements are particles from the start, in radii.
const REGION: f64 = 2.0;

/// End of fast runs: path at impact speed over the length of the bar. By then only dispersing debris is left.
const CONSUMED: f64 = 0.6;

/// Return the end of a run, s.
fn end_of(speed: f64) -> f64 {
    if speed > 500.0 { END.min(CONSUMED * LENGTH / speed) } else { END }
}

/// Criterion of conversion to particles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Coupling {
    /// Elements within a region, from the start.
    Mpfem,
    /// Elements that are deformed too far.
    Afemp,
}

impl Coupling {
    pub fn name(self) -> &'static str {
        match self {
            Coupling::Mpfem => "mpfem",
            Coupling::Afemp => "afemp",
        }
    }
}

/// Results of a bar, and of particles alone.
pub struct Outcome {
    pub coupling: Coupling,
    pub bar: Bar,
    /// Length and largest radius, m, of the coupled bar and of particles alone.
    pub sizes: [[f64; 2]; 2],
    pub book: ConversionBook,
    /// Shortest time step over the first one.
    pub shortest: f64,
    /// Number of elements at the start.
    pub elements: usize,
    pub snapshot: Snapshot,
    /// Totals of the coupled bar and of particles alone.
    pub totals: [Totals; 2],
}

impl Outcome {
    /// Return the name in tables.
    pub fn name(&self) -> String {
        format!("{}, {}, {} m/s", self.coupling.name(), self.bar.space.words(), self.bar.speed)
    }
}

/// Run the impact of the bar, and of particles alone for comparison.
pub fn impact(coupling: Coupling, bar: Bar, files: Files) -> Result<Outcome, CaseError> {
    match bar.space {
        Space::PlaneStrain => {
            run(coupling, bar, PlaneStrain, Method::impact(PlaneStrain).into_kernels(), files)
        }
        Space::Axisymmetric | Space::Quarter => {
            run(coupling, bar, Axisymmetric, Method::impact(Axisymmetric).into_kernels(), files)
        }
    }
}

fn run<E: Embedding<2>>(
    coupling: Coupling,
    bar: Bar,
    embedding: E,
    method: Kernels<f64, 2>,
    files: Files,
) -> Result<Outcome, CaseError> {
    let end = end_of(bar.speed);
    let (mut mpm, log, whole) = built(coupling, bar, embedding, method)?;
    let (mut ledger, mut steps) = (Ledger::new(Pace::interval(1.0e-6)?), Steps::new(end));
    let label = format!("{}_{}_{}", coupling.name(), bar.space.name(), bar.speed);
    let mut progress = Progress::new(format!("{} at {} m/s", coupling.name(), bar.speed));
    let mut observers: Vec<&mut dyn Observer> = vec![&mut ledger, &mut steps, &mut progress];
    let mut series = files.series(&label)?;
    observers.extend(series.iter_mut().map(|s| s as &mut dyn Observer));
    let mut simulation = files.restart.scene(label)?;
    simulation.until(&mut mpm, observers, end)?;
    let totals = Totals::of(&mpm, &simulation.summary(), &ledger);

    let (alone, particles) = alone(bar)?;
    let hoop = bar.space != Space::PlaneStrain;
    Ok(Outcome {
        coupling,
        bar,
        sizes: [sizes(&mpm, hoop), sizes(&alone, hoop)],
        book: log.book(),
        shortest: steps.shortest / steps.first,
        elements: whole,
        snapshot: mpm.snapshot()?,
        totals: [totals, particles],
    })
}

/// Build the bar in front of the wall. Return it with the conversion log and the number of elements.
fn built<E: Embedding<2>>(
    coupling: Coupling,
    bar: Bar,
    embedding: E,
    method: Kernels<f64, 2>,
) -> Result<(Mpm<2>, ConversionLog, usize), CaseError> {
    let lattice = Lattice::new([0.0; 2], RADIUS / f64::from(bar.cells))?;
    let counts = [bar.cells as usize, (f64::from(bar.cells) * LENGTH / RADIUS).round() as usize];
    let mesh = box_mesh(&Cuboid::new([0.0; 2], [RADIUS, LENGTH])?, counts)?;
    let mut fem = Fem::new(embedding);
    fem.add(MeshBody::new("bar", mesh, copper()?).moving(move |_| [0.0, -bar.speed]))?;
    let conversion = match coupling {
        Coupling::Mpfem => {
            let far = 100.0 * RADIUS;
            Conversion::within(Cuboid::new([-far, -RADIUS], [far, REGION * RADIUS])?)
        }
        Coupling::Afemp => Conversion::adaptive(),
    };
    let (elements, log) = Elements::converting(fem, "foot", conversion)?;
    let mut mpm = Mpm::new(method, BlockGrid::new(lattice));
    mpm.add_client(elements)?;
    mpm.bound(Boundary::Symmetry { axis: 0, at: 0.0, side: Side::Above })?;
    mpm.bound(Boundary::Wall { axis: 1, at: 0.0, side: Side::Above, velocity: 0.0 })?;
    mpm.set_team(Team::new(bar.threads)?);
    Ok((mpm, log, counts[0] * counts[1]))
}

/// Run the axisymmetric bar without files, for the comparison of methods.
pub fn beside(coupling: Coupling, bar: Bar) -> Result<beside::Outcome, CaseError> {
    let method = Method::impact(Axisymmetric).into_kernels();
    let (mut mpm, ..) = built(coupling, bar, Axisymmetric, method)?;
    let mut ledger = Ledger::new(Pace::interval(1.0e-6)?);
    let mut progress = Progress::new(coupling.name());
    let mut simulation = Simulation::alone();
    let observers: Vec<&mut dyn Observer> = vec![&mut ledger, &mut progress];
    simulation.until(&mut mpm, observers, end_of(bar.speed))?;
    let totals = Totals::of(&mpm, &simulation.summary(), &ledger);
    outermost(coupling.name(), bar, &mut mpm, totals)
}

/// Run particles alone, and measure them as converting elements, which is valid for a fragmented foot.
pub fn particles(bar: Bar) -> Result<beside::Outcome, CaseError> {
    let (mut mpm, totals) = alone(bar)?;
    outermost("mpm", bar, &mut mpm, totals)
}

fn outermost(
    method: &'static str,
    bar: Bar,
    mpm: &mut Mpm<2>,
    totals: Totals,
) -> Result<beside::Outcome, CaseError> {
    let sizes = sizes(mpm, true);
    Ok(beside::Outcome {
        method,
        bar,
        sizes,
        hourglass: None,
        broke: None,
        snapshot: mpm.snapshot()?,
        totals,
    })
}

/// Run particles alone on the same grid.
fn alone(bar: Bar) -> Result<(Mpm<2>, Totals), CaseError> {
    let mut mpm = mpm::scene(bar)?;
    let mut ledger = Ledger::new(Pace::interval(1.0e-6)?);
    let mut progress = Progress::new(format!("mpm at {} m/s", bar.speed));
    let mut simulation = Simulation::alone();
    let observers: Vec<&mut dyn Observer> = vec![&mut ledger, &mut progress];
    simulation.until(&mut mpm, observers, end_of(bar.speed))?;
    let totals = Totals::of(&mpm, &simulation.summary(), &ledger);
    Ok((mpm, totals))
}

/// Return length and largest radius, m, from the outermost points extended by half their size, for elements and particles alike.
fn sizes(mpm: &Mpm<2>, hoop: bool) -> [f64; 2] {
    let (mut low, mut high, mut wide) = (f64::INFINITY, f64::NEG_INFINITY, 0.0f64);
    for body in mpm.bodies() {
        body.for_each(&mut |p| {
            let depth = if hoop { p.position[0] } else { 1.0 };
            // Elements provide their current half edges.
            let half = match p.corners.is_empty() {
                true => [0.5 * (p.volume / depth).sqrt(); 2],
                false => [0, 1].map(|d| p.half_edges.iter().map(|edge| edge[d].abs()).sum::<f64>()),
            };
            low = low.min(p.position[1] - half[1]);
            high = high.max(p.position[1] + half[1]);
            wide = wide.max(p.position[0] + half[0]);
        });
    }
    [high - low, wide]
}

/// First and shortest time step of a run.
struct Steps {
    pace: Pace,
    end: f64,
    first: f64,
    shortest: f64,
    last: f64,
}

impl Steps {
    fn new(end: f64) -> Self {
        Steps { pace: Pace::every_step(), end, first: 0.0, shortest: f64::INFINITY, last: 0.0 }
    }
}

impl Observer for Steps {
    fn pace(&mut self) -> &mut Pace {
        &mut self.pace
    }
    fn observe(&mut self, now: &RunView<'_>) -> Result<(), ObserveError> {
        let step = now.time() - self.last;
        self.last = now.time();
        // The last two steps are shortened to reach the end.
        if step > 0.0 && now.time() < self.end - 3.0 * self.first {
            self.first = if self.first == 0.0 { step } else { self.first };
            self.shortest = self.shortest.min(step);
        }
        Ok(())
    }
    fn archive(&mut self, file: &mut Archive) -> Result<(), CheckpointError> {
        file.reals([&mut self.first, &mut self.shortest, &mut self.last])
    }
}

/// Tolerance of the radius, that of particles alone.
const RADIUS_TOLERANCE: f64 = 0.05;
const TOO_WIDE: &str = "5.4 % too wide with 10 cells on the radius, as particles alone are";

/// Reason for the energy loss in plane strain.
const STRETCHED: &str = "the face spreads three-fold, and two particles a cell are then more than a cell apart: particles alone \
    lose 1.6 % with two a cell along each axis, 0.8 % with three, 0.5 % with four; 2.2, 1.6, 1.5 % with 5, 10, 14 cells";

/// Cells per radius from which the face and the energy dissipated by the wall at once are evaluated.
const FINE: u32 = 10;
const COARSE: &str = "half a cell of the bar is stopped at once, and the face is some cells wide";

/// Reason for the length error of coarse bars in plane strain.
const STOPPED: &str = "1 to 2 % too long with few cells: the wall stops particles at their surfaces, and elements at their own nodes";

/// Return the checks of a bar.
pub fn checks(outcome: &Outcome) -> Vec<Check> {
    let name = |what: &str| format!("{}: {what}", outcome.name());
    let mm = |x: f64| 1e3 * x;
    let [[length, radius], [l, r]] = outcome.sizes;
    let particles = "particles alone on the same grid";
    let free = "conservation";
    let book = &outcome.book;
    let totals = &outcome.totals[0];
    let energy = totals.energy_error.abs();
    let fine = outcome.bar.cells >= FINE;
    let coarse = outcome.coupling == Coupling::Afemp && outcome.bar.space == Space::PlaneStrain && !fine;
    let of_length = |row: Check| if coarse { row.known_miss(STOPPED) } else { row };
    let flat = outcome.coupling == Coupling::Mpfem && outcome.bar.space == Space::PlaneStrain;
    let lost = Check::at_most(name("energy error"), energy, "-", 0.01, free);
    let mut rows = vec![
        of_length(Check::gate(name("length"), mm(length), "mm", mm(l), 0.01, particles)),
        Check::at_least(
            name("shortest step / first"),
            outcome.shortest,
            "-",
            0.5,
            "no element holds the run up",
        ),
        if flat { lost.known_miss(STRETCHED) } else { lost }.judged_if(fine, COARSE),
        Check::gate(name("momentum error"), totals.momentum_error, "-", 0.0, 1e-11, free),
        Check::at_most(
            name("energy that appeared with particles / all"),
            book.energy.abs() / energy_of(outcome),
            "-",
            0.01,
            free,
        ),
    ];
    if outcome.coupling == Coupling::Afemp {
        let least = book.least_jacobian.unwrap_or(1.0);
        rows.push(Check::at_least(
            name("least Jacobian of an element"),
            least,
            "-",
            0.1,
            "before it tangles",
        ));
    }
    if outcome.bar.speed == SPEED && outcome.bar.space != Space::Quarter {
        let [reference, wide] = crate::checks::finite_elements(outcome.bar.space);
        let source = "independent finite elements [C]";
        let length =
            Check::gate(name("length beside elements"), mm(length), "mm", mm(reference), 0.01, source);
        rows.push(of_length(length));
        let face = Check::gate(
            name("largest radius beside elements"),
            mm(radius),
            "mm",
            mm(wide),
            RADIUS_TOLERANCE,
            source,
        );
        rows.push(if flat { face.known_miss(TOO_WIDE) } else { face }.judged_if(fine, COARSE));
    }
    let shown = format!("{:.2} mm of particles alone: what flies off is in it", mm(r));
    rows.push(Check::unreferenced(name("largest radius"), mm(radius), "mm", &shown));
    let cost = outcome.totals[0].wall_seconds / outcome.totals[1].wall_seconds;
    rows.push(Check::unreferenced(name("cost / particles alone"), cost, "-", "shown"));
    rows.push(Check::unreferenced(
        name("elements that became particles / all"),
        book.elements as f64 / outcome.elements as f64,
        "-",
        "shown",
    ));
    rows
}

/// Return the initial kinetic energy, J.
fn energy_of(outcome: &Outcome) -> f64 {
    let area = match outcome.bar.space {
        Space::PlaneStrain => RADIUS,
        _ => 0.5 * RADIUS * RADIUS,
    };
    0.5 * 8940.0 * area * LENGTH * outcome.bar.speed.powi(2)
}
