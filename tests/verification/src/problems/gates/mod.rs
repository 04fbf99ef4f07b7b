//! Gates: benchmarks of all methods, one law each. Bar on a rigid wall (A), cantilever under a pulse (B), vibrating beam (C), plate impact
//! (D), Taylor bars of steel (G), and a pulled plate. Methods are the material point method, particle contacts, smoothed particles, finite
//! elements and fragile points, as far as they support the gate: tractions (B and the plate), axisymmetry (G). Taylor bars (G) are also run
//! by elements with conversion to particles. Kalthoff's plate (H) is run by fragile points only, whose cracks need no predefined path.
//!
//! | gate | scene | reference |
//! |---|---|---|
//! | A | 0.2 m of E 200 GPa, nu 0, 7850 kg/m^3 at 10 m/s | velocity of d'Alembert's two fronts, rebound at 10 m/s without residual energy (exact) |
//! | B | plane stress, 48 x 12 m, clamped, E 30 MPa, nu 0.3, 1 kg/m^3, 100 Pa of shear on the end for 0.5 s | displacement of the end (96 x 24 elements of eight nodes) |
//! | C | plane strain, 0.2 x 0.02 m, clamped, E 2 MPa, nu 0.3975, 1000 kg/m^3 | lowest frequency, 3.9210 Hz (CalculiX, 80 x 8 elements of eight nodes) |
//! | D | half of a symmetric impact at 500 m/s: 0.1 m of copper without strength at 250 m/s on a wall | pressure, density and energy behind the shock, its speed (Rankine and Hugoniot, exact) |
//! | G | 4340 steel, 7.595 x 37.97 mm, at 181, 224 and 270 m/s | lengths of two axisymmetric finite element codes |
//! | H | half of Kalthoff's plate of steel, 0.1 x 0.1 m, plane stress, struck at 16.5 m/s | angle, start and work of the crack (experiment, peridynamics, phase fields) |
//! | pull | 4 m of E 80 kPa, nu 0, 1 kg/m^3, clamped, pulled by half a sine and a sine squared | displacement (exact) |

mod bar;
mod beam;
mod cantilever;
mod coupled;
mod kalthoff;
mod matter;
mod plate;
mod pull;
mod solved;
mod taylor;

use fem::{Hourglass, Technology};
use mpm_core::{IntoKernels, Linear, Method, Musl, PlaneStrain, TimeControl};

use crate::case::Outcome;
use crate::fragile::{Cracks, Fragile};
use crate::problems::elements::Elements;
use crate::smoothed::Smoothed;
use crate::stored::{self, Stored};

/// Benchmark of all methods.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Gate {
    /// A: bar on a rigid wall. Resolution: cells along it.
    Bar,
    /// B: cantilever under a pulse. Resolution: cells through its thickness.
    Cantilever,
    /// C: vibrating beam. Resolution: cells through its thickness.
    Beam,
    /// D: half of a symmetric plate impact. Resolution: cells along it.
    Plate,
    /// G: Taylor bars. Resolution: cells along the radius.
    Taylor,
    /// H: Kalthoff's plate. Resolution: cells along it.
    Kalthoff,
    /// Pulled plate. Resolution: cells along it.
    Pull,
}

impl Gate {
    /// All gates.
    pub const ALL: [Gate; 7] =
        [Gate::Bar, Gate::Cantilever, Gate::Beam, Gate::Plate, Gate::Taylor, Gate::Kalthoff, Gate::Pull];

