//! Order of the stress update in a step, and the passes over the particles that it requires.
//!
//! Stages that visit particles without a grid stage between them share one pass over memory. A step begins where the
//! last one ended: the last pass of a step therefore contains the map of the next step:
//!
//! | order | pass 1 | pass 2 |
//! |---|---|---|
//! | USL | velocity, strain, stress, move; map mass, momentum, force | - |
//! | MUSL | velocity; map momentum again | strain, stress, move; map mass, momentum, force |
//! | USF | strain, stress; map force | velocity, move; map mass, momentum |

use crate::frame::{Frame, UpdatedLagrangian};
use crate::transfer::{Aflip, AnyTransfer, Apic, Blend, Flip, Fmpm, Held, Pic, Transfer};
use impactite_scene::embedding::{AnySpace, Embedding};
use impactite_simd::{Real, Vectors};

/// Operations of one pass over the particles, in this order.
#[derive(Clone, Copy, Debug)]
pub struct Pass {
    /// Update strain and stress from this nodal vector, if any.
    pub strain: Option<Nodal>,
    /// Update the particle velocity.
    pub velocity: bool,
    /// Move the particles.
    pub moves: bool,
    /// Map mass and momentum to the grid.
    pub momentum: bool,
    /// Map the force of the stress to the grid.
    pub force: bool,
    /// Smooth instead of the other operations: gather the second nodal vector and map it back as momentum (FMPM).
    pub smooth: bool,
}

/// Nodal vectors that a pass can read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Nodal {
    /// Velocity.
    First,
    /// The acceleration, the re-mapped velocity (MUSL) or the series term (FMPM): content of the second vector in the step.
    Second,
}

impl Pass {
    pub(crate) const NOTHING: Pass =
        Pass { strain: None, velocity: false, moves: false, momentum: false, force: false, smooth: false };
    /// True if the pass evaluates a material law.
    pub const fn has_law(self) -> bool {
        self.strain.is_some() || self.force
    }
}

/// Pass as a type, so that only its own operations are compiled. It depends on the parts of a method that it uses:
/// methods that differ in other parts share one compiled pass.
pub trait PassKind: Send + Sync + 'static {
    /// Operations of the pass.
    const DOES: Pass;
    /// Vector instructions for which its kernels are compiled in three dimensions. Kernels in two dimensions, where a
    /// cell has few particles, use AVX2 at most.
    const VECTORS: Vectors;
    /// True if it may map momentum and the impulse of the next step together.
    const PLANS: bool;
    /// Transfer of the pass: that of the method, where the pass changes velocities.
    type Transfer<T: Real, X: Transfer<T>>: Transfer<T>;
    /// Embedding of the pass: that of the method, where the pass computes strain or maps forces.
    type Embedding<const D: usize, E: Embedding<D>>: Embedding<D>;
    /// Frame of the pass: that of the method, where the pass computes strain, maps forces or moves particles.
    type Frame<F: Frame>: Frame;
    /// Convert the transfer of the method to that of the pass.
    fn transfer<T: Real, X: Transfer<T>>(of: X) -> Self::Transfer<T, X>;
}

