//! A body of particles of one law in one method.

use std::sync::{Arc, Mutex, PoisonError};

use mpm_materials::{Breakdown, Material};

use super::body::{BodyTrouble, GridBody, Presence, Receives, Steps, Which};

use super::capability::{Deactivation, Division, FreeVelocities, MeetsSurfaces};
use super::crossing::{Crossers, crosses};
use super::load::{Loading, Loads};
use crate::step::between_steps::deactivated::Deactivated;
use crate::step::between_steps::merging::MergeBook;
use crate::step::clients::client::ClientPoint;
use crate::step::nodes::footprint::Footprint;
use crate::step::nodes::layout::Nodes;
use crate::step::nodes::occupancy::{NodeBlocks, Tile};
use crate::step::passes::kernels::{Facts, MethodKernels};
use crate::step::passes::migrate::MigrationPayload;

use crate::dilatation::MeanDilatation;
use crate::dim::{block_nodes, centre, neighbours, offset, shifted};
use crate::grid::{Lattices, Levels};
use crate::particles::{Block, Columns, Masses, Outbox, Sent};
use crate::step::between_steps::rest::TakenMotion;
use crate::step::between_steps::splitting::{SplitBook, Splitter, Splitting};
use crate::step::nodes::wrap::Wrap;
use crate::step::passes::slot::{Common, Commons, Domains, Outline, Report, Scratch, Slot, Task, Trouble};
use crate::step::passes::total;
use impactite_geometry::Lattice;
use impactite_scene::Cause;
use impactite_scene::archive::{Archive, CheckpointError};
use impactite_scene::constants::Constant;
use impactite_scene::error::SceneError;
use impactite_scene::{Body, CentreLead, Totals};
use impactite_simd::{AlignedRecords, Float, Team};

/// Body of particles.
pub struct ParticleBody<T: Float, const D: usize> {
    pub(in crate::step) name: String,
    pub(in crate::step) material: Arc<dyn Material<T>>,
    pub(in crate::step) kernels: Arc<dyn MethodKernels<T, D>>,
    pub(in crate::step) lattice: Lattice<D>,
    /// Lattices of the levels of cells, and the refined blocks, if there are several.
    pub(in crate::step) lattices: Lattices<D>,
    pub(in crate::step) levels: Option<Arc<Levels<D>>>,
    /// Particles that entered blocks of another level in the last pass.
    pub(in crate::step) crossers: Crossers<T, D>,
    /// Number of seeds, and of particles added by splitting at the border of a level.
    pub(in crate::step) numbered: [u64; 2],
    pub(in crate::step) columns: Columns,
    pub(in crate::step) slots: Vec<Slot<T, D>>,
    /// Slots without particles, kept for reuse: a body that moves needs no new memory.
    pub(in crate::step) spare: Vec<Slot<T, D>>,
    /// Coordinates and indices of the linked slots, sorted.
    pub(in crate::step) index: Vec<([i32; D], u32)>,
    /// Coordinates of blocks to create, which particles left for or may soon.
    pub(in crate::step) wanted: Vec<[i32; D]>,
    /// Node block, slot and direction of each link, while links are made.
    pub(in crate::step) links: Vec<(u32, u32, u8)>,
    /// Particles that each slot sent to others in the last pass.
    pub(in crate::step) sent: Vec<Sent>,
    /// Sent particles by thread, stored here between passes.
    pub(in crate::step) outboxes: Vec<Outbox<T>>,
    /// Memory addresses of the slots, for prefetching in a pass.
    pub(in crate::step) outlines: Vec<Outline>,
    /// Scratch memory of each thread.
    pub(in crate::step) scratch: Vec<Mutex<Scratch<T>>>,
    /// Node blocks around each slot, 3^D, x fastest; `NONE` where there is none.
    pub(in crate::step) nodes_around: Vec<u32>,
    /// Slot of each neighbour (3^D, x fastest) of each node block of the body's own list, `NONE` where there is none.
    pub(in crate::step) contributors: Vec<u32>,
    /// Half sizes of the particles in units of h.
    pub(in crate::step) half: [T; 3],
    pub(in crate::step) lightest: T,
    pub(in crate::step) masses: Masses<T>,
    pub(in crate::step) loads: Loads<D>,
    /// Sum of the loaded areas of each traction, m^2.
    pub(in crate::step) loaded_areas: Vec<f64>,
    pub(in crate::step) loading: Loading,
    /// Pass and step sizes of loads that are mapped once the particles are in their bins.
    pub(in crate::step) unloaded: Option<(Which, Steps<T>)>,
    /// Time at which the loads mapped last act, s.
    pub(in crate::step) mapped_at: f64,
    /// Power of the loads of each slot, W, and force of a field, N, before summation.
    pub(in crate::step) powers: Vec<T>,
    pub(in crate::step) forces: Vec<[f64; 3]>,
    /// Parameters, state and books of splitting and merging.
    pub(in crate::step) splitting: Option<Splitting>,
    pub(in crate::step) splitter: Splitter<T>,
    pub(in crate::step) splits: SplitBook,
    pub(in crate::step) merges: MergeBook,
    /// Sound speed at rest, m/s, if the density is renewed from positions.
    pub(in crate::step) renewed: Option<f64>,
    /// Initial positions of the particles, by number, if a force field needs them, m.
    pub(in crate::step) starts: Vec<[f64; D]>,
    /// Values in a lane without a particle.
    pub(in crate::step) dummy: Arc<[T]>,
    /// True if the law bears shear and tension.
    pub(in crate::step) coheres: bool,
    /// Map of its blocks beyond periodic planes.
    pub(in crate::step) wrap: Wrap<D>,
    /// State while the body is deactivated.
    pub(in crate::step) resting: Option<Deactivated<T, D>>,
    /// Lead of its particles over the path of its centre of mass.
    pub(in crate::step) lead: CentreLead,
}

