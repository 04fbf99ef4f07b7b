//! Free rigid bodies in a step of the scene.

use impactite_scene::{Cause, PointKind, SceneError, StepError, Stopped};

use crate::blocks::Blocks;
use crate::contact::{resolve, supports};
use crate::couple::{Coupling, Support, Surroundings, product};
use crate::deformable::loads::Wetted;
use crate::error::FluidError;
use crate::extrapolate::FREE;
use crate::rigid::{Floater, RigidBody, Twist};
use crate::solver::{Flow, add_to};
use crate::transfer::face_centre;
use crate::view::wide;
use crate::wall::{Wall, Walls};

/// Distance from two walls, in cells, between which liquid at closed faces is held.
const NARROW: f64 = 0.75;

impl<const D: usize> Flow<D> {
    /// Add a rigid body that the liquid moves, and return its number among the rigid bodies. The liquid has to be outside of it at the
    /// start.
    ///
    /// # Errors
    /// A name that is empty or in use; a body that does not contain a point, at half a cell's spacing; velocities that are not finite; a
    /// periodic scene.
    pub fn add_rigid(&mut self, name: impl Into<String>, body: RigidBody<D>) -> Result<usize, FluidError> {
        let name = name.into();
        self.check_name(&name)?;
        if self.solids.is_some() {
            return Err(FluidError::Scene(SceneError::NotWith {
                what: format!("the rigid body `{name}` beside deformable bodies"),
                method: impactite_scene::Solver::method(self),
                why: "nothing finds the contact between them; make the stiff body deformable, or prescribe its motion",
            }));
        }
        if self.options.period.iter().any(|p| *p > 0) {
            return Err(FluidError::Scene(SceneError::NotWith {
                what: format!("the rigid body `{name}` in a periodic scene"),
                method: impactite_scene::Solver::method(self),
                why: "no image of a rigid body that the liquid moves is made; take planes instead of the period",
            }));
        }
        let mut surface = Wall::solid(body.shape.clone());
        surface.body = Some(self.rigid.len());
        let mut body = Floater::new(name, body, &self.options.lattice)?;
        body.force = self.force(self.clock.time);
        body.lag = self.lag;
        self.speed = self.speed.max(body.speed());
        self.add_wall(surface)?;
        self.rigid.push(body);
        self.watcher.reopen();
        Ok(self.rigid.len() - 1)
    }

    /// Place of the centre of mass of a rigid body, m; none for a number that is not of one.
    pub fn rigid_centre(&self, number: usize) -> Option<[f64; D]> {
        self.rigid.get(number).map(|body| body.centre)
    }
    /// Velocity of the centre of mass, m/s, and angular velocity, rad/s, of a rigid body, in the middle of the last step.
    pub fn rigid_velocity(&self, number: usize) -> Option<([f64; D], [f64; 3])> {
        self.rigid.get(number).map(|body| (body.motion().velocity, body.motion().spin))
    }

    /// Mass of a cell full of liquid, kg.
    pub(crate) fn unit(&self) -> f64 {
        self.fluid.map_or(0.0, |fluid| fluid.density) * self.frame.h.powi(D as i32)
    }

    /// Find the cells and faces near the bodies that the liquid moves.
    pub(crate) fn surround_bodies(&mut self, walls: &Walls<'_, D>) {
        let around = |body| Surroundings::new((&self.grid, &self.frame), walls, body);
        self.around = self.rigid.iter().enumerate().map(around).collect();
        if let Some(solids) = &mut self.solids {
            solids.wetted = Wetted::new(&self.grid, &self.frame, walls);
            solids.wetted.sweep(&solids.velocities, &mut self.swept);
        }
    }

    /// Subtract the net outflow of cells by the motion of the bodies that the liquid moves.
    pub(crate) fn subtract_bodies(&self, right: &mut [f64]) {
        for (body, around) in self.rigid.iter().zip(&self.around) {
            around.subtract_outflow(&body.twist, right);
        }
        self.swept.iter().for_each(|(cell, by)| right[*cell as usize] -= by);
    }

    /// Solve for the pressure together with the velocities of the rigid bodies, and the contacts with walls that hold them: contacts that
    /// would pull are released.
    pub(crate) fn project_with_bodies(
        &mut self,
        dt: f64,
        kick: f64,
        walls: &mut Walls<'_, D>,
    ) -> Result<(), StepError> {
        if self.solids.is_some() {
            return self.project_with_solids(dt, kick, walls);
        }
        if self.rigid.is_empty() {
            return self.project();
        }
        let (unit, h) = (self.unit(), self.frame.h);
        self.rigid.iter_mut().for_each(|body| body.start = body.twist);
        let mut held: Vec<_> = self.rigid.iter().map(|body| supports(body, walls, (dt, kick), h)).collect();
        let before = self.grid.velocity.clone();
        loop {
            let grid = &self.grid;
            let bodies = self.rigid.iter().zip(&self.around).zip(&held);
            self.couplings = bodies
                .map(|((body, around), held)| Coupling::new(around.clone(), grid, body, held, kick, unit))
                .collect();
            for (body, coupling) in self.rigid.iter_mut().zip(&self.couplings) {
                body.twist = coupling.free;
            }
            self.project()?;
            let mut released = false;
            for ((body, coupling), held) in self.rigid.iter_mut().zip(&self.couplings).zip(&mut held) {
                body.twist = coupling.solved(&self.grid.pressure, unit);
                let count = held.len();
                held.retain(|support| support.impulse(body.mass, &body.twist) >= 0.0);
                released |= held.len() < count;
            }
            if !released {
                break;
            }
            for (body, _) in self.rigid.iter_mut().zip(&held) {
                body.twist = body.start;
            }
            self.grid.velocity.clone_from(&before);
        }
        self.release_bodies(dt, &held, walls)
    }

