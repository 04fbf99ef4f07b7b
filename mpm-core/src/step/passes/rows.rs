//! Rows of groups, as a pass reads and writes them: of one group, of two whose lanes one vector takes together, or of one lane of a
//! group.

use std::marker::PhantomData;
use std::ops::Deref;

use mpm_materials::{Sink, Source};

use impactite_simd::{Float, Pack};

/// The rows of the groups that a vector takes its lanes from. Of vectors of one group, the second one is never looked at.
pub(crate) struct Rows<T, S> {
    groups: [S; 2],
    /// The lane, of vectors of one.
    lane: usize,
    number: PhantomData<T>,
}

/// Rows that can be written.
pub(crate) type RowsMut<'a, T> = Rows<T, &'a mut [<T as Float>::Row]>;

impl<T: Float, S: Deref<Target = [T::Row]>> Rows<T, S> {
    /// Of two groups, or of one and anything else; of one of its lanes, if vectors have one.
    #[inline(always)]
    pub(crate) fn of(groups: [S; 2], lane: usize) -> Self {
        Rows { groups, lane, number: PhantomData }
    }
    /// The numbers of a row.
    #[inline(always)]
    pub(in crate::step) fn load<P: Pack<T>>(&self, row: usize) -> P {
        let second = &self.groups[if P::GROUPS == 1 { 0 } else { 1 }];
        P::from_rows([&self.groups[0][row], &second[row]], self.lane)
    }
    /// Reads a law's state from row `at` on.
    #[inline(always)]
    pub(in crate::step) fn reader(&self, at: usize) -> Reader<'_, T, S> {
        Reader { rows: self, at }
    }
}

impl<'a, T: Float> RowsMut<'a, T> {
    /// Write the numbers of a row.
    #[inline(always)]
    pub(in crate::step) fn store<P: Pack<T>>(&mut self, row: usize, numbers: P) {
        numbers.to_row(0, &mut self.groups[0][row], self.lane);
        if P::GROUPS > 1 {
            numbers.to_row(1, &mut self.groups[1][row], self.lane);
        }
    }
    /// Writes a law's state from row `at` on.
    #[inline(always)]
    pub(in crate::step) fn writer(&mut self, at: usize) -> Writer<'_, 'a, T> {
        Writer { rows: self, at }
    }
}

/// Reads a law's state.
pub(in crate::step) struct Reader<'a, T, S> {
    rows: &'a Rows<T, S>,
    at: usize,
}

impl<T: Float, P: Pack<T>, S: Deref<Target = [T::Row]>> Source<P> for Reader<'_, T, S> {
    #[inline(always)]
    fn take(&mut self) -> P {
        self.at += 1;
        self.rows.load(self.at - 1)
    }
}

/// Writes a law's state.
pub(in crate::step) struct Writer<'a, 'b, T: Float> {
    rows: &'a mut RowsMut<'b, T>,
    at: usize,
}

impl<T: Float, P: Pack<T>> Sink<P> for Writer<'_, '_, T> {
    #[inline(always)]
    fn put(&mut self, value: P) {
        self.at += 1;
        self.rows.store(self.at - 1, value);
    }
}

/// Numbers of a row.
#[inline(always)]
pub(in crate::step) fn of_row<T: Float, P: Pack<T>>(row: &T::Row, lane: usize) -> P {
    P::from_rows([row, row], lane)
}
