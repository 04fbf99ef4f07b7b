//! Rigid bodies that the liquid moves: definition, state, motion.

use std::fmt;
use std::sync::Arc;

use impactite_geometry::{Filling, Lattice, Shape, fill};
use impactite_scene::{Archive, Body, CheckpointError, Exchange, Parts, PointView, SceneError, Totals};

use crate::error::FluidError;
use crate::options::parameter;
use crate::turn::{IDENTITY, Matrix, Motion, Pose, apply, cross, dot, inverse, rotation, times, transposed};
use crate::view::wide;

/// Velocity, m/s, and angular velocity, rad/s; or the conjugate momenta.
pub(crate) type Twist = [f64; 6];
/// Points along the edge of a cell by which a body is weighed and drawn.
const PER_AXIS: usize = 2;
/// Largest number of points of a surface along an edge of its box.
const MOST_ALONG: f64 = 64.0;

/// Rigid body that the liquid moves: shape, density, and motion at the start. Added to a scene by [`Flow::add_rigid`].
///
/// The liquid slips along it. Its velocities are unknowns of the pressure equation, so that bodies of any density, much lighter than the
/// liquid included, move with the liquid around them.
///
/// ```
/// use flow::RigidBody;
/// use impactite_geometry::Cuboid;
/// let crate_of_wood = RigidBody::new(Cuboid::new([0.4, 0.3], [0.6, 0.5])?, 500.0)?.with_spin([0.0, 0.0, 0.2]);
/// # let _ = crate_of_wood;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// [`Flow::add_rigid`]: crate::Flow::add_rigid
#[derive(Clone)]
pub struct RigidBody<const D: usize> {
    pub(crate) shape: Arc<dyn Shape<D>>,
    density: f64,
    velocity: [f64; D],
    spin: [f64; 3],
    held: [bool; 6],
}

impl<const D: usize> fmt::Debug for RigidBody<D> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let region = impactite_scene::constants::region(&*self.shape);
        write!(f, "rigid body {region}, {} kg/m^3, held {:?}", self.density, self.held)
    }
}

impl<const D: usize> RigidBody<D> {
    /// Create a body of uniform density, kg/m^3, at rest.
    ///
    /// # Errors
    /// A density that is not positive and finite; a shape without bounds.
    pub fn new(shape: impl Shape<D> + 'static, density: f64) -> Result<Self, SceneError> {
        parameter(
            density > 0.0 && density.is_finite(),
            "density of a rigid body",
            density,
            "positive and finite",
        )?;
        let bounds = shape.bounds();
        for d in 0..D {
            let size = bounds.max[d] - bounds.min[d];
            parameter(size > 0.0 && size.is_finite(), "size of a rigid body", size, "positive and finite")?;
        }
        let held = std::array::from_fn(|m| if m < 3 { m >= D } else { D == 2 && m < 5 });
        Ok(RigidBody { shape: Arc::new(shape), density, velocity: [0.0; D], spin: [0.0; 3], held })
    }
    /// Set the velocity of the centre of mass at the start, m/s.
    #[must_use]
    pub fn with_velocity(mut self, velocity: [f64; D]) -> Self {
        self.velocity = velocity;
        self
    }
    /// Set the angular velocity at the start, rad/s; about z in the plane.
    #[must_use]
    pub fn with_spin(mut self, spin: [f64; 3]) -> Self {
        self.spin = spin;
        self
    }
    /// Hold the velocity of the start along these axes.
    #[must_use]
    pub fn holding(mut self, axes: [bool; D]) -> Self {
        self.held[..D].copy_from_slice(&axes);
        self
    }
    /// Suppress the rotation.
    #[must_use]
    pub fn without_turning(mut self) -> Self {
        self.held[3..].fill(true);
        self
    }
}

