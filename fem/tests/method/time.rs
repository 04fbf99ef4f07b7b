//! Synchronous velocities and positions, damping, and hourglass energy of proper impacts.

use std::sync::Arc;

use fem::{Fem, MeshBody};
use impactite_geometry::ElementKind::Quad4;
use impactite_scene::{Boundary, Side};
use impactite_scene::{PlaneStrain, Solver};

use crate::common::{elastic, mesh};

/// Vertical throw of a block: y = v t + a t^2 / 2, v + a t, with steps that differ by a factor of up to 5.
#[test]
fn constant_acceleration_is_exact_with_steps_of_any_size() {
    let (start, a) = (3.0, -9.81);
    let mut fem = Fem::new(PlaneStrain);
    let block = MeshBody::new("block", mesh(Quad4, [0.0; 2], [1.0; 2], [2; 2]), elastic(1000.0, 1e5, 0.3));
    fem.add(block.moving(move |_| [0.0, start])).expect("a block");
    fem.set_body_force(Arc::new(move |_| [0.0, a]));
    let longest = fem.next_time_step();
    for n in 0..60 {
        fem.trial(longest * (0.6 + 0.4 * f64::sin(f64::from(n)))).expect("a step").finish().expect("its end");
        let (t, body) = (fem.time(), fem.body(0));
        let (v, y) = (start + a * t, start * t + 0.5 * a * t * t);
        for (node, rest) in body.nodes().iter().zip(&body.mesh().nodes) {
            assert!((node.position[1] - rest[1] - y).abs() < 1e-11, "{n}: {} for {y}", node.position[1]);
        }
        let totals = Solver::totals(&fem);
        assert!((body.velocity_now(0)[1] - v).abs() < 1e-11, "{n}: {:?} for {v}", body.velocity_now(0));
        assert!((totals.momentum_now()[1] - totals.mass * v).abs() < 1e-8, "{totals:?}");
        assert!((totals.kinetic_now() - 0.5 * totals.mass * v * v).abs() < 1e-7, "{totals:?}");
        for point in Solver::bodies(&fem)[0].points() {
            assert!((point.velocity[1] - v).abs() < 1e-11);
        }
    }
    assert!(fem.account().energy_error().abs() < 1e-12, "{:?}", fem.account());
}

/// Flat impact of a square on a wall: the remaining hourglass energy is a small part of the impact energy.
#[test]
fn an_impact_that_is_right_is_not_warned_of() {
    let mut fem = Fem::new(PlaneStrain);
    let square = mesh(Quad4, [0.0, 0.2], [0.2, 0.4], [8; 2]);
    let body = MeshBody::new("square", square, elastic(1000.0, 1e6, 0.3));
    fem.add(body.moving(|_| [0.0, -2.0])).expect("a square");
    fem.bound(Boundary::Wall { axis: 1, at: 0.0, side: Side::Above, velocity: 0.0 }).expect("a wall");
    fem.run_until(0.3).expect("a run");
    assert!(Solver::totals(&fem).momentum_now()[1] > 0.0, "it comes back");
    assert!(fem.warnings().is_empty(), "{:?}", fem.warnings());
}

/// Damped block that comes to rest on a wall with the stress of its weight; the energy removed by damping is booked.
#[test]
fn a_damped_block_rests_with_the_stress_of_its_weight() {
    let mut fem = Fem::new(PlaneStrain);
    let block = MeshBody::new("block", mesh(Quad4, [0.0; 2], [1.0; 2], [4; 2]), elastic(1000.0, 1e6, 0.0));
    fem.add(block).expect("a block");
    fem.bound(Boundary::Wall { axis: 1, at: 0.0, side: Side::Above, velocity: 0.0 }).expect("a wall");
    fem.set_body_force(Arc::new(|_| [0.0, -9.81]));
    fem.set_local_damping(0.7).expect("damping");
    assert!(fem.set_local_damping(1.0).is_err());
    fem.run_until(2.0).expect("a run");
    for point in Solver::bodies(&fem)[0].points() {
        let weight = -1000.0 * 9.81 * (1.0 - point.position[1]);
        assert!((point.stress[1] - weight).abs() < 0.02 * 9810.0, "{} for {weight}", point.stress[1]);
        assert!(point.velocity[1].abs() < 1e-6, "{:?}", point.velocity);
    }
    let account = fem.account();
    assert!(account.damping > 0.0 && account.energy_error().abs() < 0.01, "{account:?}");
}
