//! Deformable bodies in a step of the scene.

use impactite_geometry::{Bounds, Cuboid};
use impactite_scene::{Archive, CheckpointError, SceneError, StepError, Stopped};

use super::loads::Wetted;
use super::newton::Newton;
use super::{Deformable, NodeImpulse, Solids};
use crate::blocks::Blocks;
use crate::error::FluidError;
use crate::solver::Flow;
use crate::surface::AIR;
use crate::view::wide;
use crate::wall::{Wall, Walls};

/// Largest number of iterations of a step.
const ITERATIONS: usize = 60;
/// Residual of the velocities, over their own magnitude, at which the iteration ends.
const RELATIVE: f64 = 1e-5;
/// Residual over the speed of the liquid, at which the iteration ends.
const ABSOLUTE: f64 = 1e-7;
/// Share of the surfaces' motion from the middle of a step to its end that goes straight on from that between the middles; the rest keeps the
/// mean of the places at the start and at the end in the middle.
const STRAIGHT: f64 = 0.9;
/// Speed of surfaces, over that of the liquid, and over that of a wave of one cell, below which a step does not resolve their vibration.
const SLOW: f64 = 0.2;
const AT_REST: f64 = 0.01;
/// Distance, in cells, of air from cells whose liquid may part from a surface.
const THIN: usize = 3;
/// Depth in a wall, in cells, at which a body has run into it.
const WITHIN: f64 = 0.5;
/// Name of the solve in messages.
const MOTION: &str = "the motion of the deformable bodies";

/// Mean velocity of a surface in a step of `dt` seconds, m/s: its place at the start, and places of the body in the middles of the last step and
/// of this one, `kick` seconds apart.
fn mean_velocity([start, before, now]: [f64; 3], dt: f64, kick: f64) -> f64 {
    let on = (1.0 - STRAIGHT) * (now - start) + STRAIGHT * (0.5 * dt / kick) * (now - before);
    (now + on - start) / dt
}

impl<const D: usize> Flow<D> {
    /// Add deformable bodies that the liquid moves, all of a scene at once. The liquid slips along them and has to be outside of them at the
    /// start.
    ///
    /// # Errors
    /// Bodies that are there already; rigid bodies that the liquid moves, or periods, beside them; a name that is in use; a surface that is not
    /// closed; a body thinner than a cell.
    pub fn add_deformable(&mut self, bodies: impl Deformable<D> + 'static) -> Result<(), FluidError> {
        let refuse = |what: &str, why| {
            Err(FluidError::Scene(SceneError::NotWith {
                what: what.into(),
                method: impactite_scene::Solver::method(self),
                why,
            }))
        };
        if self.solids.is_some() {
            return refuse("a second solver of deformable bodies", "one has all bodies of a scene");
        }
        if !self.rigid.is_empty() {
            return refuse(
                "deformable bodies beside rigid bodies that the liquid moves",
                "nothing finds the contact between them; make the stiff body deformable, or prescribe its motion",
            );
        }
        if self.options.period.iter().any(|p| *p > 0) {
            return refuse("deformable bodies in a periodic scene", "take planes instead of the period");
        }
        for body in bodies.solver().bodies() {
            self.check_name(body.name())?;
        }
        let solids = Solids::new(Box::new(bodies), self.frame.h).map_err(|body| SceneError::NotWith {
            what: format!("the deformable body `{body}`, whose surface is not closed"),
            method: impactite_scene::Solver::method(self),
            why: "liquid is outside of closed surfaces; bars have none",
        })?;
        let h = self.frame.h;
        for (k, (skin, _)) in solids.skins.iter().enumerate() {
            for facet in 0..skin.facets() {
                let (centre, normal) = skin.facet(facet);
                let within: [f64; D] = std::array::from_fn(|d| centre[d] - h * normal[d]);
                if skin.nearest(&within).gap >= 0.0 {
                    let name = solids.of.solver().bodies()[k].name().to_owned();
                    return Err(FluidError::Scene(SceneError::NotWith {
                        what: format!(
                            "the deformable body `{name}`, thinner than the cells of {h} m near {centre:?} m"
                        ),
                        method: impactite_scene::Solver::method(self),
                        why: "the pressures at both of its sides would mix; take smaller cells, or a thicker body",
                    }));
                }
            }
            let bounds = Bounds::around(skin.places().iter().copied());
            let mut wall = Wall::solid(Cuboid::new(bounds.min, bounds.max)?);
            wall.solid = Some(k);
            self.add_wall(wall)?;
        }
        self.speed = self.speed.max(solids.speed());
        self.solids = Some(Box::new(solids));
        self.watcher.reopen();
        Ok(())
    }

