//! Plane stress laws, used by plane strain methods: plates of material points and of finite elements against
//! closed-form solutions.

use std::f64::consts::PI;

use fem::{Fem, Hourglass, MeshBody, Technology};
use mpm_core::geometry::structured::box_mesh;
use mpm_core::geometry::{Cuboid, ElementKind, Filling, Lattice, fill};
use mpm_core::{
    BlockGrid, Boundary, Flip, IntoKernels, Linear, Method, Mpm, Musl, PlaneStrain, PointView, Side, Solver,
};
use mpm_materials::{
    Constitutive, IntoMaterial, J2, LinearElastic, LogarithmicBulk, Moduli, PlaneStress, Solid,
};

const YOUNG: f64 = 200e9;
const POISSON: f64 = 0.3;
const DENSITY: f64 = 7850.0;
const YIELD: f64 = 400e6;
/// Cell size, m, and cells along a plate.
const H: f64 = 1e-3;
const ALONG: usize = 40;
const LENGTH: f64 = ALONG as f64 * H;

fn moduli() -> Moduli<f64> {
    Moduli::young_poisson(YOUNG, POISSON).unwrap()
}

fn elastic() -> impl IntoMaterial<f64> + Copy {
    PlaneStress::new(LinearElastic::new(DENSITY, moduli()).unwrap())
}

/// Return the J2 law in plane stress without hardening.
fn plastic() -> impl IntoMaterial<f64> + Copy {
    let bulk = LogarithmicBulk::new(DENSITY, moduli().bulk).unwrap();
    PlaneStress::new(Solid::new(J2::linear(moduli().shear, YIELD, 0.0).unwrap(), bulk)).compiled()
}

/// Return symmetry planes by axis and position; the plate is between them.
fn planes(list: &[(usize, f64)]) -> impl Iterator<Item = Boundary<2>> + '_ {
    list.iter().map(|&(axis, at)| {
        let side = if at > 0.0 { Side::Below } else { Side::Above };
        Boundary::Symmetry { axis, at, side }
    })
}

type Velocity = fn([f64; 2]) -> [f64; 2];

/// Build a plate of so many cells across by both methods.
fn plates(
    law: impl IntoMaterial<f64> + Copy,
    across: usize,
    velocity: Velocity,
    held: &[(usize, f64)],
) -> Vec<Box<dyn Solver>> {
    let shape = Cuboid::new([0.0; 2], [LENGTH, across as f64 * H]).unwrap();
    let lattice = Lattice::new([0.0; 2], H).unwrap();
    let seeds = fill(&shape, &lattice, 2, &Filling::new()).unwrap();
    let particles = |method: &dyn Fn() -> mpm_core::Kernels<f64, 2>| -> Box<dyn Solver> {
        let mut mpm = Mpm::new(method(), BlockGrid::new(lattice));
        mpm.add("plate", law, &seeds, velocity).unwrap();
        planes(held).for_each(|plane| mpm.bound(plane).unwrap());
        Box::new(mpm)
    };
    let elements = |technology: Technology| -> Box<dyn Solver> {
        let mesh = box_mesh(&shape, [ALONG, across]).unwrap();
        let body = MeshBody::new("plate", mesh, law).with(ElementKind::Quad4, technology).moving(velocity);
        let mut fem = Fem::new(PlaneStrain);
        fem.add(body).unwrap();
        planes(held).for_each(|plane| fem.bound(plane).unwrap());
        Box::new(fem)
    };
    vec![
        particles(&|| Method::new(Linear, Flip, Musl, PlaneStrain).into_kernels()),
        particles(&|| Method::impact(PlaneStrain).into_kernels()),
        elements(Technology::OnePoint(Hourglass::Stiffness(0.05))),
        elements(Technology::Full),
        elements(Technology::MeanDilatation),
    ]
}

/// Return `of` of every point, sorted by particle number.
fn look<R>(plate: &dyn Solver, mut of: impl FnMut(&PointView) -> R) -> Vec<R> {
    let mut found = Vec::new();
    plate.bodies()[0].for_each(&mut |point| found.push((point.number, of(point))));
    found.sort_by_key(|f| f.0);
    found.into_iter().map(|f| f.1).collect()
}

/// Plate wave speed of a standing wave between symmetry planes, c^2 = E / rho / (1 - nu^2): 10 % less than in plane strain.
#[test]
fn waves_are_as_fast_as_in_plates() {
    const SPEED: f64 = 0.1;
    const K: f64 = PI / LENGTH;
    let c = (YOUNG / DENSITY / (1.0 - POISSON * POISSON)).sqrt();
    let held = [(0, 0.0), (0, LENGTH), (1, 0.0), (1, 2.0 * H)];
    for mut plate in plates(elastic(), 2, |x| [SPEED * (K * x[0]).sin(), 0.0], &held) {
        let start = look(&*plate, |p| (p.mass, p.position[0]));
        // Modal amplitude of the displacement over its exact amplitude.
        let part = |plate: &dyn Solver| -> f64 {
            let now = look(plate, |p| p.position[0]);
            let mode = |x: f64| (K * x).sin();
            let sum: f64 = start.iter().zip(now).map(|((m, x), now)| m * mode(*x) * (now - x)).sum();
            sum / start.iter().map(|(m, x)| m * mode(*x).powi(2)).sum::<f64>() / (SPEED / (K * c))
        };
        let kinetic = plate.bodies()[0].totals().kinetic;
        plate.run_until(0.5 * LENGTH / c).unwrap();
        let (quarter, stored) = (part(&*plate), plate.bodies()[0].totals().internal / kinetic);
        plate.run_until(LENGTH / c).unwrap();
        let half = part(&*plate);
        assert!((quarter - 1.0).abs() < 0.01 && half.abs() < 0.02, "{}: {quarter} {half}", plate.method());
        assert!((stored - 1.0).abs() < 0.01, "{}: {stored}", plate.method());
        assert!(plate.account().energy_error().abs() < 5e-3);
    }
}

