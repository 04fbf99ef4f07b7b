//! Coupling of finite element bodies and particles, selected at run time.

use clap::ValueEnum;
use coupling::Elements;
use fem::Fem;
use mpm_contact::{AnyNormals, Coulomb, Pairs, SurfaceDistance};
use mpm_core::{BlockGrid, GridContact, Kernels, Mpm};
use serde::Serialize;

use crate::CaseError;

/// How elements meet particles.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Coupling {
    /// Particles meet their surface (ICFEMP)
    Surface,
    /// Their nodes act on the grid (CFEMP)
    Grid,
}

impl Coupling {
    /// Name on the command line.
    pub fn name(self) -> String {
        self.to_possible_value().map_or_else(String::new, |v| v.get_name().to_string())
    }

    /// Couple a scene of elements as a body of a scene of particles, with this coefficient of friction at its surface.
    ///
    /// # Errors
    /// Elements that cannot be coupled in this way; negative coefficient.
    pub fn elements<const D: usize>(self, fem: Fem<D>, friction: f64) -> Result<Elements<D>, CaseError> {
        Ok(match self {
            Coupling::Surface => Elements::by_surface(fem, Coulomb::new(friction)?)?,
            Coupling::Grid => Elements::on_the_grid(fem)?,
        })
    }

    /// Return the usual element edge for cells of this size, m: one cell, or half a cell, the particle spacing, where nodes
    /// act on the grid.
    pub fn edge(self, cell: f64) -> f64 {
        match self {
            Coupling::Surface => cell,
            Coupling::Grid => 0.5 * cell,
        }
    }

    /// Create an empty plane scene of particles. On the grid the library's default detector separates bodies, with this
    /// coefficient of friction; surface coupling needs a single velocity field.
    ///
    /// # Errors
    /// Negative coefficient.
    pub fn plane_scene(
        self,
        method: Kernels<f64, 2>,
        grid: BlockGrid<f64, 2>,
        friction: f64,
    ) -> Result<Mpm<2>, CaseError> {
        Ok(match self {
            Coupling::Surface => Mpm::new(method, grid),
            Coupling::Grid => {
                let detector = SurfaceDistance::new(AnyNormals::Plane, 0.0)?.locally();
                Mpm::with_contact(
                    method,
                    grid,
                    GridContact::new(detector, Pairs::new(Coulomb::new(friction)?)),
                )
            }
        })
    }
}
