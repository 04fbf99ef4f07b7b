//! Contact of free rigid bodies with the planes of a scene: walls, fixed planes, symmetry planes.
//!
//! A plane acts on the body as a whole, not on the grid nodes that the body maps to. Contact points of a plane and a body
//! are known exactly: the surface of a body is that of its particles. Each contact point is a unilateral constraint on the
//! body's velocity at the end of the step,
//!
//! (v - w) . n >= -gap / dt,
//!
//! with the velocity w of the plane, and Coulomb friction of the impulse; all are solved together with the contacts between
//! bodies ([`crate::ContactAlgorithm::couple`]). A body thus lands on a plane without penetration, stays there, and loses
//! its velocity into the plane: the impact is inelastic. A fixed plane is a wall without slip. A symmetry plane that cuts a
//! body is a bilateral constraint: the body is half of one, and has neither velocity across the plane nor spin along it
//! ([`RigidState::halve`]). Any other symmetry plane is a frictionless wall, since the body is in contact with its own
//! image there.

use impactite_scene::boundary::Boundary;
use nalgebra::{Matrix3, Vector3};

use super::motion::RigidState;
use super::surface::Surface;
use crate::step::nodes::stages::GridStages;
use impactite_scene::{Boundaries, Exchange};
use impactite_simd::Float;

/// Friction coefficient of planes without slip.
const NO_SLIP: f64 = 1e9;
/// Largest initial distance from a symmetry plane that cuts the body, over the half size of a particle.
const CUT: f64 = 0.1;
/// Largest shift of a body out of a plane in a step, and largest penetration that is corrected, over the half size of a
/// particle.
const SHIFT: [f64; 2] = [0.1, 2.0];

/// Plane that stops rigid bodies.
#[derive(Clone, Copy, Debug)]
pub(in crate::step) struct Barrier {
    pub(in crate::step) axis: usize,
    /// Side of the bodies: +1 above the plane, else -1.
    pub(in crate::step) sign: f64,
    /// Position at the start of the step, m.
    pub(in crate::step) at: f64,
    /// Velocity, m/s.
    pub(in crate::step) velocity: [f64; 3],
    pub(in crate::step) friction: f64,
    /// Account of the boundary.
    pub(in crate::step) account: Option<usize>,
}

impl Barrier {
    /// Return the boundary as a barrier at `time`, s, if it is one.
    pub(in crate::step) fn of<const D: usize>(boundary: &Boundary<D>, time: f64) -> Option<Self> {
        let mut of = [0.0; 3];
        let (axis, at, side, friction) = match *boundary {
            Boundary::Wall { axis, at, side, velocity } => {
                of[axis] = velocity;
                (axis, at, side, 0.0)
            }
            Boundary::FrictionWall { axis, at, side, velocity, friction } => {
                of[..D].copy_from_slice(&velocity);
                (axis, at, side, friction.min(NO_SLIP))
            }
            Boundary::Fixed { axis, at, side } => (axis, at, side, NO_SLIP),
            Boundary::Symmetry { axis, at, side } => (axis, at, side, 0.0),
            _ => return None,
        };
        let at = at + of[axis] * time;
        Some(Barrier { axis, sign: side.sign(), at, velocity: of, friction, account: None })
    }
    /// Return the barriers among boundaries at `time`, s.
    fn all<const D: usize>(boundaries: &Boundaries<D>, time: f64) -> impl Iterator<Item = Self> {
        let numbered = boundaries.iter().enumerate();
        numbered.filter_map(move |(n, b)| {
            Some(Barrier { account: boundaries.account(n), ..Barrier::of(b, time)? })
        })
    }
    fn normal(&self) -> Vector3<f64> {
        let mut n = Vector3::zeros();
        n[self.axis] = self.sign;
        n
    }
    /// Return the distance, m, of a point in front of the plane after `dt`, s.
    fn distance(&self, x: &Vector3<f64>, dt: f64) -> f64 {
        self.sign * (x[self.axis] - self.at - self.velocity[self.axis] * dt)
    }
}

/// Contact point of a free rigid body with a plane, active or possible within the step.
#[derive(Clone)]
pub struct PlaneTouch<'a, const D: usize> {
    pub(crate) body: usize,
    pub(crate) rigid: &'a RigidState<D>,
    /// Position on the body's surface, m.
    pub(crate) point: [f64; D],
    /// Unit normal of the plane towards the body.
    pub(crate) normal: [f64; 3],
    /// Velocity of the plane, m/s.
    wall: [f64; 3],
    account: Option<usize>,
    /// Gap, m.
    gap: f64,
    dt: f64,
    pub(crate) friction: f64,
    /// Trial velocity of the body at the point: at the end of the step without contact, m/s.
    pub(crate) trial: [f64; 3],
    /// Share of the body's mass for this contact among the body's contacts, kg.
    pub(crate) mass: f64,
    /// Impulse on the body, N s.
    pub(crate) impulse: [f64; 3],
}

