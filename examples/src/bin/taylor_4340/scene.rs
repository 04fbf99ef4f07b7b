//! Scene and run.

use std::path::Path;

use clap::ValueEnum;
use examples::{CaseError, Restart, Totals};
use mpm_core::geometry::{Cuboid, Filling, Lattice, fill};
use mpm_core::observe::{HistoryCsv, Ledger, LedgerEntry, Observer, Pace, Progress, RunView, VtkSeries};
use mpm_core::output::Snapshot;
use mpm_core::{Axisymmetric, Boundary, FullSpace, Side, Solver, Team};
use mpm_materials::failure::JohnsonCookDamage;
use mpm_materials::{Constitutive, IntoMaterial, library};
use serde::Serialize;
use sph::{
    ArtificialStress, Composition, GradientCorrection, Layout, Method, PairViscosity, Sph, TotalLagrangian,
    Updated, WendlandC2, ZeroEnergyPenalty,
};

use crate::damage::Counted;
use crate::gauge::{Gauge, Sizes};
use crate::quarter;

/// Length, m, of the paper.
pub const LENGTH: f64 = 37.97e-3;
/// Radius, m. The paper has a diameter of 7.595 mm and 20 x 200 particles of equal spacing, which agree within 1.3e-4.
pub const RADIUS: f64 = 0.1 * LENGTH;
/// End of the run, s: "taken as final".
pub const END: f64 = 60.0e-6;
/// Interval between two rows of the history, s.
const HISTORY: f64 = 1.0e-6;
/// Initial temperature, K, that of the law.
pub const ROOM: f64 = 294.0;

/// Bulk viscosity "after Johnson and Beissel": Q = C_L rho c h |tr d| + C_Q rho h^2 (tr d)^2 in compression, C_L and C_Q from memory of the
/// literature.
pub const PRINTED_VISCOSITY: [f64; 2] = [0.5, 4.0];
/// Usual bulk viscosity of public decks.
pub const USUAL_VISCOSITY: [f64; 2] = [0.06, 1.5];

/// A form of the method.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, ValueEnum, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Form {
    /// As printed: cubic spline, gradients as they are, artificial stress, wall of mirror images
    Printed,
    /// Updated Lagrangian: Wendland C2, corrected gradients, artificial stress, viscosity of pairs, wall of mirror images
    Updated,
    /// Total Lagrangian: Wendland C2, corrected gradients, zero-energy penalty, rows of particles on both ends of the bar
    Total,
}

impl Form {
    /// Return the name in file names.
    pub fn name(self) -> &'static str {
        match self {
            Form::Printed => "printed",
            Form::Updated => "updated",
            Form::Total => "total",
        }
    }

    /// Return the name in tables and pictures.
    pub fn words(self) -> &'static str {
        match self {
            Form::Printed => "as printed",
            Form::Updated => "updated",
            Form::Total => "total Lagrangian",
        }
    }

    /// Return the bulk viscosity of the law, linear and quadratic coefficient.
    pub fn viscosity(self) -> [f64; 2] {
        if self == Form::Printed { PRINTED_VISCOSITY } else { USUAL_VISCOSITY }
    }
}

/// Embedding of the bar in space.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Space {
    Axisymmetric,
    /// Quarter of the bar in three dimensions.
    Quarter,
}

/// Parameters of a run.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Setup {
    pub form: Form,
    pub space: Space,
    /// Impact speed, m/s.
    pub speed: f64,
    /// Particles per radius.
    pub cells: u32,
    /// Zero-energy penalty of the total Lagrangian form.
    pub penalty: f64,
    /// True if particles fail at a Johnson-Cook damage of one.
    pub failing: bool,
    #[serde(skip)]
    pub threads: usize,
}

impl Setup {
    /// Return the label, and name in files.
    pub fn name(&self) -> String {
        let space = if self.space == Space::Quarter { "quarter_" } else { "" };
        format!("{space}{}_{}", self.form.name(), self.speed)
    }

    /// Return the name in tables.
    pub fn words(&self) -> String {
        let space = if self.space == Space::Quarter { " in 3D" } else { "" };
        format!("{} m/s, {}{space}", self.speed, self.form.words())
    }

    /// Return the particle spacing, m.
    pub fn spacing(&self) -> f64 {
        RADIUS / f64::from(self.cells)
    }
}

