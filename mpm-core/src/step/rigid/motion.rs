//! Rigid bodies with prescribed motion, or free and driven by the impulses on their nodes.
//!
//! A rigid body is seeded with particles as any other, and is in contact with others at shared nodes. Its nodes start every
//! step with the rigid velocity, V + omega x (x - c), and the mass that the particles map. Impulses J_i of boundaries, body
//! forces and contact on the nodes move the body as a whole:
//!
//! M dV = sum_i J_i, dL = sum_i (x_i - c) x J_i, omega = I^-1 L,
//!
//! with mass and inertia of the particles as boxes, and the orientation rotated by the mid-step spin (second order; L is
//! exact). Contact solves all nodes of free bodies together ([`crate::ContactAlgorithm::couple`]), so that a body acts on
//! others with its full mass, and exchanges momentum and angular momentum exactly. Walls, fixed planes and symmetry planes
//! are part of that solution: they act on the body's surface (`planes`). Other conditions act on its nodes, each with its
//! share of the mass. A body with prescribed motion is part of the surroundings, of infinite mass: its impulses on others
//! are recorded like those of a wall, and its own momentum and energy are not counted.

use std::sync::Arc;

use mpm_materials::{Check, ParameterError};
use nalgebra::{Matrix3, Rotation3, SymmetricEigen, Vector3};

use super::surface::Surface;
use impactite_geometry::Seeds;
use impactite_scene::error::SceneError;

/// Velocity and angular velocity of a rigid body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Twist<const D: usize> {
    /// Velocity of the centre of rotation, m/s.
    pub velocity: [f64; D],
    /// Angular velocity, rad/s; along z in two dimensions.
    pub spin: [f64; 3],
}

impl<const D: usize> Twist<D> {
    /// Create a motion without spin.
    #[must_use]
    pub fn along(velocity: [f64; D]) -> Self {
        Twist { velocity, spin: [0.0; 3] }
    }
}

type Prescribed<const D: usize> = Arc<dyn Fn(f64) -> Twist<D> + Send + Sync>;

/// Definition of a rigid body: density and motion. Added to a scene by [`crate::Mpm::add_rigid`].
///
/// ```
/// use mpm_core::{Rigid, Twist};
/// // A steel ball that spins, and a plate that swings along y with 5 mm and 20 Hz.
/// let ball = Rigid::<3>::free(7850.0)?.with_velocity([0.0, -10.0, 0.0]).with_spin([0.0, 0.0, 30.0]);
/// let w = std::f64::consts::TAU * 20.0;
/// let plate = Rigid::<3>::prescribed(7850.0, move |t| Twist::along([0.0, 0.005 * w * (w * t).cos(), 0.0]))?;
/// # Ok::<(), mpm_materials::ParameterError>(())
/// ```
#[derive(Clone)]
pub struct Rigid<const D: usize> {
    density: f64,
    start: Twist<D>,
    prescribed: Option<Prescribed<D>>,
    held: [bool; 6],
    about: Option<[f64; D]>,
}

impl<const D: usize> std::fmt::Debug for Rigid<D> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let kind = if self.prescribed.is_some() { "prescribed" } else { "free" };
        write!(f, "Rigid({kind}, {} kg/m^3, {:?})", self.density, self.start)
    }
}

