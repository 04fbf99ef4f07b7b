//! Conditions on points that move with velocities of their own: particles, and nodes of elements.

use crate::boundary::{Boundary, BoundaryError, rub};
use crate::condition::{Condition, Place, Reaction};
use crate::error::SceneError;
use crate::exchange::Exchange;

/// A point that carries mass and moves with its own velocity through a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MovingPoint<const D: usize> {
    /// Where it is at the start of the step, m.
    pub position: [f64; D],
    /// Its mass, kg.
    pub mass: f64,
    /// Its velocity before any force of the step acted, m/s.
    pub start: [f64; D],
    /// The one that it moves with through the step, m/s.
    pub velocity: [f64; D],
    /// Its size, m: within a millionth of that it lies on a plane.
    pub size: f64,
    /// [`Place::depth`], m.
    pub depth: f64,
    /// [`Place::tolerance`], m.
    pub tolerance: f64,
}

impl<const D: usize> Boundary<D> {
    /// Refuse what cannot be for points that move with velocities of their own. For them
    ///
    /// - a wall keeps points in front of it and only pushes, rough ones with friction on what they push;
    /// - a plane of symmetry takes the velocity across it from points on it, and stops those that would cross it;
    /// - fixed and prescribed velocities hold for the points that are then behind the plane, or in the region;
    /// - absorbing planes and conditions of one's own act within [`MovingPoint::tolerance`];
    /// - there are no periodic planes, for reasons that `why` gives: places in space are not images.
    ///
    /// # Errors
    /// Numbers that a condition refuses, and periodic planes.
    pub fn check_moving(&self, why: &'static str) -> Result<(), SceneError> {
        Condition::check(self)?;
        match *self {
            Boundary::Periodic { axis, .. } => Err(BoundaryError::Periodic { axis, why }.into()),
            _ => Ok(()),
        }
    }

    /// A fixed plane at a face of a body of particles holds those whose surface it is, at `points` (m) with half sizes (m) as their surfaces are away:
    /// where it has none on or behind it, it is moved to the centres of those that touch it. Other conditions stay as they are.
    #[must_use]
    pub fn on_face(self, points: impl Iterator<Item = ([f64; D], f64)>) -> Self {
        let Boundary::Fixed { axis, at, side } = self else { return self };
        let mut moved = 0.0f64;
        for (x, half) in points {
            let height = (x[axis] - at) * side.sign();
            if height <= 1e-6 * half {
                return self;
            }
            if height <= (1.0 + 1e-6) * half {
                moved = moved.max(height);
            }
        }
        Boundary::Fixed { axis, at: at + side.sign() * moved, side }
    }

    /// Make the velocity of a point obey in the step from `time` by `dt`, s, and book what that gives to it.
    #[inline]
    pub fn hold(&self, p: &mut MovingPoint<D>, (time, dt): (f64, f64), given: &mut Exchange) {
        let before = p.velocity;
        match *self {
            Boundary::Symmetry { axis, at, side } => {
                let height = (p.position[axis] - at) * side.sign();
                // On the plane up to the rounding of lattices.
                if height <= 1e-6 * p.size {
                    p.velocity[axis] = 0.0;
                } else if height + p.velocity[axis] * side.sign() * dt < 0.0 {
                    p.velocity[axis] = -height * side.sign() / dt;
                }
            }
            Boundary::Wall { axis, at, side, velocity } => {
                let wall = at + velocity * (time + dt);
                let height = (p.position[axis] + p.velocity[axis] * dt - wall) * side.sign();
                if height < 0.0 {
                    p.velocity[axis] = (wall - p.position[axis]) / dt;
                    let impulse = p.mass * (p.velocity[axis] - before[axis]);
                    let lost = impulse * (velocity - 0.5 * (p.velocity[axis] + p.start[axis]));
                    given.impacts += lost;
                    given.work += lost;
                }
            }
            Boundary::FrictionWall { axis, at, side, velocity, friction } => {
                let wall = at + velocity[axis] * (time + dt);
                let height = (p.position[axis] + p.velocity[axis] * dt - wall) * side.sign();
                if height < 0.0 {
                    p.velocity[axis] = (wall - p.position[axis]) / dt;
                    let push = p.mass * (p.velocity[axis] - before[axis]);
                    let mut reaction = rub(&p.place((time, dt)), axis, velocity, friction * push.abs());
                    (reaction.impulse[axis], reaction.velocity[axis]) = (push, velocity[axis]);
                    p.apply(&reaction, before, given);
                    return;
                }
            }
            Boundary::Absorbing { .. } | Boundary::Own(_) => {
                let reaction = self.react(&p.place((time, dt)));
                p.apply(&reaction, before, given);
                return;
            }
            Boundary::Periodic { .. } => {}
            Boundary::Fixed { axis, at, side } => {
                if (p.position[axis] - at) * side.sign() <= 1e-6 * p.size {
                    p.velocity = [0.0; D];
                }
            }
            Boundary::Prescribed { ref region, ref velocity } => {
                if region.signed_distance(p.position) <= 0.0 {
                    p.follow(velocity(time + dt));
                }
            }
        }
        p.book(before, given);
    }

