//! Bodies of another discretisation on the grid: finite elements, bodies in the reference configuration, conversion to particles.

pub(crate) mod client;
pub(crate) mod client_body;
pub(crate) mod conversion;
pub(crate) mod near_particles;
pub(crate) mod new_particles;
pub(crate) mod reference_scene;
pub(crate) mod stages;