impl<const D: usize> std::fmt::Debug for PlaneTouch<'_, D> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let PlaneTouch { body, point, normal, gap, impulse, .. } = self;
        write!(f, "plane: body {body} at {point:?}, normal {normal:?}, gap {gap} m, impulse {impulse:?} N s")
    }
}

impl<const D: usize> PlaneTouch<'_, D> {
    /// Index of the body.
    #[must_use]
    pub fn body(&self) -> usize {
        self.body
    }
    /// Impulse on the body, N s.
    #[must_use]
    pub fn impulse(&self) -> [f64; 3] {
        self.impulse
    }
    /// Return the lower bound of the body's normal velocity, and the reference velocity of friction along the plane, m/s.
    pub(crate) fn least_velocity(&self) -> [f64; 3] {
        std::array::from_fn(|d| self.wall[d] - self.normal[d] * self.gap.max(0.0) / self.dt)
    }
    /// Return the data that is needed until the body moves.
    fn push(&self) -> PlanePush<D> {
        let PlaneTouch { body, point, normal, wall, impulse, account, .. } = *self;
        PlanePush { body, point, normal, wall, impulse, account }
    }
}

/// Impulse of a plane on a free rigid body.
#[derive(Clone, Copy, Debug)]
pub(in crate::step) struct PlanePush<const D: usize> {
    pub(in crate::step) body: usize,
    pub(in crate::step) point: [f64; D],
    normal: [f64; 3],
    wall: [f64; 3],
    pub(in crate::step) impulse: [f64; 3],
    account: Option<usize>,
}

