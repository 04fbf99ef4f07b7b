//! Contact law selected at run time.

use clap::ValueEnum;
use mpm_contact::{Coulomb, Frictionless, Pairs, Penalty, Stick};
use serde::Serialize;

use crate::CaseError;

/// What bodies do to each other where they touch.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Law {
    /// They stop each other and slide freely
    Frictionless,
    /// They stop each other and slide with friction
    Coulomb,
    /// They push each other apart by a spring where they overlap, with friction
    Penalty,
    /// They stick while they touch
    Stick,
}

impl Law {
    /// Spring of [`Law::Penalty`]: frequency over c / h, and restitution (book, "Contact laws against the cases").
    pub const SPRING: [f64; 2] = [0.9, 0.8];

    /// Name on the command line.
    pub fn name(self) -> String {
        self.to_possible_value().map_or_else(String::new, |v| v.get_name().to_string())
    }

    /// Return the law of all pairs with this coefficient of friction, for bodies of this wave speed, m/s, in cells of `spacing`, m.
    ///
    /// # Errors
    /// Negative coefficient; speed or spacing that is not positive.
    pub fn pairs(self, friction: f64, wave: f64, spacing: f64) -> Result<Pairs<f64>, CaseError> {
        let [frequency, restitution] = Law::SPRING;
        Ok(match self {
            Law::Frictionless => Pairs::new(Frictionless),
            Law::Coulomb => Pairs::new(Coulomb::new(friction)?),
            Law::Penalty => Pairs::new(Penalty::of_cells(frequency, [wave, spacing], restitution, friction)?),
            Law::Stick => Pairs::new(Stick),
        })
    }
}
