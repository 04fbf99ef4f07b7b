//! Smoothed particle hydrodynamics of solids: bodies of particles whose gradients are sums over neighbours.
//!
//! Constitutive laws are from [`mpm_materials`]; embeddings, conditions, the run loop, observers and checkpoints from [`impactite_scene`].
//! An [`Sph`] is a [`Solver`](impactite_scene::Solver), and a body of [`mpm_contact::particles::Bodies`].

mod contact;
mod faces;
mod form;
mod images;
mod kernel;
mod layout;
mod liquid;
mod load;
mod matrix;
mod method;
mod records;
mod solver;
mod stabilisation;
mod step;
mod sums;
mod surface;
mod tensors;
mod view;

pub use form::{
    Correction, Form, GradientCorrection, NoCorrection, ScaledGradients, StretchError, TotalLagrangian,
    Updated,
};
pub use kernel::{CubicSpline, Kernel, SmoothingError, WendlandC2};
pub use layout::Layout;
pub use load::TractionHistory;
pub use method::{Composition, Method};
pub use solver::{SMALL, Sph, StepTimes};
pub use stabilisation::{
    ArtificialStress, DensityDiffusion, PairViscosity, PrintedArtificialStress, Stabilisation,
    StabilisationError, Unstabilised, ZeroEnergyPenalty,
};
