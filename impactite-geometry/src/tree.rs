//! Bounding volume hierarchy of triangles.

use nalgebra::{Matrix3, SymmetricEigen};

use super::bounds::Bounds;
use super::vector::{add, dot, sub};

/// Maximum number of triangles of a leaf.
const LEAF: usize = 4;
/// Size of the traversal stack: each level halves the number of triangles, which is below 2^32, and adds one node.
const WAITING: usize = 40;
/// Threshold for an oriented box: the sum of the squared extents of the triangle boxes over that of the node. The ratio is about 1 for
/// compact triangles, and about the number of triangles for a fan.
const OVERLAP: f64 = 4.0;

/// Bounding volume hierarchy of triangles: for the nearest triangle, and for triangles on a line along the third axis.
#[derive(Clone, Debug)]
pub(super) struct Tree {
    nodes: Vec<Node>,
    leaning: Vec<Leaning>,
    order: Vec<u32>,
}

#[derive(Clone, Copy, Debug)]
struct Node {
    bounds: Bounds<3>,
    /// Range of triangles in `order`.
    range: [u32; 2],
    /// Index of the second child; the first child follows its parent. Zero in a leaf.
    second: u32,
    /// Index of the oriented box plus one, or zero without one.
    leaning: u32,
}

/// Oriented bounding box of a node, where an axis-aligned box is much larger than its triangles: long triangles side by side.
#[derive(Clone, Copy, Debug)]
struct Leaning {
    axes: [[f64; 3]; 3],
    /// Minimum and maximum coordinate along each axis.
    ranges: [[f64; 2]; 3],
    /// Direction across the triangles in the plane of the first two coordinates.
    across: [f64; 2],
    /// Minimum and maximum coordinate along `across`.
    width: [f64; 2],
    /// Bound of the rounding error of a coordinate.
    margin: f64,
}

impl Leaning {
    /// Oriented bounding box of triangles with coordinates of at most `largest`; `None` on overflow.
    fn around(triangles: impl Iterator<Item = [[f64; 3]; 3]> + Clone, largest: f64) -> Option<Self> {
        // Sum of the dyadic products of the edges, for their principal directions.
        let mut edges = Matrix3::<f64>::zeros();
        for [a, b, c] in triangles.clone() {
            for edge in [sub(b, a), sub(c, b), sub(a, c)] {
                for i in 0..3 {
                    for j in 0..3 {
                        edges[(i, j)] += edge[i] * edge[j];
                    }
                }
            }
        }
        if !edges.iter().all(|e| e.is_finite()) {
            return None;
        }
        let along = 0.5 * (2.0 * edges[(0, 1)]).atan2(edges[(0, 0)] - edges[(1, 1)]);
        let across = [-along.sin(), along.cos()];
        let frame = SymmetricEigen::try_new(edges, f64::EPSILON, 100)?.eigenvectors;
        let axes = [0, 1, 2].map(|i| [0, 1, 2].map(|d| frame[(d, i)]));
        let mut ranges = [[f64::INFINITY, f64::NEG_INFINITY]; 4];
        for x in triangles.flatten() {
            let places = [dot(axes[0], x), dot(axes[1], x), dot(axes[2], x), flat(across, [x[0], x[1]])];
            for (range, place) in ranges.iter_mut().zip(places) {
                *range = [range[0].min(place), range[1].max(place)];
            }
        }
        let [first, second, third, width] = ranges;
        // A crossing may be computed up to 6 roundings (of the largest coordinate) outside its triangle, and each dot product
        // in a comparison has an error of up to 3.
        let margin = 32.0 * f64::EPSILON * largest + f64::MIN_POSITIVE;
        Some(Self { axes, ranges: [first, second, third], across, width, margin })
    }
    fn holds_column(&self, x: [f64; 2]) -> bool {
        let place = flat(self.across, x);
        self.width[0] - self.margin <= place && place <= self.width[1] + self.margin
    }
    /// Lower bound of the distance from `x` to the box.
    fn distance(&self, x: [f64; 3]) -> f64 {
        let mut square = 0.0;
        for (axis, range) in self.axes.iter().zip(&self.ranges) {
            let place = dot(*axis, x);
            let gap = (range[0] - place).max(place - range[1]).max(0.0);
            square += gap * gap;
        }
        // The axes are orthogonal to within rounding.
        square.sqrt() * (1.0 - 1e-12) - self.margin - 8.0 * f64::EPSILON * largest(x)
    }
}

