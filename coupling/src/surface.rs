//! Point-to-surface contact of particles with elements.

use fem::Fem;
use impactite_scene::{Body, Solver, Stopped};
use impactite_simd::Team;
use mpm_contact::mesh::{Carriers, ContactBody};
use mpm_core::{NearParticles, SurfaceClient, Taken};

use crate::elements::{Elements, PointToSurface};

/// Number of bits of a label for the number of a particle in its body.
const NUMBERS: u32 = 40;

impl<const D: usize> PointToSurface<D> {
    /// Collect the boxes swept by the facets in a step of `dt`, s.
    pub(crate) fn sweep(&mut self, dt: f64) {
        let boxes = self.surfaces.iter().flat_map(|surface| {
            surface.facets().iter().map(move |facet| {
                let (mut low, mut high) = ([f64::INFINITY; D], [f64::NEG_INFINITY; D]);
                for n in facet.nodes().iter().map(|&n| n as usize) {
                    let (x, v) = (surface.positions()[n], surface.velocities()[n]);
                    for d in 0..D {
                        let end = x[d] + dt * v[d];
                        low[d] = low[d].min(x[d]).min(end);
                        high[d] = high[d].max(x[d]).max(end);
                    }
                }
                (low, high)
            })
        });
        self.swept.fill(boxes);
    }
}

/// Work of impulses on the mean of the velocities before and after the step, J.
fn work<const D: usize>(impulse: &[f64; D], before: &[f64; D], after: &[f64; D]) -> f64 {
    (0..D).map(|d| 0.5 * impulse[d] * (before[d] + after[d])).sum()
}

impl<const D: usize> SurfaceClient<f64, D> for Elements<D> {
    fn reaches(&self, low: &[f64; D], high: &[f64; D]) -> bool {
        self.swept().is_some_and(|boxes| boxes.touches(low, high))
    }

    /// Solve contact in each step of the elements, for all particles and nodes at once; particles move, and push each other, through the
    /// nodes that carry them.
    fn meet(&mut self, particles: &mut NearParticles<D>, _: f64, team: &Team) -> Result<Taken, Stopped> {
        let (mut met, step) = (Met::of(particles), self.step);
        loop {
            let Some((fem, surface)) = self.parts() else { return Ok(Taken::default()) };
            met.step(fem, surface, particles, step, team)?;
            if self.is_last() {
                return Ok(met.taken(particles));
            }
            self.next()?;
        }
    }
}

/// Contact of particles and surfaces in a step of the scene.
struct Met<const D: usize> {
    labels: Vec<u64>,
    /// Present positions of the particles.
    positions: Vec<[f64; D]>,
    /// Impulses on the particles so far, N s.
    impulses: Vec<[f64; D]>,
    friction: f64,
}

impl<const D: usize> Met<D> {
    fn of(particles: &NearParticles<D>) -> Self {
        let label = |(body, number): (&u32, &usize)| (u64::from(*body) << NUMBERS) | *number as u64;
        Met {
            labels: particles.bodies().iter().zip(particles.numbers()).map(label).collect(),
            positions: particles.positions().to_vec(),
            impulses: vec![[0.0; D]; particles.len()],
            friction: 0.0,
        }
    }

    /// Solve contact in an element step of `dt` seconds.
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
        let named = fem.element_bodies().iter().zip(&surface.surfaces);
        let mut bodies: Vec<_> = named.map(|(body, surface)| surface.as_body(body.name())).collect();
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
        for (n, of_body) in surface.surfaces.iter().enumerate() {
            for push in surface.contact.impulses(n) {
                fem.body_mut(n).add_impulse(of_body.nodes()[push.point as usize] as usize, push.impulse);
            }
        }
        Ok(())
    }

    /// Energy taken from the particles: work of the impulses on the mean velocities, so that pressure without motion takes none. The part
    /// transferred to elements is in their balance ([`fem::ElementBody::pushed`]).
    fn taken(&self, particles: &NearParticles<D>) -> Taken {
        let (mut before, mut after) = (Vec::new(), Vec::new());
        particles.velocities_before(&mut before);
        particles.velocities(&mut after);
        let ways = self.impulses.iter().zip(before.iter().zip(&after));
        let given: f64 = ways.map(|(j, (before, after))| work(j, before, after)).sum();
        Taken { friction: self.friction, impacts: -given - self.friction }
    }
}
