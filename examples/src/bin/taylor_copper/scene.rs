//! Scene and run by the particle-contact meshfree method.

use std::path::Path;

use examples::{CaseError, Restart, Totals};
use mpm_core::geometry::{Cuboid, Lattice};
use mpm_core::observe::{HistoryCsv, Ledger, Observer, Pace, Progress, RunView, VtkSeries};
use mpm_core::output::Snapshot;
use mpm_core::{Axisymmetric, Boundary, Embedding, FullSpace, PlaneStrain, RunError, Side, Solver, Team};
use mpm_materials::{
    Adiabatic, Constitutive, Heat, IntoMaterial, JohnsonCook, Logarithmic, MieGruneisen, SmoothLogarithmic,
    Solid,
};
use pcmm::{
    Audit, AzimuthFan, Composition, LocalDelaunay, Masses, Method, NoRotation, OfElement, OverlapWeighted,
    Packing, Pcmm, StartOfStep,
};

/// Radius (half width) of the bar, m.
pub const RADIUS: f64 = 5.0e-3;
/// Length of the bar, m.
pub const LENGTH: f64 = 70.0e-3;
/// End of a run, s, after the rebound of the bar.
pub const END: f64 = 260.0e-6;
/// Linear and quadratic coefficient of the bulk viscosity \[M\]; the paper has none.
pub const BULK_VISCOSITY: [f64; 2] = [0.06, 1.5];
/// Interval between two entries of a history, s.
pub const HISTORY: f64 = 1.0e-6;
/// Number of steps between two revisions.
const EVERY: u64 = 10;

/// Embedding of the bar in space.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Space {
    PlaneStrain,
    Axisymmetric,
    /// Quarter of the bar in three dimensions.
    Quarter,
}

impl Space {
    /// Return the name in file names.
    pub fn name(self) -> &'static str {
        match self {
            Space::PlaneStrain => "plane_strain",
            Space::Axisymmetric => "axisymmetric",
            Space::Quarter => "quarter",
        }
    }

    /// Return the name in tables.
    pub fn words(self) -> &'static str {
        match self {
            Space::PlaneStrain => "plane strain",
            Space::Axisymmetric => "axisymmetric",
            Space::Quarter => "three dimensions",
        }
    }
}

/// Parts of the method.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Parts {
    /// Original formulation: fans, means of particles, no rotation of stress, volume of elements.
    Printed,
    /// Consistent parts.
    Consistent,
    /// Consistent parts with the volume of elements: demonstrates locking.
    Locking,
}

/// Parameters of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Setup {
    pub name: &'static str,
    pub space: Space,
    pub parts: Parts,
    /// Impact speed, m/s.
    pub speed: f64,
    /// Hardening coefficient B, Pa.
    pub hardening: f64,
    /// Contact tolerance of the original method, in spacings.
    pub reach: f64,
    /// Spacings per radius.
    pub cells: u32,
    pub threads: usize,
}

impl Setup {
    /// Return the particle spacing, m.
    pub fn spacing(&self) -> f64 {
        RADIUS / f64::from(self.cells)
    }
}

/// Results of a run.
#[derive(Clone, Debug)]
pub struct Outcome {
    pub setup: Setup,
    /// Length and radius of the face, m.
    pub sizes: [f64; 2],
    /// Time reached, s; below [`END`] for a premature stop.
    pub time: f64,
    /// Error that stopped the run, if any.
    pub broke: Option<String>,
    pub audit: Audit,
    /// Initial kinetic energy, J.
    pub start: f64,
    /// Mass of the elements at the end over its initial value.
    pub covered: f64,
    pub snapshot: Snapshot,
    pub totals: Totals,
}

/// Output of a run.
#[derive(Clone, Copy, Debug)]
pub struct Files<'a> {
    pub folder: &'a Path,
    pub frames: u32,
    pub restart: &'a Restart,
}

impl Files<'_> {
    /// Create the ParaView series of a run, if frames are requested.
    pub fn series(&self, name: &str) -> Result<Option<VtkSeries>, CaseError> {
        if self.frames == 0 {
            return Ok(None);
        }
        let pace = Pace::interval(END / f64::from(self.frames))?;
        Ok(Some(VtkSeries::create(self.folder.join("paraview"), name, pace)?))
    }
}

