//! Bodies of a scene: description, particles, loads, capabilities.

mod across_levels;
pub(crate) mod adding;
pub(crate) mod body;
pub(crate) mod capability;
pub(crate) mod crossing;
pub(crate) mod deformable;
pub(crate) mod densities;
pub(crate) mod load;
pub(crate) mod particle_body;
mod particle_loads;
mod particle_views;
pub(crate) mod seeding;
