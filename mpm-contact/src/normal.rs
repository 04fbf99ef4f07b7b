//! Normals at the nodes that bodies share.

use impactite_simd::Float;

use crate::places::{Places, SurfaceQuantity, each_place};
use crate::vector::{difference, times, unit};

/// What detectors may remember while they look at one block: cleared for every block, kept in memory.
#[derive(Debug)]
pub struct Memory<'a, T> {
    /// Numbers of nodes.
    pub numbers: &'a mut Vec<[T; 4]>,
    /// For each field: the nodes that are looked at, a bit each; others have mass there, too.
    pub nodes: &'a [u64],
}

/// A number a node of a block.
pub type Nodal<X> = [X; 64];

/// A rule for the normal between two bodies at a node, from where their particles are. One normal serves both (the bodies' own normals are not
/// opposite, and momentum would drift).
pub trait NormalRule<T: Float, const D: usize>: std::fmt::Debug + Send + Sync + 'static {
    /// Look at the fields once, before their pairs.
    fn prepare(&self, at: &dyn Places<T, D>, memory: &mut Memory<'_, T>);
    /// Unit normals from the first to the second field of `pair` at `nodes` (a bit each). Returns the nodes
    /// that have one.
    fn normals(
        &self,
        at: &dyn Places<T, D>,
        pair: [usize; 2],
        nodes: u64,
        memory: &Memory<'_, T>,
        normals: &mut Nodal<[T; 3]>,
    ) -> u64;
}

/// Which particles weigh how much in a body's normal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Weight {
    /// By mass: sum_p m_p grad N_ip (eq. 9 of \[Zhang2017\]).
    Mass,
    /// By volume: sum_p V_p grad N_ip \[BardenhagenGuilkey2001\].
    Volume,
}

/// How two bodies' normals become one.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Choice {
    /// (n_r - n_s) / |n_r - n_s| of the unit normals \[Huang2011\]; n_r where they nearly cancel, as at a sheet
    /// inside the support of the node.
    Collinear,
    /// The direction of g_r - g_s: the body with more particles at the node counts more.
    Difference,
    /// The normal of the body that stands first in this list of numbers (the stiffer or the convex one); of
    /// pairs that are not in it, the first body's.
    OneBody(Vec<usize>),
}

/// Normals from the gradient of mass or volume at the node, which points out of a body.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Gradients {
    weight: Weight,
    choice: Choice,
}

impl Default for Gradients {
    /// By mass, collinear.
    fn default() -> Self {
        Gradients::new(Weight::Mass, Choice::Collinear)
    }
}

impl Gradients {
    /// Normals of this weight and choice.
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
                // Less than 0.1: the normals are within 6 degrees of each other.
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

/// Place of a node's number among those of a field's nodes.
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
