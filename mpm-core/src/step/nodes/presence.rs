//! Node blocks that a body's particles reach, and links to them.

use mpm_contact::{NearPoint, SurfaceQuantity};

use super::footprint::NodeWeight;
use super::layout::{Claim, Layout, NodeSums};
use crate::dim::{BLOCK, block_nodes, first_node, neighbours, offset, shifted};
use crate::grid::Node;
use crate::particles::Columns;

use crate::step::bodies::body::{GridBody, Presence};
use crate::step::bodies::capability::MeetsSurfaces;
use crate::step::bodies::crossing::crosses;
use crate::step::bodies::particle_body::{NONE, ParticleBody};
use crate::step::clients::near_particles::NearParticle;
use crate::step::passes::surface_quantity::{NearTask, SurfaceTask, beside, nodes_of};
use impactite_simd::{Float, prefetch_from};

impl<T: Float, const D: usize> ParticleBody<T, D> {
    /// Return true if a particle reaches a node that its body does not have.
    pub(in crate::step) fn reaches_beyond_links(&mut self, layout: &Layout) -> bool {
        let count = self.facts().nodes;
        let around = self.nodes_around.chunks(neighbours(D));
        self.slots.iter_mut().zip(around).any(|(slot, around)| {
            let new = slot.block.occupied() & !slot.linked;
            let beyond = new != 0
                && around.iter().enumerate().any(|(n, &block)| {
                    let kept = if block == NONE { 0 } else { layout.kept(block as usize) };
                    nodes_of::<D>(count, &offset(n), new) & !kept != 0
                });
            slot.linked |= if beyond { 0 } else { new };
            beyond
        })
    }

    /// Return true if a particle reaches a block of the body's own list.
    pub(in crate::step) fn reaches_block(&self, block: usize) -> bool {
        let count = self.facts().nodes;
        let around = &self.contributors[block * neighbours(D)..][..neighbours(D)];
        around.iter().enumerate().any(|(n, &slot)| {
            // The node block is in the opposite direction from the slot.
            let o = offset::<D>(neighbours(D) - 1 - n);
            let slot = self.slots.get(slot as usize);
            slot.is_some_and(|s| nodes_of::<D>(count, &o, s.block.occupied()) != 0)
        })
    }

    /// Store the bins whose stencil nodes the body requests: those with particles and, with `ahead`, adjacent ones, for
    /// which slots are made.
    pub(in crate::step) fn expect(&mut self, ahead: bool) {
        if !ahead {
            self.slots.iter_mut().for_each(|slot| slot.linked = slot.block.occupied());
            return;
        }
        let mut wanted = std::mem::take(&mut self.wanted);
        wanted.clear();
        for slot in &self.slots {
            for (n, &around) in slot.slots_around.iter().enumerate() {
                let o = offset::<D>(n);
                if around == NONE
                    && beside::<D>(&o, slot.block.occupied()) != 0
                    && crosses(self.levels.as_deref(), &slot.block.coordinates, n).is_none()
                {
                    wanted.push(self.wrap.block(shifted(&slot.block.coordinates, &o)));
                }
            }
        }
        if self.make_slots(&mut wanted) {
            self.link_slots();
        }
        self.wanted = wanted;
        let mut empty = false;
        for s in 0..self.slots.len() {
            let mut linked = 0;
            for (n, &around) in self.slots[s].slots_around.iter().enumerate() {
                let Some(other) = self.slots.get(around as usize) else { continue };
                // This slot is in the opposite direction from the other.
                linked |= beside::<D>(&offset(neighbours(D) - 1 - n), other.block.occupied());
            }
            self.slots[s].linked = linked;
            empty |= linked == 0;
        }
        if empty {
            self.spare.extend(self.slots.extract_if(.., |s| s.linked == 0));
            self.link_slots();
        }
    }

    pub(in crate::step) fn claim_blocks(&self, number: u32, list: &mut Vec<Claim<D>>) {
        let count = self.facts().nodes;
        for slot in &self.slots {
            for n in 0..neighbours(D) {
                let o = offset::<D>(n);
                if count == 2 && o.iter().any(|&x| x < 0) {
                    continue;
                }
                let coordinates = self.wrap.block(shifted(&slot.block.coordinates, &o));
                let reached = nodes_of::<D>(count, &o, slot.linked);
                list.push(Claim { coordinates, body: number, reached });
            }
        }
    }

    pub(in crate::step) fn link_blocks(
        &mut self,
        find: &dyn Fn(&[i32; D]) -> Option<usize>,
        places: &mut Vec<u32>,
    ) {
        let mut links = std::mem::take(&mut self.links);
        links.clear();
        self.nodes_around.clear();
        for (s, slot) in self.slots.iter().enumerate() {
            for n in 0..neighbours(D) {
                let found = find(&self.wrap.block(shifted(&slot.block.coordinates, &offset(n))));
                let block = found.map_or(NONE, |b| b as u32);
                self.nodes_around.push(block);
                if block != NONE {
                    links.push((block, s as u32, n as u8));
                }
            }
        }
        links.sort_unstable();
        self.contributors.clear();
        for &(block, slot, n) in &links {
            if places.last() != Some(&block) {
                places.push(block);
                self.contributors.resize(places.len() * neighbours(D), NONE);
            }
            // This slot is in the opposite direction from the node block.
            let last = self.contributors.len() - 1;
            self.contributors[last - n as usize] = slot;
        }
        self.links = links;
    }
}

