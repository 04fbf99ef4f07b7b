//! Conformance suite applied to every law of the crate.

use mpm_materials::conformance::{Options, eos, state_length};
use mpm_materials::*;

fn steel() -> Moduli<f64> {
    Moduli::young_poisson(200e9, 0.3).unwrap()
}

/// Options of metals: shear work heats, see [`Options::wave_tolerance`]. In strong tension the reference modulus is
/// low.
fn metal(strain: f64) -> Options {
    Options { wave_tolerance: 0.05, ..Options::strain(strain) }
}

// Elastic laws.
conformance_suite!(
    linear_elastic,
    LinearElastic::new(7800.0, steel()).unwrap(),
    Options { work_tolerance: 2e-2, ..Options::strain(1e-3) };
    single = LinearElastic::new(7800.0_f32, Moduli::young_poisson(200e9, 0.3).unwrap()).unwrap()
);
conformance_suite!(
    linear_elastic_small_rotation,
    LinearElastic::new(7800.0, steel()).unwrap().with_rate(SmallRotation),
    Options { work_tolerance: 2e-2, exact_rotation: false, ..Options::strain(1e-3) }
);
conformance_suite!(
    neo_hookean,
    NeoHookean::new(7800.0, steel()).unwrap(),
    Options::strain(0.1),
    hyperelastic;
    single = NeoHookean::new(7800.0_f32, Moduli::young_poisson(200e9, 0.3).unwrap()).unwrap()
);
conformance_suite!(
    soft_neo_hookean,
    NeoHookean::new(1000.0, Moduli::young_poisson(1e5, 0.45).unwrap()).unwrap(),
    Options { duration: 1.0, ..Options::strain(0.2) },
    hyperelastic
);
conformance_suite!(
    elastic_solid,
    Solid::new(Elastic::new(80e9).unwrap(), LogarithmicBulk::new(7800.0, 160e9).unwrap()),
    Options::strain(0.02)
);
conformance_suite!(
    elastic_solid_small_rotation,
    Solid::new(Elastic::new(80e9).unwrap(), MieGruneisen::steel_4340()).with_rate(SmallRotation),
    Options { exact_rotation: false, ..metal(0.02) }
);

conformance_suite!(
    stretching,
    Stretching::new(Solid::new(
        J2::linear(26e9, 300e6, 1e9).unwrap(),
        LinearDensity::new(2700.0, 5000.0).unwrap()
    )),
    metal(0.05),
    yields
);

// Plastic solids.
conformance_suite!(
    perfectly_plastic,
    Solid::new(J2::linear(26e9, 300e6, 0.0).unwrap(), MieGruneisen::aluminium_6061()),
    metal(0.05),
    yields
);
conformance_suite!(
    linear_hardening,
    Solid::new(J2::linear(26e9, 300e6, 1e9).unwrap(), LinearDensity::new(2700.0, 5000.0).unwrap()),
    metal(0.05),
    yields
);
conformance_suite!(
    ludwik,
    Solid::new(J2::ludwik(26e9, 100e6, 300e6, 0.3).unwrap(), MieGruneisen::aluminium_6061()),
    metal(0.1),
    yields
);
conformance_suite!(
    ludwik_steep_start,
    Solid::new(J2::ludwik(26e9, 1e6, 900e6, 0.08).unwrap(), MieGruneisen::aluminium_6061()),
    metal(0.1),
    yields
);
conformance_suite!(
    ludwik_convex,
    Solid::new(J2::ludwik(26e9, 100e6, 900e6, 1.7).unwrap(), MieGruneisen::aluminium_6061()),
    metal(0.1),
    yields
);
conformance_suite!(
    copper_taylor,
    Solid::new(JohnsonCook::copper_taylor(), MieGruneisen::copper()).with_bulk_viscosity(0.06, 1.5).unwrap(),
    metal(0.1),
    yields;
    single = Solid::new(JohnsonCook::<f32>::copper_taylor(), MieGruneisen::copper())
        .with_bulk_viscosity(0.06, 1.5).unwrap()
);
conformance_suite!(
    copper,
    Solid::new(JohnsonCook::copper(), MieGruneisen::copper()).with_bulk_viscosity(0.06, 1.5).unwrap(),
    metal(0.1),
    yields;
    single = Solid::new(JohnsonCook::<f32>::copper(), MieGruneisen::copper())
        .with_bulk_viscosity(0.06, 1.5).unwrap()
);
conformance_suite!(
    aluminium_6061,
    Solid::new(JohnsonCook::aluminium_6061(), MieGruneisen::aluminium_6061().constant_gamma()),
    metal(0.1),
    yields
);
conformance_suite!(
    steel_4340,
    Solid::new(JohnsonCook::steel_4340(), MieGruneisen::steel_4340()),
    metal(0.1),
    yields
);
conformance_suite!(
    copper_smooth_rate,
    Solid::new(
        JohnsonCook::new(47.7e9, 90e6, 292e6, 0.31)
            .unwrap()
            .with_rate(SmoothLogarithmic::new(0.025, 1.0).unwrap()),
        MieGruneisen::copper(),
    ),
    Options { duration: 1.0, ..metal(0.1) },
    yields
);
conformance_suite!(
    lead_at_high_strain,
    Solid::new(JohnsonCook::lead(), MieGruneisen::lead()),
    metal(0.15),
    yields
);

