//! Volume change passed to the material law: that of the particle, or the mean over its cell.

/// Volume change passed to material laws.
pub trait Dilatation: Copy + Send + Sync + 'static {
    /// True for the mean over the particles of a cell.
    const MEAN: bool;
    /// Name in tables and messages.
    const NAME: &'static str;
}

/// Volume change of each particle.
#[derive(Clone, Copy, Debug, Default)]
pub struct OwnDilatation;
impl Dilatation for OwnDilatation {
    const MEAN: bool = false;
    const NAME: &'static str = "own dilatation";
}

/// Mean volume change over the particles of a body in a cell, weighted by mass: a cure for volumetric locking.
///
/// Nearly incompressible material (plastic metal, undrained soil, rubber) requires a divergence-free velocity at each
/// particle of a cell. These are more constraints than the nodes of a cell can satisfy: the grid responds with
/// stiffness and with pressures that alternate from particle to particle. From the increment dL of the step, the law
/// receives
///
/// ```text
/// dL + (mean(tr dL) + (mean(J) / J - 1) / 10 - tr dL) / n I
/// ```
///
/// with J the volume ratio and n = 3, or n = 2 in plane strain, where the third axis has no strain. This is the
/// increment form of F-bar (de Souza Neto et al. 1996), with the cell of the background grid as the element. Forces
/// are assembled from the resulting stress with the unmodified gradients of the weights: as in F-bar they are not the
/// gradient of an energy, and the energy of a step closes to second order in the difference to the mean.
///
/// The term with J returns the volume of a particle to the mean of its cell within some ten steps. Without it a
/// particle would keep its deviation from cell to cell, and after many cells its volume would be unrelated to the
/// space that it occupies (a copper bar in three dimensions stopped after 51 microseconds, a particle compressed
/// beyond its equation of state).
///
/// The correction is zero for a particle alone in its cell and for a uniform dilatation.
#[derive(Clone, Copy, Debug, Default)]
pub struct MeanDilatation;
impl Dilatation for MeanDilatation {
    const MEAN: bool = true;
    const NAME: &'static str = "mean dilatation";
}

impl MeanDilatation {
    /// Fraction of the deviation from the cell mean that the volume of a particle recovers in a step.
    pub const RETURN: f64 = 0.1;
}
