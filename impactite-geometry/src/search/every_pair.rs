//! Brute-force search over all pairs.

use impactite_simd::Team;

use super::cells::Best;
use super::error::{SearchError, check_length, check_place};
use super::lists::{NeighbourLists, collect};
use super::points::{Points, Reach, distance_squared};
use super::{Nearest, NeighbourSearch};

/// Brute-force search: every query tests every point, O(N^2) for all neighbours. Reference for the other searches.
#[derive(Clone, Debug)]
pub struct EveryPair<const D: usize> {
    reach: Reach,
    points: Vec<([f64; D], f64)>,
}

impl<const D: usize> EveryPair<D> {
    fn find(&self, x: &[f64; D], radius: f64, but: usize, found: &mut Vec<u32>) {
        for (i, (y, r)) in self.points.iter().enumerate() {
            let range = self.reach.of(radius, *r);
            if i != but && distance_squared(x, y) <= range * range {
                found.push(i as u32);
            }
        }
    }
}

impl<const D: usize> NeighbourSearch<D> for EveryPair<D> {
    fn new(points: &Points<'_, D>, reach: Reach) -> Result<Self, SearchError> {
        reach.check(points.radii_range()[1])?;
        let positions = points.positions().iter().enumerate();
        Ok(EveryPair { reach, points: positions.map(|(i, x)| (*x, points.radius(i))).collect() })
    }

    fn len(&self) -> usize {
        self.points.len()
    }

    fn neighbours_into(&self, team: &Team, lists: &mut NeighbourLists) -> Result<(), SearchError> {
        collect(self.len(), team, lists, |i, found| {
            let (x, radius) = &self.points[i];
            self.find(x, *radius, i, found);
        })
    }

    fn neighbours_of(&self, others: &Points<'_, D>, team: &Team) -> Result<NeighbourLists, SearchError> {
        self.reach.check(others.radii_range()[1])?;
        let mut lists = NeighbourLists::new();
        collect(others.len(), team, &mut lists, |i, found| {
            self.find(&others.positions()[i], others.radius(i), usize::MAX, found);
        })?;
        Ok(lists)
    }

    fn visit_within(
        &self,
        x: &[f64; D],
        radius: f64,
        visit: &mut dyn FnMut(u32, f64),
    ) -> Result<(), SearchError> {
        check_place(x)?;
        check_length("radius of the ball", radius)?;
        for (i, (y, _)) in self.points.iter().enumerate() {
            let square = distance_squared(x, y);
            if square <= radius * radius {
                visit(i as u32, square.sqrt());
            }
        }
        Ok(())
    }

    fn nearest(&self, x: &[f64; D]) -> Result<Option<Nearest>, SearchError> {
        check_place(x)?;
        let mut best = Best::none();
        for (i, (y, _)) in self.points.iter().enumerate() {
            best.offer(i as u32, distance_squared(x, y));
        }
        Ok(best.point())
    }
}
