//! Rigid bodies at planes of symmetry: half and quarter models are equivalent to the whole, and prescribed bodies
//! follow their motion.

use crate::common::{H, WAVE, cuboid, lattice, particles, rubber};
use mpm_contact::{Choice, Coulomb, Gradients, Pairs, SurfaceDistance, Weight};
use mpm_core::geometry::Seeds;
use mpm_core::{
    Apic, BlockGrid, Boundary, CpGimp, CubicBSpline, Flip, FullSpace, GridContact, IntoKernels, Linear,
    Method, Mls, Mpm, Musl, PlaneStrain, PointView, QuadraticBSpline, Rigid, Side, TimeControl, Twist, Usf,
    Usl,
};

/// Position of planes of symmetry, m.
const AT: f64 = 12.0 * H;

/// Return the seeds above the planes of symmetry.
fn part<const D: usize>(seeds: Seeds<D>, planes: usize) -> Seeds<D> {
    let kept: Vec<usize> =
        (0..seeds.positions.len()).filter(|&n| (0..planes).all(|d| seeds.positions[n][d] > AT)).collect();
    Seeds {
        positions: kept.iter().map(|&n| seeds.positions[n]).collect(),
        volumes: kept.iter().map(|&n| seeds.volumes[n]).collect(),
        ..seeds
    }
}

fn free<const D: usize>() -> Rigid<D> {
    Rigid::free(3000.0).expect("rigid")
}

/// Create a box centred on the planes along the first axes, from `low` to `high` cells along the last one.
fn slab<const D: usize>(half: usize, [low, high]: [f64; 2]) -> Seeds<D> {
    let (mut from, mut to) = ([AT - half as f64 * H; D], [AT + half as f64 * H; D]);
    (from[D - 1], to[D - 1]) = (low * H, high * H);
    cuboid(from, to)
}

/// Rule for contact normals. The separating plane is iterated: for rough surfaces it depends on the order of
/// particles, which differs in half and whole models.
#[derive(Clone, Copy)]
enum Normals {
    Plane,
    Mass,
}

/// Run a scene with friction, cut by `planes` planes of symmetry, or whole: a platen of prescribed motion presses
/// rubber onto a free stone, which hits a second block of rubber. No surfaces touch at the start, where rounding
/// would decide.
fn press<const D: usize>(
    method: impl IntoKernels<f64, D>,
    normals: Normals,
    planes: usize,
    steps: usize,
) -> Vec<Vec<PointView>> {
    let laws = Pairs::new(Coulomb::new(0.3).expect("law"));
    let grid = BlockGrid::new(lattice());
    let mut mpm = match normals {
        Normals::Plane => Mpm::with_contact(method, grid, GridContact::new(SurfaceDistance::default(), laws)),
        Normals::Mass => {
            let mass = Gradients::new(Weight::Mass, Choice::Collinear);
            let detector = SurfaceDistance::new(mass, 0.0).expect("detector");
            Mpm::with_contact(method, grid, GridContact::new(detector, laws))
        }
    };
    mpm.set_time_control(TimeControl::Fixed(0.2 * H / WAVE)).expect("control");
    for axis in 0..planes {
        mpm.bound(Boundary::Symmetry { axis, at: AT, side: Side::Above }).expect("plane");
    }
    let down = |speed: f64| {
        let mut v = [0.0; D];
        v[D - 1] = -speed;
        v
    };
    mpm.set_body_force(move |_| down(10.0));
    mpm.add("bed", rubber(), &part(slab(4, [2.0, 5.0]), planes), |_| [0.0; D]).expect("bed");
    let stone = free().with_velocity(down(1.0));
    mpm.add_rigid("stone", &stone, &part(slab(2, [5.13, 7.13]), planes)).expect("stone");
    mpm.add("pad", rubber(), &part(slab(3, [7.29, 9.29]), planes), |_| [0.0; D]).expect("pad");
    let platen = Rigid::prescribed(7800.0, move |_| Twist::along(down(0.05 * WAVE))).expect("platen");
    mpm.add_rigid("platen", &platen, &part(slab(4, [9.37, 10.37]), planes)).expect("platen");
    for _ in 0..steps {
        mpm.step().expect("step");
    }
    assert!(mpm.contacts().len() >= 2, "{} contacts", mpm.contacts().len());
    particles(&mpm)
}

