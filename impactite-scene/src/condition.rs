//! Custom boundary conditions: impulse on the matter at a node or particle in one step.

use std::fmt::Debug;

/// Side of a plane on which the material is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// Coordinates above the plane's.
    Above,
    /// Coordinates below the plane's.
    Below,
}

impl Side {
    /// +1 if the inward normal points along the axis, else -1.
    #[must_use]
    pub fn sign(self) -> f64 {
        match self {
            Side::Above => 1.0,
            Side::Below => -1.0,
        }
    }
}

/// Invalid boundary condition.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum BoundaryError {
    /// Axis beyond the dimension.
    #[error("boundary axis = {axis} is not allowed; it must be below the dimension {dimension}")]
    Axis {
        /// Axis given.
        axis: usize,
        /// Dimension.
        dimension: usize,
    },
    /// Plane that is not on grid nodes.
    #[error(
        "{plane} at = {at} m is not allowed; it must lie on a plane of nodes (the nearest is {nearest} m)"
    )]
    OffNode {
        /// Name of the plane.
        plane: &'static str,
        /// Position given, m.
        at: f64,
        /// Nearest plane of nodes, m.
        nearest: f64,
    },
    /// Wall on a grid in the reference configuration.
    #[error(
        "a wall is not allowed with a total-Lagrangian method, whose nodes do not know where material is; it must \
         be a symmetry plane, a fixed plane or a prescribed velocity"
    )]
    WallInReference,
    /// Invalid parameter of a condition.
    #[error("{condition}: {field} = {value} is not allowed; it must be {allowed}")]
    Parameter {
        /// Name of the condition.
        condition: &'static str,
        /// Name of the parameter.
        field: &'static str,
        /// Value given.
        value: f64,
        /// Allowed values, in words.
        allowed: &'static str,
    },
    /// Invalid periodic planes.
    #[error("periodic planes across axis {axis} are not allowed {why}")]
    Periodic {
        /// Normal axis.
        axis: usize,
        /// Restriction and alternative, which end the message.
        why: &'static str,
    },
    /// Motion over time of a condition that has none.
    #[error("{course} is not allowed here; it must be {allowed}")]
    Course {
        /// Motion given.
        course: &'static str,
        /// Conditions that may have it, in words.
        allowed: &'static str,
    },
    /// Account of a condition that does not exist.
    #[error("account = {account} of a boundary is not allowed; it must be below {count}")]
    Account {
        /// Account given.
        account: usize,
        /// Number of accounts.
        count: usize,
    },
    /// Value that is not finite.
    #[error("boundary {field} = {value} is not allowed; it must be finite")]
    NotFinite {
        /// Name of the number.
        field: &'static str,
        /// Value given.
        value: f64,
    },
}

/// Matter at a location where a condition may act: a grid node, or a particle of a gridless method. Extensive quantities are per metre of
/// depth in plane strain, per radian in axisymmetric scenes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place<const D: usize> {
    /// Position at the start of the step, m.
    pub position: [f64; D],
    /// Mass, kg.
    pub mass: f64,
    /// Thickness of the layer that the mass represents at a surface, m: mass over density and surface share. It is half a cell for a node
    /// on the surface, unless the condition has a [`Condition::surface`].
    pub depth: f64,
    /// Distance from a plane within which the position counts as on the plane, m.
    pub tolerance: f64,
    /// Velocity at the start of the step, m/s. None in methods that map momentum and impulse together.
    pub start: Option<[f64; D]>,
    /// Trial velocity at the end of the step, without the condition, m/s.
    pub trial: [f64; D],
    /// Time at the start of the step, s.
    pub time: f64,
    /// Size of the step, s.
    pub dt: f64,
}

impl<const D: usize> Place<D> {
    /// Return the surface area that the mass represents at a density (kg/m^3): mass / (density depth), m^2.
    #[must_use]
    pub fn area(&self, density: f64) -> f64 {
        self.mass / (density * self.depth)
    }

    /// Return the mean velocity of a step with the final velocity `after`, m/s: the work of an impulse on the matter is the product of
    /// both. It is `after` if the start velocity is unknown.
    #[must_use]
    pub fn mean(&self, after: &[f64; D]) -> [f64; D] {
        let before = self.start.unwrap_or(*after);
        std::array::from_fn(|d| 0.5 * (before[d] + after[d]))
    }

    /// Return the velocity after an impulse (N s), m/s.
    #[must_use]
    pub fn after(&self, impulse: &[f64; D]) -> [f64; D] {
        std::array::from_fn(|d| self.trial[d] + impulse[d] / self.mass)
    }
}

/// Impulse, work and constraints of a condition at a place in a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reaction<const D: usize> {
    /// Impulse on the matter, N s; booked as an impulse of the boundaries.
    pub impulse: [f64; D],
    /// Velocity of the boundary, m/s. Impulse times this velocity is booked as work of the boundaries.
    pub velocity: [f64; D],
    /// Work of friction, J, zero or positive: heat that is not added to a point.
    pub heat: f64,
    /// Constrained directions: there the matter moves with `velocity`, whatever other forces act.
    pub held: [bool; D],
}

impl<const D: usize> Reaction<D> {
    /// Return a reaction without effect.
    #[must_use]
    pub fn none() -> Self {
        Reaction { impulse: [0.0; D], velocity: [0.0; D], heat: 0.0, held: [false; D] }
    }

