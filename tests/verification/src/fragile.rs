//! Fragile points method (FPM) as a method of gates.

use fpm::{Cells, CellsError, Domain, relaxed, scattered};

/// Numerical flux between cells.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Flux {
    /// `fpm::Method::printed`.
    Incomplete,
    /// `fpm::Method::symmetric`.
    Symmetric,
}

/// Fragile points method with a cell type.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Fragile {
    /// Flux between cells.
    pub flux: Flux,
    /// Voronoi cells of random points if true, squares otherwise.
    pub random: bool,
}

/// Seed of the random points.
const SEED: u64 = 1;

impl Fragile {
    /// Both fluxes on squares and on random cells.
    pub const ALL: [Fragile; 4] = [
        Fragile { flux: Flux::Incomplete, random: false },
        Fragile { flux: Flux::Symmetric, random: false },
        Fragile { flux: Flux::Incomplete, random: true },
        Fragile { flux: Flux::Symmetric, random: true },
    ];

    /// Courant number by default: fraction of the stable time step.
    pub const COURANT: f64 = 0.9;

    /// Name in files.
    pub const fn name(self) -> &'static str {
        match (self.flux, self.random) {
            (Flux::Incomplete, false) => "FPM printed",
            (Flux::Symmetric, false) => "FPM symmetric",
            (Flux::Incomplete, true) => "FPM printed at random",
            (Flux::Symmetric, true) => "FPM symmetric at random",
        }
    }

    /// Number of neighbours of a cell.
    pub const fn neighbours(self) -> u64 {
        if self.random { 6 } else { 4 }
    }

    /// Build the cells of a box: `counts` squares along its edges, `h` m wide, or random cells of about this width.
    ///
    /// # Errors
    /// Errors of the cell generation.
    pub fn cells(self, domain: &Domain<2>, counts: [usize; 2], h: f64) -> Result<Cells<2>, CellsError> {
        let points = if self.random {
            relaxed(scattered(domain, SEED, |_| h)?, domain, 3)?
        } else {
            let rows = (0..counts[1]).flat_map(|j| (0..counts[0]).map(move |i| [i, j]));
            rows.map(|at| at.map(|n| (n as f64 + 0.5) * h)).collect()
        };
        Cells::voronoi(&points, domain)
    }
}

/// Failure criterion of faces.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Opening {
    /// `fpm::MaximumTension`: abrupt failure.
    Strength,
    /// `fpm::Cohesive`: failure over the fracture energy.
    Cohesive,
}

/// Fragile points with face failure on a set of random cells.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Cracks {
    /// Failure criterion.
    pub opening: Opening,
    /// Seed of the random points.
    pub seed: u64,
}

impl Cracks {
    /// Both criteria on two sets of cells.
    pub const ALL: [Cracks; 4] = [
        Cracks { opening: Opening::Strength, seed: 1 },
        Cracks { opening: Opening::Strength, seed: 2 },
        Cracks { opening: Opening::Cohesive, seed: 1 },
        Cracks { opening: Opening::Cohesive, seed: 2 },
    ];

    /// Name in files.
    pub const fn name(self) -> &'static str {
        match (self.opening, self.seed) {
            (Opening::Strength, 1) => "FPM strength first set",
            (Opening::Strength, _) => "FPM strength second set",
            (Opening::Cohesive, 1) => "FPM cohesive first set",
            (Opening::Cohesive, _) => "FPM cohesive second set",
        }
    }
}
