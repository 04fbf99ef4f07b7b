//! Verlet lists: neighbour lists with a skin, reused over steps.

use std::marker::PhantomData;

use impactite_simd::Team;

use super::cells::SortedCells;
use super::error::{SearchError, check_length};
use super::lists::NeighbourLists;
use super::points::{Points, Reach, distance_squared};
use super::{NeighbourSearch, SearchMethod};

/// Verlet neighbour lists with a skin \[Verlet1967\]: built for the reach plus the skin, and reused until one point has consumed half of
/// the skin, by its displacement relative to the mean displacement and the growth of its radius together, or until the number of points
/// changes. A rigid translation of all points needs no new search.
///
/// Until then every list contains all points within reach, in ascending order, and some beyond it: by up to two skins,
/// plus the shrinkage of radii.
///
/// ```
/// use impactite_geometry::search::{Points, Reach, SearchError, VerletLists};
/// use impactite_simd::Team;
/// let mut lists = VerletLists::<1>::new(Reach::uniform(1.0), 0.2)?;
/// for step in 0..10 {
///     // They fly, and come nearer.
///     let at = f64::from(step);
///     let positions = [[at], [at + 1.0 - 0.03 * at]];
///     lists.update(&Points::of_positions(&positions)?, &Team::one())?;
///     assert_eq!(lists.of(0), [1]);
/// }
/// // A search at the start, and one after every sixth step: each moves by 0.015 beside the mean.
/// assert_eq!(lists.searches(), 2);
/// # Ok::<(), SearchError>(())
/// ```
#[derive(Clone, Debug)]
pub struct VerletLists<const D: usize, S = SortedCells<D>> {
    reach: Reach,
    skin: f64,
    lists: NeighbourLists,
    seen: Seen<D>,
    valid: bool,
    searches: u64,
    search: PhantomData<fn() -> S>,
}

impl<const D: usize, S: NeighbourSearch<D>> VerletLists<D, S> {
    /// Create lists of pairs within `reach`, with a skin (m).
    ///
    /// # Errors
    /// Parameters of the reach, or a skin, that are negative, not finite or too large.
    pub fn new(reach: Reach, skin: f64) -> Result<Self, SearchError> {
        check_length("skin", skin)?;
        reach.check(0.0)?;
        Ok(VerletLists {
            reach,
            skin,
            lists: NeighbourLists::new(),
            seen: Seen::default(),
            valid: false,
            searches: 0,
            search: PhantomData,
        })
    }

    /// Criterion for neighbours, without the skin.
    pub fn reach(&self) -> Reach {
        self.reach
    }
    /// Skin thickness (m).
    pub fn skin(&self) -> f64 {
        self.skin
    }
    /// Neighbours of point `i` and some points beyond reach, in ascending order.
    ///
    /// # Panics
    /// Panics if there was no such point at the last update.
    #[inline]
    pub fn of(&self, i: usize) -> &[u32] {
        self.lists.of(i)
    }
    /// Neighbour lists of all points.
    pub fn lists(&self) -> &NeighbourLists {
        &self.lists
    }
    /// Number of searches so far.
    pub fn searches(&self) -> u64 {
        self.searches
    }
    /// Invalidate the lists: the next update searches.
    pub fn forget(&mut self) {
        self.valid = false;
    }
    /// Replace the lists by empty ones for this number of points and invalidate them: for points that cannot be searched.
    pub fn clear(&mut self, points: usize) {
        self.valid = false;
        self.lists.clear(points);
    }

    /// Search again if the lists may miss a pair. Returns true after a search.
    ///
    /// # Errors
    /// Errors of [`NeighbourSearch::neighbours_into`] and [`NeighbourSearch::new`]; all lists are then empty, and the next update
    /// searches.
    pub fn update(&mut self, points: &Points<'_, D>, team: &Team) -> Result<bool, SearchError> {
        self.update_by(points, |points, wide, lists| S::new(points, wide)?.neighbours_into(team, lists))
    }

