//! Moduli of a law at rest, measured by straining a virgin point.

use impactite_scene::SceneError;
use mpm_materials::material::{Deformation, Length, Material, Motion, Response, StatesMut};

use crate::sums::{GROUP, Row};
use crate::vector::Tensor;

/// Precompression of the point, so that laws without tension carry shear, and strain of the probes.
const CLOSED: f64 = 1e-8;
const PROBE: f64 = 1e-9;

/// Law at rest.
#[derive(Clone, Debug)]
pub(crate) struct Rest<const D: usize> {
    /// Reference density, kg/m^3.
    pub density: f64,
    /// Speed of longitudinal waves, m/s.
    pub speed: f64,
    /// Young's modulus, or the bulk modulus of a law without shear, Pa.
    pub modulus: f64,
    /// Tangent moduli: column `D a + b` is P for the gradient with a one in row a, column b.
    tangent: Vec<Tensor<D>>,
}

impl<const D: usize> Rest<D> {
    /// Measure a law.
    ///
    /// # Errors
    /// A density that is not positive.
    pub fn of(material: &dyn Material<f64>) -> Result<Self, SceneError> {
        let density = material.density();
        if !(density > 0.0 && density.is_finite()) {
            return Err(SceneError::Density { law: material.name(), density });
        }
        let virgin = material.virgin();
        let speed = material.describe_point(&virgin).map_or(0.0, |said| said.wave_speed);
        // One point per component, and one with precompression only.
        let (points, numbers) = (D * D + 1, virgin.len());
        let groups: Vec<u32> = (0..points.div_ceil(GROUP) as u32).collect();
        let mut rows = vec![Row::default(); groups.len() * numbers];
        for (at, row) in rows.iter_mut().enumerate() {
            row.as_mut().fill(virgin[at % numbers]);
        }
        let mut deformation = vec![Deformation::<Row>::default(); groups.len().div_ceil(2)];
        for n in 0..points {
            let (to, half, lane) = (&mut deformation[n / GROUP / 2], n / GROUP % 2, n % GROUP);
            to.step.0[half].as_mut()[lane] = 1.0;
            for d in 0..D {
                to.gradient[4 * d].0[half].as_mut()[lane] = -CLOSED;
            }
            if n < D * D {
                to.gradient[3 * (n / D) + n % D].0[half].as_mut()[lane] += PROBE;
            }
        }
        let mut response = Response::default();
        // Long step, in which viscous stresses vanish.
        let motion = Motion { deformation: &deformation, dt: 1.0, length: Length::Same(1.0) };
        let states = StatesMut { all: &mut rows, stride: numbers, first: 0, groups: &groups };
        material.advance(&motion, states, false, &mut response);
        let stress = |n: usize| -> Tensor<D> {
            let (from, half, lane) = (&response.outputs()[n / GROUP / 2], n / GROUP % 2, n % GROUP);
            let at = |a: usize, b: usize| from.stress[PLACES[a][b]].0[half].as_ref()[lane];
            std::array::from_fn(|a| std::array::from_fn(|b| at(a, b)))
        };
        let closed = stress(D * D);
        let tangent = (0..D * D).map(|n| {
            let mut change = stress(n);
            for (row, closed) in change.iter_mut().zip(&closed) {
                row.iter_mut().zip(closed).for_each(|(x, closed)| *x = (*x - closed) / PROBE);
            }
            change
        });
        let tangent: Vec<Tensor<D>> = tangent.collect();
        let shear = tangent[1][0][1].max(0.0);
        let bulk = (density * speed * speed - 4.0 / 3.0 * shear).max(0.0);
        let young = 9.0 * bulk * shear / (3.0 * bulk + shear);
        let modulus = if shear > 1e-6 * bulk { young } else { bulk };
        Ok(Rest { density, speed, modulus, tangent })
    }

    /// Return P of a small gradient, Pa.
    pub fn stress(&self, h: &Tensor<D>) -> Tensor<D> {
        let mut p = [[0.0; D]; D];
        for (n, of) in self.tangent.iter().enumerate() {
            for a in 0..D {
                for b in 0..D {
                    p[a][b] += h[n / D][n % D] * of[a][b];
                }
            }
        }
        p
    }
}

/// Index of a tensor component in the order xx, yy, zz, yz, xz, xy.
pub(crate) const PLACES: [[usize; 3]; 3] = [[0, 5, 4], [5, 1, 3], [4, 3, 2]];
