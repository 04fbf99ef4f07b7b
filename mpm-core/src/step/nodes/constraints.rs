//! Boundary conditions of the nodes of a block.

use super::block_place::BlockPlace;
use super::fields::Fields;
use super::layout::{Layout, NodeSums, Piece, numbers};
use super::node_sets::NodeSets;
use super::node_update::{Around, NodeUpdate, Trial};
use super::planes::Planes;
use crate::grid::Node;
use crate::step::bodies::body::GridBody;
use crate::step::rigid::nodes::{self, rigid_of};
use impactite_geometry::Lattice;
use impactite_scene::Boundaries;
use impactite_scene::boundary::{BodyForce, Boundary};
use impactite_scene::{Condition, Exchange, LocalDamping, Place};
use impactite_simd::Float;

/// Records of a node block, other than its nodes.
#[derive(Clone, Copy, Debug, Default)]
pub struct BlockBooks {
    /// Exchange of its stages in a step.
    pub ledger: Exchange,
    /// Nodes that reacting conditions constrain in this step, by direction.
    pub held: NodeSets,
}

/// Conditions on the nodes of a scene.
#[derive(Clone, Default)]
pub struct Conditions<const D: usize> {
    /// Boundaries, applied in this order.
    pub boundaries: Boundaries<D>,
    /// Acceleration of all material, m/s^2.
    pub gravity: Option<BodyForce<D>>,
    /// Local damping.
    pub damping: LocalDamping,
}

/// Move a share of the exchange of a node to a sum, and reset it; `accounts` is true if conditions have accounts.
fn move_share(sum: &mut Exchange, share: f64, o: &mut Exchange, accounts: bool) {
    for d in 0..3 {
        sum.impulse[d] += share * std::mem::take(&mut o.impulse[d]);
        sum.load[d] += share * std::mem::take(&mut o.load[d]);
        sum.dropped[d] += share * std::mem::take(&mut o.dropped[d]);
    }
    sum.work += share * std::mem::take(&mut o.work);
    sum.friction += share * std::mem::take(&mut o.friction);
    sum.damping += share * std::mem::take(&mut o.damping);
    if accounts {
        sum.add_accounts(share, o);
        o.accounts = Default::default();
    }
}

/// Set the nodes of a rigid body's block to the rigid velocity. Returns true if they are final.
pub(super) fn carry<T: Float, const D: usize>(
    bodies: &[Box<dyn GridBody<T, D>>],
    fields: &Fields<D>,
    constraints: &Constraints<'_, T, D>,
    block: usize,
    sums: NodeSums,
    nodes: &mut Piece<'_, Node<T>>,
) -> bool {
    let Some(body) = rigid_of(bodies, fields, block) else { return false };
    let place = constraints.fields.place(block);
    nodes::carry(body, sums, &place, nodes)
}

/// Boundary conditions of node blocks.
pub(super) struct Constraints<'a, T: Float, const D: usize> {
    pub(super) boundaries: &'a Boundaries<D>,
    /// Planes next to which nodes include their images; their exchange is recorded by the share of their own mass.
    pub(super) planes: &'a Planes<T>,
    pub(super) layout: &'a Layout,
    pub(super) bodies: &'a [Box<dyn GridBody<T, D>>],
    pub(super) fields: &'a Fields<D>,
    pub(super) lattice: Lattice<D>,
    /// Time at the start of the step, s.
    pub(super) time: f64,
    /// Largest distance of copies behind a symmetry plane, m.
    pub(super) copies: f64,
}

