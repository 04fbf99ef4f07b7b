//! Free drops.

use flow::{Flow, FlowOptions, Fluid, Wall};
use impactite_geometry::{Ball, Cuboid, Disc, HalfSpace, Lattice};
use impactite_scene::Solver;

use crate::common::{GRAVITY, centroid};
use crate::gates::{elliptic_drop, staggered};

fn drop<const D: usize>(
    options: FlowOptions<D>,
    radius: f64,
    velocity: impl Fn([f64; D]) -> [f64; D],
) -> Flow<D> {
    let mut flow = Flow::new(options);
    let ball = Ball::new([0.0; D], radius).unwrap();
    flow.add_shape("drop", Fluid::new(1000.0).unwrap(), &ball, 2, velocity).unwrap();
    flow
}

#[test]
fn free_fall_is_exact() {
    fn fall<const D: usize>(radius: f64) {
        let options = FlowOptions::<D>::new(Lattice::new([0.013; D], 0.1).unwrap());
        let mut start = [1.0; D];
        start[1] = 3.0;
        let mut flow = drop(options.density_correction(0.0).unwrap(), radius, |_| start);
        let mut gravity = [0.0; D];
        gravity[1] = -GRAVITY;
        flow.set_body_force(move |_| gravity);
        let before = flow.points();
        let t = 0.8;
        flow.run_until(t).unwrap();
        for (a, b) in before.iter().zip(flow.points()) {
            for d in 0..D {
                let exact = a.position[d] + start[d] * t + 0.5 * gravity[d] * t * t;
                // Rounding of some tens of steps.
                assert!((b.position[d] - exact).abs() < 1e-12, "{} {exact}", b.position[d]);
            }
        }
        assert!(flow.account().unexplained.abs() < 1e-9 * flow.account().kinetic);
        assert!(flow.account().missing() < 1e-12 * flow.account().momentum_scale);
        assert!(flow.exchange().dropped.iter().all(|p| p.abs() < 1e-12 * flow.account().momentum_scale));
    }
    fall::<2>(0.5);
    fall::<3>(0.4);
    // Less than a cell: without a pressure.
    fall::<2>(0.06);
    fall::<3>(0.07);
}

/// Two drops collide beside each other. The transfer and the surface are no exact pairs: what they lose is booked.
#[test]
fn drops_that_collide_keep_their_momentum() {
    let mut flow = Flow::new(FlowOptions::<2>::new(Lattice::new([0.0; 2], 0.1).unwrap()));
    for (name, centre, speed) in [("left", [-1.1, 0.23], 1.0), ("right", [1.1, -0.31], -1.0)] {
        let disc = Disc::new(centre, 1.0).unwrap();
        flow.add_shape(name, Fluid::new(1000.0).unwrap(), &disc, 2, |_| [speed, 0.0]).unwrap();
    }
    let before = flow.totals();
    flow.run_until(1.0).unwrap();
    let (account, lost) = (flow.account(), flow.exchange().dropped);
    println!(
        "momentum lost {lost:.3?} of {:.1}, energy {:.4}",
        account.momentum_scale,
        account.unexplained / before.kinetic
    );
    assert!(account.missing() < 1e-12 * account.momentum_scale);
    assert!(lost.iter().all(|p| p.abs() < 5e-3 * account.momentum_scale), "{lost:?}");
    assert!(account.unexplained < 0.0);
}

#[test]
fn what_cannot_be_is_refused() {
    let lattice = Lattice::new([0.0; 2], 0.1).unwrap();
    let water = Fluid::new(1000.0).unwrap();
    assert!(Fluid::new(-1.0).is_err() && water.with_viscosity(f64::NAN).is_err());
    assert!(
        FlowOptions::new(lattice).periodic(0, 6).is_err()
            && FlowOptions::new(lattice).periodic(2, 8).is_err()
    );
    let mut flow = Flow::new(FlowOptions::new(lattice));
    assert!(flow.step_at_most(0.1).is_err(), "no body");
    let mut flow = Flow::new(FlowOptions::new(lattice));
    let disc = Disc::new([0.0; 2], 1.0).unwrap();
    flow.add_shape("a", water, &disc, 2, |_| [0.0; 2]).unwrap();
    assert!(flow.add_shape("a", water, &disc, 2, |_| [0.0; 2]).is_err(), "twice the same name");
    let other = Fluid::new(900.0).unwrap();
    assert!(flow.add_shape("b", other, &disc, 2, |_| [0.0; 2]).is_err(), "another liquid");
    flow.add_wall(Wall::solid(Disc::new([0.5, 0.0], 0.4).unwrap())).unwrap();
    let error = flow.step_at_most(0.1).unwrap_err().to_string();
    assert!(error.contains("distance of a particle from the walls"), "{error}");
    // A full tank whose wall moves into it.
    let mut flow = Flow::new(FlowOptions::new(lattice));
    let tank = Cuboid::new([0.0; 2], [1.0; 2]).unwrap();
    flow.add_wall(Wall::container(tank)).unwrap();
    flow.add_shape("a", water, &tank, 2, |_| [0.0; 2]).unwrap();
    let piston = HalfSpace::new([0.0; 2], [1.0, 0.0]).unwrap();
    flow.add_wall(Wall::solid(piston).moving(|t| [0.1 * t, 0.0])).unwrap();
    let error = flow.step_at_most(0.1).unwrap_err().to_string();
    assert!(error.contains("incompatible"), "{error}");
}

/// A free drop in rotation is unstable without surface tension: its pressure is below that of the surface. A full round tank is stable.
#[test]
fn solid_rotation_is_kept() {
    for (cells, lost) in [(8.0, 0.08), (16.0, 0.06), (32.0, 0.04)] {
        let options = FlowOptions::<2>::new(Lattice::new([0.0; 2], 1.0 / cells).unwrap());
        let mut flow = drop(options, 1.0, |x| [-x[1], x[0]]);
        flow.add_wall(Wall::container(Disc::new([0.0; 2], 1.0).unwrap())).unwrap();
        let before = flow.totals();
        flow.run_until(2.0 * std::f64::consts::PI).unwrap();
        let now = flow.totals();
        let radius = flow.points().iter().map(|p| p.position[0].hypot(p.position[1])).fold(0.0, f64::max);
        let spin = now.angular_momentum[2] / before.angular_momentum[2];
        println!(
            "{cells} cells: spin {spin:.4} after a revolution in {} steps, radius {radius:.4}",
            flow.steps()
        );
        // First order, by the velocities beyond the curved wall: 6.3, 4.7 and 3.0 %.
        assert!((1.0 - spin).abs() < lost, "{cells}: {spin}");
        assert!(radius < 1.0 && centroid(&flow.points()).iter().all(|x| x.abs() < 2e-3));
    }
}

#[test]
fn an_elliptic_drop_follows_its_equations() {
    for cells in [8.0, 16.0] {
        for (n, error) in elliptic_drop(staggered, cells).unwrap().iter().enumerate() {
            println!("{cells} cells: errors of a, b, energy at {}: {error:.5?}", 0.5 * (n + 1) as f64);
            // The short axis is 2.2 cells at the end, on the coarse grid.
            assert!(error[0].abs() < 6e-3 && error[1].abs() < 0.05, "{cells} {n}: {error:?}");
            assert!(error[2].abs() < 0.02, "{cells} {n}: {error:?}");
        }
    }
}
