//! Solids whose parts are chosen at run time against solids of types: the same bits, the same state variables.

use std::sync::Arc;

use mpm_materials::eos::{CubicShock, PolynomialHugoniot};
use mpm_materials::material::{Deformation, Length, Motion, Response, StatesMut};
use mpm_materials::strength::SaturatingPower;
use mpm_materials::{
    Adiabatic, AnyFailure, AnySolid, Borvik, CohesiveSpall, Constitutive, CowperSymonds, CrackBand,
    DamageLimit, Elastic, Expanding, Gruneisen, Heat, IntoMaterial, J2, JohnsonCook, JohnsonCookDamage,
    LinearDensity, Logarithmic, LogarithmicBulk, LosesShear, LosesTension, Material, MieGruneisen, NoFailure,
    PlaneStress, PlasticStrainLimit, Polynomial, Porous, PowerRate, PrincipalStress, Remains, Removed,
    SmoothLogarithmic, Solid, SteinbergGuinan, Stretched, Stretching, Tait, TensilePressure, TulerButcher,
    library,
};

type Law = Arc<dyn Material<f64>>;
type Row = <f64 as impactite_simd::Float>::Row;

/// Number of groups and steps of a run.
const GROUPS: usize = 3;
const STEPS: usize = 120;

/// Random numbers in \[-1, 1\].
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }
}

/// Run points through random motions: compression, tension, shear and rotation in turn. Return all numbers of all steps.
fn driven(law: &Law, seed: u64) -> Vec<f64> {
    let mut random = Random(seed);
    let (numbers, lanes) = (law.numbers(), Row::default().as_ref().len());
    let mut rows: Vec<Row> = (0..GROUPS).flat_map(|_| law.virgin()).map(spread).collect();
    let groups: Vec<u32> = (0..GROUPS as u32).collect();
    let mut response = Response::default();
    let mut all = Vec::new();
    // Drift of each point, so that strains grow.
    let drift: Vec<[f64; 9]> = (0..GROUPS * lanes).map(|_| std::array::from_fn(|_| random.next())).collect();
    for step in 0..STEPS {
        let mut deformation: Vec<Deformation<Row>> = vec![Deformation::default(); GROUPS.div_ceil(2)];
        let phase = (step as f64 * 0.08).sin();
        for group in 0..GROUPS {
            let entry = &mut deformation[group / 2];
            for lane in 0..lanes {
                for k in 0..9 {
                    let rate = 3e3 * (phase * drift[group * lanes + lane][k] + 0.3 * random.next());
                    entry.gradient[k].0[group % 2].as_mut()[lane] = rate;
                }
                entry.step.0[group % 2].as_mut()[lane] = 1e-6;
            }
        }
        let motion = Motion { deformation: &deformation, dt: 1e-6, length: Length::Same(1e-3) };
        let states = StatesMut { all: &mut rows, stride: numbers, first: 0, groups: &groups };
        law.advance(&motion, states, true, &mut response);
        assert!(response.faults().is_empty(), "{} at step {step}: {:?}", law.constants(), response.faults());
        all.extend(rows.iter().flat_map(|row| row.as_ref().to_vec()));
        let outputs = response.outputs();
        for group in 0..GROUPS {
            let output = &outputs[group / 2];
            let given = output.stress.iter().chain([&output.volume_ratio, &output.step_speed]);
            all.extend(given.flat_map(|pair| pair.0[group % 2].as_ref().to_vec()));
        }
    }
    for group in 0..GROUPS {
        for lane in 0..lanes {
            let state: Vec<f64> =
                rows[group * numbers..][..numbers].iter().map(|row| row.as_ref()[lane]).collect();
            let said = law.describe_point(&state).expect("a state of this law");
            all.extend(said.stress);
            all.extend([said.volume_ratio, said.wave_speed, said.energy, f64::from(u8::from(said.failed))]);
        }
    }
    all
}

fn spread(x: f64) -> Row {
    let mut row = Row::default();
    row.as_mut().fill(x);
    row
}

