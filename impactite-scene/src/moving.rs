//! Boundary conditions on points with velocities of their own: particles, and nodes of elements.

use std::sync::Arc;

use impactite_geometry::{Bounds, Shape};

use crate::boundary::{Boundary, BoundaryError, rub};
use crate::condition::{Condition, Place, Reaction};
use crate::error::SceneError;
use crate::exchange::Exchange;

/// Point with mass that moves with its own velocity through a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MovingPoint<const D: usize> {
    /// Position at the start of the step, m.
    pub position: [f64; D],
    /// Mass, kg.
    pub mass: f64,
    /// Velocity before all forces of the step, m/s.
    pub start: [f64; D],
    /// Velocity of the motion through the step, m/s.
    pub velocity: [f64; D],
    /// Size, m: a millionth of it is the tolerance of positions on a plane.
    pub size: f64,
    /// [`Place::depth`], m.
    pub depth: f64,
    /// [`Place::tolerance`], m.
    pub tolerance: f64,
}

impl<const D: usize> Boundary<D> {
    /// Check the condition for points with velocities of their own. For them
    ///
    /// - a wall keeps points in front of it and transmits compression only, rough walls with friction;
    /// - a plane of symmetry removes the normal velocity of points on it, and stops points that would cross it;
    /// - fixed and prescribed velocities apply to the points that are behind the plane or in the region at that time;
    /// - absorbing planes and custom conditions act within [`MovingPoint::tolerance`];
    /// - periodic planes are not available, since places in space are not images; `why` is the reason in the error.
    ///
    /// # Errors
    /// Invalid parameters, and periodic planes.
    pub fn check_moving(&self, why: &'static str) -> Result<(), SceneError> {
        Condition::check(self)?;
        match *self {
            Boundary::Periodic { axis, .. } => Err(BoundaryError::Periodic { axis, why }.into()),
            _ => Ok(()),
        }
    }

    /// Return the index in a list at which [`Boundaries::add`](crate::Boundaries::add) adds the condition: planes of symmetry and walls,
    /// fixed planes, prescribed velocities, then those that react (friction, dashpots, custom conditions), each in the order of addition.
    pub(crate) fn place_in(&self, list: &[Self]) -> usize {
        let rank = |boundary: &Self| match boundary {
            Boundary::Fixed { .. } => 1,
            Boundary::Prescribed { .. } => 2,
            other => 3 * u8::from(other.reacts()),
        };
        let own = rank(self);
        list.partition_point(|other| rank(other) <= own)
    }

    /// Adapt a fixed plane or a prescribed region at a face of a body of particles with `points`, m, and half sizes, m: if no particle is
    /// on or behind it, it is extended to the centres of the particles whose surface it touches. Other conditions are unchanged.
    #[must_use]
    pub fn on_face(self, points: impl Iterator<Item = ([f64; D], f64)>) -> Self {
        let distance = |x: &[f64; D]| match &self {
            Boundary::Fixed { axis, at, side } => (x[*axis] - at) * side.sign(),
            Boundary::Prescribed { region, .. } => region.signed_distance(*x),
            _ => f64::INFINITY,
        };
        let mut moved = 0.0f64;
        for (x, half) in points {
            let distance = distance(&x);
            if distance <= 1e-6 * half {
                return self;
            }
            if distance <= (1.0 + 1e-6) * half {
                moved = moved.max(distance);
            }
        }
        match self {
            Boundary::Fixed { axis, at, side } => {
                Boundary::Fixed { axis, at: at + side.sign() * moved, side }
            }
            Boundary::Prescribed { region, velocity } if moved > 0.0 => Boundary::Prescribed {
                region: Arc::new(Extended { region, by: (1.0 + 1e-9) * moved }),
                velocity,
            },
            other => other,
        }
    }

    /// Apply the condition to the velocity of a point in the step of `dt`, s, from `time`, s, and add impulse and work to `given`.
    #[inline]
    pub fn hold(&self, p: &mut MovingPoint<D>, (time, dt): (f64, f64), given: &mut Exchange) {
        let before = p.velocity;
        match *self {
            Boundary::Symmetry { axis, at, side } => {
                let height = (p.position[axis] - at) * side.sign();
                // On the plane, up to the rounding of lattices.
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

    /// Return the directions in which the condition alone determines the motion of a point in the step, given by start time and size, s.
    /// None for walls, which release points.
    #[must_use]
    pub fn holds(&self, p: &MovingPoint<D>, step: (f64, f64)) -> [bool; D] {
        if self.is_wall() { [false; D] } else { self.react(&p.place(step)).held }
    }
}

/// Region extended by a distance, m.
struct Extended<const D: usize> {
    region: Arc<dyn Shape<D>>,
    by: f64,
}

impl<const D: usize> Shape<D> for Extended<D> {
    fn signed_distance(&self, x: [f64; D]) -> f64 {
        self.region.signed_distance(x) - self.by
    }
    fn bounds(&self) -> Bounds<D> {
        let bounds = self.region.bounds();
        Bounds { min: bounds.min.map(|x| x - self.by), max: bounds.max.map(|x| x + self.by) }
    }
}

impl<const D: usize> MovingPoint<D> {
    /// Set the prescribed velocity components, m/s.
    #[inline]
    pub fn follow(&mut self, wanted: [Option<f64>; 3]) {
        for d in 0..D {
            if let Some(v) = wanted[d] {
                self.velocity[d] = v;
            }
        }
    }

    /// Book the velocity change from `before`, m/s, as an impulse of the boundaries and its work.
    #[inline]
    pub fn book(&self, before: [f64; D], given: &mut Exchange) {
        for d in 0..D {
            let impulse = self.mass * (self.velocity[d] - before[d]);
            given.impulse[d] += impulse;
            // Force and reaction act together through the step: the work uses the mean velocity.
            given.work += 0.5 * impulse * (self.velocity[d] + self.start[d]);
        }
    }

    /// Return the point as a place for conditions.
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

    /// Apply the reaction of a condition to the point with the velocity `before`, m/s. Energy lost beyond work and heat, by constraints, is
    /// booked as loss of an impact.
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
            // Walls release points.
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
