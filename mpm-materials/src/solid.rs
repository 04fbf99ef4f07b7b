//! A solid composed of strength, equation of state and failure.

use crate::capability::Yields;
use crate::eos::{Balance, Eos, Terms, balance};
use crate::failure::combine::OfSolid;
use crate::failure::{Failure, NoFailure, Observed, Strain};
use crate::lane::{Lane, Mask, Real};
use crate::parameter::ParameterError;
use crate::point::{Breakdown, Constitutive, Fault, Kinematics, State, Update, alike, finite_state, mean};
use crate::rate::{HughesWinget, ObjectiveRate};
use crate::state;
use crate::strength::{FlowStress, Loading, Strength};
use crate::tensor::Sym3;
use crate::viscosity::{BulkViscosity, NoViscosity, ShockViscosity};

state! {
    /// State variables of a composed solid. Elastic without failure: 8 numbers; Johnson-Cook isothermal: 9; adiabatic:
    /// 10; a failure flag: one more.
    pub struct SolidState<L, S, F> {
        /// Total Cauchy stress, viscous pressure included, Pa.
        pub stress: Sym3<L>,
        /// Volume over reference volume, J.
        pub volume_ratio: L,
        /// Internal energy e per reference volume, J/m^3: all stress work since the virgin state.
        pub energy: L,
        /// History of the strength.
        pub strength: S,
        /// History of the failure.
        pub failure: F,
    }
}

/// Strength, equation of state and failure as one law: sigma = s - (p + q) I.
///
/// An update rotates the old stress with the material ([`ObjectiveRate`]), returns the trial deviator to the yield
/// surface ([`Strength`]), computes the viscous pressure ([`ShockViscosity`]), solves pressure and energy together
/// ([`Eos`], book, "Mie-Grueneisen"), and evaluates the failure criterion ([`Failure`]). The energy includes the whole
/// stress work, J s : d dt and -(p + q) dJ, with s and p + q averaged over the step. The criterion selects the stress
/// that a failed point still carries ([`Remains`](crate::failure::Remains)); stress lost in a step does no work at its
/// end.
///
/// Components left at their defaults cost neither memory nor instructions.
///
/// ```
/// use mpm_materials::{JohnsonCook, MieGruneisen, PlasticStrainLimit, Solid};
/// # fn main() -> Result<(), mpm_materials::ParameterError> {
/// let copper = Solid::new(JohnsonCook::<f64>::copper_taylor(), MieGruneisen::copper())
///     .with_failure(PlasticStrainLimit::new(3.0)?)
///     .with_bulk_viscosity(0.06, 1.5)?;
/// # let _ = copper;
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Solid<S, E, F = NoFailure, V = NoViscosity, R = HughesWinget> {
    strength: S,
    eos: E,
    failure: F,
    viscosity: V,
    rate: R,
}

/// Largest relative deviation of merging points from their mean volume ratio.
pub const LIKE_VOLUME: f64 = 0.05;
/// Largest deviation of merging points from their mean plastic strain, in addition to a quarter of that mean.
pub const LIKE_STRAIN: f64 = 0.05;

impl<S, E> Solid<S, E> {
    /// Create a solid without failure and bulk viscosity, with the [`HughesWinget`] rate.
    pub fn new<T: Real>(strength: S, eos: E) -> Self
    where
        S: Strength<T>,
        E: Eos<T>,
    {
        Solid { strength, eos, failure: NoFailure, viscosity: NoViscosity, rate: HughesWinget }
    }
}

impl<S, E, F, V> Solid<S, E, F, V> {
    pub(crate) fn of_parts(strength: S, eos: E, failure: F, viscosity: V) -> Self {
        Solid { strength, eos, failure, viscosity, rate: HughesWinget }
    }
    pub(crate) fn with_viscosity(self, viscosity: V) -> Self {
        Solid { viscosity, ..self }
    }
}

