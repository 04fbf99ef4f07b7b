//! A law, a shape function and a method that the framework does not have.
//!
//! Kernels of both are compiled here, and so not again with every change of a program that has them.

pub mod choose;
pub mod peridynamics;
pub mod tent;
pub mod viscoelastic;

pub use tent::TentAveragedHat;
pub use viscoelastic::StandardLinearSolid;

use impactite::mpm::{Apic, IntoKernels, Kernels, Method, PlaneStrain, Usl};

/// APIC on the tent-averaged linear shape function, in plane strain.
pub fn tent_apic() -> Kernels<f64, 2> {
    Method::new(TentAveragedHat, Apic, Usl, PlaneStrain).compiled().into_kernels()
}
