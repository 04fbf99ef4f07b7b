//! Records that begin with a cache line.

use super::LINE;

/// Records of four numbers, the first of them at the beginning of a cache line.
#[derive(Debug, Default)]
pub struct AlignedRecords<T> {
    /// With room to choose where to begin.
    numbers: Vec<T>,
    count: usize,
}

impl<T: Copy + Default> AlignedRecords<T> {
    /// So many records of zeros.
    pub fn zeros(count: usize) -> Self {
        let room = if count == 0 { 0 } else { LINE / size_of::<T>() };
        AlignedRecords { numbers: vec![T::default(); 4 * count + room], count }
    }

    /// Have so many records; zeros, if there was another number of them.
    pub fn have(&mut self, count: usize) {
        if self.count != count {
            *self = Self::zeros(count);
        }
    }

    /// The place of the first one among the numbers.
    #[inline(always)]
    fn start(&self) -> usize {
        // Where no place is found, any will do.
        self.numbers.as_ptr().align_offset(LINE).min(self.numbers.len() - 4 * self.count)
    }

    /// The records.
    #[inline(always)]
    pub fn all(&self) -> &[[T; 4]] {
        self.numbers[self.start()..][..4 * self.count].as_chunks().0
    }

    /// The records.
    #[inline(always)]
    pub fn all_mut(&mut self) -> &mut [[T; 4]] {
        let start = self.start();
        self.numbers[start..][..4 * self.count].as_chunks_mut().0
    }

    /// Bytes of its memory.
    pub fn bytes(&self) -> usize {
        self.numbers.capacity() * size_of::<T>()
    }
}

impl<T: Copy + Default> Clone for AlignedRecords<T> {
    fn clone(&self) -> Self {
        let mut own = Self::zeros(self.count);
        own.all_mut().copy_from_slice(self.all());
        own
    }
}
