//! Passes over particles: gather, strain, constitutive law, motion, scatter, and their compiled kernels.

pub(crate) mod cell;
pub(crate) mod compiled;
pub(crate) mod convect;
pub(crate) mod gather;
pub(crate) mod kernels;
pub(crate) mod law_batch;
pub(crate) mod loads;
pub(crate) mod mean;
pub(crate) mod migrate;
pub(crate) mod rows;
pub(crate) mod scatter;
pub(crate) mod slot;
pub(crate) mod spec;
pub(crate) mod spread;
pub(crate) mod stage;
pub(crate) mod surface_quantity;
pub(crate) mod sweep;
pub(crate) mod tile;
pub(crate) mod total;