/// State of a rigid body that the liquid moves.
#[derive(Clone)]
pub(crate) struct Floater<const D: usize> {
    pub name: String,
    pub body: RigidBody<D>,
    pub mass: f64,
    /// Inertia about the centre of mass at the start, kg m^2.
    inertia: Matrix,
    /// Centre of mass at the start and now, m.
    from: [f64; D],
    pub centre: [f64; D],
    turn: Matrix,
    /// Momentum, kg m/s, and angular momentum, kg m^2/s, in the middle of the last step.
    pub momentum: Twist,
    /// Velocity and angular velocity in the middle of the last step.
    pub twist: Twist,
    /// Velocities at the start of the step.
    pub start: Twist,
    /// Velocities that the pressure equation of the last step had.
    pub solved: Twist,
    /// Impulse of the walls that hold it in the step, N s and N m s.
    pub supported: Twist,
    /// Impulse of the liquid of the last step that acts in the next one, N s and N m s.
    pub pending: Twist,
    /// Impulse and work of the liquid and of contact since the start.
    pub acted: Exchange,
    /// Time from the velocities to the positions, s.
    pub lag: f64,
    /// Body force at the present time, m/s^2.
    pub force: [f64; D],
    /// Change of the momentum over time in the last step, N.
    pub momentum_rate: [f64; D],
    /// Momentum before the last step, kg m/s.
    pub before: [f64; D],
    /// Displacement of the centre in the last step, m.
    pub moved: [f64; D],
    /// Points, m, at the start, and their volumes.
    points: Arc<Vec<([f64; D], f64)>>,
    /// Points of the surface at the start, m.
    pub surface: Arc<Vec<[f64; D]>>,
    /// Largest distance of a point from the centre, m.
    pub radius: f64,
    /// True if the surface is round about the centre: liquid that slips along it has no moment.
    round: bool,
}

/// Deviation of the surface from a round one, over the radius, up to which it is round.
const ROUND: f64 = 1e-4;

impl<const D: usize> Floater<D> {
    pub fn new(name: String, body: RigidBody<D>, lattice: &Lattice<D>) -> Result<Self, FluidError> {
        let seeds = fill(&*body.shape, lattice, PER_AXIS, &Filling::new())?;
        parameter(!seeds.is_empty(), "points of a rigid body", 0.0, "at least 1: take smaller cells")?;
        for x in body.velocity.iter().chain(&body.spin) {
            parameter(x.is_finite(), "velocity of a rigid body", *x, "finite")?;
        }
        if D == 2 {
            for x in &body.spin[..2] {
                parameter(*x == 0.0, "spin of a rigid body in the plane", *x, "about z")?;
            }
        }
        let mass = body.density * seeds.measure();
        let from = body.shape.centroid().unwrap_or_else(|| seeds.centroid());
        let half = wide(&seeds.half_size);
        let mut inertia = [[0.0; 3]; 3];
        let (mut radius, mut points) = (0.0f64, Vec::new());
        for (x, v) in seeds.positions.iter().zip(&seeds.volumes) {
            let arm = wide(&std::array::from_fn::<f64, D, _>(|d| x[d] - from[d]));
            let own = half.map(|a| a * a / 3.0);
            let square = dot(&arm, &arm) + own.iter().sum::<f64>();
            for i in 0..3 {
                for j in 0..3 {
                    let product = arm[i] * arm[j] + if i == j { own[i] } else { 0.0 };
                    inertia[i][j] += body.density * v * (if i == j { square } else { 0.0 } - product);
                }
            }
            radius = radius.max(dot(&arm, &arm).sqrt() + dot(&half, &half).sqrt());
            points.push((*x, *v));
        }
        if D == 2 {
            // The axis is z.
            inertia = std::array::from_fn(|i| IDENTITY[i].map(|x| x * inertia[2][2]));
        }
        let mut twist = [0.0; 6];
        twist[..D].copy_from_slice(&body.velocity);
        twist[3..].copy_from_slice(&body.spin);
        let surface = surface_points(&*body.shape, lattice.spacing());
        let arms = surface.iter().map(|x| (0..D).map(|d| (x[d] - from[d]).powi(2)).sum::<f64>().sqrt());
        let (least, most) = arms.fold((f64::INFINITY, 0.0f64), |(a, b), arm| (a.min(arm), b.max(arm)));
        let round = most - least < ROUND * most;
        let mut made = Floater {
            name,
            body,
            mass,
            inertia,
            from,
            centre: from,
            turn: IDENTITY,
            momentum: [0.0; 6],
            twist,
            start: twist,
            solved: twist,
            supported: [0.0; 6],
            pending: [0.0; 6],
            acted: Exchange::default(),
            lag: 0.0,
            force: [0.0; D],
            momentum_rate: [0.0; D],
            before: [0.0; D],
            moved: [0.0; D],
            points: Arc::new(points),
            surface: Arc::new(surface),
            radius,
            round,
        };
        made.momentum = made.momentum_of(&twist);
        made.before = std::array::from_fn(|d| made.momentum[d]);
        Ok(made)
    }

