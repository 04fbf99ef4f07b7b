//! Density diffusion.

use super::batch::Near;
use crate::matrix::Matrix;
use crate::records::Records;

/// Density gradients, corrected like velocity gradients: grad rho = C^T sum_j A_j s_ij (rho_j - rho_i) (x_j - x_i).
pub(crate) struct DensityGradient<'a, const D: usize> {
    pub records: &'a Records<D>,
    pub near: &'a Near,
    /// Place of the first particle of the batch.
    pub first: usize,
    pub correction: &'a [Matrix],
}

impl<const D: usize> DensityGradient<'_, D> {
    /// Return the density gradient of a particle of the batch, kg/m^4.
    pub fn of(&self, n: usize) -> [f64; 3] {
        let (records, i) = (self.records, self.first + n);
        let own = (&records.place[i], records.density[i][3]);
        let mut sum = [0.0; D];
        let (index, slope) = self.near.of(n);
        for (&j, &s) in index.iter().zip(slope) {
            let other = &records.place[j as usize];
            let weight = s * other[3] * (records.density[j as usize][3] - own.1);
            (0..D).for_each(|d| sum[d] += weight * (other[d] - own.0[d]));
        }
        let correction = &self.correction[n];
        let mut gradient = [0.0; 3];
        for (c, out) in gradient[..D].iter_mut().enumerate() {
            *out = (0..D).map(|a| sum[a] * correction[a][c]).sum();
        }
        gradient
    }
}

/// Rates of density diffusion.
pub(crate) struct Diffuse<'a, const D: usize> {
    pub records: &'a Records<D>,
    pub near: &'a Near,
    /// Place of the first particle of the batch.
    pub first: usize,
    /// The coefficient delta.
    pub delta: f64,
}

impl<const D: usize> Diffuse<'_, D> {
    /// Return the rate of the logarithm of density of a particle of the batch, 1/s.
    pub fn of(&self, n: usize) -> f64 {
        let (records, i) = (self.records, self.first + n);
        let (place, density) = (&records.place[i], &records.density[i]);
        let mut sum = 0.0;
        if !records.diffuses[i] {
            return 0.0;
        }
        let (index, slope) = self.near.of(n);
        for (&j, &s) in index.iter().zip(slope) {
            let j = j as usize;
            if !records.diffuses[j] {
                continue;
            }
            let (other, there) = (&records.place[j], &records.density[j]);
            let mut apart = there[3] - density[3];
            for d in 0..D {
                apart -= 0.5 * (density[d] + there[d]) * (other[d] - place[d]);
            }
            let h = 0.5 * (records.smoothing[i] + records.smoothing[j]);
            let c = 0.5 * (records.fluid[i][1] + records.fluid[j][1]);
            sum += other[3] * s * h * c * apart;
        }
        2.0 * self.delta * sum / density[3]
    }
}
