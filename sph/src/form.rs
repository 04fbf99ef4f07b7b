//! Configuration of the kernels, and correction of the gradients.

use std::fmt::Debug;

/// Configuration of the kernels: reference or present.
pub trait Form: Copy + Debug + Send + Sync + 'static {
    /// The name in tables and messages.
    const NAME: &'static str;
    /// True if kernels and neighbours are those of the reference configuration.
    const TOTAL: bool;
    /// Stretch above which the present configuration becomes the reference, if any.
    fn renewed_at(&self) -> Option<f64> {
        None
    }
}

/// Kernels and neighbours of the reference configuration: no tensile instability and no neighbour search. Particles do not separate: use
/// this form for bodies without fracture.
///
/// With [`TotalLagrangian::renewed`] the present configuration becomes the reference, with new neighbours, as soon as a particle is
/// stretched by more than a factor since the last update. This is a switch to an updated form for large flow.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TotalLagrangian(Option<f64>);

impl TotalLagrangian {
    /// Update the reference where the root mean square of the principal stretches of a particle, or of their inverses, exceeds `stretch`.
    ///
    /// # Errors
    /// A stretch not above 1, or not finite.
    pub fn renewed(stretch: f64) -> Result<Self, StretchError> {
        if stretch > 1.0 && stretch.is_finite() {
            Ok(TotalLagrangian(Some(stretch)))
        } else {
            Err(StretchError(stretch))
        }
    }
}

/// Invalid stretch for updates of the reference configuration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StretchError(f64);

impl std::fmt::Display for StretchError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let StretchError(stretch) = self;
        write!(
            f,
            "renewal of the reference: stretch = {stretch} is not allowed; it must be above 1 and finite"
        )
    }
}
impl std::error::Error for StretchError {}

impl Form for TotalLagrangian {
    const NAME: &'static str = "total Lagrangian";
    const TOTAL: bool = true;
    fn renewed_at(&self) -> Option<f64> {
        self.0
    }
}

/// Kernels and neighbours of the present configuration. The force of a pair, -V_i V_j (sigma_i B_i + sigma_j B_j) grad W, is conjugate to
/// the velocity gradients of the laws, so that energy is conserved.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Updated;
impl Form for Updated {
    const NAME: &'static str = "updated Lagrangian";
    const TOTAL: bool = false;
}

/// Correction of gradients for kernels truncated by surfaces, and for particle disorder.
pub trait Correction<F>: Copy + Debug + Send + Sync + 'static {
    /// The name in tables and messages.
    const NAME: &'static str;
    /// True if gradients are multiplied by B = (sum V grad W (x) (x_j - x_i))^-1.
    const CORRECTED: bool;
    /// True if gradients are multiplied by the number that makes those of a full lattice exact.
    const SCALED: bool = false;
}

/// Gradients that are exact for linear fields \[Randles1996, BonetLok1999\]: a rigid rotation causes no strain.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct GradientCorrection;
impl<F: Form> Correction<F> for GradientCorrection {
    const NAME: &'static str = "corrected gradients";
    const CORRECTED: bool = true;
}

/// Gradients times one number for all particles, with which those of linear fields are exact within a lattice. For liquids: the forces of a
/// pair push particles apart that are too close, whatever the gradients at surfaces are, and splashes need no inverse of their few
/// neighbours. Without the number (0.974 in place of 1 for a lattice in the plane and a smoothing length of 1.3 spacings) a column at rest
/// in its hydrostatic pressure would lack 2.6 % of its weight, and ring.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ScaledGradients;
impl Correction<Updated> for ScaledGradients {
    const NAME: &'static str = "scaled gradients";
    const CORRECTED: bool = false;
    const SCALED: bool = true;
}

/// Uncorrected gradients of the original formulation: about half of the exact value near surfaces.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct NoCorrection;
impl Correction<Updated> for NoCorrection {
    const NAME: &'static str = "gradients as they are";
    const CORRECTED: bool = false;
}
