//! Bad parameters are refused where they enter.

use crate::lane::Real;

/// A parameter outside what a law allows.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{law}: {parameter} = {value} is not allowed; it must be {allowed}")]
pub struct ParameterError {
    /// The law.
    pub law: &'static str,
    /// The field.
    pub parameter: &'static str,
    /// What was given.
    pub value: f64,
    /// What is allowed, in words.
    pub allowed: &'static str,
}

/// Refuses the parameters of one law.
#[derive(Clone, Copy, Debug)]
pub struct Check(
    /// The law's name.
    pub &'static str,
);

impl Check {
    /// `value` if `holds`, else an error that says what is `allowed`. A value that is not finite never passes.
    ///
    /// # Errors
    /// [`ParameterError`] naming law, parameter, value and what is allowed.
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
    /// `value` if it is positive.
    ///
    /// # Errors
    /// As [`Check::that`].
    pub fn positive<T: Real>(self, parameter: &'static str, value: T) -> Result<T, ParameterError> {
        self.that(value > T::of(0.0), parameter, value, "positive")
    }
    /// `value` if it is zero or positive.
    ///
    /// # Errors
    /// As [`Check::that`].
    pub fn not_negative<T: Real>(self, parameter: &'static str, value: T) -> Result<T, ParameterError> {
        self.that(value >= T::of(0.0), parameter, value, "zero or positive")
    }
}
