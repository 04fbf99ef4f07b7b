//! Boundary conditions on grid nodes, and body forces.

use std::sync::Arc;

use impactite_geometry::{Lattice, Shape};

pub use crate::condition::{BoundaryError, Side};
use crate::condition::{Condition, Place, Reaction, require};
use crate::constants::{over, region};

/// Velocity history: `[v_x, v_y, v_z]` in m/s at time t in s; `None` leaves a component free.
pub type VelocityHistory = Arc<dyn Fn(f64) -> [Option<f64>; 3] + Send + Sync>;

/// Velocity boundary condition.
#[derive(Clone)]
pub enum Boundary<const D: usize> {
    /// Plane of symmetry: zero normal velocity, free tangential velocity. With wide stencils the nodes behind the plane mirror those in
    /// front, so that a half model has the solution of the whole one. Particles behind the plane are an error. A free rigid body in contact
    /// with the plane at the start is half of a symmetric body, if its motion is symmetric, too; other rigid bodies are stopped by the
    /// plane.
    Symmetry {
        /// Normal axis, `0..D`.
        axis: usize,
        /// Position, m; must be on a plane of nodes.
        at: f64,
        /// Side of the material.
        side: Side,
    },
    /// Rigid frictionless wall that moves along its normal and transmits compression only: a plane of symmetry that releases matter. Matter
    /// within a cell of it is stopped by its own stress, and released when the wall no longer carries it; a wall at rest does no work
    /// (book, "Where contact is applied"). Bodies mapped in their reference configuration have no stress on the scene's nodes and are
    /// stopped by impulses there; free rigid bodies are stopped when their surface reaches the wall.
    Wall {
        /// Normal axis, `0..D`.
        axis: usize,
        /// Position at t = 0, m.
        at: f64,
        /// Side of the material.
        side: Side,
        /// Velocity along the axis, m/s.
        velocity: f64,
    },
    /// [`Boundary::Wall`] with Coulomb friction and a velocity vector. Matter in contact sticks while the tangential impulse that stops the
    /// slip in a step is at most `friction` times the normal impulse, at every node or particle; else it slips, with that limit as impulse
    /// against the slip. The work of friction is booked as heat ([`Exchange::friction`](crate::Exchange::friction)), the work of the drag
    /// as work. Model an inclined wall by a wall across an axis and an inclined body force.
    FrictionWall {
        /// Normal axis, `0..D`.
        axis: usize,
        /// Position at t = 0, m.
        at: f64,
        /// Side of the material.
        side: Side,
        /// Velocity, m/s: the component along `axis` moves the wall, the others drag the matter.
        velocity: [f64; D],
        /// Coefficient of friction mu, zero or positive.
        friction: f64,
    },
    /// Absorbing plane at the end of the material: dashpots with the tractions -rho c_p v_n across and -rho c_s v_t along the plane
    /// (\[Lysmer1969\]), integrated by the trapezoidal rule, which is stable with any step. Waves at normal incidence are absorbed, up to
    /// the discretisation error; oblique waves are reflected in part. The plane does not support static loads: bodies need supports
    /// elsewhere. The work of the dashpots, negative, is booked as that of a boundary.
    ///
    /// The density is that of the matter at the plane: the mass of a node on it counts as that of half a cell of full material, the mass of
    /// an outermost particle of a gridless method as that of its volume. So displacements must be small against a cell. Methods that map
    /// momentum and impulse together have no velocity at the start of a step: they use the implicit rule of first order, which reflects
    /// some omega dt / 4 of waves of angular frequency omega.
    Absorbing {
        /// Normal axis, `0..D`.
        axis: usize,
        /// Position, m; must be on a plane of nodes.
        at: f64,
        /// Side of the material.
        side: Side,
        /// Speed of longitudinal waves c_p, m/s, positive.
        longitudinal: f64,
        /// Speed of shear waves c_s, m/s, zero or positive.
        shear: f64,
    },
    /// Pair of periodic planes: matter that leaves through one enters through the other, and nodes interact across them. Add it before the
    /// bodies. Positions of particles are within one period; on a grid with blocks of nodes the period starts at the start of the block
    /// that contains the lower plane.
    Periodic {
        /// Normal axis, `0..D`.
        axis: usize,
        /// Position of the lower plane, m; must be on a plane of nodes.
        low: f64,
        /// Position of the upper plane, m; a whole number of blocks of four cells above.
        high: f64,
    },
    /// Zero velocity of all nodes on and behind a plane. For free rigid bodies it is a no-slip wall.
    Fixed {
        /// Normal axis, `0..D`.
        axis: usize,
        /// Position, m; with `BoundaryModified` best on a plane of nodes.
        at: f64,
        /// Side of the material.
        side: Side,
    },
    /// Prescribed velocity of the nodes inside a region.
    Prescribed {
        /// Region, fixed in space.
        region: Arc<dyn Shape<D>>,
        /// Velocity over time.
        velocity: VelocityHistory,
    },
    /// Custom condition: [`Boundary::own`].
    Own(Arc<dyn Condition<D>>),
}

