//! Background grid of a scene, with all nodal data.

use std::cell::Cell;

use impactite_scene::Exchange;
use impactite_scene::boundary::Boundary;

use super::at_wall::AtWall;
use super::constraints::BlockBooks;
use super::fields::Fields;
use super::footprint::{Folds, NodeWeight};
use super::planes::Planes;
use super::stages::{GridStages, StageOf, mass_cutoff};
use crate::dim::block_of;
use crate::grid::{GridStorage, Node, OutsideGrid};
use crate::step::bodies::capability::MeetsSurfaces;
use crate::step::clients::near_particles::{NearNode, NearParticles};
use crate::step::contact::ContactState;
use crate::step::scene::Scene;
use impactite_geometry::Lattice;
use impactite_simd::{Float, Team};

/// Background grid, with the bodies of its nodes.
pub(in crate::step) struct Background<T: Float, const D: usize> {
    pub(in crate::step) storage: Box<dyn GridStorage<T, D>>,
    /// Node blocks of each body.
    pub(in crate::step) fields: Fields<D>,
    /// Contact state.
    pub(in crate::step) contact: ContactState<T>,
    /// Records of each node block.
    pub(in crate::step) books: Vec<BlockBooks>,
    /// Exchange of a step that belongs to no single node block.
    pub(in crate::step) scene_wide: Exchange,
    /// Nodes at symmetry planes, walls and fixed planes.
    pub(in crate::step) planes: Planes<T>,
    /// Terms of the FMPM series, one per node; empty for other transfers.
    pub(in crate::step) terms: Vec<[T; 3]>,
    /// Particles near a surface of another discretisation.
    pub(in crate::step) near: NearParticles<D>,
    /// Wall contact, in the order of the conditions.
    pub(in crate::step) walls: Vec<AtWall<D>>,
    /// Step of the last arrangement of blocks (`arranged`), true if it looked ahead (`ahead`).
    pub(in crate::step) arranged: u64,
    pub(in crate::step) ahead: bool,
}

/// Treatment of nodes at planes: stencil reach, and the shares of a traction on a plane of nodes for the nodes in front of,
/// on and behind it.
#[derive(Clone, Copy)]
pub(in crate::step) struct AtPlanes {
    /// True if stencils extend beyond a plane that particles touch; true if the basis ends at walls.
    pub(in crate::step) reach: [bool; 2],
    pub(in crate::step) shares: [f64; 3],
}

impl<T: Float, const D: usize> Background<T, D> {
    /// Create a grid without bodies.
    pub(in crate::step) fn new(storage: Box<dyn GridStorage<T, D>>) -> Self {
        Background {
            fields: Fields::new(*storage.lattice()),
            storage,
            contact: ContactState::default(),
            books: Vec::new(),
            scene_wide: Exchange::default(),
            planes: Planes::default(),
            terms: Vec::new(),
            near: NearParticles::default(),
            walls: Vec::new(),
            arranged: 0,
            ahead: false,
        }
    }

    pub(in crate::step) fn lattice(&self) -> &Lattice<D> {
        self.storage.lattice()
    }
    pub(in crate::step) fn nodes(&self) -> &[Node<T>] {
        self.storage.nodes()
    }
    pub(in crate::step) fn nodes_mut(&mut self) -> &mut [Node<T>] {
        self.storage.nodes_mut()
    }