impl<T: Float, const D: usize> ParticleBody<T, D> {
    pub(in crate::step) fn surface_quantity_of(
        &self,
        block: usize,
        what: SurfaceQuantity,
        nodes: u64,
        normals: &[[T; 3]],
        out: &mut [[T; 3]],
    ) {
        let spacing = T::of(self.spacing_around(block));
        let about = SurfaceTask {
            what,
            material: &*self.material,
            slots: &self.slots,
            contributors: &self.contributors[block * neighbours(D)..][..neighbours(D)],
            nodes,
            normals,
            out,
            domains: self.domains(),
            spacing,
            masses: self.masses,
        };
        self.kernels.shape().surface_quantity(about);
    }

    /// Spacing of the nodes of a block of the body's own list, m.
    fn spacing_around(&self, block: usize) -> f64 {
        let around = &self.contributors[block * neighbours(D)..][..neighbours(D)];
        let slot = around.iter().find_map(|&slot| self.slots.get(slot as usize));
        let lattice = slot.map(|slot| self.lattices.of_block(&slot.block.coordinates).0);
        lattice.unwrap_or(self.lattice).spacing()
    }

    pub(in crate::step) fn visit_near_points(
        &self,
        block: usize,
        nodes: u64,
        visit: &mut dyn FnMut(u64, &NearPoint<T>),
    ) {
        let about = NearTask {
            slots: &self.slots,
            contributors: &self.contributors[block * neighbours(D)..][..neighbours(D)],
            nodes,
            domains: self.domains(),
            spacing: T::of(self.spacing_around(block)),
            masses: self.masses,
        };
        self.kernels.shape().near_points(about, visit);
    }
}

impl<T: Float, const D: usize> Presence<T, D> for ParticleBody<T, D> {
    fn add_affine(&self, block: usize, node: usize, sums: &mut [[T; 4]; 3]) {
        let (size, first) = (BLOCK as i32 + self.facts().nodes as i32 - 1, first_node(self.facts().nodes));
        let around = &self.contributors[block * neighbours(D)..][..neighbours(D)];
        for (n, &slot) in around.iter().enumerate() {
            let Some(slot) = self.slots.get(slot as usize).filter(|slot| !slot.affine.is_empty()) else {
                continue;
            };
            // The node block is in the opposite direction from the slot.
            let o = offset::<D>(neighbours(D) - 1 - n);
            let (mut at, mut stride, mut rest, mut inside) = (0, 1, node, true);
            for x in o {
                let along = BLOCK as i32 * x + (rest % BLOCK) as i32 - first;
                inside &= (0..size).contains(&along);
                at += along * stride;
                stride *= size;
                rest /= BLOCK;
            }
            if inside {
                for (sum, add) in sums.iter_mut().zip(&slot.affine[D * at as usize..][..D]) {
                    (0..4).for_each(|c| sum[c] += add[c]);
                }
            }
        }
    }
    fn claims(&mut self, number: u32, ahead: bool, list: &mut Vec<Claim<D>>) {
        if !self.is_deactivated() {
            self.expect(ahead);
            self.claim_blocks(number, list);
        }
    }
    fn reaches_further(&mut self, layout: &Layout) -> bool {
        self.reaches_beyond_links(layout)
    }
    fn reaches(&self, block: usize) -> bool {
        self.reaches_block(block)
    }
    fn link(&mut self, find: &dyn Fn(&[i32; D]) -> Option<usize>, places: &mut Vec<u32>) {
        if self.is_deactivated() {
            (self.nodes_around, self.contributors) = (Vec::new(), Vec::new());
        } else {
            self.link_blocks(find, places);
        }
    }
    fn add_tiles(&self, block: usize, sums: NodeSums, nodes: &mut [Node<T>]) {
        let (around, next) = self.contributors[block * neighbours(D)..].split_at(neighbours(D));
        let around = [around, next];
        // Slots whose tiles the block after the next one sums.
        for &slot in around[1].iter().skip(neighbours(D)).take(neighbours(D)) {
            prefetch_from(&self.slots, slot as usize, 0);
        }
        let facts = self.facts();
        if sums == NodeSums::Force && !facts.maps_force {
            return;
        }
        let two = facts.records() == 2 && !facts.before_forces;
        self.kernels.shape().add_tiles(nodes, &self.slots, around, sums, two);
    }
    fn surface_quantity(
        &self,
        block: usize,
        what: SurfaceQuantity,
        nodes: u64,
        normals: &[[T; 3]],
        out: &mut [[T; 3]],
    ) {
        self.surface_quantity_of(block, what, nodes, normals, out);
    }
    fn near_points(&self, block: usize, nodes: u64, visit: &mut dyn FnMut(u64, &NearPoint<T>)) {
        self.visit_near_points(block, nodes, visit);
    }
    fn each_block(&self, visit: &mut dyn FnMut(&[i32; D], u64)) {
        for slot in self.slots.iter().filter(|slot| !slot.block.is_empty()) {
            visit(&slot.block.coordinates, slot.block.occupied());
        }
    }
    fn count_by_level(&self, counts: &mut [usize]) {
        for slot in &self.slots {
            if let Some(count) = counts.get_mut(self.lattices.level(&slot.block.coordinates)) {
                *count += slot.block.len();
            }
        }
    }
}

