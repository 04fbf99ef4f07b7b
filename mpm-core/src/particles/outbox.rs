//! Particles in transit from one bin to another.

use impactite_simd::Float;

/// Particles that left their bins in a pass, consecutive for each source block; the target block, another or the same, stores them.
#[derive(Clone, Debug, Default)]
pub struct Outbox<T> {
    /// Target block of each particle: 0 .. 3^D, x fastest, the source block in the middle.
    to: Vec<u8>,
    /// Bin of each particle in the target block.
    bin: Vec<u8>,
    /// Values and payload of each particle.
    numbers: Vec<T>,
    /// Number of values per particle.
    length: usize,
}

/// Particles sent by a block: a range of an outbox.
#[derive(Clone, Copy, Debug, Default)]
pub struct Sent {
    /// Index of the outbox.
    pub outbox: u32,
    first: u32,
    end: u32,
    /// Bit mask of target blocks: bit `to` is set if a particle goes to block `to`.
    pub directions: u32,
}

impl Sent {
    /// True if a particle goes to the block `to`.
    #[inline(always)]
    pub fn goes(&self, to: usize) -> bool {
        self.directions >> to & 1 == 1
    }
}

impl<T: Float> Outbox<T> {
    /// Clear the outbox for particles of `length` values each, and keep its memory.
    pub fn clear(&mut self, length: usize) {
        self.to.clear();
        self.bin.clear();
        self.numbers.clear();
        self.length = length;
    }

    /// Append a particle that goes to bin `bin` of the block `to`, and return the memory for its values.
    #[inline(always)]
    pub fn post(&mut self, to: usize, bin: usize) -> &mut [T] {
        let start = self.numbers.len();
        if self.numbers.capacity() < start + self.length {
            // Reserve a little: where a lattice of particles moves as one, many leave at once and rarely.
            self.numbers.reserve_exact((self.to.len() / 16 + 32) * self.length);
        }
        self.to.push(to as u8);
        self.bin.push(bin as u8);
        self.numbers.resize(start + self.length, T::default());
        &mut self.numbers[start..]
    }

    /// Append the particles of another outbox of as many values.
    pub fn append(&mut self, other: &Self) {
        self.to.extend_from_slice(&other.to);
        self.bin.extend_from_slice(&other.bin);
        self.numbers.extend_from_slice(&other.numbers);
    }

    /// Number of particles.
    pub fn posted(&self) -> usize {
        self.to.len()
    }

    /// Return the particles from index `first` on, as sent from outbox number `outbox`.
    pub fn since(&self, first: usize, outbox: u32) -> Sent {
        let directions = self.to[first..].iter().fold(0, |all, to| all | 1 << to);
        Sent { outbox, first: first as u32, end: self.posted() as u32, directions }
    }

    /// Iterate over those particles of `sent` that go to the block `to`: target bin and values.
    #[inline(always)]
    pub fn going(&self, sent: Sent, to: usize) -> impl Iterator<Item = (usize, &[T])> {
        let particles = sent.first as usize..sent.end as usize;
        particles
            .filter(move |&n| self.to[n] as usize == to)
            .map(|n| (self.bin[n] as usize, &self.numbers[n * self.length..][..self.length]))
    }

    /// Memory of the outbox, bytes.
    pub fn bytes(&self) -> usize {
        self.numbers.capacity() * size_of::<T>() + self.to.capacity() + self.bin.capacity()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blocks_find_what_was_sent_to_them() {
        let mut outbox = Outbox::default();
        for pass in 0..2 {
            outbox.clear(2 + pass);
            let mut sent = Vec::new();
            // Three blocks: with three particles, with none, and with more than the initial capacity.
            for (block, count) in [(0, 3), (1, 0), (2, 500)] {
                let first = outbox.posted();
                for n in 0..count {
                    outbox.post(n % 5, n % 64)[1] = (1000 * block + n) as f64;
                }
                sent.push(outbox.since(first, block as u32));
            }
            for (block, (sent, count)) in sent.iter().zip([3, 0, 500]).enumerate() {
                assert_eq!(sent.outbox, block as u32);
                for to in 0..9 {
                    let expected: Vec<usize> = (0..count).filter(|n| n % 5 == to).collect();
                    assert_eq!(sent.goes(to), !expected.is_empty());
                    let found: Vec<(usize, f64)> =
                        outbox.going(*sent, to).map(|(bin, numbers)| (bin, numbers[1])).collect();
                    let expected: Vec<(usize, f64)> =
                        expected.iter().map(|n| (n % 64, (1000 * block + n) as f64)).collect();
                    assert_eq!(found, expected);
                    assert!(outbox.going(*sent, to).all(|(_, numbers)| numbers.len() == 2 + pass));
                }
            }
        }
    }
}
