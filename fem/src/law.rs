//! Initial moduli and wave speed of a law, for frequency bounds and hourglass control.

use impactite_scene::SceneError;
use mpm_materials::material::{Deformation, Length, Material, Motion, Response, States, StatesMut};

use crate::sweep::Row;

/// Initial moduli and wave speed of a law, found by straining a virgin point.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Probe {
    /// Reference density, kg/m^3.
    pub density: f64,
    /// Shear modulus G, Pa.
    pub shear: f64,
    /// Bulk modulus K = rho c^2 - 4 G / 3, Pa.
    pub bulk: f64,
    /// Speed of longitudinal waves, m/s.
    pub speed: f64,
    /// Bulk viscosity coefficients ([`Material::shock_viscosity`]).
    pub shock: [f64; 2],
    /// True if the volume change by the law differs from that of the motion, as for plates that become thinner.
    pub apart: bool,
}

/// Probe strains: compression, so that laws without tensile strength carry shear; and shear.
const STRAINS: [f64; 2] = [1e-8, 1e-9];
/// Relative tolerance of the volume change by the law against that of the motion.
const APART: f64 = 1e-3;

impl Probe {
    /// Probe a law.
    ///
    /// # Errors
    /// Density that is not positive and finite.
    pub fn of(material: &dyn Material<f64>) -> Result<Self, SceneError> {
        let density = material.density();
        if !(density > 0.0 && density.is_finite()) {
            return Err(SceneError::Density { law: material.name(), density });
        }
        let row = |x: f64| {
            let mut row = Row::default();
            row.as_mut().fill(x);
            row
        };
        let mut rows: Vec<Row> = material.virgin().into_iter().map(row).collect();
        let (stride, groups, mut response) = (material.numbers(), &[0][..], Response::default());
        material.describe(States { all: &rows, stride, first: 0, groups }, f64::INFINITY, &mut response);
        let speed = response.outputs()[0].step_speed.0[0].as_ref()[0];
        let before = response.outputs()[0].volume_ratio.0[0].as_ref()[0];
        let mut deformation = [Deformation::default()];
        let [closed, sheared] = STRAINS;
        for (place, strain) in [(0, -closed), (4, -closed), (8, -closed), (1, sheared)] {
            deformation[0].gradient[place].0[0] = row(strain);
        }
        deformation[0].step.0[0] = row(1.0);
        // A long step makes viscous stresses negligible.
        let motion = Motion { deformation: &deformation, dt: 1.0, length: Length::Same(1.0) };
        let states = StatesMut { all: &mut rows, stride, first: 0, groups };
        material.advance(&motion, states, false, &mut response);
        let shear = (response.outputs()[0].stress[5].0[0].as_ref()[0] / sheared).max(0.0);
        let less = 1.0 - response.outputs()[0].volume_ratio.0[0].as_ref()[0] / before;
        let apart = (less / (3.0 * closed) - 1.0).abs() > APART;
        let bulk = (density * speed * speed - 4.0 / 3.0 * shear).max(0.0);
        Ok(Probe { density, shear, bulk, speed, shock: material.shock_viscosity(), apart })
    }

    /// Modulus of hourglass springs, Pa: the shear modulus, or a hundredth of the bulk modulus for a law without one.
    pub fn hourglass_modulus(&self) -> f64 {
        if self.shear > 1e-6 * self.bulk { self.shear } else { 0.01 * self.bulk }
    }
}
