//! Trials.
use impactite_geometry::{Cuboid, Filling, Lattice, fill};
use impactite_scene::*;
use mpm_contact::particles::Bodies;
use mpm_contact::*;
use sph::*;
fn block(low: [f64; 2], high: [f64; 2], h: f64) -> Layout<2> {
    Layout::of_seeds(
        &fill(&Cuboid::new(low, high).unwrap(), &Lattice::new(low, h).unwrap(), 1, &Filling::new()).unwrap(),
    )
}
fn main() {
    let h = 0.01;
    let mut scene = Bodies::new(SurfaceDistance::default(), Pairs::new(Coulomb::new(0.3).unwrap()));
    let method = Method::total_lagrangian(PlaneStrain);
    let soft = || {
        mpm_materials::LinearElastic::new(1000.0, mpm_materials::Moduli::young_poisson(1e7, 0.3).unwrap())
            .unwrap()
    };
    let floor = block([0.0, -5.0 * h], [40.0 * h, 0.0], h);
    let mut floor = Sph::new(method, soft(), &floor, |_| [0.0; 2]).unwrap();
    floor.bound(Boundary::Fixed { axis: 1, at: -4.0 * h, side: Side::Above }).unwrap();
    let b = block([5.0 * h, 0.0], [15.0 * h, 6.0 * h], h);
    let mut b = Sph::new(method, soft(), &b, |_| [1.0, 0.0]).unwrap();
    b.set_body_force(std::sync::Arc::new(|_| [0.0, -10.0]));
    scene.add("floor", floor);
    scene.add("block", b);
    let mut last = 1.0;
    let (mut fx, mut fy, mut n) = (0.0, 0.0, 0);
    for k in 1..=12 {
        let end = 0.01 * k as f64;
        while !scene.reached(end) {
            let dt = scene.step_towards(end).unwrap();
            if scene.time() < 0.004 {
                for c in scene.contact_points() {
                    println!(
                        "{:.5} at {:?} n {:?} gap {:?} imp {:?}",
                        scene.time(),
                        c.position,
                        c.normal,
                        c.gap,
                        c.impulse
                    );
                }
            }
            for c in Solver::contacts(&scene) {
                fx += c.force[0] * dt;
                fy += c.force[1] * dt;
                n += c.places;
            }
        }
        let t = scene.totals_of(1).unwrap();
        let v = t.momentum[0] / t.mass;
        let y: f64 = scene.bodies()[1].points().iter().map(|p| p.position[1]).sum::<f64>() / 60.0;
        let low: f64 = scene.bodies()[1].points().iter().map(|p| p.position[1]).fold(1.0, f64::min);
        println!(
            "t {end:.3} v {v:.4} slow {:.3} y {:.5} (0.03) low {low:.5} vy {:.4} impulse {fx:.3} {fy:.3} (weight {:.3}) ratio {:.3} places {n} spin {:.3}",
            (last - v) / 0.01,
            y,
            t.momentum[1] / t.mass,
            0.01 * 10.0 * t.mass,
            -fx / fy,
            t.angular_momentum[2]
        );
        last = v;
        fx = 0.0;
        fy = 0.0;
        n = 0;
    }
}
