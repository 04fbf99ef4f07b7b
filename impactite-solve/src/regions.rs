//! Singular regions: connected unknowns without a Dirichlet boundary.

use impactite_simd::Team;

use crate::cells::{CellBlocks, slots, stride};
use crate::vectors::PIECE;

/// Bits of the slots of a block.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct BlockMasks {
    /// Unknowns.
    pub unknown: u64,
    /// Unknowns with a Dirichlet excess.
    pub held: u64,
    /// Slots coupled with their upper neighbour along each axis.
    pub coupled: [u64; 3],
    /// True if an entry is invalid.
    pub invalid: bool,
}

/// Connected regions of unknowns without a Dirichlet excess.
///
/// Regions within a block are filled by bit operations on its slots, and joined across blocks by a union-find forest.
#[derive(Clone, Debug, Default)]
pub(crate) struct Regions {
    unknowns: usize,
    /// Number of unknowns of each singular region.
    sizes: Vec<u64>,
    /// Parts of singular regions in blocks, sorted by block.
    parts: Vec<Part>,
}

/// Part of a singular region in a block.
#[derive(Clone, Copy, Debug)]
struct Part {
    block: u32,
    region: u32,
    mask: u64,
}

impl Regions {
    /// Find the singular regions of blocks with these masks.
    pub fn find<const D: usize>(cells: &CellBlocks<D>, masks: &[BlockMasks]) -> Self {
        let unknowns = masks.iter().map(|m| m.unknown.count_ones() as usize).sum();
        let (mut pieces, mut starts) = (Vec::with_capacity(masks.len()), Vec::with_capacity(masks.len() + 1));
        for mask in masks {
            starts.push(pieces.len());
            fill::<D>(mask, &mut pieces);
        }
        starts.push(pieces.len());
        let mut forest = Forest::new(pieces.len());
        for block in 0..masks.len() {
            for axis in 0..D {
                let Some(beside) = cells.block_neighbour(block, axis, true) else { continue };
                let (shift, crossing) =
                    (3 * stride(axis), masks[block].coupled[axis] & upper_side::<D>(axis));
                for a in starts[block]..starts[block + 1] {
                    let reached = (pieces[a] & crossing) >> shift;
                    for b in starts[beside]..starts[beside + 1] {
                        if pieces[b] & reached != 0 {
                            forest.join(a, b);
                        }
                    }
                }
            }
        }
        Self::keep_singular(masks, &pieces, &starts, &mut forest, unknowns)
    }

    fn keep_singular(
        masks: &[BlockMasks],
        pieces: &[u64],
        starts: &[usize],
        forest: &mut Forest,
        unknowns: usize,
    ) -> Self {
        let mut held = vec![false; pieces.len()];
        for block in 0..masks.len() {
            for a in starts[block]..starts[block + 1] {
                held[forest.root(a)] |= pieces[a] & masks[block].held != 0;
            }
        }
        let mut numbers = vec![u32::MAX; pieces.len()];
        let mut regions = Regions { unknowns, ..Regions::default() };
        for block in 0..masks.len() {
            for a in starts[block]..starts[block + 1] {
                let root = forest.root(a);
                if held[root] {
                    continue;
                }
                if numbers[root] == u32::MAX {
                    numbers[root] = regions.sizes.len() as u32;
                    regions.sizes.push(0);
                }
                regions.sizes[numbers[root] as usize] += u64::from(pieces[a].count_ones());
                regions.parts.push(Part { block: block as u32, region: numbers[root], mask: pieces[a] });
            }
        }
        regions
    }

    /// Number of unknowns of all regions, singular or not.
    pub fn unknowns(&self) -> usize {
        self.unknowns
    }

    /// Number of singular regions.
    pub fn len(&self) -> usize {
        self.sizes.len()
    }

    /// Subtract the mean over each singular region from vectors with `n` slots per block.
    pub fn subtract_means(&self, team: &Team, n: usize, x: &mut [f64]) {
        if self.parts.is_empty() {
            return;
        }
        let mut sums = vec![0.0; self.parts.len()];
        team.each_piece(&mut sums, PIECE / n, &mut vec![(); self.parts.len()], |first, sums, ()| {
            for (sum, part) in sums.iter_mut().zip(&self.parts[first * (PIECE / n)..]) {
                *sum = masked_sum(&x[part.block as usize * n..][..n], part.mask);
            }
        });
        let mut means = vec![0.0; self.sizes.len()];
        for (part, sum) in self.parts.iter().zip(&sums) {
            means[part.region as usize] += sum;
        }
        for (mean, size) in means.iter_mut().zip(&self.sizes) {
            *mean /= *size as f64;
        }
        let blocks = x.len() / n;
        team.each_piece(x, PIECE, &mut vec![(); blocks.div_ceil(PIECE / n)], |i, piece, ()| {
            let first = i * (PIECE / n);
            let end = first + piece.len() / n;
            let start = self.parts.partition_point(|p| (p.block as usize) < first);
            for part in self.parts[start..].iter().take_while(|p| (p.block as usize) < end) {
                let place = (part.block as usize - first) * n;
                masked_subtract(&mut piece[place..place + n], part.mask, means[part.region as usize]);
            }
        });
    }
}

fn masked_sum(x: &[f64], mask: u64) -> f64 {
    let mut sums = [0.0; 4];
    for (i, x) in x.iter().enumerate() {
        sums[i % 4] += if mask >> i & 1 == 1 { *x } else { 0.0 };
    }
    (sums[0] + sums[1]) + (sums[2] + sums[3])
}

fn masked_subtract(x: &mut [f64], mask: u64, mean: f64) {
    for (i, x) in x.iter_mut().enumerate() {
        *x -= if mask >> i & 1 == 1 { mean } else { 0.0 };
    }
}

/// Slots at the upper side of a block along an axis.
fn upper_side<const D: usize>(axis: usize) -> u64 {
    (0..slots::<D>()).filter(|i| i / stride(axis) % 4 == 3).fold(0, |mask, i| mask | 1 << i)
}

/// Append the connected regions of a block.
fn fill<const D: usize>(mask: &BlockMasks, pieces: &mut Vec<u64>) {
    let inner: [u64; D] = std::array::from_fn(|axis| mask.coupled[axis] & !upper_side::<D>(axis));
    let mut left = mask.unknown;
    while left != 0 {
        let mut region = left & left.wrapping_neg();
        loop {
            let mut grown = region;
            for axis in 0..D {
                grown |= (grown & inner[axis]) << stride(axis);
                grown |= (grown >> stride(axis)) & inner[axis];
            }
            if grown == region {
                break;
            }
            region = grown;
        }
        pieces.push(region);
        left &= !region;
    }
}

/// Union-find forest: the root of a tree is its smallest element.
struct Forest(Vec<u32>);

impl Forest {
    fn new(length: usize) -> Self {
        Forest((0..length as u32).collect())
    }
    fn root(&mut self, mut a: usize) -> usize {
        while self.0[a] as usize != a {
            self.0[a] = self.0[self.0[a] as usize];
            a = self.0[a] as usize;
        }
        a
    }
    fn join(&mut self, a: usize, b: usize) {
        let (a, b) = (self.root(a), self.root(b));
        self.0[a.max(b)] = a.min(b) as u32;
    }
}
