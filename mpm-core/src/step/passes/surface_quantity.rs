//! Surface quantities of the particles near nodes that bodies share, for contact.
//!
//! Nodes of a block are bits, x fastest. Only bins whose stencil has one of them are visited: slots around the block, bins
//! and particles in index order, so that sums do not depend on threads.

use std::marker::PhantomData;

use mpm_contact::{NearPoint, SurfaceQuantity};
use mpm_materials::material::{Material, Response, States};
use mpm_materials::{Lane, Sym3};

use super::rows::of_row;
use super::slot::{Domains, Slot};
use crate::dim::{BLOCK, Stencil, block_nodes, first_node, neighbours, offset};
use crate::particles::{Columns, Masses};
use crate::shape::domain::{Table, table};
use crate::shape::{ShapeFunction, Weights, bin_centre, node_offset};
use crate::step::nodes::layout::LAYERS;
use impactite_simd::{Arch, Float, Kernel, Pack, Vectors, lane_numbers};

/// Stencil nodes of a bin among the requested ones: index in the block of each, or [`OUTSIDE`].
type Reached = [u8; block_nodes(3)];

const OUTSIDE: u8 = u8::MAX;

/// Place of a bin relative to a node block.
struct BinPlace {
    /// First node of the stencil, from the first node of the block.
    first: [i32; 3],
    /// Offset of the bin's block.
    block: [i32; 3],
}

/// Return the nodes of a block in a bin's stencil, of `count` nodes per axis, one bit each. `first` are the coordinates of
/// its first stencil node, relative to the block's first node.
#[inline(always)]
fn stencil_nodes<const D: usize>(count: usize, first: [i32; 3]) -> u64 {
    let mut nodes = u64::MAX;
    for d in 0..D {
        let mut layers = 0;
        for place in first[d]..first[d] + count as i32 {
            if (0..BLOCK as i32).contains(&place) {
                layers |= LAYERS[d] << (place as usize * BLOCK.pow(d as u32));
            }
        }
        nodes &= layers;
    }
    nodes
}

/// Find the nodes of a bin's stencil, of `count` nodes per axis, that are in `nodes` of a node block. `first` are the
/// coordinates of its first stencil node, relative to the block's first node.
#[inline(always)]
fn reached<const D: usize>(count: usize, first: [i32; 3], nodes: u64) -> Reached {
    let mut found = [OUTSIDE; block_nodes(3)];
    let inside = 0..BLOCK as i32;
    for c in 0..if D == 3 { count } else { 1 } {
        let z = if D == 3 { first[2] + c as i32 } else { 0 };
        for b in 0..count {
            let y = first[1] + b as i32;
            if !inside.contains(&z) || !inside.contains(&y) {
                continue;
            }
            for a in 0..count {
                let x = first[0] + a as i32;
                if !inside.contains(&x) {
                    continue;
                }
                let node = (z * BLOCK as i32 + y) * BLOCK as i32 + x;
                if nodes & (1 << node) != 0 {
                    found[(c * count + b) * count + a] = node as u8;
                }
            }
        }
    }
    found
}

/// Shift a bit set of a block along an axis; bits that leave the block are dropped.
#[inline(always)]
fn moved(set: u64, by: i32, axis: usize) -> u64 {
    let stride = [1, 4, 16][axis];
    let mut kept = 0;
    for place in 0..BLOCK as i32 {
        if (0..BLOCK as i32).contains(&(place + by)) {
            kept |= LAYERS[axis] << (place as usize * stride);
        }
    }
    // No bits remain for shifts by 64 or more.
    let shift = by.unsigned_abs() * stride as u32;
    let set = set & kept;
    if by < 0 { set.wrapping_shr(shift) } else { set.wrapping_shl(shift) }
}

/// Return the nodes of the block at offset `o` from a slot in the stencils, of `count` nodes per axis, of the slot's
/// `bins`.
#[inline(always)]
pub(in crate::step) fn nodes_of<const D: usize>(count: usize, o: &[i32; D], bins: u64) -> u64 {
    let mut set = bins;
    for d in 0..D {
        let mut nodes = 0;
        for a in 0..count as i32 {
            nodes |= moved(set, first_node(count) + a - o[d] * BLOCK as i32, d);
        }
        set = nodes;
    }
    set
}

