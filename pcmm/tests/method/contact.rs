//! Contact between bodies: conformance suite of grid contact, and exact solutions.

use crate::common::{block, steel};
use impactite_geometry::{Ball, Filling, Lattice, fill};
use impactite_scene::Solver as _;
use impactite_scene::{Boundary, PlaneStrain, Side, TimeControl};
use impactite_simd::Team;
use mpm_contact::conformance::{Broken, Collision, DISC, FRICTION, collision, disc};
use mpm_contact::{
    Adhesion, Approach, Choice, Compression, ContactDetector, Coulomb, Frictionless, Gradients, Pairs,
    Regression, Stick, SurfaceDistance, Weight,
};
use mpm_materials::{Constitutive, Elastic, LogarithmicBulk, Moduli, Solid};
use pcmm::{Bodies, Consistent, LocalDelaunay, Masses, Method, Packing, Pcmm, RigidWall};

type Body = Pcmm<2, Consistent<PlaneStrain>>;

/// Return an elastic body of this density and Young's modulus.
fn elastic(packing: &Packing<2>, h: f64, density: f64, young: f64, velocity: [f64; 2]) -> Body {
    let moduli = Moduli::young_poisson(young, 0.3).unwrap();
    let law =
        Solid::new(Elastic::new(moduli.shear).unwrap(), LogarithmicBulk::new(density, moduli.bulk).unwrap());
    let method = Method::consistent(PlaneStrain, LocalDelaunay::new(0.45 * h, 2.0).unwrap());
    Pcmm::new(method, law, packing, |_| velocity, Masses::FromElements).unwrap()
}

fn difference(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|d| (a[d] - b[d]).powi(2)).sum::<f64>().sqrt()
}

/// Run the disc collision of the conformance suite with particles.
fn discs<S>(detector: S, h: f64, order: &[usize], threads: usize) -> Result<Collision, Broken>
where
    S: ContactDetector<f64, 2>,
{
    let (seen, energy) = discs_in_steps(detector, h, 0.01, order, threads);
    // First order in the step (see the next test), which is 0.4 of the limit here.
    assert!(energy.abs() < 0.02, "energy error {energy}");
    Ok(seen)
}

/// Return the collision and the energy error, with steps of `step` h.
fn discs_in_steps<S>(detector: S, h: f64, step: f64, order: &[usize], threads: usize) -> (Collision, f64)
where
    S: ContactDetector<f64, 2>,
{
    let mut scene = Bodies::new(detector, Pairs::new(Coulomb::new(FRICTION).unwrap()));
    for &n in order {
        let (centre, velocity) = disc(n, order.len());
        let lattice = Lattice::new([0.0; 2], h).unwrap();
        let seeds = fill(&Ball::new(centre, DISC).unwrap(), &lattice, 1, &Filling::new().at_sites()).unwrap();
        scene.add("disc", elastic(&Packing::of_seeds(&seeds), h, 1000.0, 1.0e6, velocity));
    }
    scene.set_team(Team::new(threads).unwrap());
    scene.set_time_control(TimeControl::Fixed(step * h)).unwrap();
    let start = scene.totals();
    let mut seen = Collision::default();
    while scene.time() < 0.022 {
        scene.step_towards(1.0).unwrap();
        let drift = difference(scene.totals().momentum, start.momentum);
        seen.drift = seen.drift.max(drift / start.momentum_scale);
        seen.contacts.extend(scene.contact_points().iter().map(|c| [c.normal, c.impulse]));
    }
    // Contact dissipates energy; the rest is kinetic and elastic.
    let (end, taken) = (scene.totals(), scene.exchange().impacts);
    assert!(taken > 0.0 && taken < 0.2 * start.kinetic, "{taken} of {}", start.kinetic);
    let error = (end.kinetic + end.internal + taken) / start.kinetic - 1.0;
    seen.positions = (0..order.len())
        .map(|b| scene.particles(b).map(|p| [p.position[0], p.position[1], 0.0]).collect())
        .collect();
    (seen, error)
}

/// Velocities, on which contact acts, are half a step from stresses: the energy balance closes to the order of the step.
#[test]
fn the_energy_books_close_with_the_step() {
    let error = |step: f64| discs_in_steps(SurfaceDistance::default(), 0.02, step, &[0, 1], 1).1.abs();
    let (long, short) = (error(0.01), error(0.0025));
    assert!(short < 0.3 * long && short < 5e-3, "{long} {short}");
}