pub(in crate::step) const NONE: u32 = u32::MAX;

impl<T: Float, const D: usize> ParticleBody<T, D> {
    /// Properties of the method besides kernels.
    pub(in crate::step) fn facts(&self) -> &Facts {
        self.kernels.facts()
    }
    /// Offset of the bin centres from the nodes, in units of h.
    pub(in crate::step) fn bin_centre(&self) -> f64 {
        centre(self.facts().nodes)
    }
    /// Storage of the domains of the particles.
    pub(in crate::step) fn domains(&self) -> Domains<T> {
        Domains { column: self.columns.domain(), half: self.half }
    }

    /// Link each slot to its neighbours.
    pub(in crate::step) fn link_slots(&mut self) {
        let (index, levels, here) = (&mut self.index, self.levels.as_deref(), neighbours(D) / 2);
        index.clear();
        index.extend(self.slots.iter().enumerate().map(|(i, s)| (s.block.coordinates, i as u32)));
        index.sort_unstable();
        self.sent.resize(self.slots.len(), Sent::default());
        for slot in &mut self.slots {
            let c = slot.block.coordinates;
            for (n, around) in slot.slots_around.iter_mut().enumerate() {
                let beside = self.wrap.block(shifted(&c, &offset(n)));
                let place = index.binary_search_by_key(&beside, |entry| entry.0);
                *around = place.map_or(NONE, |place| index[place].1);
                // Particles enter and leave blocks of another level on their own way.
                if levels.is_some() && [n, here].iter().any(|&to| crosses(levels, &c, to).is_some()) {
                    *around = NONE;
                }
            }
        }
    }

    /// Iterate over the slots in the order of their coordinates, which is that of sums: the order of creation depends
    /// on when blocks were arranged.
    pub(in crate::step) fn in_place(&self) -> impl Iterator<Item = &Slot<T, D>> {
        self.index.iter().map(|&(_, slot)| &self.slots[slot as usize])
    }

    /// Parameters of a pass for the blocks of each level of cells.
    pub(super) fn common(&self, steps: Steps<T>) -> Commons<T> {
        let count = self.levels.as_ref().map_or(1, |levels| levels.count());
        let finer = (1..count).map(|level| self.common_on(steps, level)).collect();
        Commons { coarsest: self.common_on(steps, 0), finer }
    }

