//! Kernels of the material point method, and how scenes of each dimension lie in space.

use impactite::mpm::{Axisymmetric, FullSpace, Kernels, PlaneStrain};
use impactite::scene::Embedding;

use super::wrong::{At, Made, wrong};
use crate::model::method::Mpm;

/// How a scene lies in space.
pub(crate) trait Setting<const D: usize>: Embedding<D> + std::fmt::Debug + Copy {
    /// Kernels of the material point method.
    fn kernels(self, options: &Mpm) -> Made<Kernels<f64, D>>;
}

/// What of parts is compiled, in words.
pub(crate) const PARTS: &str = "linear with flip or blend and musl; cpgimp with flip and musl or usl, or blend and musl; quadratic_b_spline \
     with flip and musl, or apic, aflip or mls and usl";

/// The kernels of a method of these options, in one of the embeddings.
macro_rules! kernels {
    ($space:expr, $options:expr) => {{
        use impactite::mpm::{
            Aflip, Apic, Blend, CpGimp, Flip, IntoKernels, Linear, Method, Mls, Musl, QuadraticBSpline, Usl,
        };
        use $crate::model::method::{Purpose, ShapeFunction as S, StressUpdate as U, Transfer as X};
        let (space, options) = ($space, $options);
        let key = "method.mpm.parts";
        match (&options.parts, options.purpose) {
            (Some(_), Some(_)) => wrong(key, "either `for` or `parts`"),
            (None, purpose) => Ok(match purpose.unwrap_or_default() {
                Purpose::Impact => Method::impact(space).into_kernels(),
                Purpose::ContactAtRest => Method::contact_at_rest(space).into_kernels(),
                Purpose::LargeElastic => Method::large_elastic(space).into_kernels(),
            }),
            (Some(parts), None) => {
                if parts.relaxation.is_some() != (parts.transfer == X::Blend) {
                    return wrong(key, "`relaxation` is of the transfer `blend`, which needs it");
                }
                let blend = |tau: &Option<$crate::quantity::Quantity<$crate::quantity::Time>>| {
                    At::at(Blend::new(tau.map_or(0.0, |q| q.value)), format!("{key}.relaxation"))
                };
                Ok(match (parts.shape_function, parts.transfer, parts.stress_update) {
                    (S::Linear, X::Flip, U::Musl) => Method::new(Linear, Flip, Musl, space).into_kernels(),
                    (S::Linear, X::Blend, U::Musl) => {
                        Method::new(Linear, blend(&parts.relaxation)?, Musl, space).into_kernels()
                    }
                    (S::Cpgimp, X::Flip, U::Musl) => Method::new(CpGimp, Flip, Musl, space).into_kernels(),
                    (S::Cpgimp, X::Flip, U::Usl) => Method::new(CpGimp, Flip, Usl, space).into_kernels(),
                    (S::Cpgimp, X::Blend, U::Musl) => {
                        Method::new(CpGimp, blend(&parts.relaxation)?, Musl, space).into_kernels()
                    }
                    (S::QuadraticBSpline, X::Flip, U::Musl) => {
                        Method::new(QuadraticBSpline, Flip, Musl, space).into_kernels()
                    }
                    (S::QuadraticBSpline, X::Apic, U::Usl) => {
                        Method::new(QuadraticBSpline, Apic, Usl, space).into_kernels()
                    }
                    (S::QuadraticBSpline, X::Aflip, U::Usl) => {
                        Method::new(QuadraticBSpline, Aflip::default(), Usl, space).into_kernels()
                    }
                    (S::QuadraticBSpline, X::Mls, U::Usl) => {
                        Method::new(QuadraticBSpline, Mls, Usl, space).into_kernels()
                    }
                    _ => {
                        return wrong(
                            key,
                            format!(
                                "no kernels of these together are compiled in this program; there are {}",
                                PARTS
                            ),
                        );
                    }
                })
            }
        }
    }};
}

macro_rules! settings {
    ($($space:ty, $d:literal;)*) => {$(
        impl Setting<$d> for $space {
            fn kernels(self, options: &Mpm) -> Made<Kernels<f64, $d>> {
                kernels!(self, options)
            }
        }
    )*};
}
settings! {
    FullSpace, 3;
    PlaneStrain, 2;
    Axisymmetric, 2;
}
