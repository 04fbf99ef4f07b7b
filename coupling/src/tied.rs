//! Nodes of elements that are tied to particles of the same body: their points on the grid.

use std::collections::{BTreeMap, BTreeSet};

use fem::{ConvertedElement, ElementBody};
use impactite_geometry::Facet;

/// Edges of facets in cells above which points between their nodes are tied, too: nodes closer to each other share nodes of the grid.
const WIDE: f64 = 1.5;

/// What tells a point from others: nodes of its facet, sorted, and its number there; of a node that alone.
type Key = ([u32; 4], u32);

/// A point on the grid as it is found, with parts of the mass, momentum and force of nodes.
struct Point {
    key: Key,
    /// Nodes with what of each it has: all parts of a node are one.
    parts: Vec<(u32, f64)>,
    /// Nodes with their shape functions: it lies on their facet.
    place: Vec<(u32, f64)>,
}

/// Lists of nodes with numbers, one a point.
#[derive(Clone, Debug, Default)]
struct Lists {
    starts: Vec<u32>,
    entries: Vec<(u32, f64)>,
}

impl Lists {
    fn of<'a>(lists: impl Iterator<Item = &'a [(u32, f64)]>) -> Self {
        let mut all = Lists { starts: vec![0], entries: Vec::new() };
        for list in lists {
            all.entries.extend_from_slice(list);
            all.starts.push(all.entries.len() as u32);
        }
        all
    }
    fn get(&self, point: usize) -> &[(u32, f64)] {
        &self.entries[self.starts[point] as usize..self.starts[point + 1] as usize]
    }
    fn bytes(&self) -> usize {
        self.starts.capacity() * 4 + self.entries.capacity() * size_of::<(u32, f64)>()
    }
}

/// The points of a body. Where facets between elements and particles are no larger than cells, they are the nodes there, and on larger ones
/// points between them as well, about as many as there are cells: through these particles would pass otherwise.
///
/// A point s has the mass m_s = sum_a A_sa m_a of nodes a, and their momentum and force likewise, with sum_s A_sa = 1; what it gains in a step
/// goes to the nodes by the same parts, dv_a = sum_s A_sa dv_s, so that sum_a m_a dv_a = sum_s m_s dv_s. That is all that a node gains: its own
/// force moves it through the points alone, or what these do not see of it would speed it up for ever, since it moves with the matter.
#[derive(Clone, Debug, Default)]
pub(crate) struct Tied<const D: usize> {
    /// The nodes, sorted: the first points are at these.
    nodes: Vec<u32>,
    keys: Vec<Key>,
    /// By place among the nodes.
    parts: Lists,
    /// By number in the body.
    places: Lists,
    /// Facets of elements that became particles.
    bare: BTreeSet<[u32; 4]>,
    /// Nodes of elements that became particles.
    touched: BTreeSet<u32>,
    /// Before the step, m/s: velocities of the nodes, and of the points.
    before: [Vec<[f64; D]>; 2],
}

fn sorted(facet: &[u32]) -> [u32; 4] {
    let mut key = [Facet::NONE; 4];
    key[..facet.len()].copy_from_slice(facet);
    key.sort_unstable();
    key
}

impl<const D: usize> Tied<D> {
    /// Elements that became particles.
    pub fn add(&mut self, elements: &[ConvertedElement<D>]) {
        for element in elements {
            self.touched.extend(&element.nodes);
            for places in element.kind.facets() {
                let nodes: Vec<u32> = places.iter().map(|&p| element.nodes[p]).collect();
                self.bare.insert(sorted(&nodes));
            }
        }
    }