    /// Name in files.
    pub const fn name(self) -> &'static str {
        match self {
            Gate::Bar => "gate A bar",
            Gate::Cantilever => "gate B cantilever",
            Gate::Beam => "gate C beam",
            Gate::Plate => "gate D plate",
            Gate::Taylor => "gate G steel bars",
            Gate::Kalthoff => "gate H Kalthoff",
            Gate::Pull => "pulled plate",
        }
    }

    /// List the methods that support the gate.
    pub fn ways(self) -> Vec<Way> {
        let elements = |way: &Way| matches!(way, Way::Elements(_) | Way::Linear | Way::Impact);
        let fragile = Fragile::ALL.map(Way::Fragile);
        match self {
            Gate::Bar | Gate::Beam | Gate::Plate => Way::ALL.into_iter().chain(fragile).collect(),
            Gate::Cantilever | Gate::Pull => Way::ALL.into_iter().filter(elements).chain(fragile).collect(),
            Gate::Taylor => Way::ALL.into_iter().chain([Way::Mpfem, Way::Afemp]).collect(),
            Gate::Kalthoff => Cracks::ALL.map(Way::Cracks).to_vec(),
        }
    }
}

/// Method of a gate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Way {
    /// Material points with linear shape functions, FLIP, MUSL.
    Linear,
    /// Material points by `Method::impact`: quadratic splines, AFLIP.
    Impact,
    /// Particle contacts, `pcmm::Method::consistent`.
    Contacts,
    /// Smoothed particles, `sph::Method::total_lagrangian`.
    TotalLagrangian,
    /// Smoothed particles, `sph::Method::updated`.
    Updated,
    /// Finite elements.
    Elements(Elements),
    /// Fragile points.
    Fragile(Fragile),
    /// Fragile points with face failure.
    Cracks(Cracks),
    /// Elements with initial particles near the wall, `coupling::Conversion::within`.
    Mpfem,
    /// Elements converted to particles at large deformation, `coupling::Conversion::adaptive`.
    Afemp,
}

impl Way {
    /// The methods of plane and axisymmetric gates, without elements converted to particles.
    pub const ALL: [Way; 8] = [
        Way::Linear,
        Way::Impact,
        Way::Contacts,
        Way::TotalLagrangian,
        Way::Updated,
        Way::Elements(Elements::Quadrilaterals(Technology::OnePoint(Hourglass::Stiffness(0.05)))),
        Way::Elements(Elements::Quadrilaterals(Technology::MeanDilatation)),
        Way::Elements(Elements::Triangles(Technology::AveragedVolumes)),
    ];

    /// Name in files.
    pub fn name(self) -> &'static str {
        match self {
            Way::Linear => "MPM linear FLIP-MUSL",
            Way::Impact => "MPM quadratic AFLIP",
            Way::Contacts => "PCMM",
            Way::TotalLagrangian => Smoothed::TotalLagrangian.name(),
            Way::Updated => Smoothed::Updated.name(),
            Way::Elements(Elements::Quadrilaterals(Technology::OnePoint(_))) => "FE one point",
            Way::Elements(Elements::Quadrilaterals(Technology::MeanDilatation)) => "FE mean dilatation",
            Way::Elements(Elements::Quadrilaterals(_)) => "FE in full",
            Way::Elements(Elements::Triangles(Technology::AveragedVolumes)) => "FE averaged triangles",
            Way::Elements(Elements::Triangles(_)) => "FE triangles",
            Way::Fragile(fragile) => fragile.name(),
            Way::Cracks(cracks) => cracks.name(),
            Way::Mpfem => "MPFEM",
            Way::Afemp => "AFEMP",
        }
    }

    /// Number of nodes of an integration point, times integration points per moving point of the solver; for elements converted to
    /// particles, before conversion.
    fn nodes(self) -> u64 {
        match self {
            Way::Linear | Way::Elements(Elements::Quadrilaterals(Technology::OnePoint(_))) => 4,
            Way::Impact => 9,
            Way::Contacts | Way::Elements(Elements::Triangles(_)) => 3,
            Way::TotalLagrangian => Smoothed::TotalLagrangian.neighbours(),
            Way::Updated => Smoothed::Updated.neighbours(),
            Way::Elements(Elements::Quadrilaterals(_)) | Way::Mpfem | Way::Afemp => 16,
            Way::Fragile(fragile) => fragile.neighbours(),
            Way::Cracks(_) => 6,
        }
    }

    /// Particles per cell and axis; one element per cell, also for elements converted to particles.
    pub fn per_axis(self) -> usize {
        if matches!(self, Way::Linear | Way::Impact) { 2 } else { 1 }
    }

    /// Courant number by default: fraction of the time step bound of the method's theory.
    pub fn courant(self) -> f64 {
        let of = |control| match control {
            TimeControl::Courant { factor, .. } => factor,
            _ => f64::NAN,
        };
        match self {
            Way::Linear => {
                let method = Method::new(Linear, mpm_core::Flip, Musl, PlaneStrain);
                of(method.into_kernels().facts().time_control())
            }
            Way::Impact | Way::Mpfem | Way::Afemp => {
                of(Method::impact(PlaneStrain).into_kernels().facts().time_control())
            }
            Way::Contacts => 0.5,
            Way::TotalLagrangian | Way::Updated => Smoothed::COURANT,
            Way::Elements(_) => 0.9,
            Way::Fragile(_) | Way::Cracks(_) => Fragile::COURANT,
        }
    }
}

