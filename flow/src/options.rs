//! Options of a scene and constants of a liquid.

use std::sync::Arc;

use impactite_geometry::Lattice;
use impactite_scene::SceneError;

use crate::blocks::SIDE;

/// Default share of the density error that is corrected in a step.
const CORRECTION: f64 = 0.25;
/// Default shares of the semi-staggered scheme: of hourglass modes, of PIC.
const HOURGLASS: f64 = 0.05;
const PIC: f64 = 0.03;
/// Default tolerance of the pressure solve, relative to the right-hand side.
const TOLERANCE: f64 = 1e-10;

/// Options of a [`Flow`](crate::Flow): grid, periods, tolerances.
#[derive(Clone, Debug, PartialEq)]
pub struct FlowOptions<const D: usize> {
    pub(crate) lattice: Lattice<D>,
    /// Period along each axis, in blocks; 0 without.
    pub(crate) period: [i32; D],
    pub(crate) correction: f64,
    pub(crate) tolerance: f64,
    pub(crate) ambient: f64,
    pub(crate) reflection: bool,
    pub(crate) semi_staggered: Option<SemiStaggered>,
}

/// Parameters of the semi-staggered scheme, as printed: velocities at nodes and the pressure at the centres of cells \[Zhang2017b\].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SemiStaggered {
    pub(crate) hourglass: f64,
    pub(crate) pic: f64,
}

impl Default for SemiStaggered {
    /// The share 0.05 of the hourglass modes, and 0.03 of PIC.
    fn default() -> Self {
        SemiStaggered { hourglass: HOURGLASS, pic: PIC }
    }
}

impl SemiStaggered {
    /// Set the share alpha of the hourglass modes that a step filters from the nodal velocity, 0 to 0.25; default is 0.05.
    ///
    /// # Errors
    /// A share out of range.
    pub fn with_hourglass(mut self, alpha: f64) -> Result<Self, SceneError> {
        parameter((0.0..=0.25).contains(&alpha), "hourglass", alpha, "from 0 to 0.25")?;
        self.hourglass = alpha;
        Ok(self)
    }
    /// Set the share of PIC in the velocity of particles, 0 to 1; the rest is FLIP. Default is 0.03.
    ///
    /// # Errors
    /// A share out of range.
    pub fn with_pic(mut self, share: f64) -> Result<Self, SceneError> {
        parameter((0.0..=1.0).contains(&share), "pic", share, "from 0 to 1")?;
        self.pic = share;
        Ok(self)
    }
}

impl<const D: usize> FlowOptions<D> {
    /// Create options for a grid: cells of the lattice with the pressure at their centres and velocity components at their faces.
    pub fn new(lattice: Lattice<D>) -> Self {
        FlowOptions {
            lattice,
            period: [0; D],
            correction: CORRECTION,
            tolerance: TOLERANCE,
            ambient: 0.0,
            reflection: true,
            semi_staggered: None,
        }
    }

    /// Make the scene periodic along an axis, with a period of so many cells from the origin of the lattice.
    ///
    /// # Errors
    /// An axis beyond the dimension; a period that is no positive multiple of 4 cells.
    pub fn periodic(mut self, axis: usize, cells: usize) -> Result<Self, SceneError> {
        parameter(axis < D, "axis", axis as f64, "below the dimension")?;
        let allowed = "a positive multiple of 4 cells, at most 2^20";
        let fits = cells > 0 && cells.is_multiple_of(SIDE) && cells <= 1 << 20;
        parameter(fits, "period", cells as f64, allowed)?;
        self.period[axis] = (cells / SIDE) as i32;
        Ok(self)
    }

    /// Set the relaxation of the density correction, 0 to 1: the share of the density error of a cell that a step removes. 0 switches the
    /// correction off; default is 0.25.
    ///
    /// # Errors
    /// A share out of range.
    pub fn density_correction(mut self, share: f64) -> Result<Self, SceneError> {
        parameter((0.0..=1.0).contains(&share), "density correction", share, "from 0 to 1")?;
        self.correction = share;
        Ok(self)
    }

