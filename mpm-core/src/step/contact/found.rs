//! What a contact algorithm finds at a block of nodes that bodies share.

use std::ops::Range;

use crate::step::nodes::fields::Member;
use impactite_simd::Float;

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
/// their bodies have moved as far as [`super::ContactAlgorithm::keeps`] says or one of them has left the block.
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
    pub(super) fn renumber(&mut self, members: &[Member]) {
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

    pub(super) fn forget(&mut self) {
        self.pairs.clear();
        self.touches.clear();
    }

    pub(super) fn bytes(&self) -> usize {
        self.pairs.capacity() * size_of::<Pair>()
            + self.touches.capacity() * size_of::<Touch<T>>()
            + self.memory.bytes()
    }
}

/// What a block's touches remember at the start and at the end of a step: a record each, in their order; empty where no law remembers.
#[derive(Clone, Debug, Default)]
pub struct TouchMemory {
    pub(super) width: usize,
    pub(super) start: Vec<f64>,
    pub(super) end: Vec<f64>,
}

impl TouchMemory {
    /// Room for so many touches, of laws that remember up to `numbers`.
    pub(super) fn clear(&mut self, touches: usize, numbers: usize) {
        self.width = if numbers == 0 { 0 } else { OFFSET + numbers };
        self.start.clear();
        self.start.resize(touches * self.width, 0.0);
        self.end.clear();
    }
    /// The record of a touch, to be recalled.
    pub(super) fn record_mut(&mut self, touch: usize) -> &mut [f64] {
        &mut self.start[touch * self.width..][..self.width]
    }
    /// All is recalled; touches that nothing happens to end as they started.
    pub(super) fn recalled(&mut self) {
        self.end.clone_from(&self.start);
    }
    /// The numbers of a touch, by its place in [`BlockContacts::touches`], at the start of the step; empty where no law remembers.
    pub fn start(&self, touch: usize) -> &[f64] {
        self.start.get(self.numbers(touch)).unwrap_or_default()
    }
    /// Those at the start, and those at the end of the step, to be brought there.
    pub fn start_and_end(&mut self, touch: usize) -> (&[f64], &mut [f64]) {
        let numbers = self.numbers(touch);
        (self.start.get(numbers.clone()).unwrap_or_default(), self.end.get_mut(numbers).unwrap_or_default())
    }
    /// Move what a touch remembers by a way, m.
    pub fn carry(&mut self, touch: usize, way: [f64; 3]) {
        let start = touch * self.width;
        let offset = self.end.get_mut(start..start + OFFSET.min(self.width)).unwrap_or_default();
        offset.iter_mut().zip(way).for_each(|(x, way)| *x += way);
    }
    fn numbers(&self, touch: usize) -> Range<usize> {
        let start = touch * self.width;
        start + OFFSET.min(self.width)..start + self.width
    }
    pub(super) fn bytes(&self) -> usize {
        (self.start.capacity() + self.end.capacity()) * size_of::<f64>()
    }
}

/// Which velocities contact acts on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ContactPhase {
    /// Those of the mapped momentum, before the stress update of USF.
    Momentum,
    /// The trial velocities of the momentum update: every body moved by its own forces.
    Trial,
    /// Those mapped a second time (MUSL).
    Remapped,
}

/// Memory of a thread for contact algorithms: nothing in it lasts.
#[derive(Clone, Debug)]
pub struct Scratch<T> {
    /// Numbers of nodes.
    pub numbers: Vec<[T; 4]>,
    /// Sets of nodes, a bit each.
    pub bits: Vec<u64>,
    /// Vectors of pairs, two each.
    pub vectors: Vec<[[T; 3]; 3]>,
}

impl<T> Default for Scratch<T> {
    fn default() -> Self {
        Scratch { numbers: Vec::new(), bits: Vec::new(), vectors: Vec::new() }
    }
}

impl<T> Scratch<T> {
    /// Bytes of its memory.
    pub(in crate::step) fn bytes(&self) -> usize {
        self.numbers.capacity() * size_of::<[T; 4]>()
            + self.bits.capacity() * size_of::<u64>()
            + self.vectors.capacity() * size_of::<[[T; 3]; 3]>()
    }
}

/// Numbers of a record before those of the law: how far it is from its node, m.
pub(in crate::step) const OFFSET: usize = 3;
