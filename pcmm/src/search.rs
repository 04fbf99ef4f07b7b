//! Neighbour search of particles, with a skin for reuse of the lists.

use impactite_geometry::search::{Points, Reach, SearchError, VerletLists};
use impactite_simd::Team;

use crate::particles::Particle;

/// Neighbour lists of particles in contact range, plus a skin: distance <= R_i + R_j + tolerance + skin.
///
/// The search uses cells, O(N) \[Feng2014\] ([`SortedCells`](impactite_geometry::search::SortedCells)). The lists are valid until a
/// particle has moved half the skin. Every list is in ascending order, so that it does not depend on the position of the cells.
#[derive(Clone, Debug)]
pub struct Neighbours<const D: usize> {
    /// Lists, or the error of an invalid tolerance or skin.
    lists: Result<VerletLists<D>, SearchError>,
    refused: Option<SearchError>,
    positions: Vec<[f64; D]>,
    radii: Vec<f64>,
}

impl<const D: usize> Neighbours<D> {
    /// Create lists with the contact tolerance and the skin, m; both zero or more.
    pub fn new(tolerance: f64, skin: f64) -> Self {
        Neighbours {
            lists: VerletLists::new(Reach::sum(tolerance), skin),
            refused: None,
            positions: Vec::new(),
            radii: Vec::new(),
        }
    }

    /// Return the neighbours of particle `i`, in ascending order; some may be up to two skins out of range.
    pub fn of(&self, i: usize) -> &[u32] {
        self.lists.as_ref().map_or(&[], |lists| lists.of(i))
    }

    /// Invalidate the lists.
    pub fn forget(&mut self) {
        if let Ok(lists) = &mut self.lists {
            lists.forget();
        }
    }

    /// Number of searches.
    pub fn searches(&self) -> u64 {
        self.lists.as_ref().map_or(0, VerletLists::searches)
    }

    /// Search again if a particle moved more than half the skin since the last search. Invalid particles have no neighbours;
    /// [`refused`](Neighbours::refused) returns the reason.
    pub fn update(&mut self, particles: &[Particle<D>], team: &Team) {
        let Ok(lists) = &mut self.lists else { return };
        if lists.hold(particles.iter().map(|p| (p.position, p.radius))) {
            return;
        }
        self.positions.clear();
        self.positions.extend(particles.iter().map(|p| p.position));
        self.radii.clear();
        self.radii.extend(particles.iter().map(|p| p.radius));
        let points = Points::new(&self.positions, &self.radii);
        self.refused = match points.and_then(|points| lists.update(&points, team)) {
            Ok(_) => None,
            Err(refused) => {
                lists.clear(particles.len());
                Some(refused)
            }
        };
    }

    /// Reason why the last update found nothing: an invalid tolerance or skin, a position that is not finite, or too many neighbours for
    /// memory.
    pub fn refused(&self) -> Option<&SearchError> {
        self.lists.as_ref().err().or(self.refused.as_ref())
    }
}
