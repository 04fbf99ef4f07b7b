//! What contact keeps from step to step, and what it reports.

use std::sync::Mutex;

use impactite_scene::{ContactPoint, PairContact};

use super::Scratch;
use super::memory::{ContactMemory, TouchMemory};
use crate::geometry::Lattice;
use crate::parallel::Float;
use crate::step::fields::{Fields, Member};
use crate::step::nodes::BlockPlace;

/// Two fields of a block that share nodes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pair {
    /// The fields, the smaller first.
    pub fields: [u32; 2],
    /// Their bodies.
    pub bodies: [u32; 2],
    /// Nodes of which it is known whether the surfaces touch, a bit each. Where they do, there is a [`Touch`].
    pub known: u64,
    /// Has it been known since an earlier step?
    pub lasts: bool,
    /// Does its law remember contacts? Told anew in every step.
    pub remembers: bool,
    /// Energy dissipated by friction in this step, J.
    pub friction: f64,
    /// Kinetic energy of the nodes taken beside that in this step, J.
    pub taken: f64,
    /// How far both had moved when they were looked at, m.
    pub(in crate::step) way: f64,
}

impl Pair {
    /// A pair of fields, of these bodies, that was not looked at before.
    pub fn new(fields: [u32; 2], bodies: [u32; 2]) -> Self {
        Pair { fields, bodies, known: 0, lasts: false, remembers: false, friction: 0.0, taken: 0.0, way: 0.0 }
    }
}

/// A pair that touches at a node, or may before it is looked at anew.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Touch<T> {
    /// Which node of the block.
    pub node: u8,
    /// Do the bodies act on each other there in this step?
    pub acts: bool,
    /// Is it the image of another node behind a plane of symmetry ([`super::SharedNodes::is_image`])?
    pub image: bool,
    /// Which of the block's pairs.
    pub pair: u32,
    /// Unit normal, from the first field to the second.
    pub normal: [T; 3],
    /// Distance of the surfaces along it, m, where it is measured; negative if they overlap. Since it was measured it
    /// follows the nodes.
    pub gap: Option<T>,
    /// Impulse on the second field, N s; the first gets its opposite.
    pub impulse: [T; 3],
}

/// What a contact algorithm found at a shared block. Pairs and their touches stay as they are from step to step, until
/// their bodies have moved as far as [`super::Contact::keeps`] says or one of them has left the block.
#[derive(Clone, Debug)]
pub struct BlockContacts<T> {
    /// The pairs of fields that share nodes.
    pub pairs: Vec<Pair>,
    /// Where they touch, by node and pair.
    pub touches: Vec<Touch<T>>,
    /// What they remember.
    pub memory: TouchMemory,
    pub(in crate::step) stale: bool,
    pub(in crate::step) block: [i32; 3],
}

impl<T> Default for BlockContacts<T> {
    fn default() -> Self {
        BlockContacts {
            pairs: Vec::new(),
            touches: Vec::new(),
            memory: TouchMemory::default(),
            stale: false,
            block: [0; 3],
        }
    }
}

impl<T: Float> BlockContacts<T> {
    /// Impulses on a field: node by node, the sum of its pairs'.
    pub fn impulses(&self, field: usize) -> impl Iterator<Item = (usize, [T; 3])> + '_ {
        let at_node = self.touches.chunk_by(|a, b| a.node == b.node);
        at_node.filter_map(move |touches| {
            let (mut sum, mut any) = ([T::default(); 3], false);
            for touch in touches.iter().filter(|t| t.acts) {
                let [first, second] = self.pairs[touch.pair as usize].fields;
                let sign = match field as u32 {
                    f if f == first => T::of(-1.0),
                    f if f == second => T::of(1.0),
                    _ => continue,
                };
                for d in 0..3 {
                    sum[d] += sign * touch.impulse[d];
                    any |= touch.impulse[d] != T::default();
                }
            }
            any.then_some((touches[0].node as usize, sum))
        })
    }

    /// Call the fields what they are called now, in the same order; or know no more what is found, if some are gone.
    fn renumber(&mut self, members: &[Member]) {
        let field = |body| members.binary_search_by_key(&body, |m| m.body).ok();
        for pair in &mut self.pairs {
            let [Some(r), Some(s)] = pair.bodies.map(field) else {
                self.stale = true;
                return;
            };
            pair.fields = [r as u32, s as u32];
        }
    }

    /// Forget of every pair what its bodies have moved away from by `keeps`, m; `way` is how far each body moved so far.
    pub(in crate::step) fn renew(&mut self, way: &[f64], keeps: f64) {
        if self.stale {
            self.forget();
            self.stale = false;
        }
        let mut forgotten = false;
        for pair in &mut self.pairs {
            let now = pair.bodies.iter().map(|&b| way[b as usize]).sum();
            pair.lasts = now - pair.way < keeps;
            if !pair.lasts {
                (pair.known, pair.way) = (0, now);
                forgotten = true;
            }
        }
        if forgotten {
            self.touches.retain(|t| self.pairs[t.pair as usize].lasts);
        }
    }

    fn forget(&mut self) {
        self.pairs.clear();
        self.touches.clear();
    }

    fn bytes(&self) -> usize {
        self.pairs.capacity() * size_of::<Pair>()
            + self.touches.capacity() * size_of::<Touch<T>>()
            + self.memory.bytes()
    }
}