impl<const D: usize> std::fmt::Debug for Boundary<D> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Boundary::Symmetry { axis, at, side } => write!(f, "Symmetry(axis {axis} at {at} {side:?})"),
            Boundary::Wall { axis, at, side, velocity } => {
                write!(f, "Wall(axis {axis} at {at} {side:?} moving {velocity} m/s)")
            }
            Boundary::Fixed { axis, at, side } => write!(f, "Fixed(axis {axis} at {at} {side:?})"),
            Boundary::FrictionWall { axis, at, side, velocity, friction } => {
                write!(
                    f,
                    "FrictionWall(axis {axis} at {at} {side:?} moving {velocity:?} m/s, friction {friction})"
                )
            }
            Boundary::Absorbing { axis, at, side, longitudinal, shear } => {
                write!(f, "Absorbing(axis {axis} at {at} {side:?}, waves of {longitudinal} and {shear} m/s)")
            }
            Boundary::Periodic { axis, low, high } => write!(f, "Periodic(axis {axis} from {low} to {high})"),
            Boundary::Prescribed { .. } => write!(f, "Prescribed(region)"),
            Boundary::Own(condition) => write!(f, "Own({condition:?})"),
        }
    }
}

/// Plane of grid nodes on which a boundary is.
#[derive(Clone, Copy, Debug)]
pub struct Plane {
    /// Normal axis.
    pub axis: usize,
    /// Node index along the axis.
    pub node: i32,
    /// +1 if the material is at larger indices, else -1.
    pub sign: i32,
}

/// Round-off tolerance for a plane on nodes, in cells.
const ON_NODE: f64 = 1e-6;

impl<const D: usize> Boundary<D> {
    /// Create a custom condition.
    pub fn own(condition: impl Condition<D> + 'static) -> Self {
        Boundary::Own(Arc::new(condition))
    }

    /// Check the condition on this lattice.
    pub fn check(&self, lattice: &Lattice<D>) -> Result<(), BoundaryError> {
        Condition::check(self)?;
        let on_node = |what, axis, at: f64| match plane(lattice, axis, at, Side::Above) {
            Some(_) => Ok(()),
            None => {
                let node = (at - lattice.origin()[axis]) / lattice.spacing();
                let nearest = lattice.origin()[axis] + node.round() * lattice.spacing();
                Err(BoundaryError::OffNode { plane: what, at, nearest })
            }
        };
        match *self {
            Boundary::Symmetry { axis, at, .. } => on_node("symmetry plane", axis, at),
            Boundary::Absorbing { axis, at, .. } => on_node("absorbing plane", axis, at),
            Boundary::Periodic { axis, low, high } => {
                on_node("lower periodic plane", axis, low)?;
                on_node("upper periodic plane", axis, high)
            }
            Boundary::Own(ref condition) => match condition.surface() {
                Some((axis, ..)) if axis >= D => Err(BoundaryError::Axis { axis, dimension: D }),
                Some((axis, at, _)) => on_node("surface of a condition", axis, at),
                None => Ok(()),
            },
            _ => Ok(()),
        }
    }

    /// Return the plane of nodes of the condition's surface, if it has one.
    pub fn surface_on(&self, lattice: &Lattice<D>) -> Option<Plane> {
        Condition::surface(self).and_then(|(axis, at, side)| plane(lattice, axis, at, side))
    }

    /// Return the normal axis of the condition, if it is a plane.
    pub fn across(&self) -> Option<usize> {
        match *self {
            Boundary::Symmetry { axis, .. }
            | Boundary::Wall { axis, .. }
            | Boundary::FrictionWall { axis, .. }
            | Boundary::Absorbing { axis, .. }
            | Boundary::Periodic { axis, .. }
            | Boundary::Fixed { axis, .. } => Some(axis),
            Boundary::Prescribed { .. } | Boundary::Own(_) => None,
        }
    }

