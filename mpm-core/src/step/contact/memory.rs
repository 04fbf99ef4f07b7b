//! Contact memory: state variables of contact laws by pair of bodies and node, kept from step to step.
//!
//! A record exists while the pair is in contact at its node. It moves with the mean of both velocities, from node to
//! nearest node, so that a patch in rigid motion changes nodes in a single step; see [`mpm_contact::Remembers`]. Records
//! are sorted by pair and node, looked up but not iterated by tasks, and rewritten between stages: results are bitwise
//! independent of threads and blocks.

use std::cmp::Ordering;

use super::found::{BlockContacts, OFFSET};
use crate::dim::BLOCK;
use impactite_simd::Float;

/// Pair of bodies at a node of the lattice.
pub(in crate::step) type Key = ([u32; 2], [i32; 3]);

/// Contact records of a scene.
#[derive(Clone, Debug, Default)]
pub struct ContactMemory {
    pub(in crate::step) width: usize,
    /// Keys of the records, with the start of their numbers.
    pub(in crate::step) keys: Vec<(Key, usize)>,
    pub(in crate::step) numbers: Vec<f64>,
    /// Previous numbers, while they are rewritten.
    before: Vec<f64>,
}

/// Return the lattice index of a node of a block.
pub(super) fn node_of(block: [i32; 3], node: usize) -> [i32; 3] {
    [0, 1, 2].map(|d| block[d] * BLOCK as i32 + (node / BLOCK.pow(d as u32) % BLOCK) as i32)
}

impl ContactMemory {
    fn record(&self, key: &Key) -> Option<&[f64]> {
        let found = self.keys.binary_search_by(|entry| entry.0.cmp(key)).ok()?;
        Some(&self.numbers[self.keys[found].1..][..self.width])
    }

    /// Load the record of a pair at a node; without one, the mean of the nearest ones at the nodes around it in
    /// `dimensions`. Without any, `record` is unchanged.
    pub(super) fn recall(&self, bodies: [u32; 2], node: [i32; 3], dimensions: usize, record: &mut [f64]) {
        if self.keys.is_empty() {
            return;
        }
        if let Some(own) = self.record(&(bodies, node)) {
            record.copy_from_slice(own);
            return;
        }
        let depth = if dimensions == 3 { -1..=1 } else { 0..=0 };
        for square in 1..=dimensions as i32 {
            let mut count = 0.0;
            for z in depth.clone() {
                for y in -1..=1 {
                    for x in -1..=1 {
                        if x * x + y * y + z * z != square {
                            continue;
                        }
                        let near = [node[0] + x, node[1] + y, node[2] + z];
                        if let Some(other) = self.record(&(bodies, near)) {
                            record.iter_mut().zip(other).for_each(|(sum, x)| *sum += x);
                            count += 1.0;
                        }
                    }
                }
            }
            if count > 0.0 {
                record.iter_mut().for_each(|sum| *sum /= count);
                return;
            }
        }
    }

    /// Store the records of touches at the end of a step, for pairs whose laws have state variables and cells of `spacing`,
    /// m.
    pub(super) fn keep<T: Float>(&mut self, found: &[BlockContacts<T>], spacing: f64) {
        self.keys.clear();
        self.numbers.clear();
        for block in found {
            let memory = &block.memory;
            for (n, touch) in block.touches.iter().enumerate() {
                let pair = &block.pairs[touch.pair as usize];
                let Some(record) = memory.end.get(n * memory.width..(n + 1) * memory.width) else { continue };
                if !pair.remembers || record.is_empty() {
                    continue;
                }
                self.width = memory.width;
                let mut node = node_of(block.block, touch.node as usize);
                let start = self.numbers.len();
                self.numbers.extend_from_slice(record);
                for d in 0..OFFSET {
                    let offset = &mut self.numbers[start + d];
                    let cells = (*offset / spacing).round().clamp(-1.0, 1.0);
                    node[d] += cells as i32;
                    *offset -= cells * spacing;
                }
                self.keys.push(((pair.bodies, node), start));
            }
        }
        // Keep the nearer of two records at one node; at equal distance, that of the first node.
        let numbers = &self.numbers;
        let away = |start: usize| numbers[start..][..OFFSET].iter().map(|x| x * x).sum::<f64>();
        self.keys.sort_by(|a, b| {
            a.0.cmp(&b.0).then_with(|| away(a.1).partial_cmp(&away(b.1)).unwrap_or(Ordering::Equal))
        });
        self.keys.dedup_by(|b, a| a.0 == b.0);
        // Sort the numbers like the keys, so that a checkpoint does not depend on the blocks.
        std::mem::swap(&mut self.numbers, &mut self.before);
        self.numbers.clear();
        for (_, start) in &mut self.keys {
            let record = &self.before[*start..][..self.width];
            *start = self.numbers.len();
            self.numbers.extend_from_slice(record);
        }
    }

