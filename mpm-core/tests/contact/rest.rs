//! Long rest: bodies on each other for 1e5 steps.
//!
//! The method is quadratic splines with APIC. Linear shape functions with FLIP and MUSL fail both tests: a layer as
//! light explodes, a pile keeps its noise and its bodies penetrate each other (book, "Bodies under load for long").

use crate::common::{H, lattice, rubber};
use mpm_contact::{Coulomb, Frictionless, Pairs, SurfaceDistance};
use mpm_core::geometry::{Compose, Cuboid, Filling, fill, rings};
use mpm_core::{
    Apic, BlockGrid, Boundary, GridContact, Method, Mpm, PlaneStrain, QuadraticBSpline, Rigid, Side, Twist,
    Usl,
};
use mpm_materials::{Moduli, NeoHookean};

const STEPS: u64 = 100_000;
const GRAVITY: f64 = 10.0;

fn smooth() -> Method<QuadraticBSpline, Apic, Usl, PlaneStrain> {
    Method::new(QuadraticBSpline, Apic, Usl, PlaneStrain)
}

fn still() -> Rigid<2> {
    Rigid::prescribed(1000.0, |_| Twist::along([0.0; 2])).expect("rigid")
}

/// Run a layer of 1 kg/m^3 between the floor and a block of 1e4 kg/m^3, with weight applied over half a second; both
/// of 1 MPa. Return the overlap of block and layer at the end, cells, and the largest speed, m/s.
fn squeeze() -> [f64; 2] {
    let contact = GridContact::new(SurfaceDistance::default(), Pairs::new(Frictionless));
    let mut mpm = Mpm::with_contact(smooth(), BlockGrid::new(lattice()), contact);
    let law =
        |density| NeoHookean::new(density, Moduli::young_poisson(1.0e6, 0.3).expect("moduli")).expect("law");
    let box_of = |low: f64, high: f64| {
        let cuboid = Cuboid::new([0.0, low], [4.0 * H, high]).expect("box");
        fill(&cuboid, &lattice(), 2, &Filling::new()).expect("seeds")
    };
    mpm.add_rigid("floor", &still(), &box_of(-4.0 * H, 0.0)).expect("floor");
    mpm.add("light", law(1.0), &box_of(0.0, 4.0 * H), |_| [0.0; 2]).expect("light");
    mpm.add("heavy", law(1.0e4), &box_of(4.0 * H, 12.0 * H), |_| [0.0; 2]).expect("heavy");
    for (at, side) in [(0.0, Side::Above), (4.0 * H, Side::Below)] {
        mpm.bound(Boundary::Symmetry { axis: 0, at, side }).expect("plane");
    }
    mpm.set_body_force(|t| [0.0, -GRAVITY * (2.0 * t).min(1.0)]);
    for _ in 0..STEPS {
        mpm.step().expect("step");
    }
    let (ledger, totals) = (mpm.exchange(), mpm.totals());
    let missing = totals.momentum[1] - ledger.impulse[1] - ledger.load[1];
    assert!(missing.abs() < 1e-12 * ledger.load[1].abs(), "momentum and books differ by {missing:e}");
    let (mut top, mut bottom, mut fastest) = (f64::MIN, f64::MAX, 0.0f64);
    for (body, sign) in [(1, 1.0), (2, -1.0)] {
        mpm.bodies()[body].for_each(&mut |p| {
            fastest = fastest.max(p.velocity[1].abs());
            let half = 0.25 * H * (p.volume / (0.25 * H * H));
            if sign > 0.0 {
                top = top.max(p.position[1] + half);
            } else {
                bottom = bottom.min(p.position[1] - half);
            }
        });
    }
    [(top - bottom) / H, fastest]
}

#[test]
fn a_light_layer_bears_a_heavy_block() {
    let [overlap, speed] = squeeze();
    assert!(overlap < 0.1, "they overlap by {overlap} cells");
    // Free fall of the block would reach this speed in a hundredth of a second.
    assert!(speed < 0.1, "at rest something moves at {speed} m/s");
}

/// Discs in a box come to rest and stay at rest.
#[test]
fn a_pile_rests() {
    let contact =
        GridContact::new(SurfaceDistance::default().locally(), Pairs::new(Coulomb::new(0.3).expect("law")));
    let mut mpm = Mpm::with_contact(smooth(), BlockGrid::new(lattice()), contact);
    let (radius, width) = (3.0 * H, 18.0 * H);
    let inner = Cuboid::new([0.0, 0.0], [width, 1.5]).expect("box");
    let outer = Cuboid::new([-2.0 * H, -2.0 * H], [width + 2.0 * H, 1.2]).expect("box");
    let vessel = fill(&outer.minus(inner), &lattice(), 2, &Filling::new()).expect("seeds");
    mpm.add_rigid("vessel", &still(), &vessel).expect("vessel");
    let mut add = |n: usize, x: f64, y: f64, r: f64| {
        let disc = rings([x, y], r, (2.0 * r / H).round() as usize).expect("disc");
        mpm.add(&format!("disc {n}"), rubber(), &disc, |_| [0.0; 2]).expect("disc");
    };
    add(0, 0.45 * width, 3.0 * radius / 2.0, 1.5 * radius);
    for n in 0..5 {
        let row = (n / 2) as f64;
        add(n + 1, (0.25 + 0.5 * (n % 2) as f64) * width + 0.3 * H * row, (4.2 + 2.1 * row) * radius, radius);
    }
    mpm.set_body_force(|_| [0.0, -GRAVITY]);
    let places = |mpm: &Mpm<2>| -> Vec<[f64; 2]> {
        let centre = |body: usize| {
            let (mut mass, mut place) = (0.0, [0.0; 2]);
            mpm.bodies()[body].for_each(&mut |p| {
                mass += p.mass;
                (0..2).for_each(|d| place[d] += p.mass * p.position[d]);
            });
            place.map(|x| x / mass)
        };
        (1..mpm.bodies().len()).map(centre).collect()
    };
    mpm.run_until(4.0).expect("run");
    let before = places(&mpm);
    for _ in 0..STEPS {
        mpm.step().expect("step");
    }
    let (after, totals) = (places(&mpm), mpm.totals());
    let kinetic = totals.kinetic / (totals.mass * GRAVITY * radius);
    let creep = before.iter().zip(&after).map(|(a, b)| (a[0] - b[0]).hypot(a[1] - b[1]));
    let creep = creep.fold(0.0, f64::max) / radius;
    assert!(kinetic < 1e-6, "kinetic energy {kinetic:e} m g R");
    assert!(creep < 1e-3, "creep {creep:e} R");
}
