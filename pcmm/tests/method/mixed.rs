//! Particle-contact bodies beside bodies of another method.

use impactite_geometry::{Cuboid, Lattice};
use impactite_scene::{
    Axisymmetric, Boundary, FullSpace, PlaneStrain, Side, Solver as _, TimeControl, solver_conforms,
};
use mpm_contact::conformance::{Balls, Broken, particle_body};
use mpm_contact::{Coulomb, Pairs, SurfaceDistance};
use pcmm::{
    Audit, AzimuthFan, Bodies, Consistent, LocalDelaunay, Masses, Method, Packing, Pcmm, Printed, RigidWall,
};

use crate::common::{block, copper};

const H: f64 = 1.0e-3;

fn delaunay() -> LocalDelaunay {
    LocalDelaunay::new(0.45 * H, 2.0).unwrap()
}

fn target(corner: [f64; 2], speed: f64) -> Pcmm<2, Consistent<PlaneStrain>> {
    let method = Method::consistent(PlaneStrain, delaunay());
    let packing = block(corner, 12, 6, H);
    Pcmm::new(method, copper(), &packing, |_| [0.0, speed], Masses::FromElements).unwrap()
}

#[test]
fn particle_contacts_are_a_body_of_particles() -> Result<(), Broken> {
    particle_body(|| {
        let mut body = target([0.0; 2], -100.0);
        body.set_body_force(std::sync::Arc::new(|_| [0.0, -10.0]));
        body.bound(Boundary::Wall { axis: 1, at: 0.0, side: Side::Above, velocity: 0.0 }).unwrap();
        body
    })?;
    particle_body(|| {
        let method = Method::consistent(Axisymmetric, delaunay());
        let mut body =
            Pcmm::new(method, copper(), &block([0.0; 2], 5, 4, H), |_| [0.0, 9.0], Masses::FromElements)
                .unwrap();
        body.bound(Boundary::Symmetry { axis: 0, at: 0.0, side: Side::Above }).unwrap();
        body
    })?;
    particle_body(|| {
        let shape = Cuboid::new([0.0; 3], [3.0 * H, 2.0 * H, 2.0 * H]).unwrap();
        let packing = Packing::on_nodes(&shape, &Lattice::new([0.0; 3], H).unwrap()).unwrap();
        let method = Method::consistent(FullSpace, LocalDelaunay::new(0.8 * H, 2.0).unwrap());
        Pcmm::new(method, copper(), &packing, |_| [1.0, 2.0, 3.0], Masses::FromElements).unwrap()
    })
}

/// A block of balls on springs falls on a copper block on a wall.
fn mixed() -> Bodies<2, SurfaceDistance> {
    let mut scene = Bodies::new(SurfaceDistance::default(), Pairs::new(Coulomb::new(0.3).unwrap()));
    scene.add("copper", target([0.0, 0.0], 0.0));
    let site = |i: u32| [(1.2 + f64::from(i % 8)) * H, (6.7 + f64::from(i / 8)) * H];
    // About as heavy and as stiff as copper.
    let balls = Balls::new((0..40).map(site).collect(), 0.5 * H, 8930.0 * H * H).bonded(1.2e11);
    scene.add("balls", balls.moving([10.0, -50.0]));
    scene.add_wall(RigidWall::new([0.0, 0.0], [0.0, 1.0]).unwrap());
    scene.set_time_control(TimeControl::Courant { factor: 0.2, growth: 1.1 }).unwrap();
    scene
}

solver_conforms! {
    with_balls: super::mixed, SolverTests::until(1.0e-5).energy_within(0.01);
}

#[test]
fn bodies_of_two_methods_meet() {
    let mut scene = mixed();
    let start = scene.totals();
    scene.run_until(1.0e-5).unwrap();
    let (end, given) = (scene.totals(), scene.exchange());
    let copper = scene.totals_of(0).unwrap();
    assert!(copper.momentum[0] > 0.0 && given.impacts > 0.0 && given.friction > 0.0, "{copper:?} {given:?}");
    for d in 0..2 {
        let missing = end.momentum[d] - start.momentum[d] - given.impulse[d];
        assert!(missing.abs() < 1e-12 * start.momentum_scale, "{missing}");
    }
    assert!(scene.contacts().iter().any(|pair| pair.bodies == [0, 1]));
    let method = scene.method();
    assert!(
        method.contains("copper: particle-contact method: ") && method.contains("balls: balls on "),
        "{method}"
    );
    assert!(scene.part::<Pcmm<2, Consistent<PlaneStrain>>>(0).is_some_and(|copper| copper.elements() == 144));
    assert!(scene.part::<Pcmm<2, Printed<PlaneStrain>>>(0).is_none());
    assert!(scene.part::<Balls<2>>(0).is_none() && scene.part::<Balls<2>>(1).is_some());
}

/// Each body has its own audit of revisions; the scene has the sum of their additions.
#[test]
fn bodies_keep_their_accounts() {
    let mut scene = Bodies::new(SurfaceDistance::default(), Pairs::new(Coulomb::new(0.1).unwrap()));
    for (name, corner, speed) in [("lower", 0.0, 0.0), ("upper", 6.2 * H, -400.0)] {
        let mut body = target([0.0, corner], speed);
        body.set_revision_interval(2).unwrap();
        scene.add(name, body);
    }
    let fan = Method::printed(PlaneStrain, AzimuthFan::new(0.45 * H).unwrap());
    let packing = block([0.0, 20.0 * H], 4, 4, H);
    scene.add("printed", Pcmm::new(fan, copper(), &packing, |_| [0.0; 2], Masses::FromElements).unwrap());
    scene.run_until(1.5e-5).unwrap();
    let audit = (0..2).filter_map(|n| scene.part::<Pcmm<2, Consistent<PlaneStrain>>>(n));
    let audit = audit.fold(Audit::default(), |sum, body| sum.plus(body.audit()));
    assert!(audit.created.elements > 0, "{audit:?}");
    let (added, given) = (audit.energy_added(), scene.exchange().conversion);
    assert!((added - given).abs() <= 1e-9 * audit.created.energy.abs(), "{added} {given}");
}