#[test]
fn discs_meet_as_on_the_grid() -> Result<(), Broken> {
    collision(|order, threads| // Enough particles for two threads.
        discs(SurfaceDistance::default(), 0.0065, order, threads))
}

#[test]
fn every_detector_serves_particles() -> Result<(), Broken> {
    collision(|o, t| discs(SurfaceDistance::default().locally(), 0.02, o, t))?;
    collision(|o, t| discs(Approach::<Gradients>::default(), 0.02, o, t))?;
    collision(|o, t| discs(Compression::<Gradients>::default(), 0.02, o, t))?;
    collision(|o, t| discs(Regression, 0.02, o, t))?;
    collision(|o, t| {
        discs(
            SurfaceDistance::new(Gradients::new(Weight::Volume, Choice::Difference), 0.0).unwrap(),
            0.02,
            o,
            t,
        )
    })
}

/// Two equal bars collide end to end: they exchange their velocities (exact), 2 L / c after the first contact.
#[test]
fn equal_bars_exchange_their_velocities() {
    let (h, cells, speed) = (1.0e-3, 200u32, 5.0);
    let mut scene = Bodies::new(SurfaceDistance::default(), Pairs::new(Frictionless));
    let length = f64::from(cells) * h;
    for (left, v) in [(0.0, speed), (length, -speed)] {
        let mut bar = elastic(&block([left, 0.0], cells, 2, h), h, 7850.0, 206e9, [v, 0.0]);
        // Planes of symmetry: no lateral inertia, the confined modulus.
        bar.bound(Boundary::Symmetry { axis: 1, at: 0.0, side: Side::Above }).unwrap();
        bar.bound(Boundary::Symmetry { axis: 1, at: 2.0 * h, side: Side::Below }).unwrap();
        scene.add("bar", bar);
    }
    let start = scene.totals();
    let wave = (206e9 * 0.7 / (1.3 * 0.4) / 7850.0f64).sqrt();
    let mut parted = f64::NAN;
    while scene.time() < 3.0 * length / wave {
        scene.step_towards(3.0 * length / wave).unwrap();
        if !scene.contact_points().is_empty() {
            parted = scene.time();
        }
    }
    let end = scene.totals();
    let drift = difference(end.momentum, start.momentum) / start.momentum_scale;
    // Random walk of rounding: up to 3e-13 within these 1700 steps.
    assert!(drift < 1e-12, "{drift:e}");
    let velocity = |b: usize| {
        let t = scene.totals_of(b).unwrap();
        t.momentum[0] / t.mass
    };
    // Dispersion of the lattice behind the fronts: about cells^(-2/3).
    assert!(
        (velocity(0) / -speed - 1.0).abs() < 0.02 && (velocity(1) / speed - 1.0).abs() < 0.02,
        "{}",
        velocity(0)
    );
    // Fronts are a few spacings wide.
    assert!((parted / (2.0 * length / wave) - 1.0).abs() < 0.05, "{parted}");
    let energy = (end.kinetic + end.internal + scene.exchange().impacts) / start.kinetic - 1.0;
    assert!(energy.abs() < 2e-3, "{energy}");
    // The ends, half a spacing of 200 each, collide inelastically, and again in the later ringing.
    assert!(scene.exchange().impacts < 0.01 * start.kinetic, "{}", scene.exchange().impacts / start.kinetic);
}

/// Return the velocity of a block on an inclined wall, and the exact one: it sticks, or slides with g (sin - mu cos).
fn incline(friction: f64, degrees: f64) -> (f64, f64) {
    let h = 0.01;
    let (s, c) = degrees.to_radians().sin_cos();
    let mut scene = Bodies::new(SurfaceDistance::default(), Pairs::new(Coulomb::new(friction).unwrap()));
    let mut body = elastic(&block([0.0, 0.0], 10, 4, h), h, 2000.0, 1.0e7, [0.0; 2]);
    let g = 10.0;
    body.set_body_force(std::sync::Arc::new(move |_| [g * s, -g * c]));
    scene.add("block", body);
    let wall = scene.add_wall(RigidWall::new([0.0, 0.0], [0.0, 2.0]).unwrap());
    assert_eq!(wall, 1);
    let start = scene.totals();
    let end = 0.1;
    scene.run_until(end).unwrap();
    let (now, given) = (scene.totals(), scene.exchange());
    // All momentum is from gravity and the wall.
    let weight = [now.mass * g * s * end, -now.mass * g * c * end];
    for d in 0..2 {
        let missing = now.momentum[d] - start.momentum[d] - weight[d] - given.impulse[d];
        assert!(missing.abs() < 1e-11 * now.mass * g * end, "{missing}");
    }
    let expected = (g * (s - friction * c)).max(0.0) * end;
    (now.momentum[0] / now.mass, expected)
}

