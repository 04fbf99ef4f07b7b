//! Law with a scaled inertia, for slow processes in which inertia does not matter.

use std::sync::Arc;

use impactite_simd::Float;

use crate::material::{Described, Material, Motion, Response, States, StatesMut};
use crate::parameter::{Check, ParameterError};

/// Material with mass scaling: the density for inertia is `factor` times that of the law, stresses and energies are those of the law. Waves
/// are slower by the square root of the factor, and the stable step is longer by it. Results are those of a slow process as long as the
/// kinetic energy is a few per cent of the internal energy.
///
/// Viscosity of the law is not scaled: bulk viscosity damps waves less by the square root of the factor.
///
/// ```
/// use mpm_materials::material::{IntoMaterial, Material};
/// use mpm_materials::{LinearElastic, MassScaled, Moduli};
///
/// let steel = LinearElastic::new(7850.0, Moduli::young_poisson(206e9, 0.3)?)?.into_material();
/// let slow = MassScaled::new(steel.clone(), 100.0)?;
/// assert_eq!(slow.density(), 100.0 * steel.density());
/// let speed = |law: &dyn Material<f64>| law.step_speed(&law.virgin(), 1e-3).unwrap();
/// assert!((10.0 * speed(&slow) / speed(&*steel) - 1.0).abs() < 1e-15);
/// # Ok::<(), mpm_materials::ParameterError>(())
/// ```
#[derive(Clone)]
pub struct MassScaled<T: Float> {
    law: Arc<dyn Material<T>>,
    /// Density over that of the law.
    factor: T,
    /// Wave speed over that of the law.
    slowness: T,
}

impl<T: Float> std::fmt::Debug for MassScaled<T> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}", self.constants())
    }
}

impl<T: Float> MassScaled<T> {
    /// Scale the inertia of a law by a factor of at least 1.
    ///
    /// # Errors
    /// A factor below 1, or that is not finite.
    pub fn new(law: Arc<dyn Material<T>>, factor: T) -> Result<Self, ParameterError> {
        let number = factor.to_double();
        Check("mass scaling").that(number >= 1.0, "factor", number, "finite and at least 1")?;
        Ok(MassScaled { law, factor, slowness: T::of(1.0 / number.sqrt()) })
    }
}

impl<T: Float> Material<T> for MassScaled<T> {
    fn name(&self) -> &'static str {
        self.law.name()
    }
    fn density(&self) -> T {
        self.factor * self.law.density()
    }
    fn constants(&self) -> String {
        format!("{} with {} times the mass", self.law.constants(), self.factor.to_double())
    }
    fn numbers(&self) -> usize {
        self.law.numbers()
    }
    fn state_names(&self) -> Vec<String> {
        self.law.state_names()
    }
    fn virgin(&self) -> Vec<T> {
        self.law.virgin()
    }
    fn advance(
        &self,
        motion: &Motion<'_, T>,
        states: StatesMut<'_, T>,
        speeds: bool,
        response: &mut Response<T>,
    ) {
        self.law.advance(motion, states, speeds, response);
        if speeds {
            response.scale_speeds(self.slowness);
        }
    }
    fn describe(&self, states: States<'_, T>, length: T, response: &mut Response<T>) {
        self.law.describe(states, length, response);
        response.scale_speeds(self.slowness);
    }
    fn volume_ratios(&self, states: States<'_, T>, ratios: &mut [T::Row]) {
        self.law.volume_ratios(states, ratios);
    }
    fn energies(&self, states: States<'_, T>, energies: &mut [T::Row], heats: &mut [T::Row]) {
        self.law.energies(states, energies, heats);
    }
    fn describe_point(&self, state: &[T]) -> Option<Described<T>> {
        let said = self.law.describe_point(state)?;
        Some(Described { wave_speed: self.slowness * said.wave_speed, ..said })
    }
    fn step_speed(&self, state: &[T], length: T) -> Option<T> {
        Some(self.slowness * self.law.step_speed(state, length)?)
    }
    fn volume_ratio_of(&self, state: &[T]) -> Option<T> {
        self.law.volume_ratio_of(state)
    }
    fn energy_of(&self, state: &[T]) -> Option<T> {
        self.law.energy_of(state)
    }
    fn viscous_heat_of(&self, state: &[T]) -> T {
        self.law.viscous_heat_of(state)
    }
    fn merged(&self, points: &[(f64, &[T])]) -> Option<Vec<T>> {
        self.law.merged(points)
    }
    fn stretch_place(&self) -> Option<usize> {
        self.law.stretch_place()
    }
    fn shock_viscosity(&self) -> [T; 2] {
        self.law.shock_viscosity()
    }
    fn is_plane_stress(&self) -> bool {
        self.law.is_plane_stress()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::material::{Deformation, IntoMaterial, Length};
    use crate::{LinearElastic, Moduli};

    #[test]
    fn stresses_are_those_of_the_law_and_waves_are_slower() {
        let moduli = Moduli::young_poisson(2.0, 0.25).expect("moduli");
        let law = LinearElastic::new(3.0, moduli).expect("a law").into_material();
        let scaled = MassScaled::new(law.clone(), 16.0).expect("a factor");
        let answer = |law: &dyn Material<f64>| {
            let row = |x: f64| {
                let mut row = <f64 as Float>::Row::default();
                row.as_mut().fill(x);
                row
            };
            let mut rows: Vec<_> = law.virgin().iter().map(|&x| row(x)).collect();
            let mut deformation = [Deformation::default()];
            deformation[0].gradient[1].0[0] = row(1e-3);
            deformation[0].step.0[0] = row(1.0);
            let motion = Motion { deformation: &deformation, dt: 1.0, length: Length::Same(1.0) };
            let mut response = Response::default();
            let states = StatesMut { all: &mut rows, stride: law.numbers(), first: 0, groups: &[0] };
            law.advance(&motion, states, true, &mut response);
            let out = response.outputs()[0];
            [out.stress[5].0[0].as_ref()[1], out.step_speed.0[0].as_ref()[1]]
        };
        let ([stress, speed], [same, slow]) = (answer(&*law), answer(&scaled));
        assert!(stress > 0.0 && stress == same);
        assert_eq!(slow, 0.25 * speed, "a power of two");
        // rho c^2 is the same modulus.
        assert_eq!(scaled.density() * slow * slow, law.density() * speed * speed);
        assert!(MassScaled::new(law, 0.5).is_err());
    }
}
