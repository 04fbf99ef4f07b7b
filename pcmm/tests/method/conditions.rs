//! Rough walls, absorbing planes and user-defined conditions on particles, against exact solutions.

use std::sync::Arc;

use impactite_geometry::Cuboid;
use impactite_scene::{Boundary, Condition, Place, PlaneStrain, Reaction, Side, Solver, TimeControl, Watch};
use mpm_materials::{LinearElastic, Moduli};
use pcmm::{Composition, LocalDelaunay, Masses, Method, Packing, Pcmm};

use crate::common::block;

const DENSITY: f64 = 1000.0;
const YOUNG: f64 = 1e6;
const POISSON: f64 = 0.3;
/// Gravity, m/s^2.
const G: f64 = 10.0;

fn law() -> LinearElastic<f64> {
    LinearElastic::new(DENSITY, Moduli::young_poisson(YOUNG, POISSON).unwrap()).unwrap()
}
fn longitudinal() -> f64 {
    (YOUNG * (1.0 - POISSON) / ((1.0 + POISSON) * (1.0 - 2.0 * POISSON)) / DENSITY).sqrt()
}
fn shear() -> f64 {
    (YOUNG / (2.0 * (1.0 + POISSON)) / DENSITY).sqrt()
}
/// Return a body of elements.
fn body(
    packing: &Packing<2>,
    velocity: &dyn Fn([f64; 2]) -> [f64; 2],
) -> Pcmm<2, impl Composition<2> + use<>> {
    let method = Method::consistent(PlaneStrain, LocalDelaunay::new(0.9 * packing.radii[0], 2.0).unwrap());
    Pcmm::new(method, law(), packing, velocity, Masses::FromElements).unwrap()
}
fn floor(velocity: [f64; 2], friction: f64) -> Boundary<2> {
    Boundary::FrictionWall { axis: 1, at: 0.0, side: Side::Above, velocity, friction }
}

#[test]
fn particles_slide_to_a_stop_and_heat() {
    // Without elements every number is exact to rounding.
    let packing = Packing {
        positions: vec![[0.0, 0.0], [5.0, 0.0]],
        radii: vec![0.1; 2],
        volumes: vec![1.0, 2.0],
        surface: 0.0,
    };
    let method = Method::consistent(PlaneStrain, LocalDelaunay::new(0.1, 2.0).unwrap());
    let mut two = Pcmm::new(method, law(), &packing, |_| [3.0, 0.0], Masses::FromVolumes).unwrap();
    two.bound(floor([1.0, 0.0], 0.4)).unwrap();
    two.set_body_force(Arc::new(|_| [0.0, -G]));
    two.set_time_control(TimeControl::Fixed(1e-3)).unwrap();
    let mass = two.totals().mass;
    two.run_until(0.25).unwrap();
    let (v, given, account) = (two.totals().momentum[0] / mass, two.exchange(), two.account());
    assert!((v - (3.0 - 0.4 * G * 0.25)).abs() < 1e-12, "{v}");
    // Friction dissipates mu m g times the slip, and the floor does work at its own speed.
    let heat = 0.4 * mass * G * (2.0 * 0.25 - 0.5 * 0.4 * G * 0.25 * 0.25);
    assert!((given.friction - heat).abs() < 1e-12 * heat, "{} and {heat} J", given.friction);
    assert!((given.work + 0.4 * mass * G * 0.25).abs() < 1e-12 * heat, "{} J", given.work);
    assert!(account.energy_error().abs() < 1e-13 && account.missing() < 1e-13 * account.momentum_scale);
    // Afterwards it moves with the floor.
    two.run_until(1.0).unwrap();
    let (v, given, account) = (two.totals().momentum[0] / mass, two.exchange(), two.account());
    assert!((v - 1.0).abs() < 1e-12, "{v}");
    assert!((given.friction - 0.5 * mass * 4.0).abs() < 1e-2 * given.friction, "{} J", given.friction);
    assert!(account.energy_error().abs() < 1e-13, "{}", account.energy_error());
}

