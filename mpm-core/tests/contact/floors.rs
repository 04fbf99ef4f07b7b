//! A body that bounces off a floor at rest gains no energy: walls, planes of symmetry, rigid bodies.

use crate::common::cuboid;
use mpm_contact::{Frictionless, Pairs, SurfaceDistance};
use mpm_core::geometry::{Ball, Cuboid, Filling, Lattice, fill};
use mpm_core::{
    BlockGrid, Boundary, CpGimp, Flip, FullSpace, GridContact, IntoKernels, Kernels, Linear, Method, Mpm,
    Musl, PlaneStrain, QuadraticBSpline, Rigid, Scalar, Side, TimeControl, Twist, Watch,
};
use mpm_materials::{Moduli, NeoHookean};

#[derive(Clone, Copy, Debug, PartialEq)]
enum Floor {
    Wall,
    Symmetry,
    Rigid,
}

/// Constructor of the kernels of a method.
type Made = fn() -> Kernels<f64, 2>;

const FLOORS: [Floor; 3] = [Floor::Wall, Floor::Symmetry, Floor::Rigid];

/// Create a rubber ball of 4 mm, 1000 kg/m^3, 100 MPa, that flies at a floor, 1 mm above the last nodes.
fn ball<const D: usize>(
    kernels: Kernels<f64, D>,
    floor: Floor,
    h: f64,
    factor: Option<f64>,
    speed: f64,
) -> Mpm<D>
where
    f64: Scalar<D>,
{
    let lattice = Lattice::new([0.0; D], h).expect("lattice");
    let mut centre = [10.3e-3; D];
    centre[1] = 6e-3;
    let seeds = fill(&Ball::new(centre, 4e-3).expect("ball"), &lattice, 2, &Filling::new()).expect("seeds");
    let law = NeoHookean::new(1000.0, Moduli::young_poisson(1e8, 0.3).expect("moduli")).expect("rubber");
    let grid = BlockGrid::new(lattice);
    let mut mpm = if floor == Floor::Rigid {
        Mpm::with_contact(
            kernels,
            grid,
            GridContact::new(SurfaceDistance::default(), Pairs::new(Frictionless)),
        )
    } else {
        Mpm::new(kernels, grid)
    };
    mpm.add("ball", law, &seeds, |_| std::array::from_fn(|d| if d == 1 { -speed } else { 0.0 }))
        .expect("ball");
    let (axis, at, side) = (1, 1e-3, Side::Above);
    match floor {
        Floor::Wall => mpm.bound(Boundary::Wall { axis, at, side, velocity: 0.0 }).expect("wall"),
        Floor::Symmetry => mpm.bound(Boundary::Symmetry { axis, at, side }).expect("plane"),
        Floor::Rigid => {
            let (mut low, mut high) = ([0.0; D], [20.6e-3; D]);
            (low[1], high[1]) = (-3e-3, at);
            let slab = Cuboid::new(low, high).expect("slab");
            let seeds = fill(&slab, &lattice, 2, &Filling::new()).expect("seeds");
            let still = Rigid::prescribed(1000.0, |_| Twist::along([0.0; D])).expect("rigid");
            mpm.add_rigid("floor", &still, &seeds).expect("floor");
        }
    }
    if let Some(factor) = factor {
        mpm.set_time_control(TimeControl::Courant { factor, growth: 1.1 }).expect("control");
    }
    // The energy is measured by this test.
    mpm.set_watch(Watch::off());
    mpm
}

/// Return the energy after the bounce over that before, and the ratio of the velocities of the ball.
fn bounce<const D: usize>(mut mpm: Mpm<D>, speed: f64) -> [f64; 2]
where
    f64: Scalar<D>,
{
    let of = |mpm: &Mpm<D>| mpm.bodies()[0].totals();
    let start = of(&mpm);
    // A distance of one millimetre, and three times the duration of the impact: 0.1 ms at 10 m/s, nearly independent of speed.
    mpm.run_until(1e-3 / speed + 0.25e-3).expect("run");
    let now = of(&mpm);
    let energy = (now.kinetic + now.internal) / start.kinetic;
    let momentum = now.momentum[1] - start.momentum[1] - mpm.exchange().impulse[1];
    assert!(momentum.abs() < 1e-12 * start.momentum_scale, "momentum {momentum:e}");
    [energy, now.momentum[1] / now.mass / speed]
}

