//! Finite element problems: the square of V3 with the body force as nodal impulses, and standing waves of a square.
//!
//! Small-amplitude waves in the unit square between symmetry planes on all sides, with wave numbers k = pi and l = 2 pi: the pressure
//! wave u = grad(cos k x cos l y) oscillates with w = c_p sqrt(k^2 + l^2), the shear wave u = (d/dy, -d/dx) (sin k x sin l y) with c_s
//! instead of c_p. Both have zero normal velocity and zero shear stress on the planes. Meshes are distorted: inner nodes are randomly
//! displaced by up to 15 % of the spacing.

use std::f64::consts::PI;

use fem::{Fem, Hourglass, MeshBody, Technology};
use mpm_core::geometry::structured::box_mesh;
use mpm_core::geometry::{Cuboid, ElementKind, ElementMesh};
use mpm_core::{PlaneStrain, Solver};

use crate::problems::{axis_aligned, box_of_planes, rubber};

/// Element type of the square.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Elements {
    /// Quadrilateral elements.
    Quadrilaterals(Technology),
    /// Triangular elements, two per quadrilateral.
    Triangles(Technology),
}

impl Elements {
    /// Element types under test: quadrilaterals with one point, with full integration and with mean dilatation, triangles with
    /// averaged volumes and without.
    pub const ALL: [Elements; 5] = [
        Elements::Quadrilaterals(Technology::OnePoint(Hourglass::Stiffness(0.05))),
        Elements::Quadrilaterals(Technology::Full),
        Elements::Quadrilaterals(Technology::MeanDilatation),
        Elements::Triangles(Technology::AveragedVolumes),
        Elements::Triangles(Technology::Full),
    ];

    /// Split quadrilaterals into triangles for triangular elements.
    ///
    /// # Errors
    /// Errors of the mesh.
    pub fn cut(self, mesh: ElementMesh<2>) -> Result<ElementMesh<2>, String> {
        match self {
            Elements::Quadrilaterals(_) => Ok(mesh),
            Elements::Triangles(_) => mesh.split_to_triangles().map_err(text),
        }
    }

    /// Element kind and integration technology.
    pub fn technology(self) -> (ElementKind, Technology) {
        match self {
            Elements::Quadrilaterals(technology) => (ElementKind::Quad4, technology),
            Elements::Triangles(technology) => (ElementKind::Triangle3, technology),
        }
    }
}

/// Standing wave type.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wave {
    /// Pressure wave.
    Pressure,
    /// Shear wave.
    Shear,
}

const K: [f64; 2] = [PI, 2.0 * PI];
const POISSON: f64 = 0.3;
/// Wave amplitude, m: stresses are linear in strains to nine digits.
const SMALL: f64 = 1e-9;
/// Number of samples in a run.
const LOOKS: u64 = 20;
/// Courant number of V3 by the element size; the shortest deformed element has 0.69 of it and four times the stiffness.
const COURANT: f64 = 0.15;

impl Wave {
    /// Both wave types.
    pub const ALL: [Wave; 2] = [Wave::Pressure, Wave::Shear];

    /// Angular frequency, rad/s, for E = 1 Pa and 1 kg/m^3.
    fn frequency(self) -> f64 {
        let shear = 0.5 / (1.0 + POISSON);
        let square = match self {
            Wave::Pressure => shear * 2.0 * (1.0 - POISSON) / (1.0 - 2.0 * POISSON),
            Wave::Shear => shear,
        };
        (square * (K[0] * K[0] + K[1] * K[1])).sqrt()
    }

    /// Displacement amplitude at a position, m, scaled by the wave amplitude.
    fn shape(self, x: [f64; 2]) -> [f64; 2] {
        let [k, l] = K;
        let [(sx, cx), (sy, cy)] = [(k * x[0]).sin_cos(), (l * x[1]).sin_cos()];
        let scale = SMALL / (k * k + l * l).sqrt();
        match self {
            Wave::Pressure => [-scale * k * sx * cy, -scale * l * cx * sy],
            Wave::Shear => [scale * l * sx * cy, -scale * k * cx * sy],
        }
    }
}

fn text(error: impl std::fmt::Display) -> String {
    error.to_string()
}

