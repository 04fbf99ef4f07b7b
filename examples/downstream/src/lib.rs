//! Example of a law, a shape function, hooks in the step and a method from outside the framework.
//!
//! Their kernels are compiled here, and not again with every change of a program that uses them.

pub mod choose;
pub mod deepest;
pub mod diffusion;
pub mod peridynamics;
pub mod tent;
pub mod viscoelastic;

pub use deepest::Deepest;
pub use diffusion::Diffusion;
pub use tent::TentAveragedHat;
pub use viscoelastic::StandardLinearSolid;

use impactite::mpm::{Apic, IntoKernels, Kernels, Method, PlaneStrain, Usl};

/// Return APIC kernels with the tent-averaged linear shape function, in plane strain.
pub fn tent_apic() -> Kernels<f64, 2> {
    Method::new(TentAveragedHat, Apic, Usl, PlaneStrain).compiled().into_kernels()
}
