//! Which node blocks there are, and whose they are: the local multi-mesh of \[Ma2010\] 1.5.
//!
//! A block of nodes that the particles of one body reach belongs to that body. Where several bodies reach the
//! same block, and the scene's [`ContactAlgorithm`](crate::ContactAlgorithm) keeps them apart, each has a **field block** of its
//! own: the first body the grid's block, the others blocks behind the grid's. Particles read and write their
//! body's block as if they were alone; only the contact stages know that there are others. A field block holds the
//! nodes that the body's particles reach, if they are few ([`Layout`]). Bodies that move as one share the fields of one of them
//! (`Fields::join`).

use super::layout::{Claim, Layout, whole_block};
use crate::dim::block_nodes;
use crate::grid::{GridStorage, OutsideGrid};
use crate::step::bodies::body::GridBody;
use crate::step::rigid::motion::RigidState;
use impactite_simd::{Float, Team};

/// A field of a shared block: whose it is, and where.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Member {
    /// Number of the body.
    pub body: u32,
    /// Its field block, by place among the nodes.
    pub block: u32,
    /// Is the body's motion prescribed?
    pub prescribed: bool,
}

/// Who maps to a node block: a body and the block's place in the body's own list.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::step) struct Giver {
    pub(in crate::step) body: u32,
    pub(in crate::step) local: u32,
}

/// A node block that several bodies reach.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(in crate::step) struct SharedBlock<const D: usize> {
    pub(in crate::step) coordinates: [i32; D],
    /// Its fields, among the members.
    pub(in crate::step) fields: std::ops::Range<usize>,
}

/// Nobody in particular.
pub(in crate::step) const NOBODY: u32 = u32::MAX;

/// The node blocks of a scene, field blocks included.
#[derive(Clone, Debug)]
pub struct Fields<const D: usize> {
    /// Of each block; the grid's own first.
    coordinates: Vec<[i32; D]>,
    /// The body of each block, or [`NOBODY`].
    owners: Vec<u32>,
    /// The nodes that each block keeps, a bit each, and where.
    kept: Vec<u64>,
    layout: Layout,
    /// Where the givers of each block start; one more than there are blocks.
    starts: Vec<u32>,
    givers: Vec<Giver>,
    shared: Vec<SharedBlock<D>>,
    members: Vec<Member>,
    /// The shared block that a block is a field of, and as which field.
    field_of: Vec<Option<(u32, u32)>>,
    /// Of bodies that have no fields of their own, whose they share; sorted.
    joined: Vec<(u32, u32)>,
    /// Whose block is where, sorted; empty if bodies are not kept apart.
    table: Vec<([i32; D], u32, u32)>,
    // Used while they are arranged.
    pub(in crate::step) claims: Vec<Claim<D>>,
    wanted: Vec<[i32; D]>,
    places: Vec<u32>,
    found: Vec<(u32, Giver)>,
}

impl<const D: usize> Default for Fields<D> {
    fn default() -> Self {
        Fields {
            coordinates: Vec::new(),
            owners: Vec::new(),
            kept: Vec::new(),
            layout: Layout::default(),
            starts: Vec::new(),
            givers: Vec::new(),
            shared: Vec::new(),
            members: Vec::new(),
            field_of: Vec::new(),
            joined: Vec::new(),
            table: Vec::new(),
            claims: Vec::new(),
            wanted: Vec::new(),
            places: Vec::new(),
            found: Vec::new(),
        }
    }
}

impl<const D: usize> Fields<D> {
    /// Let a body share the fields of another one, which has its own.
    pub(in crate::step) fn join(&mut self, body: u32, with: u32) {
        self.joined.retain(|known| known.0 != body);
        self.joined.push((body, with));
        self.joined.sort_unstable();
    }

    /// Let a body have fields of its own again.
    pub(in crate::step) fn part(&mut self, body: u32) {
        self.joined.retain(|known| known.0 != body);
    }

    /// Whose fields a body has.
    pub(in crate::step) fn owner_of(&self, body: u32) -> u32 {
        self.joined.binary_search_by_key(&body, |known| known.0).map_or(body, |at| self.joined[at].1)
    }