/// Select the contacts with an impulse.
pub(in crate::step) fn pushes<const D: usize>(touches: &[PlaneTouch<'_, D>]) -> Vec<PlanePush<D>> {
    touches.iter().filter(|t| t.impulse != [0.0; 3]).map(PlaneTouch::push).collect()
}

impl<const D: usize> PlanePush<D> {
    /// Record the impulse after the body's step; the work of `gravity`, m/s^2, has been recorded before.
    pub(in crate::step) fn book(
        &self,
        state: &RigidState<D>,
        gravity: &[f64; D],
        dt: f64,
        ledger: &mut Exchange,
    ) {
        let (before, after) = (state.velocity_at(&self.point), state.velocity_after(&self.point));
        let along: f64 = (0..3).map(|d| self.normal[d] * self.impulse[d]).sum();
        for d in 0..3 {
            let (across, slip) = (along * self.normal[d], 0.5 * (before[d] + after[d]) - self.wall[d]);
            ledger.impulse[d] += self.impulse[d];
            ledger.work += self.impulse[d] * self.wall[d];
            if let Some(account) = self.account {
                ledger.accounts[account].impulse[d] += self.impulse[d];
                ledger.accounts[account].work += self.impulse[d] * self.wall[d];
            }
            ledger.friction -= (self.impulse[d] - across) * slip;
            ledger.impacts -= across * slip;
        }
        // Body force work was recorded with the velocities before contact: add the difference.
        for d in 0..D {
            ledger.work += 0.5 * dt * gravity[d] * self.impulse[d];
        }
    }
}

impl<const D: usize> RigidState<D> {
    /// Constrain a free body that a symmetry plane cuts to mirror-symmetric motions: the plane is then the cut face of half
    /// a body. A body whose velocity or spin is not mirror-symmetric is distinct from its image and is not constrained.
    pub(in crate::step) fn halve(&mut self, axis: usize, at: f64, sign: f64) {
        let Some(surface) = &self.surface else { return };
        let plane = Barrier { axis, sign, at, velocity: [0.0; 3], friction: 0.0, account: None };
        let half = surface.half[axis];
        let nearest = surface.points.iter().map(|x| plane.distance(&(self.centre + self.rotation * x), 0.0));
        let cut = nearest.fold(f64::INFINITY, f64::min) <= (1.0 + CUT) * half;
        let others = || (0..3).filter(move |&d| d != axis);
        if !cut || self.velocity[axis] != 0.0 || others().any(|d| self.spin[d] != 0.0) {
            return;
        }
        self.held[axis] = true;
        others().for_each(|d| self.held[3 + d] = true);
        self.inverse = self.inverse_of(&self.rotation);
        let mut surface = Surface::clone(surface);
        surface.cuts[axis] = Some(at - self.centre[axis]);
        surface.ball = surface.as_ball(D);
        self.surface = Some(surface.into());
    }

    /// Return the velocity of the body's material at a point at the end of the step, m/s.
    fn velocity_after(&self, x: &[f64; D]) -> [f64; 3] {
        let mut r = -self.centre;
        (0..D).for_each(|d| r[d] += x[d]);
        (self.step.velocity + self.step.spin.cross(&r)).into()
    }

    /// Return true if the body may come into contact with a plane in a step of `dt`, s: a quick check.
    fn is_near(&self, plane: &Barrier, dt: f64) -> bool {
        let Some(surface) = &self.surface else { return false };
        let speed = self.velocity.norm() + plane.velocity[plane.axis].abs();
        plane.distance(&self.centre, 0.0) - surface.reach <= 2.0 * speed * dt + surface.half.norm()
    }

    /// Return the surface points, m, that are or may be in contact with a plane in a step of `dt`, s, with trial velocity,
    /// m/s, and spin, 1/s, and their gaps, m. Of many points only the lowest and the outermost are returned.
    fn places(
        &self,
        plane: &Barrier,
        dt: f64,
        [velocity, spin]: [Vector3<f64>; 2],
    ) -> Vec<(Vector3<f64>, f64)> {
        let Some(surface) = &self.surface else { return Vec::new() };
        let (n, half) = (plane.normal(), surface.half.norm());
        let closing = (velocity[plane.axis] - plane.velocity[plane.axis]).abs() + spin.norm() * surface.reach;
        let reach = 2.0 * closing * dt + 1e-3 * half;
        if let Some((centre, radius)) = &surface.ball {
            let centre = self.centre + self.rotation * centre;
            let gap = plane.distance(&centre, 0.0) - radius;
            return if gap <= reach { vec![(centre - n * *radius, gap)] } else { Vec::new() };
        }
        let within = self.rotation.inverse() * n;
        let [corner, round] = surface.reaches(&within);
        let height = plane.distance(&self.centre, 0.0);
        let mut near: Vec<(Vector3<f64>, f64)> = Vec::new();
        let squares = surface.half.component_mul(&surface.half);
        let under = squares.component_mul(&within) / round;
        for x in &surface.points {
            let gap = height + within.dot(x) - round;
            if gap <= reach {
                near.push((self.centre + self.rotation * (x - under), gap));
            }
        }
        for x in surface.corners.iter().map(|&p| &surface.points[p]) {
            let gap = height + within.dot(x) - corner;
            if gap <= reach {
                // Lowest point of the box; if an edge is lowest, its outer end.
                let towards = |d: usize| {
                    if within[d].abs() > 1e-9 {
                        -within[d].signum()
                    } else {
                        (x[d] - surface.middle[d]).signum()
                    }
                };
                let under = Vector3::new(towards(0), towards(1), towards(2)).component_mul(&surface.half);
                near.push((self.centre + self.rotation * (x + under), gap));
            }
        }
        let Some(lowest) = near.iter().copied().min_by(|a, b| a.1.total_cmp(&b.1)) else { return near };
        let mut chosen: Vec<(Vector3<f64>, f64)> = Vec::new();
        let directions = if D == 2 { 2 } else { 8 };
        for k in 0..directions {
            let angle = std::f64::consts::TAU * f64::from(k) / f64::from(directions);
            let mut t = Vector3::zeros();
            (t[(plane.axis + 1) % D], t[(plane.axis + D - 1) % D]) =
                (angle.cos(), if D == 2 { angle.cos() } else { angle.sin() });
            let outermost = near.iter().copied().max_by(|a, b| {
                let of = |p: &(Vector3<f64>, f64)| t.dot(&p.0);
                let same = (of(a) - of(b)).abs() <= 1e-9 * half;
                if same { b.1.total_cmp(&a.1) } else { of(a).total_cmp(&of(b)) }
            });
            let known = |p: &(Vector3<f64>, f64)| chosen.iter().any(|c| (c.0 - p.0).norm() <= 1e-6 * half);
            chosen.extend(outermost.filter(|p| !known(p)));
        }
        if chosen.iter().all(|c| c.1 > lowest.1 + 1e-6 * half) {
            chosen.push(lowest);
        }
        chosen
    }

    /// Shift the step of a body out of a plane that it would penetrate at its end: rotating bodies do, by the square of the
    /// angle.
    fn keep_out(&mut self, plane: &Barrier, dt: f64) {
        let Some(surface) = self.surface.clone().filter(|_| !self.held[plane.axis]) else { return };
        let turned: Matrix3<f64> = (Matrix3::identity() + self.step.turn) * self.rotation.matrix();
        let centre = self.centre + self.step.way;
        let gap = match &surface.ball {
            Some((of, radius)) => plane.distance(&(centre + turned * of), dt) - radius,
            None => {
                let within = turned.transpose() * plane.normal();
                let [corner, round] = surface.reaches(&within);
                let low = surface.points.iter().map(|x| within.dot(x) - round).fold(f64::INFINITY, f64::min);
                let corners = surface.corners.iter().map(|&p| within.dot(&surface.points[p]) - corner);
                plane.distance(&centre, dt) + corners.fold(low, f64::min)
            }
        };
        let [most, deepest] = SHIFT.map(|share| share * surface.half[plane.axis]);
        if gap < 0.0 && -gap <= deepest {
            self.step.way[plane.axis] += plane.sign * (-gap).min(most);
        }
    }

    /// Shift the body's step out of all planes among the boundaries; `time` is at the start of the step, s.
    pub(in crate::step) fn keep_out_of(&mut self, boundaries: &Boundaries<D>, time: f64, dt: f64) {
        for plane in Barrier::all(boundaries, time) {
            if self.is_near(&plane, dt) {
                self.keep_out(&plane, dt);
            }
        }
    }

    /// Add the impulses, N s, and moments about the centre, N m s, of planes.
    pub(in crate::step) fn pushed_by<'p>(
        &self,
        mut push: [[f64; 3]; 2],
        planes: impl Iterator<Item = &'p PlanePush<D>>,
    ) -> [[f64; 3]; 2] {
        for plane in planes {
            let moment = self.moment(&plane.point, &plane.impulse);
            for d in 0..3 {
                push[0][d] += plane.impulse[d];
                push[1][d] += moment[d];
            }
        }
        push
    }
}

