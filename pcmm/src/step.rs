//! Time step: stages in the order of the flow chart of \[Feng2014\].

use impactite_scene::boundary::BodyForce;
use impactite_scene::{Boundaries, Cause, CentreLead, Embedding, Exchange, MovingPoint, PointKind};
use impactite_scene::{Solver, StepError, Stopped};
use mpm_contact::vector::wide;

use crate::elements::{BATCH, Batch, Elements, Incidence};
use crate::kinematics::Dilatation;
use crate::method::Composition;
use crate::particles::Particle;
use crate::solver::Pcmm;
use crate::sweep::{Of, Output, Pass, sweep};
use crate::tessellation::corners;

/// Number of particles moved by a task.
const CHUNK: usize = 512;

/// Results of moving the particles of a chunk.
#[derive(Clone, Copy, Debug, Default)]
struct Moved {
    given: Exchange,
    /// Largest speed over diameter, 1/s.
    rate: f64,
    /// Sums of mass, kg, and momentum, kg m/s.
    moments: [f64; 4],
    trouble: Option<usize>,
}

/// Add mass and momentum of a particle.
fn add_moments<const D: usize>(sums: &mut [f64; 4], p: &Particle<D>) {
    sums[0] += p.mass;
    (0..D).for_each(|d| sums[d + 1] += p.mass * p.velocity[d]);
}

impl<const D: usize, M: Composition<D>> Pcmm<D, M> {
    /// Make one step of size `dt`, s. Forces are those of the elements at the end of the last step: the paper's cycle is entered at its
    /// step 11, and its steps 1 to 10 follow at the new positions.
    pub(crate) fn step(&mut self, dt: f64) -> Result<(), StepError> {
        self.move_particles(dt)?;
        self.finish(dt)
    }

    /// Run steps 1 to 10 at the new positions, and the revision when it is due.
    pub(crate) fn finish(&mut self, dt: f64) -> Result<(), StepError> {
        self.strain_elements(dt)?;
        if (self.clock.steps + 1).is_multiple_of(self.every) {
            self.revise()?;
        }
        self.clock.advance(dt);
        Ok(())
    }

    /// Run step 11: sum of forces at each particle, F/m, velocity update, boundaries, position update.
    fn move_particles(&mut self, dt: f64) -> Result<(), StepError> {
        self.boundaries.advance(self.clock.time, dt);
        self.open_lead();
        let chunks = self.each_particle(dt, |motion, n, p, found| {
            let start = p.velocity;
            motion.accelerate(n, p);
            motion.advance(n, p, &start, found);
        });
        self.take(&chunks, dt)
    }

    /// Register mass and momentum before the first step.
    fn open_lead(&mut self) {
        if self.lead.is_closed() {
            let mut moments = [0.0; 4];
            self.particles.iter().for_each(|p| add_moments(&mut moments, p));
            let [mass, x, y, z] = moments;
            self.lead.open(mass, [x, y, z]);
        }
    }

    /// Run the first half of step 11: velocity update.
    pub(crate) fn accelerate(&mut self, dt: f64) {
        self.boundaries.advance(self.clock.time, dt);
        self.open_lead();
        self.each_particle(dt, |motion, n, p, _| motion.accelerate(n, p));
    }

    /// Run the second half of step 11: boundaries and position update; the velocities before forces acted are `start`.
    pub(crate) fn advance(&mut self, dt: f64, start: &[[f64; D]]) -> Result<(), StepError> {
        let chunks = self.each_particle(dt, |motion, n, p, found| motion.advance(n, p, &start[n], found));
        self.take(&chunks, dt)
    }

