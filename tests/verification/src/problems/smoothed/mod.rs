//! Smoothed particles against closed-form solutions and independent computations: linear fields, uniform stress at the axis, breathing
//! modes, a tube under pressure, a beam with large deflection.
//!
//! | problem | reference |
//! |---|---|
//! | patch | uniform strain in a linear velocity field, on disordered particles |
//! | axis | zero acceleration under uniform stress; errors over s / (rho r) |
//! | sphere, cylinder | lowest frequencies, 248.88 and 198.13 kHz of steel with a radius of 10 mm (roots 2.6702 and 2.1257, exact) |
//! | tube, axisymmetric and plane | Lame: radii 10 and 20 mm, inner pressure p, plane strain: hoop stress 5 p / 3, displacement at bore |
//! | beam | Turek-Hron benchmark CSM3: tip displacements of 129.73 mm down and 29.30 mm back |
//!
//! Smoothed particles have no pressure boundary condition. The particles at the bore of the tube carry the forces that balance a uniform
//! pressure, and oscillations are damped until the tube rests: this is the equilibrium of the discrete body for any damping.

mod beam;
mod breathing;
mod patch;
mod tube;

use std::fmt::Debug;

use mpm_contact::particles::ParticleBody;
use mpm_core::{Boundary, Embedding};
use mpm_materials::{IntoMaterial, LinearElastic, Moduli};
use sph::{Composition, CubicSpline, GradientCorrection, Layout, Method, Sph, Unstabilised, Updated};

use crate::case::Outcome;
use crate::smoothed::{March, Smoothed};
use crate::stored::{self, Stored};
use crate::work::{Stopwatch, Work};

/// Test problem of smoothed particles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Question {
    /// Strain uniformity in a linear velocity field. Resolution: cells of the block.
    Patch,
    /// Acceleration under uniform stress at the axis. Resolution: cells of the block.
    Axis,
    /// Breathing frequency of a sphere, axisymmetric. Resolution: cells along the radius, here and below.
    Sphere,
    /// Breathing frequency of an eighth of a sphere in three dimensions.
    Eighth,
    /// Breathing frequency of a long cylinder.
    Cylinder,
    /// Stress of a tube under pressure, axisymmetric. Resolution: cells through its wall.
    Tube,
    /// Stress of a quarter tube in the plane, on rings of particles.
    Quarter,
    /// Deflection of a swinging beam. Resolution: cells through its thickness.
    Beam,
}

/// Method of smoothed particles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum By {
    /// Method that charts include, too.
    Charted(Smoothed),
    /// `sph::Method::printed`.
    Printed,
    /// Updated Lagrangian method with corrected gradients, the cubic spline and no stabilisation.
    Bare,
}

const TOTAL: By = By::Charted(Smoothed::TotalLagrangian);
const UPDATED: By = By::Charted(Smoothed::Updated);

/// Problem, method and resolution.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Trial {
    /// Test problem.
    pub question: Question,
    /// Method to run it by.
    pub by: By,
    /// Number of cells along the length of the problem.
    pub cells: usize,
}

impl Question {
    /// All problems.
    pub const ALL: [Question; 8] = [
        Question::Patch,
        Question::Axis,
        Question::Sphere,
        Question::Eighth,
        Question::Cylinder,
        Question::Tube,
        Question::Quarter,
        Question::Beam,
    ];

    /// Name in files.
    pub const fn name(self) -> &'static str {
        match self {
            Question::Patch => "SPH patch",
            Question::Axis => "SPH axis",
            Question::Sphere => "SPH sphere",
            Question::Eighth => "SPH sphere 3D",
            Question::Cylinder => "SPH cylinder",
            Question::Tube => "SPH tube",
            Question::Quarter => "SPH tube in the plane",
            Question::Beam => "SPH beam",
        }
    }
}

impl By {
    /// Name in files.
    pub const fn name(self) -> &'static str {
        match self {
            By::Charted(smoothed) => smoothed.name(),
            By::Printed => "SPH as printed",
            By::Bare => "SPH updated unstabilised",
        }
    }
}

