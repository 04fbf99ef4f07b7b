//! Whose change of volume the law of a particle sees: its own, or the mean of its cell.

/// The change of volume that laws see.
pub trait Dilatation: Copy + Send + Sync + 'static {
    /// The mean of the particles of a cell?
    const MEAN: bool;
    /// The name in tables and messages.
    const NAME: &'static str;
}

/// Every particle's own.
#[derive(Clone, Copy, Debug, Default)]
pub struct OwnDilatation;
impl Dilatation for OwnDilatation {
    const MEAN: bool = false;
    const NAME: &'static str = "own dilatation";
}

/// The mean over the particles of a body in a cell, by mass: a cure for volumetric locking.
///
/// Material that keeps its volume (plastic metal, soil in undrained shear, rubber) asks each particle of a cell for a
/// velocity without divergence, more conditions than the nodes of a cell can meet: the grid answers with stiffness and
/// with pressures that alternate from particle to particle. With the increment dL of the step, the law sees
///
/// ```text
/// dL + (mean(tr dL) + (mean(J) / J - 1) / 10 - tr dL) / n I
/// ```
///
/// with J the volume ratio, n being 3, or 2 in plane strain, where nothing stretches along the third axis: the increment form of F-bar (de Souza
/// Neto et al. 1996), with the cell of the background grid for the element. Forces are those of the stress that comes of
/// it, with the weights' own gradients: as in F-bar they are not the gradient of an energy, and the energy of a step closes
/// to second order in what the mean takes off.
///
/// The term with J brings particles back to the mean of their cell within some ten steps. Without it each would keep what it
/// brings along from cell to cell, and the volumes of those that crossed many would have little to do with the room they take (a
/// copper bar in three dimensions ended after 51 microseconds, a particle compressed beyond its equation of state).
///
/// A particle alone in its cell is not changed, nor is a uniform dilatation.
#[derive(Clone, Copy, Debug, Default)]
pub struct MeanDilatation;
impl Dilatation for MeanDilatation {
    const MEAN: bool = true;
    const NAME: &'static str = "mean dilatation";
}

impl MeanDilatation {
    /// Part of the way back to the mean of a cell that a particle's volume goes in a step.
    pub const RETURN: f64 = 0.1;
}
