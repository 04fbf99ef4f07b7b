//! Options of the cases of the fragile points method: cells, fluxes, penalty.

use clap::{Args, ValueEnum};
use fpm::{Cells, Domain, Penalty, relaxed, scattered};
use mpm_core::geometry::Cuboid;
use mpm_core::geometry::structured::box_mesh;
use serde::Serialize;

use crate::CaseError;

/// Number of Lloyd's relaxation steps of random points.
const ROUNDS: usize = 3;

/// Where the points of a box are.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Points {
    /// In rows and columns: squares
    Lattice,
    /// At random, evened out: Voronoi cells
    Random,
}

/// What joins the cells.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Joint {
    /// The incomplete flux, as printed
    Incomplete,
    /// The symmetric one: forces are the derivative of an energy
    Symmetric,
}

/// Which fluxes are run.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Fluxes {
    /// As printed
    Incomplete,
    /// Forces that are the derivative of an energy
    Symmetric,
    /// One after the other
    Both,
}

/// Options of cases of the fragile points method.
#[derive(Clone, Copy, Debug, Args)]
pub struct Fragile {
    /// What joins the cells
    #[arg(long, value_enum, default_value = "both")]
    pub flux: Fluxes,
    /// Where the points are
    #[arg(long, value_enum, default_value = "lattice")]
    pub points: Points,
    /// Seed of points at random
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub seed: u64,
    /// Penalty over Young's modulus, 0.1 to 1000; 1 to 10 are useful
    #[arg(long, value_name = "ETA", default_value_t = Penalty::default().eta(), value_parser = crate::within(0.1, 1000.0))]
    pub eta: f64,
}

impl Joint {
    /// Name in files and rows.
    pub fn name(self) -> &'static str {
        match self {
            Joint::Incomplete => "incomplete",
            Joint::Symmetric => "symmetric",
        }
    }
}

impl Fragile {
    /// Return the fluxes to run.
    pub fn joints(&self) -> &'static [Joint] {
        match self.flux {
            Fluxes::Incomplete => &[Joint::Incomplete],
            Fluxes::Symmetric => &[Joint::Symmetric],
            Fluxes::Both => &[Joint::Incomplete, Joint::Symmetric],
        }
    }

    /// Return the penalty.
    ///
    /// # Errors
    /// Invalid penalty.
    pub fn penalty(&self) -> Result<Penalty, CaseError> {
        Ok(Penalty::new(self.eta)?)
    }

    /// Build cells of a box: `counts` along each axis, or about as many at random.
    ///
    /// # Errors
    /// Empty box.
    pub fn cells(&self, low: [f64; 2], high: [f64; 2], counts: [usize; 2]) -> Result<Cells<2>, CaseError> {
        let refused = |error: fpm::CellsError| CaseError::Other(error.to_string());
        if self.points == Points::Lattice {
            return Cells::of_mesh(&box_mesh(&Cuboid::new(low, high)?, counts)?).map_err(refused);
        }
        let h = (0..2).map(|d| (high[d] - low[d]) / counts[d] as f64).product::<f64>().sqrt();
        let random = || -> Result<Cells<2>, fpm::CellsError> {
            let domain = Domain::cuboid(low, high)?;
            let points = relaxed(scattered(&domain, self.seed, |_| h)?, &domain, ROUNDS)?;
            Cells::voronoi(&points, &domain)
        };
        random().map_err(refused)
    }

    /// True if the penalty is the default one.
    pub fn has_usual_penalty(&self) -> bool {
        self.eta == Penalty::default().eta()
    }
}