impl<const D: usize> Rigid<D> {
    /// Create a free body of this density, kg/m^3, at rest.
    ///
    /// # Errors
    /// A density that is not positive.
    pub fn free(density: f64) -> Result<Self, ParameterError> {
        let density = Check("rigid body").positive("density", density)?;
        let start = Twist { velocity: [0.0; D], spin: [0.0; 3] };
        Ok(Rigid { density, start, prescribed: None, held: [false; 6], about: None })
    }
    /// Create a body with prescribed `motion` over time, s, independent of contact. It rotates about its centre of mass, or
    /// [`Rigid::about`] a point. The density, kg/m^3, sets the nodal masses for contact normals.
    ///
    /// # Errors
    /// A density that is not positive.
    pub fn prescribed(
        density: f64,
        motion: impl Fn(f64) -> Twist<D> + Send + Sync + 'static,
    ) -> Result<Self, ParameterError> {
        Ok(Rigid { prescribed: Some(Arc::new(motion)), ..Rigid::free(density)? })
    }
    /// Set the initial velocity of a free body, m/s.
    #[must_use]
    pub fn with_velocity(mut self, velocity: [f64; D]) -> Self {
        self.start.velocity = velocity;
        self
    }
    /// Set the initial angular velocity of a free body, rad/s; along z in two dimensions.
    #[must_use]
    pub fn with_spin(mut self, spin: [f64; 3]) -> Self {
        self.start.spin = spin;
        self
    }
    /// Constrain a free body along these axes: it keeps its initial velocity there.
    #[must_use]
    pub fn holding(mut self, axes: [bool; D]) -> Self {
        self.held[..D].copy_from_slice(&axes);
        self
    }
    /// Suppress the rotation of a free body.
    #[must_use]
    pub fn without_turning(mut self) -> Self {
        self.held[3..].fill(true);
        self
    }
    /// Set the centre of rotation of a body with prescribed motion, m, by its initial position.
    #[must_use]
    pub fn about(mut self, point: [f64; D]) -> Self {
        self.about = Some(point);
        self
    }
    pub(in crate::step) fn is_prescribed(&self) -> bool {
        self.prescribed.is_some()
    }
    pub(in crate::step) fn density(&self) -> f64 {
        self.density
    }
}

/// Motion of a rigid body in the current step.
#[derive(Clone, Copy, Debug)]
pub(in crate::step) struct Step {
    /// Displacement of the centre, m.
    pub(in crate::step) way: Vector3<f64>,
    /// Rotation matrix minus identity.
    pub(in crate::step) turn: Matrix3<f64>,
    pub(in crate::step) velocity: Vector3<f64>,
    pub(in crate::step) spin: Vector3<f64>,
    pub(in crate::step) per_dt: f64,
}

/// Position and motion of a rigid body.
#[derive(Clone)]
pub struct RigidState<const D: usize> {
    pub(in crate::step) prescribed: Option<Prescribed<D>>,
    pub(in crate::step) held: [bool; 6],
    pub(in crate::step) mass: f64,
    /// Inertia in the initial frame, kg m^2.
    pub(in crate::step) inertia: Matrix3<f64>,
    pub(in crate::step) centre: Vector3<f64>,
    pub(in crate::step) rotation: Rotation3<f64>,
    pub(in crate::step) velocity: Vector3<f64>,
    pub(in crate::step) angular_momentum: Vector3<f64>,
    pub(in crate::step) spin: Vector3<f64>,
    pub(in crate::step) force: Vector3<f64>,
    pub(in crate::step) step: Step,
    /// Inverse inertia: from angular momentum to spin.
    pub(in crate::step) inverse: Matrix3<f64>,
    /// Surface of a free body.
    pub(in crate::step) surface: Option<Arc<Surface>>,
}

fn wide<const D: usize>(x: &[f64; D]) -> Vector3<f64> {
    let mut v = Vector3::zeros();
    v.as_mut_slice()[..D].copy_from_slice(x);
    v
}

