//! Elements that are tied to particles of the same body: their points on the grid.

use std::collections::{BTreeMap, BTreeSet};

use fem::{ConvertedElement, ElementBody};
use impactite_geometry::{ElementKind, ElementMesh, Facet};
use impactite_scene::{Body, SceneError};
use mpm_core::Surroundings;

use crate::element::{NODES, box_around};

/// Edge length, in cells, above which points between border nodes are tied, too: nodes closer to each other share nodes of the grid.
const WIDE: f64 = 1.5;
/// Threshold for elements that are wide only by stretch, in cells. Points between nodes do not match the motion caused by nodal forces: a
/// yielding foot that was tied in this way gained energy (0.8 % of the total of a steel bar at 224 m/s).
const STRETCHED: f64 = 2.0;
/// Depth behind the border, in cells, within which elements are tied. Grid nodes reached by particles at the border also represent the
/// matter behind it: with border nodes alone they lack mass and have one-sided strains, and two periods of a standing wave lose a fifth of
/// the energy.
const DEPTH: f64 = 1.5;
/// Maximum number of parts along an edge.
const MOST_PARTS: f64 = 16.0;

/// Identity of a point.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Key {
    Node(u32),
    /// Sorted nodes, with their shape functions in parts of 2^16.
    Between(Vec<(u32, u32)>),
}

/// Point on the grid during the search, with parts of the mass, momentum and force of nodes.
struct Point {
    key: Key,
    /// Nodes with the part of each at this point: the parts of a node sum to one.
    parts: Vec<(u32, f64)>,
    /// Nodes with their shape functions at the point.
    place: Vec<(u32, f64)>,
}

/// Lists of nodes with numbers, one list per point.
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

/// Elements at each node of a mesh.
#[derive(Clone, Debug, Default)]
struct Around {
    starts: Vec<u32>,
    elements: Vec<u32>,
    /// Number of the first element of each block.
    blocks: Vec<u32>,
}

impl Around {
    fn of<const D: usize>(mesh: &ElementMesh<D>) -> Self {
        let mut starts = vec![0u32; mesh.nodes.len() + 1];
        let all = || mesh.blocks.iter().flat_map(|block| block.elements());
        all().flatten().for_each(|&n| starts[n as usize + 1] += 1);
        (1..starts.len()).for_each(|n| starts[n] += starts[n - 1]);
        let mut next = starts.clone();
        let mut elements = vec![0; starts.last().map_or(0, |&end| end as usize)];
        for (number, nodes) in (0u32..).zip(all()) {
            for &n in nodes {
                elements[next[n as usize] as usize] = number;
                next[n as usize] += 1;
            }
        }
        let mut first = 0;
        let blocks = mesh.blocks.iter().map(|block| {
            first += block.len() as u32;
            first - block.len() as u32
        });
        Around { blocks: blocks.collect(), starts, elements }
    }

    fn at(&self, node: u32) -> &[u32] {
        &self.elements[self.starts[node as usize] as usize..self.starts[node as usize + 1] as usize]
    }

    /// Kind and nodes of an element, by its number.
    fn element<'a, const D: usize>(&self, mesh: &'a ElementMesh<D>, number: u32) -> (ElementKind, &'a [u32]) {
        let block = self.blocks.partition_point(|&first| first <= number) - 1;
        let (kind, all) = (mesh.blocks[block].kind, &mesh.blocks[block].nodes);
        let first = (number - self.blocks[block]) as usize * kind.nodes();
        (kind, &all[first..first + kind.nodes()])
    }
}

