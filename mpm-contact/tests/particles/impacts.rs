//! Impacts of balls against exact solutions.

use impactite_scene::{Solver as _, TimeControl};
use mpm_contact::conformance::Balls;
use mpm_contact::particles::RigidWall;
use mpm_contact::{Coulomb, Frictionless};

use crate::{R, block, scene};

/// Plastic impact: the balls move on together, and the energy loss is m1 m2 / (m1 + m2) v^2 / 2.
#[test]
fn two_balls_go_on_together() {
    let mut scene = scene(Frictionless);
    scene.add("target", Balls::new(vec![[0.0, 0.0, 0.0]], R, 2.0));
    scene.add("bullet", Balls::new(vec![[-3.0 * R, 0.0, 0.0]], R, 1.0).moving([30.0, 0.0, 0.0]));
    scene.run_until(10.0 * R / 30.0).unwrap();
    for body in [0, 1] {
        let ball = scene.particles(body).next().unwrap();
        assert!((ball.velocity[0] - 10.0).abs() < 1e-12, "{ball:?}");
    }
    let taken = scene.exchange().impacts;
    assert!((taken - 0.5 * 2.0 / 3.0 * 900.0).abs() < 1e-9, "{taken}");
    // Contact at the sum of both radii.
    let [a, b] = [0, 1].map(|n| scene.particles(n).next().unwrap().position[0]);
    assert!(a - b >= 2.0 * R * (1.0 - 1e-9) && a - b < 2.2 * R, "{}", (a - b) / R);
}

/// Impact on a rough wall: the normal velocity vanishes, and friction reduces the slip by its coefficient times that.
#[test]
fn a_ball_on_a_rough_wall() {
    let (mu, [slip, fall]) = (0.3, [4.0, 2.0]);
    let mut scene = scene(Coulomb::new(mu).unwrap());
    scene.add("ball", Balls::new(vec![[0.0, 3.0 * R]], R, 0.5).moving([slip, -fall]));
    scene.add_wall(RigidWall::new([0.0, 0.0], [0.0, 1.0]).unwrap());
    // One step ends at the wall.
    scene.set_time_control(TimeControl::Fixed(0.1 * R / fall)).unwrap();
    scene.run_until(8.0 * R / fall).unwrap();
    let ball = scene.particles(0).next().unwrap();
    let left = slip - mu * fall;
    assert!((ball.velocity[0] - left).abs() < 1e-12 && ball.velocity[1].abs() < 1e-12, "{ball:?}");
    // The impulse mu J acts with the slip velocity at the end.
    let friction = 0.5 * mu * fall * left;
    let given = scene.exchange();
    assert!((given.friction - friction).abs() < 1e-12, "{given:?}");
    let lost = 0.5 * 0.5 * (slip * slip + fall * fall - left * left);
    assert!((given.friction + given.impacts - lost).abs() < 1e-12, "{given:?}");
    assert!((given.impulse[1] - 0.5 * fall).abs() < 1e-12, "{given:?}");
}

/// Face-to-face contact of blocks: a flat surface is flat, also where balls of the other face the gaps between its own.
#[test]
fn faces_are_flat() {
    for beside in [0.0, R] {
        let mut scene = scene(Frictionless);
        scene.add("lower", block([0.0, 0.0], [12, 5]));
        scene.add("upper", block([beside, 10.5 * R], [12, 5]).moving([3.0, -1.0]));
        let start = scene.totals();
        let mut met = 0;
        while scene.time() < 5.0e-4 {
            scene.step_towards(5.0e-4).unwrap();
            for contact in scene.contact_points() {
                met += 1;
                let within = contact.position[0] > 3.0 * R && contact.position[0] < 20.0 * R;
                assert!(!within || contact.normal[1] > 0.99, "{contact:?}");
            }
        }
        let (end, given) = (scene.totals(), scene.exchange());
        assert!(met > 0 && end.momentum[1] < 0.0);
        let slip = |body: usize| scene.totals_of(body).unwrap().momentum[0];
        // No interlocking: the upper block slides on.
        assert!(slip(0).abs() < 0.02 * slip(1), "{} {}", slip(0), slip(1));
        let missing: f64 = (0..3).map(|d| (end.momentum[d] - start.momentum[d]).abs()).sum();
        assert!(missing < 1e-13 * start.momentum_scale, "{missing}");
        let energy = (end.kinetic + end.internal + given.impacts) / start.kinetic - 1.0;
        assert!(energy.abs() < 5e-3, "{energy}");
    }
}

/// Contact at the rim alone: the inside has no effect if nothing gets there, and none on a ball that starts there; a wall acts on it.
#[test]
fn a_body_may_be_touched_at_its_rim_alone() {
    let seen = |rim: bool| {
        let mut scene = scene(Coulomb::new(0.2).unwrap());
        let of =
            |body: mpm_contact::conformance::Balls<2>| if rim { body.touched_at_the_rim() } else { body };
        scene.add("lower", of(block([0.0, 0.0], [8, 8])));
        scene.add("upper", of(block([R, 16.5 * R], [8, 8]).moving([1.0, -2.0])));
        scene.run_until(1.0e-3).unwrap();
        assert!(scene.exchange().impacts > 0.0);
        let bodies = [0, 1].map(|n| scene.particles(n).collect::<Vec<_>>());
        (bodies, scene.exchange())
    };
    assert_eq!(seen(true), seen(false));

    let speed_left = |rim: bool| {
        let mut scene = scene(Frictionless);
        let target = block([0.0, 0.0], [12, 12]);
        scene.add("target", if rim { target.touched_at_the_rim() } else { target });
        scene.add("chip", Balls::new(vec![[9.3 * R, 11.1 * R]], R, 1.0e-3).moving([50.0, 0.0]));
        scene.run_until(5.0 * R / 50.0).unwrap();
        scene.particles(1).next().unwrap().velocity[0]
    };
    assert_eq!(speed_left(true), 50.0);
    assert!(speed_left(false) < 30.0, "{}", speed_left(false));

    // Springs so soft that a wall would penetrate them deeply.
    let mut scene = scene(Frictionless);
    scene.add("soft", block([0.0, R], [5, 5]).moving([0.0, -20.0]).touched_at_the_rim());
    scene.add_wall(RigidWall::new([0.0, 0.0], [0.0, 1.0]).unwrap());
    scene.run_until(1.0e-3).unwrap();
    assert!(scene.particles(0).all(|p| p.position[1] > 0.9 * R));
}

/// Search for pairs, repeated when something has moved half a mean radius.
#[test]
fn pairs_are_kept_until_something_moved() {
    for (speed, searches) in [(0.0, 1), (5.0, 20)] {
        let mut scene = scene(Frictionless);
        scene.add("lower", block([0.0, 0.0], [8, 8]));
        scene.add("upper", block([0.0, 16.5 * R], [8, 8]).moving([0.0, speed]));
        scene.set_time_control(TimeControl::Fixed(1.0e-5)).unwrap();
        scene.run_until(1.0e-3).unwrap();
        assert!(scene.steps() == 100 && scene.searches().abs_diff(searches) <= 1, "{}", scene.searches());
    }
}