/// Uniaxial tension at a constant rate, uniform until the release wave from the free end arrives: sigma_xx = E e. The stress is zero along
/// y, where the strip is free and contracts by nu, and through the thickness, which contracts by as much.
#[test]
fn a_strip_is_drawn_with_youngs_modulus() {
    const STRAIN: f64 = 1e-4;
    const TIME: f64 = 0.6 * LENGTH / 5048.0;
    const RATE: f64 = STRAIN / TIME;
    for mut strip in plates(elastic(), 4, |[x, y]| [RATE * x, -POISSON * RATE * y], &[(0, 0.0), (1, 0.0)]) {
        strip.run_until(TIME).unwrap();
        let thickness = strip.bodies()[0].state_names().iter().position(|name| name == "thickness").unwrap();
        let seen = look(&*strip, |p| (p.position[0], p.stress, p.state[thickness]));
        let unheard: Vec<_> = seen.iter().filter(|s| s.0 < 0.2 * LENGTH).collect();
        assert!(unheard.len() >= 30);
        for (_, stress, thickness) in unheard {
            let over = stress.map(|s| s / (YOUNG * STRAIN));
            assert!((over[0] - 1.0).abs() < 5e-3, "{}: {over:?}", strip.method());
            assert!(over[1].abs() < 5e-3 && over[2].abs() < 1e-5, "{}: {over:?}", strip.method());
            let thinner = (1.0 - thickness) / (POISSON * STRAIN);
            assert!((thinner - 1.0).abs() < 5e-3, "{}: {thinner}", strip.method());
        }
        // Sudden release at the free end: USL dissipates modes as short as a cell.
        assert!(strip.account().energy_error().abs() < 0.01, "{}", strip.method());
    }
}

/// Uniaxial tension far beyond yield, fixed along y: sigma = 2 Y / sqrt 3, and the thickness decreases as the length grows except for the
/// elastic volume change. The symmetry plane carries this stress on the current thickness, 3 % less on average than the initial one.
#[test]
fn a_strip_yields_by_von_mises() {
    const STRETCH: f64 = 1.04;
    const TIME: f64 = 0.6 * LENGTH / 5048.0;
    const RATE: f64 = (STRETCH - 1.0) / TIME;
    const ROOT: f64 = 1.732_050_8;
    let held = [(0, 0.0), (1, 0.0), (1, 2.0 * H)];
    for mut strip in plates(plastic(), 2, |[x, _]| [RATE * x, 0.0], &held) {
        let momentum = |strip: &dyn Solver| strip.bodies()[0].totals().momentum[0];
        strip.run_until(0.5 * TIME).unwrap();
        let before = momentum(&*strip);
        strip.run_until(TIME).unwrap();
        let thickness = strip.bodies()[0].state_names().iter().position(|name| name == "thickness").unwrap();
        let seen = look(&*strip, |p| (p.position[0], p.stress, p.state[thickness]));
        let volume = ROOT * YIELD / (3.0 * moduli().bulk);
        for (_, stress, thickness) in seen.iter().filter(|s| s.0 < 0.1 * LENGTH) {
            let over = stress.map(|s| s / YIELD);
            assert!((over[0] - 2.0 / ROOT).abs() < 0.01, "{}: {over:?}", strip.method());
            assert!(
                (over[1] - 1.0 / ROOT).abs() < 0.02 && over[2].abs() < 1e-3,
                "{}: {over:?}",
                strip.method()
            );
            // Particles stretch uniformly within one per cent as long as none crosses cells.
            let thinner = thickness.ln() - volume + STRETCH.ln();
            assert!(thinner.abs() < 0.01 * STRETCH.ln(), "{}: {thickness}", strip.method());
        }
        let left = volume.exp() / (1.0 + 0.75 * (STRETCH - 1.0));
        let pull = 2.0 / ROOT * YIELD * 2.0 * H * left * 0.5 * TIME;
        let impulse = (before - momentum(&*strip)) / pull;
        // Linear shape functions: only the first cell pulls, and no particle left it.
        if !strip.method().contains("linear") {
            assert!((impulse - 1.0).abs() < 0.01, "{}: {impulse}", strip.method());
        }
        assert!(strip.account().energy_error().abs() < 1e-3, "{}", strip.method());
    }
}
