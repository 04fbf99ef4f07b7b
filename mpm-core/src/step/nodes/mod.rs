//! Nodes: blocks of the background grid, their fields, sums of particles, momentum update, planes and walls.

pub(crate) mod add_tiles;
pub(crate) mod at_wall;
pub(crate) mod background;
pub(crate) mod block_place;
pub(crate) mod constraints;
pub(crate) mod fields;
pub(crate) mod footprint;
pub(crate) mod frequency;
pub(crate) mod layout;
pub(crate) mod meet_walls;
pub(crate) mod node_sets;
pub(crate) mod node_update;
pub(crate) mod occupancy;
pub(crate) mod planes;
pub(crate) mod presence;
pub(crate) mod stages;
mod ties;
pub(crate) mod wrap;
