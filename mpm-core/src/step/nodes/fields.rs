//! Node blocks and their bodies: the local multi-mesh of \[Ma2010\] 1.5.
//!
//! A node block that the particles of one body reach belongs to that body. If several bodies reach the same block, and the
//! scene's [`ContactAlgorithm`](crate::ContactAlgorithm) separates them, each has its own **field block**: the first body
//! uses the grid's block, the others use blocks appended to those of the grid. Particles access their body's block as if
//! there were no other; only contact stages use several. A field block stores only the nodes that the body's particles
//! reach, if they are few ([`Layout`]). Bodies that move as one share the fields of one of them (`Fields::join`).

use std::sync::Arc;

use super::block_place::BlockPlace;
use super::layout::{Claim, Layout, whole_block};
use crate::dim::block_nodes;
use crate::grid::levels::unpack_block;
use crate::grid::{GridStorage, Lattices, Levels, OutsideGrid};
use crate::step::bodies::body::GridBody;
use crate::step::rigid::motion::RigidState;
use impactite_geometry::Lattice;
use impactite_simd::{Float, Team};

/// Field of a shared block: its body and its node block.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Member {
    /// Index of the body.
    pub body: u32,
    /// Index of its field block.
    pub block: u32,
    /// True if the body's motion is prescribed.
    pub prescribed: bool,
}

/// Contributor to a node block: a body, and the index of the block in the body's own list.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::step) struct Giver {
    pub(in crate::step) body: u32,
    pub(in crate::step) local: u32,
}

/// Node block that several bodies reach.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(in crate::step) struct SharedBlock<const D: usize> {
    pub(in crate::step) coordinates: [i32; D],
    /// Range of its fields among the members.
    pub(in crate::step) fields: std::ops::Range<usize>,
}

/// Owner of blocks that belong to no single body.
pub(in crate::step) const NOBODY: u32 = u32::MAX;

/// Node blocks of a scene, field blocks included.
#[derive(Clone, Debug)]
pub struct Fields<const D: usize> {
    /// Lattices of the nodes.
    lattices: Lattices<D>,
    /// Levels of cells, if there are several.
    levels: Option<Arc<Levels<D>>>,
    /// Coordinates of each block; the grid's own first.
    coordinates: Vec<[i32; D]>,
    /// Body of each block, or [`NOBODY`].
    owners: Vec<u32>,
    /// Nodes that each block stores, one bit each (`kept`), and their layout.
    kept: Vec<u64>,
    layout: Layout,
    /// Start of each block's contributors; one more than there are blocks.
    starts: Vec<u32>,
    givers: Vec<Giver>,
    shared: Vec<SharedBlock<D>>,
    members: Vec<Member>,
    /// Shared block and field index of each block.
    field_of: Vec<Option<(u32, u32)>>,
    /// Bodies without fields of their own, and the bodies whose fields they share; sorted.
    joined: Vec<(u32, u32)>,
    /// Coordinates, body and index of each block, sorted; empty if bodies are not separated.
    table: Vec<([i32; D], u32, u32)>,
    // Buffers for the arrangement of fields.
    pub(in crate::step) claims: Vec<Claim<D>>,
    wanted: Vec<[i32; D]>,
    places: Vec<u32>,
    found: Vec<(u32, Giver)>,
}