    /// True for walls, with or without friction.
    pub fn is_wall(&self) -> bool {
        matches!(self, Boundary::Wall { .. } | Boundary::FrictionWall { .. })
    }

    /// True for a condition that acts only on nodes on and behind a plane at rest.
    pub fn rests(&self) -> bool {
        match *self {
            Boundary::Symmetry { .. } | Boundary::Fixed { .. } => true,
            Boundary::Wall { velocity, .. } => velocity == 0.0,
            Boundary::FrictionWall { axis, velocity, .. } => velocity[axis] == 0.0,
            Boundary::Absorbing { .. }
            | Boundary::Periodic { .. }
            | Boundary::Prescribed { .. }
            | Boundary::Own(_) => false,
        }
    }

    /// True if the condition acts through [`Condition::react`].
    pub fn reacts(&self) -> bool {
        matches!(self, Boundary::FrictionWall { .. } | Boundary::Absorbing { .. } | Boundary::Own(_))
    }

    /// Return the mirror plane of nodes of a plane of symmetry.
    pub fn mirror(&self, lattice: &Lattice<D>) -> Option<Plane> {
        match *self {
            Boundary::Symmetry { axis, at, side } => plane(lattice, axis, at, side),
            _ => None,
        }
    }

    /// Return the plane of nodes at the end of the material, for a resting wall or a fixed plane on nodes.
    pub fn edge(&self, lattice: &Lattice<D>) -> Option<Plane> {
        match *self {
            Boundary::Fixed { axis, at, side } => plane(lattice, axis, at, side),
            Boundary::Wall { axis, at, side, velocity: 0.0 } => plane(lattice, axis, at, side),
            Boundary::FrictionWall { axis, at, side, velocity, .. } if velocity.get(axis) == Some(&0.0) => {
                plane(lattice, axis, at, side)
            }
            _ => None,
        }
    }

    /// True if the condition may act at `time`, s, on nodes with positions from `low` to `high`, m.
    pub fn reaches(&self, low: &[f64; D], high: &[f64; D], time: f64, tolerance: f64) -> bool {
        match *self {
            Boundary::Symmetry { axis, at, side } | Boundary::Fixed { axis, at, side } => {
                behind(low[axis], high[axis], at, side, tolerance)
            }
            Boundary::Wall { axis, at, side, velocity } => {
                behind(low[axis], high[axis], at + velocity * time, side, tolerance)
            }
            Boundary::FrictionWall { axis, at, side, velocity, .. } => {
                behind(low[axis], high[axis], at + velocity[axis] * time, side, tolerance)
            }
            Boundary::Absorbing { axis, at, .. } => {
                low[axis] <= at + tolerance && high[axis] >= at - tolerance
            }
            Boundary::Periodic { .. } => false,
            Boundary::Own(ref condition) => {
                let (low, high) = (low.map(|x| x - tolerance), high.map(|x| x + tolerance));
                condition.reaches(&low, &high, time)
            }
            Boundary::Prescribed { ref region, .. } => {
                let b = region.bounds();
                (0..D).all(|d| low[d] <= b.max[d] + tolerance && high[d] >= b.min[d] - tolerance)
            }
        }
    }

    /// Apply the condition to the velocity of a node at the position `x` at `time`. Conditions that [react](Boundary::reacts) are not
    /// applied here, except for the normal velocity at a rough wall. Nodes less than `copies` behind a plane of symmetry already mirror
    /// those in front.
    pub fn constrain(&self, x: &[f64; D], v: &mut [f64; 3], time: f64, tolerance: f64, copies: f64) {
        match *self {
            Boundary::Symmetry { axis, at, side } => {
                let depth = (at - x[axis]) * side.sign();
                if depth >= -tolerance && !(tolerance < depth && depth < copies) {
                    v[axis] = 0.0;
                }
            }
            Boundary::Wall { axis, at, side, velocity } => {
                if (x[axis] - at - velocity * time) * side.sign() <= tolerance {
                    let approach = (v[axis] - velocity) * side.sign();
                    if approach < 0.0 {
                        v[axis] = velocity;
                    }
                }
            }
            Boundary::FrictionWall { axis, at, side, velocity, .. } => {
                if (x[axis] - at - velocity[axis] * time) * side.sign() <= tolerance
                    && (v[axis] - velocity[axis]) * side.sign() < 0.0
                {
                    v[axis] = velocity[axis];
                }
            }
            Boundary::Absorbing { .. } | Boundary::Periodic { .. } | Boundary::Own(_) => {}
            Boundary::Fixed { axis, at, side } => {
                if (x[axis] - at) * side.sign() <= tolerance {
                    *v = [0.0; 3];
                }
            }
            Boundary::Prescribed { ref region, ref velocity } => {
                if region.signed_distance(*x) <= tolerance {
                    let prescribed = velocity(time);
                    for d in 0..D {
                        if let Some(value) = prescribed[d] {
                            v[d] = value;
                        }
                    }
                }
            }
        }
    }
}

