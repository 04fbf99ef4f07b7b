//! Closed surface of a shape, by facets.

use std::collections::HashMap;

use super::error::{Check, GeometryError};
use super::shape::Shape;

/// Distance from the surface, over the spacing, at which a node of the lattice is on it.
const ON: f64 = 1e-9;
/// Bisections of an edge of the lattice: to rounding.
const BISECTIONS: usize = 60;
/// Largest number of nodes of the lattice.
const MOST: f64 = 1e8;

/// Closed surface: segments in the plane, with the matter to the left; triangles in space, counter-clockwise seen from outside.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Facets<const D: usize> {
    /// Positions of the nodes, m.
    pub nodes: Vec<[f64; D]>,
    /// Nodes of each facet.
    pub facets: Vec<[u32; D]>,
}

impl<const D: usize> Facets<D> {
    /// Find the surface of a shape by facets of about `spacing`, m, in two or three dimensions: on a lattice over the bounding box, whose cells
    /// are divided into simplices. Nodes are on the surface to rounding. Planes that bound the shape normal to an axis, with their edges and
    /// corners, are kept; other edges are cut off within `spacing`, and gaps and parts thinner than that may be missed.
    ///
    /// ```
    /// use impactite_geometry::{Ball, Facets};
    /// let ball = Facets::of(&Ball::new([0.0; 3], 1.0)?, 0.1)?;
    /// assert!((ball.volume() / 4.188790 - 1.0).abs() < 0.005);
    /// # Ok::<(), impactite_geometry::GeometryError>(())
    /// ```
    ///
    /// # Errors
    /// [`GeometryError::Parameter`] unless `spacing` is positive, finite and large enough for 10^8 nodes of the lattice.
    pub fn of(shape: &(impl Shape<D> + ?Sized), spacing: f64) -> Result<Self, GeometryError> {
        let check = Check("surface by facets");
        check.positive("spacing", spacing)?;
        let bounds = shape.bounds();
        let extent: [f64; D] = std::array::from_fn(|d| bounds.max[d] - bounds.min[d]);
        // Planes of the lattice at both ends, and one layer of nodes beyond.
        let parts = extent.map(|x| (x / spacing).ceil().max(1.0));
        let nodes = parts.iter().map(|n| n + 3.0).product::<f64>();
        if let Some(axis) = (0..D).find(|d| !extent[*d].is_finite()) {
            return Err(GeometryError::Unbounded { axis });
        }
        check.that(nodes <= MOST, "spacing", spacing, "large enough for 10^8 nodes over the shape")?;
        let step: [f64; D] =
            std::array::from_fn(|d| if extent[d] > 0.0 { extent[d] / parts[d] } else { spacing });
        let lattice = Sampled::new(shape, bounds.min, step, parts.map(|n| n as usize + 3), ON * spacing);
        Ok(lattice.surface())
    }

    /// Enclosed volume, m^3 (m^2 in the plane).
    pub fn volume(&self) -> f64 {
        let Some(from) = self.nodes.first() else { return 0.0 };
        let part = |facet: &[u32; D]| {
            let edges: Vec<[f64; D]> =
                facet.iter().map(|n| std::array::from_fn(|d| self.nodes[*n as usize][d] - from[d])).collect();
            determinant(&edges)
        };
        self.facets.iter().map(part).sum::<f64>() / if D == 2 { 2.0 } else { 6.0 }
    }
}

/// Determinant of `D` vectors in two or three dimensions.
fn determinant<const D: usize>(rows: &[[f64; D]]) -> f64 {
    if D == 2 {
        return rows[0][0] * rows[1][1] - rows[0][1] * rows[1][0];
    }
    let minor = |a: usize, b: usize| rows[1][a] * rows[2][b] - rows[1][b] * rows[2][a];
    rows[0][0] * minor(1, 2) - rows[0][1] * minor(0, 2) + rows[0][2] * minor(0, 1)
}

/// Shape on the nodes of a lattice.
struct Sampled<'a, S: ?Sized, const D: usize> {
    shape: &'a S,
    low: [f64; D],
    step: [f64; D],
    counts: [usize; D],
    /// True for nodes inside or on the surface, and for those on it.
    inside: Vec<bool>,
    on: Vec<bool>,
}

impl<'a, S: Shape<D> + ?Sized, const D: usize> Sampled<'a, S, D> {
    fn new(shape: &'a S, low: [f64; D], step: [f64; D], counts: [usize; D], on: f64) -> Self {
        let mut sampled = Sampled { shape, low, step, counts, inside: Vec::new(), on: Vec::new() };
        for n in 0..counts.iter().product() {
            let distance = shape.signed_distance(sampled.place(n));
            sampled.inside.push(distance <= on);
            sampled.on.push(distance.abs() <= on);
        }
        sampled
    }

