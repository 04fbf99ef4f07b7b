//! Batch of particle groups for the constitutive law: data that a pass gathers before one call of the law for all groups,
//! and loads again in the stages after it.
//!
//! Each group has a **slot**: an index in the list that the law receives. If one vector has two groups, their slots are
//! adjacent, the first one even; a single group leaves the other slot empty.

use mpm_materials::material::{Deformation, NO_GROUP, PairOutput, Response};
use mpm_materials::{Breakdown, Mat3, Sym3};

use super::spread::MAX_LANES;
use crate::particles::Members;
use impactite_simd::{Float, Pack, RowPair};

/// Particles that pass through the stages together.
#[derive(Clone, Copy, Debug)]
pub(in crate::step) struct Entry {
    /// Groups of the particles.
    pub(in crate::step) members: Members,
    /// Number of particles.
    pub(in crate::step) here: u32,
    /// Slot of the first group.
    slot: u32,
}

impl Entry {
    /// Index of the pair of slots that contains the first group.
    #[inline(always)]
    fn pair(&self) -> usize {
        self.slot as usize / 2
    }
    /// Position of the first group in its pair: 0 or 1.
    #[inline(always)]
    fn half(&self) -> usize {
        self.slot as usize % 2
    }
}

/// The entries of a bin.
#[derive(Clone, Copy, Debug)]
pub(in crate::step) struct BinEntries {
    /// Index of the bin.
    pub(in crate::step) number: u32,
    /// First entry, and one past the last.
    pub(in crate::step) entries: [u32; 2],
}

/// Group in a slot.
#[derive(Clone, Copy, Debug)]
pub(in crate::step) struct Occupant {
    /// Bin of the group.
    pub(in crate::step) bin: u32,
    /// Number of particles.
    pub(in crate::step) here: u32,
}

/// Input and output of a call of the law.
pub(in crate::step) struct ForLaw<'a, T: Float> {
    /// Groups, by index in their block.
    pub(in crate::step) groups: &'a [u32],
    /// Deformation of the groups.
    pub(in crate::step) deformation: &'a [Deformation<T::Row>],
    /// Buffer for the response of the law.
    pub(in crate::step) response: &'a mut Response<T>,
}

/// Input and output of the mean dilatation.
pub(in crate::step) struct ForMean<'a, T: Float> {
    /// Groups, by index in their block.
    pub(in crate::step) groups: &'a [u32],
    /// Bin and number of particles of each group.
    pub(in crate::step) occupants: &'a [Occupant],
    /// Deformation of the groups.
    pub(in crate::step) deformations: &'a mut [Deformation<T::Row>],
    /// Buffer for the volume ratios, one row per group.
    pub(in crate::step) ratios: &'a mut [T::Row],
}

/// Batch of groups for the law: memory of a thread. The leading elements of each list are in use.
#[derive(Debug, Default)]
pub(in crate::step) struct LawBatch<T: Float> {
    entries: Vec<Entry>,
    entered: usize,
    bins: Vec<BinEntries>,
    groups: Vec<u32>,
    slots: usize,
    deformations: Vec<Deformation<T::Row>>,
    /// Rows for the later stages, `numbers_kept` for two slots.
    kept: Vec<RowPair<T::Row>>,
    numbers_kept: usize,
    ratios: Vec<T::Row>,
    occupants: Vec<Occupant>,
    response: Response<T>,
}

impl<T: Float> LawBatch<T> {
    /// Remove all groups.
    #[inline(always)]
    pub(in crate::step) fn clear(&mut self) {
        self.entered = 0;
        self.slots = 0;
        self.bins.clear();
    }
    /// Number of groups.
    #[inline(always)]
    pub(in crate::step) fn groups(&self) -> usize {
        self.slots
    }
    /// Allocated memory, bytes.
    pub(in crate::step) fn bytes(&self) -> usize {
        self.entries.capacity() * size_of::<Entry>()
            + self.bins.capacity() * size_of::<BinEntries>()
            + self.groups.capacity() * size_of::<u32>()
            + self.occupants.capacity() * size_of::<Occupant>()
            + self.deformations.capacity() * size_of::<Deformation<T::Row>>()
            + self.kept.capacity() * size_of::<RowPair<T::Row>>()
            + self.ratios.capacity() * size_of::<T::Row>()
            + self.response.bytes()
    }

