//! When in a step the stress is updated, and which passes over the particles that makes.
//!
//! The stages of a step that visit particles and have no grid stage between them share one pass over memory.
//! Because a step begins where the last one ended, the map of the next step rides with the end of this one:
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

/// What one pass over the particles does, in this order.
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
    /// Instead of all this: gather the second nodal vector and map it back as momentum (FMPM).
    pub smooth: bool,
}

/// The nodal vectors a pass can read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Nodal {
    /// The velocity.
    First,
    /// The acceleration, the re-mapped velocity (MUSL) or the series term (FMPM), whichever a step keeps there.
    Second,
}

impl Pass {
    pub(crate) const NOTHING: Pass =
        Pass { strain: None, velocity: false, moves: false, momentum: false, force: false, smooth: false };
    /// Is a law asked in it?
    pub const fn has_law(self) -> bool {
        self.strain.is_some() || self.force
    }
}

/// A pass as a type, so that what it does not do is not compiled. It sees of a method what it needs: passes of methods that
/// differ elsewhere are one, compiled once.
pub trait PassKind: Send + Sync + 'static {
    /// What it does.
    const DOES: Pass;
    /// Which copies of its kernels are worth their compile time, in three dimensions; in two, where a cell has few particles, no more
    /// than that for AVX2.
    const VECTORS: Vectors;
    /// May it map momentum and the impulse of the coming step together?
    const PLANS: bool;
    /// The transfer as it sees it: the method's, where it changes velocities.
    type Transfer<T: Real, X: Transfer<T>>: Transfer<T>;
    /// The embedding: the method's, where it strains or maps forces.
    type Embedding<const D: usize, E: Embedding<D>>: Embedding<D>;
    /// The frame: the method's, where it strains, maps forces or moves.
    type Frame<F: Frame>: Frame;
    /// The transfer as it sees it, of that of the method.
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
    /// Map mass, momentum and force of particles as they stand (USL).
    UslMap [Plain true its its] { momentum: true, force: true }
    /// The same (MUSL).
    MuslMap [Plain false any its] { momentum: true, force: true }
    /// Map mass, momentum and force of particles as they stand, momentum with the affine field of the nodes (USL).
    UslRefit [Plain true held its] { velocity: true, momentum: true, force: true }
    /// Map mass and momentum likewise (USF).
    UsfRefit [Plain false held any] { velocity: true, momentum: true }
    /// Map mass and momentum of particles as they stand.
    MapMomentum [Plain false any any] { momentum: true }
    /// The same in every step, beside forces that are none: of particles that hold the place of others.
    MapPlace [Avx2 false any any] { momentum: true }
    /// Bring particles that were placed out of their bins to those they are in now.
    Follow [Avx2 false any any] { moves: true }
    /// One smoothing of FMPM.
    Smooth [Avx512 false any any] { smooth: true, momentum: true }
    /// The one pass of USL.
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

/// When the stress is updated.
pub trait StressUpdate: Copy + Send + Sync + 'static {
    /// The name in tables and messages.
    const NAME: &'static str;
    /// Before the forces (USF)?
    const BEFORE_FORCES: bool = false;
    /// From the momentum mapped a second time (MUSL)?
    const REMAP: bool = false;
    /// The map at the start of a run.
    type Map: PassKind;
    /// The same with the affine velocity field of an affine transfer, which the first map cannot know.
    type Refit: PassKind;
    /// First pass of a step: before the forces for USF, after the momentum update for the others.
    type First: PassKind;
    /// Second pass of a step (the same as the first where there is only one).
    type Second: PassKind;
}

/// Update stress last, from the velocity of the momentum update. Dissipates (book, "Properties of stress updates and transfers", finding 2);
/// for smooth shape functions.
#[derive(Clone, Copy, Debug, Default)]
pub struct Usl;
impl StressUpdate for Usl {
    const NAME: &'static str = "USL";
    type Map = UslMap;
    type Refit = UslRefit;
    type First = UslPass;
    type Second = UslPass;
}

/// Modified update stress last (Sulsky et al. 1995): particle velocities are mapped to the grid a second time
/// and the strain is taken from that. Safe where cells hold little material.
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

/// Which transfers a stress-update order can be used with: USL with all, MUSL with those that filter no velocity, USF with those that
/// map force and momentum apart. A transfer of one's own goes with USL, and with others by `impl Allows<Mine> for Musl {}`.
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
