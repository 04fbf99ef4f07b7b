//! Comparison of the neighbour searches of `impactite-geometry`.

use mpm_core::Team;
use mpm_core::geometry::search::{
    BoxTree, NeighbourLists, NeighbourSearch, PointInBox, Points, Reach, SearchError, SortedCells,
    StripPointInBox,
};

use crate::{Cloud, timed};

/// Search names: sorted cells first, the reference for the others.
pub const NAMES: [&str; 5] = ["cells", "one level", "tree", "PIB", "strip PIB"];

/// Time limit above which a search is not repeated, s.
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

/// Times of searches from scratch, sorting included, into lists with memory reuse from the second round on.
#[derive(Clone, Debug, PartialEq)]
pub struct Searched {
    /// Minimum time of each kind ([`NAMES`]), s.
    pub seconds: Vec<f64>,
    /// Neighbours per point.
    pub neighbours: f64,
}

/// Run the first `kinds` of [`NAMES`] in alternating rounds.
///
/// # Errors
/// A search fails, or its neighbours differ from those of sorted cells.
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
