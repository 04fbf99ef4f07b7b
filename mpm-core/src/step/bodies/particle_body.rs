//! A body of particles of one law in one method.

use std::sync::{Arc, Mutex, PoisonError};

use mpm_materials::{Breakdown, Material};

use super::body::{BodyTrouble, GridBody, Presence, Receives, Steps, Which};
use super::capability::{Deactivation, Division, FreeVelocities, MeetsSurfaces};
use super::load::{Loading, Loads};
use crate::step::between_steps::deactivated::Deactivated;
use crate::step::between_steps::merging::MergeBook;
use crate::step::clients::client::ClientPoint;
use crate::step::nodes::footprint::Footprint;
use crate::step::nodes::layout::{Layout, Nodes};
use crate::step::passes::kernels::{Facts, MethodKernels};
use crate::step::passes::loads::LoadTask;
use crate::step::passes::migrate::MigrationPayload;

use crate::dim::{block_nodes, centre, neighbours, offset, shifted};
use crate::particles::{Block, Columns, Masses, Outbox, Place, Sent};
use crate::step::between_steps::rest::TakenMotion;
use crate::step::between_steps::splitting::{SplitBook, Splitter, Splitting};
use crate::step::nodes::wrap::Wrap;
use crate::step::passes::slot::{Common, Domains, Outline, Report, Scratch, Slot, Task, Trouble};
use crate::step::passes::spread::Maps;
use crate::step::passes::total;
use impactite_geometry::Lattice;
use impactite_scene::Cause;
use impactite_scene::archive::{Archive, CheckpointError};
use impactite_scene::constants::Constant;
use impactite_scene::error::SceneError;
use impactite_scene::{Body, CentreLead, Parts, PointView, Totals};
use impactite_simd::{AlignedRecords, Float, Team};

/// A body of particles.
pub struct ParticleBody<T: Float, const D: usize> {
    pub(in crate::step) name: String,
    pub(in crate::step) material: Arc<dyn Material<T>>,
    pub(in crate::step) kernels: Arc<dyn MethodKernels<T, D>>,
    pub(in crate::step) lattice: Lattice<D>,
    pub(in crate::step) columns: Columns,
    pub(in crate::step) slots: Vec<Slot<T, D>>,
    /// Slots without particles, kept for the next ones: a body that moves needs no new memory.
    pub(in crate::step) spare: Vec<Slot<T, D>>,
    /// Slots by coordinates, while they are linked.
    pub(in crate::step) index: Vec<([i32; D], u32)>,
    /// Places that particles left for, or may soon, while blocks are made.
    pub(in crate::step) wanted: Vec<[i32; D]>,
    /// Node block, slot and direction of each link, while they are made.
    pub(in crate::step) links: Vec<(u32, u32, u8)>,
    /// What each slot sent to others in the last pass.
    pub(in crate::step) sent: Vec<Sent>,
    /// The particles sent, by thread: here between passes.
    pub(in crate::step) outboxes: Vec<Outbox<T>>,
    /// Where the slots' memory lies, for a pass.
    pub(in crate::step) outlines: Vec<Outline>,
    /// Memory of each thread.
    pub(in crate::step) scratch: Vec<Mutex<Scratch<T>>>,
    /// Blocks of nodes around each slot, 3^D, x fastest; `NONE` where there is none.
    pub(in crate::step) nodes_around: Vec<u32>,
    /// Slot of each neighbour (3^D, x fastest) of each node block of the body's own list, `NONE` where there is
    /// none.
    pub(in crate::step) contributors: Vec<u32>,
    /// Half sizes of the particles in units of h.
    pub(in crate::step) half: [T; 3],
    pub(in crate::step) lightest: T,
    pub(in crate::step) masses: Masses<T>,
    pub(in crate::step) loads: Loads<D>,
    /// Sum of the areas that each traction loads, m^2.
    pub(in crate::step) loaded_areas: Vec<f64>,
    pub(in crate::step) loading: Loading,
    /// The steps of a pass whose loads are to be mapped when its particles are where they belong.
    pub(in crate::step) unloaded: Option<(Which, Steps<T>)>,
    /// Time at which the loads act that were mapped last, s.
    pub(in crate::step) mapped_at: f64,
    /// Of each slot, the power of its loads, W, and the force of a field, N, while they are summed up.
    pub(in crate::step) powers: Vec<T>,
    pub(in crate::step) forces: Vec<[f64; 3]>,
    /// When particles are split, and how often they were.
    pub(in crate::step) splitting: Option<Splitting>,
    pub(in crate::step) splitter: Splitter<T>,
    pub(in crate::step) splits: SplitBook,
    pub(in crate::step) merges: MergeBook,
    /// Where the particles started, by number, if a force field asks for it, m.
    pub(in crate::step) starts: Vec<[f64; D]>,
    /// What a lane without a particle holds.
    pub(in crate::step) dummy: Arc<[T]>,
    /// Does the law bear shear and tension?
    pub(in crate::step) coheres: bool,
    /// Where its blocks are found beyond periodic planes.
    pub(in crate::step) wrap: Wrap<D>,
    /// While it rests.
    pub(in crate::step) resting: Option<Deactivated<T, D>>,
    /// Lead of its particles over the path of its centre of mass.
    pub(in crate::step) lead: CentreLead,
}