    /// Position of a node, m: the second one along each axis is at the lower corner of the shape.
    fn place(&self, mut n: usize) -> [f64; D] {
        std::array::from_fn(|d| {
            let at = (n % self.counts[d]) as f64 - 1.0;
            n /= self.counts[d];
            self.low[d] + at * self.step[d]
        })
    }

    /// Point where the edge from a node inside to one outside crosses the surface, m.
    fn crossing(&self, inside: usize, outside: usize) -> [f64; D] {
        let (a, b) = (self.place(inside), self.place(outside));
        let at = |t: f64| -> [f64; D] { std::array::from_fn(|d| a[d] + t * (b[d] - a[d])) };
        if self.on[inside] {
            return a;
        }
        let (mut low, mut high) = (0.0, 1.0);
        for _ in 0..BISECTIONS {
            let middle = 0.5 * (low + high);
            if self.shape.signed_distance(at(middle)) <= 0.0 { low = middle } else { high = middle }
        }
        at(0.5 * (low + high))
    }

    fn surface(&self) -> Facets<D> {
        let mut found = Facets::default();
        let mut known: HashMap<[usize; 2], u32> = HashMap::new();
        let simplices = simplices::<D>();
        let strides: [usize; D] = std::array::from_fn(|d| self.counts[..d].iter().product());
        for first in 0..self.inside.len() {
            let mut rest = first;
            let last = (0..D).any(|d| {
                let at = rest % self.counts[d];
                rest /= self.counts[d];
                at + 1 == self.counts[d]
            });
            if last {
                continue;
            }
            let corner =
                |c: usize| first + (0..D).filter(|d| c >> d & 1 == 1).map(|d| strides[d]).sum::<usize>();
            let within = (0..1 << D).filter(|c| self.inside[corner(*c)]).count();
            if within == 0 || within == 1 << D {
                continue;
            }
            for simplex in &simplices {
                let all: Vec<usize> = simplex.iter().map(|c| corner(*c)).collect();
                let (inside, outside): (Vec<usize>, Vec<usize>) = all.iter().partition(|n| self.inside[**n]);
                if inside.is_empty() || outside.is_empty() {
                    continue;
                }
                for facet in edges_of_facets(&inside, &outside) {
                    let facet = self.outward(facet, &inside, &outside);
                    let mut node = |[inside, outside]: [usize; 2]| {
                        let key = if self.on[inside] { [inside; 2] } else { [inside, outside] };
                        *known.entry(key).or_insert_with(|| {
                            found.nodes.push(self.crossing(inside, outside));
                            found.nodes.len() as u32 - 1
                        })
                    };
                    let nodes: [u32; D] = std::array::from_fn(|k| node(facet[k]));
                    if (0..D).all(|k| !nodes[k + 1..].contains(&nodes[k])) {
                        found.facets.push(nodes);
                    }
                }
            }
        }
        found.used()
    }

    /// Order the edges of a facet such that it faces outwards, by their middles.
    fn outward(&self, mut edges: Vec<[usize; 2]>, inside: &[usize], outside: &[usize]) -> Vec<[usize; 2]> {
        let mean = |nodes: &mut dyn Iterator<Item = usize>| {
            let places: Vec<_> = nodes.map(|n| self.place(n)).collect();
            let count = places.len() as f64;
            std::array::from_fn::<f64, D, _>(|d| places.iter().map(|x| x[d]).sum::<f64>() / count)
        };
        let [from, to] = [inside, outside].map(|list| mean(&mut list.iter().copied()));
        let middles: Vec<_> = edges.iter().map(|edge| mean(&mut edge.iter().copied())).collect();
        let minus = |a: &[f64; D], b: &[f64; D]| -> [f64; D] { std::array::from_fn(|d| a[d] - b[d]) };
        let mut rows = vec![minus(&to, &from)];
        rows.extend(middles[1..].iter().map(|x| minus(x, &middles[0])));
        // With the outward direction, both are a right-handed system.
        if determinant(&rows) > 0.0 {
            return edges;
        }
        edges.swap(0, 1);
        edges
    }
}

impl<const D: usize> Facets<D> {
    /// Remove nodes without facets.
    fn used(mut self) -> Self {
        let mut numbers = vec![u32::MAX; self.nodes.len()];
        let mut nodes = Vec::new();
        for n in self.facets.as_flattened_mut() {
            let number = &mut numbers[*n as usize];
            if *number == u32::MAX {
                *number = nodes.len() as u32;
                nodes.push(self.nodes[*n as usize]);
            }
            *n = *number;
        }
        self.nodes = nodes;
        self
    }
}

