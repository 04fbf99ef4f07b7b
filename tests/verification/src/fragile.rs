//! Fragile points as a method of gates.

use fpm::{Cells, CellsError, Domain, relaxed, scattered};

/// What joins cells.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Flux {
    /// `fpm::Method::printed`.
    Incomplete,
    /// `fpm::Method::symmetric`.
    Symmetric,
}

/// A method of fragile points, and its cells.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Fragile {
    /// What joins them.
    pub flux: Flux,
    /// Are they Voronoi cells of points at random, or squares?
    pub random: bool,
}

/// Of points at random.
const SEED: u64 = 1;

impl Fragile {
    /// Both fluxes on squares and at random.
    pub const ALL: [Fragile; 4] = [
        Fragile { flux: Flux::Incomplete, random: false },
        Fragile { flux: Flux::Symmetric, random: false },
        Fragile { flux: Flux::Incomplete, random: true },
        Fragile { flux: Flux::Symmetric, random: true },
    ];

    /// The factor of the time control by default, of what is stable.
    pub const COURANT: f64 = 0.9;

    /// Its name in files.
    pub const fn name(self) -> &'static str {
        match (self.flux, self.random) {
            (Flux::Incomplete, false) => "FPM printed",
            (Flux::Symmetric, false) => "FPM symmetric",
            (Flux::Incomplete, true) => "FPM printed at random",
            (Flux::Symmetric, true) => "FPM symmetric at random",
        }
    }

    /// Neighbours of a cell.
    pub const fn neighbours(self) -> u64 {
        if self.random { 6 } else { 4 }
    }

    /// Cells of a box, `counts` along its edges and `h` m wide, or of about this width.
    ///
    /// # Errors
    /// What cells refuse.
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

/// When faces open.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Opening {
    /// `fpm::MaximumTension`: at once.
    Strength,
    /// `fpm::Cohesive`: over the work of a crack.
    Cohesive,
}

/// Fragile points whose faces open, on a set of random cells.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Cracks {
    /// When.
    pub opening: Opening,
    /// Of the points.
    pub seed: u64,
}

impl Cracks {
    /// Both on two sets.
    pub const ALL: [Cracks; 4] = [
        Cracks { opening: Opening::Strength, seed: 1 },
        Cracks { opening: Opening::Strength, seed: 2 },
        Cracks { opening: Opening::Cohesive, seed: 1 },
        Cracks { opening: Opening::Cohesive, seed: 2 },
    ];

    /// Its name in files.
    pub const fn name(self) -> &'static str {
        match (self.opening, self.seed) {
            (Opening::Strength, 1) => "FPM strength first set",
            (Opening::Strength, _) => "FPM strength second set",
            (Opening::Cohesive, 1) => "FPM cohesive first set",
            (Opening::Cohesive, _) => "FPM cohesive second set",
        }
    }
}
