//! Walls: solids and containers of any shape, at rest or in prescribed motion.

use std::fmt;
use std::sync::Arc;

use impactite_geometry::{Bounds, Shape};

use crate::deformable::skin::Skin;
use crate::rigid::Floater;
use crate::turn::{Motion, Pose, rotation};

/// Displacement of a wall over time, m.
pub type WallMotion<const D: usize> = Arc<dyn Fn(f64) -> [f64; D] + Send + Sync>;

/// Wall condition at a solid or in a container: impermeable, with free slip or no slip, at rest or in a prescribed translation.
///
/// The pressure equation contains the open fraction of each cell face, which follows from the signed distance of the shape at grid nodes
/// (cut cells). Walls need not lie on grid planes; they are resolved to second order where they are smooth.
///
/// ```
/// use flow::Wall;
/// use impactite_geometry::{Cuboid, Disc};
/// let tank: Wall<2> = Wall::container(Cuboid::new([0.0, 0.0], [2.0, 1.0])?);
/// let piston = Wall::solid(Disc::new([0.5, 0.2], 0.1)?).no_slip().moving(|t| [0.1 * t, 0.0]);
/// # let _ = (tank, piston);
/// # Ok::<(), impactite_geometry::GeometryError>(())
/// ```
#[derive(Clone)]
pub struct Wall<const D: usize> {
    shape: Arc<dyn Shape<D>>,
    /// Sign of the distance to the wall over the signed distance of the shape.
    sign: f64,
    no_slip: bool,
    motion: Option<WallMotion<D>>,
    /// Point of the undisplaced shape about which it turns, m, and angular velocity, rad/s.
    spin: Option<([f64; D], [f64; 3])>,
    /// Index of the free body whose surface this is.
    pub(crate) body: Option<usize>,
    /// Index of the surface of a deformable body; the shape is its first box.
    pub(crate) solid: Option<usize>,
}

impl<const D: usize> fmt::Debug for Wall<D> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let kind = if self.sign > 0.0 { "solid" } else { "container" };
        let slip = if self.no_slip { "no slip" } else { "slip" };
        let motion = if self.motion.is_some() { ", moving" } else { "" };
        write!(f, "{kind} {}, {slip}{motion}", impactite_scene::constants::region(&*self.shape))?;
        match &self.spin {
            Some((about, spin)) => write!(f, ", turning about {about:?} m by {spin:?} rad/s"),
            None => Ok(()),
        }
    }
}

impl<const D: usize> Wall<D> {
    /// Create a solid wall: the liquid is outside of the shape.
    pub fn solid(shape: impl Shape<D> + 'static) -> Self {
        Wall {
            shape: Arc::new(shape),
            sign: 1.0,
            no_slip: false,
            motion: None,
            spin: None,
            body: None,
            solid: None,
        }
    }
    /// Create a container: the liquid is inside of the shape.
    pub fn container(shape: impl Shape<D> + 'static) -> Self {
        Wall { sign: -1.0, ..Wall::solid(shape) }
    }
    /// Set the no-slip condition: the liquid has the tangential velocity of the wall. It acts through the viscosity; default is free slip.
    #[must_use]
    pub fn no_slip(mut self) -> Self {
        self.no_slip = true;
        self
    }
    /// Set the displacement of the wall over time, m. The velocity in a step is the mean one, the change of displacement over the step.
    #[must_use]
    pub fn moving(mut self, displacement: impl Fn(f64) -> [f64; D] + Send + Sync + 'static) -> Self {
        self.motion = Some(Arc::new(displacement));
        self
    }
    /// Set a constant angular velocity, rad/s, about a point of the shape, m, which moves by the displacement of the wall. In the plane the
    /// axis is z.
    #[must_use]
    pub fn turning(mut self, about: [f64; D], spin: [f64; 3]) -> Self {
        self.spin = Some((about, spin));
        self
    }
    /// True if the wall has the no-slip condition.
    pub fn is_no_slip(&self) -> bool {
        self.no_slip
    }
    /// True if the wall moves.
    pub fn is_moving(&self) -> bool {
        self.motion.is_some() || self.spin.is_some() || self.follows()
    }
    /// True for the surface of a body that the liquid moves.
    pub(crate) fn follows(&self) -> bool {
        self.body.is_some() || self.solid.is_some()
    }
    /// Box around the shape, m, without its displacement.
    pub(crate) fn bounds(&self) -> Bounds<D> {
        self.shape.bounds()
    }
    /// Displacement at the time `t`, s, in m.
    pub fn displacement(&self, t: f64) -> [f64; D] {
        self.motion.as_ref().map_or([0.0; D], |motion| motion(t))
    }
    /// Distance from a point to the wall, m, displaced by `by`: positive in open space. Its magnitude is at most the true distance.
    pub fn gap(&self, x: [f64; D], by: &[f64; D]) -> f64 {
        self.sign * self.shape.signed_distance(std::array::from_fn(|d| x[d] - by[d]))
    }
    /// Angular velocity of a prescribed motion, rad/s, and the point of the shape about which it turns, m.
    pub fn spin(&self) -> Option<([f64; D], [f64; 3])> {
        self.spin
    }
    /// Largest speed of a prescribed rotation within the bounds of the shape, m/s.
    pub(crate) fn turning_speed(&self) -> f64 {
        let Some((about, spin)) = self.spin else { return 0.0 };
        let bounds = self.shape.bounds();
        let arm = |d: usize| (bounds.max[d] - about[d]).abs().max((bounds.min[d] - about[d]).abs());
        let arm = (0..D).map(|d| arm(d).powi(2)).sum::<f64>().sqrt();
        let speed = arm * spin.iter().map(|w| w * w).sum::<f64>().sqrt();
        if speed.is_finite() { speed } else { 0.0 }
    }
    /// Place at the time `t`, s, of a wall that is not the surface of a free body.
    fn pose(&self, t: f64) -> Pose<D> {
        let turn = self.spin.map(|(about, spin)| (about, rotation(&spin.map(|w| w * t))));
        Pose { by: self.displacement(t), turn }
    }
}

