//! Deformable bodies of particles in an incompressible liquid, against closed-form solutions.

use std::f64::consts::{FRAC_PI_2, PI};

use coupling::ParticlesInLiquid;
use flow::{Deformable, Flow, FlowOptions, Fluid, Wall};
use impactite_geometry::{Ball, Compose, Cuboid, Facets, Filling, Lattice, Shape, fill};
use impactite_scene::{Boundary, FullSpace, PlaneStrain, SceneError, Side, Solver, solver_conforms};
use mpm_core::{BlockGrid, IntoKernels, Method, Mpm};
use mpm_materials::{LinearElastic, Moduli, NeoHookean};

const GRAVITY: f64 = 9.81;
const WATER: f64 = 1000.0;

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

/// Mean position of some nodes of the surface along an axis, m.
fn mean<const D: usize>(flow: &Flow<D>, nodes: &[u32], axis: usize) -> f64 {
    let all = flow.deformable().unwrap();
    nodes.iter().map(|n| all.node(0, *n).0[axis]).sum::<f64>() / nodes.len() as f64
}

/// Layer of this density on the floor of a tank 0.4 m wide, 0.2 m thick, under 0.4 m of water.
fn layer(method: impl IntoKernels<f64, 2>, density: f64, modulus: f64) -> Flow<2> {
    let h = 0.4 / 16.0;
    let law = LinearElastic::new(density, Moduli::young_poisson(modulus, 0.0).unwrap()).unwrap();
    let (mut mpm, surface) = body(method, h, "layer", law, &Cuboid::new([0.0; 2], [0.4, 0.2]).unwrap());
    for (axis, at, side) in [(1, 0.0, Side::Above), (0, 0.0, Side::Above), (0, 0.4, Side::Below)] {
        mpm.bound(Boundary::Symmetry { axis, at, side }).unwrap();
    }
    mpm.set_body_force(|_| [0.0, -GRAVITY]);
    let mut flow = Flow::new(FlowOptions::new(Lattice::new([0.0; 2], h).unwrap()));
    flow.add_wall(Wall::container(Cuboid::new([0.0; 2], [0.4, 1.0]).unwrap())).unwrap();
    flow.add_deformable(ParticlesInLiquid::new(mpm, &surface).unwrap()).unwrap();
    let water = Cuboid::new([0.0, 0.2], [0.4, 0.6]).unwrap();
    flow.add_shape("water", Fluid::new(WATER).unwrap(), &water, 2, |_| [0.0; 2]).unwrap();
    flow.set_body_force(|_| [0.0, -GRAVITY]);
    flow
}

/// Height of the top of the layer after `t` seconds, m, and its first period, s: modes of a bar with a mass at its end under a weight that acts
/// at once, x tan x = mass of the bar over that at its end.
fn exact(density: f64, modulus: f64, t: f64) -> (f64, f64) {
    let (length, water) = (0.2, 0.4 * WATER);
    let ratio = density * length / water;
    let (mut sum, mut period) = (length, 0.0);
    for n in 0..200 {
        let (mut low, mut high) = (f64::from(n) * PI, f64::from(n) * PI + FRAC_PI_2);
        for _ in 0..100 {
            let x = 0.5 * (low + high);
            if x * x.tan() < ratio { low = x } else { high = x }
        }
        let (sin, cos) = low.sin_cos();
        let mass = 0.5 * density * length * (1.0 - sin * cos / low) + water * sin * sin;
        let load = GRAVITY * (density * length * (1.0 - cos) / low + water * sin);
        let omega = low * (modulus / density).sqrt() / length;
        sum -= sin * load / (mass * omega * omega) * (1.0 - (omega * t).cos());
        if n == 0 {
            period = 2.0 * PI / omega;
        }
    }
    (sum, period)
}

#[test]
fn a_layer_under_water_oscillates_as_a_bar_with_a_mass_at_its_end() {
    let modulus = 2e6;
    let check = |density: f64, mut flow: Flow<2>, allowed: f64| {
        let all = flow.deformable().unwrap();
        let nodes = all.surface().into_iter().map(|f| f.nodes[0]);
        let top: Vec<u32> = nodes.filter(|n| all.node(0, *n).0[1] > 0.2 - 1e-9).collect();
        assert_eq!(top.len(), 33);
        let period = exact(density, modulus, 0.0).1;
        let amplitude = 0.2 - exact(density, modulus, 0.5 * period).0;
        let mut worst = 0.0f64;
        while flow.time() < 4.0 * period {
            flow.step_at_most(1.0).unwrap();
            let off = mean(&flow, &top, 1) - exact(density, modulus, flow.time()).0;
            worst = worst.max((off / amplitude).abs());
        }
        let steps = flow.clock().steps;
        println!("{density} kg/m^3: {worst:.4} of the amplitude, {steps} steps");
        assert!(worst < allowed, "{density} kg/m^3: {worst}");
        assert!(flow.warnings().is_empty(), "{:?}", flow.warnings());
    };
    check(2000.0, layer(Method::machine_parts(PlaneStrain), 2000.0, modulus), 0.06);
    check(500.0, layer(Method::machine_parts(PlaneStrain), 500.0, modulus), 0.08);
}

