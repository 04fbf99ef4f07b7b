//! Numerical fluxes between cells.

use std::fmt::Debug;

use impactite_scene::SceneError;
use impactite_scene::error::parameter;

/// Numerical flux: traction on a face from the cells on both sides.
///
/// In both forms t* = {P} N - eta / l \[y\]: the mean of the tractions of both sides minus a penalty on the jump, per area of the reference
/// configuration, with l the distance of the two points across the face.
pub trait Flux: Copy + Debug + Send + Sync + 'static {
    /// The name in tables and messages.
    const NAME: &'static str;
    /// True if the force is minus the derivative of an energy: laws then receive gradients with the part of the jumps.
    const LIFTED: bool;
}

/// Incomplete flux, original formulation \[Shen2022\], not symmetric: laws receive the gradient F of each cell. The work of {P} N on jumps
/// belongs to no energy; it is booked ([`Exchange::impacts`](impactite_scene::Exchange::impacts), negative if it drives the motion).
///
/// On a square lattice without prescribed faces all frequencies are real. On random cells some are not, and motion from cell to cell grows,
/// by up to 0.02 c/h at a penalty of 1, 0.003 c/h at 5 and less beyond (the largest imaginary part of a frequency, c the speed of waves in
/// plates). This is negligible during a wave passage through some hundred cells, but too much for a vibration: use [`Symmetric`] there.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Incomplete;
impl Flux for Incomplete {
    const NAME: &'static str = "incomplete flux";
    const LIFTED: bool = false;
}

/// Symmetric flux, derived from an energy and so valid at finite strain and for any law \[TenEyckLew2006\]: laws receive
///
/// F - 1/V sum over faces of A/2 \[y\] (x) N,
///
/// the gradient with the part of the jumps. For linear elasticity this is the form with
/// the terms - {sigma(du)} n . \[u\] - {sigma(u)} n . \[du\], and 1/2 V R : C : R for the part R of the jumps, which can only stiffen it.
/// Forces are minus the derivative of strain energy and penalty.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Symmetric;
impl Flux for Symmetric {
    const NAME: &'static str = "symmetric flux";
    const LIFTED: bool = true;
}

/// Penalty on jumps: eta over Young's modulus of the law at rest (over the bulk modulus for a law without shear).
///
/// Without penalty, displacements that alternate from cell to cell have no energy. Useful values are 1 to 10: above, waves are too fast,
/// and the stable step falls with the inverse square root of eta. By default 5.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Penalty(f64);

impl Default for Penalty {
    fn default() -> Self {
        Penalty(5.0)
    }
}

impl Penalty {
    /// Create a penalty with this eta over Young's modulus.
    ///
    /// # Errors
    /// A negative or non-finite eta.
    pub fn new(eta: f64) -> Result<Self, SceneError> {
        Ok(Penalty(parameter(eta >= 0.0, "penalty", "eta", eta, "zero or positive, and finite")?))
    }
    /// Eta over Young's modulus.
    #[must_use]
    pub fn eta(&self) -> f64 {
        self.0
    }
}
