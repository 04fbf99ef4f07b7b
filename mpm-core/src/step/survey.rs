//! What contact asks of the particles near the nodes that bodies share.
//!
//! Nodes of a block are given by a bit each, x fastest. Only bins whose stencil has one of them are visited:
//! slots around the block, bins and particles in order of place, so that the sums do not depend on threads.

use mpm_materials::{Constitutive, Lane, State, Sym3};

use super::load::Load;
use super::migrate::Domains;
use super::particle_body::{ParticleBody, offset};
use super::rows::Rows;
use super::sweep::{ExtentOf, ShapeOf, Slot};
use crate::dim::{Array, BLOCK, Stencil, block_nodes, neighbours};
use crate::method::Composition;
use crate::parallel::{Arch, Float, Kernel, Pack, lane_numbers};
use crate::particles::{Columns, Masses};
use crate::shape::domain::{MOST_NUMBERS, Table, table};
use crate::shape::{ShapeFunction, Weights, node_offset};

/// A quantity of a body at a node.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Survey {
    /// sum_p m_p grad N_ip, kg/m; it points out of the body \[Zhang2017\].
    MassGradient,
    /// sum_p V_p grad N_ip, m^2; likewise \[BardenhagenGuilkey2001\].
    VolumeGradient,
    /// max_p [(x_p - x_i) . n + l_p], m, with n the node's normal and l_p the particle's half size: how far the
    /// surface reaches beyond the node along n (eq. 5 of \[Ma2010\]). First component; start from a large
    /// negative number.
    Reach,
    /// [`Survey::Reach`] of the particles whose centres lie within half a cell of the line through the node along
    /// its normal: how far the surface reaches there, and not where it bulges beside it.
    LocalReach,
    /// [`Survey::Reach`] without l_p: how far the centres reach.
    CentreReach,
    /// sum_p N_ip m_p n . sigma_p . n, Pa kg: over the nodal mass the normal traction
    /// \[BardenhagenGuilkey2001\], tension positive. First component.
    Traction,
}

/// A particle as contact sees it from a node.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Near<T> {
    /// Its position less the node's, m.
    pub offset: [T; 3],
    /// Its half sizes, m.
    pub half: [T; 3],
    /// Its mass, kg.
    pub mass: T,
    /// Its weight at the node.
    pub weight: T,
}

/// For each of the nodes of a stencil: its place in the block, if the survey is about it.
struct Reached<E: Stencil> {
    node: E::Nodes<u8>,
}

const OUTSIDE: u8 = u8::MAX;

/// Places in a node block of the stencil of the bin at `first` (coordinates of its first stencil node, relative
/// to the block's first node), as far as they are in `nodes`.
#[inline(always)]
fn reached<E: Stencil, const D: usize>(first: [i32; 3], nodes: u64) -> Reached<E> {
    let mut found: Reached<E> = Reached { node: Array::filled(OUTSIDE) };
    let inside = 0..BLOCK as i32;
    for c in 0..E::LAYERS {
        let z = if D == 3 { first[2] + c as i32 } else { 0 };
        for b in 0..E::NODES {
            let y = first[1] + b as i32;
            if !inside.contains(&z) || !inside.contains(&y) {
                continue;
            }
            for a in 0..E::NODES {
                let x = first[0] + a as i32;
                if !inside.contains(&x) {
                    continue;
                }
                let node = (z * BLOCK as i32 + y) * BLOCK as i32 + x;
                if nodes & (1 << node) != 0 {
                    found.node[(c * E::NODES + b) * E::NODES + a] = node as u8;
                }
            }
        }
    }
    found
}

/// The first of the four layers of a block across each axis, a bit a node.
const LAYERS: [u64; 3] = [0x1111_1111_1111_1111, 0x000F_000F_000F_000F, 0x0000_0000_0000_FFFF];

/// A set of places in a block, moved along an axis; what leaves the block is lost.
#[inline(always)]
fn moved(set: u64, by: i32, axis: usize) -> u64 {
    let stride = [1, 4, 16][axis];
    let mut kept = 0;
    for place in 0..BLOCK as i32 {
        if (0..BLOCK as i32).contains(&(place + by)) {
            kept |= LAYERS[axis] << (place as usize * stride);
        }
    }
    // Nothing is kept of what would be shifted by 64 or more.
    let shift = by.unsigned_abs() * stride as u32;
    let set = set & kept;
    if by < 0 { set.wrapping_shr(shift) } else { set.wrapping_shl(shift) }
}

