//! Mohr-Coulomb plasticity with a tension cut-off.

use nalgebra::Matrix3;

use crate::elastic::Moduli;
use crate::ground::{Admissible, Geomaterial, Trial};
use crate::lane::{Lane, Mask, Real};
use crate::parameter::{Check, ParameterError};
use crate::point::{Breakdown, Fault};
use crate::strength::drucker_prager::Sheared;
use crate::tensor::Sym3;

/// Mohr-Coulomb soil (book, "Soil"), a [`Geomaterial`]; `Ground::new` turns it into a law. With principal stresses
/// s1 >= s2 >= s3, tension positive:
///
/// - shear: (s1 - s3) + (s1 + s3) sin phi <= 2 c cos phi, flow with dilatancy angle psi <= phi;
/// - tension: s1 <= sigma_t, at most the apex c/tan phi;
/// - elasticity and gaps in tension as of [`DruckerPrager`](crate::strength::DruckerPrager).
///
/// The return mapping is exact: to a face, an edge or the apex of the pyramid, in principal stresses
/// \[deSouzaNeto2008\]; then principal stresses above sigma_t are cut off. **Slow**: principal axes are computed point
/// by point for points that yield, without vector lanes. A cheap bound skips points far from yield.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MohrCoulomb<T> {
    density: T,
    bulk: T,
    shear: T,
    sin_friction: T,
    /// Cohesion term 2 c cos phi, Pa.
    cohesion: T,
    sin_dilatancy: T,
    tension: T,
}

const CHECK: Check = Check("Mohr-Coulomb");

impl<T: Real> MohrCoulomb<T> {
    /// Create from density, kg/m^3, elastic moduli, friction angle phi, cohesion c, Pa, and dilatancy angle psi
    /// (radians). The tensile strength is that of the apex, c/tan phi; without friction there is no apex and it is c.
    ///
    /// # Errors
    /// phi outside \[0, pi/2), psi outside \[0, phi\], c negative, a density or modulus that is not positive.
    pub fn new(
        density: T,
        moduli: Moduli<T>,
        friction_angle: T,
        cohesion: T,
        dilatancy_angle: T,
    ) -> Result<Self, ParameterError> {
        CHECK.positive("density rho0", density)?;
        CHECK.positive("bulk modulus K", moduli.bulk)?;
        CHECK.positive("shear modulus G", moduli.shear)?;
        let zero = T::of(0.0);
        let acute = friction_angle >= zero && friction_angle < T::of(std::f64::consts::FRAC_PI_2);
        CHECK.that(acute, "friction angle", friction_angle, "in [0, pi/2)")?;
        let inside = dilatancy_angle >= zero && dilatancy_angle <= friction_angle;
        CHECK.that(inside, "dilatancy angle", dilatancy_angle, "between 0 and the friction angle")?;
        CHECK.not_negative("cohesion c", cohesion)?;
        let (phi, psi) = (friction_angle.to_double(), dilatancy_angle.to_double());
        let tension = if phi > 0.0 { cohesion * T::of(phi.cos() / phi.sin()) } else { cohesion };
        Ok(MohrCoulomb {
            density,
            bulk: moduli.bulk,
            shear: moduli.shear,
            sin_friction: T::of(phi.sin()),
            cohesion: cohesion * T::of(2.0 * phi.cos()),
            sin_dilatancy: T::of(psi.sin()),
            tension,
        })
    }

    /// Set the tensile strength sigma_t, Pa.
    ///
    /// # Errors
    /// sigma_t negative or beyond the apex.
    pub fn with_tension_cutoff(self, tension: T) -> Result<Self, ParameterError> {
        let two = T::of(2.0);
        let reach = two * tension * self.sin_friction <= self.cohesion * T::of(1.0 + 1e-6);
        let allowed = "zero or positive and at most c/tan phi";
        CHECK.that(tension >= T::of(0.0) && reach, "tensile strength", tension, allowed)?;
        Ok(MohrCoulomb { tension, ..self })
    }

