//! Checks of material parameters.

use crate::lane::Real;

/// Parameter outside the range that a law allows.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{law}: {parameter} = {value} is not allowed; it must be {allowed}")]
pub struct ParameterError {
    /// Name of the law.
    pub law: &'static str,
    /// Name of the parameter.
    pub parameter: &'static str,
    /// Invalid value.
    pub value: f64,
    /// Allowed range, in words.
    pub allowed: &'static str,
}

/// Parameter checks of one law.
#[derive(Clone, Copy, Debug)]
pub struct Check(
    /// Name of the law.
    pub &'static str,
);

impl Check {
    /// Return `value` if `holds`, else an error with the `allowed` range. A value that is not finite never passes.
    ///
    /// # Errors
    /// [`ParameterError`] with law, parameter, value and allowed range.
    pub fn that<T: Real>(
        self,
        holds: bool,
        parameter: &'static str,
        value: T,
        allowed: &'static str,
    ) -> Result<T, ParameterError> {
        let given = value.to_double();
        if holds && given.is_finite() {
            Ok(value)
        } else {
            Err(ParameterError { law: self.0, parameter, value: given, allowed })
        }
    }
    /// Return `value` if it is positive.
    ///
    /// # Errors
    /// See [`Check::that`].
    pub fn positive<T: Real>(self, parameter: &'static str, value: T) -> Result<T, ParameterError> {
        self.that(value > T::of(0.0), parameter, value, "positive")
    }
    /// Return `value` if it is zero or positive.
    ///
    /// # Errors
    /// See [`Check::that`].
    pub fn not_negative<T: Real>(self, parameter: &'static str, value: T) -> Result<T, ParameterError> {
        self.that(value >= T::of(0.0), parameter, value, "zero or positive")
    }
}
