//! Memory of the sparse grid: a projectile on a long flight to its target needs no more memory than one near it, and
//! conserves momentum and energy.

use mpm_core::geometry::{Ball, Cuboid, Filling, Lattice, fill};
use mpm_core::{BlockGrid, Flip, FullSpace, Linear, Method, Mpm, Musl, Totals};
use mpm_materials::{LinearElastic, Moduli};

const H: f64 = 0.1;
/// Cells through the plate.
const THICKNESS: f64 = 3.0;
const SPEED: f64 = 10.0;

/// Build a ball this many plate thicknesses in front of a plate.
fn scene(before: f64) -> Mpm<3> {
    let lattice = Lattice::new([0.0; 3], H).expect("lattice");
    let mut mpm = Mpm::new(Method::new(Linear, Flip, Musl, FullSpace), BlockGrid::new(lattice));
    let law = LinearElastic::new(1000.0, Moduli::young_poisson(1e5, 0.3).expect("moduli")).expect("law");
    let middle = [-before * THICKNESS * H, 0.2, 0.2];
    // Particles in rows: those of other fillings change bins one by one, and groups are created and deleted.
    let rows = Filling::new().at_sites();
    let ball = fill(&Ball::new(middle, 1.5 * H).expect("ball"), &lattice, 2, &rows).expect("seeds");
    let plate = Cuboid::new([0.0; 3], [THICKNESS * H, 0.4, 0.4]).expect("plate");
    let plate = fill(&plate, &lattice, 2, &Filling::new()).expect("seeds");
    mpm.add("ball", law, &ball, |_| [SPEED, 0.0, 0.0]).expect("body");
    mpm.add("plate", law, &plate, |_| [0.0; 3]).expect("body");
    mpm
}

#[test]
fn a_long_flight_takes_no_more_memory() {
    let mut mpm = scene(50.0);
    let start: Totals = mpm.bodies()[0].totals();
    let time = 48.0 * THICKNESS * H / SPEED;
    // Blocks of the ball are created and deleted with a period of four cells: the first tenth of the flight covers
    // all cases.
    let mut most = [0; 2];
    for (part, end) in [0.1, 1.0].into_iter().enumerate() {
        while !mpm.reached(end * time) {
            mpm.step_towards(end * time).expect("step");
            most[part] = most[part].max(mpm.bytes());
        }
    }
    let end = mpm.bodies()[0].totals();
    println!("{most:?} bytes, {} steps", mpm.steps());
    // Round-off shifts a change of bins by a step, which needs one more particle group.
    assert!(most[1] as f64 <= 1.01 * most[0] as f64, "{most:?} bytes in the first tenth and later");
    assert!(((end.momentum[0] - start.momentum[0]) / start.momentum[0]).abs() < 1e-12);
    assert!(((end.kinetic - start.kinetic) / start.kinetic).abs() < 1e-12);
    // Memory of a tenth of the flight, plus one block of bins at most.
    let mut near = scene(5.0);
    let mut bytes = 0;
    while !near.reached(0.07 * time) {
        near.step_towards(0.07 * time).expect("step");
        bytes = bytes.max(near.bytes());
    }
    assert!(most[1] as f64 <= 1.1 * bytes as f64, "{bytes} bytes of a short flight");
}