    /// Yield function of two principal stresses, Pa.
    fn excess(&self, high: T, low: T) -> T {
        (high - low) + (high + low) * self.sin_friction - self.cohesion
    }

    /// Map principal stresses, largest first, to the pyramid; also return the plastic dilatation.
    fn on_pyramid(&self, [s1, s2, s3]: [T; 3]) -> ([T; 3], T) {
        let (zero, two, four, third) = (T::of(0.0), T::of(2.0), T::of(4.0), T::of(1.0 / 3.0));
        let over = self.excess(s1, s3);
        if over <= zero {
            return ([s1, s2, s3], zero);
        }
        let (g, k, sin, dil) = (self.shear, self.bulk, self.sin_friction, self.sin_dilatancy);
        // Decrease of the largest, increase of the smallest and of the intermediate principal stress per unit slip on a
        // face.
        let fall = two * g * (T::of(1.0) + dil * third) + two * k * dil;
        let rise = two * g * (T::of(1.0) - dil * third) - two * k * dil;
        let idle = (four * g * third - two * k) * dil;
        let face = four * g * (T::of(1.0) + sin * dil * third) + four * k * sin * dil;
        // Plastic dilatation per unit slip.
        let per_slip = two * dil;

        let slip = over / face;
        let new = [s1 - fall * slip, s2 + idle * slip, s3 + rise * slip];
        if new[0] >= new[1] && new[1] >= new[2] {
            return (new, per_slip * slip);
        }
        // Edge of two faces: those that share the largest, or the smallest, principal stress.
        let shares_largest = (T::of(1.0) - dil) * s1 - two * s2 + (T::of(1.0) + dil) * s3 > zero;
        let volume_part = four * k * sin * dil;
        let edge = if shares_largest {
            let other = self.excess(s1, s2);
            let cross = two * g * (T::of(1.0) + sin + dil - sin * dil * third) + volume_part;
            let (a, b) = two_slips(face, cross, over, other);
            ([s1 - fall * (a + b), s2 + idle * a + rise * b, s3 + rise * a + idle * b], a + b)
        } else {
            let other = self.excess(s2, s3);
            let cross = two * g * (T::of(1.0) - sin - dil - sin * dil * third) + volume_part;
            let (a, b) = two_slips(face, cross, over, other);
            ([s1 - fall * a + idle * b, s2 + idle * a - fall * b, s3 + rise * (a + b)], a + b)
        };
        let (new, slips) = edge;
        // On an edge two principal stresses are equal, to rounding.
        let scale = (s1.abs() + s3.abs() + self.cohesion) * T::default_epsilon() * T::of(64.0);
        if new[0] + scale >= new[1] && new[1] + scale >= new[2] {
            return (new, per_slip * slips);
        }
        // Return to the apex; without friction the pyramid is a prism without apex.
        let apex = if sin > zero { self.cohesion / (two * sin) } else { (s1 + s2 + s3) * third };
        ([apex; 3], zero)
    }
}

/// Solve \[face cross; cross face\] (a, b) = (first, second).
fn two_slips<T: Real>(face: T, cross: T, first: T, second: T) -> (T, T) {
    let determinant = face * face - cross * cross;
    ((face * first - cross * second) / determinant, (face * second - cross * first) / determinant)
}

impl<T: Real> Geomaterial<T> for MohrCoulomb<T> {
    type History<L: Lane<Real = T>> = Sheared<L>;