/// Tied points of a body, for elements beside converted ones and elements crossed by bars: at their nodes and, on facets between wide
/// elements and particles, also between the nodes, about one per cell, so that particles do not pass through.
///
/// A point s has the mass m_s = sum_a A_sa m_a of nodes a, and momentum and force likewise, with sum_s A_sa = 1. Its velocity change in a
/// step is distributed to the nodes by the same parts, dv_a = sum_s A_sa dv_s, so that sum_a m_a dv_a = sum_s m_s dv_s. Nodes have no other
/// velocity change: their own force moves them through the points alone. Force components without effect on the points would otherwise
/// accelerate a node for ever, since it moves with the matter.
#[derive(Clone, Debug, Default)]
pub(crate) struct Tied<const D: usize> {
    /// Sorted nodes: the first points are at these.
    nodes: Vec<u32>,
    keys: Vec<Key>,
    /// Parts, by index among the nodes.
    parts: Lists,
    /// Shape functions, by node number in the body.
    places: Lists,
    /// Nodes of converted elements, and of elements crossed by bars.
    touched: BTreeSet<u32>,
    /// Elements at the nodes; built on first use.
    around: Option<Around>,
    /// Velocities of the nodes, and of the points, before the step, m/s.
    before: [Vec<[f64; D]>; 2],
}

impl<const D: usize> Tied<D> {
    /// Register converted elements.
    pub fn add(&mut self, elements: &[ConvertedElement<D>]) {
        elements.iter().for_each(|element| self.touched.extend(&element.nodes));
    }

    /// Tie the elements crossed by bars, so that bars move with their matter. Returns true if there are new ones.
    ///
    /// # Errors
    /// Elements so wide that bars would miss the nodes of their forces.
    pub fn join(&mut self, body: &ElementBody<D>, around: &Surroundings<D>) -> Result<bool, SceneError> {
        let known = self.touched.len();
        if around.within.is_empty() {
            return Ok(false);
        }
        let all = body.mesh().blocks.iter().flat_map(|b| b.elements().map(|nodes| (b.kind, nodes)));
        for (_, (kind, nodes)) in all.enumerate().filter(|(number, _)| body.is_there(*number)) {
            let (low, high) = box_around(body, nodes);
            if !around.within.touches(&low, &high) {
                continue;
            }
            if longest_edge(kind, nodes, |n| body.nodes()[n].position) > WIDE * around.spacing() {
                return Err(SceneError::NotWith {
                    what: format!(
                        "bars in elements of `{}` that are wider than one and a half cells",
                        body.name()
                    ),
                    method: "elements that become particles".into(),
                    why: "on the grid bars would miss their nodes: take a finer mesh, or a coarser grid",
                });
            }
            self.touched.extend(nodes);
        }
        Ok(self.touched.len() > known)
    }

    /// Tied elements, and their nodes, sorted.
    fn zone(&self, body: &ElementBody<D>, around: &Around, layers: u32) -> (Vec<u32>, Vec<u32>) {
        let (mut nodes, mut elements) = (self.touched.clone(), BTreeSet::new());
        let mut front: Vec<u32> = nodes.iter().copied().collect();
        for _ in 0..layers {
            let mut next = Vec::new();
            for &element in front.iter().flat_map(|&n| around.at(n)) {
                if body.is_there(element as usize) && elements.insert(element) {
                    let own = around.element(body.mesh(), element).1;
                    next.extend(own.iter().copied().filter(|&n| nodes.insert(n)));
                }
            }
            front = next;
        }
        (elements.into_iter().collect(), nodes.into_iter().collect())
    }

