//! In which configuration a body is mapped to the grid: the current one, or the one it started in.

use crate::shape::FixedDomain;

/// The configuration that weights and gradients belong to.
pub trait Frame: Copy + Send + Sync + 'static {
    /// The one at the start of the run?
    const TOTAL: bool;
    /// The name in tables and messages.
    const NAME: &'static str;
}

/// Which shape functions a frame can be used with: the reference configuration asks for a [`FixedDomain`], the current one takes any.
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

/// Total Lagrangian (de Vaucorbeil et al. 2020): the grid lies in the reference configuration, particles keep
/// their place on it, and what changes is their displacement u and deformation gradient F.
///
/// With grad0 for the gradient on that grid, a step takes `F += dt grad0 v` and gives the law the increment
/// `dt grad v = dt grad0 v . F^-1` of the F before it, which is that of the motion exactly; nodes get the force
/// `-sum v sigma F^-T . grad0 N`, v the current volume: the first Piola-Kirchhoff stress times the reference volume.
/// So any law serves, and any stress update.
///
/// Weights are those of the start for ever: nothing crosses a cell, domains tile, bins and node blocks are made once.
/// Beside its other numbers a particle carries u and F: 6 more in two dimensions (7 about an axis), 12 in three.
/// Boundaries hold places of the reference configuration: symmetry, fixed planes and prescribed velocities do what
/// they say; a [`Boundary::Wall`](crate::Boundary::Wall), which asks where material is, is refused, and so is
/// contact. Bodies that share nodes at the start are bonded there for good; others never meet. To meet others, a body becomes
/// one of a scene in the current configuration: [`Mpm::add_total_lagrangian`](crate::Mpm::add_total_lagrangian), or, to go on there,
/// [`Mpm::take_over`](crate::Mpm::take_over).
///
/// The stable step shrinks as the material is compressed: the rate is c |F^-1| / h, and |v| is no part of it.
#[derive(Clone, Copy, Debug, Default)]
pub struct TotalLagrangian;
impl Frame for TotalLagrangian {
    const TOTAL: bool = true;
    const NAME: &'static str = "total Lagrangian";
}