impl<T: Float, const D: usize> Constraints<'_, T, D> {
    /// Apply `update` to the nodes of a block.
    pub(super) fn apply<U: NodeUpdate<T>>(
        &self,
        update: &U,
        block: usize,
        nodes: &mut Piece<'_, Node<T>>,
        books: &mut BlockBooks,
    ) {
        let BlockBooks { ledger, held } = books;
        let place = self.fields.place(block);
        let body = self.bodies.get(self.fields.owner(block) as usize);
        let rigid = body.is_some_and(|b| b.rigid().is_some());
        // Wall contact acts on single particles; material without stress on these nodes is stopped by the wall's impulse on
        // them.
        let apart = body.is_none_or(|b| b.meets_surfaces().is_some());
        let near = NearBoundaries::new(self, &place, apart, rigid);
        if !near.reached {
            if U::HOLDS {
                *held = NodeSets::default();
            }
            update.update_free_from(self.layout.start(block), nodes.items, ledger);
            return;
        }
        let held_before = *held;
        if U::HOLDS {
            *held = NodeSets::default();
        }
        let mirrors = self.planes.copied();
        let start = self.layout.start(block);
        let mut own = self.planes.own_masses(start, nodes.items.len());
        let across = if rigid { [false; 3] } else { self.planes.mirrored_axes() };
        let bound = near.nodes | place.copies(mirrors);
        // Nodes of no condition are updated in groups, in the order of all nodes.
        let (mut free, items) = (0, nodes.items.len());
        let [mut of_node, mut of_copies] = [Exchange::default(); 2];
        for (i, n) in numbers(nodes.kept()).enumerate() {
            let share = own.next_share(i, &nodes.items[i]);
            if bound >> n & 1 == 0 && share.is_none() {
                continue;
            }
            if free < i {
                update.update_free_from(start + free, &mut nodes.items[free..i], ledger);
            }
            free = i + 1;
            let node = &mut nodes.items[i];
            let copy = share.is_none() && place.is_copy(n, mirrors);
            let held_now = std::array::from_fn(|d| held_before.has(d, n));
            let mut around = AtNode {
                of: self,
                near: &near,
                x: place.node(n),
                at: start + i,
                weighed: if share.is_some() { across } else { [false; 3] },
                image: if near.reacting { place.image(n, mirrors) } else { [false; 3] },
                held: if U::HOLDS { [false; 3] } else { held_now },
            };
            if let Some(share) = share {
                update.update(node, &mut around, &mut of_node);
                move_share(ledger, share, &mut of_node, near.accounts);
            } else if copy {
                update.update(node, &mut around, &mut of_copies);
            } else {
                update.update(node, &mut around, ledger);
            }
            if U::HOLDS {
                (0..D).filter(|d| around.held[*d]).for_each(|d| held.set(d, n, true));
            }
        }
        if free < items {
            update.update_free_from(start + free, &mut nodes.items[free..], ledger);
        }
    }
}

/// Boundaries near a block of nodes, and the nodes on which they may act.
struct NearBoundaries<'a, const D: usize> {
    boundaries: &'a Boundaries<D>,
    /// Boundaries that act on these nodes, one bit each; those from [`NearBoundaries::LISTED`] on are tested each time.
    listed: u64,
    low: [f64; D],
    high: [f64; D],
    time: f64,
    reach: f64,
    /// True if wall contact acts on particles, and not on these nodes.
    apart: bool,
    /// True for nodes of a rigid body, which planes stop as a whole.
    rigid: bool,
    /// True if any boundary reaches the block.
    reached: bool,
    /// True if any condition reacts in this block.
    reacting: bool,
    /// True if any condition has an account.
    accounts: bool,
    /// Nodes within reach of a boundary, one bit each.
    nodes: u64,
}

impl<'a, const D: usize> NearBoundaries<'a, D> {
    /// Number of boundaries with a bit.
    const LISTED: usize = 64;

    fn new<T: Float>(of: &Constraints<'a, T, D>, place: &BlockPlace<D>, apart: bool, rigid: bool) -> Self {
        let spacing = of.lattice.spacing();
        let mut near = NearBoundaries {
            boundaries: of.boundaries,
            listed: 0,
            low: place.low,
            high: place.high,
            time: of.time,
            reach: 2.0 * spacing,
            apart,
            rigid,
            reached: false,
            reacting: false,
            accounts: of.boundaries.has_accounts(),
            nodes: 0,
        };
        for (n, b) in of.boundaries.iter().enumerate() {
            if !b.reaches(&place.low, &place.high, of.time, near.reach) {
                continue;
            }
            near.reached = true;
            if near.is_elsewhere(b) {
                continue;
            }
            near.reacting |= b.reacts();
            near.nodes |= place.within_reach(b, of.time, near.reach);
            if n < Self::LISTED {
                near.listed |= 1 << n;
            }
        }
        near
    }

    /// True for a boundary that acts on particles or bodies, and not on these nodes.
    fn is_elsewhere(&self, b: &Boundary<D>) -> bool {
        (self.apart && b.is_wall()) || (self.rigid && stops_rigid(b))
    }
    /// True if the boundary of this index acts here.
    fn acts(&self, n: usize, b: &Boundary<D>) -> bool {
        if n < Self::LISTED {
            return self.listed >> n & 1 != 0;
        }
        b.reaches(&self.low, &self.high, self.time, self.reach) && !self.is_elsewhere(b)
    }
    /// Iterate over the boundaries that act here, with their indices.
    fn iter(&self) -> impl Iterator<Item = (usize, &Boundary<D>)> {
        self.boundaries.iter().enumerate().filter(|(n, b)| self.acts(*n, b))
    }
}

/// Boundary conditions of a node.
struct AtNode<'a, T: Float, const D: usize> {
    of: &'a Constraints<'a, T, D>,
    near: &'a NearBoundaries<'a, D>,
    /// Position of the node, m.
    x: [f64; D],
    /// Index of the node among all.
    at: usize,
    /// Directions in which the forces of the node include its weight.
    weighed: [bool; 3],
    /// Axes along which the node is the mirror image of one in front of a symmetry plane.
    image: [bool; 3],
    /// Directions in which reacting conditions constrain the node.
    held: [bool; 3],
}

