//! Methods for comparison without kernels in `mpm-core`: compiled here once for all binaries.

use mpm_core::{
    Axisymmetric, CpGimp, Flip, Fmpm, FullSpace, Gimp, IntoKernels, Kernels, Linear, Method, PlaneStrain,
    Usf, Usl,
};

/// Uniform GIMP, USL, FLIP, in three dimensions.
pub fn gimp_usl_in_space() -> Kernels<f64, 3> {
    Method::new(Gimp, Flip, Usl, FullSpace).compiled().into_kernels()
}
/// Uniform GIMP, USL, FLIP, axisymmetric.
pub fn gimp_usl_revolved() -> Kernels<f64, 2> {
    Method::new(Gimp, Flip, Usl, Axisymmetric).compiled().into_kernels()
}
/// Bilinear shape functions, USF, FLIP, in plane strain.
pub fn linear_usf() -> Kernels<f64, 2> {
    Method::new(Linear, Flip, Usf, PlaneStrain).compiled().into_kernels()
}
/// GIMP with domains that follow the deformation, USF, FLIP, in plane strain.
pub fn cpgimp_usf() -> Kernels<f64, 2> {
    Method::new(CpGimp, Flip, Usf, PlaneStrain).compiled().into_kernels()
}
/// Bilinear shape functions, USF, FMPM of order 4, in plane strain.
pub fn linear_fmpm_usf() -> Kernels<f64, 2> {
    Method::new(Linear, Fmpm::<4>, Usf, PlaneStrain).compiled().into_kernels()
}
