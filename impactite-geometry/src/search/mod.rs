//! Neighbour search: pairs of points within reach, in one set or between two.
//!
//! Points have positions in one, two or three dimensions and radii ([`Points`]); a [`Reach`] defines which pairs are
//! neighbours. A search sorts the points once and then answers four queries ([`NeighbourSearch`]): the neighbours of all its points,
//! its points within reach of those of another set, its points within a ball, and the nearest one. All
//! searches return the same lists, in ascending order, for any number of threads.
//!
//! | search | data structure | suitable for |
//! |---|---|---|
//! | [`SortedCells`] | cell lists, a level for each power of two of the range | all: O(N) a level |
//! | [`BoxTree`] | k-d tree with bounding boxes \[Bentley1975\] | remote query points, few queries; O(N log N) |
//! | [`PointInBox`] | sorted coordinates per axis \[Attaway1993\] | thin bodies, similar radii; O(N^(2 - 1/D)) |
//! | [`StripPointInBox`] | sorted coordinates in strips \[Xiao2015\] | similar radii |
//! | [`EveryPair`] | none | a few points; reference for the others |
//!
//! [`VerletLists`] reuse the lists of any search over steps, by a skin; [`VerletListsBetween`] those between two sets. [`SearchMethod`]
//! selects a search at run time.
//!
//! ```
//! use impactite_geometry::search::{NeighbourSearch, Points, Reach, SearchError, SearchMethod, SortedCells};
//! use impactite_simd::Team;
//!
//! // A body of three discs in a row, and a small one beside it (m).
//! let body = [[0.0, 0.0], [1.0, 0.0], [2.1, 0.0]];
//! let points = Points::new(&body, &[0.5; 3])?;
//! let cells = SortedCells::new(&points, Reach::sum(0.05))?;
//!
//! let lists = cells.neighbours(&Team::one())?;
//! assert_eq!([lists.of(0), lists.of(1), lists.of(2)], [&[1][..], &[0], &[]]);
//!
//! let (other, radius) = ([[1.5, 0.4]], [0.15]);
//! let between = cells.neighbours_of(&Points::new(&other, &radius)?, &Team::one())?;
//! assert_eq!(between.of(0), [1]);
//!
//! assert_eq!(cells.within(&[0.5, 0.0], 0.6)?, [0, 1]);
//! let nearest = cells.nearest(&[9.0, 0.0])?;
//! assert_eq!(nearest.map(|n| n.point), Some(2));
//!
//! // Another search, chosen at run time, finds the same.
//! let tree = SearchMethod::BoxTree.sort(&points, Reach::sum(0.05))?;
//! assert_eq!(tree.neighbours(&Team::one())?, lists);
//! # Ok::<(), SearchError>(())
//! ```

mod boxes;
mod cells;
mod error;
mod every_pair;
mod lists;
mod points;
mod tree;
mod verlet;

use impactite_simd::Team;

pub use boxes::{PointInBox, StripPointInBox};
pub use cells::SortedCells;
pub use error::SearchError;
pub use every_pair::EveryPair;
pub use lists::NeighbourLists;
pub use points::{Points, Reach};
pub use tree::BoxTree;
pub use verlet::{VerletLists, VerletListsBetween};

/// Largest coordinate, radius or range of a search (m): squares of larger distances overflow.
pub const FARTHEST: f64 = 1e150;
/// Maximum number of points of a set, 2^29: cells, up to four per point, have 32-bit indices.
pub const MOST_POINTS: usize = 1 << 29;