/// Return the coordinates in the dimensions of the scene.
fn point_of<const D: usize>(x: &Vector3<f64>) -> [f64; D] {
    std::array::from_fn(|d| x[d])
}

impl<'a, T: Float, const D: usize> GridStages<'a, T, D> {
    /// Find the contact points of free rigid bodies, given by index, with planes in this step; bodies far from planes are
    /// skipped.
    pub(in crate::step) fn plane_touches(&self, rigid: &[usize]) -> Vec<PlaneTouch<'a, D>> {
        let (dt, time) = (self.of.dt.to_double(), self.of.time);
        let mut touches: Vec<PlaneTouch<'a, D>> = Vec::new();
        let barriers = || Barrier::all(&self.conditions.boundaries, time);
        let bodies: &'a [_] = self.bodies;
        for &body in rigid {
            let Some(state) = bodies[body].rigid().filter(|s| !s.is_prescribed()) else { continue };
            if !barriers().any(|plane| state.is_near(&plane, dt)) {
                continue;
            }
            let (impulse, moment) = self.push_on(body, state);
            let trial = |x: &[f64; D]| {
                let (v, more) = (state.velocity_at(x), state.response(&impulse, &moment, x));
                std::array::from_fn::<f64, 3, _>(|d| v[d] + more[d])
            };
            let velocity = Vector3::from(trial(&point_of(&state.centre)));
            let spin = state.inverse * (state.angular_momentum + Vector3::from(moment));
            let first = touches.len();
            for plane in barriers().filter(|plane| state.is_near(plane, dt)) {
                let normal: [f64; 3] = plane.normal().into();
                for (point, gap) in state.places(&plane, dt, [velocity, spin]) {
                    let point = point_of(&point);
                    let mobility =
                        state.response(&normal, &state.moment(&point, &normal), &point)[plane.axis];
                    // Constrained directions accept no impulse along the normal.
                    if mobility * plane.sign * state.mass > 1e-9 {
                        let wall = plane.velocity;
                        touches.push(PlaneTouch {
                            body,
                            rigid: state,
                            point,
                            normal,
                            wall,
                            account: plane.account,
                            gap,
                            dt,
                            friction: plane.friction,
                            trial: trial(&point),
                            mass: 0.0,
                            impulse: [0.0; 3],
                        });
                    }
                }
            }
            let count = (touches.len() - first) as f64;
            touches[first..].iter_mut().for_each(|touch| touch.mass = state.mass / count);
        }
        touches
    }
}