/// List the trials of a problem with stored errors. In sustained tension, as in the tube, artificial stress prevents particles from
/// resting: there is no equilibrium to measure.
pub fn stored(question: Question) -> Vec<Trial> {
    let (list, grids): (&[By], &[usize]) = match question {
        Question::Patch => (&[TOTAL, UPDATED, By::Printed], &[6]),
        Question::Axis => (&[TOTAL, UPDATED, By::Printed], &[12]),
        Question::Sphere => (&[TOTAL, UPDATED, By::Bare], &[10, 20, 40]),
        Question::Eighth => (&[TOTAL], &[6, 8, 10]),
        Question::Cylinder => (&[TOTAL, UPDATED], &[10, 20, 40]),
        Question::Tube | Question::Quarter => (&[TOTAL, By::Bare], &[10, 20, 40]),
        Question::Beam => (&[TOTAL], &[6, 8, 12]),
    };
    let of = |&by: &By| grids.iter().map(move |&cells| Trial { question, by, cells });
    list.iter().flat_map(of).collect()
}

impl Trial {
    /// Run the trial.
    pub fn run(self) -> Outcome {
        let Trial { question, by, cells } = self;
        let made = match question {
            Question::Patch => patch::linear(by, cells),
            Question::Axis => patch::axis(by, cells),
            Question::Sphere => breathing::sphere(by, cells),
            Question::Eighth => breathing::eighth(by, cells),
            Question::Cylinder => breathing::cylinder(by, cells),
            Question::Tube => tube::around_the_axis(by, cells),
            Question::Quarter => tube::in_the_plane(by, cells),
            Question::Beam => beam::run(by, cells),
        };
        made.unwrap_or_else(Outcome::refused)
    }
}

impl Stored for Trial {
    fn key(&self) -> String {
        stored::columns(self.question.name(), self.by.name(), 1, self.cells, Smoothed::COURANT)
    }
    fn cells(&self) -> usize {
        self.cells
    }
    fn outcome(&self) -> Outcome {
        self.run()
    }
}

/// Density of steel, kg/m^3.
const DENSITY: f64 = 7850.0;

fn text(error: impl std::fmt::Display) -> String {
    error.to_string()
}

/// Steel with Young's modulus 200 GPa and Poisson's ratio 0.3.
fn steel() -> Result<LinearElastic<f64>, String> {
    let moduli = Moduli::young_poisson(200e9, 0.3).map_err(text)?;
    LinearElastic::new(DENSITY, moduli).map_err(text)
}

/// Particles with initial velocity and boundary conditions.
struct Setup<'a, const D: usize> {
    layout: &'a Layout<D>,
    velocity: &'a dyn Fn([f64; D]) -> [f64; D],
    boundaries: Vec<Boundary<D>>,
}

impl<const D: usize> Setup<'_, D> {
    /// Build the body of a law by a method in an embedding.
    fn body<E: Embedding<D> + Debug>(
        &self,
        by: By,
        space: E,
        law: impl IntoMaterial<f64>,
    ) -> Result<March<D>, String> {
        match by {
            By::Charted(Smoothed::TotalLagrangian) => self.of(Method::total_lagrangian(space), law),
            By::Charted(Smoothed::Updated) => self.of(Method::updated(space), law),
            By::Printed => self.of(Method::printed(space), law),
            By::Bare => {
                let spline = CubicSpline::default();
                self.of(Method::new(space, spline, Updated, GradientCorrection, Unstabilised), law)
            }
        }
    }

    fn of<M: Composition<D>>(&self, method: M, law: impl IntoMaterial<f64>) -> Result<March<D>, String> {
        let mut body = Sph::new(method, law, self.layout, self.velocity).map_err(text)?;
        for boundary in &self.boundaries {
            body.bound(boundary.clone()).map_err(text)?;
        }
        let body: Box<dyn ParticleBody<D>> = Box::new(body);
        Ok(March::new(body))
    }
}

/// Time step, s: fraction of the stable step.
fn step<const D: usize>(march: &March<D>) -> f64 {
    Smoothed::COURANT / march.body.rate()
}

/// Create an outcome without measures of a run timed by a watch.
fn outcome<const D: usize>(march: &March<D>, watch: &Stopwatch) -> Outcome {
    let work = Work {
        particles: march.body.len() as u64,
        steps: march.steps,
        nodes: 0,
        seconds: watch.seconds(),
        bytes: march.body.bytes() as u64,
    };
    Outcome { work, ..Outcome::default() }
}