/// Search structure: points sorted so that neighbours are found without a test of all points.
///
/// ```
/// use impactite_geometry::search::{BoxTree, NeighbourSearch, Points, Reach, SearchError, SortedCells};
/// use impactite_simd::Team;
/// // A caller that is compiled for the search it is given.
/// fn pairs<S: NeighbourSearch<2>>(positions: &[[f64; 2]]) -> Result<usize, SearchError> {
///     let search = S::new(&Points::of_positions(positions)?, Reach::uniform(1.0))?;
///     Ok(search.neighbours(&Team::one())?.list().len() / 2)
/// }
/// let square = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]];
/// assert_eq!(pairs::<SortedCells<2>>(&square)?, 4);
/// assert_eq!(pairs::<BoxTree<2>>(&square)?, 4);
/// # Ok::<(), SearchError>(())
/// ```
#[diagnostic::on_unimplemented(
    message = "`{Self}` is no search for neighbours in {D} dimensions",
    label = "takes `SortedCells<{D}>`, `BoxTree<{D}>`, or another type that implements `NeighbourSearch<{D}>`"
)]
pub trait NeighbourSearch<const D: usize>: Send + Sync {
    /// Sort these points for queries of pairs within `reach`.
    ///
    /// # Errors
    /// Parameters of `reach` that are negative, not finite or too large.
    fn new(points: &Points<'_, D>, reach: Reach) -> Result<Self, SearchError>
    where
        Self: Sized;

    /// Number of points.
    fn len(&self) -> usize;

    /// True if there are no points.
    fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Find the neighbours of every point and write them to `lists`, whose memory is reused. Symmetric: if j is in
    /// the list of i, i is in that of j.
    ///
    /// # Errors
    /// More than 1024 neighbours per point on average (and more than 2^26 in total); the contents of `lists` are then unspecified.
    fn neighbours_into(&self, team: &Team, lists: &mut NeighbourLists) -> Result<(), SearchError>;

    /// Find the neighbours of every point.
    ///
    /// # Errors
    /// Errors of [`neighbours_into`](NeighbourSearch::neighbours_into).
    fn neighbours(&self, team: &Team) -> Result<NeighbourLists, SearchError> {
        let mut lists = NeighbourLists::new();
        self.neighbours_into(team, &mut lists)?;
        Ok(lists)
    }

    /// Find the neighbours of every point of another set: the points of this set within reach.
    ///
    /// # Errors
    /// Errors of [`neighbours_into`](NeighbourSearch::neighbours_into), and a range that becomes too large by the radii of the others.
    fn neighbours_of(&self, others: &Points<'_, D>, team: &Team) -> Result<NeighbourLists, SearchError>;

    /// Call `visit` with index and distance (m) of every point within `radius` (m) of `x`, whatever its own radius, in any order.
    ///
    /// # Errors
    /// A position that is not finite, a radius that is negative or not finite, or either beyond 1e150 m.
    fn visit_within(
        &self,
        x: &[f64; D],
        radius: f64,
        visit: &mut dyn FnMut(u32, f64),
    ) -> Result<(), SearchError>;

    /// Find the points within `radius` (m) of `x`, whatever their own radii, in ascending order.
    ///
    /// # Errors
    /// Errors of [`visit_within`](NeighbourSearch::visit_within).
    fn within(&self, x: &[f64; D], radius: f64) -> Result<Vec<u32>, SearchError> {
        let mut found = Vec::new();
        self.visit_within(x, radius, &mut |i, _| found.push(i))?;
        found.sort_unstable();
        Ok(found)
    }

    /// Find the point nearest to `x`, whatever the radii; at equal distances the one of lowest index. `None` without points.
    ///
    /// # Errors
    /// A position that is not finite or beyond 1e150 m.
    fn nearest(&self, x: &[f64; D]) -> Result<Option<Nearest>, SearchError>;
}

/// Nearest point of a query.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Nearest {
    /// Point index.
    pub point: u32,
    /// Distance (m).
    pub distance: f64,
}

/// Search methods, for selection at run time.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum SearchMethod {
    /// [`SortedCells`].
    #[default]
    SortedCells,
    /// [`BoxTree`].
    BoxTree,
    /// [`PointInBox`].
    PointInBox,
    /// [`StripPointInBox`].
    StripPointInBox,
    /// [`EveryPair`].
    EveryPair,
}

impl SearchMethod {
    /// All search methods.
    pub const ALL: [SearchMethod; 5] = [
        SearchMethod::SortedCells,
        SearchMethod::BoxTree,
        SearchMethod::PointInBox,
        SearchMethod::StripPointInBox,
        SearchMethod::EveryPair,
    ];
    /// Name for tables.
    pub fn name(self) -> &'static str {
        match self {
            SearchMethod::SortedCells => "cells",
            SearchMethod::BoxTree => "tree",
            SearchMethod::PointInBox => "point in box",
            SearchMethod::StripPointInBox => "strips",
            SearchMethod::EveryPair => "every pair",
        }
    }
    /// Sort the points for this search.
    ///
    /// # Errors
    /// Errors of [`NeighbourSearch::new`].
    pub fn sort<const D: usize>(
        self,
        points: &Points<'_, D>,
        reach: Reach,
    ) -> Result<Box<dyn NeighbourSearch<D>>, SearchError> {
        Ok(match self {
            SearchMethod::SortedCells => Box::new(SortedCells::new(points, reach)?),
            SearchMethod::BoxTree => Box::new(BoxTree::new(points, reach)?),
            SearchMethod::PointInBox => Box::new(PointInBox::new(points, reach)?),
            SearchMethod::StripPointInBox => Box::new(StripPointInBox::new(points, reach)?),
            SearchMethod::EveryPair => Box::new(EveryPair::new(points, reach)?),
        })
    }
}