    fn each_particle(
        &mut self,
        dt: f64,
        task: impl Fn(&Motion<'_, D>, usize, &mut Particle<D>, &mut Moved) + Sync + Send,
    ) -> Vec<Moved> {
        let motion = Motion {
            incidence: &self.elements.incidence,
            forces: &self.forces,
            boundaries: &self.boundaries,
            acceleration: self.body_force.as_ref().map_or([0.0; D], |f: &BodyForce<D>| f(self.clock.time)),
            surface: self.surface,
            time: self.clock.time,
            dt,
        };
        let mut chunks = vec![Moved::default(); self.particles.len().div_ceil(CHUNK)];
        self.team.each_piece(&mut self.particles, CHUNK, &mut chunks, |chunk, particles, found| {
            for (k, p) in particles.iter_mut().enumerate() {
                task(&motion, chunk * CHUNK + k, p, found);
            }
        });
        chunks
    }

    /// Add the results of moving the particles.
    fn take(&mut self, chunks: &[Moved], dt: f64) -> Result<(), StepError> {
        self.rate = 0.0;
        let mut moments = [0.0; 4];
        for found in chunks {
            (0..4).for_each(|k| moments[k] += found.moments[k]);
            self.exchange.add(&found.given);
            self.rate = self.rate.max(found.rate);
            if let Some(particle) = found.trouble {
                let p = &self.particles[particle];
                let position = wide(&p.position);
                return Err(self.broken(PointKind::Particle, particle, position, Cause::Velocity));
            }
        }
        let force = self.body_force.as_ref().map_or([0.0; D], |force| force(0.0));
        self.lead.step(moments, dt, CentreLead::along(&force, &self.boundaries, M::Embedding::HOOP));
        Ok(())
    }

    /// Run steps 1 to 10: velocity gradient, law, nodal forces.
    fn strain_elements(&mut self, dt: f64) -> Result<(), StepError> {
        if M::Dilatation::AVERAGED {
            self.sweep(Pass::Stretch, dt);
            self.average();
            self.sweep(Pass::Stress, dt);
            self.sound()?;
            self.average();
            self.sweep(Pass::Force, dt);
        } else {
            self.sweep(Pass::Stress, dt);
            self.sound()?;
        }
        self.take_rates();
        Ok(())
    }

    /// Update nodal forces (step 10) from the present states.
    pub(crate) fn forces_of_states(&mut self) {
        if M::Dilatation::AVERAGED {
            self.sweep(Pass::Pressure, 0.0);
            self.average();
        }
        self.sweep(Pass::Force, 0.0);
        self.take_rates();
    }

    fn take_rates(&mut self) {
        for batch in &self.elements.batches {
            self.rate = self.rate.max(batch.report.rate);
        }
    }

    /// Return an error for the first element whose law broke down, if any.
    fn sound(&self) -> Result<(), StepError> {
        for (b, batch) in self.elements.batches.iter().enumerate() {
            if let Some((at, cause)) = batch.report.trouble {
                let element = b * BATCH + at;
                let nodes = &self.elements.nodes[element * (D + 1)..(element + 1) * (D + 1)];
                let x = corners(&self.particles, nodes);
                let mut centre = [0.0; 3];
                for d in 0..D {
                    centre[d] = x[..=D].iter().map(|c| c[d]).sum::<f64>() / (D + 1) as f64;
                }
                return Err(self.broken(PointKind::Element, element, centre, Cause::Law(cause)));
            }
        }
        Ok(())
    }

    /// Return the error that stops the body at one of its points.
    fn broken(&self, kind: PointKind, number: usize, position: [f64; 3], cause: Cause) -> StepError {
        let (body, law) = (self.name.clone(), self.material.name());
        self.clock.stopped(Stopped::Point { kind, body, number, position, law, cause })
    }

    /// Run one pass over all elements.
    fn sweep(&mut self, pass: Pass, dt: f64) {
        let Elements { nodes, reference, batches, numbers, .. } = &mut self.elements;
        let (material, particles, averages) = (&*self.material, &self.particles, &self.averages);
        let (team, waiting, numbers) = (&self.team, &self.waiting[..], *numbers);
        let work = |b: usize, batch: &mut Batch, output: Output<'_, D>| {
            let (first, last) = (b * BATCH, ((b + 1) * BATCH).min(reference.len()));
            let (nodes, reference) = (&nodes[first * (D + 1)..last * (D + 1)], &reference[first..last]);
            let of = Of { particles, nodes, reference, averages, dt };
            let waiting = &mut *team.own(waiting);
            sweep::<D, M>(pass, &of, (material, numbers), batch, waiting, output);
        };
        let scalars = M::Dilatation::AVERAGED && pass != Pass::Force;
        if scalars {
            self.team.each_piece(&mut self.scalars, BATCH, batches, |b, s, batch| {
                work(b, batch, Output::Scalars(s))
            });
        } else {
            self.team.each_piece(&mut self.forces, BATCH * (D + 1), batches, |b, f, batch| {
                work(b, batch, Output::Forces(f));
            });
        }
    }

