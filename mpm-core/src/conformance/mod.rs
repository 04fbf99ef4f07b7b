//! Conformance tests for shape functions, transfers, grids, composed methods and contact detectors. One line applies
//! them to any implementation, of this crate or a custom one. Requires the feature `conformance`.
//!
//! ```
//! mpm_core::conforms! {
//!     the_hat: shape_function::<_, 3>(&mpm_core::Linear);
//!     the_blocks: grid::<_, 2>(mpm_core::BlockGrid::new);
//!     relaxed: transfer(mpm_core::Pic);
//! }
//! ```
//! Each line becomes a `#[test]`. The functions can also be called; they return the first [`Broken`] property.

mod contact;
mod grid;
mod method;
mod shape;

pub use contact::{detector, detector_and_law};
pub use grid::grid;
pub use method::{method, transfer};
pub use shape::{affine_shape, convected, shape_function, smooth};

/// Violated property.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{subject}: {property} does not hold: {detail}")]
pub struct Broken {
    /// Name of the tested object.
    pub subject: String,
    /// Description of the property.
    pub property: &'static str,
    /// Location and magnitude of the violation.
    pub detail: String,
}

/// Check that `error` is at most `allowed`; a value that is not a number fails.
fn within(
    subject: &str,
    property: &'static str,
    error: f64,
    allowed: f64,
    detail: impl FnOnce() -> String,
) -> Result<(), Broken> {
    if error <= allowed {
        return Ok(());
    }
    let detail = format!("{}; error {error:.3e}, allowed {allowed:.3e}", detail());
    Err(Broken { subject: subject.into(), property, detail })
}

/// Make a `#[test]` of each line `name: suite(arguments);` where `suite` is a function of
/// [`conformance`](crate::conformance).
#[macro_export]
macro_rules! conforms {
    ($($name:ident: $suite:ident $(::<$($type:tt),*>)? ($($argument:expr),* $(,)?);)*) => {$(
        #[test]
        fn $name() {
            if let Err(broken) = $crate::conformance::$suite $(::<$($type),*>)? ($($argument),*) {
                panic!("{broken}");
            }
        }
    )*};
}
