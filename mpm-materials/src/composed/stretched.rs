//! Accumulated stretch added to any material, for particle splitting.

use std::sync::Arc;

use impactite_simd::Float;

use crate::lane::{Lane, Mask, Real};
use crate::material::{Compiled, Described, Material, Motion, Response, States, StatesMut};
use crate::point::{Constitutive, Fault, Kinematics, Nothing, Update};
use crate::stretching::Stretching;
use crate::tensor::Sym3;

/// Number of state variables of the stretch: b = F F^T and the number of splits.
const STRETCH: usize = 7;

/// Law without stress and state.
#[derive(Clone, Copy, Debug)]
struct Stressless;

impl<T: Real> Constitutive<T> for Stressless {
    type State<L: Lane<Real = T>> = Nothing;
    fn name(&self) -> &'static str {
        "none"
    }
    fn density(&self) -> T {
        T::of(1.0)
    }
    fn virgin(&self) -> Nothing {
        Nothing
    }
    #[inline(always)]
    fn update<L: Lane<Real = T>>(&self, _: &Kinematics<L>, _: &Nothing) -> Update<L, Nothing> {
        Update { state: Nothing, stress: Sym3::zero(), fault: Fault::none() }
    }
    #[inline(always)]
    fn stress<L: Lane<Real = T>>(&self, _: &Nothing) -> Sym3<L> {
        Sym3::zero()
    }
    #[inline(always)]
    fn in_range<L: Lane<Real = T>>(&self, _: &Nothing) -> L::Mask {
        L::Mask::splat(true)
    }
    #[inline(always)]
    fn failed<L: Lane<Real = T>>(&self, _: &Nothing) -> L::Mask {
        L::Mask::splat(false)
    }
    #[inline(always)]
    fn volume_ratio<L: Lane<Real = T>>(&self, _: &Nothing) -> L {
        L::one()
    }
    #[inline(always)]
    fn wave_speed<L: Lane<Real = T>>(&self, _: &Nothing) -> L {
        L::zero()
    }
    #[inline(always)]
    fn energy<L: Lane<Real = T>>(&self, _: &Nothing) -> L {
        L::zero()
    }
}

/// Material with the accumulated stretch as seven state variables before those of the law: [`Stretching`] for a law that
/// is known as a [`Material`] alone. Required for particle splitting. Stress, energy and wave speed are those of the law,
/// bit for bit.
///
/// ```
/// use mpm_materials::{IntoMaterial, Material, Stretched, library};
/// let lead = Stretched::new(library::lead::<f64>().into_material());
/// assert_eq!(lead.stretch_place(), Some(0));
/// ```
#[derive(Clone)]
pub struct Stretched {
    law: Arc<dyn Material<f64>>,
    stretch: Compiled<Stretching<Stressless>>,
}

impl std::fmt::Debug for Stretched {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}", self.constants())
    }
}

impl Stretched {
    /// Wrap a material.
    pub fn new(law: Arc<dyn Material<f64>>) -> Self {
        Stretched { law, stretch: Compiled::new(Stretching::new(Stressless)) }
    }
    fn own<'a>(&self, state: &'a [f64]) -> Option<&'a [f64]> {
        state.get(STRETCH..)
    }
}

impl Material<f64> for Stretched {
    fn name(&self) -> &'static str {
        self.law.name()
    }
    fn density(&self) -> f64 {
        self.law.density()
    }
    fn constants(&self) -> String {
        format!("Stretching {{ law: {} }}", self.law.constants())
    }
    fn numbers(&self) -> usize {
        STRETCH + self.law.numbers()
    }
    fn state_names(&self) -> Vec<String> {
        [Material::<f64>::state_names(&self.stretch), self.law.state_names()].concat()
    }
    fn virgin(&self) -> Vec<f64> {
        [Material::<f64>::virgin(&self.stretch), self.law.virgin()].concat()
    }
    fn advance(
        &self,
        motion: &Motion<'_, f64>,
        states: StatesMut<'_, f64>,
        speeds: bool,
        response: &mut Response<f64>,
    ) {
        let StatesMut { all, stride, first, groups } = states;
        let own = StatesMut { all: &mut *all, stride, first, groups };
        self.stretch.advance(motion, own, false, response);
        let broken = response.take_faults();
        self.law.advance(motion, StatesMut { all, stride, first: first + STRETCH, groups }, speeds, response);
        response.add_faults(broken);
    }
    fn describe(&self, states: States<'_, f64>, length: f64, response: &mut Response<f64>) {
        self.law.describe(States { first: states.first + STRETCH, ..states }, length, response);
    }
    fn volume_ratios(&self, states: States<'_, f64>, ratios: &mut [<f64 as Float>::Row]) {
        self.law.volume_ratios(States { first: states.first + STRETCH, ..states }, ratios);
    }
    fn energies(
        &self,
        states: States<'_, f64>,
        energies: &mut [<f64 as Float>::Row],
        heats: &mut [<f64 as Float>::Row],
    ) {
        self.law.energies(States { first: states.first + STRETCH, ..states }, energies, heats);
    }
    fn describe_point(&self, state: &[f64]) -> Option<Described<f64>> {
        self.law.describe_point(self.own(state)?)
    }
    fn step_speed(&self, state: &[f64], length: f64) -> Option<f64> {
        self.law.step_speed(self.own(state)?, length)
    }
    fn volume_ratio_of(&self, state: &[f64]) -> Option<f64> {
        self.law.volume_ratio_of(self.own(state)?)
    }
    fn energy_of(&self, state: &[f64]) -> Option<f64> {
        self.law.energy_of(self.own(state)?)
    }
    fn viscous_heat_of(&self, state: &[f64]) -> f64 {
        self.own(state).map_or(0.0, |state| self.law.viscous_heat_of(state))
    }
    /// Merge the law; stretch and splits are mass-weighted means.
    fn merged(&self, points: &[(f64, &[f64])]) -> Option<Vec<f64>> {
        let own: Option<Vec<_>> =
            points.iter().map(|&(mass, state)| Some((mass, self.own(state)?))).collect();
        let law = self.law.merged(&own?)?;
        let stretches: Vec<_> = points.iter().map(|&(mass, state)| (mass, &state[..STRETCH])).collect();
        Some([self.stretch.merged(&stretches)?, law].concat())
    }
    fn stretch_place(&self) -> Option<usize> {
        Some(0)
    }
    fn shock_viscosity(&self) -> [f64; 2] {
        self.law.shock_viscosity()
    }
    fn is_plane_stress(&self) -> bool {
        self.law.is_plane_stress()
    }
}
