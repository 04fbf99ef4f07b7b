//! Errors in the set-up of liquids and rigid bodies.

use impactite_geometry::GeometryError;
use impactite_scene::SceneError;

/// Error in the set-up of a liquid from a shape.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FluidError {
    /// Invalid shape or filling.
    #[error(transparent)]
    Geometry(#[from] GeometryError),
    /// Invalid scene.
    #[error(transparent)]
    Scene(#[from] SceneError),
}
