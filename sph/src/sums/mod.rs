//! Sums over neighbours, on vectors.

mod balance;
mod batch;
mod diffuse;
mod push;
mod strain;
mod weigh;

pub(crate) use balance::Balance;
pub(crate) use batch::{BATCH, Batch, GROUP, Near, Report, Row};
pub(crate) use diffuse::{DensityGradient, Diffuse};
pub(crate) use push::{Push, Pushed, Viscous};
pub(crate) use strain::Strain;
pub(crate) use weigh::Weigh;
