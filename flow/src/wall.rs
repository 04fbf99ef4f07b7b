//! Walls: solids and containers of any shape, at rest or in prescribed motion.

use std::fmt;
use std::sync::Arc;

use impactite_geometry::Shape;

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
}

impl<const D: usize> fmt::Debug for Wall<D> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let kind = if self.sign > 0.0 { "solid" } else { "container" };
        let slip = if self.no_slip { "no slip" } else { "slip" };
        let motion = if self.motion.is_some() { ", moving" } else { "" };
        write!(f, "{kind} {}, {slip}{motion}", impactite_scene::constants::region(&*self.shape))
    }
}

impl<const D: usize> Wall<D> {
    /// Create a solid wall: the liquid is outside of the shape.
    pub fn solid(shape: impl Shape<D> + 'static) -> Self {
        Wall { shape: Arc::new(shape), sign: 1.0, no_slip: false, motion: None }
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
    /// True if the wall has the no-slip condition.
    pub fn is_no_slip(&self) -> bool {
        self.no_slip
    }
    /// True if the wall moves.
    pub fn is_moving(&self) -> bool {
        self.motion.is_some()
    }
    /// Displacement at the time `t`, s, in m.
    pub fn displacement(&self, t: f64) -> [f64; D] {
        self.motion.as_ref().map_or([0.0; D], |motion| motion(t))
    }
    /// Distance from a point to the wall, m, displaced by `by`: positive in open space. Its magnitude is at most the true distance.
    pub fn gap(&self, x: [f64; D], by: &[f64; D]) -> f64 {
        self.sign * self.shape.signed_distance(std::array::from_fn(|d| x[d] - by[d]))
    }
}

/// All walls at a moment, with their displacements and velocities.
pub(crate) struct Walls<'a, const D: usize> {
    pub list: &'a [Wall<D>],
    /// Displacement of each wall at the end of the step, m.
    pub displacements: Vec<[f64; D]>,
    /// Mean velocity of each wall in the step, m/s.
    pub velocities: Vec<[f64; D]>,
}

impl<'a, const D: usize> Walls<'a, D> {
    /// Walls at the time `t`, s, in a step of `dt` seconds.
    pub fn at(list: &'a [Wall<D>], t: f64, dt: f64) -> Self {
        let displacements: Vec<_> = list.iter().map(|w| w.displacement(t)).collect();
        let velocities = list
            .iter()
            .zip(&displacements)
            .map(|(w, x)| {
                let next = if w.is_moving() { w.displacement(t + dt) } else { *x };
                std::array::from_fn(|d| if dt > 0.0 { (next[d] - x[d]) / dt } else { 0.0 })
            })
            .collect();
        Walls { list, displacements, velocities }
    }
    /// Distance to the nearest wall, m, and its index; of walls at one place the last.
    pub fn gap(&self, x: [f64; D]) -> (f64, usize) {
        let mut nearest = (f64::INFINITY, 0);
        for (n, (wall, by)) in self.list.iter().zip(&self.displacements).enumerate() {
            let gap = wall.gap(x, by);
            if gap <= nearest.0 {
                nearest = (gap, n);
            }
        }
        nearest
    }
    /// True if a wall moves.
    pub fn moving(&self) -> bool {
        self.list.iter().any(Wall::is_moving)
    }
}