    fn common_on(&self, steps: Steps<T>, level: usize) -> Common<T> {
        let lattice = if level == 0 { self.lattice } else { self.lattices.of(level) };
        Common {
            dt: steps.this,
            next_dt: steps.next,
            speeds: steps.adapt,
            spacing: T::of(lattice.spacing()),
            origin: T::of(lattice.origin()[0]),
            density: self.material.density(),
            mean: self.facts().mean || self.renewed.is_some(),
            mean_return: T::of(if self.renewed.is_some() { 0.0 } else { MeanDilatation::RETURN }),
            domains: self.domains(),
            masses: self.masses,
            frame: self.columns.frame(),
            splitter: self.splitter,
        }
    }

    /// Allocate scratch memory for each thread.
    pub(super) fn have_scratch(&mut self, team: &Team) {
        for number in self.scratch.len()..team.threads() {
            self.scratch.push(Mutex::new(Scratch::new(number)));
            self.outboxes.push(Outbox::default());
        }
    }

    /// Make one pass over the particles.
    pub(in crate::step) fn sweep(
        &mut self,
        which: Which,
        nodes: Nodes<'_, T>,
        dt: Steps<T>,
        team: &Team,
    ) -> Result<T, BodyTrouble> {
        let does = self.kernels.does(which);
        if self.loads.act() {
            // At the start nothing has moved yet.
            if does.velocity && which != Which::Refit {
                self.book_loads(nodes, which, dt, team);
            }
            if does.force {
                self.accelerate(dt.force_time, team);
                self.mapped_at = dt.force_time;
            }
        }
        // Opened before any pass that changes velocities: MUSL updates velocities before positions.
        if self.lead.is_closed() {
            let totals = Body::totals(self);
            self.lead.open(totals.mass, totals.momentum);
        }
        self.have_scratch(team);
        let payload = MigrationPayload::of::<D>(self.kernels.maps(which), self.splitter.is_on()).count();
        self.outboxes.iter_mut().for_each(|outbox| outbox.clear(self.columns.count() + payload));
        self.hand_outboxes();
        let common = &self.common(dt);
        let (material, kernels, dummy) = (&*self.material, &*self.kernels, &self.dummy[..]);
        let lattices = self.lattices;
        self.outlines.clear();
        self.outlines.extend(self.slots.iter().map(Outline::of));
        let (nodes_around, scratch, outlines) = (&self.nodes_around, &self.scratch, &self.outlines);
        team.each_piece(&mut self.slots, 1, &mut self.sent, |s, slot, sent| {
            let slot = &mut slot[0];
            let scratch = &mut *team.own(scratch);
            let (here, ahead) = nodes_around[s * neighbours(D)..].split_at(neighbours(D));
            let around = [here, &ahead[..neighbours(D).min(ahead.len())]];
            let next = outlines.get(s + 1);
            let common = common.of(lattices.level(&slot.block.coordinates));
            kernels.sweep(which, Task { material, nodes, around, slot, next, sent, dummy, scratch, common });
        });
        self.hand_outboxes();
        let (mut rate, mut moments) = (T::default(), [0.0; 4]);
        for &(_, slot) in &self.index {
            let slot = &self.slots[slot as usize];
            self.splits.cuts += u64::from(slot.report.splits);
            self.splits.kinetic += slot.report.revealed.to_double();
            // Particles that leave for smaller cells are faster across them.
            let smaller = if slot.evacuated { T::of(2.0) } else { T::of(1.0) };
            rate = rate.max(slot.report.rate * smaller);
            (0..4).for_each(|k| moments[k] += slot.report.moments[k].to_double());
            if let Some(trouble) = slot.report.trouble {
                return Err(self.describe(slot, &trouble));
            }
        }
        if does.moves {
            self.lead.step(moments, dt.this.to_double(), dt.force);
        }
        if self.loads.act() && does.force {
            if does.moves {
                self.unloaded = Some((which, dt));
            } else {
                self.map_loads(which, dt, team);
            }
        }
        Ok(rate)
    }

    /// Move the outboxes to the threads for a pass, or back.
    fn hand_outboxes(&mut self) {
        for (scratch, outbox) in self.scratch.iter_mut().zip(&mut self.outboxes) {
            let scratch = scratch.get_mut().unwrap_or_else(PoisonError::into_inner);
            std::mem::swap(scratch.out(), outbox);
        }
    }

