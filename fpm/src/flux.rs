//! Numerical fluxes: what joins the cells.

use std::fmt::Debug;

use impactite_scene::SceneError;
use impactite_scene::error::parameter;

/// How traction on a face follows from the cells on both sides.
///
/// In both forms t* = {P} N - eta / l \[y\]: the mean of the tractions of both sides less a penalty on the jump, per area of the reference
/// configuration, with l the distance of the two points across the face.
pub trait Flux: Copy + Debug + Send + Sync + 'static {
    /// The name in tables and messages.
    const NAME: &'static str;
    /// Is the force minus the derivative of an energy, because laws see what jumps leave of the gradient?
    const LIFTED: bool;
}

/// The printed form \[Shen2022\], not symmetric: laws see the gradient F of each cell. The work of {P} N on jumps is in no energy; it is
/// booked ([`Exchange::impacts`](impactite_scene::Exchange::impacts), negative where it drives).
///
/// On a square lattice without held faces all frequencies are real. On random cells some are not, and motion from cell to cell grows, by up to
/// 0.02 c/h at a penalty of 1, 0.003 c/h at 5 and less beyond (the largest imaginary part of a frequency, c the speed of waves in plates): nothing in the time
/// that a wave takes through some hundred cells, too much for a vibration. There take [`Symmetric`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Incomplete;
impl Flux for Incomplete {
    const NAME: &'static str = "incomplete flux";
    const LIFTED: bool = false;
}

/// The symmetric form, written as an energy so that it holds at finite strain and for any law \[TenEyckLew2006\]: laws see
///
/// F - 1/V sum over faces of A/2 \[y\] (x) N,
///
/// the gradient with what jumps add to it. For linear elasticity that is the form with the terms - {sigma(du)} n . \[u\] - {sigma(u)} n . \[du\],
/// and 1/2 V R : C : R for the part R of the jumps, which can only make it stiffer. Forces are minus the derivative of strain energy and
/// penalty.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Symmetric;
impl Flux for Symmetric {
    const NAME: &'static str = "symmetric flux";
    const LIFTED: bool = true;
}

/// What holds cells together beside the flux: eta over Young's modulus of the law at rest (over the bulk modulus of one without shear).
///
/// With none, displacements that alternate from cell to cell cost nothing. Useful are 1 to 10: for more, waves travel too fast, and the
/// stable step falls as its root. By default 5.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Penalty(f64);

impl Default for Penalty {
    fn default() -> Self {
        Penalty(5.0)
    }
}

impl Penalty {
    /// With this eta over Young's modulus.
    ///
    /// # Errors
    /// Negative or not finite.
    pub fn new(eta: f64) -> Result<Self, SceneError> {
        Ok(Penalty(parameter(eta >= 0.0, "penalty", "eta", eta, "zero or positive, and finite")?))
    }
    /// Eta over Young's modulus.
    #[must_use]
    pub fn eta(&self) -> f64 {
        self.0
    }
}
