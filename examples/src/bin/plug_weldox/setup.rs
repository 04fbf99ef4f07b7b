//! Projectile, plate and laws.

use clap::ValueEnum;
use examples::CaseError;
use examples::plug::Plug;
pub use examples::plug::{PLATE, PROJECTILE};
use mpm_materials::{Constitutive, library};
use sph::{Composition, Layout, Sph};

/// Linear and quadratic coefficient of the bulk viscosity \[M\]; the paper has none.
const BULK_VISCOSITY: [f64; 2] = [0.5, 4.0];

/// Constants of Weldox 460 E.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Constants {
    /// Borvik 2001, coupled to damage: 490 MPa, 807 MPa, 0.73
    #[value(name = "2001")]
    Coupled,
    /// The later set, whose damage does not soften: 499 MPa, 382 MPa, 0.458
    #[value(name = "later")]
    Later,
}

impl Constants {
    /// Return the name in tables and files.
    pub fn name(self) -> &'static str {
        match self {
            Constants::Coupled => "2001",
            Constants::Later => "later",
        }
    }
    /// Return the state variable of damage, and its value at failure.
    pub fn damage(self) -> (&'static str, f64) {
        match self {
            Constants::Coupled => ("damage", 0.30),
            Constants::Later => ("failure_damage", 1.0),
        }
    }
    /// Return the density, kg/m^3.
    pub fn density(self) -> f64 {
        match self {
            Constants::Coupled => Constitutive::<f64>::density(&library::weldox_460_e::<f64>()),
            Constants::Later => Constitutive::<f64>::density(&library::weldox_460_e_uncoupled::<f64>()),
        }
    }
}

/// Form of the particles.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Form {
    /// As printed: cubic spline, gradients as they are, for projectile and plate
    Printed,
    /// The plate in the updated form with corrected gradients; the projectile, which stays whole, in the total Lagrangian one
    Updated,
    /// The projectile as there; the plate in the total Lagrangian form, whose reference is renewed whenever something is stretched by 5 %
    Renewed,
}

impl Form {
    /// Return the name in tables and files.
    pub fn name(self) -> &'static str {
        match self {
            Form::Printed => "printed",
            Form::Updated => "updated",
            Form::Renewed => "renewed",
        }
    }
}

/// Parameters of a shot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Setup {
    pub constants: Constants,
    pub form: Form,
    /// Impact speed, m/s.
    pub speed: f64,
    /// Requested spacing in the projectile and in the plate in front of it, m; the nearest that fits the radius is used.
    pub spacing: f64,
    /// Coefficient of friction between projectile and plate.
    pub friction: f64,
    /// End of the run, s.
    pub end: f64,
    pub threads: usize,
}

impl Setup {
    /// Return the name in tables and file names.
    pub fn name(&self) -> &'static str {
        self.constants.name()
    }

    /// Return the number of spacings per projectile radius.
    pub fn cells(&self) -> usize {
        (PROJECTILE[0] / self.spacing).round().max(2.0) as usize
    }

    /// Return projectile and plate as particles.
    fn plug(&self) -> Plug {
        Plug { cells: self.cells() }
    }

    /// Return the spacing in the fine region, m.
    pub fn fine(&self) -> f64 {
        self.plug().fine()
    }

    /// Return the number of particles through the plate in the fine region.
    pub fn rows(&self) -> f64 {
        (PLATE[1] / self.fine()).round()
    }

    /// Generate the particles of the plate.
    pub fn plate(&self) -> Result<Layout<2>, CaseError> {
        self.plug().plate()
    }

    /// Return the radius from which the plate is clamped, m: two columns.
    pub fn rim(&self) -> f64 {
        PLATE[0] - 2.0 * self.plug().coarse()
    }

    /// Build the moving projectile by a method.
    pub fn flying<M: Composition<2>>(&self, method: M) -> Result<Sph<2, M>, CaseError> {
        let [linear, quadratic] = BULK_VISCOSITY;
        let steel = library::arne_tool_steel().with_bulk_viscosity(linear, quadratic)?;
        let speed = self.speed;
        Ok(Sph::new(method, steel, &self.plug().projectile()?, |_| [0.0, speed])?)
    }

    /// Build the plate at rest by a method.
    pub fn resting<M: Composition<2>>(&self, method: M) -> Result<Sph<2, M>, CaseError> {
        let [linear, quadratic] = BULK_VISCOSITY;
        let (layout, rest) = (self.plate()?, |_| [0.0; 2]);
        Ok(match self.constants {
            Constants::Coupled => {
                let steel = library::weldox_460_e().with_bulk_viscosity(linear, quadratic)?;
                Sph::new(method, steel, &layout, rest)?
            }
            Constants::Later => {
                let steel = library::weldox_460_e_uncoupled().with_bulk_viscosity(linear, quadratic)?;
                Sph::new(method, steel.compiled(), &layout, rest)?
            }
        })
    }

    /// Exact masses of projectile and plate, kg per radian.
    pub fn masses(&self) -> [f64; 2] {
        let arne: f64 = library::arne_tool_steel::<f64>().density();
        let sizes = [(arne, PROJECTILE), (self.constants.density(), PLATE)];
        sizes.map(|(density, [radius, length])| 0.5 * density * radius * radius * length)
    }
}
