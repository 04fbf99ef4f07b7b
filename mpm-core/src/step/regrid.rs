//! Smaller cells where criteria ask for them while a scene runs.
//!
//! Every few steps the criteria mark blocks, whose cells are halved: the step that follows is made on the former cells, and
//! at its end the particles of these blocks leave for the smaller ones, as those do that enter a refined region. Cells are
//! not enlarged again: particles keep their size. Decisions depend on the particles alone, in the order of bodies and blocks.

use std::collections::{BTreeSet, HashSet};
use std::sync::Arc;

use super::criteria::{Adaptive, Criterion, OccupiedBlock, RegridView, centre_of};
use super::mpm::Mpm;
use super::nodes::layout::numbers;
use crate::dim::{BLOCK, centre, neighbours, offset, shifted};
use crate::grid::levels::{Levels, MOST_LEVELS, unpack_block};
use impactite_scene::archive::{Archive, CheckpointError};
use impactite_scene::error::{SceneError, StepError, Stopped};
use impactite_simd::Float;

/// Block of a level.
type BlockAt<const D: usize> = (usize, [i32; D]);

/// Return the blocks to refine with the empty ones around them and around the small cells that are there. At a free surface the nodes
/// are then those of the small cells, instead of dependent ones.
fn with_void<const D: usize>(
    levels: &Levels<D>,
    mut wanted: BTreeSet<BlockAt<D>>,
    occupied: &HashSet<BlockAt<D>>,
) -> BTreeSet<BlockAt<D>> {
    let around = |block: [i32; D]| (0..neighbours(D)).map(move |n| shifted(&block, &offset(n)));
    let halved = |block: [i32; D]| block.map(|b| b.div_euclid(2));
    let of_wanted = wanted.iter().flat_map(|&(level, block)| around(block).map(move |at| (level, at)));
    let of_small = occupied.iter().filter(|(level, _)| *level > 0);
    let of_small = of_small.flat_map(|&(level, block)| around(block).map(move |at| (level - 1, halved(at))));
    let empty: BTreeSet<BlockAt<D>> = of_wanted
        .chain(of_small)
        .filter(|at| !occupied.contains(at) && !levels.is_refined(at.0, &at.1) && !wanted.contains(at))
        .collect();
    // The coarser blocks around a refined one are refined, too: only those without particles are for free.
    let free = |&(level, block): &BlockAt<D>| {
        level == 0
            || around(block).map(halved).all(|coarser| {
                let at = (level - 1, coarser);
                levels.is_refined(at.0, &at.1) || wanted.contains(&at) || !occupied.contains(&at)
            })
    };
    let free: Vec<BlockAt<D>> = empty.into_iter().filter(free).collect();
    wanted.extend(free);
    wanted
}

/// Number of steps between two decisions.
const EVERY: u64 = 20;

impl<const D: usize, T: Float> Mpm<D, T> {
    /// Halve the cells of blocks that a criterion marks, at most `halvings` times, decided every twenty steps while the scene
    /// runs. Particles are divided with their cells; cells are not enlarged again. Criteria of earlier calls, with their halvings, and
    /// regions of [`Mpm::refine`], set before, remain.
    ///
    /// # Errors
    /// Errors of [`Mpm::refine`].
    pub fn refine_where(
        &mut self,
        criteria: Vec<Box<dyn Criterion<T, D>>>,
        halvings: usize,
    ) -> Result<(), SceneError> {
        if !(1..=MOST_LEVELS).contains(&halvings) {
            let allowed = "from 1 to 7";
            return Err(SceneError::Refinement { field: "halvings", value: halvings as f64, allowed });
        }
        let halving = self.check_refinement()?;
        if self.grid.fields.levels().is_none() {
            let levels = Levels::new(*self.grid.lattice(), (halving, self.facts().nodes), Vec::new());
            self.grid.fields.set_levels(Arc::new(levels));
        }
        let adaptive = self.adaptive.get_or_insert_with(Adaptive::default);
        adaptive.criteria.extend(criteria.into_iter().map(|criterion| (criterion, halvings)));
        Ok(())
    }