/// Compare a law of run-time parts with one of types.
fn same(any: impl IntoMaterial<f64>, typed: impl IntoMaterial<f64>) {
    let (any, typed) = (any.into_material(), typed.into_material());
    assert_eq!(any.state_names(), typed.state_names(), "{}", typed.constants());
    assert_eq!(any.virgin(), typed.virgin(), "{}", typed.constants());
    assert_eq!((any.name(), any.density()), (typed.name(), typed.density()));
    assert_eq!(any.shock_viscosity(), typed.shock_viscosity());
    for seed in [1, 2] {
        let (one, other) = (driven(&any, seed), driven(&typed, seed));
        assert_eq!(one.len(), other.len());
        let differ = one.iter().zip(&other).position(|(a, b)| a.to_bits() != b.to_bits());
        assert_eq!(differ, None, "{}", typed.constants());
    }
}

fn heat() -> Adiabatic<f64> {
    let heat = Heat { room: 294.0, melt: 1356.0, exponent: 1.09, heat_capacity: 383.0, taylor_quinney: 0.9 };
    Adiabatic::new(heat).expect("constants")
}

fn hardening() -> JohnsonCook<f64> {
    JohnsonCook::new(47.7e9, 90e6, 292e6, 0.31).expect("constants")
}

#[test]
fn solids_of_run_time_parts_have_the_bits_of_types() {
    let copper = MieGruneisen::copper();
    let damage = JohnsonCookDamage::copper_ofhc();
    same(
        AnySolid::new(Elastic::new(80e9).unwrap(), LinearDensity::new(7850.0, 4570.0).unwrap()),
        Solid::new(Elastic::new(80e9).unwrap(), LinearDensity::new(7850.0, 4570.0).unwrap()).compiled(),
    );
    let j2 = J2::linear(79e9, 350e6, 1e9).unwrap();
    let bulk = LogarithmicBulk::new(7850.0, 172e9).unwrap();
    let limit = PlasticStrainLimit::new(0.05).unwrap();
    same(AnySolid::new(j2, bulk).with_failure(limit), Solid::new(j2, bulk).with_failure(limit).compiled());
    let voce = J2::voce(26e9, 270e6, 100e6, 12.0).unwrap();
    let spall = TensilePressure::new(8e8).unwrap();
    same(
        AnySolid::new(voce, copper).with_failure(spall),
        Solid::new(voce, copper).with_failure(spall).compiled(),
    );
    let saturating = J2::new(47.7e9, SaturatingPower::new(120e6, 640e6, 36.0, 0.45, 0.0).unwrap()).unwrap();
    let cubic =
        Gruneisen::new(CubicShock::new(8930.0, 3940.0, [1.49, 0.1, 0.02]).unwrap(), 1.96, 0.47).unwrap();
    same(AnySolid::new(saturating, cubic), Solid::new(saturating, cubic).compiled());
    let curve = PolynomialHugoniot::new(8930.0, [139e9, 276e9, 233e9]).unwrap();
    let hugoniot = Gruneisen::new(curve, 1.96, 0.47).unwrap();
    same(
        AnySolid::new(hardening(), hugoniot).with_failure(Removed(limit)),
        Solid::new(hardening(), hugoniot).with_failure(Removed(limit)).compiled(),
    );
    let simple = hardening().with_rate(Logarithmic::new(0.025, 1.0).unwrap());
    let polynomial = Polynomial::new(8930.0, [0.0, 139e9, 1e11, 0.0], [1.96, 0.3, 0.0], 0.0).unwrap();
    let brittle = PrincipalStress::new(6e8, 8e8).unwrap();
    same(
        AnySolid::new(simple, polynomial).with_failure(LosesTension(brittle)),
        Solid::new(simple, polynomial).with_failure(LosesTension(brittle)).compiled(),
    );
    let smooth = hardening().with_rate(SmoothLogarithmic::new(0.025, 1.0).unwrap()).with_heat(heat());
    let late = TulerButcher::new(4e8, 2.0, 3e-6).unwrap();
    same(
        AnySolid::new(smooth, Expanding::new(copper)).with_failure(LosesShear(late)),
        Solid::new(smooth, Expanding::new(copper)).with_failure(LosesShear(late)).compiled(),
    );
    let power = hardening().with_rate(PowerRate::new(0.01, 1.0).unwrap());
    let tait = Tait::new(8930.0, 3940.0).unwrap();
    same(AnySolid::new(power, tait), Solid::new(power, tait).compiled());
    let symonds = hardening().with_rate(CowperSymonds::new(40.0, 5.0).unwrap());
    let cohesive = CohesiveSpall::of_work(6e8, 5e3).unwrap();
    same(
        AnySolid::new(symonds, copper).with_failure(cohesive).with_bulk_viscosity(0.06, 1.5).unwrap(),
        Solid::new(symonds, copper).with_failure(cohesive).with_bulk_viscosity(0.06, 1.5).unwrap().compiled(),
    );
    let steinberg = SteinbergGuinan::copper();
    same(
        AnySolid::new(steinberg, copper).with_failure(damage),
        Solid::new(steinberg, copper).with_failure(damage).compiled(),
    );
    let weldox = Borvik::weldox_460_e();
    let critical = DamageLimit::new(0.3).unwrap();
    same(
        AnySolid::new(weldox, bulk).with_failure(critical),
        Solid::new(weldox, bulk).with_failure(critical).compiled(),
    );
    let band = CrackBand::new(3e-3).unwrap();
    let banded = weldox.with_localisation(band);
    same(AnySolid::new(banded, bulk), Solid::new(banded, bulk).compiled());
    let adiabatic = hardening().with_rate(Logarithmic::new(0.025, 1.0).unwrap()).with_heat(heat());
    let banded = damage.with_localisation(band);
    same(
        AnySolid::new(adiabatic, copper).with_failure(banded).with_bulk_viscosity(0.06, 1.5).unwrap(),
        Solid::new(adiabatic, copper).with_failure(banded).with_bulk_viscosity(0.06, 1.5).unwrap().compiled(),
    );
}