    /// Begin a bin with this number of `groups`, each with `numbers_kept` rows for the later stages.
    #[inline(always)]
    pub(in crate::step) fn open(&mut self, groups: usize, numbers_kept: usize) -> BatchWriter<'_, T> {
        self.numbers_kept = numbers_kept;
        // One extra slot, for a single group.
        let slots = self.slots + groups + 1;
        if self.groups.len() < slots || self.kept.len() < slots.div_ceil(2) * numbers_kept {
            self.grow(slots);
        }
        BatchWriter {
            entries: &mut self.entries,
            entered: self.entered,
            groups: &mut self.groups,
            slots: self.slots,
            deformations: &mut self.deformations,
            kept: &mut self.kept,
            numbers_kept,
        }
    }
    #[cold]
    #[inline(never)]
    fn grow(&mut self, slots: usize) {
        let slots = slots.max(self.groups.len());
        let nobody = Members { groups: [0; 2], lane: 0 };
        self.entries.resize(slots * T::GROUP, Entry { members: nobody, here: 0, slot: 0 });
        self.groups.resize(slots, 0);
        self.ratios.resize(slots, T::Row::default());
        let pairs = slots.div_ceil(2);
        self.deformations.resize(pairs, Deformation::default());
        self.kept.resize(pairs * self.numbers_kept.max(1), RowPair::default());
    }
    /// End a bin, given the numbers of entries and slots that the writer counted.
    #[inline(always)]
    pub(in crate::step) fn close(&mut self, bin: usize, [entered, slots]: [usize; 2]) {
        let entries = [self.entered as u32, entered as u32];
        self.bins.push(BinEntries { number: bin as u32, entries });
        (self.entered, self.slots) = (entered, slots);
    }

    /// Groups, their deformation and the response buffer, for a call of the law.
    #[inline(always)]
    pub(in crate::step) fn for_law(&mut self) -> ForLaw<'_, T> {
        ForLaw {
            groups: &self.groups[..self.slots],
            deformation: &self.deformations,
            response: &mut self.response,
        }
    }
    /// Groups, their occupants, deformation and a row buffer, for the mean dilatation.
    pub(in crate::step) fn for_mean(&mut self) -> ForMean<'_, T> {
        let occupants = &mut self.occupants;
        occupants.clear();
        occupants.resize(self.slots, Occupant { bin: u32::MAX, here: 0 });
        for bin in &self.bins {
            for entry in &self.entries[bin.entries[0] as usize..bin.entries[1] as usize] {
                let (first, [one, two]) = (entry.slot as usize, entry.members.groups);
                // Lanes are processed one by one, or all from the first on.
                let last = entry.members.lane + entry.here;
                let of = |here: u32| Occupant { bin: bin.number, here };
                if one == two {
                    let here = occupants[first].here.max(last);
                    occupants[first] = of(here);
                    if let Some(beside) =
                        occupants.get_mut(first + 1).filter(|_| self.groups[first + 1] == NO_GROUP)
                    {
                        *beside = of(0);
                    }
                } else {
                    occupants[first] = of(T::GROUP as u32);
                    occupants[first + 1] = of(last - T::GROUP as u32);
                }
            }
        }
        let (groups, ratios) = (&self.groups[..self.slots], &mut self.ratios[..self.slots]);
        ForMean { groups, occupants: &self.occupants, deformations: &mut self.deformations, ratios }
    }
    /// Return a reader of the results.
    #[inline(always)]
    pub(in crate::step) fn reader(&self) -> BatchReader<'_, T> {
        BatchReader {
            bins: &self.bins,
            entries: &self.entries,
            deformations: &self.deformations,
            kept: &self.kept,
            numbers_kept: self.numbers_kept,
            outputs: self.response.outputs(),
        }
    }

    /// Return the first particle whose law failed: its bin, entry, lane in the entry and the cause.
    #[inline(always)]
    pub(in crate::step) fn first_fault<P: Pack<T>>(&self) -> Option<(usize, Entry, usize, Breakdown)> {
        if self.response.faults().is_empty() { None } else { self.find_fault::<P>() }
    }
    #[cold]
    #[inline(never)]
    fn find_fault<P: Pack<T>>(&self) -> Option<(usize, Entry, usize, Breakdown)> {
        self.response.faults().iter().find_map(|fault| {
            let n = (0..self.entered)
                .find(|&n| lane_in::<T, P>(&self.entries[n], fault.group, fault.lane).is_some())?;
            let lane = lane_in::<T, P>(&self.entries[n], fault.group, fault.lane)?;
            let bin = self.bins.iter().find(|bin| n < bin.entries[1] as usize)?;
            Some((bin.number as usize, self.entries[n], lane, fault.cause))
        })
    }
}

