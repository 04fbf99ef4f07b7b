//! Contact normals at the nodes that bodies share.

use impactite_simd::Float;

use crate::field_points::FieldPoints;
use crate::places::{Places, SurfaceQuantity, each_place};
use crate::vector::{difference, times, unit};

/// Scratch memory of detectors for one block: cleared for every block, kept allocated.
#[derive(Debug)]
pub struct Memory<'a, T> {
    /// Numbers of nodes.
    pub numbers: &'a mut Vec<[T; 4]>,
    /// Particles near the nodes.
    pub points: &'a mut FieldPoints,
    /// Selected nodes of each field (bit set); the field has mass at others, too.
    pub nodes: &'a [u64],
}

/// Nodal values of a block.
pub type Nodal<X> = [X; 64];

/// Nodes at which a [`NormalRule`] was asked for normals, one bit each.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct NormalNodes {
    /// Nodes with a normal.
    pub found: u64,
    /// Nodes whose normal was omitted, since the surfaces are too far apart.
    pub apart: u64,
}

/// Rule for the contact normal between two bodies at a node, from the positions of their particles. One normal serves both (the bodies' own
/// normals are not opposite, and momentum would drift).
pub trait NormalRule<T: Float, const D: usize>: std::fmt::Debug + Send + Sync + 'static {
    /// Prepare the fields once, before their pairs.
    fn prepare(&self, at: &dyn Places<T, D>, memory: &mut Memory<'_, T>);
    /// Compute unit normals from the first to the second field of `pair` at `nodes` (bit set). Returns the nodes that have one.
    fn normals(
        &self,
        at: &dyn Places<T, D>,
        pair: [usize; 2],
        nodes: u64,
        memory: &Memory<'_, T>,
        normals: &mut Nodal<[T; 3]>,
    ) -> u64;
    /// Compute the normals as [`NormalRule::normals`] does, with leave to omit those along which the surfaces of all particles near the node
    /// are more than `gap`, m, apart. By default none is omitted.
    fn normals_within(
        &self,
        at: &dyn Places<T, D>,
        pair: [usize; 2],
        nodes: u64,
        _gap: f64,
        memory: &Memory<'_, T>,
        normals: &mut Nodal<[T; 3]>,
    ) -> NormalNodes {
        NormalNodes { found: self.normals(at, pair, nodes, memory, normals), apart: 0 }
    }
}

/// Weighting of particles in the normal of a body.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Weight {
    /// Mass weighting: sum_p m_p grad N_ip (eq. 9 of \[Zhang2017\]).
    Mass,
    /// Volume weighting: sum_p V_p grad N_ip \[BardenhagenGuilkey2001\].
    Volume,
}

/// Combination of the normals of two bodies.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Choice {
    /// Collinear normal (n_r - n_s) / |n_r - n_s| of the unit normals \[Huang2011\]; n_r where they nearly cancel, as at a sheet inside the
    /// support of the node.
    Collinear,
    /// Direction of g_r - g_s: the body with more particles at the node has more weight.
    Difference,
    /// Normal of the body that is first in this list of numbers (the stiffer or the convex one); for pairs not in it, of the first body.
    OneBody(Vec<usize>),
}

/// Normals by the gradient of mass or volume at the node, which points out of a body.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Gradients {
    weight: Weight,
    choice: Choice,
}

impl Default for Gradients {
    /// Use mass weighting and collinear normals.
    fn default() -> Self {
        Gradients::new(Weight::Mass, Choice::Collinear)
    }
}

impl Gradients {
    /// Create with this weighting and combination.
    pub fn new(weight: Weight, choice: Choice) -> Self {
        Gradients { weight, choice }
    }

    fn combine<T: Float>(&self, bodies: [usize; 2], gradients: [[T; 3]; 2]) -> Option<[T; 3]> {
        let minus = T::of(-1.0);
        let [r, s] = gradients;
        match &self.choice {
            Choice::Difference => unit(difference(r, s)),
            Choice::Collinear => {
                let (r, s) = (unit(r)?, unit(s)?);
                let both = difference(r, s);
                // Below 0.1 the normals are within 6 degrees of each other.
                let nearly = crate::vector::length(both) < T::of(0.1);
                if nearly { Some(r) } else { unit(both) }
            }
            Choice::OneBody(order) => {
                let place = |body| order.iter().position(|&o| o == body).unwrap_or(usize::MAX);
                if place(bodies[1]) < place(bodies[0]) { unit(times(s, minus)) } else { unit(r) }
            }
        }
    }
}

/// Index of a node among those of a field.
fn rank(nodes: u64, node: usize) -> usize {
    (nodes & ((1 << node) - 1)).count_ones() as usize
}

impl<T: Float, const D: usize> NormalRule<T, D> for Gradients {
    fn prepare(&self, at: &dyn Places<T, D>, memory: &mut Memory<'_, T>) {
        let what = match self.weight {
            Weight::Mass => SurfaceQuantity::MassGradient,
            Weight::Volume => SurfaceQuantity::VolumeGradient,
        };
        let zero = T::of(0.0);
        let mut out: Nodal<[T; 3]> = [[zero; 3]; 64];
        for (field, &nodes) in memory.nodes.iter().enumerate() {
            if nodes == 0 {
                continue;
            }
            each_place(nodes).for_each(|n| out[n] = [zero; 3]);
            at.surface_quantity(field, what, nodes, &[], &mut out);
            memory.numbers.extend(each_place(nodes).map(|n| [out[n][0], out[n][1], out[n][2], zero]));
        }
    }

    fn normals(
        &self,
        at: &dyn Places<T, D>,
        pair: [usize; 2],
        nodes: u64,
        memory: &Memory<'_, T>,
        normals: &mut Nodal<[T; 3]>,
    ) -> u64 {
        let start = pair.map(|f| memory.nodes[..f].iter().map(|s| s.count_ones() as usize).sum::<usize>());
        let bodies = pair.map(|f| at.body(f));
        let mut have = 0;
        for node in each_place(nodes) {
            let mut gradients = [[T::of(0.0); 3]; 2];
            for side in 0..2 {
                let [x, y, z, _] = memory.numbers[start[side] + rank(memory.nodes[pair[side]], node)];
                gradients[side] = [x, y, z];
            }
            if let Some(normal) = self.combine(bodies, gradients) {
                normals[node] = normal;
                have |= 1 << node;
            }
        }
        have
    }
}