impl<const D: usize> RigidState<D> {
    /// Create the state of a body from its seeds.
    pub(in crate::step) fn new(
        name: &str,
        rigid: &Rigid<D>,
        seeds: &Seeds<D>,
        hoop: bool,
    ) -> Result<Self, SceneError> {
        let refuse = |field, value, allowed| SceneError::Rigid { body: name.into(), field, value, allowed };
        let mut held = rigid.held;
        for axis in 0..6 {
            held[axis] |= match axis {
                0 => hoop,
                1 => false,
                2 => D == 2,
                5 => hoop,
                _ => D == 2,
            };
        }
        let start = rigid.prescribed.as_ref().map_or(rigid.start, |motion| motion(0.0));
        check(name, &start, hoop)?;
        if let Some(&x) = rigid.about.iter().flatten().find(|x| !x.is_finite()) {
            return Err(refuse("point to turn about", x, "finite"));
        }
        let mass: f64 = seeds.volumes.iter().map(|v| rigid.density * v).sum();
        let points = || seeds.positions.iter().zip(&seeds.volumes).map(|(x, v)| (wide(x), rigid.density * v));
        let mut centre = points().fold(Vector3::zeros(), |sum, (x, m)| sum + x * (m / mass));
        if hoop {
            centre[0] = 0.0;
        }
        let half = wide(&seeds.half_size);
        let own = half.component_mul(&half) / 3.0;
        let mut inertia = Matrix3::zeros();
        for (x, m) in points() {
            let r = x - centre;
            let second = r * r.transpose() + Matrix3::from_diagonal(&own);
            inertia += (Matrix3::identity() * second.trace() - second) * m;
        }
        let surface = rigid.prescribed.is_none().then(|| {
            let points = seeds.positions.iter().map(|x| wide(x) - centre).collect();
            Arc::new(Surface::new(points, half, (D, hoop)))
        });
        if rigid.prescribed.is_some() {
            centre = rigid.about.as_ref().map_or(centre, wide);
        }
        let spin = Vector3::from(start.spin);
        let still = Step {
            way: Vector3::zeros(),
            turn: Matrix3::zeros(),
            velocity: Vector3::zeros(),
            spin,
            per_dt: 0.0,
        };
        let mut state = RigidState {
            prescribed: rigid.prescribed.clone(),
            held,
            mass,
            inertia,
            centre,
            rotation: Rotation3::identity(),
            velocity: wide(&start.velocity),
            angular_momentum: inertia * spin,
            spin,
            force: Vector3::zeros(),
            step: still,
            inverse: Matrix3::zeros(),
            surface,
        };
        state.inverse = state.inverse_of(&state.rotation);
        let moves = |v: &Vector3<f64>| v.iter().all(|x| x.is_finite());
        if !(mass.is_normal() && state.inverse.iter().all(|x| x.is_finite())) {
            return Err(refuse(
                "density",
                rigid.density,
                "such that mass and inertia are neither 0 nor infinite",
            ));
        }
        if !(moves(&state.angular_momentum) && state.kinetic().is_finite()) {
            let fastest = start.velocity.iter().chain(&start.spin).fold(0.0f64, |a, x| a.max(x.abs()));
            return Err(refuse("velocity or spin", fastest, "such that its energy is finite"));
        }
        Ok(state)
    }

    /// Return true if the motion is prescribed.
    pub fn is_prescribed(&self) -> bool {
        self.prescribed.is_some()
    }
    /// Mass, kg (per metre of depth or radian in two dimensions).
    pub fn mass(&self) -> f64 {
        self.mass
    }
    /// Position of the centre of mass, or of the centre of rotation of a prescribed motion, m.
    pub fn centre(&self) -> [f64; 3] {
        self.centre.into()
    }
    /// Velocity of the centre, m/s.
    pub fn velocity(&self) -> [f64; 3] {
        self.velocity.into()
    }
    /// Angular velocity, rad/s.
    pub fn spin(&self) -> [f64; 3] {
        self.spin.into()
    }
    /// Angular momentum about the centre of mass, kg m^2/s.
    pub fn angular_momentum(&self) -> [f64; 3] {
        self.angular_momentum.into()
    }
    /// Rotation matrix relative to the initial orientation, by rows.
    pub fn rotation(&self) -> [[f64; 3]; 3] {
        let r = self.rotation.matrix();
        std::array::from_fn(|i| std::array::from_fn(|j| r[(i, j)]))
    }
    /// Force of boundaries, body forces and contact on a free body in the last step, N.
    pub fn force(&self) -> [f64; 3] {
        self.force.into()
    }
    /// Return the moment about the centre of an impulse at a point, N m s.
    pub fn moment(&self, at: &[f64; D], impulse: &[f64; 3]) -> [f64; 3] {
        (wide(at) - self.centre).cross(&Vector3::from(*impulse)).into()
    }
    /// Return the velocity change, m/s, of the body at the point `seen` by an impulse, N s, and a moment about the centre,
    /// N m s.
    pub fn response(&self, impulse: &[f64; 3], moment: &[f64; 3], seen: &[f64; D]) -> [f64; 3] {
        let impulse = Vector3::from(*impulse);
        let spin = self.inverse * Vector3::from(*moment);
        let mut velocity = impulse / self.mass;
        (0..3).filter(|&d| self.held[d]).for_each(|d| velocity[d] = 0.0);
        (velocity + spin.cross(&(wide(seen) - self.centre))).into()
    }
    /// Return the least effective mass of the body for an impulse at a point, kg.
    pub fn least_mass(&self, at: &[f64; D]) -> f64 {
        let columns = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let response = |e: [f64; 3]| Vector3::from(self.response(&e, &self.moment(at, &e), at));
        let per_mass = Matrix3::from_columns(&columns.map(response));
        // The trace is a bound, if the eigenvalue solver does not converge.
        let largest = SymmetricEigen::try_new(per_mass, f64::EPSILON, 100);
        1.0 / largest.map_or(per_mass.trace(), |all| all.eigenvalues.max())
    }
    /// Kinetic energy, J.
    pub fn kinetic(&self) -> f64 {
        0.5 * self.mass * self.velocity.norm_squared() + 0.5 * self.spin.dot(&self.angular_momentum)
    }
    /// Velocity of the body at a point, m/s.
    pub fn velocity_at(&self, x: &[f64; D]) -> [f64; 3] {
        (self.velocity + self.spin.cross(&(wide(x) - self.centre))).into()
    }

