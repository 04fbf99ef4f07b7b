//! Neighbour search: which points of a set, or of two, are within reach of each other.
//!
//! Points have positions in one, two or three dimensions and radii ([`Points`]); a [`Reach`] says which pairs are
//! neighbours. A search sorts the points once and then answers four questions ([`NeighbourSearch`]): the neighbours of all its points,
//! its points within reach of those of another set, its points within a ball, and the nearest one. All
//! searches give the same lists, in ascending order, the same for any number of threads.
//!
//! | search | sorted by | suits |
//! |---|---|---|
//! | [`SortedCells`] | cells, a level for each power of two of the range | all: O(N) a level |
//! | [`BoxTree`] | a balanced tree of boxes, cut at medians \[Bentley1975\] | places far from all points, few questions; O(N log N) |
//! | [`PointInBox`] | every coordinate by itself \[Attaway1993\] | thin bodies, alike radii; O(N^(2 - 1/D)) |
//! | [`StripPointInBox`] | the same in strips \[Xiao2015\] | alike radii |
//! | [`EveryPair`] | nothing | a few points; what the others are held against |
//!
//! [`VerletLists`] keep the lists of any of them over steps, by a skin; [`VerletListsBetween`] those between two sets. [`SearchMethod`] chooses one at run time.
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

/// The largest coordinate, radius or range of a search (m): squares of distances beyond are not finite.
pub const FARTHEST: f64 = 1e150;
/// The most points of a set, 2^29: cells, of which there are up to four a point, have numbers of 32 bits.
pub const MOST_POINTS: usize = 1 << 29;

/// Points sorted so that those near a place are found without looking at all.
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
    /// These points, sorted for questions about pairs within `reach`.
    ///
    /// # Errors
    /// Numbers of `reach` that are negative, not finite or too large.
    fn new(points: &Points<'_, D>, reach: Reach) -> Result<Self, SearchError>
    where
        Self: Sized;

    /// How many points there are.
    fn len(&self) -> usize;

    /// Are there no points?
    fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// For every point the others within reach of it, written over `lists`, whose memory is used again. Symmetric: where j is in
    /// the list of i, i is in that of j.
    ///
    /// # Errors
    /// More than 1024 neighbours a point on average (and more than 2^26 altogether): what `lists` then hold is nothing to use.
    fn neighbours_into(&self, team: &Team, lists: &mut NeighbourLists) -> Result<(), SearchError>;

    /// For every point the others within reach of it.
    ///
    /// # Errors
    /// As [`neighbours_into`](NeighbourSearch::neighbours_into).
    fn neighbours(&self, team: &Team) -> Result<NeighbourLists, SearchError> {
        let mut lists = NeighbourLists::new();
        self.neighbours_into(team, &mut lists)?;
        Ok(lists)
    }

    /// A list for every point of another set: the points of this one within reach of it.
    ///
    /// # Errors
    /// As [`neighbours_into`](NeighbourSearch::neighbours_into), and a range that becomes too large by the radii of the others.
    fn neighbours_of(&self, others: &Points<'_, D>, team: &Team) -> Result<NeighbourLists, SearchError>;

    /// `visit` on the number and the distance (m) of every point within `radius` (m) of `x`, whatever its own radius, in any order.
    ///
    /// # Errors
    /// A place that is not finite, a radius that is negative or not finite, or either beyond 1e150 m.
    fn visit_within(
        &self,
        x: &[f64; D],
        radius: f64,
        visit: &mut dyn FnMut(u32, f64),
    ) -> Result<(), SearchError>;

    /// The points within `radius` (m) of `x`, whatever their own radii, in ascending order.
    ///
    /// # Errors
    /// As [`visit_within`](NeighbourSearch::visit_within).
    fn within(&self, x: &[f64; D], radius: f64) -> Result<Vec<u32>, SearchError> {
        let mut found = Vec::new();
        self.visit_within(x, radius, &mut |i, _| found.push(i))?;
        found.sort_unstable();
        Ok(found)
    }

    /// The point nearest to `x`, whatever the radii; of several at the same distance the first. `None` without points.
    ///
    /// # Errors
    /// A place that is not finite or beyond 1e150 m.
    fn nearest(&self, x: &[f64; D]) -> Result<Option<Nearest>, SearchError>;
}

/// The point nearest to a place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Nearest {
    /// Its number.
    pub point: u32,
    /// How far it is (m).
    pub distance: f64,
}

/// The searches there are, to choose one at run time.
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
    /// All of them.
    pub const ALL: [SearchMethod; 5] = [
        SearchMethod::SortedCells,
        SearchMethod::BoxTree,
        SearchMethod::PointInBox,
        SearchMethod::StripPointInBox,
        SearchMethod::EveryPair,
    ];
    /// A name for tables.
    pub fn name(self) -> &'static str {
        match self {
            SearchMethod::SortedCells => "cells",
            SearchMethod::BoxTree => "tree",
            SearchMethod::PointInBox => "point in box",
            SearchMethod::StripPointInBox => "strips",
            SearchMethod::EveryPair => "every pair",
        }
    }
    /// The points, sorted by this search.
    ///
    /// # Errors
    /// As [`NeighbourSearch::new`].
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
