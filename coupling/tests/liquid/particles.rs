//! Bodies of particles.

use coupling::ParticlesInLiquid;
use flow::{Deformable, Flow};
use impactite_geometry::{Cuboid, Facets, Filling, Lattice, Shape, fill};
use impactite_scene::{Boundary, FullSpace, PlaneStrain, SceneError, Side, Solver, solver_conforms};
use mpm_core::{BlockGrid, IntoKernels, Method, Mpm, QuadraticBSpline, Usf};
use mpm_materials::{LinearElastic, Moduli, NeoHookean};

use super::{block, conserves_momentum, drift, gravity, oscillates, pool, target, thrown_at, under_water};

/// Body of particles with its surface.
fn body<const D: usize>(
    method: impl IntoKernels<f64, D>,
    h: f64,
    name: &str,
    law: impl mpm_materials::IntoMaterial<f64>,
    shape: &impl Shape<D>,
) -> (Mpm<D>, [Facets<D>; 1]) {
    let lattice = Lattice::new([0.0; D], h).unwrap();
    let mut mpm = Mpm::new(method, BlockGrid::new(lattice));
    let seeds = fill(shape, &lattice, 2, &Filling::new()).unwrap();
    mpm.add(name, law, &seeds, |_| [0.0; D]).unwrap();
    (mpm, [Facets::of(shape, 0.5 * h).unwrap()])
}

/// Layer of this density under water.
fn layer(method: impl IntoKernels<f64, 2>, [density, modulus]: [f64; 2]) -> Flow<2> {
    let law = LinearElastic::new(density, Moduli::young_poisson(modulus, 0.0).unwrap()).unwrap();
    let shape = Cuboid::new([0.0; 2], [0.4, 0.2]).unwrap();
    let (mut mpm, surface) = body(method, 0.025, "layer", law, &shape);
    for (axis, at, side) in [(1, 0.0, Side::Above), (0, 0.0, Side::Above), (0, 0.4, Side::Below)] {
        mpm.bound(Boundary::Symmetry { axis, at, side }).unwrap();
    }
    mpm.set_body_force(|_| gravity());
    under_water(ParticlesInLiquid::new(mpm, &surface).unwrap(), 0.0)
}

#[test]
fn a_layer_under_water_oscillates_as_a_bar_with_a_mass_at_its_end() {
    for (density, allowed) in [(2000.0, 0.06), (500.0, 0.08)] {
        let law = [density, 2e6];
        println!("{}", oscillates(layer(Method::machine_parts(PlaneStrain), law), 33, law, allowed));
    }
}

/// Block of neo-Hookean rubber of 0.6 of the density of water, `cells` wide and two thirds of that high: it does not capsize.
fn floating<const D: usize>(method: impl IntoKernels<f64, D>, cells: usize) -> Flow<D> {
    let (h, density) = (0.3 / cells as f64, 600.0);
    let block = block(density, 0.2, 0.0);
    let law = NeoHookean::new(density, Moduli::young_poisson(1e6, 0.3).unwrap()).unwrap();
    let (mut mpm, surface) = body(method, h, "block", law, &block);
    mpm.set_body_force(|_| gravity());
    let mut flow = pool(h, block);
    flow.add_deformable(ParticlesInLiquid::new(mpm, &surface).unwrap()).unwrap();
    flow
}

#[test]
fn a_block_of_rubber_floats_at_its_draught() {
    let mut flow = floating(Method::machine_parts(PlaneStrain), 12);
    let [mean, largest, _] = drift(&mut flow, 1.2);
    let kinetic = flow.bodies()[1].totals().kinetic;
    println!("mean {mean:.5} m, largest {largest:.5} m, {kinetic:.2e} J, {} steps", flow.clock().steps);
    assert!(mean.abs() < 0.002 && largest < 0.006 && kinetic < 0.02);
    // The energy of the body is the work on it.
    let solver = flow.deformable().unwrap().solver();
    let (totals, given) = (solver.totals(), solver.exchange());
    let off = totals.kinetic + totals.internal - given.work;
    assert!(off.abs() < 0.01, "{off} J");
}

#[test]
fn a_block_of_rubber_floats_in_space() {
    let mut flow = floating(Method::machine_parts(FullSpace), 5);
    let off = drift(&mut flow, 0.15)[2];
    println!("off {off:.5} m, {} steps, {} iterations", flow.clock().steps, flow.coupling_iterations());
    assert!(off.abs() < 0.006);
}

/// Target of particles.
fn thrown<const D: usize>(method: impl IntoKernels<f64, D>, h: f64) -> Flow<D> {
    let law = NeoHookean::new(800.0, Moduli::young_poisson(1e6, 0.3).unwrap()).unwrap();
    let (mpm, surface) = body(method, h, "block", law, &target());
    thrown_at(ParticlesInLiquid::new(mpm, &surface).unwrap(), h)
}