    /// Rebuild the points on a grid of cells of `spacing`, m; `edge` is the mean edge length of the elements at rest, m. Returns the
    /// previous number of each point, `u32::MAX` for new ones.
    pub fn find(&mut self, body: &ElementBody<D>, [spacing, edge]: [f64; 2]) -> Vec<u32> {
        let known: BTreeMap<Key, u32> = self.keys.drain(..).zip(0..).collect();
        self.touched.retain(|&n| body.elements_at(n as usize) > 0);
        let around = self.around.take().unwrap_or_else(|| Around::of(body.mesh()));
        let layers = (DEPTH * spacing / edge).ceil().clamp(1.0, 8.0) as u32;
        let (elements, nodes) = self.zone(body, &around, layers);
        let local = |n: u32| nodes.partition_point(|&m| m < n) as u32;
        let mut points: Vec<Point> = nodes
            .iter()
            .map(|&n| Point { key: Key::Node(n), parts: vec![(local(n), 0.0)], place: vec![(n, 1.0)] })
            .collect();
        let mut between: BTreeMap<Key, usize> = BTreeMap::new();
        let mut sums = vec![0.0; nodes.len()];
        let mut border: Option<BTreeSet<[u32; 4]>> = None;
        for element in elements {
            let (kind, own) = around.element(body.mesh(), element);
            let longest = longest_edge(kind, own, |n| body.nodes()[n].position);
            let at_rest = longest_edge(kind, own, |n| body.mesh().nodes[n]);
            let most = if at_rest > WIDE * spacing { WIDE } else { STRETCHED };
            if longest <= most * spacing {
                continue;
            }
            let border = &*border.get_or_insert_with(|| self.border(body));
            let of_border = |places: &&[usize]| border.contains(&sorted(places, own));
            let facets: Vec<&[usize]> = kind.facets().iter().copied().filter(of_border).collect();
            for (values, weight) in lattice(kind, (longest / spacing).round().min(MOST_PARTS) as u32) {
                let on = |facet: &&&[usize]| (0..own.len()).all(|n| values[n] == 0.0 || facet.contains(&n));
                let weight = weight * facets.iter().filter(on).count() as f64;
                if weight == 0.0 {
                    continue;
                }
                let place: Vec<(u32, f64)> =
                    own.iter().copied().zip(values).filter(|share| share.1 > 0.0).collect();
                let point = match place[..] {
                    [(n, _)] => local(n) as usize,
                    _ => {
                        let mut key: Vec<(u32, u32)> =
                            place.iter().map(|&(n, share)| (n, (65536.0 * share).round() as u32)).collect();
                        key.sort_unstable();
                        let key = Key::Between(key);
                        let new = points.len();
                        let point = *between.entry(key.clone()).or_insert(new);
                        if point == new {
                            let parts = place.iter().map(|&(n, _)| (local(n), 0.0)).collect();
                            points.push(Point { key, parts, place: place.clone() });
                        }
                        point
                    }
                };
                for &(n, share) in &place {
                    let n = local(n);
                    sums[n as usize] += share * weight;
                    if let Some(part) = points[point].parts.iter_mut().find(|part| part.0 == n) {
                        part.1 += share * weight;
                    }
                }
            }
        }
        for (n, part) in points.iter_mut().flat_map(|point| &mut point.parts) {
            // Nodes on no such facet have a part of one.
            let sum = sums[*n as usize];
            *part = if sum > 0.0 { *part / sum } else { 1.0 };
        }
        self.parts = Lists::of(points.iter().map(|p| &p.parts[..]));
        self.places = Lists::of(points.iter().map(|p| &p.place[..]));
        self.keys = points.into_iter().map(|p| p.key).collect();
        (self.nodes, self.around) = (nodes, Some(around));
        self.keys.iter().map(|key| known.get(key).copied().unwrap_or(u32::MAX)).collect()
    }

