//! Methods with kernels compiled in this crate, once for all programs.

use crate::frame::TotalLagrangian;
use crate::kernels::IntoKernels;
use crate::method::Method;
use crate::scheme::{Musl, Usl};
use crate::shape::{CpGimp, Linear, QuadraticBSpline};
use crate::step::passes::compiled::kernels;
use crate::step::{Kernels, Scalar};
use crate::transfer::{Aflip, Apic, Blend, Flip, Mls};
use impactite_scene::embedding::{Axisymmetric, FullSpace, PlaneStrain};

macro_rules! compiled {
    ($t:ty, $d:literal: $($m:ty),+ $(,)?) => {$(
        impl IntoKernels<$t, $d> for $m {
            #[inline(never)]
            fn into_kernels(self) -> Kernels<$t, $d> {
                Kernels::new(kernels(self), <$t as Scalar<$d>>::WORK)
            }
        }
    )+};
}

compiled! {
    f64, 3:
    Method<Linear, Flip, Musl, FullSpace>,
    Method<Linear, Blend<f64>, Musl, FullSpace>,
    Method<CpGimp, Flip, Musl, FullSpace>,
    Method<CpGimp, Flip, Usl, FullSpace>,
    Method<CpGimp, Blend<f64>, Musl, FullSpace>,
    Method<QuadraticBSpline, Flip, Musl, FullSpace>,
    Method<QuadraticBSpline, Apic, Usl, FullSpace>,
    Method<QuadraticBSpline, Aflip<f64>, Usl, FullSpace>,
    Method<QuadraticBSpline, Mls, Usl, FullSpace>,
    Method<Linear, Flip, Musl, FullSpace, TotalLagrangian>,
}

macro_rules! plane_and_revolved {
    ($space:ty) => {
        compiled! {
            f64, 2:
            Method<Linear, Flip, Musl, $space>,
            Method<Linear, Blend<f64>, Musl, $space>,
            Method<CpGimp, Flip, Musl, $space>,
            Method<CpGimp, Flip, Usl, $space>,
            Method<CpGimp, Blend<f64>, Musl, $space>,
            Method<QuadraticBSpline, Flip, Musl, $space>,
            Method<QuadraticBSpline, Apic, Usl, $space>,
            Method<QuadraticBSpline, Aflip<f64>, Usl, $space>,
            Method<QuadraticBSpline, Mls, Usl, $space>,
            Method<Linear, Flip, Musl, $space, TotalLagrangian>,
        }
    };
}
plane_and_revolved!(PlaneStrain);
plane_and_revolved!(Axisymmetric);

#[cfg(feature = "single")]
compiled! {
    f32, 3:
    Method<Linear, Flip, Musl, FullSpace>,
    Method<QuadraticBSpline, Mls, Usl, FullSpace>,
}