/// Return the lane in an entry of the particle in a lane of a slot, if it is there.
fn lane_in<T: Float, P: Pack<T>>(entry: &Entry, slot: usize, lane: usize) -> Option<usize> {
    let alone = entry.members.groups[0] == entry.members.groups[1];
    let n = slot.checked_sub(entry.slot as usize).filter(|n| *n < 2 - usize::from(alone))?;
    let lane =
        if P::WIDTH == 1 { lane.checked_sub(entry.members.lane as usize)? } else { n * T::GROUP + lane };
    (lane < entry.here as usize).then_some(lane)
}

/// Writer for the groups of a bin.
pub(in crate::step) struct BatchWriter<'a, T: Float> {
    entries: &'a mut [Entry],
    entered: usize,
    groups: &'a mut [u32],
    slots: usize,
    deformations: &'a mut [Deformation<T::Row>],
    kept: &'a mut [RowPair<T::Row>],
    numbers_kept: usize,
}

impl<T: Float> BatchWriter<'_, T> {
    /// Append particles.
    #[inline(always)]
    pub(in crate::step) fn enter<P: Pack<T>>(&mut self, members: Members, here: usize) -> Entry {
        let [one, two] = members.groups;
        let mut slot = self.slots;
        if P::WIDTH == 1 && slot > 0 && self.groups[slot - 1] == one {
            // Another lane of the same group.
            slot -= 1;
        } else {
            self.groups[slot] = one;
            self.slots += 1;
            if P::WIDTH == 1 {
                self.deformations[slot / 2].step.0[slot % 2] = T::Row::default();
            }
            if P::GROUPS > 1 {
                self.groups[slot + 1] = if two == one { NO_GROUP } else { two };
                self.slots += 1;
            }
        }
        let entry = Entry { members, here: here as u32, slot: slot as u32 };
        self.entries[self.entered] = entry;
        self.entered += 1;
        entry
    }

    /// Store the deformation of particles: gradient, and factor that makes it an increment.
    #[inline(always)]
    pub(in crate::step) fn put_gradient<P: Pack<T>>(&mut self, entry: &Entry, gradient: &Mat3<P>, step: P) {
        let (half, lane) = (entry.half(), entry.members.lane as usize);
        let to = &mut self.deformations[entry.pair()];
        for i in 0..3 {
            for j in 0..3 {
                gradient.0[i][j].to_pair(&mut to.gradient[3 * i + j], half, lane);
            }
        }
        step.to_pair(&mut to.step, half, lane);
    }

    /// Store numbers for the later stages.
    #[inline(always)]
    pub(in crate::step) fn keep<P: Pack<T>>(
        &mut self,
        entry: &Entry,
        count: usize,
        number: impl Fn(usize) -> P,
    ) {
        let rows = &mut self.kept[entry.pair() * self.numbers_kept..][..count];
        for (at, row) in rows.iter_mut().enumerate() {
            number(at).to_pair(row, entry.half(), entry.members.lane as usize);
        }
    }

    /// Numbers of entries and slots so far.
    #[inline(always)]
    pub(in crate::step) fn counted(&self) -> [usize; 2] {
        [self.entered, self.slots]
    }
}