    /// Update the lists by a search method chosen at run time: see [`update`](VerletLists::update).
    ///
    /// # Errors
    /// Errors of [`update`](VerletLists::update).
    pub fn update_with(
        &mut self,
        method: SearchMethod,
        points: &Points<'_, D>,
        team: &Team,
    ) -> Result<bool, SearchError> {
        self.update_by(points, |points, wide, lists| method.sort(points, wide)?.neighbours_into(team, lists))
    }

    fn update_by(
        &mut self,
        points: &Points<'_, D>,
        search: impl FnOnce(&Points<'_, D>, Reach, &mut NeighbourLists) -> Result<(), SearchError>,
    ) -> Result<bool, SearchError> {
        if self.hold((0..points.len()).map(|i| (points.positions()[i], points.radius(i)))) {
            return Ok(false);
        }
        self.searches += 1;
        self.valid = false;
        let found = search(points, self.reach.widened(self.skin), &mut self.lists);
        if let Err(refused) = found {
            self.clear(points.len());
            return Err(refused);
        }
        self.seen.note(points);
        self.valid = true;
        Ok(true)
    }

    /// True if the lists miss no pair of points at these positions with these radii (m). A check without copying;
    /// [`update`](VerletLists::update) includes it.
    pub fn hold(&self, points: impl ExactSizeIterator<Item = ([f64; D], f64)> + Clone) -> bool {
        self.valid && self.seen.hold(points, 0.5 * self.skin, self.reach.slope())
    }
}

/// Positions and radii at the last search.
#[derive(Clone, Debug)]
struct Seen<const D: usize> {
    positions: Vec<[f64; D]>,
    radii: Vec<f64>,
}

impl<const D: usize> Default for Seen<D> {
    fn default() -> Self {
        Seen { positions: Vec::new(), radii: Vec::new() }
    }
}

impl<const D: usize> Seen<D> {
    fn bytes(&self) -> usize {
        self.positions.capacity() * size_of::<[f64; D]>() + self.radii.capacity() * 8
    }

    fn note(&mut self, points: &Points<'_, D>) {
        self.positions.clear();
        self.positions.extend_from_slice(points.positions());
        self.radii.clear();
        self.radii.extend((0..points.len()).map(|i| points.radius(i)));
    }

    /// True if no point has consumed `slack` (m), by its displacement relative to `drift` (m) and `slope` times the growth of its radius.
    fn hold_beside(
        &self,
        points: impl ExactSizeIterator<Item = ([f64; D], f64)>,
        (slack, slope): (f64, f64),
        drift: &[f64; D],
    ) -> bool {
        self.positions.len() == points.len()
            && points.zip(&self.positions).zip(&self.radii).all(|(((x, radius), before), old)| {
                let left = slack - slope * (radius - old).max(0.0);
                let there = std::array::from_fn(|d| before[d] + drift[d]);
                left >= 0.0 && distance_squared(&x, &there) <= left * left
            })
    }