impl<S, E, F, V, R> Solid<S, E, F, V, R> {
    /// Set the failure criterion: `N` is `Solid<S, E, G, V, R>`, of a `G` that is a [`Failure`].
    pub fn with_failure<T, G, W, N>(self, failure: G) -> N
    where
        T: Real,
        S: Strength<T>,
        E: Eos<T>,
        G: OfSolid<T, W, Solid<S, E, G, V, R>, N>,
    {
        let Solid { strength, eos, viscosity, rate, .. } = self;
        G::made(Solid { strength, eos, failure, viscosity, rate })
    }
    /// Set the bulk viscosity: linear coefficient b1 and quadratic b0 (0.06 and 1.5 in the public decks), and the sound
    /// speed of the equation of state at rest.
    ///
    /// # Errors
    /// A negative coefficient.
    pub fn with_bulk_viscosity<T: Real>(
        self,
        linear: T,
        quadratic: T,
    ) -> Result<Solid<S, E, F, BulkViscosity<T>, R>, ParameterError>
    where
        E: Eos<T>,
    {
        let Solid { strength, eos, failure, rate, .. } = self;
        let viscosity = BulkViscosity::new(linear, quadratic, eos.rest_speed())?;
        Ok(Solid { strength, eos, failure, viscosity, rate })
    }
    /// Set the objective rate.
    pub fn with_rate<Q: ObjectiveRate>(self, rate: Q) -> Solid<S, E, F, V, Q> {
        let Solid { strength, eos, failure, viscosity, .. } = self;
        Solid { strength, eos, failure, viscosity, rate }
    }
    /// The strength.
    pub fn strength(&self) -> &S {
        &self.strength
    }
    /// The equation of state.
    pub fn eos(&self) -> &E {
        &self.eos
    }
    pub(crate) fn viscosity(&self) -> &V {
        &self.viscosity
    }
    /// The failure criterion.
    pub fn failure(&self) -> &F {
        &self.failure
    }
}

/// Newton steps of an opening crack. Tension changes little in a time step, the material beside the crack is nearly
/// linear, and the next step corrects the residual.
const CRACK_STEPS: usize = 2;

impl<S, E, F, V, R> Solid<S, E, F, V, R> {
    /// Solve pressure and energy together, of the material beside the crack if the failure criterion opens one. Also returns the
    /// terms of the pressure.
    #[inline(always)]
    fn balanced<T, L>(
        &self,
        length: L,
        volume_ratio: L,
        worked: L,
        volume_change: L,
        failure: &mut F::History<L>,
    ) -> (Balance<L>, Terms<L>)
    where
        T: Real,
        L: Lane<Real = T>,
        E: Eos<T>,
        F: Failure<T>,
    {
        let (cracks, old) = (self.failure.opens_cracks(), *failure);
        let mut step = 0;
        // One loop, so that the equation of state is compiled once.
        loop {
            let beside =
                if cracks { volume_ratio - self.failure.crack_volume(failure) } else { volume_ratio };
            let terms = self.eos.terms(beside);
            let balanced = balance(terms, worked, volume_change);
            if !cracks || step == CRACK_STEPS || !self.failure.opens(failure, balanced.pressure).any() {
                return (balanced, terms);
            }
            // rho0 c^2 = J^2 (p b - (dp/dJ)_e): the crack opens at constant energy, that of the end of the step.
            let squared = self.eos.speed_squared(beside, balanced.energy) * L::splat(self.eos.density());
            let pressure = balanced.pressure;
            let stiffness = (squared * (beside * beside).recip() - pressure * terms.thermal).max(L::zero());
            let strain = Strain { pressure, stiffness, length };
            *failure = self.failure.opened(&strain, failure, &old);
            step += 1;
        }
    }
    /// Check a step for breakdowns. One test covers the usual case of none.
    #[inline(always)]
    fn health<T, L, H, G>(&self, new: &SolidState<L, H, G>, volume_factor: L) -> Fault<L>
    where
        T: Real,
        L: Lane<Real = T>,
        H: State<L>,
        G: State<L>,
    {
        let turned = volume_factor.gt(L::zero());
        let upright = new.volume_ratio.gt(L::zero());
        let finite = finite_state(new);
        if (turned & upright & finite).all() {
            return Fault::none();
        }
        Fault::none()
            .require(turned, Breakdown::InvertedVolume)
            .require(upright, Breakdown::InvertedVolume)
            .require(finite, Breakdown::NotFinite)
    }
}

