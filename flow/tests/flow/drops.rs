//! Free drops.

use std::f64::consts::PI;

use flow::{Flow, FlowOptions, Fluid, RigidBody, SemiStaggered, Wall};
use impactite_geometry::{Ball, Cuboid, Disc, HalfSpace, Lattice};
use impactite_scene::Solver;
use impactite_simd::Team;

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

/// Axes a and b = R^2 / a of an elliptic drop in a central force -B^2 r with B = 1, by Runge-Kutta steps: A' = (A^2 + B^2)(b^2 - a^2) / (a^2 + b^2),
/// a' = A a. Return ln(a / b) at its first maximum.
fn largest_of_ellipse(rate: f64) -> f64 {
    let slope = |[a, rate]: [f64; 2]| {
        let (a2, b2) = (a * a, 1.0 / (a * a));
        [rate * a, (rate * rate + 1.0) * (b2 - a2) / (a2 + b2)]
    };
    let (mut y, dt, mut most) = ([1.0, rate], 1e-3, 0.0f64);
    for _ in 0..2000 {
        let along = |y: [f64; 2], k: [f64; 2], s: f64| [y[0] + s * dt * k[0], y[1] + s * dt * k[1]];
        let k1 = slope(y);
        let k2 = slope(along(y, k1, 0.5));
        let k3 = slope(along(y, k2, 0.5));
        let k4 = slope(along(y, k3, 1.0));
        (0..2).for_each(|n| y[n] += dt / 6.0 * (k1[n] + 2.0 * k2[n] + 2.0 * k3[n] + k4[n]));
        most = most.max(2.0 * y[0].ln());
    }
    most
}

/// Drop of `cells` cells radius that oscillates in a central force of 1/s^2 times the distance, from v = `rate` (x, -y): errors of the period
/// over ten of them, of the first and the tenth maximum of ln(a / b), and the energy that is not explained over the largest kinetic one.
fn oscillating(cells: f64, rate: f64, centre: [f64; 2]) -> [f64; 4] {
    let mut flow = Flow::new(FlowOptions::new(Lattice::new([0.0; 2], 1.0 / cells).unwrap()));
    let disc = Disc::new(centre, 1.0).unwrap();
    let velocity = |x: [f64; 2]| [rate * (x[0] - centre[0]), -rate * (x[1] - centre[1])];
    flow.add_shape("drop", Fluid::new(1000.0).unwrap(), &disc, 2, velocity).unwrap();
    flow.set_force_field(move |x, _| [centre[0] - x[0], centre[1] - x[1]]);
    let (due, most) =
        if rate == 1.0 { (4.82734, largest_of_ellipse(1.0)) } else { (4.56737, largest_of_ellipse(0.5)) };
    let (mut crossings, mut maxima, mut last, mut peak, mut kinetic) =
        (Vec::new(), Vec::new(), [0.0; 2], 0.0f64, 0.0f64);
    while crossings.len() < 10 && flow.time() < 11.0 * due {
        flow.step_at_most(f64::INFINITY).unwrap();
        let points = flow.points();
        let at = centroid(&points);
        let moment =
            |d: usize| points.iter().map(|p| p.volume * (p.position[d] - at[d]).powi(2)).sum::<f64>();
        let now = [flow.time(), 0.5 * (moment(0) / moment(1)).ln()];
        peak = peak.max(now[1]);
        kinetic = kinetic.max(flow.totals().kinetic);
        if last[1] < 0.0 && now[1] >= 0.0 {
            crossings.push(last[0] - last[1] * (now[0] - last[0]) / (now[1] - last[1]));
            maxima.push(peak);
            peak = 0.0;
        }
        last = now;
    }
    let period = crossings[9] / 10.0;
    [period / due - 1.0, maxima[0] / most - 1.0, maxima[9] / most - 1.0, flow.account().unexplained / kinetic]
}

/// Ten periods: dissipation and growth add up.
#[test]
fn drops_oscillate_in_a_central_force() {
    let coarse = oscillating(12.0, 1.0, [0.0; 2]);
    let fine = oscillating(24.0, 1.0, [0.0; 2]);
    let beside = oscillating(16.0, 0.5, [0.013, -0.027]);
    for (cells, found) in [(12, coarse), (24, fine), (16, beside)] {
        println!("{cells} cells a radius: {found:?}");
        assert!(found[1].abs() < 0.005 && found[2].abs() < 0.005, "maxima of {cells} cells: {found:?}");
        assert!(found[3].abs() < 0.02, "energy of {cells} cells: {found:?}");
    }
    // Of second order in the cell.
    assert!(fine[0].abs() < 0.001 && (coarse[0] / fine[0]).log2() > 1.8, "{coarse:?} and {fine:?}");
    assert!(beside[0].abs() < 0.003, "{beside:?}");
}