    /// Book the contacts that hold rigid bodies, and resolve all others.
    fn release_bodies(
        &mut self,
        dt: f64,
        held: &[Vec<Support>],
        walls: &mut Walls<'_, D>,
    ) -> Result<(), StepError> {
        for (body, held) in self.rigid.iter_mut().zip(held) {
            (body.momentum, body.solved) = (body.momentum_of(&body.twist), body.twist);
            body.supported = [0.0; 6];
            let mean: Twist = std::array::from_fn(|m| 0.5 * (body.start[m] + body.twist[m]));
            for support in held {
                let impulse = support.impulse(body.mass, &body.twist);
                (0..6).for_each(|m| body.supported[m] += impulse * support.row[m]);
                self.exchange.work += impulse * support.wall;
                self.exchange.impacts += impulse * (support.wall - product(&support.row, &mean));
            }
            for d in 0..3 {
                self.exchange.impulse[d] += body.supported[d];
                body.acted.impulse[d] += body.supported[d];
            }
            let finite = body.twist.iter().all(|x| x.is_finite());
            if !finite || body.speed() * dt > self.frame.h {
                let cause = if finite { Cause::TooFast } else { Cause::Velocity };
                return Err(self.clock.stopped(Stopped::Point {
                    kind: PointKind::Particle,
                    body: body.name.clone(),
                    number: 0,
                    position: wide(&body.centre),
                    law: "rigid body",
                    cause,
                }));
            }
        }
        walls.follow(&self.rigid);
        let done = resolve(&mut self.rigid, walls, dt, self.frame.h);
        (0..3).for_each(|d| self.exchange.impulse[d] += done.impulse[d]);
        self.exchange.work += done.work;
        self.exchange.impacts += done.lost;
        walls.follow(&self.rigid);
        Ok(())
    }

    /// Give the liquid in pockets, and in what is narrower, the velocity of the walls around it: no pressure would hold it.
    pub(crate) fn hold_pockets(&mut self, walls: &Walls<'_, D>) {
        if !self.moves_bodies() {
            return;
        }
        let (grid, frame, cells) = (&self.grid, &self.frame, Blocks::<D>::CELLS);
        let mut held = Vec::new();
        for (b, cut) in grid.cuts.iter().enumerate() {
            let Some(cut) = cut else { continue };
            for (i, d) in (0..cells).flat_map(|i| (0..D).map(move |d| (i, d))) {
                let slot = b * cells + i;
                if grid.marks[d][slot] != FREE {
                    continue;
                }
                let at = face_centre::<D>(i, d);
                let x = frame.place(&grid.blocks.keys[b], &at);
                let near = |n: &usize| walls.gap_of(*n, &x) < NARROW * frame.h;
                let in_pocket = |slot: usize| grid.pockets.binary_search_by_key(&slot, |p| p.0).is_ok();
                let pocket = in_pocket(slot) || grid.blocks.beside(b, i, d, false).is_some_and(in_pocket);
                let narrow = || {
                    let list: Vec<usize> = (0..walls.list.len()).filter(near).collect();
                    grid.open[d][slot] <= 0.0
                        && list.len() > 1
                        && list.iter().any(|n| walls.list[*n].follows())
                };
                if pocket || narrow() {
                    held.push((d, slot, walls.velocity(cut.sample(&at).2, &x, d)));
                }
            }
        }
        for (d, slot, velocity) in held {
            self.grid.velocity[d][slot] = velocity;
        }
    }

    /// Find the impulses of the liquid on the rigid bodies, and move them.
    pub(crate) fn move_bodies(&mut self, dt: f64, kick: f64) {
        let (unit, mean) = (self.unit(), self.mean_force(dt));
        for (body, coupling) in self.rigid.iter_mut().zip(&self.couplings) {
            let impulse = coupling.impulse(&self.grid, unit);
            let solved = coupling.solved(&self.grid.pressure, unit);
            let all = std::array::from_fn(|m| impulse[m] + body.supported[m]);
            body.pending = coupling.pending(body, &all, &solved);
            (0..3).for_each(|d| body.acted.impulse[d] += impulse[d]);
            body.acted.work += product(&impulse, &body.twist);
            // What holds a velocity balances all else.
            for d in (0..D).filter(|d| body.held()[*d]) {
                let held = -all[d] - body.mass * kick * body.force[d];
                self.exchange.impulse[d] += held;
                self.exchange.work += held * body.twist[d];
            }
            let load: [f64; D] = std::array::from_fn(|d| body.mass * kick * body.force[d]);
            add_to(&mut self.exchange.load, &load);
            body.advance(dt);
            for d in 0..D {
                body.momentum_rate[d] = (body.momentum[d] - body.before[d]) / kick;
                self.exchange.work += body.mass * body.moved[d] * mean[d];
                body.before[d] = body.momentum[d];
            }
        }
    }

    /// Change of the momentum of the rigid bodies in the last step without that of the body force, kg m/s.
    pub(crate) fn change_of_bodies(&self, kick: f64) -> [f64; 3] {
        let mut change = [0.0; 3];
        for body in &self.rigid {
            for d in 0..D {
                change[d] += kick * body.momentum_rate[d] - body.mass * kick * body.force[d];
            }
        }
        change
    }
}
