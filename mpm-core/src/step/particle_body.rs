//! A body of particles of one law in one method.

use std::marker::PhantomData;
use std::sync::{Arc, Mutex, PoisonError};

use mpm_materials::{Breakdown, Constitutive, Lane};

use super::body::{Body, BodyTrouble, Particle, Presence, Steps, Totals, Which};
use super::checkpoint::{Archive, CheckpointError};
use super::fields::Claim;
use super::footprint::Footprint;
use super::layout::{Layout, Nodes};
use super::load::{Load, Loading, Unloaded};
use super::merging::MergeBook;
use super::migrate::{Domains, Luggage, TakeIn};
use super::reference_body::Shade;
use super::rest::Stilled;
use super::resting::Resting;
use super::scene::SceneError;
use super::splitting::{SplitBook, Splitter};
use super::survey::{Near, Survey};
use super::sweep::{Cause, Common, Outline, Report, Scratch, Slot, Sweep, Trouble};
use super::tile::{AddTiles, Sums, tile_nodes};
use super::total;
use crate::dim::{block_nodes, neighbours};
use crate::embedding::Embedding;
use crate::frame::Frame;
use crate::geometry::Lattice;
use crate::grid::Node;
use crate::method::Composition;
use crate::parallel::{AlignedRecords, Float, Team, prefetch_from};
use crate::particles::{Block, Columns, Masses, Outbox, Place, Sent};
use crate::scheme::{PassKind, Smooth, StressUpdate};
use crate::shape::{ShapeFunction, bin_centre};
use crate::transfer::Transfer;

/// A body of the law `C` in a method `M`.
pub struct ParticleBody<T: Float, const D: usize, C, M, L = Unloaded> {
    pub(super) name: String,
    pub(super) law: C,
    pub(super) method: M,
    pub(super) lattice: Lattice<D>,
    pub(super) columns: Columns,
    pub(super) slots: Vec<Slot<T, D>>,
    /// Slots without particles, kept for the next ones: a body that moves needs no new memory.
    pub(super) spare: Vec<Slot<T, D>>,
    /// Slots by coordinates, while they are linked.
    pub(super) index: Vec<([i32; D], u32)>,
    /// Places that particles left for, or may soon, while blocks are made.
    pub(super) wanted: Vec<[i32; D]>,
    /// Node block, slot and direction of each link, while they are made.
    pub(super) links: Vec<(u32, u32, u8)>,
    /// What each slot sent to others in the last pass.
    pub(super) sent: Vec<Sent>,
    /// The particles sent, by thread: here between passes.
    pub(super) outboxes: Vec<Outbox<T>>,
    /// Where the slots' memory lies, for a pass.
    pub(super) outlines: Vec<Outline>,
    /// Memory of each thread.
    pub(super) scratch: Vec<Mutex<Scratch<T>>>,
    /// Blocks of nodes around each slot, 3^D, x fastest; `NONE` where there is none.
    pub(super) nodes_around: Vec<u32>,
    /// Slot of each neighbour (3^D, x fastest) of each node block of the body's own list, `NONE` where there is
    /// none.
    pub(super) contributors: Vec<u32>,
    /// Half sizes of the particles in units of h.
    pub(super) half: [T; 3],
    pub(super) lightest: T,
    pub(super) masses: Masses<T>,
    pub(super) load: L,
    /// Sum of the loaded areas, m^2.
    pub(super) loaded_area: f64,
    pub(super) loading: Loading,
    /// When particles are split, and how often they were.
    pub(super) splitter: Splitter<T>,
    pub(super) splits: SplitBook,
    pub(super) merges: MergeBook,
    /// Where the particles started, by number, if a force field asks for it, m.
    pub(super) starts: Vec<[f64; D]>,
    /// What a lane without a particle holds.
    pub(super) dummy: Arc<[T]>,
    /// While it rests.
    pub(super) resting: Option<Resting<T, D>>,
}

pub(super) const NONE: u32 = u32::MAX;
pub(super) type ShapeOf<M, T, const D: usize> = <M as Composition<T, D>>::Shape;
pub(super) type ExtentOf<M, T, const D: usize> = <ShapeOf<M, T, D> as ShapeFunction<T, D>>::Extent;

/// Offset -1, 0 or 1 along each axis of neighbour `index`.
pub(super) fn offset<const D: usize>(index: usize) -> [i32; D] {
    let mut o = [0; D];
    let mut rest = index;
    for x in &mut o {
        *x = (rest % 3) as i32 - 1;
        rest /= 3;
    }
    o
}

