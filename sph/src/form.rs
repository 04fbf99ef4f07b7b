//! Which configuration kernels are taken in, and how gradients are made of sums.

use std::fmt::Debug;

/// The configuration that kernels are taken in.
pub trait Form: Copy + Debug + Send + Sync + 'static {
    /// The name in tables and messages.
    const NAME: &'static str;
    /// Is it that of the reference, with the neighbours that particles have there?
    const TOTAL: bool;
    /// The stretch beyond which the present configuration becomes the reference, if any.
    fn renewed_at(&self) -> Option<f64> {
        None
    }
}

/// Kernels and neighbours of the reference configuration: no tensile instability, no search, and no separation. Nothing tears, so that it
/// is for bodies that stay whole.
///
/// With [`TotalLagrangian::renewed`] the present configuration becomes the reference, neighbours and all, as soon as a particle is stretched
/// by more than a factor since: the switch to an updated form for what flows.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TotalLagrangian(Option<f64>);

impl TotalLagrangian {
    /// Renew the reference where the root mean square of the principal stretches of a particle, or that of their inverses, exceeds this.
    ///
    /// # Errors
    /// Not above 1, or not finite.
    pub fn renewed(stretch: f64) -> Result<Self, StretchError> {
        if stretch > 1.0 && stretch.is_finite() {
            Ok(TotalLagrangian(Some(stretch)))
        } else {
            Err(StretchError(stretch))
        }
    }
}

/// A stretch that renews nothing, or everything always.
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

/// Kernels and neighbours of the present configuration. The force of a pair is -V_i V_j (sigma_i B_i + sigma_j B_j) grad W, the one that
/// does the work that the velocity gradients of laws see: energy is kept.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Updated;
impl Form for Updated {
    const NAME: &'static str = "updated Lagrangian";
    const TOTAL: bool = false;
}

/// What is done about kernels that are cut off by surfaces, and about disorder.
pub trait Correction<F>: Copy + Debug + Send + Sync + 'static {
    /// The name in tables and messages.
    const NAME: &'static str;
    /// Are gradients multiplied by B = (sum V grad W (x) (x_j - x_i))^-1?
    const CORRECTED: bool;
}

/// Gradients that are exact of linear fields \[Randles1996, BonetLok1999\]: what turns as a rigid body is not strained.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct GradientCorrection;
impl<F: Form> Correction<F> for GradientCorrection {
    const NAME: &'static str = "corrected gradients";
    const CORRECTED: bool = true;
}

/// Gradients as they are, as printed: near surfaces about half of what they should be.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct NoCorrection;
impl Correction<Updated> for NoCorrection {
    const NAME: &'static str = "gradients as they are";
    const CORRECTED: bool = false;
}