/// All walls at a moment, with their places and velocities.
pub(crate) struct Walls<'a, const D: usize> {
    pub list: &'a [Wall<D>],
    /// Place of each wall.
    pub poses: Vec<Pose<D>>,
    /// Mean motion of each wall in the step; of a free body that of its present velocity.
    pub motions: Vec<Motion<D>>,
    /// Surfaces of deformable bodies, with the first of their nodes.
    pub skins: &'a [(Skin<D>, usize)],
    /// Velocities of the nodes of the surfaces, m/s.
    pub velocities: Vec<[f64; D]>,
}

impl<'a, const D: usize> Walls<'a, D> {
    /// Walls at the time `t`, s, in a step of `dt` seconds.
    pub fn at(
        list: &'a [Wall<D>],
        (bodies, skins): (&[Floater<D>], &'a [(Skin<D>, usize)]),
        t: f64,
        dt: f64,
    ) -> Self {
        let pose = |w: &Wall<D>| w.body.map_or_else(|| w.pose(t), |k| bodies[k].pose());
        let poses: Vec<_> = list.iter().map(pose).collect();
        let motion = |(w, pose): (&Wall<D>, &Pose<D>)| {
            if let Some(body) = w.body {
                return bodies[body].motion();
            }
            let x = pose.by;
            let next = if w.motion.is_some() { w.displacement(t + dt) } else { x };
            let velocity = std::array::from_fn(|d| if dt > 0.0 { (next[d] - x[d]) / dt } else { 0.0 });
            let (about, spin) = w.spin.unwrap_or(([0.0; D], [0.0; 3]));
            Motion { velocity, spin, about: std::array::from_fn(|d| about[d] + x[d]) }
        };
        let motions = list.iter().zip(&poses).map(motion).collect();
        Walls { list, poses, motions, skins, velocities: Vec::new() }
    }
    /// Take the velocities of the free bodies.
    pub fn follow(&mut self, bodies: &[Floater<D>]) {
        for (wall, motion) in self.list.iter().zip(&mut self.motions) {
            if let Some(body) = wall.body {
                *motion = bodies[body].motion();
            }
        }
    }
    /// Distance to one wall, m.
    pub fn gap_of(&self, n: usize, x: &[f64; D]) -> f64 {
        let wall = &self.list[n];
        if let Some(k) = wall.solid {
            let skin = &self.skins[k].0;
            let far = skin.outside_of_box(x);
            return if far > skin.size() { far } else { skin.nearest(x).gap };
        }
        wall.sign * wall.shape.signed_distance(self.poses[n].back(x))
    }
    /// Component of the velocity of a wall at a point, m/s.
    pub fn velocity(&self, n: usize, x: &[f64; D], d: usize) -> f64 {
        let Some(k) = self.list[n].solid else { return self.motions[n].component(x, d) };
        let (skin, first) = &self.skins[k];
        let at = skin.nearest(x);
        let of = |n: &u32| self.velocities.get(*n as usize + first).map_or(0.0, |v| v[d]);
        skin.nodes(at.facet).iter().zip(&at.weights).map(|(n, w)| w * of(n)).sum()
    }
    /// Distance to the nearest wall, m, and its index; of walls at one place the last.
    pub fn gap(&self, x: [f64; D]) -> (f64, usize) {
        let mut nearest = (f64::INFINITY, 0);
        for n in 0..self.list.len() {
            let gap = self.gap_of(n, &x);
            if gap <= nearest.0 {
                nearest = (gap, n);
            }
        }
        nearest
    }
    /// Distance to the nearest wall that moves, m.
    pub fn gap_of_moving(&self, x: &[f64; D]) -> f64 {
        let moving = |n: &usize| self.list[*n].is_moving();
        (0..self.list.len()).filter(moving).map(|n| self.gap_of(n, x)).fold(f64::INFINITY, f64::min)
    }
    /// True if a wall moves.
    pub fn moving(&self) -> bool {
        self.list.iter().any(Wall::is_moving)
    }
}
