//! Plate and load.

use std::path::Path;
use std::sync::Arc;

use examples::CaseError;
use examples::cracks::{CrackOption, Load, Plane, Softening, Torn, random_cells};
use examples::fragile::Joint;
use fpm::{Cells, Domain, Notch};
use mpm_materials::{LinearElastic, Moduli};
use serde::Serialize;

/// Length and height, m, and tip of the notch, m.
pub const SIZE: [f64; 2] = [0.1, 0.04];
pub const TIP: [f64; 2] = [0.05, 0.02];
const YOUNG: f64 = 32e9;
const POISSON: f64 = 0.2;
const DENSITY: f64 = 2450.0;
/// Rayleigh wave speed, m/s.
pub const RAYLEIGH: f64 = 2119.0;

/// Parameters of a run.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Setup {
    pub cracks: CrackOption,
    pub softening: Softening,
    pub flux: Joint,
    pub plane: Plane,
    /// Tension on the long edges, Pa.
    pub load: f64,
    /// Width of cells, m.
    pub spacing: f64,
    pub seed: u64,
    /// Strength, Pa, and fracture energy, J/m^2.
    pub strength: f64,
    pub energy: f64,
    pub eta: f64,
    /// End time, s.
    pub end: f64,
    #[serde(skip)]
    pub threads: usize,
}

impl Setup {
    /// Label of the run, and name in files.
    pub fn name(&self) -> String {
        self.words().replace(", ", "_").replace(' ', "_")
    }

    /// Name in tables.
    pub fn words(&self) -> String {
        let (load, mm) = (self.load / 1e6, 1e3 * self.spacing);
        let (cracks, plane) = (self.cracks.words(), self.plane.words());
        format!("{cracks}, {load} MPa, {plane}, {mm:.3} mm, seed {}", self.seed)
    }

    /// Build random cells of about equal width.
    pub fn cells(&self) -> Result<Cells<2>, CaseError> {
        let refused = |e: fpm::CellsError| CaseError::Other(e.to_string());
        let domain = Domain::cuboid([0.0; 2], SIZE).map_err(refused)?;
        let notch = Notch::segment([0.0, TIP[1]], TIP).map_err(refused)?;
        random_cells(&domain, &notch, self.seed, |_| self.spacing, self.spacing)
    }

    /// Set up the plate of these cells.
    pub fn torn<'a>(
        &self,
        cells: &'a Cells<2>,
        folder: &'a Path,
        frames: u32,
    ) -> Result<Torn<'a>, CaseError> {
        let load = self.load;
        let glass = LinearElastic::new(DENSITY, Moduli::young_poisson(YOUNG, POISSON)?)?;
        Ok(Torn {
            name: self.name(),
            words: self.words(),
            cells,
            law: self.plane.elastic(glass),
            flux: self.flux,
            eta: self.eta,
            criterion: self.cracks.criterion(self.strength, self.strength, self.energy, self.softening)?,
            friction: 0.0,
            loads: vec![
                Load::Traction(|f| f.normal[1] > 0.5, Arc::new(move |_| [0.0, load])),
                Load::Traction(|f| f.normal[1] < -0.5, Arc::new(move |_| [0.0, -load])),
            ],
            tip: TIP,
            end: self.end,
            threads: self.threads,
            folder,
            frames,
        })
    }
}