    /// True for velocities that are held.
    pub fn held(&self) -> &[bool; 6] {
        &self.body.held
    }
    /// Place of the shape.
    pub fn pose(&self) -> Pose<D> {
        let by = std::array::from_fn(|d| self.centre[d] - self.from[d]);
        Pose { by, turn: (self.turn != IDENTITY).then_some((self.from, self.turn)) }
    }
    /// Motion by the present velocities.
    pub fn motion(&self) -> Motion<D> {
        let spin = [self.twist[3], self.twist[4], self.twist[5]];
        Motion { velocity: std::array::from_fn(|d| self.twist[d]), spin, about: self.centre }
    }
    /// Inertia about the centre, kg m^2.
    pub fn inertia(&self) -> Matrix {
        times(&times(&self.turn, &self.inertia), &transposed(&self.turn))
    }
    /// Momentum of these velocities.
    pub fn momentum_of(&self, twist: &Twist) -> Twist {
        let turn = apply(&self.inertia(), &[twist[3], twist[4], twist[5]]);
        std::array::from_fn(|m| if m < 3 { self.mass * twist[m] } else { turn[m - 3] })
    }
    /// Velocities of this momentum; those that are held stay.
    pub fn twist_of(&self, momentum: &Twist) -> Twist {
        let spin = apply(&inverse(&self.inertia()), &[momentum[3], momentum[4], momentum[5]]);
        std::array::from_fn(|m| {
            if self.body.held[m] {
                self.twist[m]
            } else if m < 3 {
                momentum[m] / self.mass
            } else {
                spin[m - 3]
            }
        })
    }
    /// Row that maps the velocities of the body to the component of the velocity along `normal` at a point; without the spin of a round
    /// body, along whose surface all slips.
    pub fn row(&self, x: &[f64; D], normal: &[f64; D]) -> Twist {
        let (normal, arm) =
            (wide(normal), wide(&std::array::from_fn::<f64, D, _>(|d| x[d] - self.centre[d])));
        let turn = if self.round { [0.0; 3] } else { cross(&arm, &normal) };
        std::array::from_fn(|m| if m < 3 { normal[m] } else { turn[m - 3] })
    }
    /// Largest speed of a point, m/s.
    pub fn speed(&self) -> f64 {
        let length = |list: &[f64]| list.iter().map(|x| x * x).sum::<f64>().sqrt();
        length(&self.twist[..3]) + length(&self.twist[3..]) * self.radius
    }
    /// Kinetic energy of the velocities in the middle of the last step, J.
    pub fn kinetic(&self) -> f64 {
        0.5 * (0..6).map(|m| self.momentum[m] * self.twist[m]).sum::<f64>()
    }
    /// Move by the velocities for `dt` seconds. The angular momentum is kept; the inertia is that of the middle of the step.
    pub fn advance(&mut self, dt: f64) {
        let spin = |twist: &Twist, dt: f64| [twist[3] * dt, twist[4] * dt, twist[5] * dt];
        let before = self.turn;
        if spin(&self.twist, 1.0) != [0.0; 3] {
            if D == 3 {
                self.turn = times(&rotation(&spin(&self.twist, 0.5 * dt)), &before);
                self.twist = self.twist_of(&self.momentum.clone());
            }
            self.turn = times(&rotation(&spin(&self.twist, dt)), &before);
        }
        for d in 0..D {
            self.moved[d] = self.twist[d] * dt;
            self.centre[d] += self.moved[d];
        }
    }

    pub fn archive(&mut self, file: &mut Archive) -> Result<(), CheckpointError> {
        file.same("name of a rigid body", &self.name)?;
        let twists = self.momentum.iter_mut().chain(&mut self.twist).chain(&mut self.pending);
        file.reals(twists.chain(&mut self.centre).chain(self.turn.iter_mut().flatten()))?;
        file.reals(
            self.force
                .iter_mut()
                .chain(&mut self.momentum_rate)
                .chain(&mut self.moved)
                .chain(&mut self.before),
        )?;
        file.reals([&mut self.lag])?;
        self.acted.archive(file)
    }
}

