//! What elements must know of a law beside its stresses.

use impactite_scene::SceneError;
use mpm_materials::material::{Deformation, Length, Material, Motion, Response, States, StatesMut};

use crate::sweep::Row;

/// Moduli and wave speed of a law at rest, found by straining a virgin point.
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
    /// [`Material::shock_viscosity`].
    pub shock: [f64; 2],
    /// Is its change of volume not that of the motion, as that of plates that become thinner?
    pub apart: bool,
}

/// Compression of the point, so that laws that carry no tension carry shear, and the shear strain.
const STRAINS: [f64; 2] = [1e-8, 1e-9];
/// What the change of volume may differ by from that of the motion by rounding, over it.
const APART: f64 = 1e-3;

impl Probe {
    /// Of this law.
    ///
    /// # Errors
    /// A density that is not positive.
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
        // In a long step, so that what is viscous has no part in it.
        let motion = Motion { deformation: &deformation, dt: 1.0, length: Length::Same(1.0) };
        let states = StatesMut { all: &mut rows, stride, first: 0, groups };
        material.advance(&motion, states, false, &mut response);
        let shear = (response.outputs()[0].stress[5].0[0].as_ref()[0] / sheared).max(0.0);
        let less = 1.0 - response.outputs()[0].volume_ratio.0[0].as_ref()[0] / before;
        let apart = (less / (3.0 * closed) - 1.0).abs() > APART;
        let bulk = (density * speed * speed - 4.0 / 3.0 * shear).max(0.0);
        Ok(Probe { density, shear, bulk, speed, shock: material.shock_viscosity(), apart })
    }

    /// The modulus of hourglass springs: that of shear, or of a law without one a hundredth of the bulk modulus, Pa.
    pub fn hourglass_modulus(&self) -> f64 {
        if self.shear > 1e-6 * self.bulk { self.shear } else { 0.01 * self.bulk }
    }
}
