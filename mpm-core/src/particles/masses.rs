//! What particles weigh.

use impactite_simd::{Float, Pack};

/// The masses of the particles of a body, kg.
#[derive(Clone, Copy, Debug)]
pub enum Masses<T> {
    /// All are the same, and none carries it.
    Equal(T),
    /// Each carries its own, in this row.
    Each(usize),
}

impl<T: Float> Masses<T> {
    /// Of a particle with these numbers.
    #[inline(always)]
    pub fn of(&self, numbers: &[T]) -> T {
        self.read(|row| numbers[row])
    }

    /// Of a particle of which `row` reads a row.
    #[inline(always)]
    pub fn read(&self, row: impl FnOnce(usize) -> T) -> T {
        match *self {
            Masses::Equal(mass) => mass,
            Masses::Each(at) => row(at),
        }
    }

    /// Of the particles of a group, of which `row` reads a row; zero in lanes that are not `alive`.
    #[inline(always)]
    pub fn of_group<P: Pack<T>>(&self, alive: P::Mask, row: impl Fn(usize) -> P) -> P {
        match *self {
            Masses::Equal(mass) => P::select(alive, P::splat(mass), P::zero()),
            // Lanes without a particle carry none.
            Masses::Each(at) => row(at),
        }
    }

    /// The row in which they are carried.
    #[inline(always)]
    pub fn row(&self) -> Option<usize> {
        match *self {
            Masses::Equal(_) => None,
            Masses::Each(row) => Some(row),
        }
    }
}
