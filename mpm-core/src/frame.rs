//! Configuration in which a body is mapped to the grid: current or reference.

use crate::shape::FixedDomain;

/// Configuration of weights and gradients.
pub trait Frame: Copy + Send + Sync + 'static {
    /// True for the configuration at the start of the run.
    const TOTAL: bool;
    /// Name in tables and messages.
    const NAME: &'static str;
}

/// Shape functions that a frame supports: the reference configuration requires a [`FixedDomain`], the current one accepts any.
pub trait Holds<S>: Frame {}
impl<S> Holds<S> for UpdatedLagrangian {}
impl<S: FixedDomain> Holds<S> for TotalLagrangian {}

/// Updated Lagrangian: particles move through the grid.
#[derive(Clone, Copy, Debug, Default)]
pub struct UpdatedLagrangian;
impl Frame for UpdatedLagrangian {
    const TOTAL: bool = false;
    const NAME: &'static str = "updated Lagrangian";
}

/// Total Lagrangian (de Vaucorbeil et al. 2020): the grid is in the reference configuration, particles keep their
/// position on it, and their displacement u and deformation gradient F evolve.
///
/// With grad0 the gradient on that grid, a step computes `F += dt grad0 v` and passes to the law the increment `dt
/// grad v = dt grad0 v . F^-1` with the F before it, which is exact for the motion. Nodes receive the force `-sum v
/// sigma F^-T . grad0 N`, v the current volume: the first Piola-Kirchhoff stress times the reference volume. Any law
/// and any stress update can therefore be used.
///
/// Weights are constant: no particle crosses a cell, domains tile space, bins and node blocks are created once. In
/// addition a particle stores u and F: 6 more numbers in two dimensions (7 about an axis), 12 in three. Boundaries
/// refer to positions in the reference configuration: symmetry, fixed planes and prescribed velocities apply
/// unchanged; a [`Boundary::Wall`](crate::Boundary::Wall), which depends on current positions, is refused, and so is
/// contact. Bodies that share nodes at the start are bonded permanently; other bodies never interact. For contact,
/// add a body to a scene in the current configuration by
/// [`Mpm::add_total_lagrangian`](crate::Mpm::add_total_lagrangian), or continue it there by
/// [`Mpm::take_over`](crate::Mpm::take_over).
///
/// The stable step decreases as the material is compressed: the rate is c |F^-1| / h, without |v|.
#[derive(Clone, Copy, Debug, Default)]
pub struct TotalLagrangian;
impl Frame for TotalLagrangian {
    const TOTAL: bool = true;
    const NAME: &'static str = "total Lagrangian";
}
