//! Contact of the bodies of a scene with each other, and with themselves.

use impactite_geometry::Facet;
use impactite_scene::{Archive, Boundary, CheckpointError, Clock, ContactPoint, Exchange, PairContact};
use impactite_scene::{LocalDamping, StepError, Stopped};
use impactite_simd::Team;
use mpm_contact::Pairs;
use mpm_contact::mesh::{ContactBody, MeshContact, MeshStep};

use crate::body::ElementBody;
use crate::motion::Motion;

/// Nodes that a task looks at.
const CHUNK: usize = 256;
/// Of the edge of a facet, how far its nodes may be from a plane that it lies on.
const ON_PLANE: f64 = 1e-6;

/// Who may touch whom, and what comes of it.
pub(crate) struct Contacts<const D: usize> {
    mesh: MeshContact<D>,
    /// Of each body.
    surfaces: Vec<ContactSurface<D>>,
    /// Work of friction since the start, J.
    friction: f64,
    last: MeshStep,
}

impl<const D: usize> Contacts<D> {
    pub fn new(laws: Pairs<f64>, axisymmetric: bool) -> Self {
        let mesh = MeshContact::new(laws);
        let mesh = if axisymmetric { mesh.axisymmetric() } else { mesh };
        Contacts { mesh, surfaces: Vec::new(), friction: 0.0, last: MeshStep::default() }
    }

    /// With the bodies that are new in the scene: each touches all others, but bars do not touch bars.
    pub fn with(mut self, bodies: &[ElementBody<D>]) -> Self {
        let is_bars = |n: usize| bodies[n].surface.is_empty();
        for n in self.surfaces.len()..bodies.len() {
            self.surfaces.push(ContactSurface::default());
            let others = (0..n).filter(|&k| !(is_bars(k) && is_bars(n)));
            self.mesh = others.fold(self.mesh, |mesh, k| mesh.between(k, n));
        }
        self
    }

    /// With a body that touches itself.
    pub fn within(mut self, body: usize) -> Self {
        self.mesh = self.mesh.within(body);
        self
    }

    /// Look for the surfaces again: there is another plane of symmetry.
    pub fn forget(&mut self) {
        self.surfaces.iter_mut().for_each(|surface| surface.revision = None);
    }

    /// Impulses on the nodes of bodies that would meet in a step of `dt`, s.
    pub fn meet(
        &mut self,
        bodies: &mut [ElementBody<D>],
        boundaries: &[Boundary<D>],
        (clock, dt): (&Clock, f64),
        team: &Team,
    ) -> Result<(), StepError> {
        bodies.iter_mut().for_each(ElementBody::merge_pushes);
        look(&mut self.surfaces, bodies, boundaries, (clock, dt), team)?;
        let touching: Vec<_> =
            self.surfaces.iter().zip(&*bodies).map(|(surface, body)| surface.as_body(&body.name)).collect();
        let step = self.mesh.step(&touching, clock.time, dt, team);
        self.last = step.map_err(|error| clock.stopped(Stopped::Scene(error)))?;
        self.friction += self.last.exchange.friction;
        for (n, (surface, body)) in self.surfaces.iter().zip(bodies).enumerate() {
            for push in self.mesh.impulses(n) {
                body.touch(surface.nodes[push.point as usize], push.impulse);
            }
        }
        Ok(())
    }

    /// What of the energy of these bodies became heat of friction and was lost in impacts since the start: all that contact took with
    /// one hand and did not give with the other.
    pub fn exchange(&self, bodies: &[ElementBody<D>]) -> Exchange {
        let given: f64 = bodies.iter().map(|body| body.touched().work).sum();
        Exchange { friction: self.friction, impacts: -given - self.friction, ..Exchange::default() }
    }

    pub fn last(&self) -> &MeshStep {
        &self.last
    }
    /// Those that ever touched.
    pub fn pairs(&self) -> Vec<PairContact> {
        let did = |pair: &&PairContact| pair.places > 0 || pair.friction != 0.0 || pair.taken != 0.0;
        self.mesh.pairs().iter().filter(did).copied().collect()
    }
    pub fn places(&self) -> &[ContactPoint] {
        self.mesh.places()
    }
    pub fn bytes(&self) -> usize {
        self.mesh.bytes() + self.surfaces.iter().map(ContactSurface::bytes).sum::<usize>()
    }
    pub fn archive(&mut self, file: &mut Archive) -> Result<(), CheckpointError> {
        file.real(&mut self.friction)?;
        self.mesh.archive(file)
    }
}

/// Look at the surfaces of all bodies.
pub(crate) fn look<const D: usize>(
    surfaces: &mut [ContactSurface<D>],
    bodies: &[ElementBody<D>],
    boundaries: &[Boundary<D>],
    (clock, dt): (&Clock, f64),
    team: &Team,
) -> Result<(), StepError> {
    for (surface, body) in surfaces.iter_mut().zip(bodies) {
        surface.update(body, boundaries);
        let motion = Motion { body, boundaries, time: clock.time, dt, damping: LocalDamping::default() };
        if let Some(node) = surface.look(&motion, team) {
            return Err(body.runs_away(clock, node));
        }
    }
    Ok(())
}

/// The nodes of a body that may touch others in a step that was begun, and the facets they make: [`Fem::surfaces`](crate::Fem::surfaces).
#[derive(Clone, Debug)]
pub struct ContactSurface<const D: usize> {
    /// Of the surface that it is of.
    revision: Option<u64>,
    /// By place on the surface, numbers in the body.
    nodes: Vec<u32>,
    /// Their nodes are places on the surface.
    facets: Vec<Facet>,
    /// Of bars, m.
    half_sizes: Vec<f64>,
    positions: Vec<[f64; D]>,
    velocities: Vec<[f64; D]>,
    masses: Vec<f64>,
}

