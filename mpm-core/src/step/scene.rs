//! What a scene is refused for.

use super::control::ControlError;
use crate::boundary::BoundaryError;
use crate::grid::OutsideGrid;

/// A scene that cannot be.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SceneError {
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
    Restless {
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
    #[error("the scene has no body to step; add one (`Mpm::add`)")]
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
    /// What asks the nodes for the forces of a body that is mapped in its reference configuration.
    #[error("{what} is not allowed beside the body `{body}`, which is mapped in its reference configuration")]
    BesideReference {
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
    /// More particles than their numbers can count in this precision.
    #[error(
        "body `{body}`: {count} particles are too many; numbers are exact up to {most} in this precision"
    )]
    TooMany {
        /// The body.
        body: String,
        /// How many.
        count: usize,
        /// How many there may be.
        most: usize,
    },
}
