//! Access of a pass to the rows of groups: one group, two groups in one vector, or one lane of a group.

use std::marker::PhantomData;
use std::ops::Deref;

use mpm_materials::{Sink, Source};

use impactite_simd::{Float, Pack};

/// Rows of the groups in the lanes of a vector. Vectors of one group do not read the second one.
pub(crate) struct Rows<T, S> {
    groups: [S; 2],
    /// Lane in the group, for vectors of one lane.
    lane: usize,
    number: PhantomData<T>,
}

/// Mutable rows of groups.
pub(crate) type RowsMut<'a, T> = Rows<T, &'a mut [<T as Float>::Row]>;

impl<T: Float, S: Deref<Target = [T::Row]>> Rows<T, S> {
    /// Access two groups, or one group and an arbitrary second one; `lane` selects the lane for vectors of one lane.
    #[inline(always)]
    pub(crate) fn of(groups: [S; 2], lane: usize) -> Self {
        Rows { groups, lane, number: PhantomData }
    }
    /// Load the numbers of a row.
    #[inline(always)]
    pub(in crate::step) fn load<P: Pack<T>>(&self, row: usize) -> P {
        let second = &self.groups[if P::GROUPS == 1 { 0 } else { 1 }];
        P::from_rows([&self.groups[0][row], &second[row]], self.lane)
    }
    /// Return a reader of a law's state from row `at` on.
    #[inline(always)]
    pub(in crate::step) fn reader(&self, at: usize) -> Reader<'_, T, S> {
        Reader { rows: self, at }
    }
}

impl<'a, T: Float> RowsMut<'a, T> {
    /// Store the numbers of a row.
    #[inline(always)]
    pub(in crate::step) fn store<P: Pack<T>>(&mut self, row: usize, numbers: P) {
        numbers.to_row(0, &mut self.groups[0][row], self.lane);
        if P::GROUPS > 1 {
            numbers.to_row(1, &mut self.groups[1][row], self.lane);
        }
    }
    /// Return a writer of a law's state from row `at` on.
    #[inline(always)]
    pub(in crate::step) fn writer(&mut self, at: usize) -> Writer<'_, 'a, T> {
        Writer { rows: self, at }
    }
}

/// Reader of a law's state.
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

/// Writer of a law's state.
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

/// Load numbers of a row.
#[inline(always)]
pub(in crate::step) fn of_row<T: Float, P: Pack<T>>(row: &T::Row, lane: usize) -> P {
    P::from_rows([row, row], lane)
}
