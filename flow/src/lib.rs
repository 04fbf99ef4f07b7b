//! Incompressible free-surface flow: particles on a staggered (MAC) grid, in the plane and in space.

mod blocks;
mod cuts;
mod extrapolate;
mod gather;
#[cfg(test)]
mod gates;
mod grid;
mod options;
mod particles;
mod pressure;
mod solver;
mod step;
mod surface;
mod tension;
mod transfer;
mod view;
mod viscosity;
mod wall;

pub use options::{FlowOptions, Fluid};
pub use solver::{Flow, FluidError, StepTimes};
pub use wall::{Wall, WallMotion};