#[test]
fn a_block_on_an_incline_sticks_or_slides() {
    let scale = 10.0 * 0.1;
    for (friction, degrees) in [(0.3, 45.0), (0.1, 30.0), (0.0, 20.0), (0.6, 20.0)] {
        let (velocity, expected) = incline(friction, degrees);
        // The block bounces slightly, as its weight acts at once: friction acts with the mean of the reaction.
        assert!(
            (velocity - expected).abs() < 0.01 * scale,
            "{friction} {degrees}: {velocity} for {expected}"
        );
    }
}

/// A moving wall drags a block along by friction. Its work is the energy of the block plus the friction loss.
#[test]
fn a_moving_wall_does_work() {
    let h = 0.01;
    let mut scene = Bodies::new(SurfaceDistance::default(), Pairs::new(Coulomb::new(0.2).unwrap()));
    let mut body = elastic(&block([0.0, 0.0], 10, 4, h), h, 2000.0, 1.0e7, [0.0; 2]);
    body.set_body_force(std::sync::Arc::new(|_| [0.0, -10.0]));
    scene.add_wall(RigidWall::new([0.0, 0.0], [0.0, 1.0]).unwrap().moving([3.0, 0.0]).unwrap());
    scene.add("block", body);
    scene.run_until(0.1).unwrap();
    let now = scene.totals();
    // Velocity mu g t.
    assert!((now.momentum[0] / now.mass - 0.2).abs() < 0.01, "{}", now.momentum[0] / now.mass);
    let work = scene.exchange().work;
    let friction: f64 = scene.contacts().iter().map(|e| e.friction).sum();
    // Work of the force mu m g: over 3 m/s t by the wall, over mu g t^2 / 2 on the block.
    let force = 0.2 * now.mass * 10.0;
    assert!((work / (force * 0.3) - 1.0).abs() < 0.02, "{work} {}", force * 0.3);
    assert!((friction / (force * 0.29) - 1.0).abs() < 0.02, "{friction} {}", force * 0.29);
}

/// A bar on a contact wall behaves as on a wall condition for centres.
#[test]
fn a_contact_wall_is_a_wall() {
    let h = 1.0e-3;
    let bar = || elastic(&block([0.0, 0.0], 4, 30, h), h, 7850.0, 206e9, [0.0, -20.0]);
    let end = 1.5e-5;
    let mut alone = bar();
    alone.bound(Boundary::Wall { axis: 1, at: 0.0, side: Side::Above, velocity: 0.0 }).unwrap();
    alone.run_until(end).unwrap();
    let mut scene = Bodies::new(SurfaceDistance::default(), Pairs::new(Frictionless));
    scene.add("bar", bar());
    scene.add_wall(RigidWall::new([0.0, 0.0], [0.0, 1.0]).unwrap());
    scene.run_until(end).unwrap();
    let (one, other) = (alone.totals().momentum[1], scene.totals().momentum[1]);
    assert!(one > 0.0 && (other / one - 1.0).abs() < 0.01, "{other} for {one}");
}

