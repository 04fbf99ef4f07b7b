//! What an element knows when it is born.

/// A dead element that lay where the new one is.
#[derive(Clone, Copy, Debug)]
pub struct Parent<'a> {
    /// The volume they share.
    pub shared: f64,
    /// The dead element's volume.
    pub volume: f64,
    /// Its reference volume: mass over reference density.
    pub reference: f64,
    /// The numbers of its state.
    pub state: &'a [f64],
}

/// An element about to be born. Volumes are those of the embedding: m^2 in plane strain, m^3 per radian around an axis.
#[derive(Clone, Copy, Debug)]
pub struct Newborn<'a> {
    /// Its volume.
    pub volume: f64,
    /// The dead elements it overlaps.
    pub parents: &'a [Parent<'a>],
    /// The states of its particles: means over the elements each had last, weighted by mass.
    pub particles: &'a [&'a [f64]],
}

/// Hands states on.
///
/// States are mixed number by number. Mass, internal energy and volume are linear in the numbers of
/// [`SolidState`](mpm_materials::SolidState) and are conserved as far as the weights are; stored energies that are
/// squares of the stress are not. The solver books what each birth and death adds and removes ([`crate::Audit`]).
pub trait Inheritance: Copy + Send + Sync + 'static {
    /// The name in tables and messages.
    const NAME: &'static str;
    /// Put the state of the newborn into `state`. Returns the reference volume it takes over, of which the rest
    /// (volume not covered by that) is new: the solver sets it by the volume ratio of the state.
    fn inherit(newborn: &Newborn<'_>, state: &mut [f64]) -> Taken;
}

/// What a newborn takes over.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Taken {
    /// Reference volume taken over from dead elements.
    pub reference: f64,
    /// The part of the newborn's volume that this fills, 0 to 1.
    pub part: f64,
}

/// The mean of its particles' states, as printed: "all field quantities are on particles". Smooths, and keeps
/// neither mass nor energy.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ParticleMean;

impl Inheritance for ParticleMean {
    const NAME: &'static str = "mean of particles";
    fn inherit(newborn: &Newborn<'_>, state: &mut [f64]) -> Taken {
        mean(newborn, state);
        Taken::default()
    }
}

fn mean(newborn: &Newborn<'_>, state: &mut [f64]) {
    state.fill(0.0);
    let weight = 1.0 / newborn.particles.len() as f64;
    for particle in newborn.particles {
        for (x, y) in state.iter_mut().zip(*particle) {
            *x += weight * y;
        }
    }
}

/// From each dead element the part of its mass, energy and state that lay where the new one is; where nothing lay, the
/// mean of the particles. When the new elements cover the dead ones once, as in an exchange of diagonals, mass, internal
/// energy and volume are those of before to rounding.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct OverlapWeighted;

/// Parts of a newborn's volume below this are rounding.
const ROUNDING: f64 = 1e-9;

impl Inheritance for OverlapWeighted {
    const NAME: &'static str = "overlap of elements";
    fn inherit(newborn: &Newborn<'_>, state: &mut [f64]) -> Taken {
        let shared: f64 = newborn.parents.iter().map(|p| p.shared).sum();
        let part = shared / newborn.volume;
        if part <= ROUNDING {
            mean(newborn, state);
            return Taken::default();
        }
        // Parents that lay over each other fill no more than there is.
        let scale = if part > 1.0 + ROUNDING { 1.0 / part } else { 1.0 };
        let mut reference = 0.0;
        let mut sum = vec![0.0; state.len()];
        for p in newborn.parents {
            let taken = scale * p.shared / p.volume * p.reference;
            reference += taken;
            for (x, y) in sum.iter_mut().zip(p.state) {
                *x += taken * y;
            }
        }
        let part = if part > 1.0 - ROUNDING { 1.0 } else { part };
        if part < 1.0 {
            // Mass that is new brings the mean state: weigh it as if at the parents' density.
            mean(newborn, state);
            let new = reference * (1.0 / part - 1.0);
            for (x, y) in state.iter_mut().zip(&sum) {
                *x = (*x * new + y) / (reference + new);
            }
        } else {
            for (x, y) in state.iter_mut().zip(&sum) {
                *x = y / reference;
            }
        }
        Taken { reference, part }
    }
}
