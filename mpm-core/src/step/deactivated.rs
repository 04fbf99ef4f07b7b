//! What is known of a body while it is left out of the steps.

use super::body::Which;
use crate::parallel::Float;

/// What is known of a body while it rests.
#[derive(Clone, Debug, Default)]
pub(super) struct Deactivated<T, const D: usize> {
    /// The node blocks that it would claim, sorted.
    pub(super) blocks: Vec<[i32; D]>,
    /// Largest (c + |v|) / h that its passes would find, 1/s: of the map, the first and the second one.
    pub(super) rates: [T; 3],
    /// The step that it was tried with, s.
    pub(super) dt: T,
}

impl<T: Float, const D: usize> Deactivated<T, D> {
    /// What a pass would find.
    pub(super) fn rate(&self, which: Which, adapt: bool) -> T {
        match which {
            _ if !adapt => T::default(),
            Which::Map | Which::Refit => self.rates[0],
            Which::First => self.rates[1],
            Which::Second => self.rates[2],
            Which::Smooth | Which::Follow => T::default(),
        }
    }
    /// The node blocks that the body would claim, sorted.
    pub(super) fn blocks(&self) -> &[[i32; D]] {
        &self.blocks
    }
    /// Bytes of its memory.
    pub(super) fn bytes(&self) -> usize {
        self.blocks.capacity() * size_of::<[i32; D]>()
    }
}