#[test]
fn momentum_of_liquid_and_body_is_conserved() {
    conserves_momentum(thrown(Method::machine_parts(PlaneStrain), 0.0125));
}

#[test]
fn the_surface_turns_with_its_body() {
    let h = 0.02;
    let spin = 3.0;
    let block = Cuboid::new([-0.1, -0.06], [0.1, 0.06]).unwrap();
    let lattice = Lattice::new([0.0; 2], h).unwrap();
    let law = NeoHookean::new(1000.0, Moduli::young_poisson(1e7, 0.3).unwrap()).unwrap();
    let mut mpm = Mpm::new(Method::machine_parts(PlaneStrain), BlockGrid::new(lattice));
    let seeds = fill(&block, &lattice, 2, &Filling::new()).unwrap();
    mpm.add("block", law, &seeds, |x| [-spin * x[1], spin * x[0]]).unwrap();
    let surface = Facets::of(&block, 0.5 * h).unwrap();
    let mut all = ParticlesInLiquid::new(mpm, std::slice::from_ref(&surface)).unwrap();
    for _ in 0..100 {
        all.run_for(0.01, &[]).unwrap();
    }
    // As its particles, by the rotation that fits their places.
    let (mut sin, mut cos, mut worst) = (0.0, 0.0, 0.0f64);
    let mut number = 0;
    all.mpm().bodies()[0].for_each(&mut |p| {
        let x = seeds.positions[p.number];
        cos += x[0] * p.position[0] + x[1] * p.position[1];
        sin += x[0] * p.position[1] - x[1] * p.position[0];
        number += 1;
    });
    let angle = f64::atan2(sin, cos);
    let (sin, cos) = angle.sin_cos();
    for (n, x) in surface.nodes.iter().enumerate() {
        let now = all.node(0, n as u32).0;
        let due = [cos * x[0] - sin * x[1], sin * x[0] + cos * x[1]];
        worst = worst.max((now[0] - due[0]).hypot(now[1] - due[1]));
    }
    println!("turned by {angle:.4} rad, {number} particles");
    println!("worst {worst:.5} m");
    assert!(worst < 0.1 * h, "{worst} m");
}

#[test]
fn what_is_not_available_is_refused() {
    let law = || NeoHookean::new(800.0, Moduli::young_poisson(1e6, 0.3).unwrap()).unwrap();
    let block = Cuboid::new([0.0; 2], [0.1; 2]).unwrap();
    let why = |made: Result<ParticlesInLiquid<2>, SceneError>| made.err().unwrap().to_string();
    let (mpm, surface) = body(Method::contact_at_rest(PlaneStrain), 0.01, "block", law(), &block);
    let ahead = why(ParticlesInLiquid::new(mpm, &surface));
    assert!(ahead.contains("plans a step"), "{ahead}");
    let (mpm, surface) = body(Method::large_elastic(PlaneStrain), 0.01, "block", law(), &block);
    let total = why(ParticlesInLiquid::new(mpm, &surface));
    assert!(total.contains("total Lagrangian"), "{total}");
    let usf = Method::new(QuadraticBSpline, mpm_core::Flip, Usf, PlaneStrain).compiled();
    let (mpm, surface) = body(usf, 0.01, "block", law(), &block);
    let usf = why(ParticlesInLiquid::new(mpm, &surface));
    assert!(usf.contains("USF"), "{usf}");
    let (mpm, _) = body(Method::machine_parts(PlaneStrain), 0.01, "block", law(), &block);
    let none = why(ParticlesInLiquid::new(mpm, &[]));
    assert!(none.contains("0 surfaces for 1 bodies"), "{none}");
    let (mpm, _) = body(Method::machine_parts(PlaneStrain), 0.01, "block", law(), &block);
    let away = Facets::of(&Cuboid::new([0.2; 2], [0.3; 2]).unwrap(), 0.005).unwrap();
    let away = why(ParticlesInLiquid::new(mpm, &[away]));
    assert!(away.contains("`block`") && away.contains("no particles"), "{away}");
    let (mpm, _) = body(Method::machine_parts(PlaneStrain), 0.01, "block", law(), &block);
    let coarse = why(ParticlesInLiquid::new(mpm, &[Facets::of(&block, 0.05).unwrap()]));
    assert!(coarse.contains("node to node"), "{coarse}");
}

solver_conforms! {
    // An impact of liquid loses energy.
    plane: || thrown(Method::machine_parts(PlaneStrain), 0.0125), SolverTests::until(0.03).energy_within(0.3);
    space: || thrown(Method::machine_parts(FullSpace), 0.03), SolverTests::until(0.024).energy_within(0.3);
}
