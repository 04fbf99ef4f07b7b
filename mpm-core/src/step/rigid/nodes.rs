//! Nodes of rigid bodies.

use super::motion::RigidState;
use crate::grid::Node;
use crate::step::bodies::body::GridBody;
use crate::step::nodes::block_place::BlockPlace;
use crate::step::nodes::fields::Fields;
use crate::step::nodes::layout::{NodeSums, Piece};
use impactite_scene::Exchange;
use impactite_simd::Float;

/// Return the rigid body that owns a block.
pub(in crate::step) fn rigid_of<'a, T: Float, const D: usize>(
    bodies: &'a [Box<dyn GridBody<T, D>>],
    fields: &Fields<D>,
    block: usize,
) -> Option<&'a RigidState<D>> {
    bodies.get(fields.owner(block) as usize)?.rigid()
}

/// Set the nodes of a rigid body, as they are mapped, to the rigid velocity. Returns true if the nodes are final: forces do
/// not act on a body with prescribed motion.
pub(in crate::step) fn carry<T: Float, const D: usize>(
    body: &RigidState<D>,
    sums: NodeSums,
    place: &BlockPlace<D>,
    nodes: &mut Piece<'_, Node<T>>,
) -> bool {
    let free = !body.is_prescribed();
    for (n, node) in nodes.numbered() {
        let x = place.node(n);
        let mass = node.first[0];
        let put = |record: &mut [T; 4], values: [f64; 3], by: T| {
            for d in 0..D {
                record[d + 1] = by * T::of(values[d]);
            }
        };
        match sums {
            NodeSums::All if free => put(&mut node.first, body.velocity_at(&x), mass),
            NodeSums::Again if free => put(&mut node.second, body.velocity_at(&x), mass),
            NodeSums::Again => put(&mut node.second, body.velocity_at(&x), T::of(1.0)),
            NodeSums::All | NodeSums::Force if !free => {
                put(&mut node.first, body.mean_velocity(&x), T::of(1.0));
                put(&mut node.second, body.acceleration(&x), T::of(1.0));
            }
            NodeSums::All | NodeSums::Force | NodeSums::Smoothed | NodeSums::Pushes => {}
        }
    }
    !free
}

/// Record the impulse of a body with prescribed motion on others at a node: the opposite of `impulse` on itself, N s.
pub(in crate::step) fn book<const D: usize>(
    body: &RigidState<D>,
    x: &[f64; D],
    impulse: &[f64; 3],
    ledger: &mut Exchange,
) {
    let velocity = body.mean_velocity(x);
    for d in 0..D {
        ledger.impulse[d] -= impulse[d];
        ledger.work -= impulse[d] * velocity[d];
    }
}
