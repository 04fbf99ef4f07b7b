//! Long waves in reinforced concrete: in particles, in elements, across the border of both, and with lap splices.

#![allow(missing_docs)]

mod common;

use std::f64::consts::PI;

use common::{bars, boxed, elastic, half_period, seeds};
use coupling::{Conversion, Elements, LinearBond};
use fem::{Fem, MeshBody};
use impactite_geometry::Lattice;
use impactite_geometry::structured::box_mesh;
use mpm_core::{
    Aflip, BlockGrid, CpGimp, Flip, IntoKernels, Linear, Method, Mpm, Musl, PlaneStrain, QuadraticBSpline,
    SceneError, Usf, Usl,
};
use mpm_materials::LinearElastic;

const LENGTH: f64 = 1.0;
const HEIGHT: f64 = 0.1;
const H: f64 = 0.025;
/// Density, kg/m^3, and Young's modulus, Pa.
const CONCRETE: [f64; 2] = [2440.0, 34e9];
const STEEL: [f64; 2] = [7850.0, 200e9];
/// Ratio of steel to the concrete to which it is added.
const SHARE: f64 = 0.02;
const ROWS: u32 = 4;

type Kernels2 = mpm_core::Kernels<f64, 2>;

fn linear() -> Kernels2 {
    Method::new(Linear, Flip, Musl, PlaneStrain).into_kernels()
}

fn splines() -> Kernels2 {
    Method::new(QuadraticBSpline, Aflip::default(), Usl, PlaneStrain).into_kernels()
}

/// Discretisation of the concrete.
#[derive(Clone, Copy, Debug)]
enum Matrix {
    Particles,
    /// Elements of this number of cells; those between two positions, over the length, are particles.
    Elements(f64, [f64; 2]),
}

/// Bars over the full length.
fn through() -> Vec<[f64; 2]> {
    vec![[0.0, LENGTH]]
}

fn mode(x: [f64; 2]) -> [f64; 2] {
    [1e-2 * (PI * x[0] / LENGTH).cos(), 0.0]
}

fn concrete() -> LinearElastic<f64> {
    elastic(CONCRETE[0], CONCRETE[1], 0.0)
}

/// Concrete of elements of `size` cells; those between two positions are particles.
fn elements(size: f64, [from, to]: [f64; 2]) -> Elements<2> {
    let counts = [LENGTH, HEIGHT].map(|edge| (edge / (size * H)).round() as usize);
    let mesh = box_mesh(&boxed([0.0, 0.0], [LENGTH, HEIGHT]), counts).expect("mesh");
    let mut fem = Fem::new(PlaneStrain);
    fem.add(MeshBody::new("elements", mesh, concrete()).moving(mode)).expect("elements");
    let region = boxed([from * LENGTH - 1e-6, -1.0], [to * LENGTH + 1e-6, 1.0]);
    Elements::converting(fem, "concrete", Conversion::within(region)).expect("converting").0
}

/// Concrete with bars between two positions in each row, in the initial state.
fn strip(
    method: Kernels2,
    matrix: Matrix,
    along: &[[f64; 2]],
    elements_a_cell: f64,
    bond: Option<LinearBond>,
) -> Result<Mpm<2>, SceneError> {
    let lattice = Lattice::new([0.0; 2], H).expect("lattice");
    let mut mpm = Mpm::new(method, BlockGrid::new(lattice));
    match matrix {
        Matrix::Particles => {
            let block = seeds(&boxed([0.0, 0.0], [LENGTH, HEIGHT]), &lattice);
            mpm.add("concrete", concrete(), &block, mode)?;
        }
        Matrix::Elements(size, particles) => {
            mpm.add_client(elements(size, particles))?;
        }
    }
    let section = SHARE * HEIGHT / f64::from(ROWS);
    let at = |n: u32| HEIGHT * (f64::from(n) + 0.5) / f64::from(ROWS);
    let mut fem = Fem::new(PlaneStrain);
    for (k, [from, to]) in along.iter().enumerate() {
        let ends: Vec<[[f64; 2]; 2]> = (0..ROWS).map(|n| [[*from, at(n)], [*to, at(n)]]).collect();
        let mesh = bars(&ends, ((to - from) / H * elements_a_cell).round() as usize);
        let steel = MeshBody::new(format!("bars {k}"), mesh, elastic(STEEL[0], STEEL[1], 0.0));
        fem.add(steel.section(section).moving(mode))?;
    }
    let mut steel = Elements::within(fem, "concrete")?;
    if let Some(law) = bond {
        steel = steel.with_bond(law, 1.0)?;
    }
    mpm.add_client(steel)?;
    Ok(mpm)
}

/// Half period of the first mode, s, with the estimate `guess`. At most the part `most` of the energy may be lost in three periods.
fn sways(mut mpm: Mpm<2>, guess: f64, most: f64) -> f64 {
    let start = mpm.totals();
    let found = half_period(&mut mpm, LENGTH, 8.0 * guess);
    let now = mpm.totals();
    let lost = (now.kinetic + now.internal) / (start.kinetic + start.internal) - 1.0;
    println!("energy {:+.2} %", 100.0 * lost);
    assert!(lost.abs() < most, "energy {lost:+.4}");
    assert!((now.momentum[0] - start.momentum[0]).abs() < 1e-12 * start.momentum_scale);
    found
}

/// Density and modulus with this number of bars in each row.
fn both(bars: f64) -> [f64; 2] {
    [0, 1].map(|k| CONCRETE[k] + bars * SHARE * STEEL[k])
}

fn speed(bars: f64) -> f64 {
    let [density, modulus] = both(bars);
    (modulus / density).sqrt()
}

