//! The semi-staggered scheme, as printed, beside the staggered one.

use flow::{Flow, FlowOptions, Fluid, RigidBody, SemiStaggered, Wall};
use impactite_geometry::{Ball, Cuboid, Disc, HalfSpace, Lattice};
use impactite_scene::{Solver, TimeControl};

use crate::common::{GRAVITY, box_of_particles};
use crate::gates::{
    column, elliptic_drop, hydrostatic, poiseuille, resting, semi_staggered, sloshing, staggered,
    taylor_green,
};

fn nodal<const D: usize>(h: f64) -> FlowOptions<D> {
    FlowOptions::new(Lattice::new([0.0; D], h).unwrap()).semi_staggered(SemiStaggered::default())
}

#[test]
fn free_fall_at_nodes_is_exact() {
    fn fall<const D: usize>() {
        let mut flow = Flow::new(nodal::<D>(0.1));
        let mut start = [1.0; D];
        start[1] = 3.0;
        let ball = Ball::new([0.013; D], 0.4).unwrap();
        flow.add_shape("drop", Fluid::new(1000.0).unwrap(), &ball, 2, |_| start).unwrap();
        let mut gravity = [0.0; D];
        gravity[1] = -GRAVITY;
        flow.set_body_force(move |_| gravity);
        let dt = 0.01;
        flow.set_time_control(TimeControl::Fixed(dt)).unwrap();
        let before = flow.points();
        flow.run_until(0.5).unwrap();
        let n = flow.steps() as f64;
        for (a, b) in before.iter().zip(flow.points()) {
            for d in 0..D {
                // Symplectic Euler: velocities of the end of each step.
                let exact = a.position[d] + start[d] * n * dt + 0.5 * gravity[d] * dt * dt * n * (n + 1.0);
                assert!((b.position[d] - exact).abs() < 1e-12, "{} {exact}", b.position[d]);
            }
        }
        assert!(flow.account().missing() < 1e-12 * flow.account().momentum_scale);
    }
    fall::<2>();
    fall::<3>();
}

/// The pressure at rest has the exact slope, and nothing moves; but the surface of balls is up to half a cell too high.
#[test]
fn water_at_rest_has_the_slope_of_its_pressure_and_a_surface_that_is_too_high() {
    let h = 1.0 / 16.0;
    for theta in [0.01, 0.3, 0.5, 0.99] {
        let (mut flow, depth) = resting(semi_staggered, theta);
        let before = flow.points();
        flow.step_at_most(1e-4).unwrap();
        let heads: Vec<f64> = before
            .iter()
            .zip(flow.points())
            .filter(|(p, _)| p.position[1] > 0.5 * h && p.position[1] < depth - 1.5 * h)
            .map(|(p, q)| q.pressure() / (1000.0 * GRAVITY) + p.position[1])
            .collect();
        for head in &heads {
            assert!((head - heads[0]).abs() < 1e-9, "theta {theta}: {head} {}", heads[0]);
        }
        let high = (heads[0] - depth) / h;
        println!("theta {theta}: surface {high:.3} cells too high");
        assert!((0.1..0.5).contains(&high), "theta {theta}: {high}");
    }
    let [error, speed] = hydrostatic(semi_staggered, 0.5).unwrap();
    assert!(error < 0.06 && speed < 1e-9, "{error} {speed}");
}

/// The height of the surface is the error: of first order in the wall force, where the staggered scheme is of second order.
#[test]
fn the_first_pressure_at_nodes_is_of_first_order() {
    let [coarse, fine] = [16, 64].map(|cells| column(semi_staggered, cells).unwrap());
    let order = (coarse[0] / fine[0]).log(4.0);
    println!("wall force {coarse:?} {fine:?}: order {order:.3}");
    assert!((order - 1.0).abs() < 0.1, "{order}");
    let best = column(staggered, 64).unwrap();
    assert!(best[0].abs() < 0.02 * fine[0].abs(), "{best:?} {fine:?}");
}