#[test]
fn a_block_on_an_incline_sticks_or_slides() {
    for degrees in [15.0f64, 30.0] {
        let angle = degrees.to_radians();
        let mut block = body(&block([0.0; 2], 12, 3, 0.1), &|_| [0.0; 2]);
        block.bound(floor([0.0; 2], 0.4)).unwrap();
        // The block has no damping: the load rises slowly, and the rest of the bounce is subtracted below.
        block.set_body_force(Arc::new(move |t| {
            let g = G * (t / 0.3).min(1.0);
            [g * angle.sin(), -g * angle.cos()]
        }));
        block.set_watch(Watch::default().only_warn());
        block.run_until(0.5).unwrap();
        let velocity = |b: &Pcmm<2, _>| b.totals().momentum.map(|p| p / b.totals().mass);
        let (start, before) = (velocity(&block), Solver::exchange(&block));
        block.run_until(1.2).unwrap();
        let (end, given) = (velocity(&block), Solver::exchange(&block));
        let [a, lifts] = [0, 1].map(|d| (end[d] - start[d]) / 0.7);
        let speed = start[0];
        let [along, across] = [0, 1].map(|d| given.impulse[d] - before.impulse[d]);
        let account = block.account();
        println!(
            "{degrees}: {a} m/s^2, lifts {lifts}, speed {speed}, along over across {}, books {:?}",
            -along / across,
            account
        );
        if degrees < 20.0 {
            assert!(speed.abs() < 0.02 && a.abs() < 0.05, "{a} m/s^2 from {speed} m/s");
        } else {
            let exact = G * (angle.sin() - 0.4 * angle.cos());
            // The mean normal force is m (g cos a + a_y).
            let settled = a + 0.4 * lifts;
            assert!((settled / exact - 1.0).abs() < 0.01, "{settled} m/s^2, exact {exact}");
            assert!((-along / across / 0.4 - 1.0).abs() < 5e-3, "{along} and {across} N s");
        }
        // To rounding of the impulse of the floor.
        assert!(account.missing() < 1e-13 * across, "{} of {across} N s", account.missing());
        assert!(account.energy_error().abs() < 0.02, "{}", account.energy_error());
    }
}

/// Return the largest speed along `axis` in a bar after both halves of a pulse reached an end, over that of the pulse.
fn reflected(absorbs: bool, axis: usize, cells: u32, courant: f64) -> f64 {
    let h = 1.0 / f64::from(cells);
    let pulse = |x: f64| 1e-4 * (-((x - 0.5) / 0.1).powi(2)).exp();
    let velocity = |x: [f64; 2]| if axis == 0 { [pulse(x[0]), 0.0] } else { [0.0, pulse(x[0])] };
    let mut bar = body(&block([0.0; 2], cells, 4, h), &velocity);
    if absorbs {
        for (at, side) in [(0.0, Side::Above), (1.0, Side::Below)] {
            let (longitudinal, shear) = (longitudinal(), shear());
            bar.bound(Boundary::Absorbing { axis: 0, at, side, longitudinal, shear }).unwrap();
        }
    }
    // The velocity across the wave is zero: a one-dimensional wave.
    let all = Cuboid::new([-1.0; 2], [2.0; 2]).unwrap();
    let still = if axis == 0 { [None, Some(0.0), None] } else { [Some(0.0), None, None] };
    bar.bound(Boundary::Prescribed { region: Arc::new(all), velocity: Arc::new(move |_| still) }).unwrap();
    bar.set_time_control(TimeControl::Fixed(courant * h / longitudinal())).unwrap();
    let speed = if axis == 0 { longitudinal() } else { shear() };
    bar.run_until(1.0 / speed).unwrap();
    bar.particles().iter().map(|p| p.velocity[axis].abs()).fold(0.0, f64::max) / 1e-4
}