impl<T: Float, const D: usize> MeetsSurfaces<D> for ParticleBody<T, D> {
    fn visit_near(
        &self,
        dt: f64,
        reaches: &dyn Fn(&[f64; D], &[f64; D]) -> bool,
        visit: &mut dyn FnMut(&NearParticle<D>, &[NodeWeight<D>]),
    ) {
        if self.is_deactivated() {
            return;
        }
        let centre = self.bin_centre();
        // Particles extend beyond their bins by their size, and by their motion in the step, of less than half a cell: by less than a cell.
        let box_of = |first: &[i32; D], cells: i32| {
            let (lattice, first) = self.lattices.of_node(first);
            let (h, origin) = (lattice.spacing(), lattice.origin());
            let low = std::array::from_fn(|d| origin[d] + h * (f64::from(first[d]) + centre - 1.5));
            let high = std::array::from_fn::<f64, D, _>(|d| low[d] + h * f64::from(cells + 2));
            (low, high)
        };
        let size_of = |numbers: &[T], level: usize, radius: f64| {
            let edges = self.half_edges(numbers, (level, radius));
            let size = (0..D).map(|d| length(edges[d])).product::<f64>().powf(1.0 / D as f64);
            let reach: [f64; D] = std::array::from_fn(|d| edges[..D].iter().map(|edge| edge[d].abs()).sum());
            (size, reach)
        };
        // Constant domains are equal for all particles.
        let carried = self.facts().total || self.facts().domain.carried() || self.levels.is_some();
        let of_all = if carried { None } else { Some(size_of(&[], 0, 0.0)) };
        let (mut numbers, mut weights) = (Vec::new(), Vec::new());
        for slot in self.in_place().filter(|slot| !slot.block.is_empty()) {
            let level = self.lattices.level(&slot.block.coordinates);
            let (low, high) = box_of(&slot.block.bin_coordinates(0), BLOCK as i32);
            if !reaches(&low, &high) {
                continue;
            }
            for bin in 0..block_nodes(D) {
                let coordinates = slot.block.bin_coordinates(bin);
                let (low, high) = box_of(&coordinates, 1);
                let (lattice, plain) = self.lattices.of_node(&coordinates);
                let (h, origin) = (lattice.spacing(), lattice.origin());
                if slot.block.bin_len(bin) == 0 || !reaches(&low, &high) {
                    continue;
                }
                for at in slot.block.bin_places(bin) {
                    let position: [f64; D] = std::array::from_fn(|d| {
                        let cells = f64::from(plain[d]) + centre;
                        origin[d] + h * (cells + slot.block.get(at, Columns::position() + d).to_double())
                    });
                    let velocity: [f64; D] =
                        std::array::from_fn(|d| slot.block.get(at, Columns::velocity(D) + d).to_double());
                    numbers.clear();
                    let (half_size, reach) = of_all.unwrap_or_else(|| {
                        slot.block.read(at, &mut numbers);
                        size_of(&numbers, level, position[0])
                    });
                    // The motion due to nodal accelerations is within the margin.
                    let beside = |d: usize| half_size.max(reach[d]) + BESIDE * h;
                    let low = std::array::from_fn(|d| position[d] + (dt * velocity[d]).min(0.0) - beside(d));
                    let high = std::array::from_fn(|d| position[d] + (dt * velocity[d]).max(0.0) + beside(d));
                    if !reaches(&low, &high) {
                        continue;
                    }
                    self.node_weights(&slot.block, bin, at, &mut weights);
                    let number = slot.block.number(at);
                    if numbers.is_empty() {
                        slot.block.read(at, &mut numbers);
                    }
                    let mass = self.masses.of(&numbers).to_double();
                    visit(&NearParticle { number, position, velocity, half_size, reach, mass }, &weights);
                }
            }
        }
    }
}

/// Margin of the swept boxes of particles near surfaces, in cells.
const BESIDE: f64 = 0.1;

fn length(edge: [f64; 3]) -> f64 {
    edge.iter().map(|x| x * x).sum::<f64>().sqrt()
}