/// Default implementation of the built-in conditions; methods may replace it, for example by mirrored nodes or by wall contact of nodes.
impl<const D: usize> Condition<D> for Boundary<D> {
    fn check(&self) -> Result<(), BoundaryError> {
        if let Some(axis) = self.across()
            && axis >= D
        {
            return Err(BoundaryError::Axis { axis, dimension: D });
        }
        let finite = |field, value: f64| {
            if value.is_finite() { Ok(()) } else { Err(BoundaryError::NotFinite { field, value }) }
        };
        match *self {
            Boundary::Symmetry { at, .. } | Boundary::Fixed { at, .. } => finite("at", at),
            Boundary::Wall { at, velocity, .. } => {
                finite("at", at)?;
                finite("velocity", velocity)
            }
            Boundary::FrictionWall { at, velocity, friction, .. } => {
                finite("at", at)?;
                velocity.iter().try_for_each(|&v| finite("velocity", v))?;
                require(
                    friction >= 0.0,
                    "friction wall",
                    "friction",
                    friction,
                    "zero or positive, and finite",
                )
            }
            Boundary::Absorbing { at, longitudinal, shear, .. } => {
                finite("at", at)?;
                let of = "absorbing plane";
                require(longitudinal > 0.0, of, "longitudinal", longitudinal, "positive and finite")?;
                require(shear >= 0.0, of, "shear", shear, "zero or positive, and finite")
            }
            Boundary::Periodic { low, high, .. } => {
                finite("low", low)?;
                require(high > low, "periodic planes", "high", high, "above the lower plane, and finite")
            }
            Boundary::Prescribed { .. } => Ok(()),
            Boundary::Own(ref condition) => condition.check(),
        }
    }

    fn reaches(&self, low: &[f64; D], high: &[f64; D], time: f64) -> bool {
        Boundary::reaches(self, low, high, time, 0.0)
    }

    fn surface(&self) -> Option<(usize, f64, Side)> {
        match *self {
            Boundary::Absorbing { axis, at, side, .. } => Some((axis, at, side)),
            Boundary::Own(ref condition) => condition.surface(),
            _ => None,
        }
    }

    fn react(&self, place: &Place<D>) -> Reaction<D> {
        match *self {
            Boundary::FrictionWall { axis, at, side, velocity, friction } => {
                if (place.position[axis] - at - velocity[axis] * place.time) * side.sign() <= place.tolerance
                {
                    strike(place, axis, side.sign(), velocity, friction)
                } else {
                    Reaction::none()
                }
            }
            Boundary::Absorbing { axis, at, longitudinal, shear, .. } => {
                if (place.position[axis] - at).abs() <= place.tolerance {
                    absorb(place, axis, longitudinal, shear)
                } else {
                    Reaction::none()
                }
            }
            Boundary::Own(ref condition) => condition.react(place),
            Boundary::Periodic { .. } => Reaction::none(),
            Boundary::Wall { axis, at, side, velocity } => {
                let along = [0.0; D].map(|_: f64| velocity);
                let wall = Boundary::FrictionWall { axis, at, side, velocity: along, friction: 0.0 };
                let mut reaction = Condition::react(&wall, place);
                (0..D).filter(|d| *d != axis).for_each(|d| reaction.velocity[d] = 0.0);
                reaction
            }
            Boundary::Symmetry { axis, at, side } => {
                let mut held = [false; D];
                held[axis] = (place.position[axis] - at) * side.sign() <= place.tolerance;
                Reaction::hold(place, [0.0; D], held)
            }
            Boundary::Fixed { axis, at, side } => {
                let held = (place.position[axis] - at) * side.sign() <= place.tolerance;
                Reaction::hold(place, [0.0; D], [held; D])
            }
            Boundary::Prescribed { region: ref shape, ref velocity } => {
                if shape.signed_distance(place.position) > place.tolerance {
                    return Reaction::none();
                }
                let wanted = velocity(place.time + place.dt);
                let held = std::array::from_fn(|d| wanted[d].is_some());
                Reaction::hold(place, std::array::from_fn(|d| wanted[d].unwrap_or(0.0)), held)
            }
        }
    }

