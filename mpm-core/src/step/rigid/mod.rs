//! Rigid bodies: motion, proxies on the grid, contact with planes.

pub(crate) mod impulses;
pub(crate) mod motion;
pub(crate) mod nodes;
pub(crate) mod planes;
pub(crate) mod proxies;
pub(crate) mod surface;
