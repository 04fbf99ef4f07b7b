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
    /// Add the surface load of particles that carry one to that force.
    pub load: bool,
    /// Add the body force of particles that carry one.
    pub field: bool,
    /// Cut particles in two that were stretched too far, when they have moved.
    pub splits: bool,
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
    const NOTHING: Pass = Pass {
        strain: None,
        velocity: false,
        moves: false,
        momentum: false,
        force: false,
        load: false,
        field: false,
        splits: false,
        smooth: false,
    };
}

/// A pass as a type, so that what it does not do is not compiled.
pub trait PassKind: Send + Sync + 'static {
    /// What it does.
    const DOES: Pass;
}

macro_rules! passes {
    ($($(#[$doc:meta])* $name:ident { $($field:ident: $value:expr),* })*) => {$(
        $(#[$doc])*
        #[derive(Clone, Copy, Debug)]
        pub struct $name;
        impl PassKind for $name {
            const DOES: Pass = Pass { $($field: $value,)* ..Pass::NOTHING };
        }
    )*};
}
passes! {
    /// Map mass, momentum and force of particles as they stand.
    MapAll { momentum: true, force: true }
    /// Map mass and momentum of particles as they stand.
    MapMomentum { momentum: true }
    /// Bring particles that were placed out of their bins to those they are in now.
    Follow { moves: true }
    /// One smoothing of FMPM.
    Smooth { smooth: true, momentum: true }
    /// The one pass of USL.
    UslPass { strain: Some(Nodal::First), velocity: true, moves: true, momentum: true, force: true }
    /// First pass of MUSL.
    MuslReturn { velocity: true, momentum: true }
    /// Second pass of MUSL.
    MuslAdvance { strain: Some(Nodal::Second), moves: true, momentum: true, force: true }
    /// First pass of USF.
    UsfStress { strain: Some(Nodal::First), force: true }
    /// Second pass of USF.
    UsfAdvance { velocity: true, moves: true, momentum: true }
}

/// The pass `K` of a body with a surface load.
#[derive(Clone, Copy, Debug)]
pub struct Loaded<K>(std::marker::PhantomData<K>);
impl<K: PassKind> PassKind for Loaded<K> {
    const DOES: Pass = Pass { load: K::DOES.force || K::DOES.velocity, ..K::DOES };
}

/// The pass `K` of a body with a force field.
#[derive(Clone, Copy, Debug)]
pub struct Driven<K>(std::marker::PhantomData<K>);
impl<K: PassKind> PassKind for Driven<K> {
    const DOES: Pass = Pass { field: K::DOES.force || K::DOES.velocity, ..K::DOES };
}

/// The pass `K` of a body whose particles are split.
#[derive(Clone, Copy, Debug)]
pub struct Splits<K>(std::marker::PhantomData<K>);
impl<K: PassKind> PassKind for Splits<K> {
    const DOES: Pass = Pass { splits: K::DOES.moves, ..K::DOES };
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
    /// First pass of a step: before the forces for USF, after the momentum update for the others.
    type First: PassKind;
    /// Second pass of a step (the same as the first where there is only one).
    type Second: PassKind;
}

/// Update stress last, from the velocity of the momentum update. Dissipates (docs/notes.md 1, finding 2);
/// for smooth shape functions.
#[derive(Clone, Copy, Debug, Default)]
pub struct Usl;
impl StressUpdate for Usl {
    const NAME: &'static str = "USL";
    type Map = MapAll;
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
    type Map = MapAll;
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
    type First = UsfStress;
    type Second = UsfAdvance;
}