/// In space, from rest beside the centre: the centre of mass is at x0 cos t, and angular momentum stays zero. Equal bits for two threads and after
/// a restart.
#[test]
fn a_drop_falls_through_a_centre() {
    let start = [0.3, 0.1, -0.2];
    let made = |threads: usize| {
        let options = FlowOptions::<3>::new(Lattice::new([0.013; 3], 0.1).unwrap());
        let mut flow = Flow::new(options);
        let ball = Ball::new(start, 0.3).unwrap();
        flow.add_shape("drop", Fluid::new(1000.0).unwrap(), &ball, 2, |_| [0.0; 3]).unwrap();
        flow.set_force_field(|x, _| x.map(|x| -x));
        flow.set_team(Team::new(threads).unwrap());
        flow
    };
    let (mut one, mut two) = (made(1), made(2));
    one.run_until(2.0).unwrap();
    two.run_until(2.0).unwrap();
    let file = std::env::temp_dir().join(format!("flow_centre_{}", std::process::id()));
    one.save(&file).unwrap();
    let mut resumed = made(1);
    resumed.resume(&file).unwrap();
    std::fs::remove_file(&file).unwrap();
    for flow in [&mut one, &mut two, &mut resumed] {
        flow.run_until(3.0).unwrap();
    }
    let places = |flow: &Flow<3>| flow.points().iter().map(|p| p.position).collect::<Vec<_>>();
    assert!(places(&one) == places(&two) && places(&one) == places(&resumed));
    let (found, totals) = (centroid(&one.points()), one.totals());
    for d in 0..3 {
        assert!((found[d] - start[d] * 3.0_f64.cos()).abs() < 2e-3, "{found:?}");
        assert!(
            totals.angular_momentum[d].abs() < 1e-3 * totals.momentum_scale,
            "{:?}",
            totals.angular_momentum
        );
    }
    assert!(one.account().unexplained.abs() < 0.02 * one.account().energy_scale, "{:?}", one.account());
}

#[test]
fn fields_act_on_liquid_alone_and_are_finite() {
    let refused = |flow: &mut Flow<2>| flow.run_until(0.1).unwrap_err().to_string();
    let disc = Disc::new([0.0; 2], 0.5).unwrap();
    let options = || FlowOptions::<2>::new(Lattice::new([0.0; 2], 0.1).unwrap());
    let mut flow = drop(
        options().density_correction(0.0).unwrap().semi_staggered(SemiStaggered::default()),
        0.5,
        |_| [0.0; 2],
    );
    flow.set_force_field(|_, _| [1.0, 0.0]);
    assert!(refused(&mut flow).contains("by place"));
    let mut flow = Flow::new(options());
    flow.add_rigid("ball", RigidBody::new(disc, 300.0).unwrap()).unwrap();
    flow.add_shape("water", Fluid::new(1000.0).unwrap(), &Ball::new([2.0, 0.0], 0.5).unwrap(), 2, |_| {
        [0.0; 2]
    })
    .unwrap();
    flow.set_force_field(|_, _| [1.0, 0.0]);
    assert!(refused(&mut flow).contains("beside a body"));
    let mut flow = drop(options(), 0.5, |_| [0.0; 2]);
    flow.set_force_field(|x, _| [1.0 / (x[0] - x[0]), 0.0]);
    assert!(refused(&mut flow).contains("body force"));
    // After a while, and named with its place.
    let mut flow = drop(options(), 0.5, |_| [0.0; 2]);
    flow.set_force_field(|_, t| [if t < 0.05 { 1.0 } else { f64::NAN }, 0.0]);
    let error = refused(&mut flow);
    assert!(error.contains("body force of the liquid at"), "{error}");
    // A centre in open space between faces and on one.
    for centre in [[2.0, 0.0], [2.05, 0.05]] {
        let mut flow = drop(options(), 0.5, |_| [0.0; 2]);
        flow.set_force_field(move |x, _| {
            let r = [x[0] - centre[0], x[1] - centre[1]];
            r.map(|r_d| -r_d / (r[0] * r[0] + r[1] * r[1]))
        });
        flow.run_until(0.1).unwrap();
        assert!(flow.totals().momentum[0] > 0.0);
    }
}

/// A field that grows from zero: the first step is not as long as the run.
#[test]
fn steps_see_fields_that_start_from_zero() {
    let options = FlowOptions::<2>::new(Lattice::new([0.0; 2], 0.1).unwrap());
    let mut flow = drop(options, 0.3, |_| [0.0; 2]);
    flow.set_force_field(|_, t| [20.0 * (2.0 * PI * t).sin(), 0.0]);
    flow.run_until(1.0).unwrap();
    let place = centroid(&flow.points())[0];
    println!("{} steps: {place} m", flow.steps());
    assert!((place / (10.0 / PI) - 1.0).abs() < 0.01, "{place} m");
}
