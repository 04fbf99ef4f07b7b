//! What a scene is refused for, and what stops a step, of any method.

use impactite_geometry::search::SearchError;
use mpm_materials::Breakdown;

use crate::boundary::BoundaryError;
use crate::control::ControlError;
use crate::finding::Finding;

/// A step that could not be made. The run stands where the step broke off.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("step {step} at t = {time:.6e} s: {what}")]
pub struct StepError {
    /// Number of the step.
    pub step: u64,
    /// Time at its start, s.
    pub time: f64,
    /// What stopped it.
    pub what: Stopped,
}

/// What stops a step.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Stopped {
    /// A point cannot go on.
    #[error("{kind} {number} of body `{body}` (law: {law}) near {position:?} m: {cause}")]
    Point {
        /// What has the number.
        kind: PointKind,
        /// Its body.
        body: String,
        /// Its number.
        number: usize,
        /// Its position, m.
        position: [f64; 3],
        /// The body's law.
        law: &'static str,
        /// What happened.
        cause: Cause,
    },
    /// A particle came to where the grid has no nodes.
    #[error("particle {particle} of body `{body}` (law: {law}) at {position:?} m leaves the grid: {outside}")]
    Outside {
        /// Its body.
        body: String,
        /// Its number.
        particle: usize,
        /// Its position, m.
        position: [f64; 3],
        /// The body's law.
        law: &'static str,
        /// Which nodes there are none of.
        outside: Box<OutsideGrid>,
    },
    /// A rigid body is told to move as none can, or the scene became one that cannot be.
    #[error(transparent)]
    Scene(SceneError),
    /// A time that the clock cannot follow.
    #[error("{field} = {value:e} s is not allowed; it must be {allowed} (now t = {now:e} s)")]
    Clock {
        /// What was given.
        field: &'static str,
        /// Its value, s.
        value: f64,
        /// What is allowed, in words.
        allowed: &'static str,
        /// The time reached, s.
        now: f64,
    },
    /// The wave speeds give no usable time step.
    #[error(
        "the time step became {0} s: a wave speed is infinite, zero or not a number, or all bodies are rigid; check the constants of the \
         materials, or fix the step (`TimeControl::Fixed`)"
    )]
    NoTimeStep(f64),
    /// The step was made, but the run is no longer to be trusted ([`crate::watch`]).
    #[error("{0}")]
    Watch(Box<Finding>),
}

/// What has a number in a body.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum PointKind {
    /// A particle.
    Particle,
    /// An element.
    Element,
    /// A cell of a body that is divided into such.
    Cell,
    /// A node of elements.
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

/// What happens to points.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Cause {
    /// Its law broke down.
    #[error("{0}")]
    Law(Breakdown),
    /// It would move further than one cell in a step, or its velocity is not a number.
    #[error("it would move more than one cell in the step, or its velocity is not a finite number")]
    TooFast,
    /// Its velocity is not a number.
    #[error("its velocity is not a finite number")]
    Velocity,
    /// Its domain has a corner of no angle, or of more than a straight one.
    #[error("its domain is turned inside out")]
    InsideOut,
    /// What else a method finds, in words with the remedy.
    #[error("{0}")]
    Other(&'static str),
}

/// A particle came to where the grid has no nodes.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("the grid has no block {coordinates:?}; {hint}")]
pub struct OutsideGrid {
    /// Coordinates of the block, in units of four cells.
    pub coordinates: Vec<i32>,
    /// What to do.
    pub hint: &'static str,
}