/// Speed of long waves, over that of the combined stiffness and mass.
fn long_waves(method: Kernels2, matrix: Matrix, elements_a_cell: f64) -> f64 {
    let mpm = strip(method, matrix, &through(), elements_a_cell, None).expect("scene");
    let expected = LENGTH / speed(1.0);
    // Splines lose energy at a joint of particles and elements as large as cells: 6.3 %.
    let most = if matches!(matrix, Matrix::Particles) { 0.03 } else { 0.08 };
    expected / sways(mpm, expected, most)
}

#[test]
fn long_waves_of_reinforced_concrete_are_as_fast_as_both_together() {
    for elements_a_cell in [0.5, 1.0, 2.0] {
        let linear = long_waves(linear(), Matrix::Particles, elements_a_cell);
        let splines = long_waves(splines(), Matrix::Particles, elements_a_cell);
        let first = Method::new(CpGimp, Flip, Usf, PlaneStrain).compiled().into_kernels();
        let first = long_waves(first, Matrix::Particles, elements_a_cell);
        println!(
            "{elements_a_cell} elements a cell: {linear:.5} (linear, FLIP, MUSL), {splines:.5} (splines, AFLIP, USL), {first:.5} (cpGIMP, \
             FLIP, USF)"
        );
        for speed in [linear, splines, first] {
            assert!((speed - 1.0).abs() < 5e-3, "{elements_a_cell} elements a cell: {speed}");
        }
    }
}

/// Bars through elements, through particles, and across their border.
#[test]
fn bars_cross_the_border_of_particles_and_elements() {
    let nowhere = [5.0, 6.0];
    for (name, method) in [("linear, FLIP, MUSL", linear()), ("splines, AFLIP, USL", splines())] {
        for size in [0.5, 1.0] {
            for particles in [nowhere, [0.5, 1.0], [0.25, 0.75], [0.0, 1.0]] {
                let found = long_waves(method.clone(), Matrix::Elements(size, particles), 1.0);
                println!("{name}, elements of {size} cells, particles at {particles:?}: {found:.5}");
                assert!((found - 1.0).abs() < 5e-3, "{name}, {size} cells, {particles:?}: {found}");
            }
        }
    }
}

/// Lap splices of bars with bond: first mode of a rod of three pieces, sin inside and cos outside, with continuous forces and velocities.
#[test]
fn laps_carry_on_what_bars_hold() {
    let bond = LinearBond::new(1e13).expect("bond");
    for half_lap in [0.1, 0.2] {
        let along = [[0.0, 0.5 * LENGTH + half_lap], [0.5 * LENGTH - half_lap, LENGTH]];
        let off = |w: f64| {
            let [once, twice] = [1.0, 2.0].map(|n| (both(n)[1] * w / speed(n), w / speed(n)));
            twice.0 / (twice.1 * half_lap).tan() - once.0 * (once.1 * (0.5 * LENGTH - half_lap)).tan()
        };
        let (mut low, mut high) = (0.8 * PI * speed(1.0) / LENGTH, 1.2 * PI * speed(1.0) / LENGTH);
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            (low, high) = if off(middle) > 0.0 { (middle, high) } else { (low, middle) };
        }
        let expected = PI / low;
        let (whole, apart) = (LENGTH / speed(1.0), LENGTH / speed(0.0));
        for matrix in [Matrix::Particles, Matrix::Elements(1.0, [0.5, 1.0])] {
            let mpm = strip(splines(), matrix, &along, 1.0, Some(bond)).expect("scene");
            let found = sways(mpm, expected, 0.08);
            println!(
                "lap {:.1} m, {matrix:?}: {:.4} of the period (bars all along {:.4}, concrete alone {:.4})",
                2.0 * half_lap,
                found / expected,
                whole / expected,
                apart / expected
            );
            assert!((found / expected - 1.0).abs() < 3e-3, "{found} of {expected} s");
        }
    }
}

/// Concrete, half particles and half elements: a standing wave has its largest stress at the joint. With border nodes alone on the grid it
/// lost a fifth of its energy in two periods.
#[test]
fn a_joint_keeps_the_energy_of_a_standing_wave() {
    let worst = [("linear", linear()), ("splines", splines())].map(|(name, method)| {
        [0.5, 1.0, 2.0].map(|size| {
            let mut worst = 0.0f64;
            // Without quarters of a cell, at which particles at rest across the edge of a bin lose 1e-8 of momentum to rounding.
            for shift in [0.0, 0.3, 0.5, 0.7] {
                let lattice = Lattice::new([shift * H; 2], H).expect("lattice");
                let mut mpm = Mpm::new(method.clone(), BlockGrid::new(lattice));
                mpm.add_client(elements(size, [0.5, 1.0])).expect("client");
                let start = mpm.totals();
                mpm.run_until(4.0 * LENGTH / speed(0.0)).expect("two periods");
                let now = mpm.totals();
                let lost = (now.kinetic + now.internal) / (start.kinetic + start.internal) - 1.0;
                println!(
                    "{name}, elements of {size} cells, grid {shift} cells aside: energy {:+.2} %",
                    100.0 * lost
                );
                worst = worst.max(lost.abs());
                assert!((now.momentum[0] - start.momentum[0]).abs() < 1e-11 * start.momentum_scale);
            }
            worst
        })
    });
    // Wide elements are tied at the border alone, and the strain of particles there is one-sided.
    for [half, one, two] in worst {
        assert!(half < 0.02 && one < 0.06 && two < 0.17, "{worst:?}");
    }
}

#[test]
fn elements_that_are_too_wide_for_bars_are_refused() {
    let made = strip(splines(), Matrix::Elements(2.0, [0.5, 1.0]), &through(), 1.0, None);
    let told = made.expect("scene").step().expect_err("bars miss the nodes of elements of two cells");
    assert!(told.to_string().contains("finer mesh"), "{told}");
}