/// The nodes of a block at offset `o` from a slot that stencils of the slot's `bins` have.
#[inline(always)]
pub(super) fn nodes_of<E: Stencil, const D: usize>(o: &[i32; D], bins: u64) -> u64 {
    let mut set = bins;
    for d in 0..D {
        let mut nodes = 0;
        for a in 0..E::NODES as i32 {
            nodes |= moved(set, E::BASE + a - o[d] * BLOCK as i32, d);
        }
        set = nodes;
    }
    set
}

/// The bins of a slot at offset `o` from another that are among `bins` of that or next to one of them.
pub(super) fn beside<const D: usize>(o: &[i32; D], bins: u64) -> u64 {
    let mut set = bins;
    for d in 0..D {
        set = (-1..=1).fold(0, |all, by| all | moved(set, by - o[d] * BLOCK as i32, d));
    }
    set
}

/// The bins of a slot at offset `o` from the block whose stencils have one of `nodes`.
#[inline(always)]
fn bins_at<E: Stencil, const D: usize>(o: &[i32; D], nodes: u64) -> u64 {
    let mut set = nodes;
    for d in 0..D {
        let mut bins = 0;
        for a in 0..E::NODES as i32 {
            bins |= moved(set, -(o[d] * BLOCK as i32 + E::BASE + a), d);
        }
        set = bins;
    }
    set
}

/// The bins of the slots around a block that have one of `nodes` in their stencil, with particles in them.
macro_rules! for_bins {
    ($slots:expr, $contributors:expr, $nodes:expr, $extent:ty, $d:ident, $masses:expr, |$slot:ident, $bin:ident, $at:ident| $do:block) => {
        for around in 0..neighbours($d) {
            let Some($slot) = $slots.get($contributors[around] as usize) else { continue };
            let o = offset::<$d>(around);
            let mut set = bins_at::<$extent, $d>(&o, $nodes);
            while set != 0 {
                let $bin = set.trailing_zeros() as usize;
                set &= set - 1;
                if set != 0 {
                    $slot.block.prefetch(set.trailing_zeros() as usize, Columns::state($d), $masses.row());
                }
                if $slot.block.bin_len($bin) == 0 {
                    continue;
                }
                let mut first = [0; 3];
                for d in 0..$d {
                    let place = $bin / BLOCK.pow(d as u32) % BLOCK;
                    first[d] = o[d] * BLOCK as i32 + place as i32 + <$extent>::BASE;
                }
                let $at = reached::<$extent, $d>(first, $nodes);
                $do
            }
        }
    };
}

/// The survey `WHAT` of the particles around a block.
struct SurveyBlock<'a, T: Float, const D: usize, C, M: Composition<T, D>, const WHAT: u8> {
    law: &'a C,
    method: &'a M,
    slots: &'a [Slot<T, D>],
    contributors: &'a [u32],
    nodes: u64,
    normals: &'a [[T; 3]],
    out: &'a mut [[T; 3]],
    half: [T; 3],
    spacing: T,
    domain: usize,
    masses: Masses<T>,
}

const MASS_GRADIENT: u8 = 0;
const VOLUME_GRADIENT: u8 = 1;
const REACH: u8 = 2;
const TRACTION: u8 = 3;
const CENTRES: u8 = 4;
const LOCAL_REACH: u8 = 5;

/// How far from the line through a node a particle may be to count for [`Survey::LocalReach`], squared, in cells;
/// those half a cell away to either side count alike, whatever the rounding.
const BESIDE: f64 = 0.25 + 1e-6;