/// A scene that cannot be.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SceneError {
    /// Points that no search for neighbours can use.
    #[error(transparent)]
    Search(#[from] SearchError),
    /// A list of the wrong length.
    #[error("{field}: {found} values are not allowed; there must be one a particle, {particles}")]
    Length {
        /// Which list.
        field: &'static str,
        /// Its length.
        found: usize,
        /// The number of particles.
        particles: usize,
    },
    /// A parameter of a part of a method.
    #[error("{owner}: {field} = {value} is not allowed; it must be {allowed}")]
    Parameter {
        /// The part.
        owner: &'static str,
        /// The parameter.
        field: &'static str,
        /// Its value.
        value: f64,
        /// What is allowed.
        allowed: &'static str,
    },
    /// A point without mass.
    #[error("particle {particle} of body `{body}` at {position:?} m has no mass: {why}")]
    NoMass {
        /// The body.
        body: String,
        /// Which.
        particle: usize,
        /// Where, m.
        position: Vec<f64>,
        /// Why, and what to do.
        why: &'static str,
    },
    /// A law whose density is not positive.
    #[error("law `{law}`: density = {density} kg/m^3 is not allowed; it must be positive and finite")]
    Density {
        /// The law.
        law: &'static str,
        /// Its density.
        density: f64,
    },
    /// States of another law.
    #[error("states of ({there}) are not those of the law {law}")]
    OtherState {
        /// The law.
        law: &'static str,
        /// The numbers of the states given.
        there: String,
    },
    /// A boundary.
    #[error(transparent)]
    Boundary(#[from] BoundaryError),
    /// The time control.
    #[error(transparent)]
    Control(#[from] ControlError),
    /// A limit of the watch.
    #[error("watch: {field} = {value} is not allowed; it must be positive and finite")]
    Watch {
        /// Which.
        field: &'static str,
        /// The number given.
        value: f64,
    },
    /// A coefficient of local damping.
    #[error("local damping {0} is not allowed; it must be in [0, 1)")]
    Damping(f64),
    /// Damping of forces that the nodes do not know.
    #[error(
        "local damping needs the forces of the nodes, which `{0}` maps together with momentum; take FLIP, MUSL or USF"
    )]
    NoForces(String),
    /// What counts as rest.
    #[error("rest: {field} = {value} is not allowed; it must be positive and finite")]
    Rest {
        /// Which number.
        field: &'static str,
        /// What was given.
        value: f64,
    },
    /// Steps between filters.
    #[error("null-space filter: steps = 0 is not allowed; they must be at least 1")]
    FilterSteps,
    /// A filter of velocities that hide nothing.
    #[error(
        "a null-space filter has nothing to do for `{0}`, whose velocities come from the nodes; it needs FLIP or a blend"
    )]
    NothingToFilter(String),
    /// Kinetic damping of a method whose nodes know no forces.
    #[error(
        "kinetic damping is not allowed with `{0}`, which maps momentum and impulse together; take FLIP or a blend"
    )]
    RestOfTogether(String),
    /// Kinetic damping beside a free rigid body.
    #[error("kinetic damping is not allowed with the free rigid body `{0}`; its motion must be prescribed")]
    RestOfFree(String),
    /// What the method of the scene cannot do.
    #[error("{what} is not allowed with `{method}`: {why}")]
    NotWith {
        /// What was asked for.
        what: String,
        /// The method.
        method: String,
        /// Why not, and what to do.
        why: &'static str,
    },
    /// What only bodies that are kept apart can do.
    #[error("{0} needs a contact algorithm, and the scene has none: make it by `Mpm::with_contact`")]
    NoContact(&'static str),
    /// A body whose kernels are those of another method.
    #[error("body `{body}` has the kernels of `{there}`, and the scene is one of `{here}`")]
    OtherMethod {
        /// The body.
        body: String,
        /// Its method.
        there: String,
        /// That of the scene.
        here: String,
    },
    /// A law that does not keep what splitting asks for.
    #[error("body `{body}`: splitting is not allowed with the law {law}; wrap it: `Stretching::new(law)`")]
    NoStretch {
        /// The body.
        body: String,
        /// Its law.
        law: &'static str,
    },
    /// No body of this name.
    #[error("body `{body}` is not in the scene; it must be one of {bodies}")]
    NoBody {
        /// The name given.
        body: String,
        /// Those there are.
        bodies: String,
    },
    /// A body that is to rest, and does not.
    #[error(
        "body `{body}` does not rest: {field} of particle {particle} = {value} is not allowed; it must be {allowed}"
    )]
    NotAtEquilibrium {
        /// The body.
        body: String,
        /// Number of the particle.
        particle: usize,
        /// Which number of it.
        field: String,
        /// What it is.
        value: f64,
        /// What is allowed, in words.
        allowed: String,
    },
    /// A body that is to rest where something may set it in motion.
    #[error(
        "body `{body}` cannot rest: {what} is not allowed with it; only other bodies may set it in motion"
    )]
    Disturbed {
        /// The body.
        body: String,
        /// What may move it.
        what: String,
    },
    /// A scene without bodies.
    #[error("the scene has no body to step; add one")]
    NoBodies,
    /// A name that tells a body from no other.
    #[error("body name `{name}` is not allowed; it must be {allowed}")]
    Name {
        /// The name given.
        name: String,
        /// What is allowed, in words.
        allowed: &'static str,
    },
    /// A load or a prescribed velocity that is no number.
    #[error("{what} = {value} at t = {time:e} s is not allowed; it must be finite")]
    NotFinite {
        /// Which.
        what: String,
        /// Its value, in SI units.
        value: f64,
        /// When, s.
        time: f64,
    },
    /// Matter where the image of other matter is.
    #[error(
        "body `{body}`: particle {particle} is {distance:e} m behind the plane of symmetry on axis {axis} at {at} m; it must be \
         in front of it, where matter is modelled"
    )]
    BehindSymmetry {
        /// The body.
        body: String,
        /// Number of the particle.
        particle: usize,
        /// Normal axis of the plane.
        axis: usize,
        /// Where the plane is, m.
        at: f64,
        /// How far behind it the particle is, m.
        distance: f64,
    },
    /// A body without particles.
    #[error("body `{0}` has no particles; its shape holds no seed: enlarge it or refine the lattice")]
    Empty(String),
    /// A body's particles are too large for the shape function.
    #[error(
        "body `{body}`: particle half size {half} h along axis {axis} is not allowed; it must be in (0, 0.5]"
    )]
    HalfSize {
        /// The body.
        body: String,
        /// The axis.
        axis: usize,
        /// Half size in units of h.
        half: f64,
    },
    /// Particles that are to be split are not as long as they are wide.
    #[error(
        "body `{body}`: particle half size {half} h along axis {axis} is not allowed with splitting; it must be the \
         same along every axis ({first} h along the first)"
    )]
    Oblong {
        /// The body.
        body: String,
        /// The axis.
        axis: usize,
        /// Half size in units of h.
        half: f64,
        /// Half size along the first axis.
        first: f64,
    },
    /// Particles that cannot be merged.
    #[error("body `{body}`: merging is not allowed with {what}")]
    NoMerging {
        /// The body.
        body: String,
        /// What has none.
        what: String,
    },
    /// A body reaches outside the grid.
    #[error("body `{0}`: {1}")]
    Outside(String, OutsideGrid),
    /// A body of revolution across its axis.
    #[error(
        "body `{body}`: a seed at r = {r} m is not allowed in axisymmetric coordinates; r must be positive"
    )]
    BehindAxis {
        /// The body.
        body: String,
        /// Radius, m.
        r: f64,
    },
    /// Seeds whose lists differ in length.
    #[error("body `{body}`: {volumes} volumes for {positions} positions; every seed needs one of each")]
    Unequal {
        /// The body.
        body: String,
        /// Number of positions.
        positions: usize,
        /// Number of volumes.
        volumes: usize,
    },
    /// A seed that cannot become a particle.
    #[error("body `{body}`, particle {particle}: {field} = {value} is not allowed; it must be {allowed}")]
    Seed {
        /// The body.
        body: String,
        /// Number of the seed.
        particle: usize,
        /// Which number.
        field: &'static str,
        /// What was given.
        value: f64,
        /// What is allowed, in words.
        allowed: &'static str,
    },
    /// An element that cannot be.
    #[error("body `{body}`, element {element}: {field} = {value} is not allowed; it must be {allowed}")]
    Element {
        /// The body.
        body: String,
        /// Number of the element.
        element: usize,
        /// Which number of it.
        field: &'static str,
        /// What was given.
        value: f64,
        /// What is allowed, in words.
        allowed: &'static str,
    },
    /// A rigid body that moves as none can.
    #[error("rigid body `{body}`: {field} = {value} is not allowed; it must be {allowed}")]
    Rigid {
        /// The body.
        body: String,
        /// Which number.
        field: &'static str,
        /// What was given.
        value: f64,
        /// What is allowed, in words.
        allowed: &'static str,
    },
    /// A body of another law is to be taken over.
    #[error("body `{body}` has the law {there} and cannot be taken over with {here}")]
    OtherLaw {
        /// The body.
        body: String,
        /// Its law, and what that keeps.
        there: String,
        /// The law given, likewise.
        here: String,
    },
    /// A body of other coordinates is to be taken over.
    #[error("body `{body}` is in {there} coordinates and cannot be taken over into {here} ones")]
    OtherSpace {
        /// The body.
        body: String,
        /// Its embedding.
        there: &'static str,
        /// That of the scene.
        here: &'static str,
    },
    /// A scene to be added as a body has not just one.
    #[error("a scene of {0} bodies cannot be added as one; it must have one")]
    NotOneBody(usize),
    /// What asks the nodes for the forces of a body of another discretisation.
    #[error(
        "{what} is not allowed beside the body `{body}`, whose forces act on another grid than that of the scene, in its reference \
         configuration or by another method"
    )]
    BesideClient {
        /// The body.
        body: String,
        /// What is not allowed.
        what: &'static str,
    },
    /// A clock that cannot be set.
    #[error("time = {time} s after {steps} steps is not allowed; it must be finite, and no step made")]
    Clock {
        /// The time given, s.
        time: f64,
        /// Steps made.
        steps: u64,
    },
    /// More particles than their numbers can count.
    #[error("body `{body}`: {count} particles are too many; their numbers count up to {most}")]
    TooMany {
        /// The body.
        body: String,
        /// How many.
        count: usize,
        /// How many there may be.
        most: usize,
    },
}

/// Refuse a parameter of a part of a method unless it `holds` and is finite.
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