/// Return the strength of the paper's copper with the standard rate factor; B, heat capacity and melting temperature are not from the
/// paper.
pub fn strength(hardening: f64) -> Result<JohnsonCook<f64, Logarithmic<f64>, Adiabatic<f64>>, CaseError> {
    Ok(JohnsonCook::new(47.7e9, 89.63e6, hardening, 0.31)?
        .with_rate(Logarithmic::new(0.025, 1.0)?)
        .with_heat(Adiabatic::new(heat())?))
}

fn heat() -> Heat<f64> {
    Heat { room: 294.0, melt: 1356.0, exponent: 1.09, heat_capacity: 383.0, taylor_quinney: 0.9 }
}

/// Return the equation of state: Steinberg's constants, which equal the paper's except for the volume correction.
pub fn eos() -> Result<MieGruneisen<f64>, CaseError> {
    Ok(MieGruneisen::new(8940.0, 3940.0, 1.49, 2.02)?)
}

/// Run the impact of the bar on the wall.
pub fn impact(setup: &Setup, files: Files) -> Result<Outcome, CaseError> {
    match setup.space {
        Space::PlaneStrain => with_embedding(setup, PlaneStrain, files),
        Space::Axisymmetric => with_embedding(setup, Axisymmetric, files),
        Space::Quarter => quarter(setup, files),
    }
}

/// Run a quarter of the bar in three dimensions: layers of concentric rings, with particles on both planes of symmetry.
fn quarter(setup: &Setup, files: Files) -> Result<Outcome, CaseError> {
    let h = setup.spacing();
    let [linear, quadratic] = BULK_VISCOSITY;
    let law = Solid::new(strength(setup.hardening)?, eos()?).with_bulk_viscosity(linear, quadratic)?;
    let mut positions = Vec::new();
    for layer in 0..=(LENGTH / h).round() as u32 {
        for ring in 0..=setup.cells {
            let r = h * f64::from(ring);
            let parts = (std::f64::consts::FRAC_PI_2 * f64::from(ring)).round() as u32;
            for k in 0..=parts {
                // Ends exactly on the planes of symmetry.
                let (s, c) = if k == parts && k > 0 {
                    (1.0, 0.0)
                } else {
                    (std::f64::consts::FRAC_PI_2 * f64::from(k) / f64::from(parts.max(1))).sin_cos()
                };
                positions.push([r * c, r * s, h * f64::from(layer)]);
            }
        }
    }
    let radii = vec![0.5 * h; positions.len()];
    let method = Method::consistent(FullSpace, LocalDelaunay::new(h, 10.0)?);
    run(setup, method, law, &Packing::of_spheres(positions, radii), 2, files)
}

fn with_embedding<E: Embedding<2>>(setup: &Setup, embedding: E, files: Files) -> Result<Outcome, CaseError> {
    let h = setup.spacing();
    let [linear, quadratic] = BULK_VISCOSITY;
    // The original method has no planes of symmetry.
    let whole = setup.parts == Parts::Printed && setup.space == Space::PlaneStrain;
    let shape = Cuboid::new([if whole { -RADIUS } else { 0.0 }, 0.0], [RADIUS, LENGTH])?;
    let packing = Packing::on_nodes(&shape, &Lattice::new([0.0; 2], h)?)?;
    let planes = usize::from(!whole);
    // Elements may stretch to ten times their length before they become cracks.
    let delaunay = || LocalDelaunay::new(0.45 * h, 20.0);
    match setup.parts {
        Parts::Printed => {
            // Constants of the paper: G 60.74 GPa, a 1.5, the smooth rate factor, no rotation; but the correct sign in the denominator of
            // the equation of state (book, "How far the printed method goes").
            let strength = JohnsonCook::new(60.74e9, 89.63e6, setup.hardening, 0.31)?
                .with_rate(SmoothLogarithmic::new(0.025, 1.0)?)
                .with_heat(Adiabatic::new(heat())?);
            let law = Solid::new(strength, eos()?.with_correction(1.5)?)
                .with_bulk_viscosity(linear, quadratic)?
                .with_rate(NoRotation)
                .compiled();
            run(
                setup,
                Method::printed(embedding, AzimuthFan::new(setup.reach * h)?),
                law,
                &packing,
                planes,
                files,
            )
        }
        Parts::Consistent => {
            let law =
                Solid::new(strength(setup.hardening)?, eos()?).with_bulk_viscosity(linear, quadratic)?;
            run(setup, Method::consistent(embedding, delaunay()?), law, &packing, planes, files)
        }
        Parts::Locking => {
            let law =
                Solid::new(strength(setup.hardening)?, eos()?).with_bulk_viscosity(linear, quadratic)?;
            let method = Method::new(embedding, delaunay()?, OverlapWeighted, StartOfStep, OfElement);
            run(setup, method, law, &packing, planes, files)
        }
    }
}

