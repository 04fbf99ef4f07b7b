//! Dimensions and parameters of a run.

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
/// Constants of lead as in the deck: density, kg/m^3, c0, m/s, s.
pub const SHOCK: [f64; 3] = [11350.0, 2092.0, 1.45];
/// Plastic strain at which lead fails in the deck.
const FAILURE_STRAIN: f64 = 3.0;

/// Spall strength of lead at these rates, Pa \[M\]. The deck states none; its release log says that tensile failure sets
/// the pressure to zero.
const SPALL: f64 = 0.4e9;

/// Law of both bodies.
pub type Lead = Solid<
    JohnsonCook<f64>,
    Expanding<f64>,
    (PlasticStrainLimit<f64>, TensilePressure<f64>),
    BulkViscosity<f64>,
>;

/// Return the equation of state of lead from the library; in expansion gamma is constant instead of rho gamma, so that a
/// cloud of a hundredth of the density has lost its thermal pressure, too.
pub fn equation_of_state() -> Expanding<f64> {
    Expanding::new(*library::lead().eos())
}

/// Return the law of lead: equation of state, strength, failure by plastic strain as in the deck, failure in tension.
pub fn lead(viscosity: [f64; 2]) -> Result<Lead, CaseError> {
    let [linear, quadratic] = viscosity;
    let failure = (PlasticStrainLimit::new(FAILURE_STRAIN)?, TensilePressure::new(SPALL)?);
    Ok(Solid::new(*library::lead().strength(), equation_of_state())
        .with_failure(failure)
        .with_bulk_viscosity(linear, quadratic)?)
}

/// Splitting of stretched particles.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Cutting {
    /// Stretch at which a particle is split.
    pub stretch: f64,
    /// Maximum number of splits of a seed.
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

/// Parameters of a run.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Setup {
    /// Number of particles across the plate.
    pub layers: u32,
    /// Half the edge of the plate, m.
    pub half_width: f64,
    /// Discretisation of the plate.
    pub method: Plate,
    /// Splitting of particles, if any.
    pub cutting: Option<Cutting>,
    /// Linear and quadratic coefficient of the bulk viscosity.
    pub viscosity: [f64; 2],
    /// Memory of FLIP, in transits of a cell by sound at rest.
    pub memory: f64,
    /// Courant factor of the time step.
    pub factor: f64,
    /// Number of threads.
    pub threads: usize,
}

impl Setup {
    /// Spacing of seeds, m.
    pub fn edge(&self) -> f64 {
        THICKNESS / f64::from(self.layers)
    }
    /// Node spacing, m: two particles along it.
    pub fn spacing(&self) -> f64 {
        2.0 * self.edge()
    }
    /// Return the method, in any space. In the same cells linear shape functions have an error of 2 % behind the shock, CPGIMP 0.6 %.
    pub fn method<E>(&self, space: E) -> Result<Method<CpGimp, Blend<f64>, Musl, E>, CaseError> {
        let blend = Blend::new(self.memory * self.spacing() / SHOCK[1])?;
        Ok(Method::new(CpGimp, blend, Musl, space))
    }
    /// Name in files.
    pub fn name(&self) -> &'static str {
        match (self.method, self.cutting) {
            (Plate::Afemp, _) => "afemp",
            (_, Some(_)) => "split",
            (_, None) => "whole",
        }
    }
}