/// Reader of the results of groups.
#[derive(Clone, Copy)]
pub(in crate::step) struct BatchReader<'a, T: Float> {
    /// Bins with entries.
    pub(in crate::step) bins: &'a [BinEntries],
    entries: &'a [Entry],
    deformations: &'a [Deformation<T::Row>],
    kept: &'a [RowPair<T::Row>],
    numbers_kept: usize,
    outputs: &'a [PairOutput<T::Row>],
}

impl<'a, T: Float> BatchReader<'a, T> {
    /// Entries of a bin.
    #[inline(always)]
    pub(in crate::step) fn entries(&self, bin: &BinEntries) -> &'a [Entry] {
        &self.entries[bin.entries[0] as usize..bin.entries[1] as usize]
    }

    /// Load the gradient of particles, as stored by the writer.
    #[inline(always)]
    pub(in crate::step) fn gradient<const D: usize, P: Pack<T>>(
        &self,
        entry: &Entry,
        gradient: &mut [[P; 3]; 3],
    ) {
        let from = &self.deformations[entry.pair()].gradient;
        for i in 0..D {
            for j in 0..D {
                gradient[i][j] = P::from_pair(&from[3 * i + j], entry.half(), entry.members.lane as usize);
            }
        }
    }

    /// Load the numbers stored for the later stages.
    #[inline(always)]
    pub(in crate::step) fn kept<P: Pack<T>>(
        &self,
        entry: &Entry,
        count: usize,
        mut take: impl FnMut(usize, P),
    ) {
        let rows = &self.kept[entry.pair() * self.numbers_kept..][..count];
        for (at, row) in rows.iter().enumerate() {
            take(at, P::from_pair(row, entry.half(), entry.members.lane as usize));
        }
    }

    /// Load the response of the law: stress, volume ratio and, if requested, wave speed.
    #[inline(always)]
    pub(in crate::step) fn outputs<P: Pack<T>>(&self, entry: &Entry, speeds: bool) -> (Sym3<P>, P, P) {
        let (output, half, lane) = (&self.outputs[entry.pair()], entry.half(), entry.members.lane as usize);
        let mut stress = Sym3::zero();
        for i in 0..6 {
            stress.0[i] = P::from_pair(&output.stress[i], half, lane);
        }
        let ratio = P::from_pair(&output.volume_ratio, half, lane);
        (stress, ratio, if speeds { P::from_pair(&output.step_speed, half, lane) } else { P::zero() })
    }

    /// Load the velocity gradient of particles, 1/s, D x D numbers each: the stored gradient times `unit`.
    #[cold]
    #[inline(never)]
    pub(in crate::step) fn gradients<const D: usize, P: Pack<T>>(
        &self,
        entry: &Entry,
        unit: T,
        gradients: &mut [[T; MAX_LANES]; 9],
    ) {
        for lane in 0..entry.here as usize {
            let (half, at) = if P::WIDTH == 1 {
                (entry.half(), entry.members.lane as usize)
            } else {
                (entry.half() + lane / T::GROUP, lane % T::GROUP)
            };
            let gradient = &self.deformations[entry.pair()].gradient;
            for i in 0..D * D {
                gradients[i][lane] = gradient[3 * (i / D) + i % D].0[half].as_ref()[at] * unit;
            }
        }
    }
}