/// Bodies under `Stick` are one body; adhesion fails beyond its strength.
#[test]
fn glue_holds_up_to_its_strength() {
    let h = 1.0e-3;
    let pulled = |laws: Pairs<f64>| {
        let mut scene = Bodies::new(Approach::<Gradients>::default(), laws);
        scene.add("left", elastic(&block([0.0, 0.0], 10, 4, h), h, 7850.0, 206e9, [-5.0, 0.0]));
        scene.add("right", elastic(&block([10.0 * h, 0.0], 10, 4, h), h, 7850.0, 206e9, [5.0, 0.0]));
        scene.run_until(1.0e-5).unwrap();
        let right = scene.totals_of(1).unwrap();
        right.momentum[0] / right.mass
    };
    // Velocities 10 m/s apart cause a tension of rho c 5 m/s, 0.2 GPa, and reverse after 2 L / c, 3.7 us; weak adhesion fails.
    assert!(pulled(Pairs::new(Stick)).abs() < 4.5);
    assert!(pulled(Pairs::new(Adhesion::new(5e8, 5e8, 0.0).unwrap())).abs() < 4.5);
    assert!((pulled(Pairs::new(Adhesion::new(1e6, 1e6, 0.0).unwrap())) - 5.0).abs() < 0.1);
    assert!((pulled(Pairs::new(Frictionless)) - 5.0).abs() < 1e-9);
}

/// Different laws and different methods in one scene.
#[test]
fn bodies_have_laws_and_methods_of_their_own() {
    let h = 1.0e-3;
    let mut scene = Bodies::new(SurfaceDistance::default(), Pairs::new(Frictionless));
    scene.add("elastic", elastic(&block([0.0, 0.0], 6, 6, h), h, 2700.0, 70e9, [80.0, 0.0]));
    let printed = Method::printed(PlaneStrain, pcmm::AzimuthFan::new(0.1 * h).unwrap());
    let mut positions = Vec::new();
    for j in 0..7 {
        for i in 0..7 {
            positions.push([
                6.5 * h + h * (f64::from(i) + 0.5 * f64::from(j % 2)),
                h * 0.75f64.sqrt() * f64::from(j),
            ]);
        }
    }
    let radii = vec![0.5 * h; positions.len()];
    let other = Pcmm::new(
        printed,
        steel().compiled(),
        &Packing::of_spheres(positions, radii),
        |_| [0.0; 2],
        Masses::FromElements,
    );
    scene.add("steel", other.unwrap());
    let start = scene.totals();
    scene.run_until(2.0e-5).unwrap();
    let end = scene.totals();
    assert!(difference(end.momentum, start.momentum) < 1e-13 * start.momentum_scale);
    assert!(scene.contacts().len() == 1 && scene.totals_of(1).unwrap().momentum[0] > 0.0);
    assert!(scene.snapshot().unwrap().scalar("pressure").unwrap().len() == 2 * 49);
}

#[test]
fn walls_are_refused_by_name() {
    let message = RigidWall::new([0.0; 2], [0.0; 2]).unwrap_err().to_string();
    assert!(message.contains("rigid wall: length of the normal = 0"), "{message}");
    assert!(RigidWall::new([f64::NAN, 0.0], [0.0, 1.0]).is_err());
    assert!(RigidWall::new([0.0; 2], [0.0, 1.0]).unwrap().moving([0.0, f64::INFINITY]).is_err());
}

/// Two cubes in space, and two discs around an axis, collide face to face: momentum is conserved to rounding, impulses are along the normal
/// of the faces, and both rebound.
#[test]
fn faces_meet_in_space_and_around_an_axis() {
    use impactite_geometry::Cuboid;
    use impactite_scene::{Axisymmetric, FullSpace};
    let h = 1.0e-3;
    let moduli = Moduli::young_poisson(206e9, 0.3).unwrap();
    let law =
        Solid::new(Elastic::new(moduli.shear).unwrap(), LogarithmicBulk::new(7850.0, moduli.bulk).unwrap());
    let mut cubes = Bodies::<3, _>::new(SurfaceDistance::default(), Pairs::new(Frictionless));
    for (low, v) in [(0.0, 40.0), (4.0 * h, -40.0)] {
        let shape = Cuboid::new([0.0, 0.0, low], [3.0 * h, 3.0 * h, low + 4.0 * h]).unwrap();
        let packing = Packing::on_nodes(&shape, &Lattice::new([0.0; 3], h).unwrap()).unwrap();
        let method = Method::consistent(FullSpace, LocalDelaunay::new(0.75 * h, 2.0).unwrap());
        cubes.add("cube", Pcmm::new(method, law, &packing, |_| [0.0, 0.0, v], Masses::FromElements).unwrap());
    }
    face_to_face(cubes, 2, 3.0 * h);

    let mut discs = Bodies::<2, _>::new(SurfaceDistance::default(), Pairs::new(Frictionless));
    for (low, v) in [(0.0, 40.0), (4.0 * h, -40.0)] {
        let shape = Cuboid::new([0.0, low], [6.0 * h, low + 4.0 * h]).unwrap();
        let packing = Packing::on_nodes(&shape, &Lattice::new([0.0; 2], h).unwrap()).unwrap();
        let method = Method::consistent(Axisymmetric, LocalDelaunay::new(0.45 * h, 2.0).unwrap());
        let mut disc = Pcmm::new(method, law, &packing, |_| [0.0, v], Masses::FromElements).unwrap();
        disc.bound(Boundary::Symmetry { axis: 0, at: 0.0, side: Side::Above }).unwrap();
        discs.add("disc", disc);
    }
    face_to_face(discs, 1, 6.0 * h);
}

