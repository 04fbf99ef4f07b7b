//! Standard linear solid: a spring parallel to a Maxwell element in shear; elastic in volume.
//!
//! ```text
//! sigma = s + q + K tr(eps) I        s' = 2 G dev(d)        q' = 2 G1 dev(d) - q / tau
//! ```
//! with objective rates. Over a step of constant d the overstress q has the exact solution
//! q <- e^(-dt/tau) q + 2 G1 tau/dt (1 - e^(-dt/tau)) dev(d eps).

use std::sync::Arc;

use impactite::materials::{
    Breakdown, Check, Constitutive, Fault, HughesWinget, IntoMaterial, Kinematics, Lane, Material,
    ObjectiveRate, ParameterError, Sym3, Update, point::finite_state, state,
};

state! {
    /// State variables of a material point.
    pub struct Memory<L> {
        /// Elastic stress s + K tr(eps) I, Pa.
        pub elastic: Sym3<L>,
        /// Overstress q, Pa.
        pub overstress: Sym3<L>,
        /// Volume over reference volume.
        pub volume_ratio: L,
        /// Work done on the point, J per reference volume.
        pub work: L,
    }
}

/// Standard linear solid; see the module.
#[derive(Clone, Copy, Debug)]
pub struct StandardLinearSolid {
    density: f64,
    bulk: f64,
    shear: f64,
    relaxing_shear: f64,
    relaxation_time: f64,
}

impl StandardLinearSolid {
    /// Create from density rho0 (kg/m^3), bulk modulus K, slow shear modulus G, relaxing shear modulus G1 (Pa) and
    /// relaxation time tau (s).
    ///
    /// # Errors
    /// Constant that is not positive.
    pub fn new(
        density: f64,
        bulk: f64,
        shear: f64,
        relaxing_shear: f64,
        relaxation_time: f64,
    ) -> Result<Self, ParameterError> {
        let check = Check("standard linear solid");
        Ok(StandardLinearSolid {
            density: check.positive("density", density)?,
            bulk: check.positive("bulk modulus", bulk)?,
            shear: check.positive("shear modulus", shear)?,
            relaxing_shear: check.positive("relaxing shear modulus", relaxing_shear)?,
            relaxation_time: check.positive("relaxation time", relaxation_time)?,
        })
    }
    /// Return the law as a material for a body.
    pub fn material(self) -> Arc<dyn Material<f64>> {
        self.compiled().into_material()
    }
}

impl Constitutive<f64> for StandardLinearSolid {
    type State<L: Lane<Real = f64>> = Memory<L>;

    fn name(&self) -> &'static str {
        "standard linear solid"
    }
    fn density(&self) -> f64 {
        self.density
    }
    fn virgin(&self) -> Memory<f64> {
        Memory { elastic: Sym3::zero(), overstress: Sym3::zero(), volume_ratio: 1.0, work: 0.0 }
    }
    #[inline(always)]
    fn update<L: Lane<Real = f64>>(
        &self,
        kinematics: &Kinematics<L>,
        old: &Memory<L>,
    ) -> Update<L, Memory<L>> {
        let step = HughesWinget.increments(kinematics);
        let strain = step.strain;
        let deviator = strain.deviator();
        let x = kinematics.dt / L::of(self.relaxation_time);
        let decay = (-x).exp();
        // (1 - e^-x) / x, by its series where the difference suffers cancellation.
        let series = L::one() - x * L::of(0.5) * (L::one() - x * L::of(1.0 / 3.0));
        let mean_decay = L::select(x.lt(L::of(1e-5)), series, (L::one() - decay) / x);

        let elastic = HughesWinget.rotate(&step, &old.elastic) + deviator * L::of(2.0 * self.shear);
        let elastic = elastic.plus_isotropic(L::of(self.bulk) * strain.trace());
        let overstress = HughesWinget.rotate(&step, &old.overstress) * decay
            + deviator * (L::of(2.0 * self.relaxing_shear) * mean_decay);
        let stress = elastic + overstress;

        let factor = kinematics.volume_factor();
        let volume_ratio = old.volume_ratio * factor;
        // Trapezoidal rule: the old stress, rotated, and the new one.
        let before = HughesWinget.rotate(&step, &(old.elastic + old.overstress));
        let volume = (old.volume_ratio + volume_ratio) * L::of(0.5);
        let work = old.work + volume * (before + stress).dot(&strain) * L::of(0.5);
        let state = Memory { elastic, overstress, volume_ratio, work };
        let fault = Fault::none()
            .require(factor.gt(L::zero()), Breakdown::InvertedVolume)
            .require(finite_state(&state), Breakdown::NotFinite);
        Update { state, stress, fault }
    }
    #[inline(always)]
    fn stress<L: Lane<Real = f64>>(&self, now: &Memory<L>) -> Sym3<L> {
        now.elastic + now.overstress
    }
    #[inline(always)]
    fn volume_ratio<L: Lane<Real = f64>>(&self, now: &Memory<L>) -> L {
        now.volume_ratio
    }
    /// Wave speed in the limit of high frequency, without relaxation: rho c^2 = K + 4/3 (G + G1).
    #[inline(always)]
    fn wave_speed<L: Lane<Real = f64>>(&self, now: &Memory<L>) -> L {
        let modulus = self.bulk + 4.0 / 3.0 * (self.shear + self.relaxing_shear);
        (L::of(modulus / self.density) * now.volume_ratio).sqrt()
    }
    #[inline(always)]
    fn energy<L: Lane<Real = f64>>(&self, now: &Memory<L>) -> L {
        now.work
    }
}
