//! Particles near a surface that is not on the grid, with the end-of-step velocities of their nodes.

use crate::step::nodes::footprint::NodeWeight;

/// Marker for no index.
const NOWHERE: u32 = u32::MAX;
/// Maximum number of friction sweeps, and change of the impulses, over the largest, at which they have converged.
pub(in crate::step) const SWEEPS: usize = 20;
pub(in crate::step) const FOUND: f64 = 1e-6;

/// Particles near the surface of a [`SurfaceClient`](crate::step::SurfaceClient) in a step, with their nodes and
/// weights. They are sorted by body, and within each in an order that depends on the scene only.
#[derive(Clone, Debug)]
pub struct NearParticles<const D: usize> {
    bodies: Vec<u32>,
    numbers: Vec<usize>,
    positions: Vec<[f64; D]>,
    half_sizes: Vec<f64>,
    starts_with: Vec<[f64; D]>,
    /// Start of the weights of each particle; one more than there are particles.
    starts: Vec<usize>,
    /// Node, by index in this list, and weight by direction, including the mirrored one of its image behind a plane of symmetry.
    weights: Vec<(u32, [f64; D])>,
    pub(in crate::step) nodes: Vec<NearNode<D>>,
    /// Impulse of planes of symmetry, N s: mirror images receive the opposite impulse.
    pub(in crate::step) planes: [f64; D],
    /// Index in this list of each node of the grid up to the last one used, or [`NOWHERE`].
    places: Vec<u32>,
    folded: Vec<NodeWeight<D>>,
    /// Nodes of the last particle, by index on the lattice, with their indices in this list if they have mass; and
    /// the body of the particle.
    stencil: Vec<([i32; D], Option<u32>)>,
    stencil_of: u32,
    /// True if a node occurs twice in the stencil, as itself and behind a plane of symmetry.
    twice: bool,
}

/// Particle that may be in contact with a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NearParticle<const D: usize> {
    /// Number of the particle in its body.
    pub number: usize,
    /// Position, m.
    pub position: [f64; D],
    /// Velocity, m/s.
    pub velocity: [f64; D],
    /// Half the edge of a cube (square in the plane) as large as its domain, m.
    pub half_size: f64,
    /// Half the size of its domain along each axis, m.
    pub reach: [f64; D],
    /// Mass, kg; kg/m in the plane, kg/rad about an axis.
    pub mass: f64,
}

/// Node of particles near a surface.
#[derive(Clone, Copy, Debug)]
pub(in crate::step) struct NearNode<const D: usize> {
    /// Index among all nodes of the grid.
    pub(in crate::step) place: u32,
    /// Position, m.
    pub(in crate::step) position: [f64; D],
    pub(in crate::step) mass: f64,
    /// Velocity at the start of the step, m/s, if known.
    pub(in crate::step) start: Option<[f64; D]>,
    /// Velocity at the end of the step, m/s, and its change due to the surface.
    pub(in crate::step) velocity: [f64; D],
    pub(in crate::step) change: [f64; D],
}

impl<const D: usize> NearNode<D> {
    /// Acceleration along an axis, m/s^2; zero if the velocity at the start of the step is unknown.
    pub(in crate::step) fn acceleration(&self, axis: usize, step: f64) -> f64 {
        self.start.map_or(0.0, |start| (self.velocity[axis] - start[axis]) / step)
    }
}

impl<const D: usize> Default for NearParticles<D> {
    fn default() -> Self {
        NearParticles {
            bodies: Vec::new(),
            numbers: Vec::new(),
            positions: Vec::new(),
            half_sizes: Vec::new(),
            starts_with: Vec::new(),
            starts: vec![0],
            weights: Vec::new(),
            nodes: Vec::new(),
            planes: [0.0; D],
            places: Vec::new(),
            folded: Vec::new(),
            stencil: Vec::new(),
            stencil_of: u32::MAX,
            twice: false,
        }
    }
}