    fn constants(&self, times: [f64; 2]) -> String {
        match self {
            Boundary::Prescribed { region: shape, velocity } => {
                format!("Prescribed({}, {} m/s)", region(&**shape), over(times, |t| velocity(t)))
            }
            Boundary::Own(condition) => condition.constants(times),
            other => format!("{other:?}"),
        }
    }
}

/// Return the impulse of a wall across `axis` on approaching matter, with Coulomb friction: the tangential impulse is at most `friction`
/// times the normal one.
fn strike<const D: usize>(
    place: &Place<D>,
    axis: usize,
    sign: f64,
    velocity: [f64; D],
    friction: f64,
) -> Reaction<D> {
    let approach = (velocity[axis] - place.trial[axis]) * sign;
    // False for NaN: the velocity propagates and is detected later.
    if approach <= 0.0 {
        return Reaction::none();
    }
    let mut reaction = Reaction { velocity, ..Reaction::none() };
    reaction.impulse[axis] = place.mass * (velocity[axis] - place.trial[axis]);
    reaction.held[axis] = true;
    let rubbed = rub(place, axis, velocity, friction * place.mass * approach);
    for d in (0..D).filter(|d| *d != axis) {
        (reaction.impulse[d], reaction.held[d]) = (rubbed.impulse[d], rubbed.held[d]);
    }
    reaction.heat = rubbed.heat;
    reaction
}

/// Return the friction of a wall across `axis` that moves with `velocity`, m/s: the impulse that stops the slip, or `limit`, N s, against
/// it. The heat is the loss of kinetic energy of the tangential motion relative to the wall, -J . ((v- + v+) / 2 - w); it is zero in a step
/// in which the slip reverses.
pub fn rub<const D: usize>(place: &Place<D>, axis: usize, velocity: [f64; D], limit: f64) -> Reaction<D> {
    let mut slip: [f64; D] = std::array::from_fn(|d| place.trial[d] - velocity[d]);
    slip[axis] = 0.0;
    let speed = slip.iter().map(|s| s * s).sum::<f64>().sqrt();
    let mut reaction = Reaction { velocity, ..Reaction::none() };
    if place.mass * speed <= limit {
        (0..D).filter(|d| *d != axis).for_each(|d| {
            reaction.impulse[d] = place.mass * (velocity[d] - place.trial[d]);
            reaction.held[d] = true;
        });
        return reaction;
    }
    if limit > 0.0 {
        reaction.impulse = slip.map(|s| -limit * s / speed);
        let mean = place.mean(&place.after(&reaction.impulse));
        let taken: f64 = (0..D).map(|d| reaction.impulse[d] * (velocity[d] - mean[d])).sum();
        reaction.heat = taken.max(0.0);
    }
    reaction
}

/// Return the reaction of the dashpots of a plane across `axis`: m dv/dt = -m c v / depth by the trapezoidal rule, or by the implicit Euler
/// rule if the start velocity is unknown.
fn absorb<const D: usize>(place: &Place<D>, axis: usize, longitudinal: f64, shear: f64) -> Reaction<D> {
    let mut impulse = [0.0; D];
    for d in 0..D {
        let rate = if d == axis { longitudinal } else { shear } * place.dt / place.depth;
        impulse[d] = -place.mass
            * match place.start {
                Some(start) => rate * (start[d] + place.trial[d]) / (2.0 + rate),
                None => rate * place.trial[d] / (1.0 + rate),
            };
    }
    Reaction { impulse, velocity: place.mean(&place.after(&impulse)), ..Reaction::none() }
}

/// Return the plane of nodes at `at`, if there is one.
fn plane<const D: usize>(lattice: &Lattice<D>, axis: usize, at: f64, side: Side) -> Option<Plane> {
    let node = (at - lattice.origin()[axis]) / lattice.spacing();
    let on_node = (node - node.round()).abs() <= ON_NODE;
    on_node.then(|| Plane { axis, node: node.round() as i32, sign: side.sign() as i32 })
}

fn behind(low: f64, high: f64, at: f64, side: Side, tolerance: f64) -> bool {
    match side {
        Side::Above => low <= at + tolerance,
        Side::Below => high >= at - tolerance,
    }
}

/// Acceleration of all material over time, m/s^2.
pub type BodyForce<const D: usize> = Arc<dyn Fn(f64) -> [f64; D] + Send + Sync>;
