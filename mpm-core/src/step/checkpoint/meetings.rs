//! Node blocks and contact in a checkpoint.

use super::{Archive, CheckpointError};
use crate::dim::block_nodes;
use crate::parallel::Float;
use crate::step::contact::{Found, Pair, PairContact, Touch};
use crate::step::encounters::Encounters;
use crate::step::fields::{Claim, Fields};

impl<const D: usize> Fields<D> {
    /// Who claimed which blocks when they were arranged last.
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

impl<T: Float> Encounters<T> {
    /// What is known of bodies that meet, and what was booked; blocks are arranged as they were.
    pub(super) fn exchange<const D: usize>(
        &mut self,
        file: &mut Archive,
        fields: &Fields<D>,
    ) -> Result<(), CheckpointError> {
        let bodies = self.way.len();
        file.reals(&mut self.way)?;
        let shared = fields.shared().len();
        file.same("number of shared blocks", &shared.to_string())?;
        let mut block = 0;
        file.list(&mut self.found, &Found::default(), |file, found| {
            let members = (block < shared).then(|| fields.members(block).len());
            block += 1;
            found.exchange::<D>(file, members, bodies)
        })?;
        if block < shared {
            return Err(file.damaged("blocks that bodies share are missing"));
        }
        file.list(&mut self.pairs, &PairContact::new([0; 2]), |file, pair| {
            let PairContact { bodies, force, nodes, gap, friction, taken } = pair;
            bodies.iter_mut().try_for_each(|b| file.count(b))?;
            file.reals(force)?;
            file.count(nodes)?;
            file.option(gap, Archive::real)?;
            file.reals([friction, taken])
        })
    }
}

impl<T: Float> Found<T> {
    fn exchange<const D: usize>(
        &mut self,
        file: &mut Archive,
        members: Option<usize>,
        bodies: usize,
    ) -> Result<(), CheckpointError> {
        let Found { pairs, touches, stale, block } = self;
        block.iter_mut().try_for_each(|x| file.integer(x))?;
        file.flag(stale)?;
        // What is about to be forgotten has fields that are gone, and tells of its bodies alone.
        let members = members.filter(|_| !*stale).unwrap_or(u32::MAX as usize);
        file.list(pairs, &Pair::new([0; 2], [0; 2]), |file, pair| {
            let Pair { fields, bodies: of, known, lasts, friction, taken, way } = pair;
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