    /// Decide which blocks get smaller cells, if due.
    ///
    /// # Errors
    /// A criterion whose parameters do not fit the scene.
    pub(super) fn plan_regrid(&mut self) -> Result<(), StepError> {
        let Some(adaptive) = &mut self.adaptive else { return Ok(()) };
        let due = adaptive.again || !adaptive.criteria.is_empty() && self.clock.steps.is_multiple_of(EVERY);
        if due && adaptive.starts.is_empty() {
            adaptive.starts = self.scene.bodies.iter().map(|body| centre_of(&**body)).collect();
        }
        let Some(adaptive) = &self.adaptive else { return Ok(()) };
        let Some(levels) = self.grid.fields.levels().filter(|_| due) else { return Ok(()) };
        let beside = centre(self.facts().nodes) - 0.5;
        let mut blocks = Vec::new();
        for (body, particles) in self.scene.bodies.iter().enumerate() {
            particles.presence().each_block(&mut |at, occupied| {
                let (halvings, block) = unpack_block(at);
                let lattice = levels.lattices().of(halvings);
                let (origin, h) = (lattice.origin(), lattice.spacing());
                // First and last layer of bins with particles along each axis.
                let mut ends = [[BLOCK, 0]; D];
                for bin in numbers(occupied) {
                    let mut rest = bin;
                    for [first, last] in &mut ends {
                        (*first, *last) = ((*first).min(rest % BLOCK), (*last).max(rest % BLOCK));
                        rest /= BLOCK;
                    }
                }
                let face = |d: usize, layer: usize| {
                    origin[d] + h * (f64::from(BLOCK as i32 * block[d] + layer as i32) + beside)
                };
                let (low, high) = (
                    std::array::from_fn(|d| face(d, ends[d][0])),
                    std::array::from_fn(|d| face(d, ends[d][1] + 1)),
                );
                blocks.push(OccupiedBlock { at: *at, body, halvings, low, high, edge: BLOCK as f64 * h });
            });
        }
        blocks.sort_by_key(|block| (block.body, block.at));
        let first = self.clock.steps == 0;
        let view = RegridView {
            bodies: &self.scene.bodies,
            boundaries: &self.scene.conditions.boundaries,
            blocks,
            starts: &adaptive.starts,
            team: &self.team,
            time: self.clock.time,
        };
        let (mut chosen, mut marked) = (BTreeSet::new(), Vec::new());
        for (criterion, halvings) in &adaptive.criteria {
            if first {
                let checked = criterion.check(&view);
                let refused = |why| {
                    let what = format!("the criterion of smaller cells `{}`", criterion.describe());
                    let method = self.facts().description.clone();
                    self.stopped(Stopped::Scene(SceneError::NotWith { what, method, why }))
                };
                checked.map_err(refused)?;
            }
            marked.clear();
            marked.resize(view.blocks.len(), false);
            criterion.mark(&view, &mut marked);
            let halved = view
                .blocks
                .iter()
                .zip(&marked)
                .filter(|(block, marked)| **marked && block.halvings < *halvings);
            chosen.extend(halved.map(|(block, _)| unpack_block(&block.at)));
        }
        let occupied = view.blocks.iter().map(|block| unpack_block(&block.at)).collect();
        let divides = !chosen.is_empty();
        let wanted = with_void(levels, chosen, &occupied);
        let next = levels.refined_also(wanted.into_iter());
        let Some(adaptive) = &mut self.adaptive else { return Ok(()) };
        // Criteria may ask for still smaller cells at once.
        adaptive.again = divides;
        if divides {
            // Waves cross smaller cells in less time.
            self.stepper.rate *= T::of(2.0);
        }
        adaptive.pending = next.map(Arc::new);
        Ok(())
    }

    /// Largest number of halvings that criteria may ask for.
    pub(super) fn most_halvings(&self) -> usize {
        let halvings =
            self.adaptive.iter().flat_map(|adaptive| &adaptive.criteria).map(|(_, halvings)| *halvings);
        halvings.max().unwrap_or(0)
    }

    /// Let the particles of blocks with new cells leave them in the next pass.
    pub(super) fn begin_regrid(&mut self) {
        if let Some(levels) = self.adaptive.as_ref().and_then(|adaptive| adaptive.pending.as_ref()) {
            self.scene.bodies.iter_mut().for_each(|body| body.set_levels(levels));
        }
    }

    /// Use the new cells from now on. Return true if there are any.
    pub(super) fn end_regrid(&mut self) -> bool {
        let Some(levels) = self.adaptive.as_mut().and_then(|adaptive| adaptive.pending.take()) else {
            return false;
        };
        self.grid.fields.set_levels(levels);
        true
    }

    /// True if a step is made on cells that are about to change.
    pub(super) fn regrids(&self) -> bool {
        self.adaptive.as_ref().is_some_and(|adaptive| adaptive.pending.is_some())
    }

    /// Write or read the cells of an adaptive scene.
    pub(super) fn archive_levels(&mut self, file: &mut Archive) -> Result<(), CheckpointError> {
        let described = self.adaptive.as_ref().map(|adaptive| {
            let criteria = adaptive.criteria.iter();
            let criteria: Vec<String> = criteria
                .map(|(criterion, halvings)| format!("{halvings} halvings, {}", criterion.describe()))
                .collect();
            format!("{}; {}", criteria.join("; "), adaptive.regions)
        });
        file.same("criteria and regions of smaller cells", &described.unwrap_or_else(|| "none".into()))?;
        let levels = self.grid.fields.levels().cloned();
        let Some(adaptive) = &mut self.adaptive else { return Ok(()) };
        file.flag(&mut adaptive.again)?;
        file.list(&mut adaptive.starts, &[0.0; D], |file, start| file.numbers(start))?;
        let Some(levels) = levels else { return Ok(()) };
        let mut refined = levels.refined().to_vec();
        file.list(&mut refined, &Vec::new(), |file, blocks| {
            file.list(blocks, &[0; D], |file, block| block.iter_mut().try_for_each(|x| file.integer(x)))
        })?;
        if file.reads() {
            let levels = Arc::new(levels.with_refined(refined));
            self.grid.fields.set_levels(levels.clone());
            self.scene.bodies.iter_mut().for_each(|body| body.set_levels(&levels));
        }
        Ok(())
    }
}