    /// Deformable bodies; none without them.
    pub fn deformable(&self) -> Option<&dyn Deformable<D>> {
        self.solids.as_ref().map(|solids| &*solids.of)
    }

    /// Iterations of the last step between the liquid and the deformable bodies.
    pub fn coupling_iterations(&self) -> usize {
        self.solids.as_ref().map_or(0, |solids| solids.iterations)
    }

    /// True if the liquid moves bodies.
    pub(crate) fn moves_bodies(&self) -> bool {
        !self.rigid.is_empty() || self.solids.is_some()
    }

    /// Solve for the pressure together with the deformable bodies, which are at the end of the step after it.
    pub(crate) fn project_with_solids(
        &mut self,
        dt: f64,
        kick: f64,
        walls: &mut Walls<'_, D>,
    ) -> Result<(), StepError> {
        let Some(mut solids) = self.solids.take() else { return self.project() };
        let solved = self.iterate(&mut solids, (dt, kick), walls);
        self.solids = Some(solids);
        solved
    }

    fn iterate(
        &mut self,
        solids: &mut Solids<D>,
        (dt, kick): (f64, f64),
        walls: &mut Walls<'_, D>,
    ) -> Result<(), StepError> {
        let before = self.grid.velocity.clone();
        let unit = self.unit();
        let gravity = self.force(self.clock.time).iter().map(|g| g * g).sum::<f64>().sqrt();
        let floor = ABSOLUTE * self.speed.max(0.1 * gravity * dt);
        let ahead = if solids.steps[1] > 0.0 { dt / solids.steps[0] } else { 0.0 };
        let mut iterate: Vec<[f64; D]> = solids
            .velocities
            .iter()
            .zip(&solids.before)
            .map(|(v, old)| std::array::from_fn(|d| v[d] + ahead * (v[d] - old[d])))
            .collect();
        let mut newton = Newton::default();
        self.release(solids, &iterate, walls)?;
        let unsaved = |flow: &Self, error: &CheckpointError| {
            flow.clock.stopped(Stopped::Solve { what: MOTION, why: error.to_string() })
        };
        // The state in the middle of the last step; at first that of the start.
        let mut from = match solids.middle.take() {
            Some(middle) => middle,
            None => solids.save().map_err(|e| unsaved(self, &e))?,
        };
        for n in 1..=ITERATIONS {
            solids.iterations = n;
            solids.wetted.sweep(&iterate, &mut self.swept);
            self.grid.velocity.clone_from(&before);
            self.project()?;
            let mut given = solids.carry.clone();
            let change = (&solids.velocities[..], &iterate[..]);
            solids.wetted.add((&self.grid, unit), change, false, &mut given);
            from = solids.load(from).map_err(|e| unsaved(self, &e))?;
            solids.run(kick, &given, 1.0)?;
            let middles = solids.nodes_now();
            let answer: Vec<[f64; D]> = (0..middles.len())
                .map(|n| {
                    let (now, before, start) = (&middles[n], &solids.middles[n], &solids.places[n]);
                    std::array::from_fn(|d| mean_velocity([start[d], before[d], now[d]], dt, kick))
                })
                .collect();
            let mean = |list: &mut dyn Iterator<Item = f64>| (list.sum::<f64>() / answer.len() as f64).sqrt();
            let square = |v: &[f64; D]| v.iter().map(|v| v * v).sum::<f64>();
            let off = |(a, w): (&[f64; D], &[f64; D])| (0..D).map(|d| (a[d] - w[d]).powi(2)).sum::<f64>();
            let residual = mean(&mut answer.iter().zip(&iterate).map(off));
            let size = mean(&mut answer.iter().map(square));
            if !residual.is_finite() {
                let why = "a velocity is not finite".to_string();
                return Err(self.clock.stopped(Stopped::Solve { what: MOTION, why }));
            }
            if residual <= floor.max(RELATIVE * size) {
                walls.velocities.clone_from(&iterate);
                for (x, v) in solids.places.iter_mut().zip(&answer) {
                    (0..D).for_each(|d| x[d] += v[d] * dt);
                }
                solids.middle = Some(solids.save().map_err(|e| unsaved(self, &e))?);
                solids.run(0.5 * dt, &given, 0.5 * dt / kick)?;
                (solids.given, solids.middles) = (given, middles);
                let floor = (SLOW * self.speed).max(AT_REST * (gravity * self.frame.h).sqrt());
                solids.note(answer, dt, floor);
                return self.check_solids(solids, dt, walls);
            }
            if n < ITERATIONS {
                let next = newton.next(iterate.as_flattened(), answer.as_flattened());
                for (w, x) in iterate.iter_mut().zip(next.chunks(D)) {
                    w.copy_from_slice(x);
                }
            } else {
                let why = format!(
                    "the velocities of liquid and bodies differ by {residual:.2e} m/s after {ITERATIONS} iterations, with {size:.2e} m/s of the bodies; take a smaller `factor` of the time step, or, where the bodies close a region full of liquid, leave it an opening"
                );
                return Err(self.clock.stopped(Stopped::Solve { what: MOTION, why }));
            }
        }
        Ok(())
    }

