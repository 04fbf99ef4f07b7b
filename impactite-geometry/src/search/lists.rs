//! Neighbour lists in compressed rows.

use std::sync::atomic::{AtomicUsize, Ordering};

use impactite_simd::Team;

use super::error::SearchError;

/// Points per task. Constant, so that results do not depend on the number of threads.
pub(super) const CHUNK: usize = 512;
/// Maximum average number of neighbours per point, for sets with more than [`ALWAYS`] neighbours in total.
const MOST_EACH: usize = 1024;
/// Total number of neighbours that is always allowed.
const ALWAYS: usize = 1 << 26;

/// Neighbour lists of all points in compressed sparse rows: all lists in one array, and the offset of each.
///
/// Every list is in ascending order, so that the order of summation does not depend on search, cells or threads.
///
/// ```
/// use impactite_geometry::search::{NeighbourSearch, Points, Reach, SearchError, SortedCells};
/// use impactite_simd::Team;
/// let positions = [[0.0], [1.0], [1.9], [5.0]];
/// let cells = SortedCells::new(&Points::of_positions(&positions)?, Reach::uniform(1.0))?;
/// let lists = cells.neighbours(&Team::one())?;
/// assert_eq!(lists.of(1), [0, 2]);
/// assert_eq!(lists.starts(), [0, 1, 3, 4, 4]);
/// assert_eq!(lists.list(), [1, 0, 2, 1]);
/// # Ok::<(), SearchError>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct NeighbourLists {
    /// Offsets of the lists: one more than the number of lists, or empty.
    starts: Vec<u32>,
    list: Vec<u32>,
}

impl NeighbourLists {
    /// Create an empty object without lists.
    pub fn new() -> Self {
        Self::default()
    }
    /// Memory in bytes.
    pub fn bytes(&self) -> usize {
        4 * (self.starts.capacity() + self.list.capacity())
    }
    /// Number of lists.
    pub fn len(&self) -> usize {
        self.starts.len().saturating_sub(1)
    }
    /// True if there are no lists.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
    /// Neighbours of point `i`, in ascending order.
    ///
    /// # Panics
    /// Panics if there is no such point.
    #[inline]
    pub fn of(&self, i: usize) -> &[u32] {
        &self.list[self.starts[i] as usize..self.starts[i + 1] as usize]
    }
    /// Offset of each list and end of the last one: one more than the number of lists, or empty if no lists were made.
    pub fn starts(&self) -> &[u32] {
        &self.starts
    }
    /// Concatenated lists of all points.
    pub fn list(&self) -> &[u32] {
        &self.list
    }
    /// Reset to `points` empty lists.
    pub(super) fn clear(&mut self, points: usize) {
        self.list.clear();
        self.starts.clear();
        self.starts.resize(points + 1, 0);
    }
}

/// Count of the neighbours found, with a limit of memory.
pub(super) struct Limit {
    points: usize,
    allowed: usize,
    found: AtomicUsize,
}

impl Limit {
    pub(super) fn new(points: usize) -> Self {
        let allowed = points.saturating_mul(MOST_EACH).clamp(ALWAYS, u32::MAX as usize);
        Limit { points, allowed, found: AtomicUsize::new(0) }
    }
    /// Add a number of neighbours. The result of the final check does not depend on the order.
    pub(super) fn add(&self, found: usize) {
        self.found.fetch_add(found, Ordering::Relaxed);
    }
    /// True if the neighbours found and `more` exceed the limit.
    #[inline]
    pub(super) fn passed(&self, more: usize) -> bool {
        self.found.load(Ordering::Relaxed).saturating_add(more) > self.allowed
    }
    pub(super) fn check(&self) -> Result<(), SearchError> {
        if self.passed(0) {
            Err(SearchError::Neighbours { points: self.points, allowed: self.allowed })
        } else {
            Ok(())
        }
    }
}

/// Neighbours found by a task, point by point.
#[derive(Clone, Default)]
pub(super) struct Rows {
    /// End of the list of each point in `found`.
    pub ends: Vec<u32>,
    pub found: Vec<u32>,
    /// Pairs found from one side only, to be added to the list of the first point.
    pub returned: Vec<[u32; 2]>,
}

/// Assemble the lists of `points` points from rows of [`CHUNK`] sorted points each. `number` maps a sorted position to a point.
pub(super) fn assemble(
    points: usize,
    rows: &[Rows],
    number: impl Fn(usize) -> u32,
    team: &Team,
    lists: &mut NeighbourLists,
) {
    let NeighbourLists { starts, list } = lists;
    starts.clear();
    starts.resize(points + 1, 0);
    // Chunk of each point, and the start of its list in that chunk.
    let mut sources = vec![[0u32; 2]; points];
    let mut place = 0;
    for (chunk, row) in rows.iter().enumerate() {
        let mut begin = 0;
        for &end in &row.ends {
            let i = number(place) as usize;
            starts[i + 1] = end - begin;
            sources[i] = [chunk as u32, begin];
            (begin, place) = (end, place + 1);
        }
    }
    let mixed = rows.iter().any(|row| !row.returned.is_empty());
    // Number of neighbours in each list from the search of its own point.
    let mut own = Vec::new();
    if mixed {
        own.extend_from_slice(&starts[1..]);
        for [i, _] in rows.iter().flat_map(|row| &row.returned) {
            starts[*i as usize + 1] += 1;
        }
    }
    for i in 0..points {
        starts[i + 1] += starts[i];
    }
    list.resize(starts[points] as usize, 0);
    if mixed {
        let mut next: Vec<u32> = (0..points).map(|i| starts[i] + own[i]).collect();
        for [i, j] in rows.iter().flat_map(|row| &row.returned) {
            list[next[*i as usize] as usize] = *j;
            next[*i as usize] += 1;
        }
    }
    let mut chunk_starts: Vec<u32> = starts.iter().step_by(CHUNK).copied().collect();
    if !points.is_multiple_of(CHUNK) {
        chunk_starts.push(starts[points]);
    }
    team.each_part(list, &chunk_starts, &mut vec![(); points.div_ceil(CHUNK)], |chunk, part, _| {
        let first = chunk * CHUNK;
        let base = starts[first];
        for i in first..(first + CHUNK).min(points) {
            let [begin, end] = [starts[i], starts[i + 1]].map(|s| (s - base) as usize);
            let here = &mut part[begin..end];
            let [row, from] = sources[i].map(|s| s as usize);
            let count = if mixed { own[i] as usize } else { here.len() };
            here[..count].copy_from_slice(&rows[row].found[from..from + count]);
            if count < here.len() {
                here.sort_unstable();
            }
        }
    });
}

/// Build the lists of `points` points by `search`, which may append the neighbours of a point in any order.
pub(super) fn collect(
    points: usize,
    team: &Team,
    lists: &mut NeighbourLists,
    search: impl Fn(usize, &mut Vec<u32>) + Send + Sync,
) -> Result<(), SearchError> {
    let limit = Limit::new(points);
    let mut rows = vec![Rows::default(); points.div_ceil(CHUNK)];
    team.each(&mut rows, |chunk, row| {
        let first = chunk * CHUNK;
        for i in first..(first + CHUNK).min(points) {
            let before = row.found.len();
            if limit.passed(before) {
                break;
            }
            search(i, &mut row.found);
            row.found[before..].sort_unstable();
            row.ends.push(row.found.len() as u32);
        }
        limit.add(row.found.len());
    });
    limit.check()?;
    assemble(points, &rows, |place| place as u32, team, lists);
    Ok(())
}
