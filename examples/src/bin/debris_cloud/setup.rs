//! Sizes, and what to run.

use examples::CaseError;
use mpm_core::{Blend, CpGimp, Method, Musl};
use mpm_materials::{
    BulkViscosity, Expanding, JohnsonCook, PlasticStrainLimit, Solid, TensilePressure, library,
};

/// Radius of the sphere, m.
pub const RADIUS: f64 = 7.5e-3;
/// Thickness of the plate, m.
pub const THICKNESS: f64 = 6.36e-3;
/// Half the edge of the plate of the deck, m.
pub const HALF_WIDTH: f64 = 80.03e-3;
/// Impact speed, m/s.
pub const SPEED: f64 = 6580.0;
/// End of a run, s.
pub const END: f64 = 30.0e-6;
/// Of lead: density, kg/m^3, c0, m/s, s, as the deck has them.
pub const SHOCK: [f64; 3] = [11350.0, 2092.0, 1.45];
/// Plastic strain at which lead fails in the deck.
const FAILURE_STRAIN: f64 = 3.0;

/// Tension that lead bears at these rates, Pa \[M\]. The deck prints none; its release log says that tensile failure sets the
/// pressure to zero.
const SPALL: f64 = 0.4e9;

/// The law of both bodies.
pub type Lead = Solid<
    JohnsonCook<f64>,
    Expanding<f64>,
    (PlasticStrainLimit<f64>, TensilePressure<f64>),
    BulkViscosity<f64>,
>;

/// Lead of the library; in expansion gamma is constant instead of rho gamma, so that a cloud that is a hundred times
/// thinner has lost its thermal pressure, too.
pub fn equation_of_state() -> Expanding<f64> {
    Expanding::new(*library::lead().eos())
}

/// That and the strength of lead, failing as in the deck, and in tension.
pub fn lead(viscosity: [f64; 2]) -> Result<Lead, CaseError> {
    let [linear, quadratic] = viscosity;
    let failure = (PlasticStrainLimit::new(FAILURE_STRAIN)?, TensilePressure::new(SPALL)?);
    Ok(Solid::new(*library::lead().strength(), equation_of_state())
        .with_failure(failure)
        .with_bulk_viscosity(linear, quadratic)?)
}

/// How the stretch of particles is met.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Cutting {
    /// Stretch to split at.
    pub stretch: f64,
    /// Most cuts of a seed.
    pub generations: u32,
}

/// What the plate is made of.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Plate {
    /// Particles
    Mpm,
    /// Elements as large as cells that become particles near the sphere, where they fail and where they are deformed too far
    Afemp,
}

/// What to run.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Setup {
    /// Particles across the plate.
    pub layers: u32,
    /// Half the edge of the plate, m.
    pub half_width: f64,
    /// What the plate is made of.
    pub method: Plate,
    /// Splitting, if any.
    pub cutting: Option<Cutting>,
    /// Linear and quadratic coefficient of the bulk viscosity.
    pub viscosity: [f64; 2],
    /// FLIP's memory, in transits of a cell by sound at rest.
    pub memory: f64,
    /// Of the time step.
    pub factor: f64,
    /// Threads.
    pub threads: usize,
}

impl Setup {
    /// Distance of seeds, m.
    pub fn edge(&self) -> f64 {
        THICKNESS / f64::from(self.layers)
    }
    /// Node spacing, m: two particles along it.
    pub fn spacing(&self) -> f64 {
        2.0 * self.edge()
    }
    /// The method, in any space. (Linear shape functions miss the state behind the shock by 2 % in cells in which this does by 0.6 %.)
    pub fn method<E>(&self, space: E) -> Result<Method<CpGimp, Blend<f64>, Musl, E>, CaseError> {
        let blend = Blend::new(self.memory * self.spacing() / SHOCK[1])?;
        Ok(Method::new(CpGimp, blend, Musl, space))
    }
    /// As in the names of files.
    pub fn name(&self) -> &'static str {
        match (self.method, self.cutting) {
            (Plate::Afemp, _) => "afemp",
            (_, Some(_)) => "split",
            (_, None) => "whole",
        }
    }
}