fn part_is_whole<const D: usize>(
    name: &str,
    planes: usize,
    steps: usize,
    run: impl Fn(usize) -> Vec<Vec<PointView>>,
) {
    let (part, whole) = (run(planes), run(0));
    let mut worst: f64 = 0.0;
    for (part, whole) in part.iter().zip(&whole) {
        let whole: Vec<&PointView> =
            whole.iter().filter(|p| (0..planes).all(|d| p.position[d] > AT)).collect();
        assert_eq!(part.len(), whole.len());
        for (p, q) in part.iter().zip(whole) {
            for d in 0..D {
                worst = worst.max((p.position[d] - q.position[d]).abs());
            }
        }
    }
    println!("{name}: {worst:e} m after {steps} steps");
    assert!(worst < 1e-10, "{name}: off by {worst:e} m");
}

macro_rules! halves {
    ($($name:ident: $d:literal, $planes:literal, $steps:literal, $normals:ident, $method:expr;)*) => {$(
        #[test]
        fn $name() {
            part_is_whole::<$d>(stringify!($name), $planes, $steps, |planes| press::<$d>($method, Normals::$normals, planes, $steps));
        }
    )*};
}
halves! {
    half_with_the_hat: 2, 1, 100, Plane, Method::new(Linear, Flip, Musl, PlaneStrain);
    half_with_cpgimp: 2, 1, 100, Plane, Method::new(CpGimp, Flip, Musl, PlaneStrain);
    half_with_cpgimp_stress_first: 2, 1, 60, Plane, Method::new(CpGimp, Flip, Usf, PlaneStrain).compiled();
    half_with_mls: 2, 1, 60, Mass, Method::new(CubicBSpline, Mls, Usl, PlaneStrain).compiled();
    half_with_splines: 2, 1, 100, Mass, Method::new(QuadraticBSpline, Flip, Musl, PlaneStrain);
    half_with_affine_splines: 2, 1, 100, Plane, Method::new(QuadraticBSpline, Apic, Usl, PlaneStrain);
    half_with_cubic_splines: 2, 1, 60, Plane, Method::new(CubicBSpline, Apic, Usl, PlaneStrain).compiled();
    quarter_with_splines: 3, 2, 40, Plane, Method::new(QuadraticBSpline, Apic, Usl, FullSpace);
    quarter_with_cpgimp: 3, 2, 60, Plane, Method::new(CpGimp, Flip, Musl, FullSpace);
}

/// Check that a part of a prescribed body, at one plane or two, follows its motion to rounding, with every shape function.
fn obeys(method: impl IntoKernels<f64, 3>) {
    let contact = GridContact::new(SurfaceDistance::default(), Pairs::new(Coulomb::new(0.3).expect("law")));
    let mut mpm = Mpm::with_contact(method, BlockGrid::new(lattice()), contact);
    mpm.set_time_control(TimeControl::Fixed(1e-3)).expect("control");
    mpm.bound(Boundary::Symmetry { axis: 0, at: AT, side: Side::Above }).expect("plane");
    mpm.bound(Boundary::Symmetry { axis: 1, at: AT, side: Side::Above }).expect("plane");
    let motion = |t: f64| Twist { velocity: [0.0, 0.0, 0.3 * (20.0 * t).cos()], spin: [0.0; 3] };
    let quarter = Rigid::prescribed(1000.0, motion).expect("rigid");
    mpm.add_rigid("quarter", &quarter, &cuboid([AT, AT, AT], [AT + 3.0 * H, AT + 2.0 * H, AT + 4.0 * H]))
        .expect("body");
    // A body that spins about the normal of the plane on its face, and moves away from the plane.
    let motion = |_| Twist { velocity: [0.2, 0.0, 0.0], spin: [3.0, 0.0, 0.0] };
    let centre = [AT, AT + 12.0 * H, AT];
    let rotor = Rigid::prescribed(1000.0, motion).expect("rigid").about(centre);
    let shape = cuboid([AT, AT + 11.0 * H, AT - 3.0 * H], [AT + 2.0 * H, AT + 13.0 * H, AT + 3.0 * H]);
    mpm.add_rigid("rotor", &rotor, &shape).expect("body");
    let start = particles(&mpm);
    mpm.run_until(0.1).expect("run");
    let (time, now) = (mpm.time(), particles(&mpm));
    let way = 0.3 / 20.0 * (20.0 * time).sin();
    for (a, b) in start[0].iter().zip(&now[0]) {
        let due = [a.position[0], a.position[1], a.position[2] + way];
        (0..3)
            .for_each(|d| assert!((b.position[d] - due[d]).abs() < 1e-9, "{:?} and not {due:?}", b.position));
    }
    let (sin, cos) = (3.0 * time).sin_cos();
    for (a, b) in start[1].iter().zip(&now[1]) {
        let [x, y, z] = std::array::from_fn(|d| a.position[d] - centre[d]);
        let due = [AT + x + 0.2 * time, centre[1] + y * cos - z * sin, centre[2] + y * sin + z * cos];
        (0..3)
            .for_each(|d| assert!((b.position[d] - due[d]).abs() < 1e-9, "{:?} and not {due:?}", b.position));
    }
    assert_eq!(mpm.exchange().impulse, [0.0; 3], "what is prescribed is not in the books");
}

