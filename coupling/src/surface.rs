//! Particles against the surfaces of elements.

use fem::Fem;
use impactite_geometry::Facet;
use impactite_scene::{Body, Boundary, Solver, Stopped};
use impactite_simd::Team;
use mpm_contact::mesh::ContactBody;
use mpm_core::{NearParticles, SurfaceClient, Taken};

use crate::elements::{Elements, PointToSurface};

/// Of the edge of a facet, how far its nodes may be from a plane that it lies on.
const ON_PLANE: f64 = 1e-6;
/// Most rounds of a step.
const ROUNDS: u32 = 12;
/// Part of the largest change of a velocity in the first round below which what is left is none.
const ENOUGH: f64 = 1e-2;

impl<const D: usize> PointToSurface<D> {
    /// Mark where the facets are in a step of `dt`, s.
    pub(crate) fn sweep(&mut self, fem: &Fem<D>, dt: f64) {
        self.boxes.clear();
        self.find_facets(fem);
        for (body, facets) in fem.element_bodies().iter().zip(&self.facets) {
            let nodes = body.nodes();
            self.boxes.extend(facets.1.iter().map(|facet| {
                let (mut low, mut high) = ([f64::INFINITY; D], [f64::NEG_INFINITY; D]);
                for &n in facet.nodes() {
                    let node = &nodes[n as usize];
                    for d in 0..D {
                        let end = node.position[d] + dt * node.velocity[d];
                        low[d] = low[d].min(node.position[d]).min(end);
                        high[d] = high[d].max(node.position[d]).max(end);
                    }
                }
                (low, high)
            }));
        }
        self.cells.mark(&self.boxes);
    }

    /// The facets that others may meet: not those on planes of symmetry, behind which the body goes on.
    fn find_facets(&mut self, fem: &Fem<D>) {
        self.facets.resize(fem.element_bodies().len(), (None, Vec::new()));
        for (body, (revision, facets)) in fem.element_bodies().iter().zip(&mut self.facets) {
            if *revision == Some(body.surface_revision()) {
                continue;
            }
            *revision = Some(body.surface_revision());
            let rest = &body.mesh().nodes;
            let inside = |facet: &&Facet| {
                !fem.boundaries().iter().any(|boundary| match *boundary {
                    Boundary::Symmetry { axis, at, .. } => {
                        let size = edge_of(facet, rest);
                        facet.nodes().iter().all(|&n| (rest[n as usize][axis] - at).abs() < ON_PLANE * size)
                    }
                    _ => false,
                })
            };
            facets.clear();
            facets.extend(body.surface().iter().filter(inside));
        }
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

/// Positions, velocities and masses of the nodes of a body.
struct Mesh<const D: usize> {
    positions: Vec<[f64; D]>,
    velocities: Vec<[f64; D]>,
    masses: Vec<f64>,
}

impl<const D: usize> Mesh<D> {
    fn of(body: &fem::ElementBody<D>) -> Self {
        let nodes = body.nodes();
        Mesh {
            positions: nodes.iter().map(|n| n.position).collect(),
            velocities: nodes.iter().map(|n| n.velocity).collect(),
            masses: nodes.iter().map(|n| n.mass).collect(),
        }
    }
}

/// Impulses times the mean of velocities before and after the step, J.
fn work<const D: usize>(impulse: &[f64; D], before: &[f64; D], after: &[f64; D]) -> f64 {
    (0..D).map(|d| 0.5 * impulse[d] * (before[d] + after[d])).sum()
}

impl<const D: usize> SurfaceClient<f64, D> for Elements<D> {
    fn reaches(&self, low: &[f64; D], high: &[f64; D]) -> bool {
        self.swept().is_some_and(|cells| cells.touches(low, high))
    }

    /// In rounds: contact finds impulses on all particles at once, which yield to each other's by the nodes they share
    /// ([`NearParticles::masses`]); a round leaves a part of what closes to the next one.
    fn meet(&mut self, particles: &mut NearParticles<D>, dt: f64, team: &Team) -> Result<Taken, Stopped> {
        let Some((fem, surface)) = self.parts() else { return Ok(Taken::default()) };
        let count = particles.len();
        let (mut velocities, mut masses, mut impulses) = (Vec::new(), Vec::new(), vec![[0.0; D]; count]);
        let mut sums = vec![[0.0; D]; count];
        let mut pushes: Vec<Vec<(usize, [f64; D])>> = vec![Vec::new(); fem.element_bodies().len()];
        let (mut marked, mut first, mut friction) = (vec![false; count], 0.0f64, 0.0);
        let time = Solver::clock(fem).time;
        for _ in 0..ROUNDS {
            particles.velocities(&mut velocities);
            particles.masses(&marked, &mut masses);
            let meshes: Vec<Mesh<D>> = fem.element_bodies().iter().map(Mesh::of).collect();
            let mut bodies: Vec<ContactBody<'_, D>> = fem
                .element_bodies()
                .iter()
                .zip(meshes.iter().zip(&surface.facets))
                .map(|(body, (m, facets))| {
                    ContactBody::of_mesh(body.name(), &m.positions, &m.velocities, &m.masses, &facets.1)
                })
                .collect();
            let points = bodies.len();
            bodies.push(ContactBody::of_points(
                "particles",
                particles.positions(),
                &velocities,
                &masses,
                particles.half_sizes(),
            ));
            let step = surface.contact.step(&bodies, time, dt, team).map_err(Stopped::Scene)?;
            let (mut fastest, mut more) = (0.0f64, false);
            impulses.fill([0.0; D]);
            for push in surface.contact.impulses(points) {
                let n = push.point as usize;
                impulses[n] = push.impulse;
                more |= !std::mem::replace(&mut marked[n], true);
                let speed = push.impulse.iter().map(|j| (j / masses[n]).powi(2)).sum::<f64>().sqrt();
                fastest = fastest.max(speed);
            }
            if fastest == 0.0 {
                break;
            }
            first = first.max(fastest);
            if more {
                // There are more that touch: what all yield to each other is known from the next round on.
                continue;
            }
            friction += step.exchange.friction;
            particles.push(&impulses);
            for (sum, impulse) in sums.iter_mut().zip(&impulses) {
                (0..D).for_each(|d| sum[d] += impulse[d]);
            }
            for n in 0..points {
                let body = fem.body_mut(n);
                for push in surface.contact.impulses(n) {
                    body.add_impulse(push.point as usize, push.impulse);
                    pushes[n].push((push.point as usize, push.impulse));
                }
            }
            if fastest < ENOUGH * first {
                break;
            }
        }
        // What impulses do in a step is their work on the mean velocities: what presses without moving takes nothing.
        particles.velocities(&mut velocities);
        let mut before = Vec::new();
        particles.velocities_before(&mut before);
        let ways = sums.iter().zip(before.iter().zip(&velocities));
        let mut given: f64 = ways.map(|(j, (before, after))| work(j, before, after)).sum();
        for ((body, before), pushes) in fem.element_bodies().iter().zip(&surface.before).zip(&pushes) {
            given +=
                pushes.iter().map(|(n, j)| work(j, &before[*n], &body.nodes()[*n].velocity)).sum::<f64>();
        }
        Ok(Taken { friction, impacts: -given - friction })
    }
}
