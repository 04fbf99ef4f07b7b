//! Who touches whom, kept over steps by a skin.

use impactite_geometry::search::{Points, Reach, SearchError, VerletLists};
use impactite_simd::Team;

use crate::particles::Particle;

/// The particles within contact range of each, plus a skin: distance <= R_i + R_j + tolerance + skin.
///
/// Found by cells, O(N) \[Feng2014\] ([`SortedCells`](impactite_geometry::search::SortedCells)). The lists stay valid until
/// some particle has moved half the skin. Every list is in ascending order, so that it does not depend on where the cells
/// lie.
#[derive(Clone, Debug)]
pub struct Neighbours<const D: usize> {
    /// Why there are none, if tolerance or skin are no lengths.
    lists: Result<VerletLists<D>, SearchError>,
    refused: Option<SearchError>,
    positions: Vec<[f64; D]>,
    radii: Vec<f64>,
}

impl<const D: usize> Neighbours<D> {
    /// With the tolerance of contact and the skin, m; both zero or more.
    pub fn new(tolerance: f64, skin: f64) -> Self {
        Neighbours {
            lists: VerletLists::new(Reach::sum(tolerance), skin),
            refused: None,
            positions: Vec::new(),
            radii: Vec::new(),
        }
    }

    /// The neighbours of particle `i`, in ascending order; some may be up to two skins out of range.
    pub fn of(&self, i: usize) -> &[u32] {
        self.lists.as_ref().map_or(&[], |lists| lists.of(i))
    }

    /// The lists are no longer of these particles.
    pub fn forget(&mut self) {
        if let Ok(lists) = &mut self.lists {
            lists.forget();
        }
    }

    /// How many searches were made.
    pub fn searches(&self) -> u64 {
        self.lists.as_ref().map_or(0, VerletLists::searches)
    }

    /// Search again if some particle moved more than half the skin since the last search. Particles that no search can
    /// use have no neighbours, and [`refused`](Neighbours::refused) says why.
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

    /// Why the last update found nothing: a tolerance or a skin that is no length, a position that is not finite, or
    /// more neighbours than memory should hold.
    pub fn refused(&self) -> Option<&SearchError> {
        self.lists.as_ref().err().or(self.refused.as_ref())
    }
}