/// Block of neo-Hookean rubber of this density, `cells` wide and two thirds of that high, in a pool of 0.9 m by 0.5 m, at its draught: it does not capsize.
fn floating<const D: usize>(
    method: impl IntoKernels<f64, D>,
    cells: usize,
    density: f64,
    modulus: f64,
) -> Flow<D> {
    let h = 0.3 / cells as f64;
    let (mut low, mut high, mut water) = ([0.3; D], [0.6; D], [0.9; D]);
    low[1] = 0.5 - 0.2 * density / WATER;
    high[1] = low[1] + 0.2;
    water[1] = 0.5;
    let block = Cuboid::new(low, high).unwrap();
    let law = NeoHookean::new(density, Moduli::young_poisson(modulus, 0.3).unwrap()).unwrap();
    let (mut mpm, surface) = body(method, h, "block", law, &block);
    let mut gravity = [0.0; D];
    gravity[1] = -GRAVITY;
    mpm.set_body_force(move |_| gravity);
    let mut flow = Flow::new(FlowOptions::new(Lattice::new([0.0; D], h).unwrap()));
    let mut tank = [0.9; D];
    tank[1] = 2.0;
    flow.add_wall(Wall::container(Cuboid::new([0.0; D], tank).unwrap())).unwrap();
    flow.add_deformable(ParticlesInLiquid::new(mpm, &surface).unwrap()).unwrap();
    let water = Cuboid::new([0.0; D], water).unwrap().minus(block);
    flow.add_shape("water", Fluid::new(WATER).unwrap(), &water, 2, |_| [0.0; D]).unwrap();
    flow.set_body_force(move |_| gravity);
    flow
}

/// Centre of mass of the body, m.
fn centre<const D: usize>(flow: &Flow<D>) -> [f64; 3] {
    let (mut sum, mut mass) = ([0.0; 3], 0.0);
    flow.bodies()[1].for_each(&mut |p| {
        mass += p.mass;
        (0..3).for_each(|d| sum[d] += p.mass * p.position[d]);
    });
    sum.map(|x| x / mass)
}

#[test]
fn a_block_of_rubber_floats_at_its_draught() {
    let mut flow = floating(Method::machine_parts(PlaneStrain), 12, 600.0, 1e6);
    let start = centre(&flow)[1];
    let (mut sum, mut count, mut largest) = (0.0, 0, 0.0f64);
    while flow.time() < 1.2 {
        flow.step_at_most(1.0).unwrap();
        (sum, count) = (sum + centre(&flow)[1] - start, count + 1);
        largest = largest.max((centre(&flow)[1] - start).abs());
    }
    let kinetic = flow.bodies()[1].totals().kinetic;
    let mean = sum / f64::from(count);
    println!("mean {mean:.5} m, largest {largest:.5} m, {kinetic:.2e} J, {} steps", flow.clock().steps);
    assert!(mean.abs() < 0.002 && largest < 0.006 && kinetic < 0.02);
    // The energy of the body is the work on it.
    let (totals, given) = {
        let solver = flow.deformable().unwrap().solver();
        (solver.totals(), solver.exchange())
    };
    let off = totals.kinetic + totals.internal - given.work;
    assert!(off.abs() < 0.01, "{off} J");
}

#[test]
fn a_block_of_rubber_floats_in_space() {
    let mut flow = floating(Method::machine_parts(FullSpace), 5, 600.0, 1e6);
    let start = centre(&flow)[1];
    flow.run_until(0.15).unwrap();
    let off = centre(&flow)[1] - start;
    println!("off {off:.5} m, {} steps, {} iterations", flow.clock().steps, flow.coupling_iterations());
    assert!(off.abs() < 0.006);
}

/// Drop of 0.1 m that flies at 1 m/s into a block, without weight. `h` is the width of a cell.
fn thrown<const D: usize>(method: impl IntoKernels<f64, D>, h: f64) -> Flow<D> {
    let law = NeoHookean::new(800.0, Moduli::young_poisson(1e6, 0.3).unwrap()).unwrap();
    let (mut low, mut high) = ([-0.1; D], [0.1; D]);
    (low[0], high[0], high[1]) = (0.15, 0.3, 0.14);
    let (mpm, surface) = body(method, h, "block", law, &Cuboid::new(low, high).unwrap());
    let mut flow = Flow::new(FlowOptions::new(Lattice::new([0.0; D], h).unwrap()));
    flow.add_deformable(ParticlesInLiquid::new(mpm, &surface).unwrap()).unwrap();
    let (mut centre, mut velocity) = ([0.0; D], [0.0; D]);
    (centre[0], velocity[0], velocity[1]) = (0.03, 1.0, 0.3);
    let drop = Ball::new(centre, 0.1).unwrap();
    flow.add_shape("water", Fluid::new(WATER).unwrap(), &drop, 2, |_| velocity).unwrap();
    flow
}

#[test]
fn momentum_and_angular_momentum_of_liquid_and_body_are_conserved() {
    let mut flow = thrown(Method::machine_parts(PlaneStrain), 0.0125);
    let start = flow.totals().momentum;
    flow.run_until(0.045).unwrap();
    let (end, given) = (flow.totals().momentum, Solver::exchange(&flow));
    assert!(flow.bodies()[1].totals().momentum[0] > 0.15 * start[0], "the drop met the block");
    for d in 0..2 {
        let off = end[d] - start[d] - given.impulse[d] - given.load[d] - given.dropped[d];
        assert!(off.abs() < 1e-11 * start[0], "axis {d}: {off}");
        println!("axis {d}: dropped {:.2e} of {:.2e}", given.dropped[d], start[0]);
        assert!(given.dropped[d].abs() < 5e-3 * start[0], "axis {d}: {}", given.dropped[d]);
        assert!(given.impulse[d].abs() < 1e-11 * start[0], "axis {d}: {}", given.impulse[d]);
    }
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
