//! Boundary conditions on particles.

use impactite_scene::boundary::{BoundaryError, rub};
use impactite_scene::{Boundary, Condition, Exchange, Place, Reaction, SceneError};

use crate::particles::Particle;

/// Refuse what cannot be. The conditions are those of all methods, read for particles:
///
/// - a wall keeps the centres of particles in front of it and only pushes, rough ones with friction on what they push;
/// - a plane of symmetry takes the velocity across it from particles on it, and stops those that would cross it;
/// - fixed and prescribed velocities hold for the particles that are then behind the plane, or in the region;
/// - absorbing planes act on the particles whose surface is on them, up to half a radius;
/// - particles know no periodic planes: elements are made of places in space, not of images.
pub(crate) fn check<const D: usize>(boundary: &Boundary<D>) -> Result<(), SceneError> {
    Condition::check(boundary)?;
    match *boundary {
        Boundary::Periodic { axis, .. } => {
            let why = "in the particle-contact method; take planes of symmetry, or the material point method";
            Err(BoundaryError::Periodic { axis, why }.into())
        }
        _ => Ok(()),
    }
}

/// Make the velocity with which a particle moves through the step from `time` by `dt` obey. It had the velocity
/// `start` before forces acted. The surface of the body lies `surface` radii beyond the centres of its outermost particles.
pub(crate) fn constrain<const D: usize>(
    boundary: &Boundary<D>,
    p: &mut Particle<D>,
    (start, surface): (&[f64; D], f64),
    (time, dt): (f64, f64),
    given: &mut Exchange,
) {
    let before = p.velocity;
    match *boundary {
        Boundary::Symmetry { axis, at, side } => {
            let height = (p.position[axis] - at) * side.sign();
            // On the plane up to the rounding of lattices.
            if height <= 1e-6 * p.radius {
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
                let lost = impulse * (velocity - 0.5 * (p.velocity[axis] + start[axis]));
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
                let mut reaction =
                    rub(&at_particle(p, start, surface, (time, dt)), axis, velocity, friction * push.abs());
                (reaction.impulse[axis], reaction.velocity[axis]) = (push, velocity[axis]);
                apply(&reaction, p, (start, before), given);
                return;
            }
        }
        Boundary::Absorbing { .. } | Boundary::Own(_) => {
            let reaction = boundary.react(&at_particle(p, start, surface, (time, dt)));
            apply(&reaction, p, (start, before), given);
            return;
        }
        Boundary::Periodic { .. } => {}
        Boundary::Fixed { axis, at, side } => {
            if (p.position[axis] - at) * side.sign() <= 1e-6 * p.radius {
                p.velocity = [0.0; D];
            }
        }
        Boundary::Prescribed { ref region, ref velocity } => {
            if region.signed_distance(p.position) <= 0.0 {
                let wanted = velocity(time + dt);
                for d in 0..D {
                    if let Some(v) = wanted[d] {
                        p.velocity[d] = v;
                    }
                }
            }
        }
    }
    for d in 0..D {
        let impulse = p.mass * (p.velocity[d] - before[d]);
        given.impulse[d] += impulse;
        // Force and reaction act together from the start of the step to its end.
        given.work += 0.5 * impulse * (p.velocity[d] + start[d]);
    }
}

/// A particle as a condition sees it.
fn at_particle<const D: usize>(
    p: &Particle<D>,
    start: &[f64; D],
    surface: f64,
    (time, dt): (f64, f64),
) -> Place<D> {
    Place {
        position: p.position,
        mass: p.mass,
        depth: p.radius * (1.0 + surface),
        tolerance: p.radius * (0.5 + surface),
        start: Some(*start),
        trial: p.velocity,
        time,
        dt,
    }
}

/// Give a particle that had the velocity `before` what a condition does to it. What it loses beyond work and heat, stopped by what holds
/// it, is that of an impact.
fn apply<const D: usize>(
    reaction: &Reaction<D>,
    p: &mut Particle<D>,
    (start, before): (&[f64; D], [f64; D]),
    given: &mut Exchange,
) {
    let mut taken = reaction.work() - reaction.heat;
    for d in 0..D {
        p.velocity[d] = before[d] + reaction.impulse[d] / p.mass;
        given.impulse[d] += reaction.impulse[d];
        taken -= 0.5 * reaction.impulse[d] * (p.velocity[d] + start[d]);
    }
    given.work += reaction.work();
    given.friction += reaction.heat;
    given.impacts += taken;
}