fn extended<const D: usize>(block: &[i32; D]) -> [i32; 3] {
    let mut all = [0; 3];
    all[..D].copy_from_slice(block);
    all
}

/// What contact keeps from step to step.
#[derive(Debug)]
pub struct ContactState<T> {
    /// One a shared block, and behind those what was found in blocks that are shared no longer.
    pub(in crate::step) found: Vec<BlockContacts<T>>,
    shared: usize,
    /// Used while blocks are arranged.
    before: Vec<BlockContacts<T>>,
    pub(in crate::step) pairs: Vec<PairContact>,
    /// How far particles of each body may have moved since the start, m.
    pub(in crate::step) way: Vec<f64>,
    pub(in crate::step) memory: ContactMemory,
    /// Square of the largest speed by block, and by body.
    squares: Vec<T>,
    steps: Vec<T>,
    /// One a thread.
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
    /// The pairs that were ever in contact, by number.
    pub(in crate::step) fn pairs(&self) -> &[PairContact] {
        &self.pairs
    }

    /// The nodes in contact in the last step.
    pub(crate) fn nodes<const D: usize>(&self, lattice: &Lattice<D>) -> Vec<ContactPoint> {
        let mut nodes = Vec::new();
        for found in &self.found {
            let block: [i32; D] = std::array::from_fn(|d| found.block[d]);
            let place = BlockPlace::new(lattice, &block);
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

    /// Node blocks have changed: keep what was found where the bodies of a shared block are still among those there now. What
    /// was found elsewhere can be told until bodies are looked at again.
    pub(in crate::step) fn arrange<const D: usize>(&mut self, fields: &Fields<D>, bodies: usize) {
        let shared = fields.shared();
        self.before.append(&mut self.found);
        let (before, rest) = self.before.split_at_mut(self.shared);
        let mut before = before.iter_mut().peekable();
        let mut spare = rest.iter_mut().filter(|f| f.touches.is_empty());
        for (s, block) in shared.iter().enumerate() {
            let place = extended(&block.coordinates);
            // Both are sorted by place.
            while before.next_if(|f| f.block < place).is_some() {}
            let mut found = match before.next_if(|f| f.block == place) {
                Some(found) => std::mem::take(found),
                None => spare.next().map(std::mem::take).unwrap_or_default(),
            };
            found.block = place;
            found.renumber(fields.members(s));
            self.found.push(found);
        }
        // Those of blocks that are shared no longer, for what they tell and for their memory.
        self.found.extend(self.before.drain(..).filter(|f| f.bytes() > 0));
        self.shared = shared.len();
        self.way.resize(bodies, 0.0);
    }

    /// The shared blocks before contact acts there; how far each body has moved; what laws remember; memory for
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

    /// Keep what laws remember at the end of the step, for cells of `spacing`, m.
    pub(super) fn remember(&mut self, spacing: f64) {
        self.memory.keep(&self.found[..self.shared], spacing);
    }

    /// Room for the squares of the largest speeds, one a block.
    pub(in crate::step) fn squares(&mut self, blocks: usize) -> &mut [T] {
        self.squares.resize(blocks, T::default());
        &mut self.squares
    }

    /// Note the way of every body in a step of `dt`, s, from the squares of its blocks' speeds.
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

    /// Book what contact did to the trial velocities: friction and what else contact took, J.
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

    /// Bytes of its memory.
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

/// Is it in contact, and not told of as another node?
fn counts<T: Float>(touch: &Touch<T>) -> bool {
    touch.acts && !touch.image && touch.impulse.iter().any(|&x| x != T::default())
}

/// The entry of a pair of bodies in a sorted list.
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
