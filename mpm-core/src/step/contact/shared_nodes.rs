//! Shared nodes of bodies, as input of a contact algorithm.

use impactite_scene::boundary::Plane;
use mpm_contact::{NearPoint, Places, SurfaceQuantity};

use super::found::{BlockContacts, ContactPhase};
use super::memory::{ContactMemory, node_of};
use crate::dim::{BLOCK, block_nodes};
use crate::grid::Node;
use crate::step::bodies::body::GridBody;
use crate::step::nodes::block_place::BlockPlace;
use crate::step::nodes::fields::{Fields, Giver, Member};
use crate::step::nodes::layout::{LAYERS, numbers};
use crate::step::rigid::motion::RigidState;
use impactite_simd::Float;

/// Nodes of a block that several bodies share, as input of a [`super::ContactAlgorithm`].
pub struct SharedNodes<'a, T: Float, const D: usize> {
    pub(super) nodes: &'a [Node<T>],
    pub(super) members: &'a [Member],
    pub(super) bodies: &'a [Box<dyn GridBody<T, D>>],
    pub(super) fields: &'a Fields<D>,
    pub(super) mirrors: &'a [Plane],
    pub(super) wide: bool,
    pub(super) place: BlockPlace<D>,
    pub(super) coordinates: [i32; D],
    pub(super) phase: ContactPhase,
    pub(super) spacing: f64,
    pub(super) rigid: bool,
    pub(super) cutoff: T,
    pub(super) dt: T,
    pub(super) time: f64,
    pub(super) memory: &'a ContactMemory,
}

/// Nodes of a block that are images of others, mirrored along some axes.
#[derive(Clone, Copy)]
struct Image<const D: usize> {
    /// Block of the originals.
    at: [i32; D],
    /// Image nodes, one bit each.
    nodes: u64,
    axes: [Option<Mirrored>; D],
}

/// Mirroring of nodes along an axis.
#[derive(Clone, Copy)]
struct Mirrored {
    /// Offset of the originals from their images, in node indices of a block.
    by: i32,
    /// Position of the plane, in nodes from the first one of the block.
    plane: i32,
}

