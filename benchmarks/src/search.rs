//! The searches for neighbours of `impactite-geometry` beside each other.

use mpm_core::Team;
use mpm_core::geometry::search::{
    BoxTree, NeighbourLists, NeighbourSearch, PointInBox, Points, Reach, SearchError, SortedCells,
    StripPointInBox,
};

use crate::{Cloud, timed};

/// Sorted cells first, against which the others are held.
pub const NAMES: [&str; 5] = ["cells", "one level", "tree", "PIB", "strip PIB"];

/// A search that took longer is not made again, s.
const LONG: f64 = 2.0;

fn search<const D: usize>(
    kind: usize,
    points: &Points<'_, D>,
    reach: Reach,
    team: &Team,
    lists: &mut NeighbourLists,
) -> Result<(), SearchError> {
    match kind {
        0 => SortedCells::new(points, reach)?.neighbours_into(team, lists),
        1 => SortedCells::with_levels(points, reach, 1)?.neighbours_into(team, lists),
        2 => BoxTree::new(points, reach)?.neighbours_into(team, lists),
        3 => PointInBox::new(points, reach)?.neighbours_into(team, lists),
        _ => StripPointInBox::new(points, reach)?.neighbours_into(team, lists),
    }
}

/// What searches from scratch took, sorting included, into lists whose memory was there from the second round on.
#[derive(Clone, Debug, PartialEq)]
pub struct Searched {
    /// Of each kind ([`NAMES`]), seconds of the fastest.
    pub seconds: Vec<f64>,
    /// Neighbours a point.
    pub neighbours: f64,
}

/// Search by the first `kinds` of [`NAMES`] in so many rounds of alternation.
///
/// # Errors
/// What a search refuses; one that finds other neighbours than cells.
pub fn searched<const D: usize>(
    cloud: &Cloud<D>,
    reach: Reach,
    (kinds, rounds): (usize, u32),
    team: &Team,
) -> Result<Searched, Box<dyn std::error::Error>> {
    let points = Points::new(&cloud.positions, &cloud.radii)?;
    let mut best = vec![f64::INFINITY; kinds.min(NAMES.len())];
    let (mut found, mut lists) = (NeighbourLists::new(), NeighbourLists::new());
    for round in 0..rounds {
        for (kind, best) in best.iter_mut().enumerate() {
            if *best < f64::INFINITY && *best > LONG {
                continue;
            }
            let (made, seconds) = timed(team.threads(), || search(kind, &points, reach, team, &mut lists));
            made?;
            *best = best.min(seconds);
            if round == 0 && kind == 0 {
                found.clone_from(&lists);
            } else if lists != found {
                return Err(format!("{} finds other neighbours than cells", NAMES[kind]).into());
            }
        }
    }
    Ok(Searched { seconds: best, neighbours: found.list().len() as f64 / points.len() as f64 })
}