macro_rules! passes {
    ($($(#[$doc:meta])* $name:ident [$vectors:ident $plans:literal $transfer:ident $space:ident] {
        $($field:ident: $value:expr),*
    })*) => {$(
        $(#[$doc])*
        #[derive(Clone, Copy, Debug)]
        pub struct $name;
        impl PassKind for $name {
            const DOES: Pass = Pass { $($field: $value,)* ..Pass::NOTHING };
            const VECTORS: Vectors = Vectors::$vectors;
            const PLANS: bool = $plans;
            passes!(transfer $transfer);
            passes!(space $space);
        }
    )*};
    (transfer its) => {
        type Transfer<T: Real, X: Transfer<T>> = X;
        fn transfer<T: Real, X: Transfer<T>>(of: X) -> X {
            of
        }
    };
    (transfer held) => {
        type Transfer<T: Real, X: Transfer<T>> = Held<X>;
        fn transfer<T: Real, X: Transfer<T>>(of: X) -> Held<X> {
            Held(of)
        }
    };
    (transfer any) => {
        type Transfer<T: Real, X: Transfer<T>> = AnyTransfer;
        fn transfer<T: Real, X: Transfer<T>>(_: X) -> AnyTransfer {
            AnyTransfer
        }
    };
    (space its) => {
        type Embedding<const D: usize, E: Embedding<D>> = E;
        type Frame<F: Frame> = F;
    };
    (space frame) => {
        type Embedding<const D: usize, E: Embedding<D>> = AnySpace;
        type Frame<F: Frame> = F;
    };
    (space any) => {
        type Embedding<const D: usize, E: Embedding<D>> = AnySpace;
        type Frame<F: Frame> = UpdatedLagrangian;
    };
}
passes! {
    /// Map mass, momentum and force of the particles in their present state (USL).
    UslMap [Plain true its its] { momentum: true, force: true }
    /// Map mass, momentum and force of the particles in their present state (MUSL).
    MuslMap [Plain false any its] { momentum: true, force: true }
    /// Map mass, momentum and force of the particles in their present state, momentum with the affine field of the nodes (USL).
    UslRefit [Plain true held its] { velocity: true, momentum: true, force: true }
    /// Map mass and momentum of the particles in their present state, momentum with the affine field of the nodes (USF).
    UsfRefit [Plain false held any] { velocity: true, momentum: true }
    /// Map mass and momentum of the particles in their present state.
    MapMomentum [Plain false any any] { momentum: true }
    /// Map mass and momentum of proxy particles, which have no internal force, in every step.
    MapPlace [Avx2 false any any] { momentum: true }
    /// Sort particles that were placed outside of their bins into the bins of their present position.
    Follow [Avx2 false any any] { moves: true }
    /// Make one smoothing of FMPM.
    Smooth [Avx512 false any any] { smooth: true, momentum: true }
    /// Only pass of USL.
    UslPass [Avx512 true its its] {
        strain: Some(Nodal::First), velocity: true, moves: true, momentum: true, force: true
    }
    /// First pass of MUSL.
    MuslReturn [Avx512 false its any] { velocity: true, momentum: true }
    /// Second pass of MUSL.
    MuslAdvance [Avx512 false any its] {
        strain: Some(Nodal::Second), moves: true, momentum: true, force: true
    }
    /// First pass of USF.
    UsfStress [Avx512 false any its] { strain: Some(Nodal::First), force: true }
    /// Second pass of USF.
    UsfAdvance [Avx512 false its frame] { velocity: true, moves: true, momentum: true }
}

/// Order of the stress update in a step.
pub trait StressUpdate: Copy + Send + Sync + 'static {
    /// Name in tables and messages.
    const NAME: &'static str;
    /// True if the stress is updated before the forces (USF).
    const BEFORE_FORCES: bool = false;
    /// True if the stress is updated from the momentum mapped a second time (MUSL).
    const REMAP: bool = false;
    /// Map at the start of a run.
    type Map: PassKind;
    /// Map at the start of a run with the affine velocity field of an affine transfer, which is unknown in the first map.
    type Refit: PassKind;
    /// First pass of a step: before the forces for USF, after the momentum update for the others.
    type First: PassKind;
    /// Second pass of a step (the same as the first where there is only one).
    type Second: PassKind;
}

/// Update stress last, from the velocity of the momentum update. Dissipates (book, "Properties of stress updates and
/// transfers", finding 2); use it with smooth shape functions.
#[derive(Clone, Copy, Debug, Default)]
pub struct Usl;
impl StressUpdate for Usl {
    const NAME: &'static str = "USL";
    type Map = UslMap;
    type Refit = UslRefit;
    type First = UslPass;
    type Second = UslPass;
}

/// Modified update stress last (Sulsky et al. 1995): particle velocities are mapped to the grid a second time and the
/// strain is computed from the result. Robust where cells contain little material.
#[derive(Clone, Copy, Debug, Default)]
pub struct Musl;
impl StressUpdate for Musl {
    const NAME: &'static str = "MUSL";
    const REMAP: bool = true;
    type Map = MuslMap;
    type Refit = MuslMap;
    type First = MuslReturn;
    type Second = MuslAdvance;
}

/// Update stress first (Bardenhagen 2002): strain from the velocity before the momentum update. First order
/// in time.
#[derive(Clone, Copy, Debug, Default)]
pub struct Usf;
impl StressUpdate for Usf {
    const NAME: &'static str = "USF";
    const BEFORE_FORCES: bool = true;
    type Map = MapMomentum;
    type Refit = UsfRefit;
    type First = UsfStress;
    type Second = UsfAdvance;
}

/// Transfers that a stress update supports: USL all, MUSL those that filter no velocity, USF those that map force and
/// momentum separately. A custom transfer can be used with USL, and with others by `impl Allows<Mine> for Musl {}`.
#[diagnostic::on_unimplemented(
    message = "the stress update `{Self}` cannot be combined with the transfer `{X}`",
    note = "`Usl` goes with every transfer, `Musl` with `Flip` and `Blend`, `Usf` with all but `Mls`"
)]
pub trait Allows<X> {}
impl Allows<Flip> for Musl {}
impl<T> Allows<Blend<T>> for Musl {}
impl<X> Allows<X> for Usl {}
impl Allows<Flip> for Usf {}
impl Allows<Pic> for Usf {}
impl Allows<Apic> for Usf {}
impl<T> Allows<Blend<T>> for Usf {}
impl<T> Allows<Aflip<T>> for Usf {}
impl<const K: usize> Allows<Fmpm<K>> for Usf {}