    fn name(&self) -> &'static str {
        "Mohr-Coulomb"
    }
    fn density(&self) -> T {
        self.density
    }
    fn shear_modulus(&self) -> T {
        self.shear
    }
    fn virgin(&self) -> Sheared<T::Single> {
        Sheared { plastic_strain: T::Single::zero(), dilation: T::Single::zero() }
    }
    #[inline(always)]
    fn return_map<L: Lane<Real = T>>(&self, trial: &Trial<L>, old: &Sheared<L>) -> Admissible<L, Sheared<L>> {
        let mean = L::splat(self.bulk) * (trial.volume_ratio.ln() - old.dilation);
        // With q = sqrt(3/2 s:s): s1 - s3 <= 2 q/sqrt 3, s1 + s3 <= 2 mean + q/3 (each at another angle), s1 <= mean
        // + 2 q/3; rounded up a little.
        let equivalent = trial.deviator.equivalent();
        let sum = (mean + mean) + equivalent * L::of(0.334);
        let bound = equivalent * L::of(1.155) + L::splat(self.sin_friction) * sum;
        let largest = mean + equivalent * L::of(0.667);
        let near = bound.gt(L::splat(self.cohesion)) | largest.gt(L::splat(self.tension));
        let fault = Fault::none().require((mean + equivalent).is_finite(), Breakdown::NotFinite);
        let mut result = Admissible { deviator: trial.deviator, pressure: -mean, history: *old, fault };
        if !near.any() {
            return result;
        }
        for lane in 0..L::WIDTH {
            if near.lane(lane) && fault.cause(lane).is_none() {
                self.return_lane(trial, mean, lane, &mut result);
            }
        }
        result
    }
    #[inline(always)]
    fn bulk_modulus<L: Lane<Real = T>>(&self, _: L, _: &Sheared<L>) -> L {
        L::splat(self.bulk)
    }
    #[inline(always)]
    fn plastic_strain<L: Lane<Real = T>>(&self, history: &Sheared<L>) -> L {
        history.plastic_strain
    }
}

impl<T: Real> MohrCoulomb<T> {
    #[inline(never)]
    fn return_lane<L: Lane<Real = T>>(
        &self,
        trial: &Trial<L>,
        mean: L,
        lane: usize,
        result: &mut Admissible<L, Sheared<L>>,
    ) {
        let mean = mean.lane(lane);
        let deviator = Matrix3::from_fn(|i, j| trial.deviator.at(i, j).lane(lane));
        let axes = deviator.symmetric_eigen();
        let mut order = [0, 1, 2];
        let values = axes.eigenvalues;
        order.sort_by(|&a, &b| values[b].partial_cmp(&values[a]).unwrap_or(std::cmp::Ordering::Equal));
        let before = order.map(|i| values[i] + mean);
        let (mut after, dilated) = self.on_pyramid(before);
        for i in 0..3 {
            if after[i] > self.tension {
                after[i] = self.tension;
            }
        }
        if after == before {
            return;
        }
        let third = T::of(1.0 / 3.0);
        let new_mean = (after[0] + after[1] + after[2]) * third;
        // Sum over the principal axes; plastic strain from the loss of deviator and the plastic dilatation.
        let mut tensor = Matrix3::zeros();
        let mut loss = T::default();
        for i in 0..3 {
            let axis = axes.eigenvectors.column(order[i]);
            let kept = after[i] - new_mean;
            tensor += axis * axis.transpose() * kept;
            let lost = before[i] - mean - kept;
            loss += lost * lost;
        }
        let two_g = self.shear * T::of(2.0);
        let square = (loss / (two_g * two_g) + dilated * dilated * third) * T::of(2.0 / 3.0);
        let mut deviator = Sym3(result.deviator.0);
        for (k, (i, j)) in [(0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1)].into_iter().enumerate() {
            deviator.0[k] = deviator.0[k].with_lane(lane, tensor[(i, j)]);
        }
        result.deviator = deviator;
        result.pressure = result.pressure.with_lane(lane, -new_mean);
        let old = &mut result.history;
        let strain = old.plastic_strain.lane(lane) + square.sqrt();
        old.plastic_strain = old.plastic_strain.with_lane(lane, strain);
        old.dilation = old.dilation.with_lane(lane, old.dilation.lane(lane) + dilated);
    }
}