    /// Return the grid for a stage of a step, and the contact state; the bodies remain readable.
    pub(in crate::step) fn stage<'a>(
        &'a mut self,
        scene: &'a Scene<T, D>,
        team: &'a Team,
        of: StageOf<T>,
    ) -> (GridStages<'a, T, D>, &'a mut ContactState<T>) {
        let Background { storage, fields, contact, books, scene_wide, planes, .. } = self;
        let lightest = scene.lightest();
        let stage = GridStages {
            grid: &mut **storage,
            bodies: &scene.bodies,
            fields,
            team,
            conditions: &scene.conditions,
            books,
            scene_wide,
            cutoff: lightest * mass_cutoff::<T>(),
            lightest,
            of,
            planes,
            rigid: !scene.rigid.is_empty(),
        };
        (stage, contact)
    }

    /// Arrange the node blocks that the particles reach after this number of `steps`, and link the bodies to them.
    pub(in crate::step) fn arrange(
        &mut self,
        scene: &mut Scene<T, D>,
        team: &Team,
        steps: u64,
        planes: AtPlanes,
    ) -> Result<(), OutsideGrid> {
        let separate = scene.contact.separates();
        self.fields.arrange(&mut *self.storage, &mut scene.bodies, separate, self.ahead, team)?;
        self.contact.arrange(&self.fields, scene.bodies.len());
        self.books.clear();
        self.books.resize_with(self.fields.len(), Default::default);
        self.arranged = steps;
        self.arrange_planes(&scene.conditions.boundaries, &scene.rigid, planes);
        Ok(())
    }

    /// Arrange the node blocks that were requested when a checkpoint was written.
    pub(in crate::step) fn settle(&mut self, scene: &mut Scene<T, D>) -> Result<(), OutsideGrid> {
        let separate = scene.contact.separates();
        self.fields.settle(&mut *self.storage, &mut scene.bodies, separate)?;
        self.contact.arrange(&self.fields, scene.bodies.len());
        self.books.clear();
        self.books.resize_with(self.fields.len(), Default::default);
        Ok(())
    }

    /// Find the nodes at planes.
    pub(in crate::step) fn arrange_planes(
        &mut self,
        boundaries: &[Boundary<D>],
        rigid: &[usize],
        at: AtPlanes,
    ) {
        self.planes.arrange(&*self.storage, (&self.fields, rigid), boundaries, at.reach, at.shares);
    }

    /// Return true if particles reach node blocks without a field of their body or, with `prune`, if a field is no longer
    /// reached.
    pub(in crate::step) fn fields_changed(&self, scene: &mut Scene<T, D>, prune: bool) -> bool {
        let layout = self.fields.layout();
        scene.contact.separates()
            && (prune && self.ahead
                || scene.bodies.iter_mut().any(|b| b.presence_mut().reaches_further(layout))
                || prune && self.fields.outdated(&scene.bodies))
    }

    /// Gather the particles of a body in boxes that a surface reaches, with the velocities of their nodes; nodes lighter
    /// than `cutoff` are excluded. `known` is true if nodal accelerations are known.
    pub(in crate::step) fn gather_near(
        &self,
        near: &mut NearParticles<D>,
        (body, particles): (u32, &dyn MeetsSurfaces<D>),
        (folds, cutoff, known, dt): (&Folds<D>, T, bool, T),
        reaches: &dyn Fn(&[f64; D], &[f64; D]) -> bool,
    ) {
        let node_at = self.near_node(body, (cutoff, known, dt));
        particles.visit_near(dt.to_double(), reaches, &mut |particle, weights| {
            let mut fold = |folded: &mut Vec<NodeWeight<D>>| folds.fold(weights, folded);
            near.add(body, particle, &mut fold, &node_at);
        });
    }

    /// Return a lookup of a body's nodes with mass by lattice index; `known` is true if their velocities at the start of
    /// the step of `dt`, s, are known.
    pub(in crate::step) fn near_node(
        &self,
        body: u32,
        (cutoff, known, dt): (T, bool, T),
    ) -> impl Fn(&[i32; D]) -> Option<NearNode<D>> + '_ {
        // Consecutive nodes are mostly in one block.
        let last = Cell::new(None);
        move |at: &[i32; D]| {
            let (block, within) = block_of(at);
            let lattices = self.fields.lattices();
            let found = match last.get() {
                Some((known, found)) if known == block => found,
                _ => self.fields.find(&*self.storage, &block, body),
            };
            last.set(Some((block, found)));
            let found = found?;
            let place = self.fields.layout().place(found, within)?;
            let node = self.nodes().get(place).filter(|node| node.first[0] > cutoff)?;
            Some(NearNode {
                place: place as u32,
                position: lattices.position(at),
                mass: node.first[0].to_double(),
                start: known.then(|| {
                    std::array::from_fn(|d| (node.first[d + 1] - dt * node.second[d + 1]).to_double())
                }),
                velocity: std::array::from_fn(|d| node.first[d + 1].to_double()),
                change: [0.0; D],
            })
        }
    }

    /// Allocated memory, bytes.
    pub(in crate::step) fn bytes(&self) -> usize {
        self.storage.bytes()
            + self.books.capacity() * size_of::<BlockBooks>()
            + self.terms.capacity() * size_of::<[T; 3]>()
            + self.planes.bytes()
            + self.fields.bytes()
            + self.contact.bytes()
            + self.near.bytes()
            + self.walls.iter().map(AtWall::bytes).sum::<usize>()
    }
}