impl<T, S, E, F, V, R> Constitutive<T> for Solid<S, E, F, V, R>
where
    T: Real,
    S: Strength<T>,
    E: Eos<T>,
    F: Failure<T>,
    V: ShockViscosity<T>,
    R: ObjectiveRate,
{
    type State<L: Lane<Real = T>> = SolidState<L, S::History<L>, F::History<L>>;

    fn name(&self) -> &'static str {
        self.strength.name()
    }
    fn density(&self) -> T {
        self.eos.density()
    }
    fn shock_viscosity(&self) -> [T; 2] {
        self.viscosity.coefficients()
    }
    #[inline(always)]
    fn stored(&self) -> u64 {
        let low = |bits: u64, count: usize| bits & ((1 << count) - 1);
        let (strength, failure) = (
            <S::History<T::Single> as State<T::Single>>::LEN,
            <F::History<T::Single> as State<T::Single>>::LEN,
        );
        // Six of the stress, volume ratio and energy come first.
        0xff | low(self.strength.stored(), strength) << 8
            | low(self.failure.stored(), failure) << (8 + strength)
    }
    fn virgin(&self) -> Self::State<T::Single> {
        let energy = T::Single::splat(self.eos.initial_energy());
        let volume_ratio = T::Single::one();
        SolidState {
            stress: Sym3::isotropic(T::Single::zero() - self.eos.pressure(volume_ratio, energy)),
            volume_ratio,
            energy,
            strength: self.strength.virgin(),
            failure: self.failure.intact(),
        }
    }
    #[inline(always)]
    fn update<L: Lane<Real = T>>(
        &self,
        kinematics: &Kinematics<L>,
        old: &Self::State<L>,
    ) -> Update<L, Self::State<L>> {
        let (zero, half) = (L::zero(), L::of(0.5));
        let stilled;
        let kinematics = if self.failure.is_possible() && !self.failure.remains().compression() {
            // A removed point does not follow the motion: no work, no breakdown.
            let gone = self.failure.failed(&old.failure, self.strength.plastic_strain(&old.strength));
            let increment = kinematics.increment * L::select(gone, zero, L::one());
            stilled = Kinematics { increment, ..*kinematics };
            &stilled
        } else {
            kinematics
        };
        let step = self.rate.increments(kinematics);
        let volume_factor = step.volume_factor;
        let volume_ratio = old.volume_ratio * volume_factor;
        let specific_volume = volume_ratio * L::splat(T::of(1.0) / self.eos.density());
        let density = volume_ratio.recip() * L::splat(self.eos.density());

        // Rotation and elastic trial.
        let rotated = self.rate.rotate(&step, &old.stress);
        let old_mean = rotated.mean();
        let old_deviator = rotated.plus_isotropic(-old_mean);
        let loading = Loading::of(kinematics, &step.strain, -old_mean, specific_volume);
        let two_g = L::splat(self.strength.shear_modulus() * T::of(2.0));
        let mut trial = old_deviator.plus_times(&loading.strain_deviator, two_g);
        if self.failure.is_possible() && !self.failure.remains().shear() {
            let failed = self.failure.failed(&old.failure, self.strength.plastic_strain(&old.strength));
            trial = trial * L::select(failed, zero, L::one());
        }

        // Return to the yield surface.
        let returned = self.strength.return_map(&trial, &loading, &old.strength);

        // Viscous pressure, then pressure and energy together.
        let mut viscous = self.viscosity.pressure(kinematics, volume_factor, density);
        let volume_change = volume_ratio - old.volume_ratio;
        let middle_volume = volume_change.mul_add(half, old.volume_ratio);
        let deviatoric_power = (old_deviator + returned.deviator).dot(&loading.strain_deviator) * half;
        let push = (viscous - old_mean) * half;
        let worked = middle_volume.mul_add(deviatoric_power, (-push).mul_add(volume_change, old.energy));
        let mut failure = old.failure;
        let (balanced, terms) =
            self.balanced(kinematics.length, volume_ratio, worked, volume_change, &mut failure);

        // Failure: stress lost in this step does no work at its end.
        let mut deviator = returned.deviator;
        let mut pressure = balanced.pressure;
        let mut energy = balanced.energy;
        if self.failure.is_possible() {
            let plastic_strain = self.strength.plastic_strain(&returned.history);
            let observed = Observed {
                deviator,
                pressure,
                plastic_strain,
                plastic_strain_increment: plastic_strain - self.strength.plastic_strain(&old.strength),
                homologous_temperature: self.strength.homologous_temperature(&returned.history),
                damage: self.strength.damage(&returned.history),
                dt: kinematics.dt,
                length: kinematics.length,
            };
            failure = self.failure.judge(&observed, &failure);
            let failed = self.failure.failed(&failure, plastic_strain);
            if failed.any() {
                let intact = L::select(failed, zero, L::one());
                let mut left = worked;
                if !self.failure.remains().shear() {
                    left = left - middle_volume * deviator.dot(&loading.strain_deviator) * half;
                    deviator = deviator * intact;
                }
                if self.failure.remains().compression() {
                    // A crack is closed where its point has failed, but may be open where another criterion failed.
                    let terms =
                        if self.failure.opens_cracks() { self.eos.terms(volume_ratio) } else { terms };
                    let again = balance(terms, left, volume_change);
                    let mut carried = again.pressure;
                    let mut kept = again.energy;
                    if !self.failure.remains().tension() {
                        let tension = again.pressure.lt(zero);
                        carried = L::select(tension, zero, carried);
                        kept = L::select(tension, left, kept);
                    }
                    pressure = L::select(failed, carried, pressure);
                    energy = L::select(failed, kept, energy);
                } else {
                    pressure = pressure * intact;
                    energy = L::select(failed, left + viscous * half * volume_change, energy);
                    viscous = viscous * intact;
                }
            }
        }

        let stress = deviator.plus_isotropic(-(pressure + viscous));
        let state = SolidState { stress, volume_ratio, energy, strength: returned.history, failure };
        let fault = self.health(&state, volume_factor).or(returned.fault);
        Update { state, stress, fault }
    }
    #[inline(always)]
    fn stress<L: Lane<Real = T>>(&self, now: &Self::State<L>) -> Sym3<L> {
        now.stress
    }
    #[inline(always)]
    fn in_range<L: Lane<Real = T>>(&self, now: &Self::State<L>) -> L::Mask {
        self.eos.in_range(now.volume_ratio)
    }
    #[inline(always)]
    fn failed<L: Lane<Real = T>>(&self, now: &Self::State<L>) -> L::Mask {
        self.failure.failed(&now.failure, self.strength.plastic_strain(&now.strength))
    }
    #[inline(always)]
    fn volume_ratio<L: Lane<Real = T>>(&self, now: &Self::State<L>) -> L {
        now.volume_ratio
    }
    /// Squared wave speed c^2 = (dp/drho)_s + 4 G/(3 rho), the bulk part floored at zero. Plastic flow does not lower it; pressure raises
    /// it where it stiffens the strength. The shear term is zero for a failed point without shear: debris expands, and
    /// 4 G/(3 rho) at its low density would govern the time step of the whole scene. Bulk viscosity is left out; see
    /// [`BulkViscosity`] for its effect on the time step.
    #[inline(always)]
    fn wave_speed<L: Lane<Real = T>>(&self, now: &Self::State<L>) -> L {
        let beside = now.volume_ratio - self.failure.crack_volume(&now.failure);
        let bulk = self.eos.speed_squared(beside, now.energy).max(L::zero());
        let shear = L::splat(self.strength.shear_modulus() * T::of(4.0 / 3.0) / self.eos.density());
        let stiffening = self.strength.stiffening(-now.stress.mean(), now.volume_ratio, &now.strength);
        let mut stiff = shear * stiffening;
        if self.failure.is_possible() && !self.failure.remains().shear() {
            let failed = self.failure.failed(&now.failure, self.strength.plastic_strain(&now.strength));
            stiff = stiff * L::select(failed, L::zero(), L::one());
        }
        stiff.mul_add(now.volume_ratio, bulk).sqrt()
    }
    #[inline(always)]
    fn energy<L: Lane<Real = T>>(&self, now: &Self::State<L>) -> L {
        now.energy - L::splat(self.eos.initial_energy())
    }
    /// Merge points, unless failure removes points of the solid, which then no longer follow the motion. All points
    /// must be failed or all intact, with volume ratios within [`LIKE_VOLUME`] of their mean (half of it for failed
    /// points without stress) and plastic strains within [`LIKE_STRAIN`] and a quarter of their mean. Volume ratio,
    /// energy and histories are mass-weighted means, the stress is a volume-weighted one, which preserves the nodal
    /// forces. The mean deviator stores less elastic energy than the deviators; the energy, a state variable, retains
    /// the difference as heat. The pressure of the next step follows from mean volume and energy; it differs from the
    /// mean pressure by the square of the volume differences.
    fn merged(&self, points: &[(f64, Self::State<T::Single>)]) -> Option<Self::State<T::Single>> {
        if self.failure.is_possible() && !self.failure.remains().compression() {
            return None;
        }
        let number = |x: T::Single| -> f64 {
            let x: T = x.into();
            x.to_double()
        };
        let failed = |state: &Self::State<T::Single>| {
            self.failure.failed(&state.failure, self.strength.plastic_strain(&state.strength)).any()
        };
        let mut state = mean::<T, Self::State<T::Single>>(points.iter().copied());
        let by_volume = points.iter().map(|(mass, s)| (mass * number(s.volume_ratio), s.stress));
        state.stress = mean::<T, _>(by_volume);

        let gone = failed(&points.first()?.1);
        if points.iter().any(|(_, s)| failed(s) != gone) || failed(&state) != gone {
            return None;
        }
        let bare = gone && points.iter().all(|(_, s)| s.stress.0.iter().all(|&x| number(x) == 0.0));
        let volume = number(state.volume_ratio);
        let within = volume * if bare { 0.5 } else { LIKE_VOLUME };
        let strain = |s: &Self::State<T::Single>| number(self.strength.plastic_strain(&s.strength));
        let middle = strain(&state);
        let like = alike(points.iter().map(|(_, s)| number(s.volume_ratio)), volume, within)
            && alike(points.iter().map(|(_, s)| strain(s)), middle, LIKE_STRAIN + 0.25 * middle);
        like.then_some(state)
    }
}

impl<T, S, E, F, V, R> Yields<T> for Solid<S, E, F, V, R>
where
    T: Real,
    S: FlowStress<T>,
    E: Eos<T>,
    F: Failure<T>,
    V: ShockViscosity<T>,
    R: ObjectiveRate,
{
    #[inline(always)]
    fn flow_stress<L: Lane<Real = T>>(
        &self,
        kinematics: &Kinematics<L>,
        old: &Self::State<L>,
        new: &Self::State<L>,
    ) -> L {
        let specific_volume = new.volume_ratio * L::splat(T::of(1.0) / self.eos.density());
        let loading = Loading::of(
            kinematics,
            &self.rate.increments(kinematics).strain,
            -old.stress.mean(),
            specific_volume,
        );
        self.strength.flow_stress(&loading, &old.strength, &new.strength)
    }
    #[inline(always)]
    fn plastic_strain<L: Lane<Real = T>>(&self, now: &Self::State<L>) -> L {
        self.strength.plastic_strain(&now.strength)
    }
}