    pub(super) fn bytes(&self) -> usize {
        self.keys.capacity() * size_of::<(Key, usize)>()
            + (self.numbers.capacity() + self.before.capacity()) * size_of::<f64>()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::step::contact::{Pair, Touch};

    const BODIES: [u32; 2] = [0, 2];

    /// Store touches at nodes of the block at the origin, each with an offset along x and a number.
    fn kept(records: &[(u8, f64, f64)]) -> ContactMemory {
        let mut found = BlockContacts::<f64>::default();
        found.pairs.push(Pair { remembers: true, ..Pair::new([0, 1], BODIES) });
        found.touches.extend(records.iter().map(|r| Touch { node: r.0, ..Touch::default() }));
        found.memory.clear(records.len(), 1);
        found.memory.recalled();
        for (n, &(_, offset, number)) in records.iter().enumerate() {
            found.memory.carry(n, [offset, 0.0, 0.0]);
            found.memory.start_and_end(n).1[0] = number;
        }
        let mut memory = ContactMemory::default();
        memory.keep(&[found], 0.1);
        memory
    }
    fn at(memory: &ContactMemory, node: [i32; 3]) -> [f64; 2] {
        let mut record = [0.0; OFFSET + 1];
        memory.recall(BODIES, node, 2, &mut record);
        [record[0], record[OFFSET]]
    }

    #[test]
    fn new_nodes_take_the_nearest_ones() {
        let memory = kept(&[(0, 0.0, 1.0), (1, 0.0, 2.0), (2, 0.0, 4.0)]);
        assert_eq!(at(&memory, [1, 0, 0]), [0.0, 2.0], "its own");
        assert_eq!(at(&memory, [3, 0, 0]), [0.0, 4.0], "beside");
        assert_eq!(at(&memory, [1, 1, 0]), [0.0, 2.0], "below it, and not those aslant");
        assert_eq!(at(&memory, [3, 1, 0]), [0.0, 4.0], "aslant, where there is no other");
        assert_eq!(at(&memory, [1, 2, 0]), [0.0, 0.0], "a new contact");
        let ends = kept(&[(0, 0.0, 1.0), (2, 0.0, 4.0)]);
        assert_eq!(at(&ends, [1, 0, 0]), [0.0, 2.5], "between two");
        let mut other = [0.0; OFFSET + 1];
        memory.recall([0, 1], [1, 0, 0], 2, &mut other);
        assert_eq!(other[OFFSET], 0.0, "another pair");
    }

    #[test]
    fn records_move_to_the_nearest_node() {
        let near = kept(&[(1, 0.04, 3.0)]);
        assert_eq!(at(&near, [1, 0, 0]), [0.04, 3.0]);
        let far = kept(&[(1, 0.06, 3.0), (2, 0.0, 5.0)]);
        assert_eq!(at(&far, [1, 0, 0])[1], 5.0, "it has left, and its neighbour is near");
        assert_eq!(at(&far, [2, 0, 0])[1], 5.0, "the nearer one of two stays");
        let both = kept(&[(1, 0.06, 3.0), (2, 0.06, 5.0)]);
        let [offset, number] = at(&both, [2, 0, 0]);
        assert!((offset + 0.04).abs() < 1e-15 && number == 3.0);
        assert_eq!(at(&both, [3, 0, 0])[1], 5.0);
        // From the first block to the one before it.
        assert_eq!(at(&kept(&[(0, -0.06, 7.0)]), [-1, 0, 0])[1], 7.0);
    }
}
