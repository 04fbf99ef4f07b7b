//! Operations between steps: splitting, merging, deactivation, damping, checks of balances, checkpoints.

mod apply;
pub(crate) mod cells;
pub(crate) mod checkpoint;
pub(crate) mod deactivated;
pub(crate) mod deactivation;
pub(crate) mod equilibrium;
pub(crate) mod filter;
pub(crate) mod look;
pub(crate) mod looks;
pub(crate) mod merging;
pub(crate) mod operations;
pub(crate) mod renewal;
pub(crate) mod rest;
pub(crate) mod splitting;