// Failure criteria. The strains of the suite stay below failure where failure is abrupt.
fn brittle_aluminium() -> Solid<J2<f64>, MieGruneisen<f64>> {
    Solid::new(J2::linear(26e9, 300e6, 1e9).unwrap(), MieGruneisen::aluminium_6061())
}
conformance_suite!(
    plastic_strain_limit_reached,
    brittle_aluminium().with_failure(PlasticStrainLimit::new(0.02).unwrap()),
    Options { work_tolerance: 2e-2, ..metal(0.05) },
    fails
);
conformance_suite!(
    plastic_strain_limit_not_reached,
    brittle_aluminium().with_failure(PlasticStrainLimit::new(3.0).unwrap()),
    metal(0.05),
    yields
);
conformance_suite!(
    spall_not_reached,
    brittle_aluminium().with_failure(TensilePressure::new(1e12).unwrap()),
    metal(0.05),
    yields
);
conformance_suite!(
    principal_stress_not_reached,
    brittle_aluminium().with_failure(PrincipalStress::new(1e12, 1e12).unwrap()),
    metal(0.05),
    yields
);

#[test]
fn spall_never_heals() {
    let law = brittle_aluminium().with_failure(TensilePressure::new(1.2e9).unwrap());
    mpm_materials::conformance::fails(&law, &metal(0.05)).unwrap();
    mpm_materials::conformance::not_a_number(&law, &metal(0.05)).unwrap();
    mpm_materials::conformance::lanes(&law, &metal(0.05)).unwrap();
}

#[test]
fn principal_stress_never_heals() {
    for (tension, shear) in [(1.0e9, 1e15), (1e15, 1.4e8)] {
        let law = brittle_aluminium().with_failure(PrincipalStress::new(tension, shear).unwrap());
        mpm_materials::conformance::fails(&law, &metal(0.05)).unwrap();
        mpm_materials::conformance::lanes(&law, &metal(0.05)).unwrap();
    }
}

// Fluids.
conformance_suite!(
    air,
    Fluid::new(IdealGas::air()).with_bulk_viscosity(0.06, 1.5).unwrap(),
    Options { stress_free: false, ..Options::strain(0.2) };
    single = Fluid::new(IdealGas::<f32>::air()).with_bulk_viscosity(0.06, 1.5).unwrap()
);
conformance_suite!(water, Fluid::new(Tait::new(1000.0, 1480.0).unwrap()), Options::strain(0.05));
conformance_suite!(
    viscous_water,
    Fluid::new(KeepEnergy(Tait::new(1000.0, 50.0).unwrap()))
        .with_shear_viscosity(Newtonian::new(1e-3).unwrap()),
    Options { duration: 1e-3, ..Options::strain(0.05) }
);
conformance_suite!(
    linear_fluid,
    Fluid::new(LinearDensity::new(1000.0, 50.0).unwrap()),
    Options::strain(0.05)
);
conformance_suite!(hot_metal_fluid, Fluid::new(MieGruneisen::copper()), Options::strain(0.1));

