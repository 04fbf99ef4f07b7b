//! Search by a k-d tree of bounding boxes.

use impactite_simd::Team;

use super::cells::Best;
use super::error::{SearchError, check_length, check_place};
use super::lists::{NeighbourLists, collect};
use super::points::{Points, Reach, bounds_of, distance_squared, distance_to_box, half_box};
use super::{Nearest, NeighbourSearch};

/// Maximum number of points of a leaf.
const LEAF: usize = 8;
/// Size of the traversal stack: each of at most 30 levels adds one node.
const WAITING: usize = 64;

/// Balanced k-d tree \[Bentley1975\]: every node is the bounding box of its points, divided at the median of its longest side. Nodes store
/// their largest radius, so that small points are searched by their own range. O(N log N) to sort, O(log N) per query.
#[derive(Clone, Debug)]
pub struct BoxTree<const D: usize> {
    reach: Reach,
    /// Nodes in heap order: the children of node n are 2 n + 1 and 2 n + 2.
    nodes: Vec<Node<D>>,
    /// Points (position, radius, index), leaf by leaf.
    points: Vec<([f64; D], f64, u32)>,
}

#[derive(Clone, Copy, Debug)]
struct Node<const D: usize> {
    low: [f64; D],
    high: [f64; D],
    largest: f64,
    from: u32,
    to: u32,
}

impl<const D: usize> BoxTree<D> {
    fn build(&mut self, node: usize, from: usize, to: usize) {
        let points = &mut self.points[from..to];
        let (low, high) = bounds_of(points.iter().map(|(x, ..)| x));
        let largest = points.iter().fold(0.0, |m: f64, (_, r, _)| m.max(*r));
        let here = Node { low, high, largest, from: from as u32, to: to as u32 };
        if self.nodes.len() <= node {
            self.nodes.resize(node + 1, here);
        }
        self.nodes[node] = here;
        if points.len() > LEAF {
            let axis = (1..D).fold(0, |a, d| if high[d] - low[d] > high[a] - low[a] { d } else { a });
            let middle = points.len() / 2;
            points.select_nth_unstable_by(middle, |a, b| a.0[axis].total_cmp(&b.0[axis]));
            self.build(2 * node + 1, from, from + middle);
            self.build(2 * node + 2, from + middle, to);
        }
    }

    /// Visit the points of all leaves that intersect the box around `x` of half width `half_of` the largest radius of the node.
    #[inline(always)]
    fn visit(
        &self,
        x: &[f64; D],
        half_of: impl Fn(f64) -> f64,
        mut visit: impl FnMut(&([f64; D], f64, u32)),
    ) {
        let mut waiting = [0; WAITING];
        let mut height = usize::from(!self.nodes.is_empty());
        while height > 0 {
            height -= 1;
            let index = waiting[height];
            let node = &self.nodes[index];
            let half = half_of(node.largest);
            if (0..D).any(|d| x[d] + half < node.low[d] || x[d] - half > node.high[d]) {
                continue;
            }
            if (node.to - node.from) as usize <= LEAF {
                self.points[node.from as usize..node.to as usize].iter().for_each(&mut visit);
            } else {
                waiting[height] = 2 * index + 1;
                waiting[height + 1] = 2 * index + 2;
                height += 2;
            }
        }
    }

    /// Find the points within reach of a point with this radius at `x`, except for index `but`.
    fn find(&self, x: &[f64; D], radius: f64, but: u32, found: &mut Vec<u32>) {
        let half_of = |largest: f64| half_box(self.reach.of(radius, largest));
        self.visit(x, half_of, |(y, r, i)| {
            let range = self.reach.of(radius, *r);
            if *i != but && distance_squared(x, y) <= range * range {
                found.push(*i);
            }
        });
    }
}

impl<const D: usize> NeighbourSearch<D> for BoxTree<D> {
    fn new(points: &Points<'_, D>, reach: Reach) -> Result<Self, SearchError> {
        reach.check(points.radii_range()[1])?;
        let positions = points.positions().iter().enumerate();
        let entries = positions.map(|(i, x)| (*x, points.radius(i), i as u32)).collect();
        let mut tree = BoxTree { reach, nodes: Vec::new(), points: entries };
        if !points.is_empty() {
            tree.build(0, 0, points.len());
        }
        Ok(tree)
    }

    fn len(&self) -> usize {
        self.points.len()
    }

    fn neighbours_into(&self, team: &Team, lists: &mut NeighbourLists) -> Result<(), SearchError> {
        let mut places = vec![0u32; self.len()];
        for (place, (.., i)) in self.points.iter().enumerate() {
            places[*i as usize] = place as u32;
        }
        collect(self.len(), team, lists, |i, found| {
            let (x, radius, _) = &self.points[places[i] as usize];
            self.find(x, *radius, i as u32, found);
        })
    }

    fn neighbours_of(&self, others: &Points<'_, D>, team: &Team) -> Result<NeighbourLists, SearchError> {
        self.reach.check(others.radii_range()[1])?;
        let mut lists = NeighbourLists::new();
        collect(others.len(), team, &mut lists, |i, found| {
            self.find(&others.positions()[i], others.radius(i), u32::MAX, found);
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
        self.visit(
            x,
            |_| half_box(radius),
            |(y, _, i)| {
                let square = distance_squared(x, y);
                if square <= radius * radius {
                    visit(*i, square.sqrt());
                }
            },
        );
        Ok(())
    }

    fn nearest(&self, x: &[f64; D]) -> Result<Option<Nearest>, SearchError> {
        check_place(x)?;
        let mut best = Best::none();
        let mut waiting = [(0.0, 0); WAITING];
        let mut height = usize::from(!self.nodes.is_empty());
        while height > 0 {
            height -= 1;
            let (gap, index) = waiting[height];
            if gap > half_box(best.square.sqrt()) {
                continue;
            }
            let node = &self.nodes[index];
            if (node.to - node.from) as usize <= LEAF {
                for (y, _, i) in &self.points[node.from as usize..node.to as usize] {
                    best.offer(*i, distance_squared(x, y));
                }
                continue;
            }
            let child = |n: usize| (distance_to_box(x, &self.nodes[n].low, &self.nodes[n].high), n);
            let (a, b) = (child(2 * index + 1), child(2 * index + 2));
            // Visit the nearer child first.
            let (near, far) = if a.0 <= b.0 { (a, b) } else { (b, a) };
            waiting[height] = far;
            waiting[height + 1] = near;
            height += 2;
        }
        Ok(best.point())
    }
}