    /// True if no point has consumed `slack` (m), relative to zero or to the mean displacement of all points.
    fn hold(
        &self,
        points: impl ExactSizeIterator<Item = ([f64; D], f64)> + Clone,
        slack: f64,
        slope: f64,
    ) -> bool {
        if self.hold_beside(points.clone(), (slack, slope), &[0.0; D]) {
            return true;
        }
        let mut drift = [0.0; D];
        for ((x, _), before) in points.clone().zip(&self.positions) {
            (0..D).for_each(|d| drift[d] += (x[d] - before[d]) / self.positions.len() as f64);
        }
        self.hold_beside(points, (slack, slope), &drift)
    }
}

/// Verlet neighbour lists between two sets, with a skin like [`VerletLists`]: for every point of the second set the points of the first
/// set within reach, and some beyond.
///
/// ```
/// use impactite_geometry::search::{Points, Reach, SearchError, VerletListsBetween};
/// use impactite_simd::Team;
/// let mut lists = VerletListsBetween::<1>::new(Reach::sum(0.0), 0.2)?;
/// for step in 0..10 {
///     let (wall, ball) = ([[0.0]], [[1.5 - 0.04 * f64::from(step)]]);
///     lists.update(&Points::new(&wall, &[0.9])?, &Points::new(&ball, &[0.5])?, &Team::one())?;
///     assert_eq!(lists.of(0), [0]);
/// }
/// assert_eq!(lists.searches(), 4);
/// # Ok::<(), SearchError>(())
/// ```
#[derive(Clone, Debug)]
pub struct VerletListsBetween<const D: usize, S = SortedCells<D>> {
    reach: Reach,
    skin: f64,
    /// Skin of the current lists (m).
    skin_then: f64,
    lists: NeighbourLists,
    seen: [Seen<D>; 2],
    valid: bool,
    searches: u64,
    search: PhantomData<fn() -> S>,
}

impl<const D: usize, S: NeighbourSearch<D>> VerletListsBetween<D, S> {
    /// Create lists of pairs within `reach`, with a skin (m).
    ///
    /// # Errors
    /// Errors of [`VerletLists::new`].
    pub fn new(reach: Reach, skin: f64) -> Result<Self, SearchError> {
        check_length("skin", skin)?;
        reach.check(0.0)?;
        let seen = [Seen::default(), Seen::default()];
        let lists = NeighbourLists::new();
        let (skin_then, valid, searches, search) = (skin, false, 0, PhantomData);
        Ok(VerletListsBetween { reach, skin, skin_then, lists, seen, valid, searches, search })
    }

    /// Skin thickness (m).
    pub fn skin(&self) -> f64 {
        self.skin
    }
    /// Set the skin thickness (m) of future searches.
    ///
    /// # Errors
    /// A skin that is negative, not finite or too large.
    pub fn set_skin(&mut self, skin: f64) -> Result<(), SearchError> {
        check_length("skin", skin)?;
        self.skin = skin;
        Ok(())
    }
    /// Points of the first set near point `i` of the second set, in ascending order.
    ///
    /// # Panics
    /// Panics if there was no such point at the last update.
    #[inline]
    pub fn of(&self, i: usize) -> &[u32] {
        self.lists.of(i)
    }
    /// Memory in bytes.
    pub fn bytes(&self) -> usize {
        self.lists.bytes() + self.seen.iter().map(Seen::bytes).sum::<usize>()
    }
    /// Number of searches so far.
    pub fn searches(&self) -> u64 {
        self.searches
    }
    /// Invalidate the lists: the next update searches.
    pub fn forget(&mut self) {
        self.valid = false;
    }

    /// Search again if the lists may miss a pair of `points` and `others`. Returns true after a search.
    ///
    /// # Errors
    /// Errors of [`VerletLists::update`].
    pub fn update(
        &mut self,
        points: &Points<'_, D>,
        others: &Points<'_, D>,
        team: &Team,
    ) -> Result<bool, SearchError> {
        let (half, slope) = (0.5 * self.skin_then, self.reach.slope());
        // No mean displacement is subtracted: the two sets move independently.
        let hold = |seen: &Seen<D>, now: &Points<'_, D>| {
            let now = (0..now.len()).map(|i| (now.positions()[i], now.radius(i)));
            seen.hold_beside(now, (half, slope), &[0.0; D])
        };
        if self.valid && hold(&self.seen[0], points) && hold(&self.seen[1], others) {
            return Ok(false);
        }
        self.searches += 1;
        self.valid = false;
        let wide = self.reach.widened(self.skin);
        match S::new(points, wide).and_then(|search| search.neighbours_of(others, team)) {
            Ok(found) => self.lists = found,
            Err(refused) => {
                self.lists.clear(others.len());
                return Err(refused);
            }
        }
        self.seen[0].note(points);
        self.seen[1].note(others);
        (self.skin_then, self.valid) = (self.skin, true);
        Ok(true)
    }
}