#[test]
fn equations_of_state() {
    eos(&MieGruneisen::copper(), 0.6..1.2, 3e10).unwrap();
    eos(&MieGruneisen::copper().constant_gamma(), 0.6..1.2, 3e10).unwrap();
    eos(&MieGruneisen::aluminium_6061().with_correction(0.48).unwrap(), 0.6..1.2, 2e10).unwrap();
    eos(&MieGruneisen::steel_4340(), 0.7..1.2, 3e10).unwrap();
    eos(&MieGruneisen::lead(), 0.6..1.2, 1e10).unwrap();
    eos(&Expanding::new(MieGruneisen::lead()), 0.6..3.0, 8e10).unwrap();
    eos(&IdealGas::air(), 0.1..10.0, 1e7).unwrap();
    eos(&LinearDensity::new(1000.0, 50.0).unwrap(), 0.5..2.0, 0.0).unwrap();
    eos(&LogarithmicBulk::new(1000.0, 2e9).unwrap(), 0.5..2.0, 0.0).unwrap();
    eos(&Tait::new(1000.0, 1480.0).unwrap(), 0.7..1.3, 0.0).unwrap();
}

#[test]
fn absent_ingredients_take_no_memory() {
    let solid = |law| Solid::new(law, MieGruneisen::copper());
    assert_eq!(state_length(&Solid::new(Elastic::new(1.0).unwrap(), MieGruneisen::copper())), 8);
    assert_eq!(state_length(&solid(JohnsonCook::copper_taylor())), 9);
    assert_eq!(state_length(&Solid::new(JohnsonCook::copper(), MieGruneisen::copper())), 10);
    let limited = solid(JohnsonCook::copper_taylor()).with_failure(PlasticStrainLimit::new(3.0).unwrap());
    assert_eq!(state_length(&limited), 9);
    let spalling = solid(JohnsonCook::copper_taylor()).with_failure(TensilePressure::new(1e9).unwrap());
    assert_eq!(state_length(&spalling), 10);
    assert_eq!(state_length(&Fluid::new(Tait::new(1000.0, 50.0).unwrap())), 1);
    assert_eq!(state_length(&Fluid::new(IdealGas::air())), 2);
}

mpm_materials::state! {
    /// State of another law, and the shear of the last step as output.
    pub struct Shown<L, S> {
        /// State of the law.
        pub law: S,
        /// Shear of the last step.
        pub shear: L,
    }
}

/// Rubber with an output variable, which is write-only or used as a pressure that hides a NaN.
#[derive(Clone, Debug)]
struct Showing {
    rubber: NeoHookean<f64>,
    reads: bool,
}

type Rubber<L> = <NeoHookean<f64> as Constitutive<f64>>::State<L>;

impl Constitutive<f64> for Showing {
    type State<L: Lane<Real = f64>> = Shown<L, Rubber<L>>;
    fn name(&self) -> &'static str {
        "showing"
    }
    fn density(&self) -> f64 {
        Constitutive::<f64>::density(&self.rubber)
    }
    fn virgin(&self) -> Self::State<<f64 as Real>::Single> {
        Shown { law: self.rubber.virgin(), shear: Lane::zero() }
    }
    fn update<L: Lane<Real = f64>>(
        &self,
        kinematics: &Kinematics<L>,
        old: &Self::State<L>,
    ) -> Update<L, Self::State<L>> {
        let Update { state, stress, fault } = self.rubber.update(kinematics, &old.law);
        let read = if self.reads { old.shear } else { L::zero() };
        let pressure = L::select(read.is_finite(), read, L::one());
        let state = Shown { law: state, shear: kinematics.increment.0[0][1] };
        Update { state, stress: stress.plus_isotropic(-pressure), fault }
    }
    fn stress<L: Lane<Real = f64>>(&self, now: &Self::State<L>) -> Sym3<L> {
        self.rubber.stress(&now.law)
    }
    fn volume_ratio<L: Lane<Real = f64>>(&self, now: &Self::State<L>) -> L {
        self.rubber.volume_ratio(&now.law)
    }
    fn wave_speed<L: Lane<Real = f64>>(&self, now: &Self::State<L>) -> L {
        self.rubber.wave_speed(&now.law)
    }
    fn energy<L: Lane<Real = f64>>(&self, now: &Self::State<L>) -> L {
        self.rubber.energy(&now.law)
    }
}

/// A write-only state variable may be NaN; a state variable that the law reads must be reported if it is NaN.
#[test]
fn only_what_a_law_reads_must_be_a_number() {
    let rubber = NeoHookean::new(1000.0, Moduli::young_poisson(1e7, 0.4).unwrap()).unwrap();
    let shows = Showing { rubber, reads: false };
    mpm_materials::conformance::not_a_number(&shows, &Options::strain(0.2)).unwrap();
    let swallows = Showing { rubber, reads: true };
    let told = mpm_materials::conformance::not_a_number(&swallows, &Options::strain(0.2)).unwrap_err();
    assert!(told.contains("NaN in number 9 of the old state"), "{told}");
}
