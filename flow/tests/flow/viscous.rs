//! Viscous flow.

use flow::{Flow, FlowOptions, Fluid};
use impactite_geometry::{Ball, Lattice};
use impactite_scene::Solver;

use crate::gates::{first_order, poiseuille, staggered, taylor_green};

/// With the reflection the error is below that of the transfer and the stress; without it, it is of first order: 16, 8 % and so on.
#[test]
fn taylor_green_vortices_decay_at_their_rate() {
    let [coarse, fine] = [16, 32]
        .map(|cells| [taylor_green(staggered, cells).unwrap(), taylor_green(first_order, cells).unwrap()]);
    println!("16 cells: {coarse:.4?}, 32 cells: {fine:.4?}, with and without reflection");
    assert!(coarse[0].abs() < 0.02 && fine[0].abs() < 0.02, "{coarse:?} {fine:?}");
    assert!(fine[0].abs() < 0.5 * fine[1].abs());
    let order = (coarse[1] / fine[1]).log2();
    assert!((order - 1.0).abs() < 0.2, "order {order}");
}

#[test]
fn channel_flow_starts_as_it_should() {
    for (cells, viscosity, allowed) in [(8, 0.1, 3e-3), (16, 0.1, 2e-3), (16, 2.0, 2e-3)] {
        for [found, exact] in poiseuille(staggered, cells, viscosity, f64::INFINITY).unwrap() {
            println!("{cells} cells, viscosity {viscosity}: {found:.5} for {exact:.5}");
            assert!((found - exact).abs() < allowed, "{cells} {viscosity}: {found} {exact}");
        }
    }
}

/// No wall acts on a drop in free flight, in explicit and in implicit viscous steps: the impulse of walls is zero, and momentum stays.
#[test]
fn a_viscous_drop_in_flight_has_no_impulse_of_walls() {
    for viscosity in [1.0, 200.0] {
        let h = 1.0 / 16.0;
        let mut flow = Flow::new(FlowOptions::<2>::new(Lattice::new([0.0; 2], h).unwrap()));
        let fluid = Fluid::new(1000.0).unwrap().with_viscosity(viscosity).unwrap();
        let drop = Ball::new([0.013, 0.027], 0.5).unwrap();
        // It is stretched along a direction between the axes, while it flies.
        let velocity = |x: [f64; 2]| [1.0 + 0.6 * x[0] + 0.8 * x[1], 0.5 + 0.8 * x[0] - 0.6 * x[1]];
        flow.add_shape("drop", fluid, &drop, 2, velocity).unwrap();
        let before = flow.totals();
        flow.run_until(0.3).unwrap();
        let (impulse, after) = (flow.exchange().impulse, flow.totals());
        for d in 0..2 {
            let size = before.mass;
            assert!(impulse[d].abs() < 1e-9 * size, "viscosity {viscosity}: impulse {impulse:?} N s/m");
            let change = (after.momentum[d] - before.momentum[d]).abs() / size;
            println!("viscosity {viscosity}: velocity of the drop changes by {change:.1e} m/s along {d}");
            assert!(change < 5e-3, "viscosity {viscosity}: {change} m/s");
        }
    }
}