    /// Describe the failed particle: its position, or the centre of its bin if it is in transit to another or its
    /// position is not finite. A volume that is not a number is not reported as inverted.
    fn describe(&self, slot: &Slot<T, D>, trouble: &Trouble) -> BodyTrouble {
        let Trouble { bin, particle, cause } = *trouble;
        let staying = slot
            .block
            .bin_places(bin)
            .map(|place| self.particle(&slot.block, bin, place))
            .find(|p| p.number == particle);
        let nowhere = staying.as_ref().is_some_and(|p| p.volume.is_nan());
        let inverted = cause == Cause::Law(Breakdown::InvertedVolume);
        let cause = if inverted && nowhere { Cause::Law(Breakdown::NotFinite) } else { cause };
        let position = staying.filter(|p| p.position.iter().all(|x| x.is_finite())).map_or_else(
            || {
                let mut x = [0.0; 3];
                let (lattice, coordinates) = self.lattices.of_node(&slot.block.bin_coordinates(bin));
                for d in 0..D {
                    let cells = f64::from(coordinates[d]) + self.bin_centre();
                    x[d] = lattice.origin()[d] + cells * lattice.spacing();
                }
                x
            },
            |p| p.position,
        );
        BodyTrouble { particle, position, cause }
    }

    fn take_in(&mut self, which: Which, team: &Team) {
        if !self.kernels.does(which).moves || self.facts().total {
            return;
        }
        let common = &self.common(Steps {
            this: T::default(),
            next: T::default(),
            adapt: false,
            force_time: 0.0,
            force: [0.0; 3],
        });
        let (kernels, sent, outboxes, lattices) = (&*self.kernels, &self.sent, &self.outboxes, self.lattices);
        let maps = kernels.maps(which);
        let payload = &MigrationPayload::of::<D>(maps, self.splitter.is_on());
        team.each(&mut self.slots, |_, slot| {
            let Slot { block, tile, rows, slots_around, affine, .. } = slot;
            let common = common.of(lattices.level(&block.coordinates));
            for (from, &s) in slots_around.iter().enumerate() {
                // The slot in direction `from` sent particles in the opposite direction. Particles that stayed were
                // stored by their own pass.
                let to = neighbours(D) - 1 - from;
                if from != to
                    && let Some(sent) = sent.get(s as usize).filter(|sent| sent.goes(to))
                {
                    let outbox = &outboxes[sent.outbox as usize];
                    let sums = (tile.all_mut(), &mut *rows, &mut affine[..]);
                    kernels.shape().take_in(block, sums, (outbox, *sent, to), common, (maps, payload));
                }
            }
            block.tidy();
        });
        self.take_in_crossers(common, payload, maps);
    }

    /// Implement [`GridBody::locate`].
    pub(in crate::step) fn locate_after(&mut self, which: Which, prune: bool, team: &Team) -> bool {
        let payload = MigrationPayload::of::<D>(self.kernels.maps(which), self.splitter.is_on());
        let mut changed = self.make_blocks(&payload);
        if changed {
            self.link_slots();
        }
        self.take_in(which, team);
        if let Some((which, dt)) = self.unloaded.take() {
            self.map_loads(which, dt, team);
        }
        if self.levels.is_some() {
            self.slots.iter_mut().for_each(|slot| slot.evacuated = false);
        }
        if prune && self.slots.iter().any(|s| s.block.is_empty()) {
            // A block without particles contains no contributions: particles that left map where they arrive.
            self.spare.extend(self.slots.extract_if(.., |s| s.block.is_empty()));
            self.link_slots();
            changed = true;
        }
        changed
    }

    /// Create the missing blocks that particles left for.
    fn make_blocks(&mut self, payload: &MigrationPayload) -> bool {
        let mut wanted = std::mem::take(&mut self.wanted);
        wanted.clear();
        if self.levels.is_some() {
            self.find_crossers(payload, &mut wanted);
        }
        let levels = self.levels.as_deref();
        for (slot, sent) in self.slots.iter().zip(&self.sent) {
            let mut directions = sent.directions;
            while directions != 0 {
                let to = directions.trailing_zeros() as usize;
                directions &= directions - 1;
                if slot.slots_around[to] == NONE
                    && !slot.evacuated
                    && crosses(levels, &slot.block.coordinates, to).is_none()
                {
                    wanted.push(self.wrap.block(shifted(&slot.block.coordinates, &offset(to))));
                }
            }
        }
        let made = self.make_slots(&mut wanted);
        self.wanted = wanted;
        made
    }

