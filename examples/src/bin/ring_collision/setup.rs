//! Parameters of a run, by name.

use clap::ValueEnum;
use examples::{Detection, Law};
use serde::Serialize;

/// The stress update.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Scheme {
    /// Stress first
    Usf,
    /// Stress from the momentum mapped a second time
    Musl,
}

/// Where particles start.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Seeding {
    /// In circles, so that the outermost ones touch the surface
    Circles,
    /// On a square lattice, which makes stairs of the surface
    Lattice,
}

/// The shape function.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Kernel {
    /// Bilinear shape functions, as in the paper
    Linear,
    /// GIMP with domains that follow the deformation, half sizes of particles included
    Cpgimp,
}

macro_rules! names {
    ($($type:ty),*) => {$(
        impl $type {
            /// Return the name on the command line.
            pub fn name(self) -> String {
                self.to_possible_value().map_or_else(String::new, |v| v.get_name().to_string())
            }
        }
    )*};
}
names!(Scheme, Kernel);

/// Parameters of a run.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Setup {
    pub seeding: Seeding,
    pub kernel: Kernel,
    pub scheme: Scheme,
    pub detection: Detection,
    pub law: Law,
    /// Cell size, m; particles are half as far apart.
    pub cell: f64,
    pub friction: f64,
    /// Offset of the centres normal to the direction of flight, m.
    pub offset: f64,
    /// Time factor: time step over h / (c + |v|).
    pub factor: f64,
}

impl Setup {
    /// Return the name in file names.
    pub fn name(&self) -> String {
        let [kernel, scheme] = [self.kernel.name(), self.scheme.name()];
        format!("{kernel}_{scheme}_{}_{:.0}um", self.detection.name(), 1e6 * self.cell)
    }
}
