//! Records aligned to a cache line.

use super::LINE;

/// Records of four numbers, the first of them aligned to a cache line.
#[derive(Debug, Default)]
pub struct AlignedRecords<T> {
    /// Numbers with slack for the alignment.
    numbers: Vec<T>,
    count: usize,
}

impl<T: Copy + Default> AlignedRecords<T> {
    /// Create `count` records of zeros.
    pub fn zeros(count: usize) -> Self {
        let room = if count == 0 { 0 } else { LINE / size_of::<T>() };
        AlignedRecords { numbers: vec![T::default(); 4 * count + room], count }
    }

    /// Set the number of records to `count`; if it changes, all are zero.
    pub fn have(&mut self, count: usize) {
        if self.count != count {
            *self = Self::zeros(count);
        }
    }

    /// Index of the first number of the first record.
    #[inline(always)]
    fn start(&self) -> usize {
        // Any start will do if no aligned one exists.
        self.numbers.as_ptr().align_offset(LINE).min(self.numbers.len() - 4 * self.count)
    }

    /// Return the records.
    #[inline(always)]
    pub fn all(&self) -> &[[T; 4]] {
        self.numbers[self.start()..][..4 * self.count].as_chunks().0
    }

    /// Return the records for writing.
    #[inline(always)]
    pub fn all_mut(&mut self) -> &mut [[T; 4]] {
        let start = self.start();
        self.numbers[start..][..4 * self.count].as_chunks_mut().0
    }

    /// Return the allocated memory, bytes.
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