    /// True if the reaction has no effect.
    #[must_use]
    pub fn is_none(&self) -> bool {
        *self == Reaction::none()
    }

    /// Return the reaction of a boundary that prescribes `velocity` (m/s) in the directions `held`.
    #[must_use]
    pub fn hold(place: &Place<D>, velocity: [f64; D], held: [bool; D]) -> Self {
        let mut impulse = [0.0; D];
        for d in (0..D).filter(|d| held[*d]) {
            impulse[d] = place.mass * (velocity[d] - place.trial[d]);
        }
        Reaction { impulse, velocity, heat: 0.0, held }
    }

    /// Return the work of the boundary on the matter, J.
    #[must_use]
    pub fn work(&self) -> f64 {
        (0..D).map(|d| self.impulse[d] * self.velocity[d]).sum()
    }
}

/// Custom boundary condition on grid nodes or on particles of gridless methods, passed to a scene as
/// [`Boundary::own`](crate::Boundary::own). It is applied after forces and walls and before prescribed velocities; several conditions are
/// applied in the order in which they were added.
///
/// It is evaluated at every place within its reach in every step: it should be cheap and depend only on its constants and the [`Place`].
/// Integrate a force implicitly, or keep it so small that the scene's step resolves it: the time step control ignores conditions.
/// `condition_conforms!` (feature `conformance`) tests a condition in one line.
///
/// Springs and dashpots under a floor (a Winkler foundation):
///
/// ```
/// use impactite_scene::boundary::{Boundary, BoundaryError, Side};
/// use impactite_scene::condition::{Condition, Place, Reaction, require};
///
/// /// Pressure k u + c v against matter that is u below the plane y = `floor` and moves down with v.
/// #[derive(Debug)]
/// struct Foundation { floor: f64, stiffness: f64, damping: f64, density: f64 }
///
/// impl Condition<2> for Foundation {
///     fn check(&self) -> Result<(), BoundaryError> {
///         let positive = |field, value: f64| require(value > 0.0, "foundation", field, value, "positive and finite");
///         positive("stiffness", self.stiffness)?;
///         positive("damping", self.damping)?;
///         positive("density", self.density)
///     }
///     fn reaches(&self, low: &[f64; 2], _: &[f64; 2], _: f64) -> bool {
///         low[1] <= self.floor
///     }
///     fn surface(&self) -> Option<(usize, f64, Side)> {
///         Some((1, self.floor, Side::Above))
///     }
///     fn react(&self, place: &Place<2>) -> Reaction<2> {
///         let depth = self.floor - place.position[1];
///         if depth < -place.tolerance {
///             return Reaction::none();
///         }
///         // Implicit: m (v - v_trial) = dt A (k (u - dt v) - c v).
///         let (area, dt) = (place.area(self.density), place.dt);
///         let pull = dt * area * (dt * self.stiffness + self.damping);
///         let velocity = (place.mass * place.trial[1] + dt * area * self.stiffness * depth) / (place.mass + pull);
///         let impulse = [0.0, place.mass * (velocity - place.trial[1])];
///         Reaction { impulse, velocity: place.mean(&place.after(&impulse)), ..Reaction::none() }
///     }
/// }
///
/// let foundation = Foundation { floor: 0.0, stiffness: 1e7, damping: 1e4, density: 2e3 };
/// foundation.check()?;
/// let boundary = Boundary::<2>::own(foundation);
/// # Ok::<(), BoundaryError>(())
/// ```
pub trait Condition<const D: usize>: Debug + Send + Sync {
    /// Check the parameters; called once, when the condition is added to a scene.
    ///
    /// # Errors
    /// Field, value and allowed values ([`require`]).
    fn check(&self) -> Result<(), BoundaryError> {
        Ok(())
    }

    /// Return true if the condition may act between these corners, m, in a step that starts at `time`, s. Default: everywhere.
    fn reaches(&self, low: &[f64; D], high: &[f64; D], time: f64) -> bool {
        let _ = (low, high, time);
        true
    }

    /// Return the surface plane of the matter that the condition loads, if it is a plane across an axis: axis, position in m, and side of
    /// the matter. The plane must be on nodes. On grids whose shape functions extend beyond the next node, the condition is evaluated at
    /// all nodes with a share of this surface, on the plane or not. Their [`Place::depth`] follows from that share, and their tolerance
    /// includes them: only then do tractions balance stresses at every node.
    fn surface(&self) -> Option<(usize, f64, Side)> {
        None
    }

    /// Return the reaction at a place; [`Reaction::none`] where the condition does not act.
    fn react(&self, place: &Place<D>) -> Reaction<D>;

    /// Return a description for comparison with checkpoints; functions of time are sampled at `times`, s. Default: the `Debug` output.
    fn constants(&self, times: [f64; 2]) -> String {
        let _ = times;
        format!("{self:?}")
    }
}

/// Check that a parameter of a condition is finite and `holds`.
///
/// # Errors
/// [`BoundaryError::Parameter`].
pub fn require(
    holds: bool,
    condition: &'static str,
    field: &'static str,
    value: f64,
    allowed: &'static str,
) -> Result<(), BoundaryError> {
    if holds && value.is_finite() {
        Ok(())
    } else {
        Err(BoundaryError::Parameter { condition, field, value, allowed })
    }
}