    /// Find the points anew, on a grid of cells of `spacing`, m. Returns the number that each had, `u32::MAX` of new ones.
    pub fn find(&mut self, body: &ElementBody<D>, spacing: f64) -> Vec<u32> {
        let known: BTreeMap<Key, u32> = self.keys.iter().copied().zip(0..).collect();
        self.touched.retain(|&n| body.elements_at(n as usize) > 0);
        let facets: Vec<&Facet> =
            body.surface().iter().filter(|facet| self.bare.contains(&sorted(facet.nodes()))).collect();
        // Facets of what became particles long ago have no elements behind them any more.
        self.bare.retain(|facet| facet.iter().any(|n| self.touched.contains(n)));
        let node = |&n: &u32| Point { key: (sorted(&[n]), 0), parts: vec![(n, 0.0)], place: vec![(n, 1.0)] };
        let mut points: Vec<Point> = self.touched.iter().map(node).collect();
        let own: BTreeMap<u32, usize> = self.touched.iter().copied().zip(0..).collect();
        let mut sums = vec![0.0; points.len()];
        for facet in facets {
            let (key, nodes) = (sorted(facet.nodes()), facet.nodes());
            let edge = |n: usize| -> f64 {
                let [a, b] =
                    [nodes[n], nodes[(n + 1) % nodes.len()]].map(|n| body.nodes()[n as usize].position);
                (0..D).map(|d| (a[d] - b[d]).powi(2)).sum::<f64>().sqrt()
            };
            let longest = (0..nodes.len()).map(edge).fold(0.0, f64::max);
            let cut = if longest > WIDE * spacing {
                (longest / spacing).round().clamp(1.0, 16.0) as u32
            } else {
                1
            };
            for (k, (shares, weight)) in on_facet(nodes.len(), cut).into_iter().enumerate() {
                let place: Vec<(u32, f64)> =
                    nodes.iter().copied().zip(shares).filter(|s| s.1 > 0.0).collect();
                let parts: Vec<(u32, f64)> = place.iter().map(|&(n, share)| (n, share * weight)).collect();
                parts.iter().for_each(|&(n, part)| sums[own[&n]] += part);
                match place[..] {
                    [(n, _)] => points[own[&n]].parts[0].1 += weight,
                    _ => points.push(Point { key: (key, k as u32), parts, place }),
                }
            }
        }
        for point in &mut points {
            for (n, part) in &mut point.parts {
                let local = own[n];
                // Nodes of edges or corners alone have themselves.
                (*n, *part) = (local as u32, if sums[local] > 0.0 { *part / sums[local] } else { 1.0 });
            }
        }
        self.nodes = self.touched.iter().copied().collect();
        self.keys = points.iter().map(|p| p.key).collect();
        self.parts = Lists::of(points.iter().map(|p| &p.parts[..]));
        self.places = Lists::of(points.iter().map(|p| &p.place[..]));
        self.keys.iter().map(|key| known.get(key).copied().unwrap_or(u32::MAX)).collect()
    }

    /// Mass, kg, and velocity, m/s, of a point.
    #[inline]
    fn motion(&self, body: &ElementBody<D>, point: usize) -> (f64, [f64; D]) {
        let (mut mass, mut momentum) = (0.0, [0.0; D]);
        for &(local, part) in self.parts.get(point) {
            let node = &body.nodes()[self.nodes[local as usize] as usize];
            mass += part * node.mass;
            (0..D).for_each(|d| momentum[d] += part * node.mass * node.velocity[d]);
        }
        (mass, momentum.map(|p| p / mass))
    }

    /// Mass, kg, and velocity, m/s.
    pub fn mass_points(&self, body: &ElementBody<D>) -> Vec<(f64, [f64; D])> {
        (0..self.keys.len()).map(|point| self.motion(body, point)).collect()
    }

    /// Their velocities, m/s.
    pub fn velocities(&self, body: &ElementBody<D>, out: &mut [[f64; 3]]) {
        for (point, to) in out.iter_mut().enumerate() {
            to[..D].copy_from_slice(&self.motion(body, point).1);
        }
    }

    /// Where they are, m.
    pub fn positions<'a>(&'a self, body: &'a ElementBody<D>) -> impl Iterator<Item = [f64; D]> + 'a {
        (0..self.keys.len()).map(|point| {
            let mut x = [0.0; D];
            for &(n, share) in self.places.get(point) {
                let node = &body.nodes()[n as usize].position;
                (0..D).for_each(|d| x[d] += share * node[d]);
            }
            x
        })
    }