    /// Create empty slots at these coordinates, without links. Return true if there were any.
    pub(in crate::step) fn make_slots(&mut self, wanted: &mut Vec<[i32; D]>) -> bool {
        wanted.sort_unstable();
        wanted.dedup();
        for &c in &*wanted {
            let slot = match self.spare.pop() {
                Some(mut slot) => {
                    slot.block.place_at(c);
                    self.set_border(&mut slot);
                    slot.evacuated = false;
                    slot.rows = 0;
                    slot.report = Report::default();
                    slot
                }
                None => self.empty_slot(c),
            };
            self.slots.push(slot);
        }
        !wanted.is_empty()
    }

    pub(in crate::step) fn empty_slot(&self, coordinates: [i32; D]) -> Slot<T, D> {
        let mut slot = Slot {
            block: Block::new(coordinates, &self.columns, self.dummy.clone()),
            tile: AlignedRecords::zeros(self.tile_records()),
            rows: 0,
            slots_around: vec![NONE; neighbours(D)],
            linked: 0,
            report: Report::default(),
            affine: Vec::new(),
            border: 0,
            evacuated: false,
        };
        self.set_border(&mut slot);
        slot
    }

    /// Number of records in the tile of a slot: one or two per node.
    pub(in crate::step) fn tile_records(&self) -> usize {
        self.facts().tile_nodes(D) * self.facts().records()
    }
}

impl<T: Float, const D: usize> GridBody<T, D> for ParticleBody<T, D> {
    fn constants(&self, times: [f64; 2]) -> Vec<Constant> {
        self.constants_at(times)
    }
    fn embedding(&self) -> &'static str {
        self.facts().embedding
    }
    fn half_size(&self) -> [f64; D] {
        std::array::from_fn(|d| self.half[d].to_double() * self.lattice.spacing())
    }
    fn lightest(&self) -> T {
        self.lightest
    }
    fn presence(&self) -> &dyn Presence<T, D> {
        self
    }
    fn presence_mut(&mut self) -> &mut dyn Presence<T, D> {
        self
    }
    fn receiver(&mut self) -> Option<&mut dyn Receives<T, D>> {
        Some(self)
    }
    fn meets_surfaces(&self) -> Option<&dyn MeetsSurfaces<D>> {
        Some(self)
    }
    fn deactivation(&self) -> Option<&dyn Deactivation<T, D>> {
        Some(self)
    }
    fn deactivation_mut(&mut self) -> Option<&mut dyn Deactivation<T, D>> {
        Some(self)
    }
    fn division(&self) -> Option<&dyn Division> {
        Some(self)
    }
    fn renewed(&self) -> Option<f64> {
        self.renewed.filter(|_| self.resting.is_none())
    }
    fn density_tiles(&self, team: &Team) -> Vec<Tile<D>> {
        ParticleBody::density_tiles(self, team)
    }
    fn take_density(
        &mut self,
        nodes: &NodeBlocks<D>,
        fits: &[[f64; 4]],
        errors: &[[f64; 2]],
        rate: f64,
        team: &Team,
    ) -> f64 {
        ParticleBody::take_density(self, nodes, fits, errors, rate, team)
    }
    fn division_mut(&mut self) -> Option<&mut dyn Division> {
        Some(self)
    }
    fn free_velocities(&mut self) -> Option<&mut dyn FreeVelocities<T>> {
        Some(self)
    }

    fn rate(&self, spacing: f64) -> T {
        let mut fastest = T::default();
        for slot in &self.slots {
            let halvings = self.lattices.level(&slot.block.coordinates) as i32;
            let (h, per_cell) = (spacing * 0.5f64.powi(halvings), T::of(2f64.powi(halvings)));
            for (_, at) in slot.block.places() {
                let numbers = self.numbers(&slot.block, at);
                let mut square = T::default();
                for d in 0..D {
                    square += numbers[Columns::velocity(D) + d] * numbers[Columns::velocity(D) + d];
                }
                let speed = self.material.step_speed(self.state_of(&numbers), T::of(h));
                let Some(speed) = speed else { continue };
                if self.facts().total {
                    let f = total::gradient::<T, D>(&numbers[self.columns.frame()..], self.facts().hoop);
                    let stretch: T = total::stretch(&total::inverse::<T::Single, D>(&f)).into();
                    fastest = fastest.max(speed * stretch);
                } else {
                    fastest = fastest.max((speed + square.sqrt()) * per_cell);
                }
            }
        }
        fastest / T::of(spacing)
    }
    fn pass(
        &mut self,
        which: Which,
        nodes: Nodes<'_, T>,
        dt: Steps<T>,
        team: &Team,
    ) -> Result<T, BodyTrouble> {
        // FMPM of order 1 has no smoothing pass, and a transfer without an affine field no refit.
        let idle = match which {
            Which::Smooth => self.facts().order < 2,
            Which::Refit => !self.facts().affine,
            _ => false,
        };
        if idle {
            return Ok(T::default());
        }
        if let Some(resting) = &self.resting {
            return Ok(resting.rate(which, dt.adapt));
        }
        self.sweep(which, nodes, dt, team)
    }
    fn loading(&self) -> Loading {
        self.loading
    }
    fn locate(&mut self, which: Which, prune: bool, team: &Team) -> bool {
        !self.is_deactivated() && self.locate_after(which, prune, team)
    }
    fn totals_on(&self, team: &Team, parts: &mut Vec<Totals>) -> Totals {
        parts.clear();
        parts.resize(self.index.len(), Totals::default());
        team.each(parts, |n, part| *part = self.totals_of(&self.slots[self.index[n].1 as usize]));
        parts.iter().fold(Totals::default(), |sum, part| sum.plus(part))
    }
    fn coheres(&self) -> bool {
        self.coheres
    }
    fn set_levels(&mut self, levels: &Arc<Levels<D>>) {
        self.change_levels(levels);
    }
    fn each_block_above(&self, state: &str, least: f64, team: &Team, visit: &mut dyn FnMut(&[i32; D])) {
        self.blocks_above(state, least, team, visit);
    }
    fn particle_bytes(&self) -> usize {
        self.columns.bytes::<T>()
    }
    fn archive(&mut self, file: &mut Archive) -> Result<(), CheckpointError> {
        self.exchange_particles(file)
    }
    fn footprints(&self, time: f64, visit: &mut dyn FnMut(&Footprint<'_, D>)) {
        self.show_footprints(time, visit);
    }
}

