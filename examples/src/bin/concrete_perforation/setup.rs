//! Parameters of a run.

use clap::ValueEnum;
use examples::{Coupling, Ogive};
use serde::Serialize;

/// Rod \[Hanchak1992\]: diameter and nose as in its summary, the length \[M\].
pub const ROD: Ogive = Ogive { diameter: 25.4e-3, length: 143.7e-3, crh: 3.0 };
/// Mass of the whole rod, kg; its density follows.
pub const MASS: f64 = 0.50;
/// Thickness of the slab, m.
pub const THICKNESS: f64 = 0.178;
/// Half the edge of the slab of \[Ma2010\], m: from its number of particles.
pub const HALF_WIDTH: f64 = 0.305;
/// Young's modulus of the rod \[Ma2010\], Pa; the paper does not state Poisson's ratio.
pub const YOUNG: f64 = 212.42e9;

/// Impact and residual speeds of the shots at 48 MPa, m/s \[Hanchak1992\], from memory of the literature \[M\].
pub const SHOTS: [[f64; 2]; 7] = [
    [301.0, 0.0],
    [360.0, 67.0],
    [381.0, 136.0],
    [434.0, 214.0],
    [606.0, 449.0],
    [749.0, 615.0],
    [1058.0, 947.0],
];

/// How the slab lies in space.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Model {
    /// A quarter of a square slab, between two planes of symmetry
    Quarter,
    /// A round slab of the same half width, in radius and height: no radial cracks
    Axisymmetric,
}

/// What the rod is made of.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Rod {
    /// Linear elastic steel
    Elastic,
    /// A free rigid body
    Rigid,
    /// Linear elastic steel in finite elements, which meet the slab as --coupling says
    Fem,
}

/// How rod and slab meet.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Detection {
    /// By the distance of the surfaces along gradients, within half a cell of the line through the node
    Gradients,
    /// By the distance along the normal of the plane that best separates the particles
    Regression,
    /// By the distance along the volume gradient of the rod
    Rod,
}

/// Shape function, transfer and stress update.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Kernel {
    /// What the library has for impact: quadratic B-splines, AFLIP, USL
    Impact,
    /// Linear shape functions, FLIP or a blend, MUSL
    Linear,
    /// Convected-particle GIMP, FLIP or a blend, MUSL
    Cpgimp,
}

impl Model {
    /// Name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Model::Quarter => "quarter",
            Model::Axisymmetric => "axisymmetric",
        }
    }
}

/// Parameters of a run.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Setup {
    /// Impact speed, m/s.
    pub speed: f64,
    pub model: Model,
    pub rod: Rod,
    pub coupling: Coupling,
    /// Edge of the elements of the rod, m.
    pub rod_edge: f64,
    /// Cells through the slab.
    pub cells: u32,
    /// Particles a cell along each axis.
    pub parts: u32,
    /// Half the edge of the slab, or its radius, m.
    pub half_width: f64,
    pub friction: f64,
    pub kernel: Kernel,
    /// Memory of FLIP: decay time of velocities that the nodes do not resolve, in transits of a cell by sound.
    pub memory: f64,
    pub detection: Detection,
    /// Courant factor of the time step.
    pub factor: f64,
    pub threads: usize,
}

impl Setup {
    /// Cell size, m.
    pub fn spacing(&self) -> f64 {
        THICKNESS / f64::from(self.cells)
    }
    /// Edge of a particle, m.
    pub fn edge(&self) -> f64 {
        self.spacing() / f64::from(self.parts)
    }
    /// Ratio of the whole to the model.
    pub fn copies(&self) -> f64 {
        match self.model {
            Model::Quarter => 4.0,
            Model::Axisymmetric => std::f64::consts::TAU,
        }
    }
    /// Name in files.
    pub fn name(&self) -> String {
        format!("{}_{:.0}_{}", self.model.name(), self.speed, self.cells)
    }
}