/// Linear shape functions gain up to 1.3 % at the default step off a wall and 2.1 % off a plane of symmetry (README
/// recommends them for no impact).
#[test]
fn no_floor_gives_energy() {
    let methods: [(&str, Made); 4] = [
        ("impact", || Method::impact(PlaneStrain).into_kernels()),
        ("at rest", || Method::contact_at_rest(PlaneStrain).into_kernels()),
        ("quadratic FLIP MUSL", || Method::new(QuadraticBSpline, Flip, Musl, PlaneStrain).into_kernels()),
        ("cpGIMP FLIP MUSL", || Method::new(CpGimp, Flip, Musl, PlaneStrain).into_kernels()),
    ];
    for (name, method) in methods {
        // FLIP without an affine field is recommended for no contact.
        let floors = if name.contains("FLIP") { 2 } else { 3 };
        for floor in FLOORS.into_iter().take(floors) {
            for (h, factor) in
                [(1e-3, None), (1e-3, Some(0.1)), (5e-4, None), (5e-4, Some(0.1)), (2.5e-4, None)]
            {
                let [energy, _] = bounce(ball(method(), floor, h, factor, 10.0), 10.0);
                assert!(energy < 1.005, "{name}, {floor:?}, h {h}, factor {factor:?}: energy {energy}");
            }
            // At 100 m/s, a third of the speed of waves, FLIP with cpGIMP gains 1 to 2 %; it is recommended for no impact.
            for speed in [1.0, 100.0].into_iter().filter(|_| floors == 3) {
                let [energy, _] = bounce(ball(method(), floor, 1e-3, None, speed), speed);
                assert!(energy < 1.005, "{name}, {floor:?}, {speed} m/s: energy {energy}");
            }
        }
    }
    let linear = || Method::new(Linear, Flip, Musl, PlaneStrain).into_kernels();
    for h in [1e-3, 5e-4, 2.5e-4] {
        let [energy, _] = bounce(ball(linear(), Floor::Wall, h, None, 10.0), 10.0);
        assert!(energy < 1.02, "linear, h {h}: energy {energy} off a wall");
    }
}

/// Table of book, "Where contact is applied".
#[test]
#[ignore = "a table for the notes, not a test"]
fn energy_by_floor() {
    let methods: [(&str, Made); 5] = [
        ("`Method::impact`", || Method::impact(PlaneStrain).into_kernels()),
        ("`Method::contact_at_rest`", || Method::contact_at_rest(PlaneStrain).into_kernels()),
        ("quadratic MUSL, `Flip`", || Method::new(QuadraticBSpline, Flip, Musl, PlaneStrain).into_kernels()),
        ("cpGIMP MUSL, `Flip`", || Method::new(CpGimp, Flip, Musl, PlaneStrain).into_kernels()),
        ("linear shape function MUSL, `Flip`", || {
            Method::new(Linear, Flip, Musl, PlaneStrain).into_kernels()
        }),
    ];
    println!(
        "| | floor | default step: 4, 8, 16 cells a radius | factor 0.1: 4, 8, 16 cells |\n|---|---|---|---|"
    );
    for (name, method) in methods {
        for floor in FLOORS {
            let row = [None, Some(0.1)].map(|factor| {
                let of = |h| format!("{:.3}", bounce(ball(method(), floor, h, factor, 10.0), 10.0)[0]);
                [1e-3, 5e-4, 2.5e-4].map(of).join(", ")
            });
            println!("| {name} | {floor:?} | {} |", row.join(" | "));
        }
    }
}

#[test]
fn no_floor_gives_energy_in_space() {
    for method in
        [|| Method::impact(FullSpace).into_kernels(), || Method::contact_at_rest(FullSpace).into_kernels()]
    {
        for floor in FLOORS {
            for speed in [1.0, 10.0, 100.0] {
                let [energy, _] = bounce(ball::<3>(method(), floor, 1e-3, None, speed), speed);
                assert!(energy < 1.005, "{floor:?}, {speed} m/s: energy {energy}");
            }
        }
    }
}