/// Results of a run.
#[derive(Clone, Debug)]
pub struct Outcome {
    pub setup: Setup,
    /// Description of the method.
    pub method: String,
    pub sizes: Sizes,
    /// Mass over that of the bar.
    pub mass: f64,
    /// Kinetic energy removed by stabilisation and by the inelastic stop of particles at the wall, over the initial one.
    pub impacts: f64,
    /// Energy in the springs of the zero-energy penalty over the internal energy.
    pub springs: f64,
    pub peaks: Peaks,
    pub snapshot: Snapshot,
    pub ledger: Vec<LedgerEntry>,
    pub totals: Totals,
}

/// Largest values of the particles at the end.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Peaks {
    /// Temperature, K.
    pub temperature: f64,
    /// Equivalent plastic strain.
    pub plastic_strain: f64,
    /// Johnson-Cook damage.
    pub damage: f64,
    /// Number of particles with a damage of one.
    pub damaged: usize,
}

/// Output of a run.
#[derive(Clone, Copy, Debug)]
pub struct Files<'a> {
    pub folder: &'a Path,
    pub frames: u32,
    pub restart: &'a Restart,
}

/// Run the impact of the bar, with a label for its checkpoint; write files if `write`.
pub fn impact(setup: &Setup, label: &str, files: Files, write: bool) -> Result<Outcome, CaseError> {
    let [linear, quadratic] = setup.form.viscosity();
    let law = library::steel_4340()
        .with_failure(Counted { damage: JohnsonCookDamage::steel_4340(), failing: setup.failing })
        .with_bulk_viscosity(linear, quadratic)?
        .compiled();
    let run = Run { setup, label, files, write };
    match (setup.space, setup.form) {
        (Space::Quarter, _) => {
            let layout = quarter::layout(setup.spacing());
            let mut body = run.body(total_lagrangian(FullSpace, setup.penalty)?, law, &layout)?;
            body.bound(Boundary::Wall { axis: 2, at: 0.0, side: Side::Above, velocity: 0.0 })?;
            run.to_the_end(body, &layout)
        }
        (Space::Axisymmetric, Form::Printed) => {
            run.on_mirrors(Method::printed(Axisymmetric), law, &within(setup.spacing())?)
        }
        (Space::Axisymmetric, Form::Updated) => {
            let stabilisation = (ArtificialStress::default(), PairViscosity::default());
            let method =
                Method::new(Axisymmetric, WendlandC2::default(), Updated, GradientCorrection, stabilisation);
            run.on_mirrors(method, law, &within(setup.spacing())?)
        }
        (Space::Axisymmetric, Form::Total) => {
            let layout = on_the_ends(setup.spacing())?;
            let mut body = run.body(total_lagrangian(Axisymmetric, setup.penalty)?, law, &layout)?;
            body.bound(Boundary::Wall { axis: 1, at: 0.0, side: Side::Above, velocity: 0.0 })?;
            run.to_the_end(body, &layout)
        }
    }
}

/// Return [`Method::total_lagrangian`] with another penalty.
fn total_lagrangian<E>(
    embedding: E,
    penalty: f64,
) -> Result<Method<E, WendlandC2, TotalLagrangian, GradientCorrection, ZeroEnergyPenalty>, CaseError> {
    let penalty = ZeroEnergyPenalty::new(penalty).map_err(|e| CaseError::Other(e.to_string()))?;
    Ok(Method::new(embedding, WendlandC2::NARROW, TotalLagrangian::default(), GradientCorrection, penalty))
}

/// Generate particles half a spacing inside the surface.
pub fn within(spacing: f64) -> Result<Layout<2>, CaseError> {
    let bar = Cuboid::new([0.0; 2], [RADIUS, LENGTH])?;
    let lattice = Lattice::new([0.0; 2], spacing)?;
    Ok(Layout::of_seeds(&fill(&bar, &lattice, 1, &Filling::new().axisymmetric())?))
}

/// Generate rows of particles on both ends, half a spacing inside the mantle.
pub fn on_the_ends(spacing: f64) -> Result<Layout<2>, CaseError> {
    let bar = Cuboid::new([0.0; 2], [RADIUS, LENGTH])?;
    let lattice = Lattice::new([0.0; 2], spacing)?;
    Ok(Layout::on_faces(&bar, &lattice, [false, true], &Filling::new().axisymmetric())?)
}

/// Run to be started.
struct Run<'a> {
    setup: &'a Setup,
    label: &'a str,
    files: Files<'a>,
    write: bool,
}

