//! Contacts at a shared node block, as found by a contact algorithm.

use std::ops::Range;

use mpm_contact::FieldPoints;

use crate::step::nodes::fields::Member;
use impactite_simd::Float;

/// Pair of fields of a block that share nodes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pair {
    /// Indices of the fields, the smaller first.
    pub fields: [u32; 2],
    /// Bodies of the fields.
    pub bodies: [u32; 2],
    /// Nodes with known contact status, one bit each. A node in contact has a [`Touch`].
    pub known: u64,
    /// True if the status is known since an earlier step.
    pub lasts: bool,
    /// True if the law has state variables; set in every step.
    pub remembers: bool,
    /// Energy dissipated by friction in this step, J.
    pub friction: f64,
    /// Kinetic energy of the nodes dissipated other than by friction in this step, J.
    pub taken: f64,
    /// Sum of the motions of both bodies at the last update, m.
    pub(in crate::step) way: f64,
}

impl Pair {
    /// Create a pair of fields, of these bodies, without known contacts.
    pub fn new(fields: [u32; 2], bodies: [u32; 2]) -> Self {
        Pair { fields, bodies, known: 0, lasts: false, remembers: false, friction: 0.0, taken: 0.0, way: 0.0 }
    }
}

/// Contact of a pair at a node, active or possible before the next update.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Touch<T> {
    /// Index of the node in the block.
    pub node: u8,
    /// True if the contact is active in this step.
    pub acts: bool,
    /// True if the node is the image of another behind a symmetry plane ([`super::SharedNodes::is_image`]).
    pub image: bool,
    /// Index of the pair in the block.
    pub pair: u32,
    /// Unit contact normal, from the first field to the second.
    pub normal: [T; 3],
    /// Gap along the normal, m, if measured; negative for penetration. After the measurement it follows the nodes.
    pub gap: Option<T>,
    /// Impulse on the second field, N s; the opposite acts on the first.
    pub impulse: [T; 3],
}

/// Contacts at a shared block. Pairs and their touches are kept from step to step, until their bodies have moved by
/// [`super::ContactAlgorithm::keeps`] or one of them has left the block.
#[derive(Clone, Debug)]
pub struct BlockContacts<T> {
    /// Pairs of fields that share nodes.
    pub pairs: Vec<Pair>,
    /// Contacts of the pairs, by node and pair.
    pub touches: Vec<Touch<T>>,
    /// State variables of the contacts.
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
    /// Iterate over the nodes with impulses on a field: sums over its pairs.
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

    /// Update the field indices of the pairs, in the same order; mark the contacts as stale if a body has left.
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

    /// Discard the contacts of pairs whose bodies have moved by `keeps`, m; `way` is the motion of each body so far, m.
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

/// Contact memory of a block at the start and at the end of a step: a record per touch, in their order; empty if no law has
/// state variables.
#[derive(Clone, Debug, Default)]
pub struct TouchMemory {
    pub(super) width: usize,
    pub(super) start: Vec<f64>,
    pub(super) end: Vec<f64>,
}

impl TouchMemory {
    /// Allocate records for this number of `touches`, of laws with up to `numbers` state variables.
    pub(super) fn clear(&mut self, touches: usize, numbers: usize) {
        self.width = if numbers == 0 { 0 } else { OFFSET + numbers };
        self.start.clear();
        self.start.resize(touches * self.width, 0.0);
        self.end.clear();
    }
    /// Return the record of a touch, to be restored.
    pub(super) fn record_mut(&mut self, touch: usize) -> &mut [f64] {
        &mut self.start[touch * self.width..][..self.width]
    }
    /// Copy the restored memory to the end of the step: contacts without an impulse keep it unchanged.
    pub(super) fn recalled(&mut self) {
        self.end.clone_from(&self.start);
    }
    /// Return the state variables of a touch at the start of the step, by its index in [`BlockContacts::touches`]; empty if
    /// no law has any.
    pub fn start(&self, touch: usize) -> &[f64] {
        self.start.get(self.numbers(touch)).unwrap_or_default()
    }
    /// Return the state variables of a touch at the start and, mutable, at the end of the step.
    pub fn start_and_end(&mut self, touch: usize) -> (&[f64], &mut [f64]) {
        let numbers = self.numbers(touch);
        (self.start.get(numbers.clone()).unwrap_or_default(), self.end.get_mut(numbers).unwrap_or_default())
    }
    /// Move the record of a touch by the displacement `way`, m.
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

/// Velocities that contact acts on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ContactPhase {
    /// Velocities of the mapped momentum, before the stress update of USF.
    Momentum,
    /// Trial velocities of the momentum update: every body moved by its own forces.
    Trial,
    /// Velocities mapped a second time (MUSL).
    Remapped,
}

/// Scratch memory of a thread for contact algorithms, not kept.
#[derive(Clone, Debug)]
pub struct Scratch<T> {
    /// Nodal values.
    pub numbers: Vec<[T; 4]>,
    /// Sets of nodes, one bit each.
    pub bits: Vec<u64>,
    /// Vectors of pairs, three each.
    pub vectors: Vec<[[T; 3]; 3]>,
    /// Particles near nodes.
    pub points: FieldPoints,
}

impl<T> Default for Scratch<T> {
    fn default() -> Self {
        Scratch { numbers: Vec::new(), bits: Vec::new(), vectors: Vec::new(), points: FieldPoints::default() }
    }
}

impl<T> Scratch<T> {
    /// Allocated memory, bytes.
    pub(in crate::step) fn bytes(&self) -> usize {
        self.numbers.capacity() * size_of::<[T; 4]>()
            + self.bits.capacity() * size_of::<u64>()
            + self.vectors.capacity() * size_of::<[[T; 3]; 3]>()
            + self.points.bytes()
    }
}

/// Number of values of a record before the state variables: offset from its node, m.
pub(in crate::step) const OFFSET: usize = 3;
