//! V24: adiabatic heating. Plastic work heats, heat expands, and the energy balance closes; the framework has no heat
//! conduction.

use std::sync::Arc;

use mpm_core::Run;
use mpm_core::geometry::{Cuboid, Lattice};
use mpm_core::observe::{Ledger, Pace};
use mpm_core::{
    BlockGrid, Boundary, Deformable, Flip, GridBody, IntoKernels, Linear, Method, Mpm, Musl, PlaneStrain,
    Side, TimeControl,
};
use mpm_materials::strength::{Adiabatic, Heat};
use mpm_materials::{Constitutive, Elastic, IntoMaterial, JohnsonCook, MieGruneisen, Solid};
use verification::scene::block;

const DENSITY: f64 = 8960.0;
const SOUND: f64 = 3940.0;
const GRUNEISEN: f64 = 1.99;
const SHEAR: f64 = 46.0e9;
const HEAT_CAPACITY: f64 = 383.0;
const CELLS: usize = 20;

fn metal() -> MieGruneisen<f64> {
    MieGruneisen::new(DENSITY, SOUND, 1.489, GRUNEISEN).expect("equation of state")
}

/// Longitudinal wave speed, m/s.
fn wave() -> f64 {
    (SOUND * SOUND + 4.0 / 3.0 * SHEAR / DENSITY).sqrt()
}

/// Bar of 1 m, one cell high between symmetry planes, fixed at x = 0.
fn bar<C: Constitutive<f64>>(
    method: impl IntoKernels<f64, 2>,
    law: impl IntoMaterial<f64, Law = C>,
    state: C::State<f64>,
    velocity: impl Fn(f64) -> f64,
) -> Mpm<2> {
    let h = 1.0 / CELLS as f64;
    let lattice = Lattice::new([0.0; 2], h).expect("lattice");
    let seeds = block(&lattice, [0; 2], [CELLS, 1], 2);
    let mut mpm = Mpm::new(method, BlockGrid::new(lattice));
    let body = Deformable::new("bar", law, &seeds).moving(|x| [velocity(x[0]), 0.0]).in_state(|_| state);
    mpm.add_body(body).expect("body");
    mpm.bound(Boundary::Symmetry { axis: 0, at: 0.0, side: Side::Above }).expect("end");
    mpm.bound(Boundary::Symmetry { axis: 1, at: 0.0, side: Side::Above }).expect("below");
    mpm.bound(Boundary::Symmetry { axis: 1, at: h, side: Side::Below }).expect("above");
    mpm
}

/// State variable of all particles, by name.
fn all(body: &dyn GridBody<f64, 2>, name: &str) -> Vec<f64> {
    let names = body.state_names();
    let at = names.iter().position(|n| n.ends_with(name)).unwrap_or_else(|| panic!("{name} of {names:?}"));
    let mut list = Vec::new();
    body.for_each(&mut |p| list.push(p.state[at]));
    list
}