fn face_to_face<const D: usize>(mut scene: Bodies<D, SurfaceDistance>, axis: usize, width: f64) {
    scene.set_time_control(TimeControl::Courant { factor: 0.1, growth: 1.1 }).unwrap();
    let start = scene.totals();
    let mut met = 0;
    while scene.time() < 3.0e-6 {
        scene.step_towards(3.0e-6).unwrap();
        for contact in scene.contact_points() {
            met += 1;
            // In space one or two triangles of each face are at a corner of a cube of six tetrahedra, so that the normals of two cubes are
            // not mirror images at their rims (35 degrees at worst); within faces they are.
            assert!(contact.normal[axis] > 0.8, "{contact:?}");
            // Faces bulge by the strain of the impact, v / c, 0.7 %.
            let slants = 1.0 - contact.normal[axis] > 1e-4;
            let rim =
                |d: usize| contact.position[d] > width - 0.5e-3 || D == 3 && contact.position[d] < 0.5e-3;
            assert!(!slants || (0..axis).any(rim), "{contact:?}");
        }
    }
    let end = scene.totals();
    assert!(met > 0 && (end.momentum[axis] - start.momentum[axis]).abs() < 1e-13 * start.momentum_scale);
    for (body, sign) in [(0, -1.0), (1, 1.0)] {
        assert!(scene.totals_of(body).unwrap().momentum[axis] * sign > 0.0);
    }
    let energy = (end.kinetic + end.internal + scene.exchange().impacts) / start.kinetic - 1.0;
    // Energy error of 2 % at half the step limit, first order in the step.
    assert!(energy.abs() < 6e-3, "{energy}");
}

/// A body that starts inside another one is in contact with it: a chip of nine particles in the middle of a block shares its momentum with
/// the block before it has crossed a quarter.
#[test]
fn what_is_inside_a_body_meets_it() {
    let h = 1.0e-3;
    let mut scene = Bodies::new(SurfaceDistance::default(), Pairs::new(Frictionless));
    let speed = 100.0;
    scene.add("block", elastic(&block([0.0; 2], 24, 24, h), h, 2700.0, 70e9, [0.0; 2]));
    scene.add("chip", elastic(&block([11.3 * h, 11.4 * h], 2, 2, h), h, 2700.0, 70e9, [speed, 0.0]));
    let start = scene.totals();
    scene.run_until(6.0 * h / speed).unwrap();
    let chip = scene.totals_of(1).unwrap();
    assert!(chip.momentum[0] < 0.5 * chip.mass * speed, "{}", chip.momentum[0] / chip.mass);
    let drift = difference(scene.totals().momentum, start.momentum) / start.momentum_scale;
    assert!(drift < 1e-12, "{drift}");
    assert!(scene.contact_points().is_empty() || scene.exchange().impacts > 0.0);
}

/// Particles have no grid nodes whose frequencies could be bounded.
#[test]
fn a_time_control_that_needs_a_grid_is_refused() {
    let h = 0.1;
    let mut body = elastic(&block([0.0; 2], 2, 2, h), h, 1000.0, 1e6, [0.0; 2]);
    let error = body.set_time_control(TimeControl::Gershgorin { factor: 0.9, growth: 1.1, every: 10 });
    let message = error.unwrap_err().to_string();
    assert_eq!(
        message,
        "time control: every = 10 is not allowed; it must be left out, as `Gershgorin` needs the nodes of a grid: take `Courant`"
    );
}