/// Points of a surface about a quarter of a cell apart: nodes of a lattice near it, moved along the slope of the distance.
fn surface_points<const D: usize>(shape: &dyn Shape<D>, h: f64) -> Vec<[f64; D]> {
    let bounds = shape.bounds();
    let size: [f64; D] = std::array::from_fn(|d| bounds.max[d] - bounds.min[d]);
    let width = size.iter().fold(0.25 * h, |width, s| width.max(s / MOST_ALONG));
    let counts: [usize; D] = std::array::from_fn(|d| (size[d] / width).ceil() as usize + 2);
    let mut points = Vec::new();
    for n in 0..counts.iter().product() {
        let mut rest: usize = n;
        let mut x: [f64; D] = std::array::from_fn(|d| {
            let at = rest % counts[d];
            rest /= counts[d];
            let middle = 0.5 * (bounds.min[d] + bounds.max[d]);
            middle + (at as f64 - 0.5 * (counts[d] - 1) as f64) * width
        });
        if shape.signed_distance(x).abs() > width {
            continue;
        }
        for _ in 0..4 {
            let distance = shape.signed_distance(x);
            let slope = slope(&|x| shape.signed_distance(x), &x, 1e-4 * width);
            let square: f64 = slope.iter().map(|s| s * s).sum();
            if square > 1e-6 {
                (0..D).for_each(|d| x[d] -= distance * slope[d] / square);
            }
        }
        if shape.signed_distance(x).abs() < 0.01 * width {
            points.push(x);
        }
    }
    points
}

/// Slope of a distance by central differences over `by`, m, to both sides.
pub(crate) fn slope<const D: usize>(distance: &dyn Fn([f64; D]) -> f64, x: &[f64; D], by: f64) -> [f64; D] {
    std::array::from_fn(|d| {
        let at = |by: f64| {
            let mut y = *x;
            y[d] += by;
            distance(y)
        };
        (at(by) - at(-by)) / (2.0 * by)
    })
}

impl<const D: usize> Body for Floater<D> {
    fn name(&self) -> &str {
        &self.name
    }
    fn law(&self) -> &'static str {
        "rigid body"
    }
    fn len(&self) -> usize {
        self.points.len()
    }
    fn state_names(&self) -> Vec<String> {
        Vec::new()
    }
    fn given_by_others(&self) -> Option<Exchange> {
        Some(self.acted)
    }
    /// Sums of the body as a whole, as those of the liquid: velocities are those of the middle of the last step.
    fn totals(&self) -> Totals {
        let mut sum = Totals::default();
        let velocity: [f64; D] = std::array::from_fn(|d| self.twist[d]);
        sum.add_point(self.mass, &self.centre, &velocity);
        sum.particles = self.points.len();
        (0..3).for_each(|k| sum.angular_momentum[k] += self.momentum[3 + k]);
        sum.kinetic = self.kinetic();
        let mut square = 0.0;
        for d in 0..D {
            sum.kinetic += self.lag * self.force[d] * sum.momentum[d];
            sum.staggered.momentum[d] = self.lag * self.momentum_rate[d];
            square += self.momentum_rate[d] * self.momentum_rate[d] / self.mass;
        }
        sum.kinetic += 0.5 * self.lag * self.lag * square;
        sum
    }
    fn for_each(&self, visit: &mut dyn FnMut(&PointView)) {
        self.for_each_with(Parts::ALL, visit);
    }
    fn for_each_with(&self, _: Parts, visit: &mut dyn FnMut(&PointView)) {
        let (pose, motion) = (self.pose(), self.motion());
        let mut point = PointView { in_range: true, ..PointView::default() };
        for (n, (x, volume)) in self.points.iter().enumerate() {
            let place = pose.there(x);
            point.number = n;
            point.position = wide(&place);
            point.velocity = wide(&std::array::from_fn::<f64, D, _>(|d| motion.component(&place, d)));
            point.mass = self.body.density * volume;
            point.volume = *volume;
            visit(&point);
        }
    }
    fn bytes(&self) -> usize {
        size_of::<([f64; D], f64)>() * self.points.capacity()
            + size_of::<[f64; D]>() * self.surface.capacity()
    }
}