impl<const D: usize> NearParticles<D> {
    /// Number of particles.
    #[must_use]
    pub fn len(&self) -> usize {
        self.positions.len()
    }
    /// True if there are no particles.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.positions.is_empty()
    }
    /// Body of each particle, by number in the scene.
    #[must_use]
    pub fn bodies(&self) -> &[u32] {
        &self.bodies
    }
    /// Number of each particle in its body.
    #[must_use]
    pub fn numbers(&self) -> &[usize] {
        &self.numbers
    }
    /// Positions at the start of the step, m.
    #[must_use]
    pub fn positions(&self) -> &[[f64; D]] {
        &self.positions
    }
    /// Half sizes, m: half the edge of a cube (square in the plane) of the volume of each particle.
    #[must_use]
    pub fn half_sizes(&self) -> &[f64] {
        &self.half_sizes
    }

    /// Store the velocities at the start of the step, m/s, the reference for impulses: those of the nodes; those of
    /// the particles where nodes do not know them (APIC and related transfers).
    pub fn velocities_before(&self, list: &mut Vec<[f64; D]>) {
        list.clear();
        list.extend((0..self.len()).map(|p| {
            let mut sum = [0.0; D];
            for (node, weight) in self.weights(p) {
                let Some(start) = self.nodes[*node as usize].start else { return self.starts_with[p] };
                (0..D).for_each(|d| sum[d] += weight[d] * start[d]);
            }
            sum
        }));
    }

    pub(in crate::step) fn weights(&self, particle: usize) -> &[(u32, [f64; D])] {
        &self.weights[self.starts[particle]..self.starts[particle + 1]]
    }

    /// Find for each `thin` node the nearest node in front of it, by `along` an axis, that is not thin, if it is the
    /// same for all particles with a weight on the thin node. Return indices in this list.
    pub(in crate::step) fn fronts(&self, thin: &[bool], (axis, along): (usize, f64)) -> Vec<Option<u32>> {
        let mut fronts: Vec<Option<Option<u32>>> = vec![None; self.nodes.len()];
        for p in 0..self.len() {
            let weights = self.weights(p);
            for node in weights.iter().map(|(node, _)| *node as usize).filter(|node| thin[*node]) {
                let at = self.nodes[node].position;
                let cells = |other: u32| {
                    let x = self.nodes[other as usize].position;
                    let beside = (0..D).all(|d| d == axis || (x[d] - at[d]).abs() < 0.1 * along.abs());
                    let cells = (x[axis] - at[axis]) / along;
                    (beside && cells > 0.5).then_some((cells, other))
                };
                let front = weights
                    .iter()
                    .filter(|(other, _)| !thin[*other as usize])
                    .filter_map(|(other, _)| cells(*other))
                    .min_by(|a, b| a.0.total_cmp(&b.0))
                    .map(|(_, other)| other);
                fronts[node] = match fronts[node] {
                    Some(known) if known != front => Some(None),
                    _ => Some(front),
                };
            }
        }
        fronts.into_iter().map(Option::flatten).collect()
    }

    /// Transfer the weights of nodes to their fronts.
    pub(in crate::step) fn fold_to(&mut self, fronts: &[Option<u32>]) {
        for p in 0..self.len() {
            let weights = &mut self.weights[self.starts[p]..self.starts[p + 1]];
            for n in 0..weights.len() {
                let Some(front) = fronts[weights[n].0 as usize] else { continue };
                let given = std::mem::replace(&mut weights[n].1, [0.0; D]);
                for (_, weight) in weights.iter_mut().filter(|(node, _)| *node == front) {
                    (0..D).for_each(|d| weight[d] += given[d]);
                }
            }
        }
    }

    /// Store the velocities that will move the particles, m/s.
    pub fn velocities(&self, list: &mut Vec<[f64; D]>) {
        list.clear();
        list.extend((0..self.len()).map(|p| {
            let mut sum = [0.0; D];
            for (node, weight) in self.weights(p) {
                (0..D).for_each(|d| sum[d] += weight[d] * self.nodes[*node as usize].velocity[d]);
            }
            sum
        }));
    }

    /// Start of the weights of each particle; one more than there are particles.
    #[must_use]
    pub fn weight_starts(&self) -> &[usize] {
        &self.starts
    }
    /// Nodes that move each particle, by index in this list, each once, with the weight N_ip in each direction: v_p =
    /// sum_i N_ip v_i, and an impulse J on the particle is N_ip J on node i.
    #[must_use]
    pub fn node_weights(&self) -> &[(u32, [f64; D])] {
        &self.weights
    }
    /// Store velocities at the end of the step, m/s, and masses, kg, of the nodes.
    pub fn nodes(&self, velocities: &mut Vec<[f64; D]>, masses: &mut Vec<f64>) {
        velocities.clear();
        velocities.extend(self.nodes.iter().map(|node| node.velocity));
        masses.clear();
        masses.extend(self.nodes.iter().map(|node| node.mass));
    }

    /// Apply an impulse, N s, to every particle.
    pub fn push(&mut self, impulses: &[[f64; D]]) {
        for (p, impulse) in impulses.iter().enumerate().filter(|(_, j)| **j != [0.0; D]) {
            (0..D).for_each(|d| self.planes[d] -= impulse[d]);
            for n in self.starts[p]..self.starts[p + 1] {
                let (node, weight) = self.weights[n];
                let node = &mut self.nodes[node as usize];
                for d in 0..D {
                    self.planes[d] += weight[d] * impulse[d];
                    let change = weight[d] * impulse[d] / node.mass;
                    node.velocity[d] += change;
                    node.change[d] += change;
                }
            }
        }
    }

    /// Apply Coulomb friction to particles, in this order, on a plane across `axis` of this velocity, m/s: tangential
    /// impulses of at most `limit`, N s, that stop the slip, found one after the other until they converge. Return
    /// the impulses, N s, by particle, and the heat, J.
    pub(in crate::step) fn rub(
        &mut self,
        order: &[usize],
        limit: impl Fn(usize) -> f64,
        axis: usize,
        velocity: &[f64; D],
    ) -> (Vec<[f64; D]>, f64) {
        let mut impulses = vec![[0.0; D]; self.len()];
        for _ in 0..SWEEPS {
            let (mut changed, mut largest) = (0.0f64, 0.0f64);
            for &p in order {
                let (mut slip, mut give) = ([0.0; D], [0.0; D]);
                for (node, weight) in &self.weights[self.starts[p]..self.starts[p + 1]] {
                    let node = &self.nodes[*node as usize];
                    for d in 0..D {
                        slip[d] += weight[d] * node.velocity[d];
                        give[d] += weight[d] * weight[d] / node.mass;
                    }
                }
                let mut wanted = impulses[p];
                for d in (0..D).filter(|d| *d != axis && give[*d] > 0.0) {
                    wanted[d] += (velocity[d] - slip[d]) / give[d];
                }
                let size = wanted.iter().map(|j| j * j).sum::<f64>().sqrt();
                let scale = if size > limit(p) { limit(p) / size } else { 1.0 };
                for d in 0..D {
                    wanted[d] *= scale;
                    let more = wanted[d] - impulses[p][d];
                    impulses[p][d] = wanted[d];
                    changed = changed.max(more.abs());
                    largest = largest.max(wanted[d].abs());
                    for n in self.starts[p]..self.starts[p + 1] {
                        let (node, weight) = self.weights[n];
                        let node = &mut self.nodes[node as usize];
                        let change = weight[d] * more / node.mass;
                        node.velocity[d] += change;
                        node.change[d] += change;
                    }
                }
            }
            if changed <= FOUND * largest {
                break;
            }
        }
        for (p, impulse) in impulses.iter().enumerate() {
            for d in 0..D {
                let given: f64 = self.weights(p).iter().map(|(_, weight)| weight[d]).sum();
                self.planes[d] += (given - 1.0) * impulse[d];
            }
        }
        // A particle at rest at the end of a step was at rest at its start: its trial velocity is that of forces,
        // which friction balances.
        let mut heat = 0.0;
        for (p, impulse) in impulses.iter().enumerate().filter(|(_, j)| **j != [0.0; D]) {
            for (node, weight) in self.weights(p) {
                let node = &self.nodes[*node as usize];
                (0..D).for_each(|d| heat -= impulse[d] * weight[d] * node.velocity[d]);
            }
            (0..D).for_each(|d| heat += impulse[d] * velocity[d]);
        }
        (impulses, heat)
    }

    pub(in crate::step) fn clear(&mut self) {
        self.bodies.clear();
        self.numbers.clear();
        self.positions.clear();
        self.half_sizes.clear();
        self.starts_with.clear();
        self.starts.clear();
        self.starts.push(0);
        self.weights.clear();
        for node in self.nodes.drain(..) {
            self.places[node.place as usize] = NOWHERE;
        }
        self.planes = [0.0; D];
        self.stencil.clear();
    }

    /// Add a particle with its weights from `fold`, without those on nodes of no mass.
    pub(in crate::step) fn add(
        &mut self,
        body: u32,
        particle: &NearParticle<D>,
        fold: &mut dyn FnMut(&mut Vec<NodeWeight<D>>),
        node_at: &dyn Fn(&[i32; D]) -> Option<NearNode<D>>,
    ) {
        let mut folded = std::mem::take(&mut self.folded);
        fold(&mut folded);
        // Particles of a bin have the same nodes in the same order.
        let known = folded.len() == self.stencil.len()
            && self.stencil_of == body
            && folded.iter().zip(&self.stencil).all(|(w, (node, _))| w.node == *node);
        if !known {
            self.stencil_of = body;
            self.stencil.clear();
            self.twice = false;
            for w in &folded {
                let place = node_at(&w.node).map(|node| {
                    let at = node.place as usize;
                    if self.places.len() <= at {
                        self.places.resize(at + 1, NOWHERE);
                    }
                    if self.places[at] == NOWHERE {
                        self.places[at] = self.nodes.len() as u32;
                        self.nodes.push(node);
                    }
                    self.places[at]
                });
                self.twice |= place.is_some() && self.stencil.iter().any(|(_, known)| *known == place);
                self.stencil.push((w.node, place));
            }
        }
        let first = self.weights.len();
        for (w, (_, place)) in folded.iter().zip(&self.stencil).filter(|(w, _)| w.value != 0.0) {
            let Some(place) = *place else { continue };
            let weight = std::array::from_fn(|d| w.sign[d] * w.value);
            let again =
                if self.twice { self.weights[first..].iter_mut().find(|w| w.0 == place) } else { None };
            match again {
                Some((_, sum)) => (0..D).for_each(|d| sum[d] += weight[d]),
                None => self.weights.push((place, weight)),
            }
        }
        self.folded = folded;
        self.starts.push(self.weights.len());
        self.bodies.push(body);
        self.numbers.push(particle.number);
        self.positions.push(particle.position);
        self.half_sizes.push(particle.half_size);
        self.starts_with.push(particle.velocity);
    }

    /// Memory, bytes.
    pub(in crate::step) fn bytes(&self) -> usize {
        self.positions.capacity() * size_of::<([[f64; D]; 2], f64, usize, usize, u32)>()
            + self.weights.capacity() * size_of::<(u32, [f64; D])>()
            + self.nodes.capacity() * size_of::<NearNode<D>>()
            + self.places.capacity() * size_of::<u32>()
    }
}