#[test]
fn vortices_and_drops_at_nodes_lose_more_energy() {
    let error = taylor_green(semi_staggered, 32).unwrap();
    println!("Taylor-Green: {error:+.4}");
    assert!((-0.08..-0.02).contains(&error), "{error}");
    let last = elliptic_drop(semi_staggered, 16.0).unwrap()[3];
    println!("elliptic drop: {last:.5?}");
    assert!(last[0].abs() < 0.01 && last[1].abs() < 0.01 && (-0.08..-0.02).contains(&last[2]), "{last:?}");
}

/// The share c of PIC in each step of dt is a viscosity of about c h^2 / (8 dt): the flow is the slower the shorter the steps are.
#[test]
fn the_share_of_pic_is_a_viscosity() {
    let error = |longest: f64| {
        let found = poiseuille(semi_staggered, 8, 0.1, longest).unwrap();
        found.iter().map(|[u, exact]| (u - exact).abs()).fold(0.0, f64::max)
    };
    let [long, short] = [4e-4, 2e-4].map(error);
    println!("channel: {long:.4} and {short:.4} with half of the step");
    assert!(short > 1.5 * long && long > 0.05, "{long} {short}");
}

/// The velocity is not free of divergence: the Laplacian is not the divergence of the gradient at the nodes.
#[test]
fn the_velocity_at_nodes_has_divergence() {
    let [printed, best] = [semi_staggered, staggered].map(|scheme| sloshing(scheme, 24, 6.0).unwrap());
    println!("divergence h/v {:.1e}, {:.1e} of the staggered scheme", printed[2], best[2]);
    assert!(printed[2] > 0.05 && best[2] < 1e-9);
}

#[test]
fn what_is_off_the_lines_is_refused() {
    let water = Fluid::new(1000.0).unwrap();
    let run = |wall: Option<Wall<2>>, rigid: bool| {
        let mut flow = Flow::new(nodal::<2>(0.1));
        if let Some(wall) = wall {
            flow.add_wall(wall).unwrap();
        }
        let seeds = box_of_particles([0.0; 2], [1.0, 0.5], 0.1, 2);
        flow.add_fluid("water", water, &seeds, |_| [0.0; 2]).unwrap();
        if rigid {
            let ball = Disc::new([0.5, 0.9], 0.2).unwrap();
            flow.add_rigid("ball", RigidBody::new(ball, 100.0).unwrap()).unwrap();
        }
        flow.step_at_most(1e-3).map(|_| ()).map_err(|error| error.to_string())
    };
    let container = |width: f64| Wall::container(Cuboid::new([0.0; 2], [width, 1.0]).unwrap());
    assert_eq!(run(Some(container(1.0)), false), Ok(()));
    for (wall, rigid, expected) in [
        (Some(container(1.05)), false, "a wall at x = 1.05 m"),
        (Some(container(1.0).moving(|t| [t, 0.0])), false, "a wall that moves"),
        (
            Some(Wall::solid(HalfSpace::new([0.0; 2], [0.6, 0.8]).unwrap())),
            false,
            "a wall through the cell at",
        ),
        (None, true, "a body that the liquid moves"),
    ] {
        let error = run(wall, rigid).unwrap_err();
        assert!(error.contains(expected) && error.contains("lines of the grid"), "{error}");
    }
    let options = nodal::<2>(0.1).density_correction(0.1).unwrap();
    let error = Flow::new(options).check_scheme().unwrap_err().to_string();
    assert!(error.contains("a correction of the density"), "{error}");
    let mut flow = Flow::new(nodal::<2>(0.1));
    let seeds = box_of_particles([0.0; 2], [1.0, 0.5], 0.1, 2);
    flow.add_fluid("oil", water.with_viscosity(100.0).unwrap(), &seeds, |_| [0.0; 2]).unwrap();
    flow.set_time_control(TimeControl::Fixed(0.02)).unwrap();
    let error = flow.step_at_most(0.02).unwrap_err().to_string();
    assert!(error.contains("limit of the viscous stress"), "{error}");
    assert!(
        SemiStaggered::default().with_pic(1.1).is_err()
            && SemiStaggered::default().with_hourglass(0.3).is_err()
    );
}
