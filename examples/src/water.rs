//! Weakly compressible water in the plane.

use clap::ValueEnum;
use mpm_core::{IntoKernels, Kernels, Method, PlaneStrain};
use mpm_materials::{Constitutive, Fluid, Lane, Tait};
use serde::Serialize;

use crate::CaseError;

/// Water with an artificial sound speed: high enough for small changes of density, low enough for long steps \[Zhang2017\].
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Water {
    /// Density at rest, kg/m^3.
    pub density: f64,
    /// Sound speed at rest, m/s.
    pub sound: f64,
}

/// State variables of a material point of [`Water`].
pub type WaterState = <Fluid<Tait<f64>> as Constitutive<f64>>::State<<f64 as mpm_materials::Real>::Single>;

impl Water {
    /// Density of water, kg/m^3.
    pub const DENSITY: f64 = 1000.0;

    /// Create water with this sound speed, m/s.
    pub fn of(sound: f64) -> Self {
        Water { density: Self::DENSITY, sound }
    }

    /// Return the law: Tait equation of state, inviscid.
    ///
    /// # Errors
    /// Constants that are not positive.
    pub fn law(&self) -> Result<Fluid<Tait<f64>>, CaseError> {
        Ok(Fluid::new(Tait::new(self.density, self.sound)?))
    }

    /// Return the state of a material point under a pressure, Pa: J = (1 + 7 p / (rho c^2))^(-1/7).
    pub fn under(&self, law: &Fluid<Tait<f64>>, pressure: f64) -> WaterState {
        WaterState { volume_ratio: Lane::splat(self.ratio(pressure)), ..law.virgin() }
    }

    /// Return the volume ratio under a pressure, Pa.
    pub fn ratio(&self, pressure: f64) -> f64 {
        (1.0 + 7.0 * pressure / (self.density * self.sound.powi(2))).powf(-1.0 / 7.0)
    }

    /// Return the kernels in plane strain: quadratic B-splines and affine transfers, USL, and mean dilatation of a cell,
    /// without which the pressure alternates between particles by more than its value.
    pub fn method(transfer: Transfer) -> Kernels<f64, 2> {
        match transfer {
            Transfer::Apic => {
                Method::contact_at_rest(PlaneStrain).mean_dilatation().compiled().into_kernels()
            }
            Transfer::Aflip => Method::impact(PlaneStrain).mean_dilatation().compiled().into_kernels(),
        }
    }
}

/// How particles of water take velocities from the grid.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Transfer {
    /// With the affine field around them: water at rest stays at rest
    Apic,
    /// Their change, with that field: keeps more energy, and more noise; what elements on the grid ask for
    Aflip,
}