    /// Find the facets between elements and particles.
    fn border(&self, body: &ElementBody<D>) -> BTreeSet<[u32; 4]> {
        let facets = body.surface().iter().map(Facet::nodes);
        let tied = facets.filter(|nodes| nodes.iter().all(|n| self.touched.contains(n)));
        tied.map(|nodes| sorted(&[0, 1, 2, 3][..nodes.len()], nodes)).collect()
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

    /// Masses, kg, and velocities, m/s, of the points.
    pub fn mass_points(&self, body: &ElementBody<D>) -> Vec<(f64, [f64; D])> {
        (0..self.keys.len()).map(|point| self.motion(body, point)).collect()
    }

    /// Write the velocities of the points, m/s.
    pub fn velocities(&self, body: &ElementBody<D>, out: &mut [[f64; 3]]) {
        for (point, to) in out.iter_mut().enumerate() {
            to[..D].copy_from_slice(&self.motion(body, point).1);
        }
    }

    /// Positions of the points, m.
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

    /// Store the velocities before a step.
    pub fn remember(&mut self, body: &ElementBody<D>) {
        let mut before = std::mem::take(&mut self.before);
        before.iter_mut().for_each(Vec::clear);
        before[0].extend(self.nodes.iter().map(|&n| body.nodes()[n as usize].velocity));
        before[1].extend((0..self.keys.len()).map(|point| self.motion(body, point).1));
        self.before = before;
    }

    /// Apply the velocity changes of the points as impulses to the nodes, which moved by their own forces: `changes`, m/s, add to the trial
    /// velocities of the points; zero where missing.
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

    /// Move the nodes with the velocities, m/s, of the matter at their positions.
    pub fn carry(&self, body: &mut ElementBody<D>, velocities: &[[f64; 3]]) {
        for (&n, v) in self.nodes.iter().zip(velocities) {
            body.carry(n as usize, std::array::from_fn(|d| v[d]));
        }
    }

    /// Nodes that define the points.
    pub fn touched(&self) -> Vec<u32> {
        self.touched.iter().copied().collect()
    }

    /// Create from the nodes that define the points.
    pub fn of(touched: Vec<u32>) -> Self {
        Tied { touched: touched.into_iter().collect(), ..Tied::default() }
    }

    pub fn bytes(&self) -> usize {
        let between = |key: &Key| match key {
            Key::Node(_) => 0,
            Key::Between(list) => list.capacity() * size_of::<(u32, u32)>(),
        };
        let around = self.around.as_ref().map_or(0, |a| a.starts.capacity() + a.elements.capacity());
        self.keys.capacity() * size_of::<Key>()
            + self.keys.iter().map(between).sum::<usize>()
            + self.parts.bytes()
            + self.places.bytes()
            + (self.nodes.capacity() + around) * size_of::<u32>()
            + self.before.iter().map(|list| list.capacity() * size_of::<[f64; D]>()).sum::<usize>()
            + self.touched.len() * size_of::<u32>()
    }
}

/// Nodes at these corners, sorted.
fn sorted(places: &[usize], nodes: &[u32]) -> [u32; 4] {
    let mut key = [Facet::NONE; 4];
    key.iter_mut().zip(places).for_each(|(to, &place)| *to = nodes[place]);
    key.sort_unstable();
    key
}

/// Longest edge of an element with these node positions, m.
fn longest_edge<const D: usize>(kind: ElementKind, nodes: &[u32], place: impl Fn(usize) -> [f64; D]) -> f64 {
    let square = |&[a, b]: &[usize; 2]| -> f64 {
        let [a, b] = [a, b].map(|n| place(nodes[n] as usize));
        (0..D).map(|d| (a[d] - b[d]).powi(2)).sum()
    };
    kind.edges().iter().map(square).fold(0.0, f64::max).sqrt()
}

/// Points of an element divided into `parts` along each edge: shape functions of its nodes, and weights (trapezoidal rule) that sum to one.
fn lattice(kind: ElementKind, parts: u32) -> Vec<([f64; NODES], f64)> {
    let dim = kind.dimensions();
    let at = |k: u32| f64::from(k) / f64::from(parts);
    let all = (0..(parts + 1).pow(dim as u32)).map(|n| -> [u32; 3] {
        std::array::from_fn(|d| if d < dim { n / (parts + 1).pow(d as u32) % (parts + 1) } else { 0 })
    });
    let mut list: Vec<([f64; NODES], f64)> = Vec::new();
    for k in all {
        let (xi, weight) = if kind.is_simplex() {
            let Some(first) = parts.checked_sub(k.iter().sum()) else { continue };
            let zeros = k[..dim].iter().chain([&first]).filter(|&&k| k == 0).count();
            // Part of a small simplex around the point that is inside the element.
            (k.map(at), [1.0, 1.0 / 2.0, 1.0 / 6.0, 1.0 / 24.0][zeros])
        } else {
            let ends = k[..dim].iter().filter(|&&k| k == 0 || k == parts).count();
            let xi = std::array::from_fn(|d| if d < dim { 2.0 * at(k[d]) - 1.0 } else { 0.0 });
            (xi, 0.5f64.powi(ends as i32))
        };
        let mut values = kind.shape_functions(xi);
        values.iter_mut().filter(|value| value.abs() < 1e-12).for_each(|value| *value = 0.0);
        list.push((values, weight));
    }
    let sum: f64 = list.iter().map(|point| point.1).sum();
    list.iter_mut().for_each(|point| point.1 /= sum);
    list
}
