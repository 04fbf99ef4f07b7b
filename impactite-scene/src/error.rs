//! Invalid scene definitions and errors of steps, for any method.

use impactite_geometry::search::SearchError;
use mpm_materials::Breakdown;

use crate::condition::BoundaryError;
use crate::control::ControlError;
use crate::finding::Finding;

/// Failed step. The run stays in the state in which the step failed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("step {step} at t = {time:.6e} s: {what}")]
pub struct StepError {
    /// Number of the step.
    pub step: u64,
    /// Time at the start of the step, s.
    pub time: f64,
    /// Reason of the stop.
    pub what: Stopped,
}

/// Reason of a stopped step.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Stopped {
    /// Failure at a point.
    #[error("{kind} {number} of body `{body}` (law: {law}) near {position:?} m: {cause}")]
    Point {
        /// Kind of the point.
        kind: PointKind,
        /// Name of the body.
        body: String,
        /// Number of the point in the body.
        number: usize,
        /// Position, m.
        position: [f64; 3],
        /// Law of the body.
        law: &'static str,
        /// Cause.
        cause: Cause,
    },
    /// Particle outside of the grid.
    #[error("particle {particle} of body `{body}` (law: {law}) at {position:?} m leaves the grid: {outside}")]
    Outside {
        /// Name of the body.
        body: String,
        /// Number of the particle.
        particle: usize,
        /// Position, m.
        position: [f64; 3],
        /// Law of the body.
        law: &'static str,
        /// Missing block of the grid.
        outside: Box<OutsideGrid>,
    },
    /// Scene that became invalid, for example by the prescribed motion of a rigid body.
    #[error(transparent)]
    Scene(SceneError),
    /// Invalid time or time step.
    #[error("{field} = {value:e} s is not allowed; it must be {allowed} (now t = {now:e} s)")]
    Clock {
        /// Name of the argument.
        field: &'static str,
        /// Value given, s.
        value: f64,
        /// Allowed values, in words.
        allowed: &'static str,
        /// Current time, s.
        now: f64,
    },
    /// Time step that is not positive and finite.
    #[error(
        "the time step became {0} s: a wave speed is infinite, zero or not a number, or all bodies are rigid; check the constants of the \
         materials, or fix the step (`TimeControl::Fixed`)"
    )]
    NoTimeStep(f64),
    /// System of equations that was not solved.
    #[error("{what} was not solved: {why}")]
    Solve {
        /// Name of the system.
        what: &'static str,
        /// Error of the solve, with the remedy.
        why: String,
    },
    /// Error of a hook of the scene.
    #[error("hook `{hook}`: {why}")]
    Hook {
        /// Name of the hook.
        hook: String,
        /// Error.
        why: String,
    },
    /// Finding of a check after a completed step: results are not to be trusted ([`crate::watch`]).
    #[error("{0}")]
    Watch(Box<Finding>),
}

/// Kind of a numbered point of a body.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum PointKind {
    /// Particle.
    Particle,
    /// Element.
    Element,
    /// Cell of a body that is divided into cells.
    Cell,
    /// Node of elements.
    Node,
}

impl std::fmt::Display for PointKind {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            PointKind::Particle => "particle",
            PointKind::Element => "element",
            PointKind::Cell => "cell",
            PointKind::Node => "node",
        })
    }
}

/// Cause of a failure at a point.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Cause {
    /// Failure of the material law.
    #[error("{0}")]
    Law(Breakdown),
    /// Displacement of more than one cell in a step, or a velocity that is not finite.
    #[error("it would move more than one cell in the step, or its velocity is not a finite number")]
    TooFast,
    /// Velocity that is not finite.
    #[error("its velocity is not a finite number")]
    Velocity,
    /// Particle domain with an inner angle of 0 or of more than 180 degrees.
    #[error("its domain is turned inside out")]
    InsideOut,
    /// Cause of a specific method, in words with the remedy.
    #[error("{0}")]
    Other(&'static str),
}

/// Missing block of grid nodes at a particle.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("the grid has no block {coordinates:?}; {hint}")]
pub struct OutsideGrid {
    /// Coordinates of the block, in units of four cells.
    pub coordinates: Vec<i32>,
    /// Remedy.
    pub hint: &'static str,
}

