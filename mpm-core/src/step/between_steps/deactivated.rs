//! State of a deactivated body.

use crate::step::bodies::body::Which;
use impactite_simd::Float;

/// State of a deactivated body.
#[derive(Clone, Debug, Default)]
pub(in crate::step) struct Deactivated<T, const D: usize> {
    /// Node blocks that the body would claim, sorted.
    pub(in crate::step) blocks: Vec<[i32; D]>,
    /// Largest (c + |v|) / h of its passes, 1/s: map, first and second pass.
    pub(in crate::step) rates: [T; 3],
    /// Size of the trial step, s.
    pub(in crate::step) dt: T,
}

impl<T: Float, const D: usize> Deactivated<T, D> {
    /// Rate that a pass would return, 1/s.
    pub(in crate::step) fn rate(&self, which: Which, adapt: bool) -> T {
        match which {
            _ if !adapt => T::default(),
            Which::Map | Which::Refit => self.rates[0],
            Which::First => self.rates[1],
            Which::Second => self.rates[2],
            Which::Smooth | Which::Follow => T::default(),
        }
    }
    /// Node blocks that the body would claim, sorted.
    pub(in crate::step) fn blocks(&self) -> &[[i32; D]] {
        &self.blocks
    }
    /// Memory, bytes.
    pub(in crate::step) fn bytes(&self) -> usize {
        self.blocks.capacity() * size_of::<[i32; D]>()
    }
}
