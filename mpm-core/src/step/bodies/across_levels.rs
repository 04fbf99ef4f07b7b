//! Particles of a body that enter blocks of another level of cells.
//!
//! A particle leaves its block by the outbox of the pass, with the contributions that it maps to its next nodes. If the next
//! block is of another level, these contributions are expressed in the cells of that level. A particle that enters smaller
//! cells is first divided along every axis, so that cells of the finer level have particles of their size.

use super::crossing::Crossers;
use super::particle_body::ParticleBody;
use crate::dim::{block_of, neighbours, node_of, offset, shifted};
use crate::grid::Levels;
use crate::grid::levels::{Crossing, pack, unpack_block};
use crate::particles::{Columns, Masses, Outbox, Sent};
use crate::step::passes::migrate::MigrationPayload;
use crate::step::passes::slot::{Commons, Slot};
use crate::step::passes::spread::Maps;
use impactite_simd::{Float, Team};
use std::sync::Arc;

/// Size of a particle, over that of the seeds in the cells of its level, above which it is divided in a finer level.
const DIVIDED_FROM: f64 = 0.75;

/// Place of a particle in the cells of a level: bin, and offset from its centre.
struct At<T, const D: usize> {
    level: usize,
    bin: [i32; D],
    xi: [T; D],
}

impl<T: Float, const D: usize> ParticleBody<T, D> {
    /// Set the bins of a block at the border of a level, and the memory for their affine momentum.
    pub(in crate::step) fn set_border(&self, slot: &mut Slot<T, D>) {
        let Some(levels) = &self.levels else { return };
        let (level, block) = unpack_block(&slot.block.coordinates);
        slot.border = levels.bins_at_border(level, &block);
        let nodes = if slot.border != 0 { self.facts().tile_nodes(D) } else { 0 };
        slot.affine.clear();
        slot.affine.resize(D * nodes, [T::default(); 4]);
    }

    /// Size of a particle of this mass over that of the seeds in the cells of a level. In an axisymmetric body its distance to
    /// the axis is `radius`, m.
    pub(in crate::step) fn relative_size(&self, mass: T, level: usize, radius: f64) -> f64 {
        let h = self.lattice.spacing() * 0.5f64.powi(level as i32);
        let mut seed: f64 = (0..D).map(|d| 2.0 * self.half[d].to_double() * h).product();
        if self.facts().hoop {
            seed *= radius.abs().max(1e-6 * h);
        }
        (mass.to_double() / (self.material.density().to_double() * seed)).powf(1.0 / D as f64)
    }

    /// Change the cells of blocks: their particles leave them in the next pass.
    pub(super) fn change_levels(&mut self, levels: &Arc<Levels<D>>) {
        (self.lattices, self.levels) = (levels.lattices(), Some(levels.clone()));
        let mut slots = std::mem::take(&mut self.slots);
        for slot in &mut slots {
            let (level, block) = unpack_block(&slot.block.coordinates);
            slot.evacuated = levels.crossing(level, &block).is_some();
            self.set_border(slot);
        }
        self.slots = slots;
        self.link_slots();
    }

    /// Call `visit` for every block with a particle whose state variable `state` is `least` or more, in the order of blocks.
    pub(super) fn blocks_above(
        &self,
        state: &str,
        least: f64,
        team: &Team,
        visit: &mut dyn FnMut(&[i32; D]),
    ) {
        let Some(column) = self.columns.state_names().iter().position(|name| name == state) else { return };
        let mut above = vec![false; self.index.len()];
        team.each(&mut above, |n, above| {
            let block = &self.slots[self.index[n].1 as usize].block;
            let row = Columns::state(D) + column;
            *above = block.places().any(|(_, at)| block.get(at, row).to_double() >= least);
        });
        for (_, (block, _)) in above.iter().zip(&self.index).filter(|(above, _)| **above) {
            visit(block);
        }
    }

