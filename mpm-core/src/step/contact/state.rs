//! Contact state, kept from step to step, and contact results.

use std::sync::Mutex;

use impactite_scene::{ContactPoint, PairContact};

use super::found::{BlockContacts, Scratch, Touch};
use super::memory::ContactMemory;
use crate::grid::Lattices;
use crate::step::nodes::block_place::BlockPlace;
use crate::step::nodes::fields::Fields;
use impactite_simd::Float;

fn extended<const D: usize>(block: &[i32; D]) -> [i32; 3] {
    let mut all = [0; 3];
    all[..D].copy_from_slice(block);
    all
}

/// Contact state, kept from step to step.
#[derive(Debug)]
pub struct ContactState<T> {
    /// Contacts of each shared block, followed by those of blocks that are no longer shared.
    pub(in crate::step) found: Vec<BlockContacts<T>>,
    shared: usize,
    /// Previous contacts, while blocks are arranged.
    before: Vec<BlockContacts<T>>,
    pub(in crate::step) pairs: Vec<PairContact>,
    /// Bound of the motion of each body's particles since the start, m.
    pub(in crate::step) way: Vec<f64>,
    pub(in crate::step) memory: ContactMemory,
    /// Square of the largest speed by block (`squares`) and by body (`steps`).
    squares: Vec<T>,
    steps: Vec<T>,
    /// Scratch memory, one per thread.
    pub(in crate::step) scratch: Vec<Mutex<Scratch<T>>>,
}

impl<T> Default for ContactState<T> {
    fn default() -> Self {
        ContactState {
            found: Vec::new(),
            shared: 0,
            before: Vec::new(),
            pairs: Vec::new(),
            way: Vec::new(),
            memory: ContactMemory::default(),
            squares: Vec::new(),
            steps: Vec::new(),
            scratch: Vec::new(),
        }
    }
}

impl<T: Float> ContactState<T> {
    /// Pairs that were ever in contact, by body index.
    pub(in crate::step) fn pairs(&self) -> &[PairContact] {
        &self.pairs
    }

    /// Return the nodes in contact in the last step.
    pub(crate) fn nodes<const D: usize>(&self, lattices: &Lattices<D>) -> Vec<ContactPoint> {
        let mut nodes = Vec::new();
        for found in &self.found {
            let block: [i32; D] = std::array::from_fn(|d| found.block[d]);
            let place = BlockPlace::new(lattices, &block);
            for touch in found.touches.iter().filter(|t| counts(t)) {
                let mut position = [0.0; 3];
                position[..D].copy_from_slice(&place.node(touch.node as usize));
                nodes.push(ContactPoint {
                    position,
                    bodies: found.pairs[touch.pair as usize].bodies.map(|b| b as usize),
                    normal: touch.normal.map(T::to_double),
                    gap: touch.gap.map(T::to_double),
                    impulse: touch.impulse.map(T::to_double),
                });
            }
        }
        nodes
    }

    /// Rearrange contacts after a change of node blocks: keep those of shared blocks whose bodies are still there. Other
    /// contacts are reported until the next update.
    pub(in crate::step) fn arrange<const D: usize>(&mut self, fields: &Fields<D>, bodies: usize) {
        let shared = fields.shared();
        self.before.append(&mut self.found);
        let (before, rest) = self.before.split_at_mut(self.shared);
        let mut before = before.iter_mut().peekable();
        let mut spare = rest.iter_mut().filter(|f| f.touches.is_empty());
        for (s, block) in shared.iter().enumerate() {
            let place = extended(&block.coordinates);
            // Both lists are sorted by block.
            while before.next_if(|f| f.block < place).is_some() {}
            let mut found = match before.next_if(|f| f.block == place) {
                Some(found) => std::mem::take(found),
                None => spare.next().map(std::mem::take).unwrap_or_default(),
            };
            found.block = place;
            found.renumber(fields.members(s));
            self.found.push(found);
        }
        // Keep contacts of blocks that are no longer shared, for their report and their memory.
        self.found.extend(self.before.drain(..).filter(|f| f.bytes() > 0));
        self.shared = shared.len();
        self.way.resize(bodies, 0.0);
    }

