//! Shape functions: how a particle's domain weighs on the nodes around it.
//!
//! All but those with domains that convect ([`Cpdi`]) are tensor products of a function along each axis, in units of the
//! node spacing h. Particles are kept by **bin**: the set of points with the same stencil. Along an axis a bin is one h wide; it lies between
//! two nodes when the stencil has an even number of them, and around a node when it has an odd number.
//! Within a bin a particle's place is its offset xi from the bin's centre, -1/2 <= xi < 1/2.

mod bspline;
mod cpdi;
pub mod domain;
mod edge;
mod gimp;
mod linear;

use mpm_materials::{Lane, Real};

use crate::dim::{Array, Stencil, centre, offset_of};

pub use bspline::{CubicBSpline, QuadraticBSpline};
pub use cpdi::{Cpdi, Cpdi2};
pub use domain::Domain;
pub use edge::BoundaryModified;
pub use gimp::{CpGimp, Gimp};
pub use linear::Linear;

/// Weights along one axis on the nodes of the stencil, smallest index first.
#[derive(Clone, Copy)]
pub struct Weights<L: Lane, E: Stencil> {
    /// N: the weight of each node.
    pub value: E::Axis<L>,
    /// h dN/dx: its derivative with respect to xi.
    pub slope: E::Axis<L>,
}

impl<L: Lane, E: Stencil> Weights<L, E> {
    /// All zero.
    #[inline(always)]
    pub fn zero() -> Self {
        Weights { value: Array::filled(L::zero()), slope: Array::filled(L::zero()) }
    }
}

/// What a gather multiplies the numbers of a bin with, along one axis.
#[derive(Clone, Copy)]
pub struct Basis<L: Lane, E: Stencil> {
    /// For the value: N.
    pub value: E::Axis<L>,
    /// For the derivative with respect to xi.
    pub slope: E::Axis<L>,
    /// For the slope of the affine fit of APIC: N_a (a - xi) / sum_b N_b (b - xi)^2.
    pub fit: E::Axis<L>,
}

impl<L: Lane, E: Stencil> Basis<L, E> {
    /// All zero.
    #[inline(always)]
    pub fn zero() -> Self {
        let zero = Array::filled(L::zero());
        Basis { value: zero, slope: zero, fit: zero }
    }
}

/// A shape function in `D` dimensions.
///
/// Written once for a lane: the same text gives the weights of one particle and of a vector of them. Mark
/// the implementation `#[inline(always)]`.
pub trait ShapeFunction<T: Real, const D: usize>: Copy + Send + Sync + 'static {
    /// Stencil size: `Extent<D, 2>`, `Extent<D, 3>` or `Extent<D, 4>`.
    type Extent: Stencil;
    /// What of its own domain each particle carries.
    const DOMAIN: Domain = Domain::Fixed;
    /// Does the basis end at walls and fixed planes ([`BoundaryModified`])?
    const BOUNDARY_MODIFIED: bool = false;
    /// Smallest limit of dt c / h measured with USL in three dimensions, 2 particles an axis and cell
    /// (book, "The stable time step"); 0.7 of it is the default.
    const USL_LIMIT: f64;
    /// The name in tables and messages.
    const NAME: &'static str;

    /// Weights along one axis of a particle at offset `xi` from its bin's centre, whose domain reaches `half`
    /// to each side (both in units of h). Of a domain that convects: while it is a box along the axes.
    fn weights<L: Lane<Real = T>>(&self, xi: L, half: L) -> Weights<L, Self::Extent>;

    /// Second moment of the weights along one axis, sum_i N_i (i - xi)^2, in units of h^2.
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

    /// Does it have a **polynomial form**: are its functions, within a bin, polynomials in xi?
    ///
    /// Then the nodal numbers of a bin are turned once into the coefficients of 1, xi, xi^2, ... by
    /// [`ShapeFunction::coefficients`], and each particle evaluates those, for which
    /// [`ShapeFunction::basis`] gives the powers of xi: fewer operations than weights, and the same numbers but
    /// for rounding. Without it a bin's numbers stay as they are and the basis is the weights.
    const POLYNOMIAL: bool = false;

    /// Coefficients of 1, xi, xi^2, ... along one axis, from the nodal numbers.
    #[inline(always)]
    fn coefficients<L: Lane<Real = T>>(
        nodes: <Self::Extent as Stencil>::Axis<L>,
    ) -> <Self::Extent as Stencil>::Axis<L> {
        nodes
    }

    /// The basis along one axis at offset `xi`. In polynomial form the first function is 1 and the second xi;
    /// their values, slopes (0, 1) and fits (0, 1) are not read.
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

    /// The half size after a relative elongation `strain` along the axis, of [`Domain::Axes`].
    #[inline(always)]
    fn stretch<L: Lane<Real = T>>(&self, half: L, _strain: L) -> L {
        half
    }
}

/// Shape functions whose second moment ([`ShapeFunction::inertia`]) stays away from zero, as affine transfers
/// (APIC) need it. The linear shape function's vanishes at a node.
#[diagnostic::on_unimplemented(
    message = "affine transfers (`Apic`, `Aflip`, `Mls`) cannot be used with the shape function `{Self}`",
    note = "the second moment of its weights vanishes when a particle sits on a node, so the affine matrix \
            is undefined there; take a B-spline or `Gimp`, or the transfer `Flip`"
)]
pub trait AffineShape {}

/// Shape functions of particles that keep the box they start with ([`Domain::Fixed`]), as the reference configuration needs it
/// ([`TotalLagrangian`](crate::TotalLagrangian)): domains tile there for ever, and one that followed the strain would leave its place.
#[diagnostic::on_unimplemented(
    message = "`{Self}` has no form in the reference configuration: its domains follow the strain",
    note = "a shape function of one's own whose particles keep their box (`Domain::Fixed`) says so: `impl FixedDomain for {Self} {{}}`"
)]
pub trait FixedDomain {}

/// Position of node `a` of the stencil relative to the bin's centre, in units of h.
#[inline(always)]
pub fn node_offset<E: Stencil>(a: usize) -> f64 {
    offset_of(E::NODES, a)
}

/// Where the bins' centres lie between the nodes, in units of h: 1/2 for even stencils, 0 for odd ones.
#[inline(always)]
pub fn bin_centre<E: Stencil>() -> f64 {
    centre(E::NODES)
}