/// Return the bins of a slot at offset `o` from another that are among `bins` of the other or adjacent to one of them.
pub(in crate::step) fn beside<const D: usize>(o: &[i32; D], bins: u64) -> u64 {
    let mut set = bins;
    for d in 0..D {
        set = (-1..=1).fold(0, |all, by| all | moved(set, by - o[d] * BLOCK as i32, d));
    }
    set
}

/// Return the bins of a slot at offset `o` from the block whose stencils, of `count` nodes per axis, have one of `nodes`.
#[inline(always)]
fn bins_at<const D: usize>(count: usize, o: &[i32; D], nodes: u64) -> u64 {
    let mut set = nodes;
    for d in 0..D {
        let mut bins = 0;
        for a in 0..count as i32 {
            bins |= moved(set, -(o[d] * BLOCK as i32 + first_node(count) + a), d);
        }
        set = bins;
    }
    set
}

/// Visit the non-empty bins of the slots around a block that have one of `nodes` in their stencil.
macro_rules! for_bins {
    ($slots:expr, $contributors:expr, $nodes:expr, $count:expr, $d:ident, $masses:expr, |$slot:ident, $bin:ident, $at:ident| $do:block) => {
        for around in 0..neighbours($d) {
            let Some($slot) = $slots.get($contributors[around] as usize) else { continue };
            let o = offset::<$d>(around);
            let mut set = bins_at::<$d>($count, &o, $nodes);
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
                    first[d] = o[d] * BLOCK as i32 + place as i32 + first_node($count);
                }
                let mut place = BinPlace { first, block: [0; 3] };
                place.block[..$d].copy_from_slice(&o);
                let $at = place;
                $do
            }
        }
    };
}

/// Request of a surface quantity from particles.
pub struct SurfaceTask<'a, T: Float, const D: usize> {
    pub(in crate::step) what: SurfaceQuantity,
    pub(in crate::step) material: &'a dyn Material<T>,
    pub(in crate::step) slots: &'a [Slot<T, D>],
    /// The slots around the block.
    pub(in crate::step) contributors: &'a [u32],
    pub(in crate::step) nodes: u64,
    pub(in crate::step) normals: &'a [[T; 3]],
    pub(in crate::step) out: &'a mut [[T; 3]],
    pub(in crate::step) domains: Domains<T>,
    pub(in crate::step) spacing: T,
    pub(in crate::step) masses: Masses<T>,
}

/// Kernel of a quantity of the particles around a block, by their weights ([`GRADIENT`], [`TRACTION`]) or places
/// ([`REACH`]).
pub(in crate::step) struct SurfaceKernel<'a, T: Float, const D: usize, S, const KIND: u8> {
    pub(in crate::step) shape: &'a S,
    pub(in crate::step) about: SurfaceTask<'a, T, D>,
    /// Responses of the law for the visited groups, in order, if required.
    pub(in crate::step) said: &'a [Response<T>],
}

/// Sums of gradients of weights, times masses or volumes.
pub(in crate::step) const GRADIENT: u8 = 0;
/// Largest extents of particles along the normals.
pub(in crate::step) const REACH: u8 = 1;
/// Sums of normal stresses.
pub(in crate::step) const TRACTION: u8 = 2;

/// Squared distance limit of particles from the line through a node for [`SurfaceQuantity::LocalReach`], in cells;
/// particles half a cell away to either side are included despite rounding. Particles whose domain the line passes through
/// are included, too.
const BESIDE: f64 = 0.25 + BESIDE_ROUNDING;
const BESIDE_ROUNDING: f64 = 1e-6;

/// Marker of a reach without particles.
const LOWEST: f64 = -1e30;

/// Evaluate the law for the visited groups, bin by bin, if required.
pub(in crate::step) fn asked<T: Float, const D: usize>(
    about: &SurfaceTask<'_, T, D>,
    count: usize,
) -> Vec<Response<T>> {
    let mut said = Vec::new();
    if !matches!(about.what, SurfaceQuantity::VolumeGradient | SurfaceQuantity::Traction) {
        return said;
    }
    let SurfaceTask { slots, contributors, nodes, masses, material, .. } = about;
    for_bins!(slots, contributors, *nodes, count, D, masses, |slot, bin, _place| {
        let mut groups = Vec::new();
        let mut next = slot.block.last_group(bin);
        while let Some((group, _)) = next {
            next = slot.block.group_before(group);
            groups.push(group);
        }
        let (all, stride) = slot.block.all_rows();
        let mut response = Response::default();
        let states = States { all, stride, first: Columns::state(D), groups: &groups };
        // Wave speeds are not used.
        material.describe(states, T::of(1.0), &mut response);
        said.push(response);
    });
    said
}

