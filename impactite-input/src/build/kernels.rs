//! Kernels of the material point method, and the embedding of scenes in space.

use impactite::mpm::{
    Aflip, Apic, Axisymmetric, Blend, CpGimp, Flip, FullSpace, IntoKernels, Kernels, Linear, Method, Mls,
    Musl, PlaneStrain, QuadraticBSpline, Usl,
};
use impactite::scene::Embedding;
use serde::Serialize;

use super::wrong::{At, Made, wrong};
use crate::model::method::{Mpm, Purpose, ShapeFunction, StressUpdate, Transfer};

/// Embedding of a scene in space, with its kernels.
pub(crate) trait Setting<const D: usize>: Embedding<D> + std::fmt::Debug + Copy {
    /// Return the kernels of the material point method.
    fn kernels(self, options: &Mpm) -> Made<Kernels<f64, D>>;
}

/// Combinations of parts whose kernels are compiled in this program: key of the shape function, its type, transfer, stress update. One list
/// serves the documentation and the kernels.
macro_rules! combinations {
    ($made:ident! $rest:tt) => {
        $made! {
            $rest
            (Linear, Linear, Flip, Musl)
            (Linear, Linear, Blend, Musl)
            (Cpgimp, CpGimp, Flip, Musl)
            (Cpgimp, CpGimp, Flip, Usl)
            (Cpgimp, CpGimp, Blend, Musl)
            (QuadraticBSpline, QuadraticBSpline, Flip, Musl)
            (QuadraticBSpline, QuadraticBSpline, Apic, Usl)
            (QuadraticBSpline, QuadraticBSpline, Aflip, Usl)
            (QuadraticBSpline, QuadraticBSpline, Mls, Usl)
        }
    };
}

macro_rules! list {
    (() $(($word:ident, $shape:ident, $transfer:ident, $update:ident))*) => {
        /// Compiled combinations of parts.
        pub(crate) const PARTS: &[(ShapeFunction, Transfer, StressUpdate)] =
            &[$((ShapeFunction::$word, Transfer::$transfer, StressUpdate::$update)),*];
    };
}
combinations!(list!());

/// Parts and frame of each purpose.
pub(crate) const PURPOSES: &[(Purpose, ShapeFunction, Transfer, StressUpdate, &str)] = &[
    (
        Purpose::Impact,
        ShapeFunction::QuadraticBSpline,
        Transfer::Aflip,
        StressUpdate::Usl,
        "updated Lagrangian",
    ),
    (
        Purpose::ContactAtRest,
        ShapeFunction::QuadraticBSpline,
        Transfer::Apic,
        StressUpdate::Usl,
        "updated Lagrangian",
    ),
    (Purpose::MachineParts, ShapeFunction::Cpgimp, Transfer::Flip, StressUpdate::Musl, "updated Lagrangian"),
    (Purpose::LargeElastic, ShapeFunction::Linear, Transfer::Flip, StressUpdate::Musl, "total Lagrangian"),
];

/// Return the key of a choice in scene files.
pub(crate) fn word(choice: impl Serialize) -> String {
    let value = serde_json::to_value(choice).unwrap_or_default();
    value.as_str().unwrap_or_default().to_string()
}

fn not_compiled() -> String {
    let list = PARTS.iter().map(|(s, x, u)| format!("{}, {}, {}", word(s), word(x), word(u)));
    let list = list.collect::<Vec<_>>().join("; ");
    format!("this combination is not compiled in the program; there are: {list} (`impactite list parts`)")
}

/// Construct a transfer from the options of the parts.
macro_rules! transfer {
    (Flip, $parts:expr) => {
        Flip
    };
    (Apic, $parts:expr) => {
        Apic
    };
    (Mls, $parts:expr) => {
        Mls
    };
    (Aflip, $parts:expr) => {
        Aflip::default()
    };
    (Blend, $parts:expr) => {{
        let relaxation = $parts.relaxation.map_or(0.0, |q| q.value);
        Blend::new(relaxation).at("method.mpm.parts.relaxation")?
    }};
}

macro_rules! of_parts {
    (($parts:ident, $space:ident) $(($word:ident, $shape:ident, $transfer:ident, $update:ident))*) => {
        match ($parts.shape_function, $parts.transfer, $parts.stress_update) {
            $((ShapeFunction::$word, Transfer::$transfer, StressUpdate::$update) => {
                Method::new($shape, transfer!($transfer, $parts), $update, $space).into_kernels()
            })*
            _ => return wrong("method.mpm.parts", not_compiled()),
        }
    };
}

/// Return the kernels for the options of the method in one of the embeddings.
macro_rules! kernels {
    ($space:ident, $options:ident) => {
        match (&$options.parts, $options.purpose) {
            (Some(_), Some(_)) => wrong("method.mpm.parts", "either `for` or `parts`: leave `for` out, and write `shape_function`, `transfer` and `stress_update`"),
            (None, purpose) => Ok(match purpose.unwrap_or_default() {
                Purpose::Impact => Method::impact($space).into_kernels(),
                Purpose::ContactAtRest => Method::contact_at_rest($space).into_kernels(),
                Purpose::MachineParts => Method::machine_parts($space).into_kernels(),
                Purpose::LargeElastic => Method::large_elastic($space).into_kernels(),
            }),
            (Some(parts), None) => {
                if parts.relaxation.is_some() != (parts.transfer == Transfer::Blend) {
                    return wrong(
                        "method.mpm.parts",
                        "`relaxation` is of the transfer `blend`, which needs it",
                    );
                }
                Ok(combinations!(of_parts!(parts, $space)))
            }
        }
    };
}

macro_rules! settings {
    ($($space:ty, $d:literal;)*) => {$(
        impl Setting<$d> for $space {
            fn kernels(self, options: &Mpm) -> Made<Kernels<f64, $d>> {
                let space = self;
                kernels!(space, options)
            }
        }
    )*};
}
settings! {
    FullSpace, 3;
    PlaneStrain, 2;
    Axisymmetric, 2;
}