/// Corners of the simplices of a cell (Kuhn): bit `d` of a corner is its place along axis `d`.
fn simplices<const D: usize>() -> Vec<Vec<usize>> {
    let mut paths = vec![vec![0]];
    for _ in 0..D {
        paths = paths
            .iter()
            .flat_map(|path: &Vec<usize>| {
                let last = path[path.len() - 1];
                (0..D)
                    .filter(move |d| last >> d & 1 == 0)
                    .map(move |d| [&path[..], &[last | 1 << d]].concat())
            })
            .collect();
    }
    paths
}

/// Facets that divide a simplex, each by the edges on which its nodes are.
fn edges_of_facets(inside: &[usize], outside: &[usize]) -> Vec<Vec<[usize; 2]>> {
    let edge = |i: usize, o: usize| [inside[i], outside[o]];
    match (inside.len(), outside.len()) {
        (1, count) => vec![(0..count).map(|o| edge(0, o)).collect()],
        (count, 1) => vec![(0..count).map(|i| edge(i, 0)).collect()],
        _ => vec![vec![edge(0, 0), edge(0, 1), edge(1, 1)], vec![edge(0, 0), edge(1, 1), edge(1, 0)]],
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Ball, Compose, Cuboid, Cylinder};

    /// Every edge (corner in the plane) is between facets of both senses.
    fn closed<const D: usize>(surface: &Facets<D>) {
        let mut sum: HashMap<[u32; 2], i32> = HashMap::new();
        for facet in &surface.facets {
            for k in 0..D {
                let (a, b) = if D == 2 { (facet[k], facet[k]) } else { (facet[k], facet[(k + 1) % D]) };
                let forth = if D == 2 { k == 0 } else { a < b };
                *sum.entry([a.min(b), a.max(b)]).or_default() += if forth { 1 } else { -1 };
            }
        }
        assert!(!sum.is_empty() && sum.values().all(|n| *n == 0));
    }

    #[test]
    fn boxes_are_exact() {
        let plane = Facets::of(&Cuboid::new([0.1, -0.2], [0.4, 0.7]).unwrap(), 0.07).unwrap();
        closed(&plane);
        assert!((plane.volume() - 0.27).abs() < 1e-14, "{}", plane.volume());
        let space = Facets::of(&Cuboid::new([0.0; 3], [0.3, 0.5, 0.7]).unwrap(), 0.06).unwrap();
        closed(&space);
        assert!((space.volume() - 0.105).abs() < 1e-14, "{}", space.volume());
    }

    #[test]
    fn round_shapes_converge_in_second_order() {
        let disc = |h| Facets::of(&Ball::new([0.03, -0.01], 0.5).unwrap(), h).unwrap();
        let ball = |h| Facets::of(&Ball::new([0.03, -0.01, 0.2], 0.5).unwrap(), h).unwrap();
        closed(&disc(0.1));
        closed(&ball(0.1));
        let exact = [0.25, 1.0 / 6.0].map(|x| x * std::f64::consts::PI);
        let off = [0.1, 0.05].map(|h| [1.0 - disc(h).volume() / exact[0], 1.0 - ball(h).volume() / exact[1]]);
        for d in 0..2 {
            assert!(off[0][d] > 0.0 && off[0][d] < 0.03, "{off:?}");
            assert!(off[0][d] / off[1][d] > 3.0, "{off:?}");
        }
        assert!(ball(0.1).nodes.iter().all(|x| {
            let r = ((x[0] - 0.03).powi(2) + (x[1] + 0.01).powi(2) + (x[2] - 0.2).powi(2)).sqrt();
            (r - 0.5).abs() < 1e-12
        }));
    }

    #[test]
    fn shapes_with_holes_are_closed() {
        let bore = Cylinder::new([0.5, 0.5, -1.0], [0.0, 0.0, 1.0], 3.0, 0.2).unwrap();
        let block = Cuboid::new([0.0; 3], [1.0; 3]).unwrap().minus(bore);
        let surface = Facets::of(&block, 0.05).unwrap();
        closed(&surface);
        let exact = 1.0 - 0.04 * std::f64::consts::PI;
        assert!((surface.volume() / exact - 1.0).abs() < 0.005, "{} {exact}", surface.volume());
        assert!(Facets::of(&block, 0.0).is_err() && Facets::of(&block, 1e-4).is_err());
    }
}
