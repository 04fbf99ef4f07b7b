//! Boundary conditions on particles.

use mpm_core::{Boundary, Side};

use crate::particles::{Particle, SceneError};

/// What the boundaries gave to the particles, summed over a run.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Given {
    /// Impulse, kg m/s.
    pub impulse: [f64; 3],
    /// Work, J: impulse times the mean of the particle's velocities before and after the step. It contains what
    /// particles lose that a wall stops.
    pub work: f64,
    /// Kinetic energy lost in plastic impacts of particles on walls, J, already counted in `work`: there work is less
    /// than impulse times the velocity of the wall.
    pub lost: f64,
}

impl Given {
    /// The sum.
    #[must_use]
    pub fn plus(mut self, o: &Given) -> Given {
        for d in 0..3 {
            self.impulse[d] += o.impulse[d];
        }
        self.work += o.work;
        self.lost += o.lost;
        self
    }
}

/// Refuse what cannot be. The conditions are those of `mpm-core`, read for particles:
///
/// - a wall keeps the centres of particles in front of it and only pushes;
/// - a plane of symmetry takes the velocity across it from particles on it, and stops those that would cross it;
/// - fixed and prescribed velocities hold for the particles that are then behind the plane, or in the region.
pub(crate) fn check<const D: usize>(boundary: &Boundary<D>) -> Result<(), SceneError> {
    let refuse = |field, value, allowed| Err(SceneError::Boundary { field, value, allowed });
    let (axis, at, velocity) = match *boundary {
        Boundary::Symmetry { axis, at, .. } | Boundary::Fixed { axis, at, .. } => (axis, at, 0.0),
        Boundary::Wall { axis, at, velocity, .. } => (axis, at, velocity),
        Boundary::Prescribed { .. } => return Ok(()),
    };
    if axis >= D {
        return refuse("axis", axis as f64, "below the dimension");
    }
    for (field, value) in [("at", at), ("velocity", velocity)] {
        if !value.is_finite() {
            return refuse(field, value, "finite");
        }
    }
    Ok(())
}

/// +1 if the material lies above the plane, else -1.
fn sign(side: Side) -> f64 {
    match side {
        Side::Above => 1.0,
        Side::Below => -1.0,
    }
}

/// Make the velocity with which a particle moves through the step from `time` by `dt` obey. It had the velocity
/// `start` before forces acted.
pub(crate) fn constrain<const D: usize>(
    boundary: &Boundary<D>,
    p: &mut Particle<D>,
    start: &[f64; D],
    time: f64,
    dt: f64,
    given: &mut Given,
) {
    let before = p.velocity;
    match *boundary {
        Boundary::Symmetry { axis, at, side } => {
            let height = (p.position[axis] - at) * sign(side);
            // On the plane up to the rounding of lattices.
            if height <= 1e-6 * p.radius {
                p.velocity[axis] = 0.0;
            } else if height + p.velocity[axis] * sign(side) * dt < 0.0 {
                p.velocity[axis] = -height * sign(side) / dt;
            }
        }
        Boundary::Wall { axis, at, side, velocity } => {
            let wall = at + velocity * (time + dt);
            let height = (p.position[axis] + p.velocity[axis] * dt - wall) * sign(side);
            if height < 0.0 {
                p.velocity[axis] = (wall - p.position[axis]) / dt;
                let impulse = p.mass * (p.velocity[axis] - before[axis]);
                given.lost += impulse * (velocity - 0.5 * (p.velocity[axis] + start[axis]));
            }
        }
        Boundary::Fixed { axis, at, side } => {
            if (p.position[axis] - at) * sign(side) <= 1e-6 * p.radius {
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