/// Return a pseudo-random number in (-1, 1) by seed.
pub(crate) fn anywhere(seed: u64) -> f64 {
    let mut z = seed.wrapping_add(1).wrapping_mul(0x9E37_79B9_7F4A_7C15);
    for shift in [30, 27, 31] {
        z = (z ^ (z >> shift)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    }
    (z >> 11) as f64 / (1u64 << 52) as f64 - 1.0
}

/// Mesh the unit square with `cells` x `cells` quadrilaterals, split for triangles; inner nodes are displaced by up
/// to `part` of a spacing.
fn square(elements: Elements, cells: usize, part: f64) -> Result<ElementMesh<2>, String> {
    let mut mesh = box_mesh(&Cuboid::new([0.0; 2], [1.0; 2]).map_err(text)?, [cells; 2]).map_err(text)?;
    let h = 1.0 / cells as f64;
    for (n, x) in (0..).zip(&mut mesh.nodes) {
        if x.iter().all(|c| *c > 0.5 * h && *c < 1.0 - 0.5 * h) {
            *x = std::array::from_fn(|d| x[d] + part * h * anywhere(2 * n + d as u64));
        }
    }
    elements.cut(mesh)
}

fn scene(
    elements: Elements,
    mesh: ElementMesh<2>,
    velocity: impl Fn([f64; 2]) -> [f64; 2] + Send + Sync + 'static,
) -> Result<Fem<2>, String> {
    let (kind, technology) = elements.technology();
    let body = MeshBody::new("square", mesh, rubber(1.0, 1.0, POISSON)?).with(kind, technology);
    let mut fem = Fem::new(PlaneStrain);
    fem.add(body.moving(velocity)).map_err(text)?;
    for plane in box_of_planes(0..2, 0.0, 1.0) {
        fem.bound(plane).map_err(text)?;
    }
    Ok(fem)
}

/// Root mean square error of the displacement, mass-weighted, m.
fn error(fem: &Fem<2>, rest: &[[f64; 2]], exact: impl Fn([f64; 2]) -> [f64; 2]) -> f64 {
    let (mut sum, mut mass) = (0.0, 0.0);
    for (node, &x) in fem.body(0).nodes().iter().zip(rest) {
        let u = exact(x);
        let square: f64 = (0..2).map(|d| (node.position[d] - x[d] - u[d]).powi(2)).sum();
        (sum, mass) = (sum + node.mass * square, mass + node.mass);
    }
    (sum / mass).sqrt()
}

/// Run a standing wave for two periods with default settings; return the largest displacement error of 20 samples over the
/// amplitude.
///
/// # Errors
/// Errors of the scene and of the run.
pub fn standing(elements: Elements, wave: Wave, cells: usize) -> Result<f64, String> {
    let frequency = wave.frequency();
    let mesh = square(elements, cells, 0.15)?;
    let rest = mesh.nodes.clone();
    let mut fem = scene(elements, mesh, move |x| wave.shape(x).map(|u| frequency * u))?;
    let mut worst = 0.0f64;
    for look in 1..=LOOKS {
        let time = 4.0 * PI / frequency * look as f64 / LOOKS as f64;
        fem.run_until(time).map_err(text)?;
        let now = (frequency * time).sin();
        worst = worst.max(error(&fem, &rest, |x| wave.shape(x).map(|u| now * u)) / SMALL);
    }
    Ok(worst)
}

/// Run V3 with finite elements; return the largest displacement error of 20 samples over the amplitude.
///
/// # Errors
/// Errors of the scene and of the run.
pub fn pulsating(elements: Elements, cells: usize) -> Result<f64, String> {
    let mesh = square(elements, cells, 0.0)?;
    let rest = mesh.nodes.clone();
    let moved = |x: [f64; 2], t: f64| [0, 1].map(|d| axis_aligned::motion(d, x[d], t));
    let mut fem = scene(elements, mesh, move |x| moved(x, 0.0).map(|(_, v, _)| v))?;
    let each = (cells as f64 / COURANT / LOOKS as f64).ceil() as u64;
    let dt = 1.0 / (each * LOOKS) as f64;
    let mut worst = 0.0f64;
    for step in 0..each * LOOKS {
        let time = step as f64 * dt;
        // Leapfrog velocities are at mid-step: the first force acts for half a step.
        let kick = if step == 0 { 0.5 * dt } else { dt };
        let mut trial = fem.trial(dt).map_err(text)?;
        for (n, x) in rest.iter().enumerate() {
            let mass = trial.bodies()[0].nodes()[n].mass;
            let force = axis_aligned::force(x, time);
            trial.body_mut(0).add_impulse(n, force.map(|b| kick * mass * b));
        }
        trial.finish().map_err(text)?;
        if (step + 1) % each == 0 {
            let now = error(&fem, &rest, |x| moved(x, time + dt).map(|(u, ..)| u));
            worst = worst.max(now / axis_aligned::AMPLITUDE);
        }
    }
    Ok(worst)
}
