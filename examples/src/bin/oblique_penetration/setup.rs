//! Parameters of a run.

use clap::ValueEnum;
use examples::{CaseError, Coupling, Law, Ogive};
use mpm_materials::JohnsonCookDamage;
use serde::Serialize;

use crate::plate::Ductility;

/// Geometry of the rod \[Piekutowski1996\].
pub const ROD: Ogive = Ogive { diameter: 12.9e-3, length: 88.9e-3, crh: 3.0 };
/// Thickness of the plate, m.
pub const THICKNESS: f64 = 26.3e-3;
/// Density of the rod, kg/m^3: 4340 steel; 81.06 g.
pub const STEEL: f64 = 7830.0;

/// How a rod meets a plate.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Detection {
    /// By the distance of the surfaces along the line through the node, normals of the separating plane: the library's default
    Plane,
    /// By the distance of the surfaces
    Distance,
    /// By the distance of the surfaces within half a cell of the line through the node
    Local,
    /// The same, along the normal of the plane that best separates the particles
    Regression,
    /// They stick where they share a node: one velocity field
    Off,
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

/// Where the forces and strains of the rod are computed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum RodFrame {
    /// On a grid that flies with it: total Lagrangian. Meets the plate by springs (--law penalty)
    Reference,
    /// On the grid of the plate, through whose cells it flies
    Current,
    /// In finite elements, which meet the plate as --coupling says
    Fem,
}

/// What the plate is made of.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Target {
    /// Of particles
    Particles,
    /// Of elements as large as cells, which become particles near the rod and where they are deformed too far
    Afemp,
}

/// When the plate fails.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Criterion {
    /// Never
    None,
    /// At a plastic strain (--failure-strain)
    Strain,
    /// Johnson-Cook damage, D1 to D5 of 6061-T6
    JohnsonCook,
}

/// Parameters of a run.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Setup {
    /// Impact speed, m/s.
    pub speed: f64,
    /// Obliquity: angle between flight direction and plate normal, rad.
    pub angle: f64,
    /// Cells through the plate.
    pub cells: u32,
    /// Particles per cell along each axis.
    pub parts: u32,
    /// Half edge length of the square plate, m.
    pub half_width: f64,
    pub friction: f64,
    pub criterion: Criterion,
    /// Plastic strain at failure, for the criterion `Strain`.
    pub failure_strain: f64,
    pub kernel: Kernel,
    /// Time constant of the FLIP-PIC blend, in cell transits of sound.
    pub memory: f64,
    pub detection: Detection,
    pub rod: RodFrame,
    pub target: Target,
    pub coupling: Coupling,
    /// Edge of the rod's elements, m.
    pub edge: f64,
    pub law: Law,
    /// Free flight of the rod before impact, in plate thicknesses.
    pub stand_off: f64,
    /// True if the plate is deactivated until impact.
    pub rest: bool,
    /// Factor of the time step.
    pub factor: f64,
    pub threads: usize,
}

impl Setup {
    /// Cell size, m.
    pub fn spacing(&self) -> f64 {
        THICKNESS / f64::from(self.cells)
    }
    /// Return the path length of the rod's axis through the plate, m.
    pub fn way(&self) -> f64 {
        THICKNESS / self.angle.cos()
    }
    /// Return the free flight of the rod before impact, m.
    pub fn flight(&self) -> f64 {
        self.stand_off * THICKNESS
    }
    /// True for the shot of \[Ma2010\].
    pub fn is_the_paper_s(&self) -> bool {
        self.speed == 575.0 && (self.angle.to_degrees() - 30.0).abs() < 1e-9
    }
    /// Return the name in file names.
    pub fn name(&self) -> String {
        let target = if self.target == Target::Afemp { "_afemp" } else { "" };
        format!("{:.0}_{:.0}deg_{}{target}", self.speed, self.angle.to_degrees(), self.cells)
    }
    /// Return the failure criterion of the plate.
    ///
    /// # Errors
    /// Failure strain that is not positive.
    pub fn ductility(&self) -> Result<Ductility, CaseError> {
        Ok(match self.criterion {
            Criterion::None => Ductility::Whole,
            Criterion::Strain => Ductility::strain(self.failure_strain)?,
            Criterion::JohnsonCook => Ductility::Damage(JohnsonCookDamage::aluminium_6061()),
        })
    }
}