impl<const D: usize> Default for ContactSurface<D> {
    fn default() -> Self {
        ContactSurface {
            revision: None,
            nodes: Vec::new(),
            facets: Vec::new(),
            half_sizes: Vec::new(),
            positions: Vec::new(),
            velocities: Vec::new(),
            masses: Vec::new(),
        }
    }
}

impl<const D: usize> ContactSurface<D> {
    /// Look for it again where elements left.
    fn update(&mut self, body: &ElementBody<D>, boundaries: &[Boundary<D>]) {
        if self.revision == Some(body.revision) {
            return;
        }
        self.revision = Some(body.revision);
        self.facets = body.facets_to_meet(boundaries);
        let is_of_bars = body.mesh.blocks.iter().all(|block| block.kind.facets().is_empty());
        self.nodes = if is_of_bars {
            let alive =
                body.sets.iter().flat_map(|set| set.alive().map(move |(batch, e, _)| (set, batch, e)));
            alive.flat_map(|(set, batch, e)| set.nodes_of(batch, e)).collect()
        } else {
            self.facets.iter().flat_map(|facet| facet.nodes()).copied().collect()
        };
        self.nodes.sort_unstable();
        self.nodes.dedup();
        let mut places = vec![Facet::NONE; body.nodes.len()];
        for (place, &n) in self.nodes.iter().enumerate() {
            places[n as usize] = place as u32;
        }
        for n in self.facets.iter_mut().flat_map(|facet| &mut facet.nodes).filter(|n| **n != Facet::NONE) {
            *n = places[*n as usize];
        }
        let count = self.nodes.len();
        self.half_sizes = vec![body.half_thickness; if is_of_bars { count } else { 0 }];
        self.positions.resize(count, [0.0; D]);
        self.velocities.resize(count, [0.0; D]);
        self.masses.resize(count, 0.0);
    }

    /// Where its nodes are and how they would move if nobody met, held by conditions; those that these alone move have a mass without
    /// end. The first node whose velocity is not a number.
    fn look(&mut self, motion: &Motion<'_, D>, team: &Team) -> Option<usize> {
        let mut rows: Vec<_> = self
            .positions
            .chunks_mut(CHUNK)
            .zip(self.velocities.chunks_mut(CHUNK).zip(self.masses.chunks_mut(CHUNK)))
            .zip(self.nodes.chunks(CHUNK))
            .map(|of| (of, None))
            .collect();
        team.each(&mut rows, |_, (((positions, (velocities, masses)), nodes), trouble)| {
            for (i, n) in nodes.iter().map(|&n| n as usize).enumerate() {
                let node = &motion.body.nodes[n];
                let (velocity, is_held) = motion.answer(n, node);
                positions[i] = node.position;
                velocities[i] = velocity;
                masses[i] = if is_held { f64::INFINITY } else { node.mass };
                if trouble.is_none() && !velocity.iter().all(|v| v.is_finite()) {
                    *trouble = Some(n);
                }
            }
        });
        rows.iter().find_map(|(_, trouble)| *trouble)
    }

    /// Numbers of its nodes in the body, ascending.
    pub fn nodes(&self) -> &[u32] {
        &self.nodes
    }
    /// Its facets, whose nodes are places among those of the surface; none of bars.
    pub fn facets(&self) -> &[Facet] {
        &self.facets
    }
    /// Positions of the nodes at the start of the step, m.
    pub fn positions(&self) -> &[[f64; D]] {
        &self.positions
    }
    /// Velocities that the nodes will have if nobody meets them, as conditions hold them, m/s.
    pub fn velocities(&self) -> &[[f64; D]] {
        &self.velocities
    }

    /// As contact of meshes sees it: masses of nodes that conditions alone move are infinite.
    pub fn as_body<'a>(&'a self, name: &'a str) -> ContactBody<'a, D> {
        ContactBody::of_mesh(name, &self.positions, &self.velocities, &self.masses, &self.facets)
            .with_half_sizes(&self.half_sizes)
    }

    /// Bytes of its memory.
    pub fn bytes(&self) -> usize {
        self.nodes.capacity() * 4
            + self.facets.capacity() * size_of::<Facet>()
            + (self.half_sizes.capacity() + self.masses.capacity()) * 8
            + (self.positions.capacity() + self.velocities.capacity()) * size_of::<[f64; D]>()
    }
}

impl<const D: usize> ElementBody<D> {
    /// The facets that others may meet under these conditions: not those that lie at rest on planes of symmetry, behind which the body
    /// goes on.
    fn facets_to_meet(&self, boundaries: &[Boundary<D>]) -> Vec<Facet> {
        let rest = &self.mesh.nodes;
        let goes_on = |facet: &Facet| {
            boundaries.iter().any(|boundary| match *boundary {
                Boundary::Symmetry { axis, at, .. } => {
                    let size = edge_of(facet, rest);
                    facet.nodes().iter().all(|&n| (rest[n as usize][axis] - at).abs() < ON_PLANE * size)
                }
                _ => false,
            })
        };
        self.surface.iter().filter(|facet| !goes_on(facet)).copied().collect()
    }
}

/// The longest edge of a facet, m.
fn edge_of<const D: usize>(facet: &Facet, nodes: &[[f64; D]]) -> f64 {
    let corners = facet.nodes();
    let edge = |i: usize| {
        let [a, b] = [corners[i], corners[(i + 1) % corners.len()]].map(|n| nodes[n as usize]);
        (0..D).map(|d| (a[d] - b[d]).powi(2)).sum::<f64>().sqrt()
    };
    (0..corners.len()).map(edge).fold(0.0, f64::max)
}