fn flat(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

fn largest(x: [f64; 3]) -> f64 {
    x.iter().fold(0.0, |m: f64, c| m.max(c.abs()))
}

impl Tree {
    /// Build a tree of `count` triangles with bounding boxes `within`, and oriented boxes by `leaning`.
    fn build(
        count: usize,
        within: impl Fn(u32) -> Bounds<3>,
        leaning: impl Fn(&[u32], f64) -> Option<Leaning>,
    ) -> Self {
        let boxes: Vec<Bounds<3>> = (0..count as u32).map(within).collect();
        let mut tree = Self { nodes: Vec::new(), leaning: Vec::new(), order: (0..count as u32).collect() };
        // Pending ranges; `Some` is the node of which the range becomes the second child.
        let mut pending: Vec<([usize; 2], Option<usize>)> = vec![([0, count], None)];
        while let Some(([from, to], parent)) = pending.pop() {
            let here = tree.nodes.len();
            if let Some(parent) = parent {
                tree.nodes[parent].second = here as u32;
            }
            let slice = &mut tree.order[from..to];
            let (mut bounds, mut spread) = (Bounds::NOTHING, Bounds::NOTHING);
            let mut squares = 0.0;
            for t in slice.iter() {
                let own = &boxes[*t as usize];
                let extent = sub(own.max, own.min);
                squares += dot(extent, extent);
                bounds = bounds.union(own);
                spread = spread.union(&Bounds::around([add(own.min, own.max)]));
            }
            let mut node = Node { bounds, range: [from as u32, to as u32], second: 0, leaning: 0 };
            if to - from > LEAF {
                let extent = sub(bounds.max, bounds.min);
                if squares > OVERLAP * dot(extent, extent)
                    && let Some(box_) = leaning(slice, largest(bounds.min).max(largest(bounds.max)))
                {
                    tree.leaning.push(box_);
                    node.leaning = tree.leaning.len() as u32;
                }
                let extent = sub(spread.max, spread.min);
                let mut axis = 0;
                for i in 1..3 {
                    if extent[i] > extent[axis] {
                        axis = i;
                    }
                }
                let middle = (to - from) / 2;
                let place = |t: u32| boxes[t as usize].min[axis] + boxes[t as usize].max[axis];
                slice.select_nth_unstable_by(middle, |a, b| place(*a).total_cmp(&place(*b)).then(a.cmp(b)));
                // The last range pushed is built next and so follows its parent.
                pending.push(([from + middle, to], Some(here)));
                pending.push(([from, from + middle], None));
            }
            tree.nodes.push(node);
        }
        tree
    }

    /// Build a tree of triangles with these boxes, for [`column`](Self::column) queries only.
    pub(super) fn of_boxes(count: usize, within: impl Fn(u32) -> Bounds<3>) -> Self {
        Self::build(count, within, |_, _| None)
    }

    /// Build a tree of triangles with these corners.
    pub(super) fn of_triangles(count: usize, corners: impl Fn(u32) -> [[f64; 3]; 3]) -> Self {
        let leaning = |slice: &[u32], largest| Leaning::around(slice.iter().map(|t| corners(*t)), largest);
        Self::build(count, |t| Bounds::around(corners(t)), leaning)
    }

    /// Call `act` for every triangle whose box intersects the line through (x, y) along the third axis between two coordinates, and
    /// possibly for others.
    #[inline]
    pub(super) fn column(&self, x: [f64; 2], [from, to]: [f64; 2], mut act: impl FnMut(u32)) {
        let mut waiting = [0u32; WAITING];
        let mut height = 1;
        while height > 0 {
            height -= 1;
            let index = waiting[height];
            let node = &self.nodes[index as usize];
            let b = &node.bounds;
            if !(b.min[0] <= x[0] && x[0] <= b.max[0] && b.min[1] <= x[1] && x[1] <= b.max[1])
                || b.max[2] < from
                || b.min[2] > to
            {
                continue;
            }
            if let Some(leaning) = self.leaning_of(node)
                && !leaning.holds_column(x)
            {
                continue;
            }
            if node.second == 0 {
                for t in &self.order[node.range[0] as usize..node.range[1] as usize] {
                    act(*t);
                }
                continue;
            }
            waiting[height] = node.second;
            waiting[height + 1] = index + 1;
            height += 2;
        }
    }

    fn leaning_of(&self, node: &Node) -> Option<&Leaning> {
        if node.leaning == 0 { None } else { self.leaning.get(node.leaning as usize - 1) }
    }

    /// Lower bound of the distance from `x` to the triangles of a node.
    fn least(&self, index: u32, x: [f64; 3]) -> f64 {
        let node = &self.nodes[index as usize];
        let least = node.bounds.distance(x);
        self.leaning_of(node).map_or(least, |leaning| least.max(leaning.distance(x)))
    }

    /// Distance from `x` to the nearest triangle, or `limit` if that is less; `of` computes the distance to one triangle.
    #[inline]
    pub(super) fn distance(&self, x: [f64; 3], limit: f64, mut of: impl FnMut(u32) -> f64) -> f64 {
        let mut best = limit;
        let mut waiting = [(0.0, 0u32); WAITING];
        let mut height = 1;
        while height > 0 {
            height -= 1;
            let (least, index) = waiting[height];
            if least >= best {
                continue;
            }
            let node = &self.nodes[index as usize];
            if node.second == 0 {
                for t in &self.order[node.range[0] as usize..node.range[1] as usize] {
                    best = best.min(of(*t));
                }
                continue;
            }
            let children = [index + 1, node.second];
            let [a, b] = children.map(|c| (self.least(c, x), c));
            let (near, far) = if a.0 <= b.0 { (a, b) } else { (b, a) };
            for child in [far, near] {
                if child.0 < best {
                    waiting[height] = child;
                    height += 1;
                }
            }
        }
        best
    }
}
