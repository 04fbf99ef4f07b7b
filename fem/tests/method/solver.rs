//! Solver conformance of finite elements.

use fem::{Criterion, Erosion, Fem, MeshBody, Technology};
use impactite_geometry::ElementKind::{Bar2, Hexa8, Quad4, Tetra4, Triangle3};
use impactite_scene::{
    Axisymmetric, Boundary, FullSpace, Line, PlaneStrain, Side, TimeControl, solver_conforms,
};
use mpm_materials::library;

use crate::common::{distorted, elastic, flowing, mesh};

const H: f64 = 1.0e-3;

fn wall<const D: usize>(fem: &mut Fem<D>, axis: usize) {
    fem.bound(Boundary::Wall { axis, at: 0.0, side: Side::Above, velocity: 0.0 }).unwrap();
}

/// Spinning copper block that hits a rough wall under a body force.
fn plane() -> Fem<2> {
    let mut fem = Fem::new(PlaneStrain);
    let block = distorted(mesh(Quad4, [0.0, 0.2 * H], [6.0 * H, 4.2 * H], [6, 4]), 0.2, H);
    let body = MeshBody::new("block", block, library::copper_taylor::<f64>());
    fem.add(body.moving(|x| [20.0 + 2e4 * x[1], -80.0 - 2e4 * x[0]])).unwrap();
    let floor =
        Boundary::FrictionWall { axis: 1, at: 0.0, side: Side::Above, velocity: [0.0; 2], friction: 0.3 };
    fem.bound(floor).unwrap();
    fem.set_body_force(std::sync::Arc::new(|t| [0.0, -1e4 * (1e5 * t).cos()]));
    fem
}

/// Two bodies of bricks, one of them subcycled by four.
fn bricks() -> Fem<3> {
    let mut fem = Fem::new(FullSpace);
    let fine = mesh(Hexa8, [0.0; 3], [H; 3], [4; 3]);
    let coarse = distorted(mesh(Hexa8, [2.0 * H, 0.0, 0.0], [8.0 * H, 6.0 * H, 6.0 * H], [5; 3]), 0.1, H);
    let steel = || flowing(7850.0, 206e9, 0.3, 400e6);
    fem.add(MeshBody::new("fine", fine, steel()).moving(|x| [x[1] * 1e4, -x[0] * 1e4, -30.0])).unwrap();
    fem.add(MeshBody::new("coarse", coarse, steel()).moving(|_| [0.0, 0.0, -60.0])).unwrap();
    wall(&mut fem, 2);
    fem.set_subcycling(4).unwrap();
    fem
}

/// Bricks with full integration and erosion.
fn full() -> Fem<3> {
    let mut fem = Fem::new(FullSpace);
    let bar = mesh(Hexa8, [0.0; 3], [2.0 * H, 2.0 * H, 8.0 * H], [2, 2, 8]);
    let erosion = Erosion::plastic_strain(0.25).or(Criterion::Step(1e-9));
    let body = MeshBody::new("bar", bar, flowing(8930.0, 117e9, 0.35, 200e6));
    fem.add(body.with(Hexa8, Technology::MeanDilatation).eroding(erosion).moving(|_| [0.0, 0.0, -250.0]))
        .unwrap();
    wall(&mut fem, 2);
    fem
}

/// Tetrahedra.
fn tetrahedra() -> Fem<3> {
    let mut fem = Fem::new(FullSpace);
    let block = mesh(Tetra4, [0.0; 3], [2.0 * H, 2.0 * H, 5.0 * H], [2, 2, 5]);
    fem.add(MeshBody::new("bar", block, flowing(8930.0, 117e9, 0.35, 200e6)).moving(|_| [0.0, 0.0, -100.0]))
        .unwrap();
    wall(&mut fem, 2);
    fem
}

/// Axisymmetric bar of quadrilaterals and triangles.
fn round() -> Fem<2> {
    let mut fem = Fem::new(Axisymmetric);
    let mut bar = mesh(Quad4, [0.0; 2], [3.0 * H, 12.0 * H], [3, 12]);
    let nodes = bar.blocks[0].nodes.split_off(4 * 18);
    let cut = nodes.chunks_exact(4).flat_map(|n| [n[0], n[1], n[2], n[0], n[2], n[3]]).collect();
    let mut upper = bar.blocks[0].clone();
    (upper.kind, upper.nodes, upper.name) = (Triangle3, cut, "upper".into());
    bar.blocks.push(upper);
    fem.add(MeshBody::new("bar", bar, library::copper_taylor::<f64>()).moving(|_| [0.0, -120.0])).unwrap();
    fem.bound(Boundary::Symmetry { axis: 0, at: 0.0, side: Side::Above }).unwrap();
    wall(&mut fem, 1);
    fem
}

/// Bars on a line, pulled at an end.
fn bars() -> Fem<1> {
    let mut fem = Fem::new(Line);
    fem.add(
        MeshBody::new("rod", mesh(Bar2, [0.0], [30.0 * H], [30]), flowing(8930.0, 117e9, 0.35, 200e6))
            .section(1e-5),
    )
    .unwrap();
    fem.prescribe(0, "high x", std::sync::Arc::new(|t| [Some(20.0 * (2e5 * t).sin()), None, None])).unwrap();
    fem.bound(Boundary::Fixed { axis: 0, at: 0.0, side: Side::Above }).unwrap();
    fem
}

/// Body whose halves fly through each other in one step, which breaks the run.
fn torn() -> Fem<2> {
    let mut fem = Fem::new(PlaneStrain);
    let speed = |[x, _]: [f64; 2]| [if x < 2.5 * H { 4.0e3 } else { -4.0e3 }, 0.0];
    fem.add(
        MeshBody::new("block", mesh(Quad4, [0.0; 2], [5.0 * H; 2], [5; 2]), elastic(8930.0, 117e9, 0.35))
            .moving(speed),
    )
    .unwrap();
    fem.set_time_control(TimeControl::Fixed(0.4e-6)).unwrap();
    fem
}

solver_conforms! {
    one_point_in_the_plane: super::plane, SolverTests::until(2.0e-5).energy_within(0.01).breaking(1.0e-5, super::torn);
    one_point_in_space: super::bricks, SolverTests::until(4.0e-6).energy_within(0.01);
    full_integration: super::full, SolverTests::until(6.0e-6).energy_within(0.02);
    tetrahedra: super::tetrahedra, SolverTests::until(3.0e-6).energy_within(0.01);
    axisymmetric: super::round, SolverTests::until(1.0e-5).energy_within(0.01);
    bars: super::bars, SolverTests::until(1.5e-5).energy_within(0.01);
}