    /// Have the node blocks that the particles reach, kept apart by body if `separate`, and tell the bodies
    /// where theirs are; to look `ahead`, those that they reach from a cell beside as well. A body that rests has none, and
    /// wakes where another claims what it would.
    pub(in crate::step) fn arrange<T: Float>(
        &mut self,
        grid: &mut dyn GridStorage<T, D>,
        bodies: &mut [Box<dyn GridBody<T, D>>],
        separate: bool,
        ahead: bool,
        team: &Team,
    ) -> Result<(), OutsideGrid> {
        let mut claims = std::mem::take(&mut self.claims);
        claims.clear();
        for (number, body) in bodies.iter_mut().enumerate() {
            body.presence_mut().claims(self.owner_of(number as u32), ahead, &mut claims);
        }
        // Those who wake claim, too, and may wake others.
        let mut known = 0;
        while known < claims.len() {
            let new = std::mem::replace(&mut known, claims.len())..claims.len();
            for (number, body) in bodies.iter_mut().enumerate() {
                let met = body.deactivated_blocks().is_some_and(|at| {
                    claims[new.clone()].iter().any(|claim| at.binary_search(&claim.coordinates).is_ok())
                });
                if met {
                    body.reactivate(team);
                    body.presence_mut().claims(self.owner_of(number as u32), ahead, &mut claims);
                }
            }
        }
        claims.sort_unstable_by_key(|c| (c.coordinates, c.body));
        claims.dedup_by(|next, kept| {
            let same = (next.coordinates, next.body) == (kept.coordinates, kept.body);
            kept.reached |= if same { next.reached } else { 0 };
            same
        });
        self.claims = claims;
        self.settle(grid, bodies, separate)
    }

    /// Have the node blocks that are claimed.
    pub(in crate::step) fn settle<T: Float>(
        &mut self,
        grid: &mut dyn GridStorage<T, D>,
        bodies: &mut [Box<dyn GridBody<T, D>>],
        separate: bool,
    ) -> Result<(), OutsideGrid> {
        let claims = std::mem::take(&mut self.claims);
        self.wanted.clear();
        self.wanted.extend(claims.iter().map(|c| c.coordinates));
        self.wanted.dedup();
        let arranged = grid.arrange(&self.wanted);
        if arranged.is_ok() {
            self.assign(grid, &claims, separate);
            self.link(grid, bodies, separate);
        }
        self.claims = claims;
        arranged
    }

    /// Give every claim a block.
    fn assign<T: Float>(&mut self, grid: &mut dyn GridStorage<T, D>, claims: &[Claim<D>], separate: bool) {
        self.coordinates.clear();
        self.coordinates.extend_from_slice(grid.blocks());
        self.owners.clear();
        self.owners.resize(self.coordinates.len(), NOBODY);
        self.kept.clear();
        self.kept.resize(self.coordinates.len(), whole_block(D));
        self.table.clear();
        self.shared.clear();
        self.members.clear();
        self.field_of.clear();
        if separate {
            for claims in claims.chunk_by(|a, b| a.coordinates == b.coordinates) {
                self.divide(grid.find(&claims[0].coordinates), claims);
            }
        }
        self.layout.arrange(D, self.kept.iter().copied());
        grid.arrange_nodes(self.layout.len());
        self.field_of.resize(self.coordinates.len(), None);
        for (s, shared) in self.shared.iter().enumerate() {
            for (f, member) in self.members[shared.fields.clone()].iter().enumerate() {
                self.field_of[member.block as usize] = Some((s as u32, f as u32));
            }
        }
    }

    /// One place: the grid's block to the first body, further blocks to the others. A body whose particles do
    /// not reach it yet has no part in it if another claims it.
    fn divide(&mut self, block: Option<usize>, claims: &[Claim<D>]) {
        let Some(block) = block else { return };
        let coordinates = claims[0].coordinates;
        let alone = claims.len() == 1;
        let first = self.members.len();
        let sharing = claims.iter().filter(|c| c.reached != 0).count();
        for claim in claims.iter().filter(|c| alone || c.reached != 0) {
            let kept =
                if D < 3 || sharing < CROWD { whole_block(D) } else { worth_keeping::<D>(claim.reached) };
            let block = if self.members.len() == first {
                (self.owners[block], self.kept[block]) = (claim.body, kept);
                block
            } else {
                self.coordinates.push(coordinates);
                self.owners.push(claim.body);
                self.kept.push(kept);
                self.coordinates.len() - 1
            };
            self.table.push((coordinates, claim.body, block as u32));
            self.members.push(Member { body: claim.body, block: block as u32, prescribed: false });
        }
        if self.members.len() - first < 2 {
            self.members.truncate(first);
        } else {
            self.shared.push(SharedBlock { coordinates, fields: first..self.members.len() });
        }
    }

    fn link<T: Float>(
        &mut self,
        grid: &dyn GridStorage<T, D>,
        bodies: &mut [Box<dyn GridBody<T, D>>],
        separate: bool,
    ) {
        let (mut places, mut found) = (std::mem::take(&mut self.places), std::mem::take(&mut self.found));
        found.clear();
        for (number, body) in bodies.iter_mut().enumerate() {
            let number = number as u32;
            places.clear();
            if separate {
                let (table, owner) = (&self.table, self.owner_of(number));
                body.presence_mut().link(&|c| find_in(table, c, owner), &mut places);
            } else {
                body.presence_mut().link(&|c| grid.find(c), &mut places);
            }
            let givers = places.iter().enumerate();
            found.extend(givers.map(|(l, &block)| (block, Giver { body: number, local: l as u32 })));
        }
        // By block, bodies in order in each.
        found.sort_unstable_by_key(|f| (f.0, f.1.body));
        self.starts.clear();
        self.givers.clear();
        for &(block, giver) in &found {
            while self.starts.len() <= block as usize {
                self.starts.push(self.givers.len() as u32);
            }
            self.givers.push(giver);
            if let Some((s, f)) = self.field_of[block as usize] {
                let fields = self.shared[s as usize].fields.clone();
                let member = &mut self.members[fields][f as usize];
                let rigid = bodies[member.body as usize].rigid();
                member.prescribed = rigid.is_some_and(RigidState::is_prescribed);
            }
        }
        self.starts.resize(self.coordinates.len() + 1, self.givers.len() as u32);
        (self.places, self.found) = (places, found);
    }