pub(super) fn shifted<const D: usize>(c: &[i32; D], by: &[i32; D]) -> [i32; D] {
    let mut r = *c;
    for d in 0..D {
        r[d] += by[d];
    }
    r
}

impl<T, const D: usize, C, M, L> ParticleBody<T, D, C, M, L>
where
    T: Float,
    C: Constitutive<T>,
    M: Composition<T, D>,
    L: Load<D>,
{
    /// Records a node that the method maps.
    const RECORDS: usize = if M::MAPS_TOGETHER { 1 } else { 2 };
    /// Note which slots lie around each.
    pub(super) fn link_slots(&mut self) {
        let index = &mut self.index;
        index.clear();
        index.extend(self.slots.iter().enumerate().map(|(i, s)| (s.block.coordinates, i as u32)));
        index.sort_unstable();
        self.sent.resize(self.slots.len(), Sent::default());
        for slot in &mut self.slots {
            let c = slot.block.coordinates;
            for (n, around) in slot.slots_around.iter_mut().enumerate() {
                let place = index.binary_search_by_key(&shifted(&c, &offset(n)), |entry| entry.0);
                *around = place.map_or(NONE, |place| index[place].1);
            }
        }
    }

    /// Slots in the order of their places, which is that of sums: the order in which they were made is a matter of when
    /// blocks were arranged.
    fn in_place(&self) -> impl Iterator<Item = &Slot<T, D>> {
        self.index.iter().map(|&(_, slot)| &self.slots[slot as usize])
    }

    pub(super) fn traction(&self, time: f64) -> [f64; 3] {
        let mut traction = [0.0; 3];
        if L::ACTS {
            traction[..D].copy_from_slice(&self.load.traction(time));
        }
        traction
    }

    /// Give every particle the acceleration of a force field at a time, s.
    fn accelerate(&mut self, time: f64, team: &Team) {
        let (load, starts, columns) = (&self.load, &self.starts, &self.columns);
        team.each(&mut self.slots, |_, slot| {
            for bin in 0..block_nodes(D) {
                let mut next = slot.block.last_group(bin);
                while let Some((group, here)) = next {
                    next = slot.block.group_before(group);
                    for lane in 0..here as u32 {
                        let at = Place { group, lane };
                        let Some(start) = starts.get(slot.block.number(at)) else { continue };
                        let a = load.acceleration(start, time);
                        for d in 0..D {
                            slot.block.set(at, columns.load() + d, T::of(a[d]));
                        }
                    }
                }
            }
        });
    }

    /// Note the power of the load that acted in a step, with the pass in which velocities change; and the force of the one
    /// that the pass mapped, at `time`, s.
    fn book_load<K: PassKind>(&mut self, time: f64) {
        let sum = |of: &dyn Fn(&Report<T>) -> T| -> f64 {
            self.in_place().map(|s| of(&s.report).to_double()).sum()
        };
        let mut loading = self.loading;
        if K::DOES.velocity {
            loading.power = sum(&|r| r.power);
            // The traction that acted: that of the last force.
            for d in (0..D).filter(|_| self.loaded_area > 0.0) {
                loading.power += self.loading.force[d] / self.loaded_area * sum(&|r| r.flux[d]);
            }
        }
        if K::DOES.force {
            let traction = self.traction(time);
            loading.force = std::array::from_fn(|d| traction[d] * self.loaded_area + sum(&|r| r.push[d]));
        }
        self.loading = loading;
    }

    fn common(&self, steps: Steps<T>) -> Common<T> {
        Common {
            dt: steps.this,
            next_dt: steps.next,
            speeds: steps.adapt,
            traction: self.traction(steps.force_time).map(T::of),
            spacing: T::of(self.lattice.spacing()),
            origin: T::of(self.lattice.origin()[0]),
            domains: Domains { column: self.columns.domain(), half: self.half },
            masses: self.masses,
            frame: self.columns.frame(),
            splitter: self.splitter,
        }
    }

    pub(super) fn sweep<K: PassKind>(
        &mut self,
        nodes: Nodes<'_, T>,
        dt: Steps<T>,
        team: &Team,
    ) -> Result<T, BodyTrouble> {
        if L::FIELD && K::DOES.field && K::DOES.force {
            self.accelerate(dt.force_time, team);
        }
        for number in self.scratch.len()..team.threads() {
            self.scratch.push(Mutex::new(Scratch::new(number)));
            self.outboxes.push(Outbox::default());
        }
        let luggage = Luggage::of::<T, D, M, K>().count();
        self.outboxes.iter_mut().for_each(|outbox| outbox.clear(self.columns.count() + luggage));
        self.hand_outboxes();
        let common = self.common(dt);
        let (law, method, dummy) = (&self.law, &self.method, &self.dummy[..]);
        self.outlines.clear();
        self.outlines.extend(self.slots.iter().map(Outline::of));
        let (nodes_around, scratch, outlines) = (&self.nodes_around, &self.scratch, &self.outlines);
        team.each_piece(&mut self.slots, 1, &mut self.sent, |s, slot, sent| {
            let slot = &mut slot[0];
            let scratch = &mut *team.own(scratch);
            let (here, ahead) = nodes_around[s * neighbours(D)..].split_at(neighbours(D));
            let around = [here, &ahead[..neighbours(D).min(ahead.len())]];
            let (next, pass) = (outlines.get(s + 1), PhantomData);
            let sweep: Sweep<'_, T, D, C, M, K> =
                Sweep { law, method, nodes, around, slot, next, sent, dummy, scratch, common, pass };
            T::dispatch(sweep);
        });
        self.hand_outboxes();
        if (L::ACTS && K::DOES.load) || (L::FIELD && K::DOES.field) {
            self.book_load::<K>(dt.force_time);
        }
        let mut rate = T::default();
        for &(_, slot) in &self.index {
            let slot = &self.slots[slot as usize];
            if K::DOES.splits {
                self.splits.cuts += u64::from(slot.report.splits);
                self.splits.kinetic += slot.report.revealed.to_double();
            }
            rate = rate.max(slot.report.rate);
            if let Some(trouble) = slot.report.trouble {
                return Err(self.describe(slot, &trouble));
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
                    let cells = f64::from(coordinates[d]) + bin_centre::<ExtentOf<M, T, D>>();
                    x[d] = self.lattice.origin()[d] + cells * self.lattice.spacing();
                }
                x
            },
            |p| p.position,
        );
        BodyTrouble { particle, position, cause }
    }

    fn take_in<K: PassKind>(&mut self, team: &Team) {
        if !K::DOES.moves || M::Frame::TOTAL {
            return;
        }
        let common =
            self.common(Steps { this: T::default(), next: T::default(), adapt: false, force_time: 0.0 });
        let (method, sent, outboxes) = (&self.method, &self.sent, &self.outboxes);
        team.each(&mut self.slots, |_, slot| {
            // What lies in direction `from` of here sends towards the opposite direction.
            let comes = |(from, &s): (usize, &u32)| {
                let to = neighbours(D) - 1 - from;
                from != to && sent.get(s as usize).is_some_and(|sent| sent.goes(to))
            };
            if slot.slots_around.iter().enumerate().any(comes) {
                let take: TakeIn<'_, T, D, M, K> =
                    TakeIn { method, slot, sent, outboxes, common, pass: PhantomData };
                T::dispatch(take);
            }
            slot.block.tidy();
        });
    }

    /// [`Body::locate`], after the pass `K`.
    pub(super) fn locate_after<K: PassKind>(&mut self, prune: bool, team: &Team) -> bool {
        let mut changed = self.make_blocks();
        if changed {
            self.link_slots();
        }
        self.take_in::<K>(team);
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
                    wanted.push(shifted(&slot.block.coordinates, &offset(to)));
                }
            }
        }
        let made = self.make_slots(&mut wanted);
        self.wanted = wanted;
        made
    }

    /// Make empty slots at these places; not linked yet. Were there any?
    pub(super) fn make_slots(&mut self, wanted: &mut Vec<[i32; D]>) -> bool {
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

    pub(super) fn empty_slot(&self, coordinates: [i32; D]) -> Slot<T, D> {
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
    pub(super) fn tile_records(&self) -> usize {
        tile_nodes::<ExtentOf<M, T, D>>(D) * Self::RECORDS
    }

    pub(super) fn particle(&self, block: &Block<T, D>, bin: usize, at: Place) -> Particle {
        let (numbers, state) = self.point(block, at);
        let centre = bin_centre::<ExtentOf<M, T, D>>();
        let coordinates = block.bin_coordinates(bin);
        let mut p = Particle {
            number: numbers[self.columns.number()].to_double() as usize,
            position: [0.0; 3],
            velocity: [0.0; 3],
            mass: self.masses.of(&numbers).to_double(),
            volume: 0.0,
            half_edges: self.half_edges(&numbers),
            stress: [0.0; 6],
            state: Vec::new(),
        };
        for d in 0..D {
            let mut cells = f64::from(coordinates[d]) + centre + numbers[Columns::position() + d].to_double();
            if M::Frame::TOTAL {
                cells += numbers[self.columns.frame() + d].to_double();
            }
            p.position[d] = self.lattice.origin()[d] + self.lattice.spacing() * cells;
            p.velocity[d] = numbers[Columns::velocity(D) + d].to_double();
        }
        p.state = numbers[Columns::state(D)..self.columns.domain()].iter().map(|x| x.to_double()).collect();
        if let Ok(state) = state {
            let stress = self.law.stress(&state);
            for i in 0..6 {
                p.stress[i] = stress.0[i].lane(0).to_double();
            }
            let j: T = self.law.volume_ratio(&state).into();
            p.volume = p.mass / self.law.density().to_double() * j.to_double();
        }
        p
    }

    /// The mass of a particle, kg.
    pub(super) fn mass_at(&self, block: &Block<T, D>, at: Place) -> T {
        self.masses.read(|row| block.get(at, row))
    }

    /// The numbers of a particle, and its law's state.
    #[allow(clippy::type_complexity)]
    pub(super) fn point(
        &self,
        block: &Block<T, D>,
        at: Place,
    ) -> (Vec<T>, Result<C::State<T::Single>, usize>) {
        let mut numbers = Vec::with_capacity(self.columns.count());
        block.read(at, &mut numbers);
        let state: Vec<T::Single> =
            numbers[Columns::state(D)..self.columns.domain()].iter().map(|&x| T::Single::from(x)).collect();
        let state = mpm_materials::point::unflatten(&state);
        (numbers, state)
    }

    fn energy(&self, block: &Block<T, D>, at: Place) -> f64 {
        let (numbers, state) = self.point(block, at);
        state.map_or(0.0, |state| {
            let per_volume: T = self.law.energy(&state).into();
            let volume = self.masses.of(&numbers) / self.law.density();
            (per_volume * volume).to_double()
        })
    }
}

impl<T, const D: usize, C, M, L> Presence<T, D> for ParticleBody<T, D, C, M, L>
where
    T: Float,
    C: Constitutive<T>,
    M: Composition<T, D>,
    L: Load<D>,
{
    fn claims(&mut self, number: u32, ahead: bool, list: &mut Vec<Claim<D>>) {
        if !self.rests() {
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
        if self.rests() {
            (self.nodes_around, self.contributors) = (Vec::new(), Vec::new());
        } else {
            self.link_blocks(find, places);
        }
    }
    fn add_tiles(&self, block: usize, sums: Sums, nodes: &mut [Node<T>]) {
        let (around, next) = self.contributors[block * neighbours(D)..].split_at(neighbours(D));
        let around = [around, next];
        let tile = |n: usize, block: usize| {
            let slot = *around[block].get(n).unwrap_or(&NONE);
            self.slots.get(slot as usize).map(|slot| (slot.tile.all(), slot.rows))
        };
        // Whose tiles the block after the next one sums up.
        for &slot in around[1].iter().skip(neighbours(D)).take(neighbours(D)) {
            prefetch_from(&self.slots, slot as usize, 0);
        }
        let two = !M::MAPS_TOGETHER && !M::Update::BEFORE_FORCES;
        let add: AddTiles<'_, T, D, ExtentOf<M, T, D>, _> =
            AddTiles { nodes, tile, sums, two, extent: PhantomData };
        T::dispatch(add);
    }
    fn survey(&self, block: usize, what: Survey, nodes: u64, normals: &[[T; 3]], out: &mut [[T; 3]]) {
        self.survey_nodes(block, what, nodes, normals, out);
    }
    fn near(&self, block: usize, nodes: u64, visit: &mut dyn FnMut(usize, &Near<T>)) {
        self.visit_near(block, nodes, visit);
    }
}

impl<T, const D: usize, C, M, L> Body<T, D> for ParticleBody<T, D, C, M, L>
where
    T: Float,
    C: Constitutive<T>,
    M: Composition<T, D>,
    L: Load<D>,
{
    fn name(&self) -> &str {
        &self.name
    }
    fn law(&self) -> &'static str {
        self.law.name()
    }
    fn len(&self) -> usize {
        self.slots.iter().map(|s| s.block.len()).sum()
    }
    fn state_names(&self) -> Vec<String> {
        self.columns.state_names().to_vec()
    }
    fn embedding(&self) -> &'static str {
        <M::Embedding as Embedding<D>>::NAME
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

    fn let_rest(&mut self, longest: T, team: &Team) -> Result<(), SceneError> {
        self.lie_down(longest, team)
    }
    fn wake(&mut self, team: &Team) {
        self.stand_up(team);
    }
    fn rests_at(&self) -> Option<&[[i32; D]]> {
        self.resting.as_ref().map(Resting::blocks)
    }

    fn rate(&self, spacing: f64) -> T {
        let mut fastest = T::default();
        for slot in &self.slots {
            for (_, at) in slot.block.places() {
                let (numbers, state) = self.point(&slot.block, at);
                let mut square = T::default();
                for d in 0..D {
                    square += numbers[Columns::velocity(D) + d] * numbers[Columns::velocity(D) + d];
                }
                let Ok(state) = state else { continue };
                if M::Frame::TOTAL {
                    let f = total::gradient::<T, D, M>(&numbers[self.columns.frame()..]);
                    let c: T = total::speed(&self.law, &state, &total::inverse::<T::Single, D>(&f)).into();
                    fastest = fastest.max(c);
                } else {
                    let c: T = self.law.wave_speed(&state).into();
                    fastest = fastest.max(c + square.sqrt());
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
        if let Some(resting) = &self.resting {
            return Ok(resting.rate(which, dt.adapt));
        }
        match which {
            Which::Map => self.sweep::<L::Pass<<M::Update as StressUpdate>::Map>>(nodes, dt, team),
            Which::First => self.sweep::<L::Pass<<M::Update as StressUpdate>::First>>(nodes, dt, team),
            Which::Second => self.sweep::<L::Pass<<M::Update as StressUpdate>::Second>>(nodes, dt, team),
            // Known when compiling: a transfer that smooths nothing has no kernel for it.
            Which::Smooth if <M::Transfer as Transfer<T>>::ORDER < 2 => Ok(T::default()),
            Which::Smooth => self.sweep::<Smooth>(nodes, dt, team),
        }
    }

    fn loading(&self) -> Loading {
        self.loading
    }

    fn locate(&mut self, which: Which, prune: bool, team: &Team) -> bool {
        if self.rests() {
            return false;
        }
        match which {
            Which::First => self.locate_after::<L::Pass<<M::Update as StressUpdate>::First>>(prune, team),
            _ => self.locate_after::<L::Pass<<M::Update as StressUpdate>::Second>>(prune, team),
        }
    }

    fn totals(&self) -> Totals {
        let mut sum = Totals::default();
        for slot in self.in_place() {
            let mut part = Totals::default();
            for (bin, at) in slot.block.places() {
                let p = self.particle(&slot.block, bin, at);
                part.particles += 1;
                part.mass += p.mass;
                let ([x, y, z], [u, v, w]) = (p.position, p.velocity);
                let moment = [y * w - z * v, z * u - x * w, x * v - y * u];
                for d in 0..3 {
                    part.momentum[d] += p.mass * p.velocity[d];
                    part.angular_momentum[d] += p.mass * moment[d];
                }
                let square = u * u + v * v + w * w;
                part.momentum_scale += p.mass * square.sqrt();
                part.kinetic += 0.5 * p.mass * square;
                part.internal += self.energy(&slot.block, at);
            }
            sum = sum.plus(&part);
        }
        sum
    }

    fn for_each(&self, visit: &mut dyn FnMut(&Particle)) {
        for slot in self.in_place() {
            for (bin, at) in slot.block.places() {
                visit(&self.particle(&slot.block, bin, at));
            }
        }
    }

    fn each_velocity(&mut self, visit: &mut dyn FnMut(usize, &mut [T; 3])) {
        self.show_velocities(visit);
    }
    fn cast(&self, numbers: &mut Vec<T>, shapes: &mut [Shade]) {
        self.cast_shadow(numbers, shapes);
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
            + (self.contributors.capacity() + self.nodes_around.capacity()) * size_of::<u32>()
            + self.resting.as_ref().map_or(0, Resting::bytes)
    }
    fn particle_bytes(&self) -> usize {
        self.columns.bytes::<T>()
    }
    fn splits(&self) -> SplitBook {
        self.splits
    }
    fn merges(&self) -> Option<MergeBook> {
        self.load.splitting()?.merging().map(|_| self.merges)
    }

    fn exchange(&mut self, file: &mut Archive) -> Result<(), CheckpointError> {
        self.exchange_particles(file)
    }

    fn still(&mut self) -> Stilled {
        let mut sum = Stilled::default();
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
        if self.rests() { 0.0 } else { self.filter_cells(team) }
    }
    fn merge(&mut self, steps: u64, team: &Team) -> bool {
        self.merge_cells(steps, team)
    }
    fn footprints(&self, time: f64, visit: &mut dyn FnMut(&Footprint<'_, D>)) {
        self.show_footprints(time, visit);
    }
}

const _: () = assert!(block_nodes(3) <= u8::MAX as usize + 1, "bins are numbered by bytes");