#[test]
fn waves_are_absorbed() {
    for axis in 0..2 {
        for (cells, courant) in [(50, 0.2), (50, 0.5), (80, 0.5)] {
            let r = reflected(true, axis, cells, courant);
            println!("axis {axis}, {cells} cells, courant {courant}: {r:.4}");
            assert!(r < 0.03, "along {axis}: {r} comes back");
        }
        let r = reflected(false, axis, 80, 0.5);
        println!("axis {axis}, free: {r:.4}");
        assert!((r - 1.0).abs() < 0.05, "{r} comes back from a free end");
    }
}

/// Implicit viscous drag.
#[derive(Debug)]
struct Drag(f64);

impl Condition<2> for Drag {
    fn react(&self, place: &Place<2>) -> Reaction<2> {
        let rate = self.0 * place.dt;
        let impulse = place.trial.map(|v| -place.mass * v * rate / (1.0 + rate));
        Reaction { impulse, velocity: place.mean(&place.after(&impulse)), ..Reaction::none() }
    }
}

#[test]
fn conditions_of_ones_own_act_on_particles() {
    let mut bar = body(&block([0.0; 2], 6, 3, 0.1), &|_| [2.0, 1.0]);
    bar.bound(Boundary::own(Drag(3.0))).unwrap();
    bar.set_time_control(TimeControl::Fixed(1e-3)).unwrap();
    bar.run_until(0.5).unwrap();
    let exact = 1.003f64.powi(-500);
    let totals = bar.totals();
    assert!((totals.momentum[0] / totals.mass / 2.0 / exact - 1.0).abs() < 1e-10);
    let account = bar.account();
    assert!(
        account.energy_error().abs() < 1e-10
            && account.work < 0.0
            && account.missing() < 1e-12 * account.momentum_scale
    );
}

#[test]
fn periodic_planes_are_refused() {
    let mut bar = body(&block([0.0; 2], 6, 3, 0.1), &|_| [0.0; 2]);
    let refused = bar.bound(Boundary::Periodic { axis: 0, low: 0.0, high: 0.6 }).unwrap_err().to_string();
    assert_eq!(
        refused,
        "periodic planes across axis 0 are not allowed in the particle-contact method; take planes of symmetry, or the material point \
         method"
    );
}

#[test]
fn threads_and_checkpoints_change_no_bit() {
    let scene = |friction, threads| {
        let mut bar = body(&block([0.0; 2], 80, 40, 0.0125), &|x| [0.5 + x[1], -0.1]);
        bar.bound(floor([0.3, 0.0], friction)).unwrap();
        let (longitudinal, shear) = (longitudinal(), shear());
        bar.bound(Boundary::Absorbing { axis: 1, at: 0.5, side: Side::Below, longitudinal, shear }).unwrap();
        bar.set_body_force(Arc::new(|_| [1.0, -G]));
        Solver::set_team(&mut bar, impactite_simd::Team::new(threads).unwrap());
        bar
    };
    let mut plain = scene(0.3, 1);
    plain.run_until(0.002).unwrap();
    assert!(Solver::exchange(&plain).friction > 0.0);
    for threads in 2..=4 {
        let mut other = scene(0.3, threads);
        other.run_until(0.002).unwrap();
        assert!(plain.particles() == other.particles(), "{threads} threads");
        assert_eq!(Solver::exchange(&plain), Solver::exchange(&other));
    }
    let file = std::env::temp_dir().join(format!("impactite-pcmm-conditions-{}", std::process::id()));
    let mut saved = scene(0.3, 1);
    while saved.time() < 0.001 {
        saved.step_towards(0.002).unwrap();
    }
    Solver::save(&mut saved, &file).unwrap();
    let mut resumed = scene(0.3, 1);
    Solver::resume(&mut resumed, &file).unwrap();
    let other = Solver::resume(&mut scene(0.4, 1), &file).unwrap_err().to_string();
    std::fs::remove_file(&file).unwrap();
    resumed.run_until(0.002).unwrap();
    assert!(plain.particles() == resumed.particles() && other.contains("boundary 0"), "{other}");
}