impl<T: Float, const D: usize> SharedNodes<'_, T, D> {
    /// Number of fields.
    pub fn fields(&self) -> usize {
        self.members.len()
    }
    /// Index of the body of a field; fields are in the order of bodies.
    pub fn body(&self, field: usize) -> usize {
        self.members[field].body as usize
    }
    /// Number of nodes in the block.
    pub fn nodes(&self) -> usize {
        block_nodes(D)
    }
    /// Nodes at which the field has mass, one bit each.
    pub fn occupied(&self, field: usize) -> u64 {
        let block = self.members[field].block as usize;
        let layout = self.fields.layout();
        let mut bits = 0;
        for (n, node) in numbers(layout.kept(block)).zip(layout.of(self.nodes, block)) {
            bits |= u64::from(node.first[0] > self.cutoff) << n;
        }
        bits
    }
    /// Return true if any body of the scene is rigid.
    pub fn has_rigid(&self) -> bool {
        self.rigid
    }
    /// Position and motion of the field's body, if it is rigid.
    pub fn rigid(&self, field: usize) -> Option<&RigidState<D>> {
        self.bodies[self.body(field)].rigid()
    }
    /// Return true if the motion of the field's body is prescribed. Two such bodies exchange no impulse.
    pub fn is_prescribed(&self, field: usize) -> bool {
        self.members[field].prescribed
    }
    /// Mass of a field at a node, kg: infinite if the body's motion is prescribed; for a free rigid body, the share of its
    /// mass at the node.
    pub fn mass(&self, field: usize, node: usize) -> T {
        if self.is_prescribed(field) { T::of(f64::INFINITY) } else { self.of(field, node).first[0] }
    }
    /// Velocity of a field at a node, m/s.
    pub fn velocity(&self, field: usize, node: usize) -> [T; 3] {
        let node = self.of(field, node);
        let [_, x, y, z] = if self.phase == ContactPhase::Remapped { node.second } else { node.first };
        [x, y, z]
    }
    /// Velocity of a field at a node at the start of the step, m/s, before forces and contact. If momentum and impulse are
    /// mapped together, it is unknown, and the trial velocity is returned.
    pub fn old_velocity(&self, field: usize, node: usize) -> [T; 3] {
        let mut v = self.velocity(field, node);
        if self.phase == ContactPhase::Trial {
            let a = self.of(field, node).second;
            for d in 0..D {
                v[d] -= a[d + 1] * self.dt;
            }
        }
        v
    }
    /// Position of a node, m.
    pub fn position(&self, node: usize) -> [f64; D] {
        self.place.node(node)
    }
    /// Node spacing, m.
    pub fn spacing(&self) -> f64 {
        self.spacing
    }
    /// Time step, s.
    pub fn dt(&self) -> T {
        self.dt
    }
    /// Time at the start of the step, s.
    pub fn time(&self) -> f64 {
        self.time
    }
    /// Velocities that contact acts on.
    pub fn phase(&self) -> ContactPhase {
        self.phase
    }
    /// Return true if the node is the image of another behind a symmetry plane.
    pub fn is_image(&self, node: usize) -> bool {
        self.wide && self.place.is_copy(node, self.mirrors)
    }

    /// Load the state variables of this block's touches into [`BlockContacts::memory`], up to `numbers` each, for pairs
    /// with state variables ([`Pair::remembers`](super::Pair::remembers)).
    pub fn recall(&self, found: &mut BlockContacts<T>, numbers: usize) {
        let BlockContacts { pairs, touches, memory, block, .. } = found;
        memory.clear(touches.len(), numbers);
        for (n, touch) in touches.iter().enumerate() {
            let pair = &pairs[touch.pair as usize];
            if pair.remembers {
                let node = node_of(*block, touch.node as usize);
                self.memory.recall(pair.bodies, node, D, memory.record_mut(n));
            }
        }
        memory.recalled();
    }

    /// Compute a surface quantity of a field's particles at some nodes, one bit each; see
    /// [`Presence::surface_quantity`](crate::step::bodies::body::Presence::surface_quantity). Mirror images beyond symmetry
    /// planes are included.
    pub fn surface_quantity(
        &self,
        field: usize,
        what: SurfaceQuantity,
        nodes: u64,
        normals: &[[T; 3]],
        out: &mut [[T; 3]],
    ) {
        let member = self.members[field];
        for giver in self.fields.givers(member.block as usize) {
            let presence = self.bodies[giver.body as usize].presence();
            presence.surface_quantity(giver.local as usize, what, nodes, normals, out);
        }
        for mirror in self.mirrors {
            self.mirror(mirror, member, what, nodes, normals, out);
        }
    }

    /// Call `visit` for every particle of a field near some nodes, one bit each, with those of them that are in its
    /// stencil. Mirror images beyond symmetry planes are included.
    pub fn near_points(&self, field: usize, nodes: u64, visit: &mut dyn FnMut(u64, &NearPoint<T>)) {
        let member = self.members[field];
        for giver in self.fields.givers(member.block as usize) {
            self.bodies[giver.body as usize].presence().near_points(giver.local as usize, nodes, visit);
        }
        let none = Image { at: self.coordinates, nodes, axes: [None; D] };
        self.near_images(member, self.mirrors, &none, visit);
    }

    /// Visit the mirror images of particles near some nodes in one or several of `mirrors`, in addition to those of
    /// `so_far`.
    fn near_images(
        &self,
        member: Member,
        mirrors: &[Plane],
        so_far: &Image<D>,
        visit: &mut dyn FnMut(u64, &NearPoint<T>),
    ) {
        let block = BLOCK as i32;
        for (next, mirror) in mirrors.iter().enumerate() {
            let axis = mirror.axis;
            if so_far.axes[axis].is_some() {
                continue;
            }
            let stride = BLOCK.pow(axis as u32);
            for layer in if self.wide { -1..=1 } else { 0..=0 } {
                let index = mirror.node + layer;
                if index.div_euclid(block) != self.coordinates[axis] {
                    continue;
                }
                let within = index.rem_euclid(block) as usize;
                let mine = (LAYERS[axis] << (within * stride)) & so_far.nodes;
                if mine == 0 {
                    continue;
                }
                let image = mirror.node - layer;
                let mut here = *so_far;
                here.nodes = mine;
                here.at[axis] = image.div_euclid(block);
                let by = (image.rem_euclid(block) - within as i32) * stride as i32;
                here.axes[axis] = Some(Mirrored { by, plane: mirror.node - self.coordinates[axis] * block });
                for &giver in self.fields.givers_at(&here.at, member.body) {
                    self.near_mirrored(giver, &here, visit);
                }
                self.near_images(member, &mirrors[next + 1..], &here, visit);
            }
        }
    }

    /// Visit the mirror images of the particles near the originals of some nodes.
    fn near_mirrored(&self, giver: Giver, image: &Image<D>, visit: &mut dyn FnMut(u64, &NearPoint<T>)) {
        let by: i32 = image.axes.iter().flatten().map(|m| m.by).sum();
        let moved = |set: u64, by: i32| if by < 0 { set >> -by } else { set << by };
        let body = &self.bodies[giver.body as usize];
        body.presence().near_points(giver.local as usize, moved(image.nodes, by), &mut |nodes, near| {
            let mut seen = *near;
            for d in 0..D {
                let blocks = f64::from((image.at[d] - self.coordinates[d]) * BLOCK as i32);
                let here = near.offset[d] + T::of(blocks * self.spacing);
                seen.offset[d] = match image.axes[d] {
                    None => here,
                    Some(m) => T::of(2.0 * f64::from(m.plane) * self.spacing) - here,
                };
            }
            visit(moved(nodes, -by), &seen);
        });
    }

    /// Return a node of a field; empty if the body has none.
    fn of(&self, field: usize, node: usize) -> Node<T> {
        let place = self.fields.layout().place(self.members[field].block as usize, node);
        place.map_or_else(Node::default, |place| self.nodes[place])
    }

    /// Add the surface quantity of the body's mirror image.
    fn mirror(
        &self,
        mirror: &Plane,
        member: Member,
        what: SurfaceQuantity,
        nodes: u64,
        normals: &[[T; 3]],
        out: &mut [[T; 3]],
    ) {
        let (axis, block) = (mirror.axis, BLOCK as i32);
        let stride = BLOCK.pow(axis as u32);
        let vector = matches!(what, SurfaceQuantity::MassGradient | SurfaceQuantity::VolumeGradient);
        let largest = matches!(
            what,
            SurfaceQuantity::Reach | SurfaceQuantity::LocalReach | SurfaceQuantity::CentreReach
        );
        for layer in -1..=1 {
            let index = mirror.node + layer;
            if index.div_euclid(block) != self.coordinates[axis] {
                continue;
            }
            let within = index.rem_euclid(block) as usize;
            let mine = (0..block_nodes(D)).filter(|n| n / stride % BLOCK == within && nodes & (1 << n) != 0);
            if layer == 0 {
                // Contributions of both halves of the body are equal along the plane and cancel across it.
                if vector {
                    mine.for_each(|n| out[n][axis] = T::default());
                }
                continue;
            }
            if !self.wide {
                continue;
            }
            let image = mirror.node - layer;
            let mut at = self.coordinates;
            at[axis] = image.div_euclid(block);
            let givers = self.fields.givers_at(&at, member.body);
            if givers.is_empty() {
                continue;
            }
            let there = |n: usize| n - within * stride + image.rem_euclid(block) as usize * stride;
            let mut bits = 0;
            let mut turned = [[T::default(); 3]; 64];
            let mut found = [[T::default(); 3]; 64];
            for n in mine.clone() {
                bits |= 1 << there(n);
                if let Some(normal) = normals.get(n) {
                    turned[there(n)] = *normal;
                    turned[there(n)][axis] = -normal[axis];
                }
                found[there(n)][0] = if largest { out[n][0] } else { T::default() };
            }
            for giver in givers {
                let presence = self.bodies[giver.body as usize].presence();
                presence.surface_quantity(giver.local as usize, what, bits, &turned, &mut found);
            }
            for n in mine {
                let mut image = found[there(n)];
                if largest {
                    out[n][0] = image[0];
                    continue;
                }
                if vector {
                    image[axis] = -image[axis];
                }
                for d in 0..3 {
                    out[n][d] += image[d];
                }
            }
        }
    }
}

impl<T: Float, const D: usize> Places<T, D> for SharedNodes<'_, T, D> {
    fn body(&self, field: usize) -> usize {
        SharedNodes::body(self, field)
    }
    fn spacing(&self) -> f64 {
        SharedNodes::spacing(self)
    }
    fn position(&self, n: usize) -> [f64; D] {
        SharedNodes::position(self, n)
    }
    fn mass(&self, field: usize, n: usize) -> T {
        SharedNodes::mass(self, field, n)
    }
    fn velocity(&self, field: usize, n: usize) -> [T; 3] {
        SharedNodes::velocity(self, field, n)
    }
    fn surface_quantity(
        &self,
        field: usize,
        quantity: SurfaceQuantity,
        places: u64,
        normals: &[[T; 3]],
        out: &mut [[T; 3]],
    ) {
        SharedNodes::surface_quantity(self, field, quantity, places, normals, out);
    }
    fn near_points(&self, field: usize, places: u64, visit: &mut dyn FnMut(u64, &NearPoint<T>)) {
        SharedNodes::near_points(self, field, places, visit);
    }
}