/// Uniform compression by the bar end: every point keeps its initial velocity -a X, so that accelerations are zero and the
/// strain is exact. Perfect plasticity in uniaxial strain: eps_p = 2/3 ln(J_y / J) from J_y = exp(-Y / 2 G) on; with Cauchy
/// stress the plastic work per reference volume is 2/3 Y (J_y - J).
#[test]
fn v24_plastic_work_heats() {
    let (yielding, part) = (400.0e6, 0.9);
    // Melting temperature so high that there is no thermal softening.
    let heat =
        Heat { room: 294.0, melt: 1e7, exponent: 1.0, heat_capacity: HEAT_CAPACITY, taylor_quinney: part };
    let strength = JohnsonCook::new(SHEAR, yielding, 0.0, 1.0).expect("strength");
    let strength = strength.with_heat(Adiabatic::new(heat).expect("heat"));
    let law = Solid::new(strength, metal());
    let speed = 10.0;
    // Total Lagrangian: no cell of the end is partly empty.
    let method = Method::new(Linear, Flip, Musl, PlaneStrain).total_lagrangian();
    let mut mpm = bar(method, law.compiled(), law.virgin(), |x| -speed * x);
    let end = Cuboid::new([0.999, -1.0], [1.001, 1.0]).expect("end");
    let velocity = Arc::new(move |_: f64| [Some(-speed), None, None]);
    mpm.bound(Boundary::Prescribed { region: Arc::new(end), velocity }).expect("end");
    let mut ledger = Ledger::new(Pace::every_step());
    Run::new(&mut mpm).observe(&mut ledger).until(0.1 / speed).expect("run");

    let (onset, now) = ((-yielding / (2.0 * SHEAR)).exp(), 0.9);
    let exact = part * 2.0 / 3.0 * yielding * (onset - now) / (DENSITY * HEAT_CAPACITY);
    let found = all(&*mpm.bodies()[0], "temperature");
    let (low, high) = found.iter().fold((f64::INFINITY, 0.0f64), |s, t| (s.0.min(*t), s.1.max(*t)));
    let energy = ledger.worst_energy_error();
    println!("heating by {:.4} to {:.4} K, exact {exact:.4}; energy {energy:.1e}", low - 294.0, high - 294.0);
    // Tolerance: strain increments are of first order in the step, of which there are some thousand.
    for t in [low, high] {
        assert!(((t - 294.0) / exact - 1.0).abs() < 2e-3, "{} K for {exact}", t - 294.0);
    }
    // Tolerance: the work of the end uses momentum at half steps, which is of first order in the step.
    assert!(energy.abs() < 1e-3, "energy {energy}");
}

/// A uniformly heated bar: e = rho0 c dT, with Mie-Grueneisen pressure gamma0 e, which is 3 K alpha dT. Fixed at both ends the
/// pressure persists; released at one end the bar oscillates about the length at rest, L (1 + gamma0 e / (K + 4 G / 3)).
#[test]
fn v24_heat_expands_a_bar() {
    let law = Solid::new(Elastic::new(SHEAR).expect("strength"), metal());
    let hot = DENSITY * HEAT_CAPACITY * 1.0;
    let mut state = law.virgin();
    state.energy = hot;
    let pressure = GRUNEISEN * hot;
    let period = 4.0 / wave();

    let method = || Method::new(Linear, Flip, Musl, PlaneStrain);
    let mut held = bar(method(), law.compiled(), state, |_| 0.0);
    held.bound(Boundary::Symmetry { axis: 0, at: 1.0, side: Side::Below }).expect("end");
    held.run_until(period).expect("run");
    held.bodies()[0].for_each(&mut |p| {
        // Tolerance: all points are at rest, so that the error is round-off.
        assert!((p.stress[0] / -pressure - 1.0).abs() < 1e-12, "{} Pa for {pressure}", -p.stress[0]);
    });

    let mut free = bar(method(), law.compiled(), state, |_| 0.0);
    let (h, periods, steps) = (1.0 / CELLS as f64, 4, 400);
    let dt = period / f64::from(steps);
    assert!(dt * wave() < 0.5 * h);
    free.set_time_control(TimeControl::Fixed(dt)).expect("step");
    let mut ledger = Ledger::new(Pace::every_step());
    let (mut sum, mut count) = (0.0, 0.0);
    let last = 2 * CELLS - 1;
    let start = 1.0 - 0.25 * h;
    for n in 1..=periods * steps {
        Run::new(&mut free).observe(&mut ledger).until(f64::from(n) * dt).expect("run");
        free.bodies()[0].for_each(&mut |p| {
            if p.number % (2 * CELLS) == last {
                sum += (p.position[0] - start) / start;
                count += 1.0;
            }
        });
    }
    let exact = pressure / (DENSITY * wave() * wave());
    let (found, energy) = (sum / count, ledger.worst_energy_error());
    println!("mean strain {found:.4e}, exact {exact:.4e}; energy {energy:.1e}");
    // Tolerance: second order in the cell size, of 20 cells, and in the strain.
    assert!((found / exact - 1.0).abs() < 0.01, "{found} for {exact}");
    // MUSL energies of momentum and stress are half a step apart: the oscillation is a fraction omega dt / 2 of the elastic
    // energy.
    assert!(energy.abs() < 1e-6, "energy {energy}");
}