/// A wall releases bodies that a plane of symmetry retains. With MUSL it takes no energy from a ball. With USL the
/// stress at the wall accelerates nodes behind it, of little mass, which strain in a step before the particles are
/// accelerated: this loss decreases with the cell size by an order of at least 1.3.
#[test]
fn a_wall_is_a_plane_of_symmetry_that_lets_go() {
    let flip = || Method::new(QuadraticBSpline, Flip, Musl, PlaneStrain).into_kernels();
    let impact = || Method::impact(PlaneStrain).into_kernels();
    let mut lost = Vec::new();
    for h in [1e-3, 5e-4, 2.5e-4] {
        let run = |method: Made, floor| bounce(ball(method(), floor, h, None, 10.0), 10.0);
        let ([energy, speed], [as_plane, _]) = (run(flip, Floor::Wall), run(flip, Floor::Symmetry));
        println!("h {h}: MUSL: energy {energy}, {as_plane} off a plane, restitution {speed}");
        assert!((energy - as_plane).abs() < 0.01, "h {h}: energy {energy}, {as_plane} off a plane");
        let ([energy, speed], [as_plane, _]) = (run(impact, Floor::Wall), run(impact, Floor::Symmetry));
        println!("h {h}: USL: energy {energy}, {as_plane} off a plane, restitution {speed}");
        lost.push(as_plane - energy);
    }
    assert!(lost[0] < 0.15 && lost[2] < 0.02, "{lost:?}");
    assert!(lost.windows(2).all(|two| two[1] * 2f64.powf(1.3) < two[0]), "{lost:?}");
    // A block stands on a wall under its weight, is lifted, and separates without resistance.
    let mut mpm = crate::common::build(
        Method::impact(PlaneStrain),
        mpm_core::OneField,
        &vec![(cuboid([0.1, 0.05], [0.3, 0.25]), [0.0; 2])],
    );
    mpm.bound(Boundary::Wall { axis: 1, at: 0.05, side: Side::Above, velocity: 0.0 }).expect("wall");
    mpm.set_body_force(|t| [0.0, if t < 0.1 { -10.0 } else { 20.0 }]);
    mpm.run_until(0.1).expect("stands");
    let weight = mpm.totals().mass * 10.0 * 0.1;
    let pushed = mpm.exchange().impulse[1];
    assert!((pushed / weight - 1.0).abs() < 0.05, "the wall carries {pushed} of {weight} N s");
    let before = mpm.totals().momentum[1];
    mpm.run_until(0.2).expect("flies");
    let gained = (mpm.totals().momentum[1] - before) / (2.0 * weight);
    assert!((gained - 1.0).abs() < 0.03, "gained {gained} of what lifts it");
}

/// A moving wall that hits a disc at rest accelerates it to less than twice its own speed (book, "Where contact is
/// applied"); its impulse is booked, and its work as the impulse times its velocity.
#[test]
fn a_wall_that_moves_does_its_work() {
    let speed = 12.0;
    let run = |h: f64| {
        let lattice = Lattice::new([0.3e-3, 0.1e-3], h).expect("lattice");
        let disc = Ball::new([8e-3, 9e-3], 5e-3).expect("disc");
        let seeds = fill(&disc, &lattice, 2, &Filling::new()).expect("seeds");
        let rubber =
            NeoHookean::new(1100.0, Moduli::young_poisson(5e7, 0.4).expect("moduli")).expect("rubber");
        let mut mpm = Mpm::new(Method::impact(PlaneStrain), BlockGrid::new(lattice));
        mpm.add("disc", rubber, &seeds, |_| [0.0; 2]).expect("disc");
        mpm.bound(Boundary::Wall { axis: 0, at: 2e-3, side: Side::Above, velocity: speed }).expect("wall");
        mpm.set_watch(Watch::off());
        mpm.run_until(0.6e-3).expect("run");
        let (now, given) = (mpm.totals(), mpm.exchange());
        assert!((given.impulse[0] - now.momentum[0]).abs() < 1e-12 * now.momentum_scale, "{given:?}");
        assert!((given.work / (speed * given.impulse[0]) - 1.0).abs() < 1e-12, "{given:?}");
        assert!(
            now.kinetic + now.internal < given.work,
            "{} J of {}",
            now.kinetic + now.internal,
            given.work
        );
        now.momentum[0] / now.mass
    };
    let [coarse, fine] = [1e-3, 0.5e-3].map(run);
    println!("{coarse:.2} and {fine:.2} m/s at 5 and 10 cells a radius, {} due", 2.0 * speed);
    assert!(coarse < fine && fine < 2.0 * speed && coarse > 1.4 * speed, "{coarse} and {fine}");
}
