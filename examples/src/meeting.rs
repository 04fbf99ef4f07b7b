//! How bodies of finite elements meet particles, chosen at run time.

use clap::ValueEnum;
use coupling::Elements;
use fem::Fem;
use mpm_contact::{Coulomb, Pairs, SurfaceDistance};
use mpm_core::{BlockGrid, GridContact, Kernels, Mpm};
use serde::Serialize;

use crate::{CaseError, Normals};

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
    /// As on the command line.
    pub fn name(self) -> String {
        self.to_possible_value().map_or_else(String::new, |v| v.get_name().to_string())
    }

    /// A scene of elements as a body of a scene of particles that it slides along with this coefficient of friction.
    ///
    /// # Errors
    /// Elements that cannot be coupled so, a coefficient that is negative.
    pub fn elements<const D: usize>(self, fem: Fem<D>, friction: f64) -> Result<Elements<D>, CaseError> {
        Ok(match self {
            Coupling::Surface => Elements::by_surface(fem, Coulomb::new(friction)?)?,
            Coupling::Grid => Elements::on_the_grid(fem)?,
        })
    }

    /// The usual edge of elements beside cells of this size, m: one of them, and half of one where nodes act on the grid, as far apart as
    /// particles are.
    pub fn edge(self, cell: f64) -> f64 {
        match self {
            Coupling::Surface => cell,
            Coupling::Grid => 0.5 * cell,
        }
    }

    /// An empty scene of particles in the plane: on the grid bodies are kept apart by the library's default detector with this
    /// coefficient of friction; surfaces need one field alone.
    ///
    /// # Errors
    /// A coefficient that is negative.
    pub fn plane_scene(
        self,
        method: Kernels<f64, 2>,
        grid: BlockGrid<f64, 2>,
        friction: f64,
    ) -> Result<Mpm<2>, CaseError> {
        Ok(match self {
            Coupling::Surface => Mpm::new(method, grid),
            Coupling::Grid => {
                let detector = SurfaceDistance::new(Normals::Plane, 0.0)?.locally();
                Mpm::with_contact(
                    method,
                    grid,
                    GridContact::new(detector, Pairs::new(Coulomb::new(friction)?)),
                )
            }
        })
    }
}