/// Run the bar along the last axis, with planes of symmetry normal to the first axes.
fn run<const D: usize, M: Composition<D>>(
    setup: &Setup,
    method: M,
    law: impl IntoMaterial<f64>,
    packing: &Packing<D>,
    planes: usize,
    files: Files,
) -> Result<Outcome, CaseError> {
    let h = setup.spacing();
    let axis = D - 1;
    let mut velocity = [0.0; D];
    velocity[axis] = -setup.speed;
    let mut bar = Pcmm::new(method, law, packing, |_| velocity, Masses::FromElements)?;
    for plane in 0..planes {
        bar.bound(Boundary::Symmetry { axis: plane, at: 0.0, side: Side::Above })?;
    }
    bar.bound(Boundary::Wall { axis, at: 0.0, side: Side::Above, velocity: 0.0 })?;
    bar.set_team(Team::new(setup.threads)?);
    bar.set_revision_interval(EVERY)?;

    let row = |at: f64| -> Vec<usize> {
        let near = |n: &usize| (packing.positions[*n][axis] - at).abs() < 0.5 * h;
        (0..packing.positions.len()).filter(near).collect()
    };
    let (foot, top) = (row(0.0), row(LENGTH));
    let sizes = |bar: &Pcmm<D, M>| sizes_of([&foot, &top], |&n| bar.particles()[n].position);

    let columns = [
        ("time", "s"),
        ("length", "m"),
        ("face radius", "m"),
        ("kinetic energy", "J"),
        ("internal energy", "J"),
        ("work of the wall", "J"),
        ("energy added by revisions", "J"),
        ("mass of elements", "kg"),
    ];
    let (start, covered) = (bar.totals(), bar.coverage().mass);
    let path = files.folder.join(format!("history_{}.csv", setup.name));
    let mut history = HistoryCsv::create(path, columns, Pace::interval(HISTORY)?, |now: &RunView<'_>| {
        let bar = now.solver_as::<Pcmm<D, M>>()?;
        let [length, radius] = sizes(bar);
        Ok(vec![
            now.time(),
            length,
            radius,
            now.totals().kinetic,
            now.totals().internal,
            now.exchange().work,
            bar.audit().energy_added(),
            bar.coverage().mass,
        ])
    })?;
    let mut ledger = Ledger::new(Pace::interval(HISTORY)?);
    let mut progress = Progress::new(format!("{:<28}", setup.name));
    let mut series = files.series(setup.name)?;
    let mut observers: Vec<&mut dyn Observer> = vec![&mut history, &mut ledger, &mut progress];
    observers.extend(series.iter_mut().map(|s| s as &mut dyn Observer));
    // An error that stops the original method is a result.
    let mut simulation = files.restart.scene(setup.name)?;
    let broke = match simulation.until(&mut bar, observers, END) {
        Ok(()) => None,
        Err(RunError::Step(error)) => Some(error.to_string()),
        Err(error) => return Err(error.into()),
    };
    let totals = Totals::of(&bar, &simulation.summary(), &ledger);
    let covered = bar.coverage().mass / covered;
    Ok(Outcome {
        setup: *setup,
        sizes: sizes(&bar),
        time: bar.time(),
        broke,
        audit: *bar.audit(),
        start: start.kinetic,
        covered,
        snapshot: bar.snapshot()?,
        totals,
    })
}

/// Return length and face radius of a bar, m, from the points of its face and its other end. The length extends from the lowest point of
/// the face, whose rim curls up, to the mean height of the other end; the radius is that of the outermost point of the face.
pub fn sizes_of<N, const D: usize>([foot, top]: [&[N]; 2], at: impl Fn(&N) -> [f64; D]) -> [f64; 2] {
    let axis = D - 1;
    let height = |n: &N| at(n)[axis];
    let (end, lowest) = (top.iter().map(height).sum::<f64>() / top.len() as f64, foot.iter().map(height));
    let radius = |n: &N| at(n)[..axis].iter().map(|c| c * c).sum::<f64>().sqrt();
    [end - lowest.fold(f64::INFINITY, f64::min), foot.iter().map(radius).fold(0.0, f64::max)]
}