    /// Number of node blocks, field blocks included.
    pub(in crate::step) fn len(&self) -> usize {
        self.coordinates.len()
    }
    /// Where their nodes are.
    pub(in crate::step) fn layout(&self) -> &Layout {
        &self.layout
    }
    /// Coordinates of the node blocks.
    pub(in crate::step) fn coordinates(&self) -> &[[i32; D]] {
        &self.coordinates
    }
    /// The body of a block, or [`NOBODY`].
    pub(in crate::step) fn owner(&self, block: usize) -> u32 {
        self.owners[block]
    }
    /// Who maps to a block, bodies in order.
    pub(in crate::step) fn givers(&self, block: usize) -> &[Giver] {
        &self.givers[self.starts[block] as usize..self.starts[block + 1] as usize]
    }
    /// The blocks that several bodies reach, by coordinates.
    pub(in crate::step) fn shared(&self) -> &[SharedBlock<D>] {
        &self.shared
    }
    /// The fields of a shared block, bodies in order.
    pub(in crate::step) fn members(&self, shared: usize) -> &[Member] {
        &self.members[self.shared[shared].fields.clone()]
    }
    /// The shared block that a block is a field of, and as which field.
    pub(in crate::step) fn field_of(&self, block: usize) -> Option<(usize, usize)> {
        self.field_of[block].map(|(s, f)| (s as usize, f as usize))
    }
    /// Where the body's nodes of a place are (of the one common field if bodies are not kept apart).
    pub(in crate::step) fn find<T: Float>(
        &self,
        grid: &dyn GridStorage<T, D>,
        at: &[i32; D],
        body: u32,
    ) -> Option<usize> {
        if self.table.is_empty() {
            return grid.find(at);
        }
        if body == NOBODY {
            return grid.find(at).filter(|&block| self.owners[block] == NOBODY);
        }
        find_in(&self.table, at, body)
    }
    /// Who maps to the field of a body at `at`, where bodies are kept apart.
    pub(in crate::step) fn givers_at(&self, at: &[i32; D], body: u32) -> &[Giver] {
        find_in(&self.table, at, body).map_or(&[], |block| self.givers(block))
    }
    /// Is there a field that no particle of its body reaches any more?
    pub(in crate::step) fn outdated<T: Float>(&self, bodies: &[Box<dyn GridBody<T, D>>]) -> bool {
        let reaches = |g: &Giver| bodies[g.body as usize].presence().reaches(g.local as usize);
        self.members.iter().any(|member| !self.givers(member.block as usize).iter().any(reaches))
    }
    /// Bytes of its memory.
    pub(in crate::step) fn bytes(&self) -> usize {
        self.coordinates.capacity() * size_of::<[i32; D]>()
            + (self.owners.capacity() + self.starts.capacity()) * size_of::<u32>()
            + self.kept.capacity() * size_of::<u64>()
            + self.layout.bytes()
            + self.givers.capacity() * size_of::<Giver>()
            + self.shared.capacity() * size_of::<SharedBlock<D>>()
            + self.members.capacity() * size_of::<Member>()
            + self.field_of.capacity() * size_of::<Option<(u32, u32)>>()
            + self.table.capacity() * size_of::<([i32; D], u32, u32)>()
            + self.claims.capacity() * size_of::<Claim<D>>()
            + self.wanted.capacity() * size_of::<[i32; D]>()
            + (self.places.capacity() + 2 * self.joined.capacity()) * size_of::<u32>()
            + self.found.capacity() * size_of::<(u32, Giver)>()
    }
}

/// Bodies in a block of space from which on fields keep only the nodes that are reached; in the plane a block has few. Where
/// two bodies meet, particles reach further nodes all the time, and every such change means to arrange all blocks anew.
const CROWD: usize = 3;

/// The nodes that a field keeps whose particles reach these: all, if they are most.
fn worth_keeping<const D: usize>(reached: u64) -> u64 {
    let most = 4 * reached.count_ones() as usize > 3 * block_nodes(D);
    if most { whole_block(D) } else { reached }
}

fn find_in<const D: usize>(table: &[([i32; D], u32, u32)], at: &[i32; D], body: u32) -> Option<usize> {
    let place = table.binary_search_by(|entry| (entry.0, entry.1).cmp(&(*at, body))).ok()?;
    Some(table[place].2 as usize)
}
