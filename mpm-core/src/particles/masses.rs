//! Masses of particles.

use impactite_simd::{Float, Pack};

/// Masses of the particles of a body, kg.
#[derive(Clone, Copy, Debug)]
pub enum Masses<T> {
    /// Equal masses, stored once.
    Equal(T),
    /// Individual masses, stored in this row.
    Each(usize),
}

impl<T: Float> Masses<T> {
    /// Return the mass of a particle with these values.
    #[inline(always)]
    pub fn of(&self, numbers: &[T]) -> T {
        self.read(|row| numbers[row])
    }

    /// Return the mass of a particle; `row` reads a row.
    #[inline(always)]
    pub fn read(&self, row: impl FnOnce(usize) -> T) -> T {
        match *self {
            Masses::Equal(mass) => mass,
            Masses::Each(at) => row(at),
        }
    }

    /// Return the masses of the particles of a group; `row` reads a row. The mass is zero in lanes that are not `alive`.
    #[inline(always)]
    pub fn of_group<P: Pack<T>>(&self, alive: P::Mask, row: impl Fn(usize) -> P) -> P {
        match *self {
            Masses::Equal(mass) => P::select(alive, P::splat(mass), P::zero()),
            // Lanes without a particle have zero mass in the row.
            Masses::Each(at) => row(at),
        }
    }

    /// Row of the masses, if they are stored individually.
    #[inline(always)]
    pub fn row(&self) -> Option<usize> {
        match *self {
            Masses::Equal(_) => None,
            Masses::Each(row) => Some(row),
        }
    }
}