    /// Return the mean velocity of the body's material at a point in this step, m/s: displacement over dt.
    pub(in crate::step) fn mean_velocity(&self, x: &[f64; D]) -> [f64; 3] {
        ((self.step.way + self.step.turn * (wide(x) - self.centre)) * self.step.per_dt).into()
    }
    /// Return the acceleration of the body's material at a point, m/s^2.
    pub(in crate::step) fn acceleration(&self, x: &[f64; D]) -> [f64; 3] {
        let (step, r) = (&self.step, wide(x) - self.centre);
        let then = step.velocity + step.spin.cross(&(r + step.turn * r));
        ((then - self.velocity - self.spin.cross(&r)) * step.per_dt).into()
    }

    /// Compute the step of a body with prescribed motion.
    pub(in crate::step) fn plan(
        &mut self,
        name: &str,
        time: f64,
        dt: f64,
        hoop: bool,
    ) -> Result<(), SceneError> {
        let Some(motion) = &self.prescribed else { return Ok(()) };
        let at = [motion(time), motion(time + 0.5 * dt), motion(time + dt)];
        for twist in &at {
            check(name, twist, hoop)?;
            turns(&(Vector3::from(twist.spin) * dt)).map_err(|wrong| {
                let Wrong { field, value, allowed } = wrong;
                SceneError::Rigid { body: name.into(), field, value, allowed }
            })?;
        }
        // Simpson's rule.
        let mean = |of: fn(&Twist<D>) -> Vector3<f64>| (of(&at[0]) + 4.0 * of(&at[1]) + of(&at[2])) / 6.0;
        let (velocity, spin) = (mean(|t| wide(&t.velocity)), mean(|t| Vector3::from(t.spin)));
        self.velocity = wide(&at[0].velocity);
        self.spin = Vector3::from(at[0].spin);
        self.step = Step {
            way: velocity * dt,
            turn: turn(&(spin * dt)).matrix() - Matrix3::identity(),
            velocity: wide(&at[2].velocity),
            spin: Vector3::from(at[2].spin),
            per_dt: 1.0 / dt,
        };
        Ok(())
    }

    /// Compute the step of a free body from the impulse on it, N s, and its moment about the centre, N m s. Returns the
    /// impulse of the constraints, N s.
    ///
    /// # Errors
    /// A quantity that is not finite, or a rotation by pi or more.
    pub(in crate::step) fn push(
        &mut self,
        impulse: [f64; 3],
        moment: [f64; 3],
        dt: f64,
    ) -> Result<[f64; 3], Wrong> {
        finite("impulse on its nodes", &impulse)?;
        finite("moment of the impulses on its nodes", &moment)?;
        let (mut impulse, moment) = (Vector3::from(impulse), Vector3::from(moment));
        let mut holding = Vector3::zeros();
        for d in (0..3).filter(|&d| self.held[d]) {
            holding[d] = -impulse[d];
            impulse[d] = 0.0;
        }
        self.force = impulse / dt;
        self.angular_momentum += moment;
        let velocity = self.velocity + impulse / self.mass;
        let before = self.inverse * self.angular_momentum;
        let middle = self.inverse_of(&(turn(&(before * (0.5 * dt))) * self.rotation)) * self.angular_momentum;
        turns(&(middle * dt))?;
        let turned = turn(&(middle * dt));
        let spin = self.inverse_of(&(turned * self.rotation)) * self.angular_momentum;
        self.step = Step {
            way: velocity * dt,
            turn: turned.matrix() - Matrix3::identity(),
            velocity,
            spin,
            per_dt: 1.0 / dt,
        };
        finite("velocity", velocity.as_slice())?;
        finite("spin", spin.as_slice())?;
        Ok(holding.into())
    }

