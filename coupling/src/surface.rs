//! Particles against the surfaces of elements.

use fem::Fem;
use impactite_scene::{Body, Solver, Stopped};
use impactite_simd::Team;
use mpm_contact::mesh::{Carriers, ContactBody};
use mpm_core::{NearParticles, SurfaceClient, Taken};

use crate::elements::{Elements, PointToSurface};

/// Bits of a label that are the number of a particle in its body.
const NUMBERS: u32 = 40;

impl<const D: usize> PointToSurface<D> {
    /// Mark where the facets are in a step of `dt`, s.
    pub(crate) fn sweep(&mut self, fem: &Fem<D>, dt: f64) {
        self.find_facets(fem);
        let boxes = fem.element_bodies().iter().zip(&self.facets).flat_map(|(body, (_, facets))| {
            let nodes = body.nodes();
            facets.iter().map(move |facet| {
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
            })
        });
        self.swept.fill(boxes);
    }

    /// The facets that particles may meet.
    fn find_facets(&mut self, fem: &Fem<D>) {
        self.facets.resize(fem.element_bodies().len(), (None, Vec::new()));
        for (body, (revision, facets)) in fem.element_bodies().iter().zip(&mut self.facets) {
            if *revision == Some(body.surface_revision()) {
                continue;
            }
            *revision = Some(body.surface_revision());
            *facets = body.facets_to_meet(fem.boundaries());
        }
    }
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
        self.swept().is_some_and(|boxes| boxes.touches(low, high))
    }

    /// In each step of the elements: all particles and nodes at once, particles as the nodes that carry them move and push each other.
    fn meet(&mut self, particles: &mut NearParticles<D>, dt: f64, team: &Team) -> Result<Taken, Stopped> {
        let (mut met, step) = (Met::of(particles), dt / f64::from(self.steps));
        loop {
            let Some((fem, surface)) = self.parts() else { return Ok(Taken::default()) };
            met.step(fem, surface, particles, step, team)?;
            if self.made + 1 == self.steps {
                return Ok(met.taken(particles));
            }
            self.next()?;
        }
    }
}

/// What particles and surfaces do to each other in a step of the scene.
struct Met<const D: usize> {
    labels: Vec<u64>,
    /// Of the particles, now.
    positions: Vec<[f64; D]>,
    /// On the particles so far, N s.
    impulses: Vec<[f64; D]>,
    friction: f64,
    /// Work on the nodes of the elements so far, J.
    work: f64,
}

impl<const D: usize> Met<D> {
    fn of(particles: &NearParticles<D>) -> Self {
        let label = |(body, number): (&u32, &usize)| (u64::from(*body) << NUMBERS) | *number as u64;
        Met {
            labels: particles.bodies().iter().zip(particles.numbers()).map(label).collect(),
            positions: particles.positions().to_vec(),
            impulses: vec![[0.0; D]; particles.len()],
            friction: 0.0,
            work: 0.0,
        }
    }

    /// A step of the elements of `dt` seconds.
    fn step(
        &mut self,
        fem: &mut Fem<D>,
        surface: &mut PointToSurface<D>,
        particles: &mut NearParticles<D>,
        dt: f64,
        team: &Team,
    ) -> Result<(), Stopped> {
        let (mut velocities, mut masses, mut moving) = (Vec::new(), Vec::new(), Vec::new());
        particles.nodes(&mut velocities, &mut masses);
        particles.velocities(&mut moving);
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
        let carriers = Carriers {
            starts: particles.weight_starts(),
            weights: particles.node_weights(),
            velocities: &velocities,
            masses: &masses,
        };
        let half_sizes = particles.half_sizes();
        let carried =
            ContactBody::of_carried_points("particles", &self.positions, &moving, half_sizes, carriers);
        bodies.push(carried.with_labels(&self.labels));
        let time = Solver::clock(fem).time;
        let step = surface.contact.step(&bodies, time, dt, team).map_err(Stopped::Scene)?;
        self.friction += step.exchange.friction;

        let mut impulses = vec![[0.0; D]; particles.len()];
        for push in surface.contact.impulses(points) {
            let n = push.point as usize;
            impulses[n] = push.impulse;
            (0..D).for_each(|d| self.impulses[n][d] += push.impulse[d]);
        }
        particles.push(&impulses);
        particles.velocities(&mut moving);
        for (x, v) in self.positions.iter_mut().zip(&moving) {
            (0..D).for_each(|d| x[d] += dt * v[d]);
        }
        for n in 0..points {
            let body = fem.body_mut(n);
            for push in surface.contact.impulses(n) {
                body.add_impulse(push.point as usize, push.impulse);
            }
            for push in surface.contact.impulses(n) {
                let node = push.point as usize;
                self.work += work(&push.impulse, &surface.before[n][node], &body.nodes()[node].velocity);
            }
        }
        Ok(())
    }

    /// What impulses do in a step is their work on the mean velocities: what presses without moving takes nothing.
    fn taken(&self, particles: &NearParticles<D>) -> Taken {
        let (mut before, mut after) = (Vec::new(), Vec::new());
        particles.velocities_before(&mut before);
        particles.velocities(&mut after);
        let ways = self.impulses.iter().zip(before.iter().zip(&after));
        let given: f64 = ways.map(|(j, (before, after))| work(j, before, after)).sum();
        Taken { friction: self.friction, impacts: -given - self.work - self.friction }
    }
}
