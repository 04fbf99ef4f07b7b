//! The grid goes where the matter is: a projectile that flies far to its target takes no more memory than one that is
//! there, and loses nothing on its way.

use mpm_core::geometry::{Ball, Cuboid, Filling, Lattice, fill};
use mpm_core::{BlockGrid, Flip, FullSpace, Linear, Method, Mpm, Musl, Totals};
use mpm_materials::{LinearElastic, Moduli};

const H: f64 = 0.1;
/// Cells through the plate.
const THICKNESS: f64 = 3.0;
const SPEED: f64 = 10.0;

/// A ball this many thicknesses before a plate.
fn scene(before: f64) -> Mpm<f64, 3, Method<Linear, Flip, Musl, FullSpace>, BlockGrid<f64, 3>> {
    let lattice = Lattice::new([0.0; 3], H).expect("lattice");
    let mut mpm = Mpm::new(Method::new(Linear, Flip, Musl, FullSpace), BlockGrid::new(lattice));
    let law = LinearElastic::new(1000.0, Moduli::young_poisson(1e5, 0.3).expect("moduli")).expect("law");
    let middle = [-before * THICKNESS * H, 0.6, 0.6];
    let ball = fill(&Ball::new(middle, 1.5 * H).expect("ball"), &lattice, 2, &Filling::new()).expect("seeds");
    let plate = Cuboid::new([0.0; 3], [THICKNESS * H, 1.2, 1.2]).expect("plate");
    let plate = fill(&plate, &lattice, 2, &Filling::new()).expect("seeds");
    mpm.add("ball", law, &ball, |_| [SPEED, 0.0, 0.0]).expect("body");
    mpm.add("plate", law, &plate, |_| [0.0; 3]).expect("body");
    mpm
}

#[test]
fn a_long_flight_takes_no_more_memory() {
    let mut mpm = scene(50.0);
    let start: Totals = mpm.bodies()[0].totals();
    let way = 48.0 * THICKNESS * H;
    mpm.run_until(0.02 * way / SPEED).expect("run");
    let (early, blocks) = (mpm.bytes(), mpm.grid().bytes());
    let mut most = [early, blocks];
    while !mpm.reached(way / SPEED) {
        mpm.step_towards(way / SPEED).expect("step");
        most = [most[0].max(mpm.bytes()), most[1].max(mpm.grid().bytes())];
    }
    let end = mpm.bodies()[0].totals();
    println!("{early} bytes early, {most:?} at most, {} steps", mpm.steps());
    // Blocks of the ball come and go by planes of up to nine.
    assert!(most[0] as f64 <= 1.05 * early as f64, "{early} bytes early, {most:?} at most");
    assert!(((end.momentum[0] - start.momentum[0]) / start.momentum[0]).abs() < 1e-12);
    assert!(((end.kinetic - start.kinetic) / start.kinetic).abs() < 1e-12);
    // No more than if the ball had started where it came to.
    let mut near = scene(2.0);
    near.run_until(0.02 * way / SPEED).expect("run");
    assert!(most[0] as f64 <= 1.1 * near.bytes() as f64, "{} bytes near the plate", near.bytes());
}