    /// The directions in which it alone moves a point in the step from `time` by `dt`, s, whatever else pushes that. None of walls, which
    /// let go.
    #[must_use]
    pub fn holds(&self, p: &MovingPoint<D>, step: (f64, f64)) -> [bool; D] {
        if self.is_wall() { [false; D] } else { self.react(&p.place(step)).held }
    }
}

impl<const D: usize> MovingPoint<D> {
    /// Take a velocity, m/s, where it is prescribed.
    #[inline]
    pub fn follow(&mut self, wanted: [Option<f64>; 3]) {
        for d in 0..D {
            if let Some(v) = wanted[d] {
                self.velocity[d] = v;
            }
        }
    }

    /// Book what changed the velocity from `before`, m/s, as an impulse of the boundaries and its work.
    #[inline]
    pub fn book(&self, before: [f64; D], given: &mut Exchange) {
        for d in 0..D {
            let impulse = self.mass * (self.velocity[d] - before[d]);
            given.impulse[d] += impulse;
            // Force and reaction act together from the start of the step to its end.
            given.work += 0.5 * impulse * (self.velocity[d] + self.start[d]);
        }
    }

    /// As a condition sees it.
    fn place(&self, (time, dt): (f64, f64)) -> Place<D> {
        Place {
            position: self.position,
            mass: self.mass,
            depth: self.depth,
            tolerance: self.tolerance,
            start: Some(self.start),
            trial: self.velocity,
            time,
            dt,
        }
    }

    /// Give it what a condition does to it, that had the velocity `before`. What it loses beyond work and heat, stopped by what holds it,
    /// is that of an impact.
    fn apply(&mut self, reaction: &Reaction<D>, before: [f64; D], given: &mut Exchange) {
        let mut taken = reaction.work() - reaction.heat;
        for d in 0..D {
            self.velocity[d] = before[d] + reaction.impulse[d] / self.mass;
            given.impulse[d] += reaction.impulse[d];
            taken -= 0.5 * reaction.impulse[d] * (self.velocity[d] + self.start[d]);
        }
        given.work += reaction.work();
        given.friction += reaction.heat;
        given.impacts += taken;
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use impactite_geometry::Cuboid;

    use super::*;
    use crate::condition::Side;

    #[test]
    fn what_alone_moves_a_point_is_known() {
        let region = Arc::new(Cuboid::new([-1.0, -1.0], [1.0, 1.0]).expect("a box"));
        let velocity: crate::boundary::VelocityHistory = Arc::new(|_| [None, Some(2.0), None]);
        let plane = (0, 0.0, Side::Above);
        let (axis, at, side) = plane;
        let wall = Boundary::Wall { axis, at, side, velocity: 0.0 };
        let rough = Boundary::FrictionWall { axis, at, side, velocity: [0.0; 2], friction: 10.0 };
        for (boundary, on, off) in [
            (Boundary::Symmetry { axis, at, side }, [true, false], [false; 2]),
            (Boundary::Fixed { axis, at, side }, [true; 2], [false; 2]),
            (Boundary::Prescribed { region, velocity }, [false, true], [false; 2]),
            // They let go.
            (wall, [false; 2], [false; 2]),
            (rough, [false; 2], [false; 2]),
        ] {
            for (x, wanted) in [(0.0, on), (3.0, off)] {
                let point = MovingPoint {
                    position: [x, 0.5],
                    mass: 1.0,
                    start: [-1.0, 0.1],
                    velocity: [-1.0, 0.1],
                    size: 1.0,
                    depth: 0.5,
                    tolerance: 1e-6,
                };
                assert_eq!(boundary.holds(&point, (0.0, 0.1)), wanted, "{boundary:?} at {x}");
            }
        }
    }
}