    /// Collect the particles that entered blocks of another level in the last pass, and append the missing ones of these
    /// blocks to `wanted`.
    pub(super) fn find_crossers(&mut self, payload: &MigrationPayload, wanted: &mut Vec<[i32; D]>) {
        let Some(levels) = self.levels.clone() else { return };
        let mut crossers = std::mem::take(&mut self.crossers);
        crossers.list.clear();
        let index = std::mem::take(&mut self.index);
        for &(coordinates, s) in &index {
            let (sent, (level, block)) = (self.sent[s as usize], unpack_block(&coordinates));
            let evacuated = self.slots[s as usize].evacuated;
            for to in (0..neighbours(D)).filter(|to| sent.goes(*to)) {
                let beside = shifted(&block, &offset(to));
                if evacuated || levels.crossing(level, &beside).is_some() {
                    self.cross(&levels, (level, &beside), (sent, to), payload, &mut crossers);
                }
            }
        }
        // Stable: particles of a block remain in the order of their sources.
        crossers.list.sort_by_key(|(block, ..)| *block);
        let missing = |block: &[i32; D]| index.binary_search_by_key(block, |entry| entry.0).is_err();
        wanted.extend(crossers.list.iter().map(|(block, ..)| *block).filter(missing));
        (self.index, self.crossers) = (index, crossers);
    }

    /// Convert the particles that a block sent to a block of another level.
    fn cross(
        &mut self,
        levels: &Levels<D>,
        (level, block): (usize, &[i32; D]),
        (sent, to): (Sent, usize),
        payload: &MigrationPayload,
        crossers: &mut Crossers<T, D>,
    ) {
        let outboxes = std::mem::take(&mut self.outboxes);
        for (bin, numbers) in outboxes[sent.outbox as usize].going(sent, to) {
            let bin = node_of(block, bin);
            let xi = std::array::from_fn(|d| numbers[Columns::position() + d]);
            let at = At { level, bin, xi };
            let mass = self.masses.of(numbers);
            let finer = levels.crossing(level, block) == Some(Crossing::Finer);
            let radius = self.radius(&at);
            if finer && self.relative_size(mass, level, radius) > DIVIDED_FROM {
                self.divide(levels, (&at, radius), numbers, payload, crossers);
            } else {
                crossers.list.push(convert(levels, at, numbers.to_vec(), payload));
            }
        }
        self.outboxes = outboxes;
    }

    /// First coordinate of a place, m.
    fn radius(&self, at: &At<T, D>) -> f64 {
        let lattice = self.lattices.of(at.level);
        lattice.origin()[0]
            + lattice.spacing() * (f64::from(at.bin[0]) + self.bin_centre() + at.xi[0].to_double())
    }

    /// Divide a particle along every axis, in an axisymmetric body by the volumes of its parts. The parts move with its affine
    /// velocity field, so that momentum and angular momentum are those of the particle; the kinetic energy of their motion
    /// relative to its centre is booked.
    fn divide(
        &mut self,
        levels: &Levels<D>,
        (at, radius): (&At<T, D>, f64),
        numbers: &[T],
        payload: &MigrationPayload,
        crossers: &mut Crossers<T, D>,
    ) {
        let (columns, equal) = (self.columns.count(), T::of(0.5f64.powi(D as i32)));
        let mass = self.masses.of(numbers);
        let affine = payload.affine_of(&numbers[columns..]);
        let seeds = self.numbered[0].max(1);
        let number = numbers[self.columns.number()].to_double() as u64;
        let mut gained = T::default();
        // Half of the distance between the parts over the distance to the axis, and the centre of mass of the parts.
        let curved = if self.facts().hoop && radius != 0.0 {
            T::of(
                (0.5 * self.half[0].to_double() * self.lattices.of(at.level).spacing() / radius)
                    .clamp(-0.9, 0.9),
            )
        } else {
            T::default()
        };
        let mut centre = [T::default(); D];
        centre[0] = -(curved * T::of(0.5) * self.half[0]);
        for n in 0..1usize << D {
            let mut part = numbers.to_vec();
            let parts = equal * (T::of(1.0) + if n & 1 == 0 { -curved } else { curved });
            payload.change_cells::<T, D>(&mut part[columns..], &centre, T::of(1.0));
            part[columns..].iter_mut().for_each(|x| *x *= parts);
            if let Masses::Each(row) = self.masses {
                part[row] = mass * parts;
            }
            let areas = self.loads.rows(self.columns.load()).areas;
            part[areas[0]..areas[1]].iter_mut().for_each(|x| *x *= parts);
            let mut xi = at.xi;
            for d in 0..D {
                let sign = T::of(if n >> d & 1 == 0 { -0.5 } else { 0.5 });
                let way = sign * self.half[d];
                xi[d] += way;
                for c in 0..D {
                    part[Columns::velocity(D) + c] += affine[d][c] / mass * (way + centre[d]);
                }
            }
            for c in 0..D {
                let more = part[Columns::velocity(D) + c] - numbers[Columns::velocity(D) + c];
                gained += T::of(0.5) * mass * parts * more * more;
            }
            if n > 0 {
                self.numbered[1] += 1;
                part[self.columns.number()] = T::of((number % seeds + seeds * self.numbered[1]) as f64);
            }
            crossers.list.push(convert(levels, At { xi, ..*at }, part, payload));
        }
        self.splits.cuts += 1;
        self.splits.kinetic += gained.to_double();
    }