/// Invalid scene definition.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SceneError {
    /// Points that the neighbour search rejects.
    #[error(transparent)]
    Search(#[from] SearchError),
    /// List of the wrong length.
    #[error("{field}: {found} values are not allowed; there must be one a particle, {particles}")]
    Length {
        /// Name of the list.
        field: &'static str,
        /// Length of the list.
        found: usize,
        /// Number of particles.
        particles: usize,
    },
    /// Invalid parameter of a component of a method.
    #[error("{owner}: {field} = {value} is not allowed; it must be {allowed}")]
    Parameter {
        /// Name of the component.
        owner: &'static str,
        /// Name of the parameter.
        field: &'static str,
        /// Value given.
        value: f64,
        /// Allowed values, in words.
        allowed: &'static str,
    },
    /// Particle without mass.
    #[error("particle {particle} of body `{body}` at {position:?} m has no mass: {why}")]
    NoMass {
        /// Name of the body.
        body: String,
        /// Number of the particle.
        particle: usize,
        /// Position, m.
        position: Vec<f64>,
        /// Reason and remedy.
        why: &'static str,
    },
    /// Law with a density that is not positive.
    #[error("law `{law}`: density = {density} kg/m^3 is not allowed; it must be positive and finite")]
    Density {
        /// Name of the law.
        law: &'static str,
        /// Density given, kg/m^3.
        density: f64,
    },
    /// Initial states of another law.
    #[error("states of ({there}) are not those of the law {law}")]
    OtherState {
        /// Name of the law.
        law: &'static str,
        /// State variables of the states given.
        there: String,
    },
    /// Invalid boundary condition.
    #[error(transparent)]
    Boundary(#[from] BoundaryError),
    /// Invalid time control.
    #[error(transparent)]
    Control(#[from] ControlError),
    /// Invalid threshold of the watch.
    #[error("watch: {field} = {value} is not allowed; it must be positive and finite")]
    Watch {
        /// Name of the threshold.
        field: &'static str,
        /// Value given.
        value: f64,
    },
    /// Invalid coefficient of local damping.
    #[error("local damping {0} is not allowed; it must be in [0, 1)")]
    Damping(f64),
    /// Local damping with a method whose nodes have no separate forces.
    #[error(
        "local damping needs the forces of the nodes, which `{0}` maps together with momentum; take FLIP, MUSL or USF"
    )]
    NoForces(String),
    /// Invalid criterion of rest.
    #[error("rest: {field} = {value} is not allowed; it must be positive and finite")]
    Rest {
        /// Name of the parameter.
        field: &'static str,
        /// Value given.
        value: f64,
    },
    /// Invalid number of steps between null-space filters.
    #[error("null-space filter: steps = 0 is not allowed; they must be at least 1")]
    FilterSteps,
    /// Null-space filter for velocities without a null-space part.
    #[error(
        "a null-space filter has nothing to do for `{0}`, whose velocities come from the nodes; it needs FLIP or a blend"
    )]
    NothingToFilter(String),
    /// A body whose density cannot be renewed from positions, and what is needed.
    #[error("body `{0}`: its density cannot be renewed from the positions of its particles; {1}")]
    NoRenewal(String, &'static str),
    /// Kinetic damping with a method whose nodes have no separate forces.
    #[error(
        "kinetic damping is not allowed with `{0}`, which maps momentum and impulse together; take FLIP or a blend"
    )]
    RestOfTogether(String),
    /// Kinetic damping beside a free rigid body.
    #[error("kinetic damping is not allowed with the free rigid body `{0}`; its motion must be prescribed")]
    RestOfFree(String),
    /// Feature that the method does not support.
    #[error("{what} is not allowed with `{method}`: {why}")]
    NotWith {
        /// Feature.
        what: String,
        /// Name of the method.
        method: String,
        /// Reason and alternative.
        why: &'static str,
    },
    /// Invalid region of smaller cells.
    #[error("refinement: {field} = {value} is not allowed; it must be {allowed}")]
    Refinement {
        /// Name of the field.
        field: &'static str,
        /// Value.
        value: f64,
        /// Allowed values, in words.
        allowed: &'static str,
    },
    /// Feature that needs a contact algorithm.
    #[error("{0} needs a contact algorithm, and the scene has none: make it by `Mpm::with_contact`")]
    NoContact(&'static str),
    /// Body with the kernels of another method.
    #[error("body `{body}` has the kernels of `{there}`, and the scene is one of `{here}`")]
    OtherMethod {
        /// Name of the body.
        body: String,
        /// Method of the body.
        there: String,
        /// Method of the scene.
        here: String,
    },
    /// Splitting with a law that does not store the stretch.
    #[error("body `{body}`: splitting is not allowed with the law {law}; wrap it: `Stretching::new(law)`")]
    NoStretch {
        /// Name of the body.
        body: String,
        /// Name of the law.
        law: &'static str,
    },
    /// Unknown name of a body.
    #[error("body `{body}` is not in the scene; it must be one of {bodies}")]
    NoBody {
        /// Name given.
        body: String,
        /// Names of the bodies.
        bodies: String,
    },
    /// Body to be deactivated that is not at equilibrium.
    #[error(
        "body `{body}` does not rest: {field} of particle {particle} = {value} is not allowed; it must be {allowed}"
    )]
    NotAtEquilibrium {
        /// Name of the body.
        body: String,
        /// Number of the particle.
        particle: usize,
        /// Name of the quantity.
        field: String,
        /// Value of the quantity.
        value: f64,
        /// Allowed values, in words.
        allowed: String,
    },
    /// Body to be deactivated that something other than a body may set in motion.
    #[error(
        "body `{body}` cannot rest: {what} is not allowed with it; only other bodies may set it in motion"
    )]
    Disturbed {
        /// Name of the body.
        body: String,
        /// Possible cause of motion.
        what: String,
    },
    /// Scene without bodies.
    #[error("the scene has no body to step; add one")]
    NoBodies,
    /// Body name that is empty or not unique.
    #[error("body name `{name}` is not allowed; it must be {allowed}")]
    Name {
        /// Name given.
        name: String,
        /// Allowed names, in words.
        allowed: &'static str,
    },
    /// Load or prescribed velocity that is not finite.
    #[error("{what} = {value} at t = {time:e} s is not allowed; it must be finite")]
    NotFinite {
        /// Name of the quantity.
        what: String,
        /// Value, in SI units.
        value: f64,
        /// Time, s.
        time: f64,
    },
    /// Particle behind a plane of symmetry.
    #[error(
        "body `{body}`: particle {particle} is {distance:e} m behind the plane of symmetry on axis {axis} at {at} m; it must be \
         in front of it, where matter is modelled"
    )]
    BehindSymmetry {
        /// Name of the body.
        body: String,
        /// Number of the particle.
        particle: usize,
        /// Normal axis of the plane.
        axis: usize,
        /// Position of the plane, m.
        at: f64,
        /// Distance of the particle behind the plane, m.
        distance: f64,
    },
    /// Body without particles.
    #[error("body `{0}` has no particles; its shape holds no seed: enlarge it or refine the lattice")]
    Empty(String),
    /// Particles too large for the shape function.
    #[error(
        "body `{body}`: particle half size {half} h along axis {axis} is not allowed; it must be in (0, 0.5]"
    )]
    HalfSize {
        /// Name of the body.
        body: String,
        /// Axis.
        axis: usize,
        /// Half size in units of h.
        half: f64,
    },
    /// Splitting of particles whose half sizes differ between axes.
    #[error(
        "body `{body}`: particle half size {half} h along axis {axis} is not allowed with splitting; it must be the \
         same along every axis ({first} h along the first)"
    )]
    Oblong {
        /// Name of the body.
        body: String,
        /// Axis.
        axis: usize,
        /// Half size in units of h.
        half: f64,
        /// Half size along the first axis in units of h.
        first: f64,
    },
    /// Body whose particles cannot be merged.
    #[error("body `{body}`: merging is not allowed with {what}")]
    NoMerging {
        /// Name of the body.
        body: String,
        /// Component that prevents merging.
        what: String,
    },
    /// Body outside of the grid.
    #[error("body `{0}`: {1}")]
    Outside(String, OutsideGrid),
    /// Body of revolution with a seed on or behind the axis.
    #[error(
        "body `{body}`: a seed at r = {r} m is not allowed in axisymmetric coordinates; r must be positive"
    )]
    BehindAxis {
        /// Name of the body.
        body: String,
        /// Radius, m.
        r: f64,
    },
    /// Seeds with lists of different lengths.
    #[error("body `{body}`: {volumes} volumes for {positions} positions; every seed needs one of each")]
    Unequal {
        /// Name of the body.
        body: String,
        /// Number of positions.
        positions: usize,
        /// Number of volumes.
        volumes: usize,
    },
    /// Invalid seed.
    #[error("body `{body}`, particle {particle}: {field} = {value} is not allowed; it must be {allowed}")]
    Seed {
        /// Name of the body.
        body: String,
        /// Number of the seed.
        particle: usize,
        /// Name of the quantity.
        field: &'static str,
        /// Value given.
        value: f64,
        /// Allowed values, in words.
        allowed: &'static str,
    },
    /// Invalid element.
    #[error("body `{body}`, element {element}: {field} = {value} is not allowed; it must be {allowed}")]
    Element {
        /// Name of the body.
        body: String,
        /// Number of the element.
        element: usize,
        /// Name of the quantity.
        field: &'static str,
        /// Value given.
        value: f64,
        /// Allowed values, in words.
        allowed: &'static str,
    },
    /// Invalid motion of a rigid body.
    #[error("rigid body `{body}`: {field} = {value} is not allowed; it must be {allowed}")]
    Rigid {
        /// Name of the body.
        body: String,
        /// Name of the quantity.
        field: &'static str,
        /// Value given.
        value: f64,
        /// Allowed values, in words.
        allowed: &'static str,
    },
    /// Takeover of a body with another law.
    #[error("body `{body}` has the law {there} and cannot be taken over with {here}")]
    OtherLaw {
        /// Name of the body.
        body: String,
        /// Law of the body, and its state variables.
        there: String,
        /// Law given, and its state variables.
        here: String,
    },
    /// Takeover of a body with other coordinates.
    #[error("body `{body}` is in {there} coordinates and cannot be taken over into {here} ones")]
    OtherSpace {
        /// Name of the body.
        body: String,
        /// Embedding of the body.
        there: &'static str,
        /// Embedding of the scene.
        here: &'static str,
    },
    /// Takeover of a scene with more or less than one body.
    #[error("a scene of {0} bodies cannot be added as one; it must have one")]
    NotOneBody(usize),
    /// Feature that needs nodal forces of a body with another discretisation.
    #[error(
        "{what} is not allowed beside the body `{body}`, whose forces act on another grid than that of the scene, in its reference \
         configuration or by another method"
    )]
    BesideClient {
        /// Name of the body.
        body: String,
        /// Feature.
        what: &'static str,
    },
    /// Elements, with contact by their surface, that meet a body without particles.
    #[error(
        "the elements of `{elements}` meet `{other}`, and no contact acts between them: the surface of elements is in contact with \
         particles alone; let elements act on the grid (`Elements::on_the_grid`), or compute a scene without particles by finite \
         elements (`Fem::touch`)"
    )]
    NoContactOf {
        /// Name of the body of elements.
        elements: String,
        /// Name of the other body, rigid or of elements.
        other: String,
    },
    /// Invalid initial setting of the clock.
    #[error("time = {time} s after {steps} steps is not allowed; it must be finite, and no step made")]
    Clock {
        /// Time given, s.
        time: f64,
        /// Number of steps.
        steps: u64,
    },
    /// Too many particles for their numbering.
    #[error("body `{body}`: {count} particles are too many; their numbers count up to {most}")]
    TooMany {
        /// Name of the body.
        body: String,
        /// Number of particles.
        count: usize,
        /// Largest number of particles.
        most: usize,
    },
}

/// Check that a parameter of a component `holds` and is finite, and return it.
///
/// # Errors
/// [`SceneError::Parameter`].
pub fn parameter(
    holds: bool,
    owner: &'static str,
    field: &'static str,
    value: f64,
    allowed: &'static str,
) -> Result<f64, SceneError> {
    if holds && value.is_finite() {
        Ok(value)
    } else {
        Err(SceneError::Parameter { owner, field, value, allowed })
    }
}
