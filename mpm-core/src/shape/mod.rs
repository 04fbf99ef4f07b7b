//! Shape functions: weights of a particle's domain on the nodes around it.
//!
//! All shape functions except those with convected domains ([`Cpdi`]) are tensor products of a function along each axis, in
//! units of the node spacing h. Particles are sorted by **bin**: the set of points with the same stencil. Along an axis a
//! bin is one h wide, between two nodes for a stencil with an even number of nodes and around a node for an odd number. The
//! position of a particle is its offset xi from the bin's centre, -1/2 <= xi < 1/2.

mod bspline;
mod cpdi;
pub mod domain;
mod edge;
mod gimp;
mod linear;

use mpm_materials::{Lane, Real};

use crate::dim::{Array, Stencil, centre, offset_of};
use crate::grid::Halving;

pub use bspline::{CubicBSpline, QuadraticBSpline};
pub use cpdi::{Cpdi, Cpdi2};
pub use domain::Domain;
pub use edge::BoundaryModified;
pub use gimp::{CpGimp, Gimp};
pub use linear::Linear;

/// Weights along one axis on the nodes of the stencil, smallest index first.
#[derive(Clone, Copy)]
pub struct Weights<L: Lane, E: Stencil> {
    /// N: weight of each node.
    pub value: E::Axis<L>,
    /// h dN/dx: its derivative with respect to xi.
    pub slope: E::Axis<L>,
}

impl<L: Lane, E: Stencil> Weights<L, E> {
    /// Return zero weights.
    #[inline(always)]
    pub fn zero() -> Self {
        Weights { value: Array::filled(L::zero()), slope: Array::filled(L::zero()) }
    }
}

/// Basis functions along one axis, by which a gather multiplies the nodal values of a bin.
#[derive(Clone, Copy)]
pub struct Basis<L: Lane, E: Stencil> {
    /// Basis of the value: N.
    pub value: E::Axis<L>,
    /// Basis of the derivative with respect to xi.
    pub slope: E::Axis<L>,
    /// Basis of the slope of the affine fit of APIC: N_a (a - xi) / sum_b N_b (b - xi)^2.
    pub fit: E::Axis<L>,
}

impl<L: Lane, E: Stencil> Basis<L, E> {
    /// Return a zero basis.
    #[inline(always)]
    pub fn zero() -> Self {
        let zero = Array::filled(L::zero());
        Basis { value: zero, slope: zero, fit: zero }
    }
}

/// A shape function in `D` dimensions.
///
/// Implementations are generic over the lane type: the same code evaluates one particle or a vector of particles. Mark the
/// implementation `#[inline(always)]`.
pub trait ShapeFunction<T: Real, const D: usize>: Copy + Send + Sync + 'static {
    /// Stencil size: `Extent<D, 2>`, `Extent<D, 3>` or `Extent<D, 4>`.
    type Extent: Stencil;
    /// Particle domain: data that each particle stores.
    const DOMAIN: Domain = Domain::Fixed;
    /// True if the basis ends at walls and fixed planes ([`BoundaryModified`]).
    const BOUNDARY_MODIFIED: bool = false;
    /// Refinement relation to the functions of a lattice of half the spacing, if cells of several sizes are available.
    const HALVING: Option<Halving> = None;
    /// Smallest stable Courant number dt c / h measured with USL in three dimensions, with 2 particles per axis and cell
    /// (book, "The stable time step"); 0.7 of it is the default.
    const USL_LIMIT: f64;
    /// Name in tables and messages.
    const NAME: &'static str;

    /// Return the weights along one axis of a particle at offset `xi` from its bin's centre, with the domain half size
    /// `half` (both in units of h). A convected domain must be a box along the axes.
    fn weights<L: Lane<Real = T>>(&self, xi: L, half: L) -> Weights<L, Self::Extent>;

    /// Return the second moment of the weights along one axis, sum_i N_i (i - xi)^2, in units of h^2.
    #[inline(always)]
    fn inertia<L: Lane<Real = T>>(&self, xi: L, half: L) -> L {
        let w = self.weights(xi, half);
        let mut sum = L::zero();
        for a in 0..Self::Extent::NODES {
            let d = L::of(node_offset::<Self::Extent>(a)) - xi;
            sum = (w.value[a] * d).mul_add(d, sum);
        }
        sum
    }

    /// True if the functions have a **polynomial form**: within a bin they are polynomials in xi.
    ///
    /// The nodal values of a bin are then converted once to the coefficients of 1, xi, xi^2, ... by
    /// [`ShapeFunction::coefficients`], and each particle evaluates the polynomial with the powers of xi from
    /// [`ShapeFunction::basis`]: fewer operations than with weights, and the same result except for rounding. Without a
    /// polynomial form the nodal values are unchanged and the basis is the weights.
    const POLYNOMIAL: bool = false;

    /// Return the coefficients of 1, xi, xi^2, ... along one axis, from the nodal values.
    #[inline(always)]
    fn coefficients<L: Lane<Real = T>>(
        nodes: <Self::Extent as Stencil>::Axis<L>,
    ) -> <Self::Extent as Stencil>::Axis<L> {
        nodes
    }

    /// Return the basis along one axis at offset `xi`. In polynomial form the first function is 1 and the second xi; their
    /// values, slopes (0, 1) and fits (0, 1) are not read.
    #[inline(always)]
    fn basis<L: Lane<Real = T>>(&self, xi: L, half: L, fit: bool) -> Basis<L, Self::Extent> {
        let w = self.weights(xi, half);
        let mut basis: Basis<L, Self::Extent> = Basis { value: w.value, slope: w.slope, fit: w.value };
        if fit {
            let per_inertia = self.inertia(xi, half).recip();
            for a in 0..Self::Extent::NODES {
                let d = L::of(node_offset::<Self::Extent>(a)) - xi;
                basis.fit[a] = w.value[a] * d * per_inertia;
            }
        }
        basis
    }

    /// Return the half size of a [`Domain::Axes`] domain after a relative elongation `strain` along the axis.
    #[inline(always)]
    fn stretch<L: Lane<Real = T>>(&self, half: L, _strain: L) -> L {
        half
    }
}

/// Shape functions with a second moment ([`ShapeFunction::inertia`]) that stays away from zero, as affine transfers (APIC)
/// require. That of the linear shape function vanishes at a node.
#[diagnostic::on_unimplemented(
    message = "affine transfers (`Apic`, `Aflip`, `Mls`) cannot be used with the shape function `{Self}`",
    note = "the second moment of its weights vanishes when a particle sits on a node, so the affine matrix \
            is undefined there; take a B-spline or `Gimp`, or the transfer `Flip`"
)]
pub trait AffineShape {}

/// Shape functions with constant particle boxes ([`Domain::Fixed`]), as the reference configuration requires
/// ([`TotalLagrangian`](crate::TotalLagrangian)): the initial domains always tile it; domains that follow the strain would
/// not.
#[diagnostic::on_unimplemented(
    message = "`{Self}` has no form in the reference configuration: its domains follow the strain",
    note = "a shape function of one's own whose particles keep their box (`Domain::Fixed`) says so: `impl FixedDomain for {Self} {{}}`"
)]
pub trait FixedDomain {}

/// Return the position of node `a` of the stencil relative to the bin's centre, in units of h.
#[inline(always)]
pub fn node_offset<E: Stencil>(a: usize) -> f64 {
    offset_of(E::NODES, a)
}

/// Return the position of a bin's centre between the nodes, in units of h: 1/2 for even stencils, 0 for odd ones.
#[inline(always)]
pub fn bin_centre<E: Stencil>() -> f64 {
    centre(E::NODES)
}