    /// Insert the particles that entered blocks of another level, and add their contributions.
    pub(super) fn take_in_crossers(&mut self, common: &Commons<T>, payload: &MigrationPayload, maps: Maps) {
        let crossers = std::mem::take(&mut self.crossers);
        let mut outbox = Outbox::default();
        for same in crossers.list.chunk_by(|a, b| a.0 == b.0) {
            let block = same[0].0;
            let Ok(place) = self.index.binary_search_by_key(&block, |entry| entry.0) else {
                debug_assert!(false, "the block was made when its particles were found");
                continue;
            };
            outbox.clear(self.columns.count() + payload.count());
            for (_, bin, numbers) in same {
                outbox.post(0, *bin).copy_from_slice(numbers);
            }
            let common = common.of(self.lattices.level(&block));
            let Slot { block, tile, rows, affine, .. } = &mut self.slots[self.index[place].1 as usize];
            let sums = (tile.all_mut(), &mut *rows, &mut affine[..]);
            let from = (&outbox, outbox.since(0, 0), 0);
            self.kernels.shape().take_in(block, sums, from, common, (maps, payload));
            block.tidy();
        }
        self.crossers = Crossers::default();
    }
}

/// Express a particle in the cells of the level of its place: block, bin, values and contributions.
fn convert<T: Float, const D: usize>(
    levels: &Levels<D>,
    mut at: At<T, D>,
    mut numbers: Vec<T>,
    payload: &MigrationPayload,
) -> ([i32; D], usize, Vec<T>) {
    let first = numbers.len() - payload.count();
    // The part of a divided particle may be in another bin.
    let mut turn = [T::default(); D];
    for d in 0..D {
        let cells = (at.xi[d] + T::of(0.5)).floor();
        turn[d] = cells;
        at.bin[d] += cells.to_double() as i32;
        at.xi[d] -= cells;
    }
    payload.change_cells::<T, D>(&mut numbers[first..], &turn, T::of(1.0));
    match levels.crossing(at.level, &block_of(&at.bin).0) {
        Some(Crossing::Finer) => {
            for d in 0..D {
                let upper = at.xi[d] >= T::default();
                turn[d] = T::of(if upper { 0.25 } else { -0.25 });
                at.bin[d] = 2 * at.bin[d] + i32::from(upper);
                at.xi[d] = T::of(2.0) * (at.xi[d] - turn[d]);
            }
            payload.change_cells::<T, D>(&mut numbers[first..], &turn, T::of(2.0));
            at.level += 1;
        }
        Some(Crossing::Coarser) => {
            for d in 0..D {
                turn[d] = T::of(if at.bin[d].rem_euclid(2) == 0 { 0.5 } else { -0.5 });
                at.bin[d] = at.bin[d].div_euclid(2);
                at.xi[d] = T::of(0.5) * (at.xi[d] - turn[d]);
            }
            payload.change_cells::<T, D>(&mut numbers[first..], &turn, T::of(0.5));
            at.level -= 1;
        }
        None => {}
    }
    numbers[Columns::position()..][..D].copy_from_slice(&at.xi);
    let (block, bin) = block_of(&at.bin);
    (pack(at.level, block), bin, numbers)
}