#[test]
fn prescribed_bodies_at_planes_of_symmetry_go_where_they_are_told() {
    obeys(Method::new(Linear, Flip, Musl, FullSpace));
    obeys(Method::new(CpGimp, Flip, Usl, FullSpace));
    obeys(Method::new(CpGimp, Flip, Usf, FullSpace).compiled());
    obeys(Method::new(QuadraticBSpline, Apic, Usl, FullSpace));
    obeys(Method::new(QuadraticBSpline, Flip, Musl, FullSpace));
    obeys(Method::new(CubicBSpline, Mls, Usl, FullSpace).compiled());
}

/// A free body cut by a plane keeps its symmetry under any load, and the balances close; the plane stops a body that is not cut.
#[test]
fn planes_of_symmetry_hold_free_bodies() {
    let method = Method::new(QuadraticBSpline, Apic, Usl, FullSpace);
    let contact = GridContact::new(SurfaceDistance::default(), Pairs::new(Coulomb::new(0.3).expect("law")));
    let mut mpm = Mpm::with_contact(method, BlockGrid::new(lattice()), contact);
    mpm.set_time_control(TimeControl::Fixed(1e-3)).expect("control");
    mpm.bound(Boundary::Symmetry { axis: 0, at: AT, side: Side::Above }).expect("plane");
    mpm.set_body_force(|_| [-4.0, 1.0, -10.0]);
    // Not symmetric about its own centre along y and z, so that weight and spin would rotate it.
    let wedge = cuboid([AT, AT, AT], [AT + 4.0 * H, AT + 2.0 * H, AT + 3.0 * H]);
    let spins = free().with_velocity([0.0, 1.0, 0.5]).with_spin([5.0, 0.0, 0.0]);
    mpm.add_rigid("wedge", &spins, &wedge).expect("wedge");
    let far = 8.0 * H;
    let ball = cuboid([AT + H, AT - far, AT], [AT + 3.0 * H, AT - far + 2.0 * H, AT + 2.0 * H]);
    mpm.add_rigid("stone", &free(), &ball).expect("stone");
    let start = mpm.totals();
    mpm.run_until(0.3).expect("run");
    let time = mpm.time();
    let state = mpm.bodies()[0].rigid().expect("rigid");
    let [u, v, w] = state.velocity();
    assert!(u == 0.0 && (v - 1.0 - time).abs() < 1e-9 && (w - 0.5 + 10.0 * time).abs() < 1e-9, "{u} {v} {w}");
    let [p, q, r] = state.spin();
    assert!((p - 5.0).abs() < 1e-9 && q == 0.0 && r == 0.0, "spin {p} {q} {r}");
    let stone = mpm.bodies()[1].rigid().expect("rigid");
    assert!((stone.centre()[0] - AT - H).abs() < 1e-9, "the stone is {} m off", stone.centre()[0] - AT - H);
    assert!(stone.velocity()[0].abs() < 1e-12, "the stone moves at {} m/s", stone.velocity()[0]);
    let (end, books) = (mpm.totals(), mpm.exchange());
    for d in 0..3 {
        let missing = end.momentum[d] - start.momentum[d] - books.impulse[d] - books.load[d];
        assert!(missing.abs() < 1e-10 * end.momentum_scale, "{d}: {missing:e}");
    }
    let missing = end.kinetic - start.kinetic - books.work + books.impacts + books.friction;
    assert!(missing.abs() < 1e-9 * end.kinetic, "energy: {missing:e} J");
}
