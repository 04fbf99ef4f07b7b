//! Node blocks and contact in a checkpoint.

use crate::dim::block_nodes;
use crate::step::contact::{BlockContacts, ContactMemory, ContactState, Key, OFFSET, Pair, Touch};
use crate::step::nodes::fields::Fields;
use crate::step::nodes::layout::Claim;
use impactite_scene::{Archive, CheckpointError, PairContact};
use impactite_simd::Float;

impl<const D: usize> Fields<D> {
    /// Write or read the claims of bodies to node blocks in the last arrangement.
    pub(super) fn exchange(&mut self, file: &mut Archive, bodies: usize) -> Result<(), CheckpointError> {
        let blank = Claim { coordinates: [0; D], body: 0, reached: 0 };
        file.list(&mut self.claims, &blank, |file, claim| {
            let Claim { coordinates, body, reached } = claim;
            coordinates.iter_mut().try_for_each(|x| file.integer(x))?;
            file.index(body, bodies)?;
            file.word(reached)
        })
    }
}

impl<T: Float> ContactState<T> {
    /// Write or read the state and books of contact; blocks are arranged as they were.
    pub(super) fn exchange<const D: usize>(
        &mut self,
        file: &mut Archive,
        fields: &Fields<D>,
        remembers: usize,
    ) -> Result<(), CheckpointError> {
        let bodies = self.way.len();
        file.reals(&mut self.way)?;
        let shared = fields.shared().len();
        file.same("number of shared blocks", &shared.to_string())?;
        let mut block = 0;
        file.list(&mut self.found, &BlockContacts::default(), |file, found| {
            let members = (block < shared).then(|| fields.members(block).len());
            block += 1;
            found.exchange::<D>(file, members, bodies)
        })?;
        if block < shared {
            return Err(file.damaged("blocks that bodies share are missing"));
        }
        if remembers > 0 {
            self.memory.exchange(file, remembers, bodies)?;
        }
        file.list(&mut self.pairs, &PairContact::new([0; 2]), |file, pair| pair.archive(file))
    }
}

impl ContactMemory {
    /// Write or read the state variables of contact laws.
    fn exchange(
        &mut self,
        file: &mut Archive,
        numbers: usize,
        all_bodies: usize,
    ) -> Result<(), CheckpointError> {
        self.width = OFFSET + numbers;
        let mut count = 0;
        let blank: (Key, usize) = (([0; 2], [0; 3]), 0);
        file.list(&mut self.keys, &blank, |file, ((bodies, node), start)| {
            bodies.iter_mut().try_for_each(|b| file.index(b, all_bodies))?;
            *start = count;
            count += OFFSET + numbers;
            node.iter_mut().try_for_each(|x| {
                let mut word = i64::from(*x) as u64;
                file.word(&mut word)?;
                let read = i32::try_from(word as i64);
                *x = read.map_err(|_| file.damaged(format!("{word:#x} is no node")))?;
                Ok(())
            })
        })?;
        self.numbers.resize(count, 0.0);
        file.reals(&mut self.numbers)?;
        let sorted = self.keys.windows(2).all(|two| two[0].0 < two[1].0);
        let sound = sorted && self.numbers.iter().all(|x| x.is_finite());
        if sound { Ok(()) } else { Err(file.damaged("contacts remember what none can")) }
    }
}

impl<T: Float> BlockContacts<T> {
    fn exchange<const D: usize>(
        &mut self,
        file: &mut Archive,
        members: Option<usize>,
        bodies: usize,
    ) -> Result<(), CheckpointError> {
        // The contact memory of touches is restored in every step.
        let BlockContacts { pairs, touches, memory: _, stale, block } = self;
        block.iter_mut().try_for_each(|x| file.integer(x))?;
        file.flag(stale)?;
        // The fields of stale contacts no longer exist; only their bodies are valid.
        let members = members.filter(|_| !*stale).unwrap_or(u32::MAX as usize);
        file.list(pairs, &Pair::new([0; 2], [0; 2]), |file, pair| {
            let Pair { fields, bodies: of, known, lasts, remembers: _, friction, taken, way } = pair;
            fields.iter_mut().try_for_each(|f| file.index(f, members))?;
            of.iter_mut().try_for_each(|b| file.index(b, bodies))?;
            file.word(known)?;
            file.flag(lasts)?;
            file.reals([friction, taken, way])
        })?;
        let count = pairs.len();
        file.list(touches, &Touch::default(), |file, touch| {
            let Touch { node, acts, image, pair, normal, gap, impulse } = touch;
            let mut place = u32::from(*node);
            file.index(&mut place, block_nodes(D))?;
            *node = place as u8;
            file.flag(acts)?;
            file.flag(image)?;
            file.index(pair, count)?;
            file.numbers(normal)?;
            file.option(gap, |file, gap| file.numbers([gap]))?;
            file.numbers(impulse)
        })
    }
}
