//! Nodes of elements that are tied to particles of the same body: their points on the grid.

use std::collections::{BTreeMap, BTreeSet};

use fem::{ConvertedElement, ElementBody};
use impactite_geometry::Facet;

/// Edges of facets in cells above which points between their nodes are tied, too.
const WIDE: f64 = 1.05;

/// What tells a point from others: nodes of its facet, sorted, and its number there; of a node that alone.
type Key = ([u32; 4], u32);

/// A point on the grid, with parts of the mass, momentum and force of nodes.
#[derive(Clone, Debug, PartialEq)]
struct Point {
    key: Key,
    /// Nodes with what of each it has: all parts of a node are one.
    parts: Vec<(u32, f64)>,
    /// Nodes with their shape functions: it lies on their facet.
    place: Vec<(u32, f64)>,
}

/// The points of a body. Where facets between elements and particles are no larger than cells, they are the nodes there, and on larger ones
/// points between them as well, about as many as there are cells: through these particles would pass otherwise.
///
/// A point s has the mass m_s = sum_a A_sa m_a of nodes a, and their momentum and force likewise, with sum_s A_sa = 1; what it gains in a step
/// goes to the nodes by the same parts, dv_a = sum_s A_sa dv_s, so that sum_a m_a dv_a = sum_s m_s dv_s. That is all that a node gains: its own
/// force moves it through the points alone, or what these do not see of it would speed it up for ever, since it moves with the matter.
#[derive(Clone, Debug, Default)]
pub(crate) struct Tied<const D: usize> {
    points: Vec<Point>,
    /// Facets of elements that became particles.
    bare: BTreeSet<[u32; 4]>,
    /// Nodes of elements that became particles.
    touched: BTreeSet<u32>,
    /// Before the step, m/s: velocities of the nodes, in their order, and of the points.
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
        let known: BTreeMap<Key, u32> = self.points.iter().map(|p| p.key).zip(0..).collect();
        self.touched.retain(|&n| body.elements_at(n as usize) > 0);
        let facets: Vec<&Facet> =
            body.surface().iter().filter(|facet| self.bare.contains(&sorted(facet.nodes()))).collect();
        // Facets of what became particles long ago have no elements behind them any more.
        self.bare.retain(|facet| facet.iter().any(|n| self.touched.contains(n)));
        let mut longest = 0.0f64;
        for facet in &facets {
            let nodes = facet.nodes();
            for (n, &a) in nodes.iter().enumerate() {
                let [a, b] = [a, nodes[(n + 1) % nodes.len()]].map(|n| body.nodes()[n as usize].position);
                longest = longest.max((0..D).map(|d| (a[d] - b[d]).powi(2)).sum::<f64>().sqrt());
            }
        }
        let parts = (longest / (WIDE * spacing)).ceil().clamp(1.0, 16.0) as u32;
        let node = |&n: &u32| Point { key: (sorted(&[n]), 0), parts: vec![(n, 0.0)], place: vec![(n, 1.0)] };
        self.points = self.touched.iter().map(node).collect();
        let own: BTreeMap<u32, usize> = self.touched.iter().copied().zip(0..).collect();
        let mut sums: BTreeMap<u32, f64> = BTreeMap::new();
        for facet in facets {
            let (key, nodes) = (sorted(facet.nodes()), facet.nodes());
            for (k, (shares, weight)) in on_facet(nodes.len(), parts).into_iter().enumerate() {
                let place: Vec<(u32, f64)> =
                    nodes.iter().copied().zip(shares).filter(|s| s.1 > 0.0).collect();
                let parts: Vec<(u32, f64)> = place.iter().map(|&(n, share)| (n, share * weight)).collect();
                parts.iter().for_each(|&(n, part)| *sums.entry(n).or_default() += part);
                match place[..] {
                    [(n, _)] => self.points[own[&n]].parts[0].1 += weight,
                    _ => self.points.push(Point { key: (key, k as u32), parts, place }),
                }
            }
        }
        for point in &mut self.points {
            for (n, part) in &mut point.parts {
                // Nodes of edges or corners alone have themselves.
                *part = sums.get(n).map_or(1.0, |sum| *part / sum);
            }
        }
        self.points.iter().map(|p| known.get(&p.key).copied().unwrap_or(u32::MAX)).collect()
    }

    /// Mass, kg, and velocity, m/s.
    pub fn mass_points(&self, body: &ElementBody<D>) -> Vec<(f64, [f64; D])> {
        self.points
            .iter()
            .map(|point| {
                let (mut mass, mut momentum) = (0.0, [0.0; D]);
                for &(n, part) in &point.parts {
                    let node = &body.nodes()[n as usize];
                    mass += part * node.mass;
                    (0..D).for_each(|d| momentum[d] += part * node.mass * node.velocity[d]);
                }
                (mass, momentum.map(|p| p / mass))
            })
            .collect()
    }

    /// Their velocities, m/s.
    pub fn velocities(&self, body: &ElementBody<D>, out: &mut [[f64; 3]]) {
        for (to, (_, velocity)) in out.iter_mut().zip(self.mass_points(body)) {
            to[..D].copy_from_slice(&velocity);
        }
    }

    /// Where they are, m.
    pub fn positions<'a>(&'a self, body: &'a ElementBody<D>) -> impl Iterator<Item = [f64; D]> + 'a {
        self.points.iter().map(|point| {
            let mut x = [0.0; D];
            for &(n, share) in &point.place {
                let node = &body.nodes()[n as usize].position;
                (0..D).for_each(|d| x[d] += share * node[d]);
            }
            x
        })
    }

    /// Note the velocities before a step.
    pub fn remember(&mut self, body: &ElementBody<D>) {
        let points = self.mass_points(body).into_iter().map(|(_, velocity)| velocity).collect();
        let nodes = self.touched.iter().map(|&n| body.nodes()[n as usize].velocity).collect();
        self.before = [nodes, points];
    }

    /// Give the nodes, which moved by their own forces, what the points gained, as impulses: `changes`, m/s, are those of the velocities that these
    /// had by then, none where there are none.
    pub fn push(&self, body: &mut ElementBody<D>, changes: &[[f64; 3]]) {
        let tried = self.mass_points(body);
        let mut gains: BTreeMap<u32, [f64; D]> = self.touched.iter().map(|&n| (n, [0.0; D])).collect();
        for (s, (point, (_, tried))) in self.points.iter().zip(tried).enumerate() {
            let change = changes.get(s).copied().unwrap_or_default();
            for &(n, part) in &point.parts {
                let Some(sum) = gains.get_mut(&n) else { continue };
                (0..D).for_each(|d| sum[d] += part * (tried[d] + change[d] - self.before[1][s][d]));
            }
        }
        for ((n, gain), before) in gains.into_iter().zip(&self.before[0]) {
            let node = body.nodes()[n as usize];
            let impulse = std::array::from_fn(|d| node.mass * (before[d] + gain[d] - node.velocity[d]));
            body.add_impulse(n as usize, impulse);
        }
    }

    /// Move the nodes with the velocities, m/s, that matter has where they are.
    pub fn carry(&self, body: &mut ElementBody<D>, velocities: &[[f64; 3]]) {
        for (point, v) in self.points.iter().zip(velocities) {
            if let [(n, _)] = point.place[..] {
                body.carry(n as usize, std::array::from_fn(|d| v[d]));
            }
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
        let of = |p: &Point| (p.parts.capacity() + p.place.capacity()) * size_of::<(u32, f64)>();
        self.points.iter().map(of).sum::<usize>()
            + self.points.capacity() * size_of::<Point>()
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