    /// Return the contacts of the shared blocks, the motion of each body, the contact memory, and scratch memory for
    /// `threads`.
    #[allow(clippy::type_complexity)]
    pub(in crate::step) fn open(
        &mut self,
        threads: usize,
    ) -> (&mut [BlockContacts<T>], &[f64], &ContactMemory, &[Mutex<Scratch<T>>]) {
        let (here, gone) = self.found.split_at_mut(self.shared);
        gone.iter_mut().for_each(BlockContacts::forget);
        self.scratch.resize_with(threads, Mutex::default);
        (here, &self.way, &self.memory, &self.scratch)
    }

    /// Store the state variables at the end of the step, for cells of `spacing`, m.
    pub(super) fn remember(&mut self, spacing: f64) {
        self.memory.keep(&self.found[..self.shared], spacing);
    }

    /// Return the buffer for squares of the largest speeds, one per block.
    pub(in crate::step) fn squares(&mut self, blocks: usize) -> &mut [T] {
        self.squares.resize(blocks, T::default());
        &mut self.squares
    }

    /// Add the motion of every body in a step of `dt`, s, from the squares of its blocks' speeds.
    pub(in crate::step) fn follow(&mut self, owner: impl Fn(usize) -> u32, dt: f64) {
        self.steps.clear();
        self.steps.resize(self.way.len(), T::default());
        for (block, &square) in self.squares.iter().enumerate() {
            if let Some(step) = self.steps.get_mut(owner(block) as usize) {
                *step = step.max(square);
            }
        }
        for (way, &square) in self.way.iter_mut().zip(&self.steps) {
            *way += square.sqrt().to_double() * dt;
        }
    }

    /// Record the contact results of the trial velocities. Returns the energies dissipated by friction and by the rest of
    /// contact, J.
    pub(in crate::step) fn book(&mut self, dt: f64) -> [f64; 2] {
        for pair in &mut self.pairs {
            (pair.force, pair.places, pair.gap) = ([0.0; 3], 0, None);
        }
        let mut sums = [0.0; 2];
        for found in &self.found[..self.shared] {
            for (number, pair) in found.pairs.iter().enumerate() {
                let mine = |t: &&Touch<T>| t.pair as usize == number && counts(t);
                let mut touches = found.touches.iter().filter(mine).peekable();
                if touches.peek().is_none() {
                    continue;
                }
                let entry = entry(&mut self.pairs, pair.bodies.map(|b| b as usize));
                for touch in touches {
                    for d in 0..3 {
                        entry.force[d] += touch.impulse[d].to_double() / dt;
                    }
                    entry.places += 1;
                    let gap = touch.gap.map(T::to_double);
                    entry.gap = match (entry.gap, gap) {
                        (Some(a), Some(b)) => Some(a.min(b)),
                        (a, b) => a.or(b),
                    };
                }
                entry.friction += pair.friction;
                entry.taken += pair.taken;
                sums[0] += pair.friction;
                sums[1] += pair.taken;
            }
        }
        sums
    }

    /// Allocated memory, bytes.
    pub(in crate::step) fn bytes(&self) -> usize {
        let scratch = |s: &Mutex<Scratch<T>>| s.lock().map_or(0, |s| s.bytes() + size_of::<Scratch<T>>());
        self.found.iter().map(BlockContacts::bytes).sum::<usize>()
            + (self.found.capacity() + self.before.capacity()) * size_of::<BlockContacts<T>>()
            + self.pairs.capacity() * size_of::<PairContact>()
            + self.way.capacity() * size_of::<f64>()
            + self.memory.bytes()
            + (self.squares.capacity() + self.steps.capacity()) * size_of::<T>()
            + self.scratch.iter().map(scratch).sum::<usize>()
    }
}

/// Return true if the touch is in contact, and not the image of another node.
fn counts<T: Float>(touch: &Touch<T>) -> bool {
    touch.acts && !touch.image && touch.impulse.iter().any(|&x| x != T::default())
}

/// Return the entry of a pair of bodies in a sorted list, added if absent.
fn entry(pairs: &mut Vec<PairContact>, bodies: [usize; 2]) -> &mut PairContact {
    let place = match pairs.binary_search_by_key(&bodies, |p| p.bodies) {
        Ok(place) => place,
        Err(place) => {
            pairs.insert(place, PairContact::new(bodies));
            place
        }
    };
    &mut pairs[place]
}