    /// Apply the step to position, orientation and velocities.
    pub(in crate::step) fn advance(&mut self) {
        self.centre += self.step.way;
        self.rotation =
            Rotation3::from_matrix_unchecked((Matrix3::identity() + self.step.turn) * self.rotation.matrix());
        // One step of Newton's method for the nearest rotation: the remaining error is the square of the initial one.
        let r = *self.rotation.matrix();
        let nearest = r * (Matrix3::identity() * 3.0 - r.transpose() * r) * 0.5;
        self.rotation = Rotation3::from_matrix_unchecked(nearest);
        self.velocity = self.step.velocity;
        self.spin = self.step.spin;
        self.inverse = self.inverse_of(&self.rotation);
        if self.prescribed.is_none() && self.held[3..] != [false; 3] {
            // Rotation constraints absorb their share of the angular momentum.
            self.angular_momentum = self.inertia_of(&self.rotation) * self.spin;
        }
    }

    fn inertia_of(&self, rotation: &Rotation3<f64>) -> Matrix3<f64> {
        let r = rotation.matrix();
        r * self.inertia * r.transpose()
    }

    /// Return the inverse inertia at this orientation: zero about constrained axes.
    pub(in crate::step) fn inverse_of(&self, rotation: &Rotation3<f64>) -> Matrix3<f64> {
        let mut inertia = self.inertia_of(rotation);
        let held: Vec<usize> = (0..3).filter(|d| self.held[d + 3]).collect();
        for &d in &held {
            inertia.fill_row(d, 0.0);
            inertia.fill_column(d, 0.0);
            inertia[(d, d)] = 1.0;
        }
        // Particles have extent, so that the inertia is invertible.
        let mut inverse = inertia.cholesky().map_or_else(Matrix3::zeros, |c| c.inverse());
        held.iter().for_each(|&d| inverse[(d, d)] = 0.0);
        inverse
    }
}

fn turn(by: &Vector3<f64>) -> Rotation3<f64> {
    Rotation3::from_scaled_axis(*by)
}

/// Invalid value in the motion of a rigid body.
#[derive(Clone, Copy, Debug)]
pub(in crate::step) struct Wrong {
    pub(in crate::step) field: &'static str,
    pub(in crate::step) value: f64,
    pub(in crate::step) allowed: &'static str,
}

fn finite(field: &'static str, values: &[f64]) -> Result<(), Wrong> {
    let wrong = values.iter().find(|x| !x.is_finite());
    wrong.map_or(Ok(()), |&value| Err(Wrong { field, value, allowed: "finite" }))
}

/// Reject rotations by half a turn or more in a step, whose direction is ambiguous.
fn turns(by: &Vector3<f64>) -> Result<(), Wrong> {
    let value = by.norm();
    let allowed = "below pi in a step: take smaller steps or a slower spin";
    if value < std::f64::consts::PI { Ok(()) } else { Err(Wrong { field: "turn", value, allowed }) }
}

/// Reject motions that are not finite, or not available in the coordinates.
fn check<const D: usize>(name: &str, twist: &Twist<D>, hoop: bool) -> Result<(), SceneError> {
    let refuse = |field, value, allowed| Err(SceneError::Rigid { body: name.into(), field, value, allowed });
    let numbers = [("velocity", &twist.velocity[..]), ("spin", &twist.spin[..])];
    for (field, values) in numbers {
        if let Some(&x) = values.iter().find(|x| !x.is_finite()) {
            return refuse(field, x, "finite");
        }
    }
    if D == 2
        && let Some(&x) = twist.spin[..2].iter().find(|&&x| x != 0.0)
    {
        return refuse("spin along x or y", x, "0 in two dimensions");
    }
    if hoop && twist.spin[2] != 0.0 {
        return refuse("spin", twist.spin[2], "0 in axisymmetric coordinates");
    }
    if hoop && twist.velocity[0] != 0.0 {
        return refuse("velocity along r", twist.velocity[0], "0 in axisymmetric coordinates");
    }
    Ok(())
}
