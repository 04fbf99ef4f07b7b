//! What is known of a body while it is left out of the steps.

use crate::step::bodies::body::Which;
use impactite_simd::Float;

/// What is known of a body while it rests.
#[derive(Clone, Debug, Default)]
pub(in crate::step) struct Deactivated<T, const D: usize> {
    /// The node blocks that it would claim, sorted.
    pub(in crate::step) blocks: Vec<[i32; D]>,
    /// Largest (c + |v|) / h that its passes would find, 1/s: of the map, the first and the second one.
    pub(in crate::step) rates: [T; 3],
    /// The step that it was tried with, s.
    pub(in crate::step) dt: T,
}

impl<T: Float, const D: usize> Deactivated<T, D> {
    /// What a pass would find.
    pub(in crate::step) fn rate(&self, which: Which, adapt: bool) -> T {
        match which {
            _ if !adapt => T::default(),
            Which::Map | Which::Refit => self.rates[0],
            Which::First => self.rates[1],
            Which::Second => self.rates[2],
            Which::Smooth | Which::Follow => T::default(),
        }
    }
    /// The node blocks that the body would claim, sorted.
    pub(in crate::step) fn blocks(&self) -> &[[i32; D]] {
        &self.blocks
    }
    /// Bytes of its memory.
    pub(in crate::step) fn bytes(&self) -> usize {
        self.blocks.capacity() * size_of::<[i32; D]>()
    }
}