    /// Set the tolerance of the pressure solve: the norm of the residual over that of the right-hand side. Default is 1e-10.
    ///
    /// # Errors
    /// A tolerance out of range.
    pub fn tolerance(mut self, relative: f64) -> Result<Self, SceneError> {
        parameter((1e-14..=1e-2).contains(&relative), "tolerance", relative, "from 1e-14 to 1e-2")?;
        self.tolerance = relative;
        Ok(self)
    }

    /// Set the ambient pressure at the surface, Pa; default is 0. It shifts all pressures of liquid with a surface, and no motion depends
    /// on it.
    ///
    /// # Errors
    /// A pressure that is not finite.
    pub fn ambient_pressure(mut self, pressure: f64) -> Result<Self, SceneError> {
        parameter(pressure.is_finite(), "ambient pressure", pressure, "finite")?;
        self.ambient = pressure;
        Ok(self)
    }

    /// Project velocities as they are, without the reflection of smooth motion: first order in time, as in most codes of this kind.
    pub fn without_reflection(mut self) -> Self {
        self.reflection = false;
        self
    }

    /// Take the semi-staggered scheme instead of the staggered one, for comparison with it: first order in time, without reflection and
    /// without correction of the density. Walls are lines of the grid that do not move, and no bodies are in the liquid.
    pub fn semi_staggered(mut self, with: SemiStaggered) -> Self {
        self.semi_staggered = Some(with);
        self.reflection = false;
        self.correction = 0.0;
        self
    }

    /// Grid.
    pub fn lattice(&self) -> &Lattice<D> {
        &self.lattice
    }
}

/// Constants of an incompressible Newtonian liquid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fluid {
    pub(crate) density: f64,
    pub(crate) viscosity: f64,
    pub(crate) tension: f64,
}

impl Fluid {
    /// Create an inviscid liquid without surface tension, of density rho, kg/m^3.
    ///
    /// # Errors
    /// A density that is not positive and finite.
    pub fn new(density: f64) -> Result<Self, SceneError> {
        parameter(density > 0.0 && density.is_finite(), "density", density, "positive and finite")?;
        Ok(Fluid { density, viscosity: 0.0, tension: 0.0 })
    }
    /// Set the dynamic viscosity mu, Pa s.
    ///
    /// # Errors
    /// A viscosity that is negative or not finite.
    pub fn with_viscosity(mut self, viscosity: f64) -> Result<Self, SceneError> {
        let allowed = "zero or positive, and finite";
        parameter(viscosity >= 0.0 && viscosity.is_finite(), "viscosity", viscosity, allowed)?;
        self.viscosity = viscosity;
        Ok(self)
    }
    /// Set the surface tension sigma, N/m.
    ///
    /// # Errors
    /// A surface tension that is negative or not finite.
    pub fn with_surface_tension(mut self, tension: f64) -> Result<Self, SceneError> {
        let allowed = "zero or positive, and finite";
        parameter(tension >= 0.0 && tension.is_finite(), "surface tension", tension, allowed)?;
        self.tension = tension;
        Ok(self)
    }
    /// Density rho, kg/m^3.
    pub fn density(&self) -> f64 {
        self.density
    }
    /// Dynamic viscosity mu, Pa s.
    pub fn viscosity(&self) -> f64 {
        self.viscosity
    }
    /// Surface tension sigma, N/m.
    pub fn surface_tension(&self) -> f64 {
        self.tension
    }
}

/// Check a parameter of a flow.
pub(crate) fn parameter(
    fits: bool,
    field: &'static str,
    value: f64,
    allowed: &'static str,
) -> Result<(), SceneError> {
    if fits { Ok(()) } else { Err(SceneError::Parameter { owner: "flow", field, value, allowed }) }
}

/// Acceleration by place, m, and time, s, m/s^2, and what was found of it.
pub(crate) struct ForceField<const D: usize> {
    pub of: Arc<dyn Fn([f64; D], f64) -> [f64; D] + Send + Sync>,
    /// Largest magnitude on the liquid in the last step, m/s^2.
    pub strongest: f64,
    /// Impulse in the present step, N s.
    pub load: [f64; D],
}