/// Gate, method and resolution.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Passage {
    /// Gate to run.
    pub gate: Gate,
    /// Method to run it by.
    pub way: Way,
    /// Number of cells along the length of the gate.
    pub cells: usize,
}

impl Passage {
    /// Run the gate with the default settings of the method.
    pub fn run(self) -> Outcome {
        let made = match self.gate {
            Gate::Bar => bar::run(self),
            Gate::Beam => beam::run(self),
            Gate::Plate => plate::run(self),
            Gate::Taylor => taylor::run(self),
            Gate::Cantilever => cantilever::run(self),
            Gate::Pull => pull::run(self),
            Gate::Kalthoff => match self.way {
                Way::Cracks(cracks) => kalthoff::run(self, cracks),
                other => Err(format!("{} has no cracks", other.name())),
            },
        };
        made.unwrap_or_else(Outcome::refused)
    }
}

impl Stored for Passage {
    fn key(&self) -> String {
        let Passage { gate, way, cells } = self;
        stored::columns(gate.name(), way.name(), way.per_axis(), *cells, way.courant())
    }
    fn cells(&self) -> usize {
        self.cells
    }
    fn outcome(&self) -> Outcome {
        self.run()
    }
    /// Fragile points conserve energy to the round-off of the law's sums over ten thousands of steps.
    fn round_off(&self) -> f64 {
        if matches!(self.way, Way::Fragile(_)) { 1e-6 } else { stored::ROUND_OFF }
    }
}

/// List the passages of a gate with stored errors: every method on coarse grids, seconds per gate. Exclusions: material points with linear
/// shape functions that cross cells, whose noise is not reproducible, crack paths, which depend on round-off (tests of `fpm` cover them),
/// and elements converted to particles for the same reason. Smoothed particles and random cells need more cells through a beam.
pub fn stored(gate: Gate) -> Vec<Passage> {
    let grids = |way| -> &[usize] {
        match (gate, way) {
            (Gate::Plate | Gate::Taylor, Way::Linear)
            | (Gate::Kalthoff, _)
            | (_, Way::Mpfem | Way::Afemp) => &[],
            (Gate::Bar | Gate::Plate, _) => &[25, 50, 100],
            (Gate::Beam, Way::TotalLagrangian) => &[4, 8, 16],
            (Gate::Beam, Way::Fragile(Fragile { random: true, .. })) => &[4, 8, 12],
            (Gate::Beam, _) => &[2, 4, 8],
            (Gate::Cantilever, _) => &[3, 6, 12],
            (Gate::Pull, _) => &[40, 80, 160],
            (Gate::Taylor, _) => &[4, 8],
        }
    };
    let of = |way| grids(way).iter().map(move |&cells| Passage { gate, way, cells });
    gate.ways().into_iter().flat_map(of).collect()
}