#[test]
fn solids_of_types_use_the_kernels_of_run_time_parts() {
    same(library::copper_ofhc(), library::copper_ofhc().compiled());
    same(library::weldox_460_e(), library::weldox_460_e().compiled());
    let viscous = library::lead().with_bulk_viscosity(0.06, 1.5).unwrap();
    same(viscous, viscous.compiled());
}

#[test]
fn criteria_together_fail_as_a_pair_does() {
    let (damage, spall) = (JohnsonCookDamage::copper_ofhc(), TensilePressure::new(8e8).unwrap());
    let both = AnyFailure::default().or(damage).unwrap().or(spall).unwrap();
    let copper = library::copper_ofhc();
    same(
        AnySolid::new(*copper.strength(), *copper.eos()).with_failure(both),
        copper.with_failure((damage, spall)).compiled(),
    );
    assert!(both.or(damage).is_err(), "two criteria of a kind");
    let crack = AnyFailure::from(CohesiveSpall::of_work(6e8, 5e3).unwrap());
    assert!(crack.with_post_failure(Remains::Pressure).is_err(), "a crack that carries tension");
    assert_eq!(AnyFailure::from(NoFailure), AnyFailure::<f64>::default());
}

#[test]
fn pores_plates_and_stretches_have_the_bits_of_types() {
    let (strength, eos) = (J2::linear(26e9, 100e6, 1e8).unwrap(), MieGruneisen::aluminium_6061());
    let solid = AnySolid::new(strength, eos);
    same(
        solid.with_pores(1.3, 5e7, 5e8).unwrap(),
        Porous::new(strength, eos, 1.3, 5e7, 5e8).unwrap().compiled(),
    );
    assert!(solid.with_failure(TensilePressure::new(1e9).unwrap()).with_pores(1.3, 5e7, 5e8).is_err());
    let lead = library::lead();
    let stretched: Law = Arc::new(Stretched::new(lead.into_material()));
    same(stretched, Stretching::new(lead).compiled());

    // A plate in tension: the secant iteration of plane stress is that of types.
    let plate = solid.in_plane_stress().into_material();
    let typed = PlaneStress::new(Solid::new(strength, eos)).compiled().into_material();
    assert_eq!(plate.state_names(), typed.state_names());
    assert_eq!(plate.virgin(), typed.virgin());
    assert!(plate.is_plane_stress());
}
