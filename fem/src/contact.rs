//! Contact between the bodies of a scene, and self-contact.

use impactite_geometry::Facet;
use impactite_scene::{
    Archive, Boundaries, Boundary, CheckpointError, Clock, ContactPoint, Exchange, PairContact,
};
use impactite_scene::{LocalDamping, StepError, Stopped};
use impactite_simd::Team;
use mpm_contact::Pairs;
use mpm_contact::mesh::{ContactBody, MeshContact, MeshStep};

use crate::body::ElementBody;
use crate::motion::Motion;

/// Number of nodes per task.
const CHUNK: usize = 256;
/// Tolerance for facets on a plane, over the longest edge of the facet.
const ON_PLANE: f64 = 1e-6;

/// Contact of a scene: mesh contact, surfaces and results.
pub(crate) struct Contacts<const D: usize> {
    mesh: MeshContact<D>,
    /// Contact surface of each body.
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

    /// Add the new bodies of the scene: contact with all others, but not between bars.
    pub fn with(mut self, bodies: &[ElementBody<D>]) -> Self {
        let is_bars = |n: usize| bodies[n].surface.is_empty();
        for n in self.surfaces.len()..bodies.len() {
            self.surfaces.push(ContactSurface::default());
            let others = (0..n).filter(|&k| !(is_bars(k) && is_bars(n)));
            self.mesh = others.fold(self.mesh, |mesh, k| mesh.between(k, n));
        }
        self
    }

    /// Enable self-contact of a body.
    pub fn within(mut self, body: usize) -> Self {
        self.mesh = self.mesh.within(body);
        self
    }

    /// Invalidate the surfaces after a new plane of symmetry.
    pub fn forget(&mut self) {
        self.surfaces.iter_mut().for_each(|surface| surface.revision = None);
    }

    /// Apply contact impulses to the nodes of bodies that would penetrate in a step of `dt`, s.
    pub fn meet(
        &mut self,
        bodies: &mut [ElementBody<D>],
        boundaries: &Boundaries<D>,
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

    /// Exchange by contact since the start: heat of friction, and impact losses, which are the rest of the energy that contact removed from
    /// these bodies.
    pub fn exchange(&self, bodies: &[ElementBody<D>]) -> Exchange {
        let given: f64 = bodies.iter().map(|body| body.touched().work).sum();
        Exchange { friction: self.friction, impacts: -given - self.friction, ..Exchange::default() }
    }

    pub fn last(&self) -> &MeshStep {
        &self.last
    }
    /// Pairs that ever were in contact.
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

/// Update the contact surfaces of all bodies.
pub(crate) fn look<const D: usize>(
    surfaces: &mut [ContactSurface<D>],
    bodies: &[ElementBody<D>],
    boundaries: &Boundaries<D>,
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

/// Contact surface of a body in an open step: nodes and facets ([`Fem::surfaces`](crate::Fem::surfaces)).
#[derive(Clone, Debug)]
pub struct ContactSurface<const D: usize> {
    /// Revision of the body surface from which this surface was built.
    revision: Option<u64>,
    /// Node numbers in the body, by index on the surface.
    nodes: Vec<u32>,
    /// Facets, whose nodes are indices on the surface.
    facets: Vec<Facet>,
    /// Half thickness of bars, m.
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
    /// Rebuild the surface if that of the body has changed.
    fn update(&mut self, body: &ElementBody<D>, boundaries: &Boundaries<D>) {
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

    /// Update positions and velocities of the nodes, without contact and with boundary conditions applied; nodes prescribed by conditions
    /// have infinite mass. Returns the first node whose velocity is not finite.
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

    /// Node numbers in the body, ascending.
    pub fn nodes(&self) -> &[u32] {
        &self.nodes
    }
    /// Facets, whose nodes are indices on the surface; none for bars.
    pub fn facets(&self) -> &[Facet] {
        &self.facets
    }
    /// Positions of the nodes at the start of the step, m.
    pub fn positions(&self) -> &[[f64; D]] {
        &self.positions
    }
    /// Velocities of the nodes without contact, with boundary conditions applied, m/s.
    pub fn velocities(&self) -> &[[f64; D]] {
        &self.velocities
    }

    /// View for mesh contact: nodes prescribed by conditions have infinite mass.
    pub fn as_body<'a>(&'a self, name: &'a str) -> ContactBody<'a, D> {
        ContactBody::of_mesh(name, &self.positions, &self.velocities, &self.masses, &self.facets)
            .with_half_sizes(&self.half_sizes)
    }

    /// Memory, bytes.
    pub fn bytes(&self) -> usize {
        self.nodes.capacity() * 4
            + self.facets.capacity() * size_of::<Facet>()
            + (self.half_sizes.capacity() + self.masses.capacity()) * 8
            + (self.positions.capacity() + self.velocities.capacity()) * size_of::<[f64; D]>()
    }
}

impl<const D: usize> ElementBody<D> {
    /// Facets for contact under these conditions: without those on planes of symmetry at rest, behind which the body continues.
    fn facets_to_meet(&self, boundaries: &Boundaries<D>) -> Vec<Facet> {
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

/// Longest edge of a facet, m.
fn edge_of<const D: usize>(facet: &Facet, nodes: &[[f64; D]]) -> f64 {
    let corners = facet.nodes();
    let edge = |i: usize| {
        let [a, b] = [corners[i], corners[(i + 1) % corners.len()]].map(|n| nodes[n as usize]);
        (0..D).map(|d| (a[d] - b[d]).powi(2)).sum::<f64>().sqrt()
    };
    (0..corners.len()).map(edge).fold(0.0, f64::max)
}
