//! Bodies of finite elements.

use std::sync::Arc;

use coupling::ElementsInLiquid;
use fem::{Fem, MeshBody};
use flow::{Flow, FlowOptions, Fluid, RigidBody, Wall};
use impactite_geometry::{Ball, Cuboid, ElementMesh, Lattice, structured::box_mesh};
use impactite_scene::{
    Boundary, Embedding, FullSpace, PlaneStrain, Side, Solver, TimeControl, Watch, solver_conforms,
};
use mpm_materials::{LinearElastic, Moduli, NeoHookean};

use super::{
    WATER, block, centre, conserves_momentum, drift, gravity, oscillates, pool, target, thrown_at,
    under_water,
};

/// Mesh of a box with elements of about this edge.
fn mesh<const D: usize>(of: &Cuboid<D>, edge: f64) -> ElementMesh<D> {
    let bounds = impactite_geometry::Shape::bounds(of);
    let counts = std::array::from_fn(|d| ((bounds.max[d] - bounds.min[d]) / edge).round() as usize);
    box_mesh(of, counts).unwrap()
}

/// Layer of this density under water.
fn layer([density, modulus]: [f64; 2], off: f64) -> Flow<2> {
    let law = LinearElastic::new(density, Moduli::young_poisson(modulus, 0.0).unwrap()).unwrap();
    let mut elements = Fem::new(PlaneStrain);
    let shape = Cuboid::new([0.0; 2], [0.4, 0.2]).unwrap();
    elements.add(MeshBody::new("layer", mesh(&shape, 0.025), law)).unwrap();
    for (axis, at, side) in [(1, 0.0, Side::Above), (0, 0.0, Side::Above), (0, 0.4, Side::Below)] {
        elements.bound(Boundary::Symmetry { axis, at, side }).unwrap();
    }
    elements.set_body_force(Arc::new(|_| gravity()));
    under_water(ElementsInLiquid::new(elements), off)
}

/// The mass of the water is up to ten times that of the layer.
#[test]
fn a_layer_under_water_oscillates_as_a_bar_with_a_mass_at_its_end() {
    for (density, off, allowed) in
        [(2000.0, 0.0, 0.05), (500.0, 0.0, 0.06), (500.0, 0.4, 0.05), (200.0, 0.0, 0.07), (200.0, 0.4, 0.1)]
    {
        let law = [density, 2e6];
        println!("{off} cells: {}", oscillates(layer(law, off), 17, law, allowed));
    }
}

/// Block of neo-Hookean rubber of this density and modulus, 0.3 m, `lifted` above its draught, of elements of about this edge, m. `cells` of the grid
/// are on an edge of the block.
fn floating<E: Embedding<D>, const D: usize>(
    space: E,
    cells: usize,
    [density, modulus]: [f64; 2],
    lifted: f64,
    edge: f64,
) -> Flow<D> {
    let law = NeoHookean::new(density, Moduli::young_poisson(modulus, 0.3).unwrap()).unwrap();
    let block = block(density, 0.3, lifted);
    let mut elements = Fem::new(space);
    elements.add(MeshBody::new("block", mesh(&block, edge), law)).unwrap();
    elements.set_body_force(Arc::new(|_| gravity()));
    let mut flow = pool(0.3 / cells as f64, block);
    flow.add_deformable(ElementsInLiquid::new(elements)).unwrap();
    flow
}

#[test]
fn a_block_of_rubber_floats_at_its_draught() {
    let mut flow = floating(PlaneStrain, 12, [600.0, 1e6], 0.0, 0.06);
    let [mean, largest, _] = drift(&mut flow, 2.0);
    println!("mean {mean:.5} m, largest {largest:.5} m, {} steps", flow.clock().steps);
    assert!(mean.abs() < 0.002 && largest < 0.006);
}

/// Waves of a fine mesh, which the cells of the liquid do not resolve, gain no energy. The vibration after the start has some 0.1 J.
#[test]
fn meshes_finer_than_the_cells_come_to_rest() {
    for (edge, step) in
        [(0.025, None), (0.02, None), (0.02, Some(9e-4)), (0.0125, None), (0.0125, Some(4e-4))]
    {
        let mut flow = floating(PlaneStrain, 12, [600.0, 1e6], 0.0, edge);
        if let Some(step) = step {
            flow.set_time_control(TimeControl::Fixed(step)).unwrap();
        }
        let (start, mut kinetic) = (centre(&flow)[1], 0.0f64);
        while flow.time() < 0.35 {
            flow.step_at_most(1.0).unwrap();
            if flow.time() > 0.25 {
                kinetic = kinetic.max(flow.bodies()[1].totals().kinetic);
            }
        }
        let sunk = centre(&flow)[1] - start;
        println!("{edge} m, {step:?} s: {kinetic:.2e} J, {sunk:.5} m");
        assert!(kinetic < 0.02 && sunk > -0.0035, "{edge} m, {step:?} s: {kinetic:.2e} J, {sunk} m");
    }
}

