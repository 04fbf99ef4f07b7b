//! Conditions of one's own: what a boundary does to the matter at a place, in one step.

use std::fmt::Debug;

/// On which side of a plane the material is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// At coordinates above the plane's.
    Above,
    /// At coordinates below the plane's.
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

/// A boundary that a scene cannot have.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum BoundaryError {
    /// The axis does not exist.
    #[error("boundary axis = {axis} is not allowed; it must be below the dimension {dimension}")]
    Axis {
        /// Given axis.
        axis: usize,
        /// Dimension.
        dimension: usize,
    },
    /// A plane between nodes.
    #[error(
        "{plane} at = {at} m is not allowed; it must lie on a plane of nodes (the nearest is {nearest} m)"
    )]
    OffNode {
        /// Which plane.
        plane: &'static str,
        /// Given position, m.
        at: f64,
        /// Nearest plane of nodes, m.
        nearest: f64,
    },
    /// A wall where the grid lies in the reference configuration.
    #[error(
        "a wall is not allowed with a total-Lagrangian method, whose nodes do not know where material is; it must \
         be a symmetry plane, a fixed plane or a prescribed velocity"
    )]
    WallInReference,
    /// A number of a condition.
    #[error("{condition}: {field} = {value} is not allowed; it must be {allowed}")]
    Parameter {
        /// Which condition.
        condition: &'static str,
        /// Which number.
        field: &'static str,
        /// Its value.
        value: f64,
        /// What is allowed.
        allowed: &'static str,
    },
    /// Periodic planes that a scene cannot have.
    #[error("periodic planes across axis {axis} are not allowed {why}")]
    Periodic {
        /// Their axis.
        axis: usize,
        /// Where, and what is allowed.
        why: &'static str,
    },
    /// Not a finite number.
    #[error("boundary {field} = {value} is not allowed; it must be finite")]
    NotFinite {
        /// Which number.
        field: &'static str,
        /// Its value.
        value: f64,
    },
}

/// Matter at a place where a condition may act: a node of a grid, or a particle of a method without one. Per metre of depth in plane
/// strain, per radian in axisymmetric scenes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place<const D: usize> {
    /// Where it is at the start of the step, m.
    pub position: [f64; D],
    /// Its mass, kg.
    pub mass: f64,
    /// How thick the layer is that its mass stands for where the matter ends there, m: mass over density and its share of the surface.
    /// Half a cell for a node on the surface, unless the condition names its [`Condition::surface`].
    pub depth: f64,
    /// Within this distance of a plane it counts as lying on it, m.
    pub tolerance: f64,
    /// Velocity at the start of the step, m/s, by the methods that know it. Those that map momentum and impulse together do not.
    pub start: Option<[f64; D]>,
    /// Velocity at the end of the step if the condition did not act, m/s.
    pub trial: [f64; D],
    /// Time at the start of the step, s.
    pub time: f64,
    /// Size of the step, s.
    pub dt: f64,
}

impl<const D: usize> Place<D> {
    /// The part of the surface that the place stands for where matter of this density, kg/m^3, ends: mass / (density depth), m^2.
    #[must_use]
    pub fn area(&self, density: f64) -> f64 {
        self.mass / (density * self.depth)
    }

    /// The velocity over the step that ends with `after`, m/s: an impulse works on the matter with this one. The last one, where the
    /// velocity at the start is not known.
    #[must_use]
    pub fn mean(&self, after: &[f64; D]) -> [f64; D] {
        let before = self.start.unwrap_or(*after);
        std::array::from_fn(|d| 0.5 * (before[d] + after[d]))
    }

    /// The velocity after an impulse, N s, m/s.
    #[must_use]
    pub fn after(&self, impulse: &[f64; D]) -> [f64; D] {
        std::array::from_fn(|d| self.trial[d] + impulse[d] / self.mass)
    }
}

/// What a condition does to the matter at a place in a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reaction<const D: usize> {
    /// Impulse on the matter, N s; booked as one of the boundaries.
    pub impulse: [f64; D],
    /// The velocity that it works with, m/s: that of the boundary. Impulse times this is booked as work of the boundaries.
    pub velocity: [f64; D],
    /// Work of friction, J, zero or positive: heat that no point gets.
    pub heat: f64,
    /// The directions in which the matter moves with `velocity`, whatever pulls at it.
    pub held: [bool; D],
}

impl<const D: usize> Reaction<D> {
    /// Nothing.
    #[must_use]
    pub fn none() -> Self {
        Reaction { impulse: [0.0; D], velocity: [0.0; D], heat: 0.0, held: [false; D] }
    }

    /// Is it nothing?
    #[must_use]
    pub fn is_none(&self) -> bool {
        *self == Reaction::none()
    }

    /// Matter that is held in some directions by a boundary that moves with `velocity`, m/s.
    #[must_use]
    pub fn hold(place: &Place<D>, velocity: [f64; D], held: [bool; D]) -> Self {
        let mut impulse = [0.0; D];
        for d in (0..D).filter(|d| held[*d]) {
            impulse[d] = place.mass * (velocity[d] - place.trial[d]);
        }
        Reaction { impulse, velocity, heat: 0.0, held }
    }

    /// Work of the boundary on the matter, J.
    #[must_use]
    pub fn work(&self) -> f64 {
        (0..D).map(|d| self.impulse[d] * self.velocity[d]).sum()
    }
}

/// A boundary condition of one's own, on the nodes of a grid or on the particles of a method without one: passed to a scene as
/// [`Boundary::own`](crate::Boundary::own). It acts after forces and walls, and before velocities that are prescribed; several act in the
/// order in which they were added.
///
/// It is called for every place within its reach in every step, so it is to be cheap and to depend on nothing but its own constants and
/// the [`Place`]. A force should be integrated implicitly, or so small that the scene's step can follow it: the time step does not ask
/// conditions. `condition_conforms!` (behind the feature `conformance`) tests one in a line.
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
    /// Refuse numbers that it cannot work with; asked once, when a scene is given it.
    ///
    /// # Errors
    /// Field, value and what is allowed ([`require`]).
    fn check(&self) -> Result<(), BoundaryError> {
        Ok(())
    }

    /// May it act at a place between these corners, m, in a step that starts at `time`, s? Everywhere, if this is not said.
    fn reaches(&self, low: &[f64; D], high: &[f64; D], time: f64) -> bool {
        let _ = (low, high, time);
        true
    }

    /// The plane that it pushes on where the matter ends, if it is one across an axis: axis, position in m, and where the matter is. On a
    /// grid whose nodes share their surroundings further than to the next one, it is then asked for all nodes that have a share of
    /// this surface, on the plane or not, with that share for their [`Place::depth`] and a tolerance that takes them in: only so do
    /// tractions balance stresses at every node. The plane must lie on nodes.
    fn surface(&self) -> Option<(usize, f64, Side)> {
        None
    }

    /// What it does at a place: [`Reaction::none`] where it does not act.
    fn react(&self, place: &Place<D>) -> Reaction<D>;

    /// What it is, for checkpoints to compare; functions of time by what they give at these, s. What `Debug` shows, if this is not said.
    fn constants(&self, times: [f64; 2]) -> String {
        let _ = times;
        format!("{self:?}")
    }
}

/// Refuse a number of a condition unless `holds` and it is finite.
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