pub(in crate::step) const NONE: u32 = u32::MAX;

impl<T: Float, const D: usize> ParticleBody<T, D> {
    /// What its method is beside kernels.
    pub(in crate::step) fn facts(&self) -> &Facts {
        self.kernels.facts()
    }
    /// Where bins' centres lie between the nodes, in units of h.
    pub(in crate::step) fn bin_centre(&self) -> f64 {
        centre(self.facts().nodes)
    }
    /// Where its particles' domains come from.
    pub(in crate::step) fn domains(&self) -> Domains<T> {
        Domains { column: self.columns.domain(), half: self.half }
    }

    /// Note which slots lie around each.
    pub(in crate::step) fn link_slots(&mut self) {
        let index = &mut self.index;
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
            }
        }
    }

    /// Slots in the order of their places, which is that of sums: the order in which they were made is a matter of when
    /// blocks were arranged.
    pub(in crate::step) fn in_place(&self) -> impl Iterator<Item = &Slot<T, D>> {
        self.index.iter().map(|&(_, slot)| &self.slots[slot as usize])
    }

    /// Give every particle the acceleration of a force field at a time, s, and note the force of all loads then.
    fn accelerate(&mut self, time: f64, team: &Team) {
        self.loading.force = [0.0; 3];
        for (traction, area) in self.loads.tractions(time).zip(&self.loaded_areas) {
            (0..3).for_each(|d| self.loading.force[d] += traction[d] * area);
        }
        let Some(field) = &self.loads.field else { return };
        let (starts, columns, masses) = (&self.starts, &self.columns, self.masses);
        let Some(first) = self.loads.rows(columns.load()).acceleration else { return };
        let mut forces = std::mem::take(&mut self.forces);
        forces.clear();
        forces.resize(self.slots.len(), [0.0; 3]);
        team.each_piece(&mut self.slots, 1, &mut forces, |_, slot, force| {
            let block = &mut slot[0].block;
            for bin in 0..block_nodes(D) {
                let mut next = block.last_group(bin);
                while let Some((group, here)) = next {
                    next = block.group_before(group);
                    for lane in 0..here as u32 {
                        let at = Place { group, lane };
                        // Children of a particle that was split are told by their seed.
                        let a = (field.acceleration)(&starts[block.number(at) % starts.len()], time);
                        let mass = masses.read(|row| block.get(at, row)).to_double();
                        for d in 0..D {
                            block.set(at, first + d, T::of(a[d]));
                            force[d] += mass * a[d];
                        }
                    }
                }
            }
        });
        for &(_, slot) in &self.index {
            for d in 0..3 {
                self.loading.force[d] += forces[slot as usize][d];
            }
        }
        self.forces = forces;
    }

    /// `task` on the loads of every slot, with the sum of what it returns.
    pub(in crate::step) fn each_load(
        &mut self,
        nodes: Nodes<'_, T>,
        maps: Maps,
        (time, dt): (f64, Steps<T>),
        team: &Team,
        task: impl Fn(&dyn crate::step::passes::kernels::ShapeKernels<T, D>, LoadTask<'_, T, D>) -> T
        + Send
        + Sync,
    ) -> f64 {
        self.have_scratch(team);
        let common = &self.common(dt);
        let (kernels, scratch, around) = (&*self.kernels, &self.scratch, &self.nodes_around);
        let rows = self.loads.rows(self.columns.load());
        let mut acting = std::mem::take(&mut self.loads.acting);
        acting.clear();
        acting.extend(self.loads.tractions(time));
        let tractions = &acting[..];
        let reads_increment = kernels.facts().reads_increment;
        self.powers.clear();
        self.powers.resize(self.slots.len(), T::default());
        team.each_piece(&mut self.slots, 1, &mut self.powers, |s, slot, power| {
            let slot = &mut slot[0];
            let mut own = team.own(scratch);
            let tile_in = own.tile_in();
            let around = around.get(s * neighbours(D)..).unwrap_or_default();
            let around = &around[..neighbours(D).min(around.len())];
            let nodes = (nodes, around);
            let loads = LoadTask { slot, common, rows, tractions, maps, nodes, reads_increment, tile_in };
            *power = task(kernels.shape(), loads);
        });
        self.loads.acting = acting;
        self.index.iter().map(|&(_, slot)| self.powers[slot as usize].to_double()).sum()
    }

    /// Note the power of the loads that act in a step, with the pass in which velocities change.
    fn book_loads(&mut self, nodes: Nodes<'_, T>, which: Which, dt: Steps<T>, team: &Team) {
        // The traction that acts: that of the last force.
        let (time, maps) = (self.mapped_at, self.kernels.maps(which));
        self.loading.power =
            self.each_load(nodes, maps, (time, dt), team, |shape, loads| shape.book_loads(loads));
    }

    /// Add the loads to the tiles, as they are at the time at which the forces of a pass act.
    fn map_loads(&mut self, which: Which, dt: Steps<T>, team: &Team) {
        let nodes = Nodes { all: &[], layout: &Layout::default() };
        let maps = self.kernels.maps(which);
        self.each_load(nodes, maps, (dt.force_time, dt), team, |shape, loads| {
            shape.map_loads(loads);
            T::default()
        });
    }

    /// Give particles, by number and velocity, m/s, the accelerations that they carry, m/s^2, and add their forces to the tiles, whose
    /// second records hold nothing else.
    pub(in crate::step) fn map_given(
        &mut self,
        dt: Steps<T>,
        give: &(dyn Fn(usize, [T; 3]) -> [T; 3] + Sync),
        team: &Team,
    ) {
        let Some(row) = self.loads.rows(self.columns.load()).acceleration else { return };
        let first = Columns::velocity(D);
        let forces = self.facts().tile_nodes(D);
        team.each(&mut self.slots, |_, slot| {
            slot.tile.all_mut()[forces..].fill([T::default(); 4]);
            for bin in 0..block_nodes(D) {
                let mut next = slot.block.last_group(bin);
                while let Some((group, here)) = next {
                    next = slot.block.group_before(group);
                    for lane in 0..here as u32 {
                        let at = Place { group, lane };
                        let mut v = [T::default(); 3];
                        (0..D).for_each(|d| v[d] = slot.block.get(at, first + d));
                        let a = give(slot.block.number(at), v);
                        (0..D).for_each(|d| slot.block.set(at, row + d, a[d]));
                    }
                }
            }
        });
        let nodes = Nodes { all: &[], layout: &Layout::default() };
        let maps = Maps { momentum: true, force: true, ..Maps::NOTHING };
        self.each_load(nodes, maps, (dt.force_time, dt), team, |shape, loads| {
            shape.map_loads(loads);
            T::default()
        });
    }

    /// The velocities that the nodes have where the particles are, m/s, by number.
    pub(in crate::step) fn carried(
        &mut self,
        nodes: Nodes<'_, T>,
        dt: Steps<T>,
        out: &mut [[T; 3]],
        team: &Team,
    ) {
        let Some(row) = self.loads.rows(self.columns.load()).acceleration else { return };
        self.each_load(nodes, Maps::NOTHING, (dt.force_time, dt), team, |shape, loads| {
            shape.carry_velocity(loads);
            T::default()
        });
        for slot in &self.slots {
            for (_, at) in slot.block.places() {
                if let Some(v) = out.get_mut(slot.block.number(at)) {
                    (0..D).for_each(|d| v[d] = slot.block.get(at, row + d));
                }
            }
        }
    }

    fn common(&self, steps: Steps<T>) -> Common<T> {
        Common {
            dt: steps.this,
            next_dt: steps.next,
            speeds: steps.adapt,
            spacing: T::of(self.lattice.spacing()),
            origin: T::of(self.lattice.origin()[0]),
            density: self.material.density(),
            mean: self.facts().mean,
            domains: self.domains(),
            masses: self.masses,
            frame: self.columns.frame(),
            splitter: self.splitter,
        }
    }

    /// Have memory for each thread.
    fn have_scratch(&mut self, team: &Team) {
        for number in self.scratch.len()..team.threads() {
            self.scratch.push(Mutex::new(Scratch::new(number)));
            self.outboxes.push(Outbox::default());
        }
    }

    /// One pass over the particles.
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
        // Before any pass that changes velocities: with MUSL they change before positions do.
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
        self.outlines.clear();
        self.outlines.extend(self.slots.iter().map(Outline::of));
        let (nodes_around, scratch, outlines) = (&self.nodes_around, &self.scratch, &self.outlines);
        team.each_piece(&mut self.slots, 1, &mut self.sent, |s, slot, sent| {
            let slot = &mut slot[0];
            let scratch = &mut *team.own(scratch);
            let (here, ahead) = nodes_around[s * neighbours(D)..].split_at(neighbours(D));
            let around = [here, &ahead[..neighbours(D).min(ahead.len())]];
            let next = outlines.get(s + 1);
            kernels.sweep(which, Task { material, nodes, around, slot, next, sent, dummy, scratch, common });
        });
        self.hand_outboxes();
        let (mut rate, mut moments) = (T::default(), [0.0; 4]);
        for &(_, slot) in &self.index {
            let slot = &self.slots[slot as usize];
            self.splits.cuts += u64::from(slot.report.splits);
            self.splits.kinetic += slot.report.revealed.to_double();
            rate = rate.max(slot.report.rate);
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

    /// Give each thread its outbox for a pass, or take it back.
    fn hand_outboxes(&mut self) {
        for (scratch, outbox) in self.scratch.iter_mut().zip(&mut self.outboxes) {
            let scratch = scratch.get_mut().unwrap_or_else(PoisonError::into_inner);
            std::mem::swap(scratch.out(), outbox);
        }
    }

    /// Which particle, and where: its position, or the centre of its bin if it is on its way to another or its position
    /// is none. A volume that is not a number is not an inverted one.
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
                let coordinates = slot.block.bin_coordinates(bin);
                for d in 0..D {
                    let cells = f64::from(coordinates[d]) + self.bin_centre();
                    x[d] = self.lattice.origin()[d] + cells * self.lattice.spacing();
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
        let (kernels, sent, outboxes) = (&*self.kernels, &self.sent, &self.outboxes);
        let maps = kernels.maps(which);
        let payload = &MigrationPayload::of::<D>(maps, self.splitter.is_on());
        team.each(&mut self.slots, |_, slot| {
            let Slot { block, tile, rows, slots_around, .. } = slot;
            for (from, &s) in slots_around.iter().enumerate() {
                // What lies in direction `from` of here sent towards the opposite direction. What stayed its own pass took in.
                let to = neighbours(D) - 1 - from;
                if from != to
                    && let Some(sent) = sent.get(s as usize).filter(|sent| sent.goes(to))
                {
                    let outbox = &outboxes[sent.outbox as usize];
                    let sums = (tile.all_mut(), &mut *rows);
                    kernels.shape().take_in(block, sums, (outbox, *sent, to), common, (maps, payload));
                }
            }
            block.tidy();
        });
    }

    /// [`Body::locate`].
    pub(in crate::step) fn locate_after(&mut self, which: Which, prune: bool, team: &Team) -> bool {
        let mut changed = self.make_blocks();
        if changed {
            self.link_slots();
        }
        self.take_in(which, team);
        if let Some((which, dt)) = self.unloaded.take() {
            self.map_loads(which, dt, team);
        }
        if prune && self.slots.iter().any(|s| s.block.is_empty()) {
            // A block that particles left still holds what they mapped before: none, since they map where
            // they arrive.
            self.spare.extend(self.slots.extract_if(.., |s| s.block.is_empty()));
            self.link_slots();
            changed = true;
        }
        changed
    }

    /// Make the blocks that particles left for and that are not there yet.
    fn make_blocks(&mut self) -> bool {
        let mut wanted = std::mem::take(&mut self.wanted);
        wanted.clear();
        for (slot, sent) in self.slots.iter().zip(&self.sent) {
            let mut directions = sent.directions;
            while directions != 0 {
                let to = directions.trailing_zeros() as usize;
                directions &= directions - 1;
                if slot.slots_around[to] == NONE {
                    wanted.push(self.wrap.block(shifted(&slot.block.coordinates, &offset(to))));
                }
            }
        }
        let made = self.make_slots(&mut wanted);
        self.wanted = wanted;
        made
    }

    /// Make empty slots at these places; not linked yet. Were there any?
    pub(in crate::step) fn make_slots(&mut self, wanted: &mut Vec<[i32; D]>) -> bool {
        wanted.sort_unstable();
        wanted.dedup();
        for &c in &*wanted {
            let slot = match self.spare.pop() {
                Some(mut slot) => {
                    slot.block.place_at(c);
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
        Slot {
            block: Block::new(coordinates, &self.columns, self.dummy.clone()),
            tile: AlignedRecords::zeros(self.tile_records()),
            rows: 0,
            slots_around: vec![NONE; neighbours(D)],
            linked: 0,
            report: Report::default(),
        }
    }

    /// Records of a slot's tile: one or two a node.
    pub(in crate::step) fn tile_records(&self) -> usize {
        self.facts().tile_nodes(D) * self.facts().records()
    }

    pub(in crate::step) fn particle(&self, block: &Block<T, D>, bin: usize, at: Place) -> PointView {
        let mut p = PointView::default();
        self.read_particle((block, bin, at), Parts::ALL, &self.lead.way(), &mut Vec::new(), &mut p);
        p
    }

    /// Parts of the same, in memory that is there.
    fn read_particle(
        &self,
        (block, bin, at): (&Block<T, D>, usize, Place),
        parts: Parts,
        way: &[f64; 3],
        numbers: &mut Vec<T>,
        p: &mut PointView,
    ) {
        numbers.clear();
        block.read(at, numbers);
        let numbers = &*numbers;
        let centre = self.bin_centre();
        let coordinates = block.bin_coordinates(bin);
        p.number = numbers[self.columns.number()].to_double() as usize;
        p.mass = self.masses.of(numbers).to_double();
        if parts.size {
            p.half_edges = self.half_edges(numbers);
        }
        (p.position, p.velocity) = ([0.0; 3], [0.0; 3]);
        let total = self.facts().total;
        for d in 0..D {
            let mut cells = f64::from(coordinates[d]) + centre + numbers[Columns::position() + d].to_double();
            if total {
                cells += numbers[self.columns.frame() + d].to_double();
            }
            p.position[d] = self.lattice.origin()[d] + self.lattice.spacing() * cells - way[d];
            p.velocity[d] = numbers[Columns::velocity(D) + d].to_double();
        }
        let state = self.state_of(numbers);
        let unstrained = || p.mass / self.material.density().to_double();
        if !parts.law {
            if let Some(ratio) = self.material.volume_ratio_of(state).filter(|_| parts.size) {
                p.volume = unstrained() * ratio.to_double();
            }
            return;
        }
        p.state.clear();
        p.state.extend(state.iter().map(|x| x.to_double()));
        if let Some(said) = self.material.describe_point(state) {
            p.stress = said.stress.map(|x| x.to_double());
            p.in_range = said.in_range;
            p.failed = said.failed;
            p.volume = unstrained() * said.volume_ratio.to_double();
        }
    }

    /// The law's state among the numbers of a particle.
    pub(in crate::step) fn state_of<'a>(&self, numbers: &'a [T]) -> &'a [T] {
        &numbers[Columns::state(D)..self.columns.domain()]
    }

    /// The mass of a particle, kg.
    pub(in crate::step) fn mass_at(&self, block: &Block<T, D>, at: Place) -> T {
        self.masses.read(|row| block.get(at, row))
    }

    /// The numbers of a particle.
    pub(in crate::step) fn numbers(&self, block: &Block<T, D>, at: Place) -> Vec<T> {
        let mut numbers = Vec::with_capacity(self.columns.count());
        block.read(at, &mut numbers);
        numbers
    }

    fn totals_of(&self, slot: &Slot<T, D>) -> Totals {
        let mut part = Totals::default();
        let mut numbers = Vec::with_capacity(self.columns.count());
        let (centre, spacing, way) = (self.bin_centre(), self.lattice.spacing(), self.lead.way());
        let (total, density) = (self.facts().total, self.material.density());
        for (bin, at) in slot.block.places() {
            numbers.clear();
            slot.block.read(at, &mut numbers);
            let coordinates = slot.block.bin_coordinates(bin);
            let (mut x, mut v) = ([0.0; 3], [0.0; 3]);
            for d in 0..D {
                let mut cells =
                    f64::from(coordinates[d]) + centre + numbers[Columns::position() + d].to_double();
                if total {
                    cells += numbers[self.columns.frame() + d].to_double();
                }
                x[d] = self.lattice.origin()[d] + spacing * cells - way[d];
                v[d] = numbers[Columns::velocity(D) + d].to_double();
            }
            let mass = self.masses.of(&numbers);
            let energy = self.material.energy_of(self.state_of(&numbers)).unwrap_or_default();
            part.internal += (energy * (mass / density)).to_double();
            let heat = self.material.viscous_heat_of(self.state_of(&numbers));
            part.viscous_heat += (heat * (mass / density)).to_double();
            let mass = mass.to_double();
            part.particles += 1;
            part.mass += mass;
            let moment = [x[1] * v[2] - x[2] * v[1], x[2] * v[0] - x[0] * v[2], x[0] * v[1] - x[1] * v[0]];
            for d in 0..3 {
                part.momentum[d] += mass * v[d];
                part.angular_momentum[d] += mass * moment[d];
            }
            let square = v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
            part.momentum_scale += mass * square.sqrt();
            part.kinetic += 0.5 * mass * square;
        }
        part
    }
}

impl<T: Float, const D: usize> Body for ParticleBody<T, D> {
    fn name(&self) -> &str {
        &self.name
    }
    fn law(&self) -> &'static str {
        self.material.name()
    }
    fn is_plane_stress(&self) -> bool {
        self.material.is_plane_stress()
    }
    fn len(&self) -> usize {
        self.slots.iter().map(|s| s.block.len()).sum()
    }
    fn state_names(&self) -> Vec<String> {
        self.columns.state_names().to_vec()
    }
    fn totals(&self) -> Totals {
        let parts = self.in_place().map(|slot| self.totals_of(slot));
        parts.fold(Totals::default(), |sum, part| sum.plus(&part))
    }
    fn for_each(&self, visit: &mut dyn FnMut(&PointView)) {
        self.for_each_with(Parts::ALL, visit);
    }
    fn for_each_with(&self, parts: Parts, visit: &mut dyn FnMut(&PointView)) {
        let (mut numbers, mut p, way) = (Vec::new(), PointView::default(), self.lead.way());
        for slot in self.in_place() {
            for (bin, at) in slot.block.places() {
                self.read_particle((&slot.block, bin, at), parts, &way, &mut numbers, &mut p);
                visit(&p);
            }
        }
    }
    fn bytes(&self) -> usize {
        let slot = |s: &Slot<T, D>| {
            s.block.bytes()
                + s.tile.bytes()
                + s.slots_around.len() * size_of::<u32>()
                + size_of::<Slot<T, D>>()
        };
        let own = |s: &Mutex<Scratch<T>>| s.lock().unwrap_or_else(PoisonError::into_inner).bytes();
        self.slots.iter().chain(&self.spare).map(slot).sum::<usize>()
            + self.index.capacity() * size_of::<([i32; D], u32)>()
            + self.wanted.capacity() * size_of::<[i32; D]>()
            + self.links.capacity() * size_of::<(u32, u32, u8)>()
            + self.sent.capacity() * size_of::<Sent>()
            + self.outboxes.iter().map(Outbox::bytes).sum::<usize>()
            + self.scratch.iter().map(own).sum::<usize>()
            + self.outlines.capacity() * size_of::<Outline>()
            + self.starts.capacity() * size_of::<[f64; D]>()
            + self.powers.capacity() * size_of::<T>()
            + self.forces.capacity() * size_of::<[f64; 3]>()
            + (self.contributors.capacity() + self.nodes_around.capacity()) * size_of::<u32>()
            + self.resting.as_ref().map_or(0, Deactivated::bytes)
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
    fn division_mut(&mut self) -> Option<&mut dyn Division> {
        Some(self)
    }
    fn free_velocities(&mut self) -> Option<&mut dyn FreeVelocities<T>> {
        Some(self)
    }

    fn rate(&self, spacing: f64) -> T {
        let mut fastest = T::default();
        for slot in &self.slots {
            for (_, at) in slot.block.places() {
                let numbers = self.numbers(&slot.block, at);
                let mut square = T::default();
                for d in 0..D {
                    square += numbers[Columns::velocity(D) + d] * numbers[Columns::velocity(D) + d];
                }
                let speed = self.material.step_speed(self.state_of(&numbers), T::of(spacing));
                let Some(speed) = speed else { continue };
                if self.facts().total {
                    let f = total::gradient::<T, D>(&numbers[self.columns.frame()..], self.facts().hoop);
                    let stretch: T = total::stretch(&total::inverse::<T::Single, D>(&f)).into();
                    fastest = fastest.max(speed * stretch);
                } else {
                    fastest = fastest.max(speed + square.sqrt());
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
        // A transfer that smooths nothing has no such pass.
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
