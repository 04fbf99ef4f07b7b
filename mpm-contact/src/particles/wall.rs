//! Rigid walls.

use impactite_scene::error::parameter;
use impactite_scene::{Archive, Body, CheckpointError, PointView, SceneError, Totals};

use crate::vector::wide;

/// Rigid half space with prescribed motion, in contact with bodies by the laws of the scene, friction included.
///
/// Cheaper walls, across an axis: [`impactite_scene::Boundary::Wall`] and [`impactite_scene::Boundary::FrictionWall`].
#[derive(Clone, Debug, PartialEq)]
pub struct RigidWall<const D: usize> {
    point: [f64; D],
    normal: [f64; D],
    velocity: [f64; D],
    name: String,
}

impl<const D: usize> RigidWall<D> {
    /// Create a wall at rest through a point (m), with its normal towards the bodies (any length).
    ///
    /// # Errors
    /// Numbers that are not finite, a normal without length.
    pub fn new(point: [f64; D], normal: [f64; D]) -> Result<Self, SceneError> {
        let length = normal.iter().map(|n| n * n).sum::<f64>().sqrt();
        let owner = "rigid wall";
        for x in point {
            parameter(x.is_finite(), owner, "point", x, "finite")?;
        }
        parameter(length > 0.0, owner, "length of the normal", length, "positive and finite")?;
        Ok(RigidWall { point, normal: normal.map(|n| n / length), velocity: [0.0; D], name: String::new() })
    }

    /// Set a constant velocity, m/s; motion along the wall drags bodies by friction.
    ///
    /// # Errors
    /// A velocity that is not finite.
    pub fn moving(self, velocity: [f64; D]) -> Result<Self, SceneError> {
        for v in velocity {
            parameter(v.is_finite(), "rigid wall", "velocity", v, "finite")?;
        }
        Ok(RigidWall { velocity, ..self })
    }

    pub(super) fn rename(&mut self, name: String) {
        self.name = name;
    }

    /// Store or load the position; compare the definition.
    pub(super) fn archive(&mut self, file: &mut Archive) -> Result<(), CheckpointError> {
        let (normal, velocity) = (self.normal, self.velocity);
        file.same(&self.name, &format!("normal {normal:?}, velocity {velocity:?} m/s"))?;
        file.reals(&mut self.point)
    }

    /// Height of a position above the wall, m.
    pub(super) fn height(&self, x: &[f64; D]) -> f64 {
        (0..D).map(|d| (x[d] - self.point[d]) * self.normal[d]).sum()
    }

    pub(super) fn advance(&mut self, dt: f64) {
        for d in 0..D {
            self.point[d] += dt * self.velocity[d];
        }
    }

    pub(super) fn normal(&self) -> [f64; 3] {
        wide(&self.normal)
    }
    pub(super) fn velocity(&self) -> [f64; 3] {
        wide(&self.velocity)
    }
    pub(super) fn speed(&self) -> f64 {
        self.velocity.iter().map(|v| v * v).sum::<f64>().sqrt()
    }
}

/// Body without points.
impl<const D: usize> Body for RigidWall<D> {
    fn name(&self) -> &str {
        &self.name
    }
    fn law(&self) -> &'static str {
        ""
    }
    fn len(&self) -> usize {
        0
    }
    fn state_names(&self) -> Vec<String> {
        Vec::new()
    }
    fn totals(&self) -> Totals {
        Totals::default()
    }
    fn for_each(&self, _: &mut dyn FnMut(&PointView)) {}
    fn bytes(&self) -> usize {
        size_of::<Self>()
    }
}