impl<T, const D: usize, C, M, const WHAT: u8> Kernel<T> for SurveyBlock<'_, T, D, C, M, WHAT>
where
    T: Float,
    C: Constitutive<T>,
    M: Composition<T, D>,
{
    type Output = ();

    #[inline(always)]
    fn run<A: Arch<T>>(self) {
        let SurveyBlock {
            law,
            method,
            slots,
            contributors,
            nodes,
            normals,
            out,
            half,
            spacing,
            domain,
            masses,
        } = self;
        let count = <ExtentOf<M, T, D> as Stencil>::NODES;
        let layers = <ExtentOf<M, T, D> as Stencil>::LAYERS;
        let (zero, one) = (A::Pack::zero(), A::Pack::one());
        let lowest = A::Pack::of(-1e30);
        let carries = ShapeOf::<M, T, D>::DOMAIN.carried();
        let convects = ShapeOf::<M, T, D>::DOMAIN.convects();
        let reaches = WHAT == REACH || WHAT == CENTRES || WHAT == LOCAL_REACH;
        // A sum a node and lane; lanes are added up at the end.
        let mut sums = [[if reaches { lowest } else { zero }; 3]; block_nodes(3)];
        // Half sizes along the normals, where they are the same for all particles.
        let mut sizes = [T::default(); block_nodes(3)];
        if reaches && WHAT != CENTRES && !carries {
            let mut left = nodes;
            while left != 0 {
                let node = left.trailing_zeros() as usize;
                left &= left - 1;
                let mut square = T::default();
                for d in 0..D {
                    square += half[d] * normals[node][d] * (half[d] * normals[node][d]);
                }
                sizes[node] = square.sqrt();
            }
        }
        let lane_index = lane_numbers::<T, A::Pack>();
        for_bins!(slots, contributors, nodes, ExtentOf<M, T, D>, D, masses, |slot, bin, at| {
            let mut next = slot.block.last_group(bin);
            while let Some((group, here)) = next {
                next = slot.block.group_before(group);
                let group = slot.block.group(group);
                let alive = lane_index.lt(A::Pack::of(here as f64));
                let mut xi = [zero; 3];
                let size = Domains { column: domain, half }
                    .of::<A::Pack, ShapeOf<M, T, D>, D>(|n| A::Pack::load(&group[domain + n]));
                let mut w = [Weights::<A::Pack, ExtentOf<M, T, D>>::zero(); 3];
                let mut weights = Table::<A::Pack, ExtentOf<M, T, D>>::zero();
                for d in 0..D {
                    xi[d] = A::Pack::load(&group[Columns::position() + d]);
                    if !reaches && !convects {
                        w[d] = method.shape().weights(xi[d], size[d]);
                    }
                }
                if !reaches && convects {
                    weights = table::<T, A::Pack, ShapeOf<M, T, D>, D>(&xi, &size);
                }
                if D == 2 {
                    w[2].value[0] = one;
                }
                let mass = masses.of_group(alive, |row| A::Pack::load(&group[row]));
                let mut amount = mass;
                let mut stress = Sym3::<A::Pack>::zero();
                if WHAT == VOLUME_GRADIENT || WHAT == TRACTION {
                    let now = C::State::<A::Pack>::read(&mut Rows::of(group).reader(Columns::state(D)));
                    if WHAT == VOLUME_GRADIENT {
                        amount = law.volume_ratio(&now) * mass * A::Pack::splat(law.density()).recip();
                    } else {
                        stress = law.stress(&now);
                    }
                }
                for c in 0..layers {
                    for b in 0..count {
                        // What the nodes of a row have in common, of a gradient and of a weight.
                        let (y, z) = (w[1].value[b], w[2].value[c] * amount);
                        let (yz, dyz) = (y * z, w[1].slope[b] * z);
                        let ydz = if D == 3 { y * (w[2].slope[c] * amount) } else { zero };
                        for a in 0..count {
                            let node = at.node[(c * count + b) * count + a] as usize;
                            if node >= block_nodes(3) {
                                continue;
                            }
                            let sum = &mut sums[node];
                            let of_table = (c * count + b) * count + a;
                            if (WHAT == MASS_GRADIENT || WHAT == VOLUME_GRADIENT) && convects {
                                for d in 0..D {
                                    sum[d] = weights.slope[d][of_table].mul_add(amount, sum[d]);
                                }
                                continue;
                            }
                            if WHAT == MASS_GRADIENT || WHAT == VOLUME_GRADIENT {
                                sum[0] = w[0].slope[a].mul_add(yz, sum[0]);
                                sum[1] = w[0].value[a].mul_add(dyz, sum[1]);
                                if D == 3 {
                                    sum[2] = w[0].value[a].mul_add(ydz, sum[2]);
                                }
                                continue;
                            }
                            let n = normals[node];
                            let n = [A::Pack::splat(n[0]), A::Pack::splat(n[1]), A::Pack::splat(n[2])];
                            if WHAT == TRACTION {
                                let t = normal_stress(&stress, &n);
                                let weighted = match convects {
                                    true => weights.value[of_table] * amount,
                                    false => w[0].value[a] * yz,
                                };
                                sum[0] = weighted.mul_add(t, sum[0]);
                                continue;
                            }
                            let place = [a, b, c];
                            let (mut along, mut away) = (zero, zero);
                            for d in 0..D {
                                let x = xi[d] - A::Pack::of(node_offset::<ExtentOf<M, T, D>>(place[d]));
                                along = x.mul_add(n[d], along);
                                if WHAT == LOCAL_REACH {
                                    away = x.mul_add(x, away);
                                }
                            }
                            let half = if WHAT == CENTRES {
                                zero
                            } else if carries {
                                ShapeOf::<M, T, D>::DOMAIN.half_along::<A::Pack, D>(&size, &n)
                            } else {
                                A::Pack::splat(sizes[node])
                            };
                            let mut reach = along + half;
                            if WHAT == LOCAL_REACH {
                                let near = (away - along * along).lt(A::Pack::of(BESIDE));
                                reach = A::Pack::select(near, reach, lowest);
                            }
                            sum[0] = sum[0].max(A::Pack::select(alive, reach, lowest));
                        }
                    }
                }
            }
        });
        let per_spacing = T::of(1.0) / spacing;
        let mut left = nodes;
        while left != 0 {
            let node = left.trailing_zeros() as usize;
            left &= left - 1;
            let to = &mut out[node];
            if reaches {
                let mut far = sums[node][0].lane(0);
                for i in 1..A::Pack::WIDTH {
                    far = far.max(sums[node][0].lane(i));
                }
                to[0] = to[0].max(far * spacing);
            } else {
                let factor = if WHAT == TRACTION { T::of(1.0) } else { per_spacing };
                for d in 0..D {
                    let mut sum = sums[node][d].lane(0);
                    for i in 1..A::Pack::WIDTH {
                        sum += sums[node][d].lane(i);
                    }
                    to[d] += sum * factor;
                }
            }
        }
    }
}