    /// Let liquid part from the surfaces: cells beside them and near air, which the velocities `iterate` would hold by tension, get the pressure
    /// of air in this step. Else jets that pass a corner are sucked along it.
    fn release(
        &mut self,
        solids: &mut Solids<D>,
        iterate: &[[f64; D]],
        walls: &Walls<'_, D>,
    ) -> Result<(), StepError> {
        let near_air = |kind: &[u8], slot: usize| {
            (0..D).flat_map(|d| [(d, false), (d, true)]).any(|(d, up)| {
                let mut at = slot;
                (0..THIN).any(|_| {
                    let next =
                        self.grid.blocks.beside(at / Blocks::<D>::CELLS, at % Blocks::<D>::CELLS, d, up);
                    at = next.unwrap_or(at);
                    next.is_some_and(|next| kind[next] == AIR)
                })
            })
        };
        let thin: Vec<usize> =
            solids.wetted.hosts().filter(|cell| near_air(&self.grid.surface.kind, *cell)).collect();
        if thin.is_empty() {
            return Ok(());
        }
        let before = self.grid.velocity.clone();
        solids.wetted.sweep(iterate, &mut self.swept);
        self.project()?;
        self.grid.velocity = before;
        let mut released = false;
        for cell in thin {
            if self.grid.pressure[cell] < 0.0 {
                self.grid.surface.kind[cell] = AIR;
                released = true;
            }
        }
        if released {
            self.mark_faces();
            self.assemble()?;
            solids.wetted = Wetted::new(&self.grid, &self.frame, walls);
        }
        Ok(())
    }

    /// Check that no node of a surface has moved too far, or into a wall.
    fn check_solids(&self, solids: &Solids<D>, dt: f64, walls: &Walls<'_, D>) -> Result<(), StepError> {
        let h = self.frame.h;
        let name = |n: usize| solids.of.solver().bodies()[solids.nodes[n].0 as usize].name().to_owned();
        for (n, (x, v)) in solids.places.iter().zip(&solids.velocities).enumerate() {
            let speed = v.iter().map(|v| v * v).sum::<f64>().sqrt();
            let body = solids.nodes[n].0 as usize;
            let within = |w: &usize| {
                walls.list[*w].solid != Some(body)
                    && !walls.list[*w].follows()
                    && walls.gap_of(*w, x) < -WITHIN * h
            };
            if speed * dt > h {
                let why = format!(
                    "node {} of body `{}` moves more than a cell in the step",
                    solids.nodes[n].1,
                    name(n)
                );
                return Err(self.clock.stopped(Stopped::Solve { what: MOTION, why }));
            }
            if (0..walls.list.len()).any(|w| within(&w)) {
                return Err(self.clock.stopped(Stopped::Scene(SceneError::NotWith {
                    what: format!("the deformable body `{}` in a wall near {:?} m", name(n), wide(x)),
                    method: impactite_scene::Solver::method(self),
                    why: "nothing finds the contact of deformable bodies with prescribed ones; planes `wall` hold them",
                })));
            }
        }
        Ok(())
    }

    /// Book the impulses of the liquid, and place the surfaces at the end of the step.
    pub(crate) fn settle_solids(&mut self, walls: &Walls<'_, D>) -> Result<(), StepError> {
        let unit = self.unit();
        let Some(solids) = &mut self.solids else { return Ok(()) };
        let mut all = vec![[0.0; D]; solids.nodes.len()];
        let change = (&solids.before[..], &solids.velocities[..]);
        solids.wetted.add((&self.grid, unit), change, true, &mut all);
        solids.skins = solids.moved(walls.skins.to_vec());
        solids.passed = [0.0; D];
        for ((carry, all), given) in solids.carry.iter_mut().zip(&all).zip(&solids.given) {
            for d in 0..D {
                carry[d] += all[d] - given[d];
                solids.taken[d] += all[d];
                solids.passed[d] += all[d];
            }
        }
        if solids.of.surface_revision() != solids.revision {
            return Err(self.clock.stopped(Stopped::Scene(SceneError::NotWith {
                what: "elements that erode from a deformable body".into(),
                method: impactite_scene::Solver::method(self),
                why: "the liquid needs surfaces that stay; take a law without failure, or another method",
            })));
        }
        Ok(())
    }
}