const _: () = assert!(block_nodes(3) <= u8::MAX as usize + 1, "bins are numbered by bytes");

impl<T: Float, const D: usize> Deactivation<T, D> for ParticleBody<T, D> {
    fn deactivate(&mut self, longest: T, team: &Team) -> Result<(), SceneError> {
        self.deactivate_particles(longest, team)
    }
    fn reactivate(&mut self, team: &Team) {
        self.reactivate_particles(team);
    }
    fn blocks(&self) -> Option<&[[i32; D]]> {
        self.resting.as_ref().map(Deactivated::blocks)
    }
}

impl<T: Float, const D: usize> Division for ParticleBody<T, D> {
    fn splits(&self) -> SplitBook {
        self.splits
    }
    fn merges(&self) -> Option<MergeBook> {
        self.splitting?.merging().map(|_| self.merges)
    }
    fn merge(&mut self, steps: u64, team: &Team) -> bool {
        self.merge_cells(steps, team)
    }
}

impl<T: Float, const D: usize> FreeVelocities<T> for ParticleBody<T, D> {
    fn each_velocity(&mut self, visit: &mut dyn FnMut(usize, &mut [T; 3])) {
        self.show_velocities(visit);
    }
    fn place(&self, numbers: &mut Vec<T>, points: &mut [ClientPoint]) {
        self.place_of_particles(numbers, points);
    }
    fn stop_motion(&mut self) -> TakenMotion {
        let mut sum = TakenMotion::default();
        for &(_, slot) in &self.index {
            let slot = &mut self.slots[slot as usize];
            let part = slot.block.motion(self.masses);
            sum.kinetic += part.kinetic;
            for d in 0..3 {
                sum.momentum[d] += part.momentum[d];
            }
            slot.block.stop();
        }
        sum
    }
    fn filter(&mut self, team: &Team) -> f64 {
        if self.is_deactivated() { 0.0 } else { self.filter_cells(team) }
    }
}
