//! Inheritance of states by new elements.

/// Deleted element that overlaps a new one.
#[derive(Clone, Copy, Debug)]
pub struct Parent<'a> {
    /// Shared volume.
    pub shared: f64,
    /// Volume of the deleted element.
    pub volume: f64,
    /// Reference volume of the deleted element: mass over reference density.
    pub reference: f64,
    /// State variables of the deleted element.
    pub state: &'a [f64],
}

/// New element before its creation. Volumes are those of the embedding: m^2 in plane strain, m^3 per radian around an axis.
#[derive(Clone, Copy, Debug)]
pub struct Newborn<'a> {
    /// Volume of the new element.
    pub volume: f64,
    /// Deleted elements that it overlaps.
    pub parents: &'a [Parent<'a>],
    /// States of its particles: last means over their elements, weighted by mass.
    pub particles: &'a [&'a [f64]],
}

/// Inheritance rule.
///
/// States are averaged number by number. Mass, internal energy and volume are linear in the numbers of
/// [`SolidState`](mpm_materials::SolidState) and are conserved as far as the weights are; stored energies that are quadratic in the stress
/// are not. The solver books the additions and removals of each creation and deletion ([`crate::Audit`]).
pub trait Inheritance: Copy + Send + Sync + 'static {
    /// The name in tables and messages.
    const NAME: &'static str;
    /// Store the state of the new element in `state`. Return the inherited reference volume; the rest (the volume not covered by it) is
    /// new: the solver sets it by the volume ratio of the state.
    fn inherit(newborn: &Newborn<'_>, state: &mut [f64]) -> Taken;
}

/// Inherited part of a new element.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Taken {
    /// Reference volume inherited from deleted elements.
    pub reference: f64,
    /// Part of the new element's volume that it fills, 0 to 1.
    pub part: f64,
}

/// Mean state of the particles, original formulation: "all field quantities are on particles". It smooths, and conserves neither mass nor
/// energy.
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

/// Overlap-weighted states: a new element inherits from each deleted element the overlapping part of its mass, energy and state; uncovered
/// parts have the mean of the particles. If the new elements cover the deleted ones once, as in an exchange of diagonals, mass, internal
/// energy and volume are conserved to rounding.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct OverlapWeighted;

/// Rounding of a part of a new element's volume.
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
        // Overlapping parents fill no more than the whole volume.
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
            // New mass has the mean state, weighted as if at the parents' density.
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
