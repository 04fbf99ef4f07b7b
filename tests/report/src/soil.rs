//! Volumetric locking: limit load of a strip footing (V18), with the dilatation of each particle and with the mean
//! dilatation of a cell.

use mpm_core::{Flip, Linear, Method, Musl, PlaneStrain};
use verification::problems::footing::{COURANT, EXACT, press};
use verification::{Kernel, Outcome, Scheme, Velocity};

use crate::job::Key;

/// Footing pressed into soil by linear shape functions with FLIP and MUSL: for other kernels the effective width of the footing is not
/// known to a per cent.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Footing {
    /// True for the total Lagrangian method.
    pub total: bool,
    /// True for the mean dilatation of a cell.
    pub mean: bool,
    /// Number of cells of half the width.
    pub cells: usize,
}

impl Footing {
    /// Problem name in files.
    pub const PROBLEM: &str = "V18 footing";

    /// Key of the run.
    pub fn key(self) -> Key {
        let scheme = Scheme { kernel: Kernel::Linear, velocity: Velocity::FlipMusl, total: self.total };
        let cure = if self.mean { "mean" } else { "own" };
        Key {
            problem: Self::PROBLEM.into(),
            scheme: format!("{}, {cure} dilatation", scheme.name()),
            per_axis: 2,
            cells: self.cells,
            courant: COURANT,
        }
    }

    /// List all runs of a grid.
    pub fn all(cells: usize) -> Vec<Footing> {
        let total = [true, false];
        total.into_iter().flat_map(|total| [false, true].map(|mean| Footing { total, mean, cells })).collect()
    }

    /// Find the run of a key.
    pub fn of(key: &Key) -> Option<Footing> {
        Footing::all(key.cells).into_iter().find(|f| f.key() == *key)
    }

    /// Run the footing: "load" is the relative error of the last of four loads, "rising" its increase over the
    /// third.
    pub fn run(self) -> Outcome {
        let cells = self.cells as u32;
        let hats = || Method::new(Linear, Flip, Musl, PlaneStrain);
        let made = match (self.total, self.mean) {
            (true, true) => press(hats().total_lagrangian().mean_dilatation().compiled(), cells, 4),
            (true, false) => press(hats().total_lagrangian(), cells, 4),
            (false, true) => press(hats().mean_dilatation().compiled(), cells, 4),
            (false, false) => press(hats(), cells, 4),
        };
        let made = match made {
            Ok(made) => made,
            Err(why) => return Outcome { failure: Some(why), ..Outcome::default() },
        };
        let at = |n: usize| made.loads.get(n).copied().unwrap_or(f64::NAN);
        let mut work = made.work;
        work.nodes = Kernel::Linear.nodes(2);
        let measures = vec![("load", at(3) / EXACT - 1.0), ("rising", at(3) / at(2) - 1.0)];
        Outcome { measures, work, failure: made.failure }
    }
}