impl<const D: usize> Fields<D> {
    /// Create an empty list of the blocks of a lattice.
    pub(in crate::step) fn new(lattice: Lattice<D>) -> Self {
        Fields {
            lattices: Lattices::one(lattice),
            levels: None,
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

    /// Use several levels of cells.
    pub(in crate::step) fn set_levels(&mut self, levels: Arc<Levels<D>>) {
        self.lattices = levels.lattices();
        self.levels = Some(levels);
    }
    /// Lattices of the nodes.
    pub(in crate::step) fn lattices(&self) -> Lattices<D> {
        self.lattices
    }
    /// Levels of cells, if there are several.
    pub(in crate::step) fn levels(&self) -> Option<&Arc<Levels<D>>> {
        self.levels.as_ref()
    }
    /// Return the positions of the nodes of a block.
    pub(in crate::step) fn place(&self, block: usize) -> BlockPlace<D> {
        BlockPlace::new(&self.lattices, &self.coordinates[block])
    }

    /// Claim the nodes of coarser levels on which those of the claimed blocks depend.
    fn claim_parents(&self, claims: &mut Vec<Claim<D>>) {
        let Some(levels) = &self.levels else { return };
        let mut n = 0;
        while n < claims.len() {
            let Claim { coordinates, body, .. } = claims[n];
            let (level, block) = unpack_block(&coordinates);
            if let Some(border) = levels.border_at(level, &block) {
                let parents = border.blocks.iter();
                claims.extend(parents.map(|&(coordinates, reached)| Claim { coordinates, body, reached }));
            }
            n += 1;
        }
    }

    /// Assign the fields of the body `with`, which has its own, to another body.
    pub(in crate::step) fn join(&mut self, body: u32, with: u32) {
        self.joined.retain(|known| known.0 != body);
        self.joined.push((body, with));
        self.joined.sort_unstable();
    }

    /// Restore a body's own fields.
    pub(in crate::step) fn part(&mut self, body: u32) {
        self.joined.retain(|known| known.0 != body);
    }

    /// Return the body whose fields a body uses.
    pub(in crate::step) fn owner_of(&self, body: u32) -> u32 {
        self.joined.binary_search_by_key(&body, |known| known.0).map_or(body, |at| self.joined[at].1)
    }

    /// Arrange the node blocks that the particles reach, separated by body if `separate`, and link the bodies to them; with
    /// `ahead`, include those reached from adjacent cells. A deactivated body has no blocks, and is reactivated if another
    /// requests one that it would have.
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
        // Reactivated bodies also request blocks, and may reactivate others.
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
        self.claim_parents(&mut claims);
        claims.sort_unstable_by_key(|c| (c.coordinates, c.body));
        claims.dedup_by(|next, kept| {
            let same = (next.coordinates, next.body) == (kept.coordinates, kept.body);
            kept.reached |= if same { next.reached } else { 0 };
            same
        });
        self.claims = claims;
        self.settle(grid, bodies, separate)
    }

    /// Arrange the requested node blocks.
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

    /// Assign a block to every request.
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

    /// Assign the blocks at one place: the grid's block to the first body, further blocks to the others. A body whose
    /// particles do not reach it yet has no field if another requests it.
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
        // Sort by block, then by body.
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
    /// Storage layout of the nodes.
    pub(in crate::step) fn layout(&self) -> &Layout {
        &self.layout
    }
    /// Coordinates of the node blocks.
    pub(in crate::step) fn coordinates(&self) -> &[[i32; D]] {
        &self.coordinates
    }
    /// Body of a block, or [`NOBODY`].
    pub(in crate::step) fn owner(&self, block: usize) -> u32 {
        self.owners[block]
    }
    /// Contributors to a block, in the order of bodies.
    pub(in crate::step) fn givers(&self, block: usize) -> &[Giver] {
        &self.givers[self.starts[block] as usize..self.starts[block + 1] as usize]
    }
    /// Blocks that several bodies reach, sorted by coordinates.
    pub(in crate::step) fn shared(&self) -> &[SharedBlock<D>] {
        &self.shared
    }
    /// Fields of a shared block, in the order of bodies.
    pub(in crate::step) fn members(&self, shared: usize) -> &[Member] {
        &self.members[self.shared[shared].fields.clone()]
    }
    /// Shared block and field index of a block.
    pub(in crate::step) fn field_of(&self, block: usize) -> Option<(usize, usize)> {
        self.field_of[block].map(|(s, f)| (s as usize, f as usize))
    }
    /// Return the block of a body's nodes at `at` (of the common field if bodies are not separated).
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
    /// Contributors to the field of a body at `at`, if bodies are separated.
    pub(in crate::step) fn givers_at(&self, at: &[i32; D], body: u32) -> &[Giver] {
        find_in(&self.table, at, body).map_or(&[], |block| self.givers(block))
    }
    /// Return true if a field is no longer reached by any particle of its body.
    pub(in crate::step) fn outdated<T: Float>(&self, bodies: &[Box<dyn GridBody<T, D>>]) -> bool {
        let reaches = |g: &Giver| bodies[g.body as usize].presence().reaches(g.local as usize);
        self.members.iter().any(|member| !self.givers(member.block as usize).iter().any(reaches))
    }
    /// Allocated memory, bytes.
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

/// Number of bodies in a 3D block from which fields store only the nodes that are reached; a 2D block has few nodes. With
/// two bodies in contact, particles often reach further nodes, and every such change requires an arrangement of all blocks.
const CROWD: usize = 3;

/// Return the nodes that a field stores for these reached nodes: all, if most are reached.
fn worth_keeping<const D: usize>(reached: u64) -> u64 {
    let most = 4 * reached.count_ones() as usize > 3 * block_nodes(D);
    if most { whole_block(D) } else { reached }
}

fn find_in<const D: usize>(table: &[([i32; D], u32, u32)], at: &[i32; D], body: u32) -> Option<usize> {
    let place = table.binary_search_by(|entry| (entry.0, entry.1).cmp(&(*at, body))).ok()?;
    Some(table[place].2 as usize)
}
