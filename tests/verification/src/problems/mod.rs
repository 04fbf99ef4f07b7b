//! Verification problems. Numbers such as V3 refer to the list of verification problems of the book,
//! "Verification".

pub mod axis_aligned;
pub mod bar;
pub mod column;
pub mod elements;
pub mod footing;
pub mod gas;
pub mod gates;
pub mod rigid;
pub mod ring;
pub mod smoothed;
pub mod statics;
pub mod vortex;

use mpm_core::geometry::Lattice;
use mpm_core::{Boundary, Side};
use mpm_materials::{Moduli, NeoHookean};

/// Create a neo-Hookean law of Young's modulus (Pa) and Poisson's ratio.
///
/// # Errors
/// Invalid elastic constants.
pub fn rubber(density: f64, young: f64, poisson: f64) -> Result<NeoHookean<f64>, String> {
    let moduli = Moduli::young_poisson(young, poisson).map_err(|e| e.to_string())?;
    NeoHookean::new(density, moduli).map_err(|e| e.to_string())
}

/// Create a lattice from an origin.
///
/// # Errors
/// Invalid origin or spacing.
pub fn lattice<const D: usize>(origin: [f64; D], spacing: f64) -> Result<Lattice<D>, String> {
    Lattice::new(origin, spacing).map_err(|e| e.to_string())
}

/// Return symmetry planes at `low` and `high` of the axes.
pub fn box_of_planes<const D: usize>(axes: std::ops::Range<usize>, low: f64, high: f64) -> Vec<Boundary<D>> {
    axes.flat_map(|axis| {
        [
            Boundary::Symmetry { axis, at: low, side: Side::Above },
            Boundary::Symmetry { axis, at: high, side: Side::Below },
        ]
    })
    .collect()
}