impl Run<'_> {
    /// Build the bar, which moves along its last axis, with planes of symmetry normal to the others.
    fn body<const D: usize, M: Composition<D>>(
        &self,
        method: M,
        law: impl IntoMaterial<f64>,
        layout: &Layout<D>,
    ) -> Result<Sph<D, M>, CaseError> {
        let mut velocity = [0.0; D];
        velocity[D - 1] = -self.setup.speed;
        let mut body = Sph::new(method, law, layout, |_| velocity)?.named("bar");
        for axis in 0..D - 1 {
            body.bound(Boundary::Symmetry { axis, at: 0.0, side: Side::Above })?;
        }
        body.set_team(Team::new(self.setup.threads)?);
        Ok(body)
    }

    /// Run with a wall of mirror images.
    fn on_mirrors<M: Composition<2>>(
        &self,
        method: M,
        law: impl IntoMaterial<f64>,
        layout: &Layout<2>,
    ) -> Result<Outcome, CaseError> {
        let mut body = self.body(method, law, layout)?;
        body.mirror_wall(1, 0.0, Side::Above)?;
        self.to_the_end(body, layout)
    }

    fn to_the_end<const D: usize, M: Composition<D>>(
        &self,
        mut body: Sph<D, M>,
        layout: &Layout<D>,
    ) -> Result<Outcome, CaseError> {
        let (setup, Files { folder, frames, restart }) = (self.setup, self.files);
        let gauge = Gauge::of(layout);
        let start = body.totals();
        let mut ledger = Ledger::new(Pace::interval(HISTORY)?);
        let mut progress = Progress::new(format!("{:<28}", setup.words()));
        let mut observers: Vec<&mut dyn Observer> = vec![&mut ledger, &mut progress];
        let mut history = self.write.then(|| history::<D, M>(folder, setup, gauge.clone())).transpose()?;
        observers.extend(history.iter_mut().map(|h| h as &mut dyn Observer));
        let mut series = None;
        if self.write && frames > 0 {
            let pace = Pace::interval(END / f64::from(frames))?;
            series = Some(VtkSeries::create(folder.join("paraview"), setup.name(), pace)?);
        }
        observers.extend(series.iter_mut().map(|s| s as &mut dyn Observer));
        let mut simulation = restart.scene(self.label)?;
        simulation.until(&mut body, observers, END)?;
        let snapshot = body.snapshot()?;
        Ok(Outcome {
            setup: *setup,
            method: body.describe(),
            sizes: gauge.sizes(&body),
            mass: body.totals().mass / (body.material().density() * volume(setup)),
            impacts: Solver::exchange(&body).impacts / start.kinetic,
            springs: body.penalty_energy() / body.internal_energy(),
            peaks: Peaks::of(&snapshot)?,
            ledger: ledger.entries().to_vec(),
            totals: Totals::of(&body, &simulation.summary(), &ledger),
            snapshot,
        })
    }
}

/// Return the volume, m^3: per radian in axisymmetric runs, or of a quarter.
fn volume(setup: &Setup) -> f64 {
    let radian = 0.5 * RADIUS * RADIUS * LENGTH;
    if setup.space == Space::Quarter { std::f64::consts::FRAC_PI_2 * radian } else { radian }
}

impl Peaks {
    fn of(snapshot: &Snapshot) -> Result<Self, CaseError> {
        let most = |field| -> Result<f64, CaseError> {
            Ok(examples::largest(snapshot.scalar(field)?.iter().copied()))
        };
        Ok(Peaks {
            temperature: most("temperature")?,
            plastic_strain: most("plastic_strain")?,
            damage: most("failure_damage")?,
            damaged: snapshot.scalar("failure_damage")?.iter().filter(|d| **d >= 1.0).count(),
        })
    }
}

fn history<const D: usize, M: Composition<D>>(
    folder: &Path,
    setup: &Setup,
    gauge: Gauge,
) -> Result<impl Observer + use<D, M>, CaseError> {
    let columns = [
        ("time", "s"),
        ("length", "m"),
        ("diameter of the face", "m"),
        ("diameter at 0.2 L0", "m"),
        ("kinetic energy", "J"),
        ("internal energy", "J"),
        ("taken by stabilisation and stops at the wall", "J"),
        ("impulse of the wall", "N s"),
    ];
    let path = folder.join(format!("history_{}.csv", setup.name()));
    Ok(HistoryCsv::create(path, columns, Pace::interval(HISTORY)?, move |now: &RunView<'_>| {
        let Sizes { length, face, waist } = gauge.sizes(now.solver_as::<Sph<D, M>>()?);
        let exchange = now.exchange();
        Ok(vec![
            now.time(),
            length,
            face,
            waist,
            now.totals().kinetic,
            now.totals().internal,
            exchange.impacts,
            exchange.impulse[D - 1],
        ])
    })?)
}