#[test]
fn a_stiff_block_heaves_as_a_rigid_one() {
    let heights = |flow: &mut Flow<2>, height: &dyn Fn(&Flow<2>) -> f64| {
        let mut list = Vec::new();
        for n in 1..=40 {
            flow.run_until(0.025 * f64::from(n)).unwrap();
            list.push(height(flow));
        }
        list
    };
    let mut soft = floating(PlaneStrain, 12, [500.0, 1e8], 0.05, 0.06);
    let own = heights(&mut soft, &|flow| centre(flow)[1]);
    let block = block::<2>(500.0, 0.3, 0.05);
    let mut flow = pool(0.025, block);
    flow.add_rigid("box", RigidBody::new(block, 500.0).unwrap().without_turning()).unwrap();
    let rigid = heights(&mut flow, &|flow| flow.rigid_centre(0).unwrap()[1]);
    let worst = own.iter().zip(&rigid).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    println!("worst {worst:.5} m of 0.05 m; {:.4?} {:.4?}", own, rigid);
    assert!(worst < 0.005);
}

/// Target of elements of two cells.
fn thrown<E: Embedding<D>, const D: usize>(space: E, h: f64) -> Flow<D> {
    let law = NeoHookean::new(800.0, Moduli::young_poisson(1e6, 0.3).unwrap()).unwrap();
    let mut elements = Fem::new(space);
    elements.add(MeshBody::new("block", mesh(&target(), 2.0 * h), law)).unwrap();
    thrown_at(ElementsInLiquid::new(elements), h)
}

#[test]
fn momentum_of_liquid_and_body_is_conserved() {
    conserves_momentum(thrown(PlaneStrain, 0.0125));
}

#[test]
fn a_block_of_rubber_floats_in_space() {
    let mut flow = floating(FullSpace, 5, [600.0, 1e6], 0.0, 0.06);
    let off = drift(&mut flow, 0.15)[2];
    println!("off {off:.5} m, {} steps, {} iterations", flow.clock().steps, flow.coupling_iterations());
    assert!(off.abs() < 0.006);
}

#[test]
fn what_is_not_available_is_refused() {
    let law = || NeoHookean::new(800.0, Moduli::young_poisson(1e6, 0.3).unwrap()).unwrap();
    let options = || FlowOptions::new(Lattice::new([0.0; 2], 0.02).unwrap());
    let with = |thickness: f64| {
        let mut elements = Fem::new(PlaneStrain);
        let plate = mesh(&Cuboid::new([0.1, 0.0], [0.1 + thickness, 0.2]).unwrap(), 0.5 * thickness);
        elements.add(MeshBody::new("plate", plate, law())).unwrap();
        ElementsInLiquid::new(elements)
    };
    let thin = Flow::new(options()).add_deformable(with(0.015)).unwrap_err().to_string();
    assert!(thin.contains("thinner than the cells") && thin.contains("`plate`"), "{thin}");
    let mut flow = Flow::new(options());
    flow.add_deformable(with(0.04)).unwrap();
    let second = flow.add_deformable(with(0.04)).unwrap_err().to_string();
    assert!(second.contains("second solver"), "{second}");
    let rigid = RigidBody::new(Cuboid::new([0.3, 0.3], [0.4, 0.4]).unwrap(), 500.0).unwrap();
    let rigid = flow.add_rigid("box", rigid).unwrap_err().to_string();
    assert!(rigid.contains("beside deformable bodies"), "{rigid}");
    let mut flow = Flow::new(options().periodic(0, 20).unwrap());
    let period = flow.add_deformable(with(0.04)).unwrap_err().to_string();
    assert!(period.contains("periodic"), "{period}");
    // A prescribed solid that a body runs into stops the run.
    let mut elements = Fem::new(PlaneStrain);
    elements.set_watch(Watch::off());
    elements
        .add(
            MeshBody::new("block", mesh(&Cuboid::new([0.1, 0.0], [0.2, 0.1]).unwrap(), 0.02), law())
                .moving(|_| [5.0, 0.0]),
        )
        .unwrap();
    let mut flow = Flow::new(options());
    flow.add_deformable(ElementsInLiquid::new(elements)).unwrap();
    flow.add_wall(Wall::solid(Cuboid::new([0.3, -0.2], [0.5, 0.3]).unwrap())).unwrap();
    let drop = Ball::new([0.0, 0.05], 0.05).unwrap();
    flow.add_shape("water", Fluid::new(WATER).unwrap(), &drop, 2, |_| [0.0; 2]).unwrap();
    let stopped = flow.run_until(0.1).unwrap_err().to_string();
    assert!(stopped.contains("`block` in a wall"), "{stopped}");
}

solver_conforms! {
    // An impact of liquid loses energy.
    plane: || thrown(PlaneStrain, 0.0125), SolverTests::until(0.04).energy_within(0.3);
    space: || thrown(FullSpace, 0.025), SolverTests::until(0.04).energy_within(0.3);
}