    /// Note the velocities before a step.
    pub fn remember(&mut self, body: &ElementBody<D>) {
        let mut before = std::mem::take(&mut self.before);
        before.iter_mut().for_each(Vec::clear);
        before[0].extend(self.nodes.iter().map(|&n| body.nodes()[n as usize].velocity));
        before[1].extend((0..self.keys.len()).map(|point| self.motion(body, point).1));
        self.before = before;
    }

    /// Give the nodes, which moved by their own forces, what the points gained, as impulses: `changes`, m/s, are those of the velocities that these
    /// had by then, none where there are none.
    pub fn push(&self, body: &mut ElementBody<D>, changes: &[[f64; 3]]) {
        let mut ends = self.before[0].clone();
        for (point, before) in self.before[1].iter().enumerate() {
            let change = changes.get(point).copied().unwrap_or_default();
            let (_, tried) = self.motion(body, point);
            for &(local, part) in self.parts.get(point) {
                let end = &mut ends[local as usize];
                (0..D).for_each(|d| end[d] += part * (tried[d] + change[d] - before[d]));
            }
        }
        for (&n, end) in self.nodes.iter().zip(ends) {
            let node = body.nodes()[n as usize];
            body.add_impulse(n as usize, std::array::from_fn(|d| node.mass * (end[d] - node.velocity[d])));
        }
    }

    /// Move the nodes with the velocities, m/s, that matter has where they are.
    pub fn carry(&self, body: &mut ElementBody<D>, velocities: &[[f64; 3]]) {
        for (&n, v) in self.nodes.iter().zip(velocities) {
            body.carry(n as usize, std::array::from_fn(|d| v[d]));
        }
    }

    /// The sets that it is found from, as lists.
    pub fn lists(&self) -> (Vec<u32>, Vec<[u32; 4]>) {
        (self.touched.iter().copied().collect(), self.bare.iter().copied().collect())
    }

    /// Of such lists.
    pub fn of_lists(touched: Vec<u32>, bare: Vec<[u32; 4]>) -> Self {
        let (touched, bare) = (touched.into_iter().collect(), bare.into_iter().collect());
        Tied { bare, touched, ..Tied::default() }
    }

    pub fn bytes(&self) -> usize {
        self.keys.capacity() * size_of::<Key>()
            + self.parts.bytes()
            + self.places.bytes()
            + self.nodes.capacity() * size_of::<u32>()
            + self.before.iter().map(|list| list.capacity() * size_of::<[f64; D]>()).sum::<usize>()
            + self.bare.len() * size_of::<[u32; 4]>()
            + self.touched.len() * size_of::<u32>()
    }
}

/// Points of a facet of so many nodes, cut into so many parts along each edge: shape functions of the nodes there and weights (trapezoidal
/// rule).
fn on_facet(nodes: usize, parts: u32) -> Vec<(Vec<f64>, f64)> {
    let at = |k: u32| f64::from(k) / f64::from(parts);
    let ends = |k: u32| if k == 0 || k == parts { 0.5 } else { 1.0 };
    let mut list = Vec::new();
    match nodes {
        2 => list.extend((0..=parts).map(|k| (vec![1.0 - at(k), at(k)], ends(k)))),
        3 => {
            for i in 0..=parts {
                for j in 0..=parts - i {
                    let shares = vec![1.0 - at(i) - at(j), at(i), at(j)];
                    let zeros = [i, j, parts - i - j].iter().filter(|&&k| k == 0).count();
                    let shares = shares.into_iter().map(|s: f64| if s < 1e-12 { 0.0 } else { s }).collect();
                    list.push((shares, [1.0, 0.5, 1.0 / 6.0][zeros]));
                }
            }
        }
        _ => {
            for i in 0..=parts {
                for j in 0..=parts {
                    let (x, y) = (at(i), at(j));
                    let shares = vec![(1.0 - x) * (1.0 - y), x * (1.0 - y), x * y, (1.0 - x) * y];
                    list.push((shares, ends(i) * ends(j)));
                }
            }
        }
    }
    list
}
