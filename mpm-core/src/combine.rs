//! Compiler errors for incompatible parts of a method: one message each, at the place of the combination.
//!
//! By default the compiler reports an unsatisfied bound where it is required. The type of the call is known all the
//! same, so that the compiler also reports its consequences: kernels that are not compiled, bounds that the method
//! passes on. Here the type of the call follows from the bound. Each of these traits has two implementations, the
//! second of which never applies: a single implementation is selected first and its bounds are checked later; of two,
//! the one with satisfied bounds is selected. If neither is, the call has no type, and the compiler prints one
//! message, that of the trait, without consequences.

use crate::scheme::Allows;
use crate::shape::FixedDomain;
use crate::transfer::Suits;

/// Marker of the implementation that can apply.
#[derive(Clone, Copy, Debug)]
pub struct Holding;
/// Marker of the implementation that never applies.
#[derive(Clone, Copy, Debug)]
pub struct Failing;
/// Trait that no type implements.
pub trait Never {}

/// Transfer compatible with the shape function `S`. `R` equals `M`.
#[diagnostic::on_unimplemented(
    message = "`{Self}` is not a transfer that can be used with the shape function `{S}`",
    label = "not with this shape function",
    note = "the affine transfers `Apic`, `Aflip` and `Mls` divide by the second moment of the weights, which vanishes for `Linear`, `Cpdi`, \
            `Cpdi2` and `BoundaryModified`: take `QuadraticBSpline`, `CubicBSpline`, `Gimp` or `CpGimp`, or the transfer `Flip`",
    note = "the order K of `Fmpm::<K>` must be 1 to 16",
    note = "`Method::new` takes a shape function, a transfer, a stress update and an embedding, in this order",
    note = "shape functions and transfers of one's own say what they go with: `impl AffineShape for Shape {{}}`, `impl Suits<Mine> for Gimp {{}}`; \
            generic code asks for it: `where S: Suits<X>`"
)]
pub trait OnShape<S, W, M, R> {
    /// Return the method.
    fn made(method: M) -> R;
}
impl<X, S: Suits<X>, M> OnShape<S, Holding, M, M> for X {
    fn made(method: M) -> M {
        method
    }
}
impl<X: Never, S, M> OnShape<S, Failing, M, M> for X {
    fn made(method: M) -> M {
        method
    }
}

/// Stress update compatible with the transfer `X`. `R` equals `M`.
#[diagnostic::on_unimplemented(
    message = "`{Self}` is not a stress update that can be used with the transfer `{X}`",
    label = "not with this transfer",
    note = "take `Usl`, which goes with every transfer",
    note = "`Musl` maps the velocities of particles to the grid a second time, and goes with `Flip` and `Blend` alone: what filters the velocity \
            (`Pic`, `Apic`, `Aflip`, `Mls`, `Fmpm`) would do so twice in a step and blow up (book, \"Properties of stress updates and transfers\", finding 8)",
    note = "`Mls` maps force and momentum together, which needs the stress of the same pass: it goes with neither `Usf` nor `Musl`",
    note = "a transfer of one's own says what it goes with beside `Usl`: `impl Allows<Mine> for Musl {{}}`; generic code asks for \
            it: `where U: Allows<X>`"
)]
pub trait WithTransfer<X, W, M, R> {
    /// Return the method.
    fn made(method: M) -> R;
}
impl<U: Allows<X>, X, M> WithTransfer<X, Holding, M, M> for U {
    fn made(method: M) -> M {
        method
    }
}
impl<U: Never, X, M> WithTransfer<X, Failing, M, M> for U {
    fn made(method: M) -> M {
        method
    }
}

/// Shape function available in the reference configuration. `R` equals `M`.
#[diagnostic::on_unimplemented(
    message = "`.total_lagrangian()` cannot be used with the shape function `{Self}`",
    label = "not with this shape function",
    note = "the domains of `CpGimp`, `Cpdi` and `Cpdi2` follow the strain, and in the reference configuration there is nothing to follow: take \
            `Gimp` for `CpGimp`, `Linear` or a B-spline for `Cpdi` and `Cpdi2`",
    note = "a shape function of one's own whose particles keep their box (`Domain::Fixed`) says so: `impl FixedDomain for Shape {{}}`; generic \
            code asks for it: `where S: FixedDomain`"
)]
pub trait InReference<W, M, R> {
    /// Return the method.
    fn made(method: M) -> R;
}
impl<S: FixedDomain, M> InReference<Holding, M, M> for S {
    fn made(method: M) -> M {
        method
    }
}
impl<S: Never, M> InReference<Failing, M, M> for S {
    fn made(method: M) -> M {
        method
    }
}