    /// Average over the elements at each particle, weighted by mass.
    fn average(&mut self) {
        let Elements { incidence, reference, .. } = &self.elements;
        let (scalars, weights) = (&self.scalars, &self.weights);
        self.team.each(&mut self.averages, |n, mean| {
            let mut sum = 0.0;
            for &at in incidence.of(n) {
                let e = at as usize / (D + 1);
                sum += reference[e] * scalars[e];
            }
            *mean = if weights[n] > 0.0 { sum / weights[n] } else { 0.0 };
        });
    }

    /// Size of the next step by the time step control, s.
    pub fn next_time_step(&self) -> f64 {
        self.control.next(self.rate, self.clock.last)
    }

    /// Step until the time `end` (s), which is reached exactly.
    ///
    /// # Errors
    /// Errors of [`Solver::run_until`].
    pub fn run_until(&mut self, end: f64) -> Result<(), StepError> {
        Solver::run_until(self, end)
    }
}

/// Input of the motion of a particle.
struct Motion<'a, const D: usize> {
    incidence: &'a Incidence,
    forces: &'a [[f64; D]],
    boundaries: &'a Boundaries<D>,
    acceleration: [f64; D],
    /// Distance from the outermost centres to the surface, in radii.
    surface: f64,
    time: f64,
    dt: f64,
}

impl<const D: usize> Motion<'_, D> {
    #[inline]
    fn accelerate(&self, n: usize, p: &mut Particle<D>) {
        let mut force = [0.0; D];
        for &at in self.incidence.of(n) {
            let f = &self.forces[at as usize];
            for d in 0..D {
                force[d] += f[d];
            }
        }
        for d in 0..D {
            p.velocity[d] += self.dt * (force[d] / p.mass + self.acceleration[d]);
        }
    }

    /// Return a particle for boundary conditions; its velocity before forces acted is `start`.
    #[inline]
    fn point(&self, p: &Particle<D>, start: &[f64; D]) -> MovingPoint<D> {
        MovingPoint {
            position: p.position,
            mass: p.mass,
            start: *start,
            velocity: p.velocity,
            size: p.radius,
            depth: p.radius * (1.0 + self.surface),
            tolerance: p.radius * (0.5 + self.surface),
        }
    }

    #[inline]
    fn advance(&self, n: usize, p: &mut Particle<D>, start: &[f64; D], found: &mut Moved) {
        if !self.boundaries.is_empty() {
            let mut point = self.point(p, start);
            for boundary in 0..self.boundaries.len() {
                self.boundaries.hold(boundary, &mut point, (self.time, self.dt), &mut found.given);
            }
            p.velocity = point.velocity;
        }
        let mut square = 0.0;
        for d in 0..D {
            let impulse = self.dt * p.mass * self.acceleration[d];
            found.given.load[d] += impulse;
            found.given.work += impulse * 0.5 * (start[d] + p.velocity[d]);
            p.position[d] += self.dt * p.velocity[d];
            square += p.velocity[d] * p.velocity[d];
        }
        add_moments(&mut found.moments, p);
        if !square.is_finite() && found.trouble.is_none() {
            found.trouble = Some(n);
        }
        found.rate = found.rate.max(square.sqrt() / (2.0 * p.radius));
    }
}
