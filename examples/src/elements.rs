//! Bodies of finite elements in scenes of material points.

use clap::ValueEnum;
use coupling::Elements;
use fem::Fem;
use mpm_contact::ContactLaw;
use mpm_core::SceneError;
use serde::Serialize;

/// How a body of finite elements meets particles.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Coupling {
    /// Particles meet its surface (ICFEMP)
    Surface,
    /// Its nodes act on the grid (CFEMP)
    Grid,
}

impl Coupling {
    /// These elements, as a body of a scene of material points; on the grid that has its own contact law.
    ///
    /// # Errors
    /// As [`Elements::by_surface`] and [`Elements::on_the_grid`].
    pub fn of<const D: usize>(
        self,
        fem: Fem<D>,
        law: impl ContactLaw<f64>,
    ) -> Result<Elements<D>, SceneError> {
        match self {
            Coupling::Surface => Elements::by_surface(fem, law),
            Coupling::Grid => Elements::on_the_grid(fem),
        }
    }

    /// The usual edge of elements beside these cells, m: one of them, and half of one where nodes act on the grid, as far apart as
    /// particles are.
    pub fn edge(self, cell: f64) -> f64 {
        match self {
            Coupling::Surface => cell,
            Coupling::Grid => 0.5 * cell,
        }
    }
}