/// n . sigma . n.
#[inline(always)]
fn normal_stress<L: Lane>(s: &Sym3<L>, n: &[L; 3]) -> L {
    let two = L::of(2.0);
    let direct = s.0[0] * n[0] * n[0] + s.0[1] * n[1] * n[1] + s.0[2] * n[2] * n[2];
    direct + two * (s.0[3] * n[1] * n[2] + s.0[4] * n[0] * n[2] + s.0[5] * n[0] * n[1])
}

impl<T, const D: usize, C, M, L> ParticleBody<T, D, C, M, L>
where
    T: Float,
    C: Constitutive<T>,
    M: Composition<T, D>,
    L: Load<D>,
{
    pub(super) fn survey_nodes(
        &self,
        block: usize,
        what: Survey,
        nodes: u64,
        normals: &[[T; 3]],
        out: &mut [[T; 3]],
    ) {
        match what {
            Survey::MassGradient => self.survey_as::<MASS_GRADIENT>(block, nodes, normals, out),
            Survey::VolumeGradient => self.survey_as::<VOLUME_GRADIENT>(block, nodes, normals, out),
            Survey::Reach => self.survey_as::<REACH>(block, nodes, normals, out),
            Survey::LocalReach => self.survey_as::<LOCAL_REACH>(block, nodes, normals, out),
            Survey::CentreReach => self.survey_as::<CENTRES>(block, nodes, normals, out),
            Survey::Traction => self.survey_as::<TRACTION>(block, nodes, normals, out),
        }
    }

    fn survey_as<const WHAT: u8>(&self, block: usize, nodes: u64, normals: &[[T; 3]], out: &mut [[T; 3]]) {
        T::dispatch(SurveyBlock::<T, D, C, M, WHAT> {
            law: &self.law,
            method: &self.method,
            slots: &self.slots,
            contributors: &self.contributors[block * neighbours(D)..][..neighbours(D)],
            nodes,
            normals,
            out,
            half: self.half,
            spacing: T::of(self.lattice.spacing()),
            domain: self.columns.domain(),
            masses: self.masses,
        });
    }

    /// The domain of a particle, of which `carried` gives the numbers of its own.
    pub(super) fn domain_at(&self, carried: impl Fn(usize) -> T::Single) -> [T::Single; MOST_NUMBERS] {
        let domains = Domains { column: self.columns.domain(), half: self.half };
        domains.of::<T::Single, ShapeOf<M, T, D>, D>(carried)
    }

    pub(super) fn visit_near(&self, block: usize, nodes: u64, visit: &mut dyn FnMut(usize, &Near<T>)) {
        let h = T::of(self.lattice.spacing());
        let (count, layers) = (<ExtentOf<M, T, D> as Stencil>::NODES, <ExtentOf<M, T, D> as Stencil>::LAYERS);
        let one: T = T::of(1.0);
        let contributors = &self.contributors[block * neighbours(D)..][..neighbours(D)];
        let masses = self.masses;
        for_bins!(self.slots, contributors, nodes, ExtentOf<M, T, D>, D, masses, |slot, bin, at| {
            for place in slot.block.bin_places(bin) {
                let number = |column: usize| slot.block.get(place, column);
                let mut near = Near {
                    offset: [T::default(); 3],
                    half: [T::default(); 3],
                    mass: self.mass_at(&slot.block, place),
                    weight: one,
                };
                let kind = ShapeOf::<M, T, D>::DOMAIN;
                let domain = self.domain_at(|n| T::Single::from(number(self.columns.domain() + n)));
                let mut xi = [T::default(); 3];
                let mut w = [Weights::<T::Single, ExtentOf<M, T, D>>::zero(); 3];
                w[2].value[0] = T::Single::one();
                for d in 0..D {
                    xi[d] = number(Columns::position() + d);
                    let mut axis = [T::Single::zero(); 3];
                    axis[d] = T::Single::one();
                    let half: T = kind.half_along::<T::Single, D>(&domain, &axis).into();
                    near.half[d] = half * h;
                    w[d] = self.method.shape().weights(T::Single::from(xi[d]), domain[d]);
                }
                let mut weights = Table::<T::Single, ExtentOf<M, T, D>>::zero();
                if kind.convects() {
                    weights = table::<T, T::Single, ShapeOf<M, T, D>, D>(&xi.map(T::Single::from), &domain);
                }
                for s in 0..layers * count * count {
                    let node = at.node[s];
                    if node == OUTSIDE {
                        continue;
                    }
                    let place = [s % count, s / count % count, s / (count * count)];
                    let mut weight = one;
                    for d in 0..D {
                        near.offset[d] = (xi[d] - T::of(node_offset::<ExtentOf<M, T, D>>(place[d]))) * h;
                        weight *= w[d].value[place[d]].into();
                    }
                    near.weight = if kind.convects() { weights.value[s].into() } else { weight };
                    visit(node as usize, &near);
                }
            }
        });
    }
}

const _: () = assert!(block_nodes(3) == u64::BITS as usize, "a node of a block is a bit");

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bins_beside_spill_into_blocks_around() {
        // The last bin of a block in the plane: all around it, three of them in three other blocks.
        let last = 1 << (BLOCK * BLOCK - 1);
        assert_eq!(beside::<2>(&[0, 0], last), 0b1100_1100_0000_0000);
        assert_eq!(beside::<2>(&[1, 0], last), 0b0001_0001_0000_0000);
        assert_eq!(beside::<2>(&[0, 1], last), 0b1100);
        assert_eq!(beside::<2>(&[1, 1], last), 1);
        assert_eq!(beside::<2>(&[-1, 0], last), 0);
        // A full block in space: itself, and a layer of each of its neighbours.
        let count = |o| beside::<3>(&o, !0).count_ones() as usize;
        assert_eq!((count([0; 3]), count([0, -1, 0]), count([1, 1, 0]), count([-1; 3])), (64, 16, 4, 1));
        assert_eq!(count([2, 0, 0]), 0);
    }
}