impl<T: Float, const D: usize> AtNode<'_, T, D> {
    /// Return the position of the node, or of its original if it is an image, and the signs of its vectors there.
    fn place(&self) -> ([f64; D], [f64; D]) {
        let (mut x, mut sign) = (self.x, [1.0; D]);
        for m in self.of.planes.copied().iter().filter(|m| self.image[m.axis]) {
            let (origin, h) = (self.of.lattice.origin()[m.axis], self.of.lattice.spacing());
            let plane = origin + f64::from(m.node) * h;
            if (x[m.axis] - plane) * f64::from(m.sign) < 0.0 {
                x[m.axis] = 2.0 * plane - x[m.axis];
                sign[m.axis] = -1.0;
            }
        }
        (x, sign)
    }
}

impl<T: Float, const D: usize> Around for AtNode<'_, T, D> {
    #[inline]
    fn constrain(&self, v: &mut [f64; 3], time: f64) -> bool {
        let before = *v;
        let tolerance = 1e-6 * self.of.lattice.spacing();
        for (_, b) in self.near.iter() {
            b.constrain(&self.x, v, time, tolerance, self.of.copies);
        }
        *v != before
    }

    #[inline]
    fn constrain_booked(&self, v: &mut [f64; 3], time: f64, mass: f64, ledger: &mut Exchange) -> bool {
        let before = *v;
        let tolerance = 1e-6 * self.of.lattice.spacing();
        if !self.near.accounts {
            return self.constrain(v, time);
        }
        let at = (time, tolerance, self.of.copies);
        self.of.boundaries.constrain(|n, b| self.near.acts(n, b), &self.x, v, at, mass, ledger);
        *v != before
    }

    fn react(&mut self, trial: &Trial, v: &mut [f64; 3], takes: f64, ledger: &mut Exchange) -> bool {
        if !self.near.reacting {
            return false;
        }
        let (position, sign) = self.place();
        let spacing = self.of.lattice.spacing();
        let (mut any, mut held) = (false, self.held);
        for (n, b) in self.near.iter().filter(|(_, b)| b.reacts()) {
            let (mut depth, mut tolerance) = (0.5 * spacing, 1e-6 * spacing);
            if b.surface().is_some() {
                let Some(share) = self.of.planes.depth(self.at, n) else { continue };
                (depth, tolerance) = (share, 1.5 * spacing);
            }
            let reaction = b.react(&Place {
                position,
                mass: trial.mass,
                depth,
                tolerance,
                start: trial.start.map(|start| std::array::from_fn(|d| sign[d] * start[d])),
                trial: std::array::from_fn(|d| sign[d] * v[d]),
                time: self.of.time,
                dt: trial.dt,
            });
            if reaction.is_none() {
                continue;
            }
            any = true;
            ledger.friction += if trial.only_held { 0.0 } else { reaction.heat };
            for d in (0..D).filter(|d| !trial.only_held || reaction.held[*d]) {
                let impulse = sign[d] * reaction.impulse[d];
                let work = takes * reaction.impulse[d] * reaction.velocity[d];
                ledger.impulse[d] += takes * impulse;
                ledger.work += work;
                if let Some(account) = self.of.boundaries.account(n) {
                    ledger.accounts[account].impulse[d] += takes * impulse;
                    ledger.accounts[account].work += work;
                }
                held[d] |= reaction.held[d];
                // Bitwise exact, so that a constrained position stays.
                v[d] = if reaction.held[d] {
                    sign[d] * reaction.velocity[d]
                } else {
                    v[d] + impulse / trial.mass
                };
            }
        }
        self.held = held;
        any
    }

    fn held(&self) -> [bool; 3] {
        self.held
    }

    fn weighed(&self) -> [bool; 3] {
        self.weighed
    }

    fn place(&self) -> usize {
        self.at
    }
}

/// Return true if the boundary stops free rigid bodies as a whole, at their surfaces ([`crate::step::rigid::planes`]), and
/// not their nodes.
pub(in crate::step) fn stops_rigid<const D: usize>(boundary: &Boundary<D>) -> bool {
    boundary.is_wall() || matches!(boundary, Boundary::Symmetry { .. } | Boundary::Fixed { .. })
}

/// Return the directions in which no boundary constrains the node, unilateral walls and reacting conditions aside.
pub(in crate::step) fn free_directions<const D: usize>(
    conditions: &Conditions<D>,
    x: &[f64; D],
    time: f64,
    spacing: f64,
    copies: f64,
) -> [bool; 3] {
    let mut free = [true; 3];
    // A boundary that changes neither of two opposite probes in a direction leaves it free.
    for probe in [1e30, -1e30] {
        let before = [probe; 3];
        let mut v = before;
        for b in conditions.boundaries.iter().filter(|b| !b.is_wall()) {
            b.constrain(x, &mut v, time, 1e-6 * spacing, copies);
        }
        for d in 0..3 {
            free[d] &= v[d] == before[d];
        }
    }
    free
}