impl<const D: usize> Solids<D> {
    /// Places of all nodes for the liquid in the state that the bodies have now, m.
    pub fn nodes_now(&self) -> Vec<[f64; D]> {
        let ways = self.nodes.iter().zip(&self.rest).map(|((body, node), rest)| {
            let place = self.of.node(*body, *node).0;
            std::array::from_fn(|d| place[d] - rest[d])
        });
        let mut places = self.smoothing.average(&ways.collect::<Vec<_>>());
        for (x, rest) in places.iter_mut().zip(&self.rest) {
            (0..D).for_each(|d| x[d] += rest[d]);
        }
        places
    }

    /// Save the state of the bodies in memory.
    pub fn save(&mut self) -> Result<Archive, CheckpointError> {
        let mut state = Archive::in_memory();
        self.of.archive(&mut state)?;
        Ok(state)
    }
    /// Restore the state of the bodies, and return it.
    pub fn load(&mut self, state: Archive) -> Result<Archive, CheckpointError> {
        let mut state = state.again();
        self.of.archive(&mut state)?;
        Ok(state)
    }

    /// Run the bodies under a share of these impulses on the nodes.
    fn run(&mut self, dt: f64, given: &[[f64; D]], share: f64) -> Result<(), StepError> {
        let list: Vec<_> = self
            .nodes
            .iter()
            .zip(self.smoothing.spread(given))
            .map(|((body, node), impulse)| NodeImpulse {
                body: *body,
                node: *node,
                impulse: impulse.map(|x| share * x),
            })
            .collect();
        self.of.run_for(dt, &list)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Oscillator of unit mass with the phase `theta`, rad, in a step of unit length, beside liquid of the mass `liquid`: place at the end of each
    /// step, from the velocity 1.
    fn oscillate(theta: f64, liquid: f64, steps: usize) -> Vec<f64> {
        let (sin, cos) = theta.sin_cos();
        let run = |x: f64, v: f64, force: f64| {
            let from = force / (theta * theta);
            ((x - from) * cos + v / theta * sin + from, v * cos - (x - from) * theta * sin)
        };
        let (mut x, mut v, mut place, mut last) = (0.0, 1.0, 0.0, 1.0);
        let mut places = Vec::new();
        for _ in 0..steps {
            let answer = |force: f64| mean_velocity([place, x, run(x, v, force).0], 1.0, 1.0);
            // The force -liquid (W - W') of the mean velocity W, which is linear in it.
            let (rest, slope) = (answer(0.0), answer(1.0) - answer(0.0));
            let force = -liquid * (rest - last) / (1.0 + liquid * slope);
            let velocity = rest + slope * force;
            (x, v) = run(x, v, force);
            (place, last) = (place + velocity, velocity);
            places.push(place);
        }
        places
    }

    #[test]
    fn oscillators_are_stable_with_any_mass_of_liquid() {
        for liquid in [0.01, 0.1, 1.0, 5.0, 30.0, 100.0] {
            for n in 1..200 {
                // Long enough for the beats of modes near a whole number of periods a step.
                let places = oscillate(0.07 * f64::from(n), liquid, 20_000);
                let largest = |part: &[f64]| part.iter().fold(0.0f64, |most, x| most.max(x.abs()));
                let (first, last) = (largest(&places[..10_000]), largest(&places[10_000..]));
                assert!(last <= 1.001 * first, "{n} {liquid}: {first} {last}");
            }
        }
    }

    #[test]
    fn an_oscillator_of_20_steps_a_period_keeps_its_amplitude() {
        for liquid in [0.1f64, 1.0, 10.0] {
            // The frequency with the liquid.
            let theta = 0.1 * std::f64::consts::PI * (1.0 + liquid).sqrt();
            let places = oscillate(theta, liquid, 200);
            let exact = 1.0 / (0.1 * std::f64::consts::PI);
            let last = places[180..].iter().fold(0.0f64, |most, x| most.max(x.abs()));
            assert!((last / exact - 1.0).abs() < 0.2, "{liquid}: {last} of {exact}");
        }
    }
}