impl<T, const D: usize, S, const KIND: u8> Kernel<T> for SurfaceKernel<'_, T, D, S, KIND>
where
    T: Float,
    S: ShapeFunction<T, D>,
{
    const VECTORS: Vectors = if KIND == TRACTION { Vectors::Plain } else { Vectors::Avx2 };
    type Output = ();

    #[inline(always)]
    fn run<A: Arch<T>>(self) {
        let SurfaceKernel { shape, about, said } = self;
        let SurfaceTask {
            what,
            material,
            slots,
            contributors,
            nodes,
            normals,
            out,
            domains,
            spacing,
            masses,
        } = about;
        let count = S::Extent::NODES;
        let layers = S::Extent::LAYERS;
        let (zero, one) = (A::Pack::zero(), A::Pack::one());
        let lowest = A::Pack::of(LOWEST);
        let carries = S::DOMAIN.carried();
        let convects = S::DOMAIN.convects();
        let reaches = KIND == REACH;
        let (centres, local) = (what == SurfaceQuantity::CentreReach, what == SurfaceQuantity::LocalReach);
        // Domains that may cover a line farther from their centres than [`BESIDE`].
        let diagonal = domains.half[..D].iter().fold(T::default(), |sum, half| sum + *half * *half);
        let wide = reaches && local && !convects && (carries || diagonal > T::of(BESIDE));
        let per_density = A::Pack::splat(material.density()).recip();
        // One sum per node and lane; lanes are added up at the end.
        let mut sums = [[if reaches { lowest } else { zero }; 3]; block_nodes(3)];
        // Half sizes along the normals, if equal for all particles.
        let mut sizes = [T::default(); block_nodes(3)];
        if reaches && !centres && !carries {
            let mut left = nodes;
            while left != 0 {
                let node = left.trailing_zeros() as usize;
                left &= left - 1;
                let mut square = T::default();
                for d in 0..D {
                    square += domains.half[d] * normals[node][d] * (domains.half[d] * normals[node][d]);
                }
                sizes[node] = square.sqrt();
            }
        }
        let lane_index = lane_numbers::<T, A::Pack>();
        let mut visited = 0;
        for_bins!(slots, contributors, nodes, count, D, masses, |slot, bin, at| {
            let reached = reached::<D>(count, at.first, nodes);
            let of_bin = said.get(visited);
            visited += 1;
            let mut number = 0;
            let mut next = slot.block.last_group(bin);
            while let Some((group, in_group)) = next {
                next = slot.block.group_before(group);
                let group = slot.block.group(group);
                let of_group = of_bin.map(|of| (&of.outputs()[number / 2], number % 2));
                number += 1;
                for lane in (0..in_group).step_by(A::Pack::WIDTH) {
                    let here = in_group - lane;
                    let alive = lane_index.lt(A::Pack::of(here as f64));
                    let mut xi = [zero; 3];
                    let size = domains
                        .of::<A::Pack, S, D>(|n| of_row::<T, A::Pack>(&group[domains.column + n], lane));
                    let mut w = [Weights::<A::Pack, S::Extent>::zero(); 3];
                    let mut weights = Table::<A::Pack, S::Extent>::zero();
                    for d in 0..D {
                        xi[d] = of_row::<T, A::Pack>(&group[Columns::position() + d], lane);
                        if !reaches && !convects {
                            w[d] = shape.weights(xi[d], size[d]);
                        }
                    }
                    if !reaches && convects {
                        weights = table::<T, A::Pack, S, D>(&xi, &size);
                    }
                    if D == 2 {
                        w[2].value[0] = one;
                    }
                    let mass = masses.of_group(alive, |row| of_row::<T, A::Pack>(&group[row], lane));
                    let mut amount = mass;
                    let mut stress = Sym3::<A::Pack>::zero();
                    if let Some((said, half)) = of_group {
                        if KIND == GRADIENT {
                            amount = A::Pack::from_pair(&said.volume_ratio, half, lane) * mass * per_density;
                        } else if KIND == TRACTION {
                            for i in 0..6 {
                                stress.0[i] = A::Pack::from_pair(&said.stress[i], half, lane);
                            }
                        }
                    }
                    for c in 0..layers {
                        for b in 0..count {
                            // Factors common to the nodes of a row, for a gradient and for a weight.
                            let (y, z) = (w[1].value[b], w[2].value[c] * amount);
                            let (yz, dyz) = (y * z, w[1].slope[b] * z);
                            let ydz = if D == 3 { y * (w[2].slope[c] * amount) } else { zero };
                            for a in 0..count {
                                let node = reached[(c * count + b) * count + a] as usize;
                                if node >= block_nodes(3) {
                                    continue;
                                }
                                let sum = &mut sums[node];
                                let of_table = (c * count + b) * count + a;
                                if KIND == GRADIENT && convects {
                                    for d in 0..D {
                                        sum[d] = weights.slope[d][of_table].mul_add(amount, sum[d]);
                                    }
                                    continue;
                                }
                                if KIND == GRADIENT {
                                    sum[0] = w[0].slope[a].mul_add(yz, sum[0]);
                                    sum[1] = w[0].value[a].mul_add(dyz, sum[1]);
                                    if D == 3 {
                                        sum[2] = w[0].value[a].mul_add(ydz, sum[2]);
                                    }
                                    continue;
                                }
                                let n = normals[node];
                                let n = [A::Pack::splat(n[0]), A::Pack::splat(n[1]), A::Pack::splat(n[2])];
                                if KIND == TRACTION {
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
                                    let x = xi[d] - A::Pack::of(node_offset::<S::Extent>(place[d]));
                                    along = x.mul_add(n[d], along);
                                    away = x.mul_add(x, away);
                                }
                                let half = if centres {
                                    zero
                                } else if carries {
                                    S::DOMAIN.half_along::<A::Pack, D>(&size, &n)
                                } else {
                                    A::Pack::splat(sizes[node])
                                };
                                let mut reach = along + half;
                                if local {
                                    let near = (away - along * along).lt(A::Pack::of(BESIDE));
                                    reach = A::Pack::select(near, reach, lowest);
                                    if wide {
                                        // Largest distance from the line in half sizes of the domain.
                                        let mut most = zero;
                                        for d in 0..D {
                                            let x = xi[d] - A::Pack::of(node_offset::<S::Extent>(place[d]));
                                            let off = (x - along * n[d]) / size[d];
                                            most = most.max(off.max(-off));
                                        }
                                        let through = most.lt(A::Pack::of(1.0 + BESIDE_ROUNDING));
                                        reach = A::Pack::select(through, along + half, reach);
                                    }
                                }
                                sum[0] = sum[0].max(A::Pack::select(alive, reach, lowest));
                            }
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
                // Without a particle the value stays what it was.
                if far > T::of(LOWEST) {
                    to[0] = to[0].max(far * spacing);
                }
            } else {
                let factor = if KIND == TRACTION { T::of(1.0) } else { per_spacing };
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

/// Return the normal stress n . sigma . n.
#[inline(always)]
fn normal_stress<L: Lane>(s: &Sym3<L>, n: &[L; 3]) -> L {
    let two = L::of(2.0);
    let direct = s.0[0] * n[0] * n[0] + s.0[1] * n[1] * n[1] + s.0[2] * n[2] * n[2];
    direct + two * (s.0[3] * n[1] * n[2] + s.0[4] * n[0] * n[2] + s.0[5] * n[0] * n[1])
}

/// Visitor of single particles near some nodes of a block.
pub(in crate::step) struct NearPoints<'a, T: Float, const D: usize, S> {
    pub(in crate::step) shape: PhantomData<S>,
    pub(in crate::step) about: NearTask<'a, T, D>,
}

/// Particles near some nodes of a block, to be visited one by one.
pub struct NearTask<'a, T: Float, const D: usize> {
    pub(in crate::step) slots: &'a [Slot<T, D>],
    /// The slots around the block.
    pub(in crate::step) contributors: &'a [u32],
    pub(in crate::step) nodes: u64,
    pub(in crate::step) domains: Domains<T>,
    pub(in crate::step) spacing: T,
    pub(in crate::step) masses: Masses<T>,
}

impl<T: Float, const D: usize, S: ShapeFunction<T, D>> NearPoints<'_, T, D, S> {
    /// Return the half sizes of a particle along the axes, and a bound of that in any direction, m; `number` reads its columns.
    #[inline(always)]
    fn sizes(&self, number: impl Fn(usize) -> T) -> ([T; 3], T) {
        let NearTask { domains, spacing: h, .. } = &self.about;
        let domain = domains.of::<T::Single, S, D>(|n: usize| T::Single::from(number(domains.column + n)));
        let (mut sizes, mut largest, mut squares) = ([T::default(); 3], T::default(), T::default());
        for d in 0..D {
            let mut axis = [T::Single::zero(); 3];
            axis[d] = T::Single::one();
            let half: T = S::DOMAIN.half_along::<T::Single, D>(&domain, &axis).into();
            sizes[d] = half * *h;
            largest = largest.max(sizes[d]);
            squares += sizes[d] * sizes[d];
        }
        // The sum of the squares is that of the half edges of an oblique domain.
        (sizes, if S::DOMAIN.convects() { squares.sqrt() } else { largest })
    }

    pub(in crate::step) fn visit(&self, visit: &mut dyn FnMut(u64, &NearPoint<T>)) {
        let NearTask { slots, contributors, nodes, spacing: h, masses, .. } = &self.about;
        let count = S::Extent::NODES;
        // Constant domains are equal for all particles.
        let of_all = (!S::DOMAIN.carried()).then(|| self.sizes(|_| T::default()));
        for_bins!(slots, contributors, *nodes, count, D, masses, |slot, bin, at| {
            let mask = stencil_nodes::<D>(count, at.first) & *nodes;
            // Nodes of the block have integer coordinates; the centre of the bin is that of its stencil.
            let mut centre = [T::default(); 3];
            for d in 0..D {
                let place = (bin / BLOCK.pow(d as u32) % BLOCK) as i32;
                let block = at.block[d] * BLOCK as i32;
                centre[d] = T::of(f64::from(block + place) + bin_centre::<S::Extent>());
            }
            let mut next = slot.block.last_group(bin);
            while let Some((group, in_group)) = next {
                next = slot.block.group_before(group);
                let group = slot.block.group(group);
                for lane in 0..in_group {
                    let number = |column: usize| group[column].as_ref()[lane];
                    let (half, radius) = of_all.unwrap_or_else(|| self.sizes(number));
                    let mut near =
                        NearPoint { offset: [T::default(); 3], half, radius, mass: masses.read(number) };
                    for d in 0..D {
                        near.offset[d] = (centre[d] + number(Columns::position() + d)) * *h;
                    }
                    visit(mask, &near);
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
    fn nodes_of_a_stencil_are_those_of_its_table() {
        for count in [2, 3, 4] {
            for place in 0..512 {
                let first = [0, 1, 2].map(|d| place / 8i32.pow(d) % 8 - 4);
                let nodes = 0x0123_4567_89ab_cdef;
                let table = reached::<3>(count, first, nodes);
                let bits = table.iter().filter(|n| **n != OUTSIDE).fold(0, |bits, n| bits | 1 << n);
                assert_eq!(stencil_nodes::<3>(count, first) & nodes, bits, "{count} {first:?}");
                let table = reached::<2>(count, first, 0x9bdf);
                let bits = table.iter().filter(|n| **n != OUTSIDE).fold(0, |bits, n| bits | 1 << n);
                assert_eq!(stencil_nodes::<2>(count, first) & 0x9bdf, bits, "{count} {first:?}");
            }
        }
    }

    #[test]
    fn bins_beside_spill_into_blocks_around() {
        // Last bin of a 2D block: its neighbours include three in three other blocks.
        let last = 1 << (BLOCK * BLOCK - 1);
        assert_eq!(beside::<2>(&[0, 0], last), 0b1100_1100_0000_0000);
        assert_eq!(beside::<2>(&[1, 0], last), 0b0001_0001_0000_0000);
        assert_eq!(beside::<2>(&[0, 1], last), 0b1100);
        assert_eq!(beside::<2>(&[1, 1], last), 1);
        assert_eq!(beside::<2>(&[-1, 0], last), 0);
        // Full 3D block: all its bins, and one layer of each neighbour.
        let count = |o| beside::<3>(&o, !0).count_ones() as usize;
        assert_eq!((count([0; 3]), count([0, -1, 0]), count([1, 1, 0]), count([-1; 3])), (64, 16, 4, 1));
        assert_eq!(count([2, 0, 0]), 0);
    }
}
